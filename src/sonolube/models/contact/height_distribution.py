"""Distributions of summit heights by name: the exponential fit to the Gaussian tail, and the Gaussian itself.

Heights are measured from the mean of the summit heights in units of the rms height R_q. A new distribution takes one
file `contact/height_distributions/NAME.py` with its class, and one line of `HEIGHT_DISTRIBUTIONS`.
"""

import math
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np

from sonolube.checks import Floats, require_positive, require_within
from sonolube.errors import OutsideRange
from sonolube.variants import VariantTable

MINIMUM_ROUGHNESS_PARAMETER = math.sqrt(3.717e-4)
"""Smallest roughness parameter of an isotropic Gaussian surface, at which its summit heights have no scatter. []"""


class HeightDistribution(Protocol):
    """Probability density of summit heights over R_q.

    Attributes
    ----------
    name : str
        Name in `HEIGHT_DISTRIBUTIONS`, and value of `height_distribution` in rig files.
    citation : str
        Source of the distribution.
    """

    name: ClassVar[str]
    citation: ClassVar[str]

    @property
    def standard_deviation(self) -> float:
        """Standard deviation of the summit heights over R_q; it sets the range and the step of quadrature. []"""

    def log_density(self, normalized_height: Floats) -> Floats:
        """Natural logarithm of the density, finite also where the density itself underflows. []

        Parameters
        ----------
        normalized_height : ndarray, any shape
            Height above the mean of the summit heights, over R_q. []

        Returns
        -------
        ndarray, shape of `normalized_height`
        """


@dataclass(frozen=True, kw_only=True, slots=True)
class ExponentialHeights:
    r"""Exponential distribution of summit heights, a fit to the upper tail of the Gaussian.

    Parameters
    ----------
    amplitude : float
        Density at the mean height, c, a pure number.
    decay : float
        Decay constant lambda of the density per R_q, a pure number.

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    Notes
    -----
    .. math:: \phi(z) = c\, e^{-\lambda z} \tag{D 3.2}

    The density is not normalized: with the default values it integrates to 17/3 over positive heights. It approximates
    the Gaussian only for summits in the upper tail; `sonolube.models.contact.exponential_validity_range` returns the
    range of separations in which both give the same load within a factor. Surfaces with exponential heights never
    separate: the load falls by a factor of e over every R_q/lambda.

    See Also
    --------
    GaussianHeights : The distribution whose tail this one fits.

    References
    ----------
    .. [1] D 3.2
    .. [2] A. A. Polycarpou and I. Etsion, J. Tribol. 121, 234 (1999). doi:10.1115/1.2833926
    """

    name: ClassVar[str] = "exponential"
    citation: ClassVar[str] = "A. A. Polycarpou and I. Etsion, J. Tribol. 121, 234 (1999); D 3.2"

    amplitude: float = 17.0
    decay: float = 3.0

    def __post_init__(self) -> None:
        require_positive(amplitude=self.amplitude, decay=self.decay)

    @property
    def standard_deviation(self) -> float:
        """Standard deviation of the exponential tail over R_q, 1/lambda. []"""
        return 1 / self.decay

    def log_density(self, normalized_height: Floats) -> Floats:
        """Natural logarithm of the density. []"""
        return math.log(self.amplitude) - self.decay * normalized_height  # D 3.2


@dataclass(frozen=True, kw_only=True, slots=True)
class GaussianHeights:
    r"""Gaussian distribution of summit heights.

    Parameters
    ----------
    summit_deviation_ratio : float
        Standard deviation of summit heights over that of the surface, s, from above 0 to 1. []

    Raises
    ------
    InvalidInput
        If the ratio does not lie above 0 and up to 1.

    Notes
    -----
    .. math:: \phi(z) = \frac{1}{s \sqrt{2 \pi}}\, e^{-z^2 / 2 s^2}

    See Also
    --------
    ExponentialHeights : Fit to the upper tail, with closed forms for every asperity law.

    References
    ----------
    .. [1] J. A. Greenwood and J. B. P. Williamson, Proc. R. Soc. A 295, 300 (1966). doi:10.1098/rspa.1966.0242
    """

    name: ClassVar[str] = "gaussian"
    citation: ClassVar[str] = "J. A. Greenwood and J. B. P. Williamson, Proc. R. Soc. A 295, 300 (1966)"

    summit_deviation_ratio: float = 1.0

    def __post_init__(self) -> None:
        require_positive(summit_deviation_ratio=self.summit_deviation_ratio)
        require_within(0.0, 1.0, summit_deviation_ratio=self.summit_deviation_ratio)

    @classmethod
    def from_roughness_parameter(cls, *, roughness_parameter: float) -> "GaussianHeights":
        r"""Distribution of summit heights of an isotropic Gaussian surface after McCool.

        Parameters
        ----------
        roughness_parameter : float
            Summit density times rms height times summit radius, beta. []

        Returns
        -------
        GaussianHeights

        Raises
        ------
        OutsideRange
            If the roughness parameter is too small for a Gaussian surface.

        Notes
        -----
        .. math:: s^2 = 1 - \frac{3.717 \cdot 10^{-4}}{\beta^2}

        References
        ----------
        .. [1] J. I. McCool, Wear 107, 37 (1986). doi:10.1016/0043-1648(86)90045-1
        """
        require_positive(roughness_parameter=roughness_parameter)
        if roughness_parameter <= MINIMUM_ROUGHNESS_PARAMETER:
            raise OutsideRange(
                f"roughness_parameter must exceed {MINIMUM_ROUGHNESS_PARAMETER:.4f} for a Gaussian surface, "
                f"got {roughness_parameter!r}"
            )
        return cls(summit_deviation_ratio=math.sqrt(1 - (MINIMUM_ROUGHNESS_PARAMETER / roughness_parameter) ** 2))

    @property
    def standard_deviation(self) -> float:
        """Standard deviation of summit heights over R_q. []"""
        return self.summit_deviation_ratio

    def log_density(self, normalized_height: Floats) -> Floats:
        """Natural logarithm of the density. []"""
        s = self.summit_deviation_ratio
        return -0.5 * np.square(normalized_height / s) - math.log(s * math.sqrt(2 * math.pi))


HEIGHT_DISTRIBUTIONS: VariantTable[HeightDistribution] = VariantTable(
    "height distribution",
    {
        "exponential": "sonolube.models.contact.height_distribution:ExponentialHeights",
        "gaussian": "sonolube.models.contact.height_distribution:GaussianHeights",
    },
    made=lambda law: law(),
)
"""Height distributions by name, with their default parameters; a new one takes its file and one line here."""
