"""Patches on a half-space that take up heat evenly, and the two limits of how hot they get."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.special import beta, ellipk

from sonolube.checks import require_positive

_FAST_MEAN_OF_RECTANGLE = 2 / 3  # mean of sqrt(x) over its end value
_FAST_MEAN_OF_ELLIPSE = float(4 / (3 * np.pi) * beta(1 / 2, 7 / 4))  # the same over all chords
_STILL_MEAN_OF_ELLIPSE = 8 / (3 * np.pi)  # of any ellipse: mean and centre scale alike with the axes


class HeatSource(Protocol):
    """A patch of even heat flux on a half-space; rises are in units of flux times `half_length` over conductivity."""

    @property
    def half_length(self) -> float:
        """Half the length along the sliding. [m]"""

    @property
    def area(self) -> float:
        """Area of the patch. [m2]"""

    @property
    def still_peak(self) -> float:
        """Rise at the centre, source at rest. []"""

    @property
    def still_mean(self) -> float:
        """Mean rise, source at rest. []"""

    @property
    def fast_mean_share(self) -> float:
        """Mean rise over the highest where the source is fast. []"""


@dataclass(frozen=True, kw_only=True, slots=True)
class EllipticSource:
    """An elliptic patch, one axis along the sliding; round where both are equal.

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
    def still_peak(self) -> float:
        """Rise at the centre, source at rest. []"""
        short, long = sorted((self.half_length, self.half_width))
        return float(2 / np.pi * ellipk(1 - (short / long) ** 2) * short / self.half_length)

    @property
    def still_mean(self) -> float:
        """Mean rise, source at rest. []"""
        return float(_STILL_MEAN_OF_ELLIPSE * self.still_peak)

    @property
    def fast_mean_share(self) -> float:
        """Mean rise over the highest where the source is fast. []"""
        return _FAST_MEAN_OF_ELLIPSE


@dataclass(frozen=True, kw_only=True, slots=True)
class RectangularSource:
    """A rectangular patch, one side along the sliding; square where both are equal.

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
    def still_peak(self) -> float:
        """Rise at the centre, source at rest. []"""
        r = self.half_width / self.half_length
        return float(2 / np.pi * (r * np.arcsinh(1 / r) + np.arcsinh(r)))

    @property
    def still_mean(self) -> float:
        """Mean rise, source at rest. []"""
        r = self.half_width / self.half_length
        corner = (1 + r**3 - np.hypot(1, r) ** 3) / (3 * r)
        return float(2 / np.pi * (r * np.arcsinh(1 / r) + np.arcsinh(r) + corner))

    @property
    def fast_mean_share(self) -> float:
        """Mean rise over the highest where the source is fast. []"""
        return _FAST_MEAN_OF_RECTANGLE
