"""How the heights of asperity summits are distributed about their mean."""

import math
from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_positive, require_within
from sonolube.errors import OutsideRange
from sonolube.variants import VariantTable

LEAST_ROUGHNESS_PARAMETER = math.sqrt(3.717e-4)
"""Roughness parameter below which no Gaussian surface has real summits. []"""


class HeightDistribution(Protocol):
    """A law of summit heights, in units of the standard deviation Rq of the surface."""

    name: ClassVar[str]

    @property
    def spread(self) -> float:
        """Height over which the density changes by about a factor of e. []"""

    def log_density(self, normalized_height: Floats) -> Floats:
        """Return the natural logarithm of the density, finite also where the density itself underflows."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ExponentialHeights:
    """The exponential law c exp(-lambda z), which stands in for the upper tail of a Gaussian one.

    Parameters
    ----------
    amplitude : float
        Density at the mean height, c, a pure number.
    decay : float
        Decay of the density per standard deviation, lambda, a pure number.

    Notes
    -----
    The density is no normalized one: with the default values it integrates to 17/3 over positive heights, and it means
    something only where summits touch. `sonolube.contact.exponential_window` says for which separations that is so.

    References
    ----------
    .. [1] D 3.2
    .. [2] A. A. Polycarpou and I. Etsion, J. Tribol. 121, 234 (1999). doi:10.1115/1.2833926
    """

    name: ClassVar[str] = "exponential"

    amplitude: float = 17.0
    decay: float = 3.0

    def __post_init__(self) -> None:
        require_positive(amplitude=self.amplitude, decay=self.decay)

    @property
    def spread(self) -> float:
        """Height over which the density falls by a factor of e, 1/lambda. []"""
        return 1 / self.decay

    def log_density(self, normalized_height: Floats) -> Floats:
        """Return the natural logarithm of the density."""
        return math.log(self.amplitude) - self.decay * normalized_height  # D 3.2


@dataclass(frozen=True, kw_only=True, slots=True)
class GaussianHeights:
    """The normal law.

    Parameters
    ----------
    summit_deviation_ratio : float
        Standard deviation of summit heights over that of the surface, from above 0 to 1. []

    References
    ----------
    .. [1] J. A. Greenwood and J. B. P. Williamson, Proc. R. Soc. A 295, 300 (1966). doi:10.1098/rspa.1966.0242
    """

    name: ClassVar[str] = "gaussian"

    summit_deviation_ratio: float = 1.0

    def __post_init__(self) -> None:
        require_positive(summit_deviation_ratio=self.summit_deviation_ratio)
        require_within(0.0, 1.0, summit_deviation_ratio=self.summit_deviation_ratio)

    @classmethod
    def from_roughness_parameter(cls, *, roughness_parameter: float) -> "GaussianHeights":
        """Return the summit heights of an isotropic Gaussian surface.

        Parameters
        ----------
        roughness_parameter : float
            Summit density times deviation times summit radius. []

        Returns
        -------
        GaussianHeights

        Raises
        ------
        OutsideRange
            If the roughness parameter is so small that no such surface exists.

        References
        ----------
        .. [1] J. I. McCool, Wear 107, 37 (1986). doi:10.1016/0043-1648(86)90045-1
        """
        require_positive(roughness_parameter=roughness_parameter)
        if roughness_parameter <= LEAST_ROUGHNESS_PARAMETER:
            raise OutsideRange(
                f"roughness_parameter must exceed {LEAST_ROUGHNESS_PARAMETER:.4f} for a Gaussian surface, "
                f"got {roughness_parameter!r}"
            )
        return cls(summit_deviation_ratio=math.sqrt(1 - (LEAST_ROUGHNESS_PARAMETER / roughness_parameter) ** 2))

    @property
    def spread(self) -> float:
        """Standard deviation of summit heights, in units of Rq. []"""
        return self.summit_deviation_ratio

    def log_density(self, normalized_height: Floats) -> Floats:
        """Return the natural logarithm of the density."""
        s = self.summit_deviation_ratio
        return -0.5 * np.square(normalized_height / s) - math.log(s * math.sqrt(2 * math.pi))


def height_density(heights: HeightDistribution, *, normalized_height: ArrayLike) -> Floats:
    """Return the probability density of summit heights. []

    Parameters
    ----------
    heights : HeightDistribution
    normalized_height : array_like, any shape
        Height above the mean of summit heights, over Rq. []

    Returns
    -------
    ndarray, shape of `normalized_height`

    Raises
    ------
    InvalidInput
        If a height is not finite.
    """
    return np.exp(heights.log_density(require_finite(normalized_height=normalized_height)))


HEIGHT_DISTRIBUTIONS: VariantTable[HeightDistribution] = VariantTable(
    "height distribution",
    {
        "exponential": "sonolube.contact.height_distribution:ExponentialHeights",
        "gaussian": "sonolube.contact.height_distribution:GaussianHeights",
    },
    made=lambda law: law(),
)
"""The height laws by name, with their default parameters; a new law takes its file and one line here."""
