"""Patches on a half-space that take up heat, and the two limits of how hot they get."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.special import beta, ellipk

from sonolube.checks import require_positive

_FAST_PEAK_OF_EVEN = float(2 / np.sqrt(np.pi))  # half a space heated for as long as the source passes
_FAST_MEAN_OF_RECTANGLE = 2 / 3  # mean of sqrt(x) over its end value
_FAST_MEAN_OF_ELLIPSE = float(4 / (3 * np.pi) * beta(1 / 2, 7 / 4))  # the same over all chords
_STILL_MEAN_OF_ELLIPSE = 8 / (3 * np.pi)  # of any ellipse: mean and centre scale alike with the axes
# Flux q = 3/2 sqrt(1 - x^2) of its mean along the middle chord makes the greatest, over s, of the integral up to s of
# q/sqrt(2 pi (s - x)): at s = 0.652 of the half length behind the middle.
_FAST_PEAK_OF_HERTZ = 2.3210497325 / float(np.sqrt(np.pi))
_FAST_MEAN_OF_HERTZ = float(16 / (5 * np.pi) * beta(1 / 2, 9 / 4) / np.sqrt(np.pi)) / _FAST_PEAK_OF_HERTZ
_STILL_MEAN_OF_HERTZ = 3 / 4  # of its peak, whatever the axes


class HeatSource(Protocol):
    """A patch of heat flux on a half-space; rises are in units of mean flux times `half_length` over conductivity."""

    @property
    def half_length(self) -> float:
        """Half the length along the sliding. [m]"""

    @property
    def area(self) -> float:
        """Area of the patch. [m2]"""

    @property
    def peak_low_peclet(self) -> float:
        """Rise at the centre, source at rest. []"""

    @property
    def mean_low_peclet(self) -> float:
        """Mean rise, source at rest. []"""

    @property
    def peak_high_peclet(self) -> float:
        """Highest rise, source fast, times the root of the Peclet number. []"""

    @property
    def mean_to_peak_high_peclet(self) -> float:
        """Mean rise over the highest where the source is fast. []"""


@dataclass(frozen=True, kw_only=True, slots=True)
class EllipticSource:
    """An elliptic patch of even flux, one axis along the sliding; round where both are equal.

    Parameters
    ----------
    half_length : float
        Half the axis along the sliding. [m]
    half_width : float
        Half the axis across it. [m]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    References
    ----------
    .. [1] H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 2nd ed., Oxford (1959), chapters 8 and 10.
    """

    half_length: float
    half_width: float

    def __post_init__(self) -> None:
        require_positive(half_length=self.half_length, half_width=self.half_width)

    @property
    def area(self) -> float:
        """Area of the patch. [m2]"""
        return float(np.pi * self.half_length * self.half_width)

    @property
    def peak_low_peclet(self) -> float:
        """Rise at the centre, source at rest. []"""
        short, long = sorted((self.half_length, self.half_width))
        return float(2 / np.pi * ellipk(1 - (short / long) ** 2) * short / self.half_length)

    @property
    def mean_low_peclet(self) -> float:
        """Mean rise, source at rest. []"""
        return float(_STILL_MEAN_OF_ELLIPSE * self.peak_low_peclet)

    @property
    def peak_high_peclet(self) -> float:
        """Highest rise, source fast, times the root of the Peclet number. []"""
        return _FAST_PEAK_OF_EVEN

    @property
    def mean_to_peak_high_peclet(self) -> float:
        """Mean rise over the highest where the source is fast. []"""
        return _FAST_MEAN_OF_ELLIPSE


@dataclass(frozen=True, kw_only=True, slots=True)
class HertzianSource:
    """An elliptic patch whose heat flux follows the pressure of Hertz: the parabolic source of Tian and Kennedy.

    Parameters
    ----------
    half_length : float
        Half the axis along the sliding. [m]
    half_width : float
        Half the axis across it. [m]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    Notes
    -----
    At rest the rise falls with the square of the distance from the centre, as the indentation under that pressure does.

    References
    ----------
    .. [1] X. Tian, F. E. Kennedy, J. Tribol. 116, 167 (1994). doi:10.1115/1.2927035
    .. [2] K. L. Johnson, Contact Mechanics, Cambridge (1985), section 3.5. doi:10.1017/CBO9781139171731
    """

    half_length: float
    half_width: float

    def __post_init__(self) -> None:
        require_positive(half_length=self.half_length, half_width=self.half_width)

    @property
    def area(self) -> float:
        """Area of the patch. [m2]"""
        return float(np.pi * self.half_length * self.half_width)

    @property
    def peak_low_peclet(self) -> float:
        """Rise at the centre, source at rest. []"""
        short, long = sorted((self.half_length, self.half_width))
        return float(3 / 4 * ellipk(1 - (short / long) ** 2) * short / self.half_length)

    @property
    def mean_low_peclet(self) -> float:
        """Mean rise, source at rest. []"""
        return _STILL_MEAN_OF_HERTZ * self.peak_low_peclet

    @property
    def peak_high_peclet(self) -> float:
        """Highest rise, source fast, times the root of the Peclet number. []"""
        return _FAST_PEAK_OF_HERTZ

    @property
    def mean_to_peak_high_peclet(self) -> float:
        """Mean rise over the highest where the source is fast. []"""
        return _FAST_MEAN_OF_HERTZ


@dataclass(frozen=True, kw_only=True, slots=True)
class RectangularSource:
    """A rectangular patch of even flux, one side along the sliding; square where both are equal.

    Parameters
    ----------
    half_length : float
        Half the side along the sliding. [m]
    half_width : float
        Half the side across it. [m]

    Raises
    ------
    InvalidInput
        If a value is not positive and finite.

    References
    ----------
    .. [1] J. C. Jaeger, J. Proc. R. Soc. N.S.W. 76, 203 (1942).
    """

    half_length: float
    half_width: float

    def __post_init__(self) -> None:
        require_positive(half_length=self.half_length, half_width=self.half_width)

    @property
    def area(self) -> float:
        """Area of the patch. [m2]"""
        return 4 * self.half_length * self.half_width

    @property
    def peak_low_peclet(self) -> float:
        """Rise at the centre, source at rest. []"""
        r = self.half_width / self.half_length
        return float(2 / np.pi * (r * np.arcsinh(1 / r) + np.arcsinh(r)))

    @property
    def mean_low_peclet(self) -> float:
        """Mean rise, source at rest. []"""
        r = self.half_width / self.half_length
        corner = (1 + r**3 - np.hypot(1, r) ** 3) / (3 * r)
        return float(2 / np.pi * (r * np.arcsinh(1 / r) + np.arcsinh(r) + corner))

    @property
    def peak_high_peclet(self) -> float:
        """Highest rise, source fast, times the root of the Peclet number. []"""
        return _FAST_PEAK_OF_EVEN

    @property
    def mean_to_peak_high_peclet(self) -> float:
        """Mean rise over the highest where the source is fast. []"""
        return _FAST_MEAN_OF_RECTANGLE
