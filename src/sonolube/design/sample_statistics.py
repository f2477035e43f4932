"""What many samples say of an outcome: mean, deviation and quantiles, each with how far it may be trusted."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import stdtrit

from sonolube.checks import Floats
from sonolube.errors import InvalidInput

QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
"""Shares below the quantiles that a spread states."""

_CONVERGED = 0.05


@dataclass(frozen=True, kw_only=True, slots=True)
class Estimated:
    """A number estimated from samples.

    Parameters
    ----------
    value : float
        The estimate.
    lower, upper : float
        Ends of its 95 % interval.
    """

    value: float
    lower: float
    upper: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Spread:
    """How an uncertain outcome is spread.

    Parameters
    ----------
    samples : int
        Samples that were asked for.
    found : int
        Those that have a result, and alone count.
    mean : Estimated
        The mean.
    deviation : Estimated
        The standard deviation.
    quantiles : mapping of float to Estimated
        By the share below.
    """

    samples: int
    found: int
    mean: Estimated
    deviation: Estimated
    quantiles: Mapping[float, Estimated]

    @property
    def relative_error(self) -> float:
        """Widest half interval of mean, 5, 50 and 95 % quantile, over the distance between the outer two."""
        told = (self.mean, *(self.quantiles[share] for share in (0.05, 0.5, 0.95)))
        width = self.quantiles[0.95].value - self.quantiles[0.05].value
        return max((each.upper - each.lower) / 2 for each in told) / width if width > 0 else 0.0

    @property
    def has_converged(self) -> bool:
        """Whether more samples would change no number by more than a twentieth of the spread."""
        return self.relative_error < _CONVERGED


def spread(outcomes: ArrayLike, *, stretch: NDArray[np.intp]) -> Spread:
    """Return how an outcome is spread over its samples.

    Parameters
    ----------
    outcomes : array_like, shape (samples,)
        NaN where there is no result.
    stretch : ndarray of int, shape (samples,)
        Which part of the samples each is of, all alike.

    Returns
    -------
    Spread

    Raises
    ------
    InvalidInput
        If fewer than two parts have at least two results.

    Notes
    -----
    Each number is of all samples together; its interval is Student's, from the scatter between the parts. Parts of a
    scrambled sequence complete each other, so that the interval is rather too wide.
    """
    values = np.asarray(outcomes, dtype=np.float64)
    parts = [values[(stretch == each) & np.isfinite(values)] for each in np.unique(stretch)]
    parts = [part for part in parts if part.size > 1]
    if len(parts) < 2:
        raise InvalidInput("hardly any sample has a result: uncertainty cannot be told")
    known = np.concatenate(parts)

    def estimated(statistic: Callable[[Floats], Any]) -> Estimated:
        value = float(statistic(known))
        each = np.array([statistic(part) for part in parts])
        half = float(stdtrit(len(parts) - 1, 0.975) * each.std(ddof=1) / np.sqrt(len(parts)))
        return Estimated(value=value, lower=value - half, upper=value + half)

    return Spread(
        samples=values.size,
        found=known.size,
        mean=estimated(np.mean),
        deviation=estimated(partial(np.std, ddof=1)),
        quantiles=MappingProxyType({share: estimated(partial(np.quantile, q=share)) for share in QUANTILES}),
    )
