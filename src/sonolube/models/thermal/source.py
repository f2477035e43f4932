"""Thermal properties of a solid, and heat sources on it with their limits at low and high Peclet number."""

import math
from abc import ABC, abstractmethod
from dataclasses import asdict, dataclass
from typing import ClassVar

import numpy as np

from sonolube.checks import require_positive


@dataclass(frozen=True, kw_only=True, slots=True)
class ThermalSolid:
    """Conductivity, density and specific heat capacity of a homogeneous, isotropic solid.

    Parameters
    ----------
    thermal_conductivity : float
        Heat flux per temperature gradient, k. [W/(m K)]
    density : float
        Mass density, rho. [kg/m3]
    specific_heat_capacity : float
        Heat per mass and kelvin, c_p. [J/(kg K)]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    Notes
    -----
    The properties do not depend on temperature, which holds for rises of some tens of kelvin.
    """

    thermal_conductivity: float
    density: float
    specific_heat_capacity: float

    def __post_init__(self) -> None:
        require_positive(**asdict(self))

    @property
    def thermal_diffusivity(self) -> float:
        """Thermal diffusivity, k/(rho c_p). [m2/s]"""
        return self.thermal_conductivity / (self.density * self.specific_heat_capacity)


def _complete_elliptic_integral(complement: float) -> float:
    """Complete elliptic integral K of the first kind, of the complementary modulus, by arithmetic-geometric means.

    DLMF 19.8.5; `scipy.special.ellipkm1` gives the same, but its import takes longer than a whole prediction.
    """
    low, high = complement, 1.0
    while high - low > 1e-8 * high:  # means meet quadratically
        low, high = math.sqrt(low * high), (low + high) / 2
    return math.pi / (low + high)


def _beta(a: float, b: float) -> float:
    """Beta function."""
    return math.gamma(a) * math.gamma(b) / math.gamma(a + b)


_PEAK_HIGH_PECLET_UNIFORM = float(2 / np.sqrt(np.pi))  # half-space heated for the time of passage of the whole length
_MEAN_TO_PEAK_RECTANGLE = 2 / 3  # mean of sqrt(x) over its end value
_MEAN_TO_PEAK_ELLIPSE = 4 / (3 * math.pi) * _beta(1 / 2, 7 / 4)  # the same, averaged over all chords
# Flux q = 3/2 sqrt(1 - x^2) of its mean along the middle chord: the maximum, over s, of the integral up to s of
# q/sqrt(2 pi (s - x)), which lies 0.652 half lengths behind the centre.
_PEAK_HIGH_PECLET_HERTZ = 2.3210497325 / float(np.sqrt(np.pi))
_MEAN_TO_PEAK_HERTZ = 16 / (5 * math.pi) * _beta(1 / 2, 9 / 4) / math.sqrt(math.pi) / _PEAK_HIGH_PECLET_HERTZ


@dataclass(frozen=True, kw_only=True, slots=True)
class HeatSource(ABC):
    r"""Heat flux distributed over a patch of a half-space, with the low- and high-Peclet limits of its temperature.

    Parameters
    ----------
    half_length, half_width : float
        Half the length along the sliding, and half the width across it. [m]

    Attributes
    ----------
    peak_high_peclet : float
        Dimensionless peak rise times the square root of the Peclet number, for Pe to infinity.
    mean_to_peak_high_peclet : float
        Mean over peak rise for Pe to infinity.

    Notes
    -----
    Rises are dimensionless, in units of :math:`\bar q b/k` with the mean flux :math:`\bar q`, the half length b along
    the sliding and the conductivity k. With the Peclet number Pe the limits are

    .. math::

        \frac{\Delta T}{\bar q b/k} \to c_0 \quad (\mathrm{Pe} \to 0) , \qquad
        \frac{\Delta T}{\bar q b/k} \to \frac{c_\infty}{\sqrt{\mathrm{Pe}}} \quad (\mathrm{Pe} \to \infty) .
    """

    half_length: float
    half_width: float
    peak_high_peclet: ClassVar[float]
    mean_to_peak_high_peclet: ClassVar[float]

    def __post_init__(self) -> None:
        require_positive(half_length=self.half_length, half_width=self.half_width)

    @property
    @abstractmethod
    def area(self) -> float:
        """Area of the patch. [m2]"""

    @property
    @abstractmethod
    def peak_low_peclet(self) -> float:
        """Dimensionless rise at the centre of the stationary source, Pe = 0. []"""

    @property
    @abstractmethod
    def mean_low_peclet(self) -> float:
        """Dimensionless mean rise under the stationary source, Pe = 0. []"""


@dataclass(frozen=True, kw_only=True, slots=True)
class _EllipticPatch(HeatSource):
    """Heat flux over an ellipse, whose rises at rest scale alike with the ratio of its axes."""

    centre_low_peclet: ClassVar[float]  # rise at the centre over K(m) min(b, l)/b
    mean_to_centre_low_peclet: ClassVar[float]

    @property
    def area(self) -> float:
        """Area of the patch. [m2]"""
        return float(np.pi * self.half_length * self.half_width)

    @property
    def peak_low_peclet(self) -> float:
        """Dimensionless rise at the centre of the stationary source, Pe = 0. []"""
        short, long = sorted((self.half_length, self.half_width))
        return self.centre_low_peclet * _complete_elliptic_integral(short / long) * short / self.half_length

    @property
    def mean_low_peclet(self) -> float:
        """Dimensionless mean rise under the stationary source, Pe = 0. []"""
        return self.mean_to_centre_low_peclet * self.peak_low_peclet


