"""Sobol's indices: how much of an outcome's variance each uncertain input brings, alone and with the others."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput

STRETCHES = 16
"""Parts of a sequence of which each fills the cube, so that their scatter tells how far to trust the whole."""

_INSIDE = 2.0**-54  # keeps points off 0, where a normal distribution has no quantile
_FEWEST = 32
_INTERVAL = (0.025, 0.975)
_RESAMPLES_AT_ONCE = 4_000_000  # numbers; bounds the memory


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SobolIndices:
    """Shares of the variance of an outcome by input.

    Parameters
    ----------
    first : ndarray, shape (inputs,)
        Share that would go, on average, were the input known.
    total : ndarray, shape (inputs,)
        Share that would stay, were all others known; above `first` where inputs act together.
    first_interval, total_interval : ndarray, shape (inputs, 2)
        Intervals of 95 %, by bootstrap.
    standard_deviation : float
        Of the outcome.
    rows : int
        Rows that entered.
    """

    first: Floats
    total: Floats
    first_interval: Floats
    total_interval: Floats
    standard_deviation: float
    rows: int


def sobol_points(inputs: int, *, samples: int, seed: int = 0) -> tuple[Floats, NDArray[np.intp]]:
    """Return points spread evenly over the unit cube: Sobol's sequence, scrambled.

    Parameters
    ----------
    inputs : int
        Dimensions of the cube.
    samples : int
        How many are wanted; taken up to the next power of two.
    seed : int
        Of the scrambling.

    Returns
    -------
    points : ndarray, shape (samples, inputs)
        Strictly inside the cube.
    stretch : ndarray of int, shape (samples,)
        Which sixteenth of the sequence each point is of; each fills the cube on its own.

    Raises
    ------
    InvalidInput
        If there are no inputs, or fewer than 32 samples.

    References
    ----------
    .. [1] A. B. Owen, J. Complexity 14, 466 (1998). doi:10.1006/jcom.1998.0487
    """
    if inputs < 1:
        raise InvalidInput("inputs must be at least 1")
    if samples < _FEWEST:
        raise InvalidInput(f"samples must be at least {_FEWEST}, got {samples}")
    power = int(np.ceil(np.log2(samples)))
    from scipy.stats import qmc

    points = qmc.Sobol(d=inputs, rng=np.random.default_rng(seed)).random_base2(power)
    return np.clip(points, _INSIDE, 1 - _INSIDE), np.repeat(np.arange(STRETCHES), 2**power // STRETCHES)


def saltelli_points(inputs: int, *, samples: int, seed: int = 0) -> tuple[Floats, NDArray[np.intp]]:
    """Return the points at which an outcome must be known for Sobol's indices.

    Parameters
    ----------
    inputs : int
        Inputs of the outcome.
    samples : int
        Rows of each block; taken up to the next power of two.
    seed : int
        Of the scrambling.

    Returns
    -------
    points : ndarray, shape (inputs + 2, samples, inputs)
        Two independent blocks, then the first with one column after the other from the second.
    stretch : ndarray of int, shape (samples,)
        Which sixteenth of the sequence each row is of.

    Raises
    ------
    InvalidInput
        If there are no inputs, or fewer than 32 samples.

    References
    ----------
    .. [1] A. Saltelli et al., Comput. Phys. Commun. 181, 259 (2010). doi:10.1016/j.cpc.2009.09.018
    """
    both, stretch = sobol_points(2 * inputs, samples=samples, seed=seed)
    first, second = both[:, :inputs], both[:, inputs:]
    mixed = np.repeat(first[np.newaxis], inputs, axis=0)
    for each in range(inputs):
        mixed[each, :, each] = second[:, each]
    return np.concatenate([first[np.newaxis], second[np.newaxis], mixed]), stretch


def sobol_indices(outcomes: ArrayLike, *, resamples: int = 1000, seed: int = 0) -> SobolIndices:
    """Return Sobol's indices from an outcome at `saltelli_points`.

    Parameters
    ----------
    outcomes : array_like, shape (inputs + 2, samples)
        One row to each block; a column in which any is NaN is left out.
    resamples : int
        Of the bootstrap.
    seed : int
        Of the bootstrap.

    Returns
    -------
    SobolIndices
        All zero where the outcome never varies.

    Raises
    ------
    InvalidInput
        If fewer than 32 columns are left.

    Notes
    -----
    First indices by Saltelli's estimator about the mean, total ones by Jansen's, which is never negative. [1]_ [2]_
    Inputs must be independent. Columns are drawn again as if they were random; as they fill the cube more evenly than
    that, intervals are rather too wide.

    References
    ----------
    .. [1] M. J. W. Jansen, Comput. Phys. Commun. 117, 35 (1999). doi:10.1016/S0010-4655(98)00154-4
    .. [2] A. Saltelli et al., Comput. Phys. Commun. 181, 259 (2010). doi:10.1016/j.cpc.2009.09.018
    """
    known = np.asarray(outcomes, dtype=np.float64)
    known = known[:, np.all(np.isfinite(known), axis=0)]
    rows = known.shape[1]
    if rows < _FEWEST:
        raise InvalidInput(f"indices need at least {_FEWEST} rows with a result, got {rows}")
    terms = _terms(known)
    first, total, variance = _indices(terms.mean(axis=1))
    random = np.random.default_rng(seed)
    drawn, step = [], max(1, _RESAMPLES_AT_ONCE // rows)
    for start in range(0, resamples, step):
        counts = random.multinomial(rows, np.full(rows, 1 / rows), size=min(step, resamples - start))
        drawn.append(np.stack(_indices(terms @ counts.T / rows)[:2]))
    low, high = np.quantile(np.concatenate(drawn, axis=-1), _INTERVAL, axis=-1)
    return SobolIndices(
        first=first,
        total=total,
        first_interval=np.stack([low[0], high[0]], axis=-1),
        total_interval=np.stack([low[1], high[1]], axis=-1),
        standard_deviation=float(np.sqrt(variance)),
        rows=rows,
    )


def _terms(known: Floats) -> Floats:
    """Return for each row of samples what the indices are means of: outcomes, squares, and the products per input."""
    a, b, mixed = known[0], known[1], known[2:]
    centre = (a.mean() + b.mean()) / 2
    a, b, mixed = a - centre, b - centre, mixed - centre
    return np.concatenate([[(a + b) / 2, (a**2 + b**2) / 2], b * (mixed - a), (a - mixed) ** 2 / 2])


def _indices(means: Floats) -> tuple[Floats, Floats, Floats]:
    """Return first and total indices, and the variance, from the means of the terms."""
    variance = np.maximum(means[1] - means[0] ** 2, 0.0)
    both = np.divide(means[2:], variance, out=np.zeros_like(means[2:]), where=variance > 0)
    return both[: len(both) // 2], both[len(both) // 2 :], variance
