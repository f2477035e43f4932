"""Truncated probability distributions of uncertain parameters: normal, lognormal and uniform."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive, require_within
from sonolube.errors import InvalidInput

_MAX_CUT = 0.5


@dataclass(frozen=True, kw_only=True, slots=True)
class Normal:
    """Normal distribution.

    Parameters
    ----------
    middle : float
        Its mean.
    deviation : float
        Its standard deviation.
    """

    middle: float
    deviation: float

    def __post_init__(self) -> None:
        require_positive(deviation=self.deviation)

    def below(self, value: ArrayLike) -> Floats:
        """Cumulative probability at a value. []"""
        from scipy.special import ndtr

        return np.asarray(ndtr((np.asarray(value) - self.middle) / self.deviation))

    def quantile(self, share: ArrayLike) -> Floats:
        """Quantile of a probability."""
        from scipy.special import ndtri

        return np.asarray(self.middle + self.deviation * ndtri(share))


@dataclass(frozen=True, kw_only=True, slots=True)
class LogNormal:
    """Lognormal distribution: the logarithm is normal.

    Parameters
    ----------
    median : float
        The value of which half lies on either side.
    factor : float
        Geometric standard deviation: 68 % lies between the median over it and the median times it.
    """

    median: float
    factor: float

    def __post_init__(self) -> None:
        require_positive(median=self.median)
        if not 1 < self.factor < math.inf:
            raise InvalidInput(f"factor must be above 1, got {self.factor:g}")

    def below(self, value: ArrayLike) -> Floats:
        """Cumulative probability at a value. []"""
        from scipy.special import ndtr

        with np.errstate(divide="ignore"):
            return np.asarray(ndtr(np.log(np.maximum(value, 0) / self.median) / math.log(self.factor)))

    def quantile(self, share: ArrayLike) -> Floats:
        """Quantile of a probability."""
        from scipy.special import ndtri

        return np.asarray(self.median * np.exp(math.log(self.factor) * ndtri(share)))


@dataclass(frozen=True, kw_only=True, slots=True)
class Uniform:
    """Uniform distribution between two ends.

    Parameters
    ----------
    low, high : float
        The ends.
    """

    low: float
    high: float

    def __post_init__(self) -> None:
        if not -math.inf < self.low < self.high < math.inf:
            raise InvalidInput(f"the lower end, {self.low:g}, must lie below the upper one, {self.high:g}, both finite")

    def below(self, value: ArrayLike) -> Floats:
        """Cumulative probability at a value. []"""
        return np.clip((np.asarray(value) - self.low) / (self.high - self.low), 0.0, 1.0)

    def quantile(self, share: ArrayLike) -> Floats:
        """Quantile of a probability."""
        return self.low + (self.high - self.low) * np.asarray(share, dtype=np.float64)


Law = Normal | LogNormal | Uniform
"""Continuous probability distribution of one number."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Distribution:
    """Distribution of an uncertain parameter: a law truncated to the possible range of the parameter.

    Parameters
    ----------
    law : Normal, LogNormal or Uniform
    lowest, highest : float
        Ends of what the parameter can be; what the law puts beyond is spread over the rest in proportion.
    text : str
        The law in words.

    Raises
    ------
    InvalidInput
        If more than half of the law lies beyond the ends.
    """

    law: Law
    lowest: float = -math.inf
    highest: float = math.inf
    text: str = ""

    def __post_init__(self) -> None:
        if self.truncated_fraction > _MAX_CUT:
            raise InvalidInput(
                f"{self.truncated_fraction:.0%} lies outside {self.lowest:g} to {self.highest:g}, the possible"
            )

    @property
    def truncated_fraction(self) -> float:
        """Probability of the law beyond the ends of the range. []"""
        low, high = self.law.below((self.lowest, self.highest))
        return float(low + 1 - high)

    def quantile(self, share: ArrayLike) -> Floats:
        """Quantile of a probability.

        Parameters
        ----------
        share : array_like, any shape
            Between 0 and 1.

        Returns
        -------
        ndarray, shape of `share`
        """
        low, high = self.law.below((self.lowest, self.highest))
        found = self.law.quantile(low + (high - low) * require_within(0.0, 1.0, share=share))
        return np.clip(found, self.lowest, self.highest)