@dataclass(frozen=True, kw_only=True, slots=True)
class EllipticSource(_EllipticPatch):
    r"""Uniform heat flux over an ellipse with one axis along the sliding; a circle where both axes are equal.

    Parameters
    ----------
    half_length : float
        Semi-axis along the sliding, b. [m]
    half_width : float
        Semi-axis across the sliding, l. [m]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    See Also
    --------
    HertzianSource : the same patch with a flux in proportion to the Hertzian pressure.
    RectangularSource : uniform flux over a rectangle.

    Notes
    -----
    With the complete elliptic integral K of parameter :math:`m = 1 - \min(b, l)^2/\max(b, l)^2`, the stationary rise at
    the centre and its mean over the ellipse are

    .. math::

        \frac{\Delta T_0}{q b/k} = \frac{2}{\pi}\, K(m)\, \frac{\min(b, l)}{b} , \qquad
        \overline{\Delta T} = \frac{8}{3\pi} \Delta T_0 .

    At high Peclet number the peak is :math:`2/\sqrt{\pi\,\mathrm{Pe}}` at the trailing end of the middle chord.

    References
    ----------
    .. [1] H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 2nd ed., Oxford (1959), chapters 8 and 10.
    """

    peak_high_peclet: ClassVar[float] = _PEAK_HIGH_PECLET_UNIFORM
    mean_to_peak_high_peclet: ClassVar[float] = _MEAN_TO_PEAK_ELLIPSE
    centre_low_peclet: ClassVar[float] = 2 / math.pi
    mean_to_centre_low_peclet: ClassVar[float] = 8 / (3 * math.pi)


@dataclass(frozen=True, kw_only=True, slots=True)
class HertzianSource(_EllipticPatch):
    r"""Heat flux in proportion to the Hertzian pressure on an ellipse: the parabolic source of Tian and Kennedy.

    Parameters
    ----------
    half_length : float
        Semi-axis along the sliding, b. [m]
    half_width : float
        Semi-axis across the sliding, l. [m]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    See Also
    --------
    EllipticSource : the same patch with a uniform flux.

    Notes
    -----
    The flux is :math:`\tfrac32 \bar q \sqrt{1 - x^2/b^2 - y^2/l^2}`. The stationary rise falls with the square of the
    distance from the centre, as the indentation under that pressure does; its mean is 3/4 of its value at the centre,

    .. math:: \frac{\Delta T_0}{\bar q b/k} = \frac{3}{4}\, K(m)\, \frac{\min(b, l)}{b} ,

    with the elliptic integral of `EllipticSource`. At high Peclet number the peak is
    :math:`2.321/\sqrt{\pi\,\mathrm{Pe}}`, 0.652 b behind the centre.

    References
    ----------
    .. [1] X. Tian, F. E. Kennedy, J. Tribol. 116, 167 (1994). doi:10.1115/1.2927035
    .. [2] K. L. Johnson, Contact Mechanics, Cambridge (1985), section 3.5. doi:10.1017/CBO9781139171731
    """

    peak_high_peclet: ClassVar[float] = _PEAK_HIGH_PECLET_HERTZ
    mean_to_peak_high_peclet: ClassVar[float] = _MEAN_TO_PEAK_HERTZ
    centre_low_peclet: ClassVar[float] = 3 / 4
    mean_to_centre_low_peclet: ClassVar[float] = 3 / 4


@dataclass(frozen=True, kw_only=True, slots=True)
class RectangularSource(HeatSource):
    r"""Uniform heat flux over a rectangle with one side along the sliding; a square where both sides are equal.

    Parameters
    ----------
    half_length : float
        Half the side along the sliding, b. [m]
    half_width : float
        Half the side across the sliding, l. [m]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    See Also
    --------
    EllipticSource : uniform flux over an ellipse.
    moving_rectangle_rise : the temperature around this source by quadrature.

    Notes
    -----
    With r = l/b the stationary rise at the centre and its mean over the rectangle are

    .. math::

        \frac{\Delta T_0}{q b/k} &= \frac{2}{\pi}
        \left( r \operatorname{arsinh} \frac1r + \operatorname{arsinh} r \right) \\
        \frac{\overline{\Delta T}}{q b/k} &= \frac{\Delta T_0}{q b/k} + \frac{2}{\pi}\,
        \frac{1 + r^3 - (1 + r^2)^{3/2}}{3 r} .

    At high Peclet number the peak is :math:`2/\sqrt{\pi\,\mathrm{Pe}}` along the trailing edge, the mean 2/3 of it.

    References
    ----------
    .. [1] J. C. Jaeger, J. Proc. R. Soc. N.S.W. 76, 203 (1942).
    """

    peak_high_peclet: ClassVar[float] = _PEAK_HIGH_PECLET_UNIFORM
    mean_to_peak_high_peclet: ClassVar[float] = _MEAN_TO_PEAK_RECTANGLE

    @property
    def area(self) -> float:
        """Area of the patch. [m2]"""
        return 4 * self.half_length * self.half_width

    @property
    def peak_low_peclet(self) -> float:
        """Dimensionless rise at the centre of the stationary source, Pe = 0. []"""
        r = self.half_width / self.half_length
        return float(2 / np.pi * (r * np.arcsinh(1 / r) + np.arcsinh(r)))

    @property
    def mean_low_peclet(self) -> float:
        """Dimensionless mean rise under the stationary source, Pe = 0. []"""
        r = self.half_width / self.half_length
        corner = (1 + r**3 - np.hypot(1, r) ** 3) / (3 * r)
        return float(2 / np.pi * (r * np.arcsinh(1 / r) + np.arcsinh(r) + corner))
