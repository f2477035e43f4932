"""Maps of measured runs: a Gaussian process through scattered points, with its uncertainty."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import minimize

from sonolube.checks import Floats, require_finite, require_non_negative
from sonolube.errors import InvalidInput

_FEWEST = 6
_BOUNDS = ((-2.5, 2.5), (-2.5, 2.5), (-7.0, 1.0), (-12.0, 0.0))  # logarithms: both ranges, variance, noise
_STARTS = ((0.0, 0.0, -2.0, -6.0), (-1.0, 0.5, -2.0, -8.0), (0.5, -1.0, -3.0, -5.0))


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MeasuredMap:
    """Friction reduction between measured runs.

    Parameters
    ----------
    friction_reduction : ndarray, shape (...)
        Most likely value at each place. []
    friction_reduction_uncertainty : ndarray, shape (...)
        Its standard uncertainty, what scatters from run to run not included. []
    scatter : float
        Standard deviation of a run about the map, as the runs themselves show it.
    leave_one_out_error : float
        Root mean square of what the map misses a run by that it was not shown.
    """

    friction_reduction: Floats
    friction_reduction_uncertainty: Floats
    scatter: float
    leave_one_out_error: float


def measured_map(
    *,
    runs: ArrayLike,
    friction_reduction: ArrayLike,
    places: ArrayLike,
    friction_reduction_uncertainty: ArrayLike = 0.0,
) -> MeasuredMap:
    """Return friction reduction at any places between measured runs.

    Parameters
    ----------
    runs : array_like, shape (n, 2)
        Both coordinates of each run, such as sliding speed and power; six runs or more.
    friction_reduction : array_like, shape (n,)
        What each run measured. []
    places : array_like, shape (..., 2)
        Where to interpolate.
    friction_reduction_uncertainty : array_like, shape () or (n,)
        Standard uncertainty of each run. []

    Returns
    -------
    MeasuredMap

    Raises
    ------
    InvalidInput
        If there are too few runs, shapes do not match, all runs agree in a coordinate, or a value is not finite.

    Notes
    -----
    A Gaussian process of constant mean and squared-exponential covariance, one range to a coordinate, its ranges,
    variance and scatter those of the highest likelihood of the runs. Far from all runs it returns to their mean, with
    the uncertainty of all of them.

    References
    ----------
    .. [1] C. E. Rasmussen, C. K. I. Williams, Gaussian Processes for Machine Learning, MIT Press (2006), equations
       2.25, 2.26, 5.8 and 5.12.
    """
    z = require_finite(friction_reduction=friction_reduction)
    told = require_non_negative(friction_reduction_uncertainty=friction_reduction_uncertainty)
    x, at = (np.asarray(array, dtype=np.float64) for array in (runs, places))
    if (
        x.ndim != 2
        or x.shape[1] != 2
        or at.shape[-1:] != (2,)
        or z.shape != x.shape[:1]
        or told.shape not in ((), z.shape)
    ):
        raise InvalidInput(
            f"runs and places must be pairs, one reduction to a run, got shapes {x.shape}, {at.shape}, {z.shape}"
        )
    if not (np.isfinite(x).all() and np.isfinite(at).all()):
        raise InvalidInput("runs and places must be finite")
    if z.size < _FEWEST:
        raise InvalidInput(f"a map needs {_FEWEST} runs or more, got {z.size}")
    centre, width = x.mean(axis=0), x.std(axis=0)
    if not np.all(width > 0):
        raise InvalidInput("all runs agree in a coordinate: a map needs runs that differ in both")
    x, at = (x - centre) / width, (at - centre) / width
    noise = np.broadcast_to(told**2, z.shape)
    fits = [minimize(_unlikelihood, start, args=(x, z, noise), method="L-BFGS-B", bounds=_BOUNDS) for start in _STARTS]
    found = min(fits, key=lambda fit: float(fit.fun)).x
    inverse = np.linalg.inv(_covariance(found, x, noise))
    ones = np.ones(z.size)
    mean = float(ones @ inverse @ z / (ones @ inverse @ ones))
    weights = inverse @ (z - mean)
    flat = at.reshape(-1, 2)
    near = _kernel(found, flat, x)
    left = 1 - near @ inverse @ ones
    variance = np.exp(found[2]) - np.einsum("ij,jk,ik->i", near, inverse, near) + left**2 / (ones @ inverse @ ones)
    reduced = inverse - np.outer(inverse @ ones, ones @ inverse) / (ones @ inverse @ ones)
    missed = (reduced @ z) / np.diag(reduced)
    shape = at.shape[:-1]
    return MeasuredMap(
        friction_reduction=(mean + near @ weights).reshape(shape),
        friction_reduction_uncertainty=np.sqrt(np.maximum(variance, 0.0)).reshape(shape),
        scatter=float(np.exp(found[3] / 2)),
        leave_one_out_error=float(np.sqrt(np.mean(missed**2))),
    )


def _kernel(logs: Floats, a: Floats, b: Floats) -> Floats:
    apart = (a[:, np.newaxis] - b) / np.exp(logs[:2])
    return np.asarray(np.exp(logs[2] - 0.5 * np.sum(apart**2, axis=-1)))


def _covariance(logs: Floats, x: Floats, noise: Floats) -> Floats:
    return _kernel(logs, x, x) + np.diag(noise + np.exp(logs[3]))


def _unlikelihood(logs: Floats, x: Floats, z: Floats, noise: Floats) -> float:
    factor = cho_factor(_covariance(logs, x, noise), lower=True)
    ones = np.ones(z.size)
    shares = cho_solve(factor, ones)
    deviation = z - (shares @ z) / (shares @ ones)
    return float(0.5 * deviation @ cho_solve(factor, deviation) + np.sum(np.log(np.diag(factor[0]))))
