"""Covariance of a reading's noise along the sliding distance, beside any smooth course of it."""

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from sonolube.checks import Floats

_COURSES = (0.05, 0.1, 0.2, 0.4, 1.0)  # distances of relaxation over that of the run
_SHARES = (0.0, 0.2, 0.5, 0.8)  # of the variance, that wander slowly
_LENGTHS = (0.03, 0.1, 0.3)  # of this wander over the distance of the run
_SCALES = (1e-3, 1e2)  # limits of relaxation distances over that of the run; beyond, courses no longer change
_EXPONENTS = (0.1, 8.0)
_CAUTION = 1e-9


def relaxation(distance: Floats, *, reach: Floats, exponent: Floats | float = 1.0) -> Floats:
    """Course from 0 on the fresh track to 1 at the end of the run, a row for each relaxation distance S and exponent n.

    (1 - exp(-(s/S)^n))/(1 - exp(-(s_end/S)^n)).
    """
    scale = np.clip(np.asarray(reach)[..., None] / distance[-1], *_SCALES)
    power = np.clip(np.asarray(exponent)[..., None], *_EXPONENTS)
    slid = distance / distance[-1]
    return np.asarray(np.expm1(-((slid / scale) ** power)) / np.expm1(-((1 / scale) ** power)))


def noise_covariance(distance: Floats, values: Floats, uncertainty: Floats | None) -> Floats:
    """Covariance of white and slowly wandering noise by restricted maximum likelihood, shape (readings, readings).

    The course of the reading beside it is a constant, a relaxation and its square, so that the noise is the same under
    every hypothesis. Stated standard uncertainties are a lower limit of the white part.
    """
    weights = np.ones(values.size) if uncertainty is None else uncertainty**2 / np.mean(uncertainty**2)
    gaps = np.abs(np.subtract.outer(distance, distance)) / distance[-1]
    white = np.diag(weights)
    wandering = [(share, length) for share in _SHARES[1:] for length in _LENGTHS]
    shapes = [white, *((1 - share) * white + share * np.exp(-gaps / length) for share, length in wandering)]
    shares = [0.0, *(share for share, _ in wandering)]
    courses = relaxation(distance, reach=distance[-1] * np.array(_COURSES))
    designs = [np.column_stack([np.ones(values.size), c, c**2]) for c in courses]
    found = [(*_restricted(values, design, shape), index) for index, shape in enumerate(shapes) for design in designs]
    _, variance, index = max(found)
    floor = 0.0 if uncertainty is None else float(np.mean(uncertainty**2))
    variance = max(variance, floor / (1 - shares[index]), (_CAUTION * float(np.abs(values).max())) ** 2, 1e-300)
    return np.asarray(variance * shapes[index])


def _restricted(values: Floats, design: Floats, shape: Floats) -> tuple[float, float]:
    """Logarithm of the restricted likelihood at its best variance, and that variance."""
    factor = cho_factor(shape, lower=True)
    solved = cho_solve(factor, design)
    normal = design.T @ solved + 1e-12 * np.eye(design.shape[1])
    rest = values - design @ np.linalg.solve(normal, solved.T @ values)
    freedom = values.size - design.shape[1]
    variance = max(float(rest @ cho_solve(factor, rest)) / freedom, 1e-300)
    log_determinants = 2 * np.log(np.diag(factor[0])).sum() + np.linalg.slogdet(normal)[1]
    return -0.5 * float(freedom * np.log(variance) + log_determinants), variance
