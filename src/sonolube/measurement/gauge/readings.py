"""Validated displacement and force readings of a force gauge, and the direction of a displacement history."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats, require_finite
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.measurement.time_series import require_equal_length

_REVERSAL = 0.02  # of the range, by which the displacement must return for a reversal
_RANGE_TOLERANCE = 1e-9  # of the range


def loading_mask(x: Floats) -> NDArray[np.bool_]:
    """Where a displacement is on a loading branch, with hysteresis against small reversals; shape (samples,)."""
    threshold = _REVERSAL * float(np.ptp(x))
    rising = np.empty(x.size, dtype=np.bool_)
    up, extreme, since = True, x[0], 0
    for at, value in enumerate(x.tolist()):
        if (value >= extreme) if up else (value <= extreme):
            extreme, since = value, at
        elif abs(value - extreme) > threshold:
            rising[since:at] = not up
            up, extreme, since = not up, value, at
        rising[at] = up
    return rising


def require_calibrated_range(*, displacement: ArrayLike, lowest: float, highest: float) -> Floats:
    """Displacements as a one-dimensional array; refuse any outside the calibrated range; shape (samples,)."""
    x = np.atleast_1d(require_finite(displacement=displacement))
    if x.ndim != 1:
        raise InvalidInput(f"displacement must be one-dimensional, got shape {x.shape}")
    tolerance = _RANGE_TOLERANCE * (highest - lowest)
    outside = (x < lowest - tolerance) | (x > highest + tolerance)
    if outside.any():
        raise OutsideRange(
            f"displacement must lie between {lowest:.6g} and {highest:.6g} m, where it was calibrated,"
            f" got {float(x[outside][0]):.6g} m"
        )
    return x


def require_readings(*, displacement: ArrayLike, applied_force: ArrayLike) -> tuple[Floats, Floats]:
    """Displacement and force as one-dimensional arrays of equal length; shape (samples,)."""
    x, force = require_finite(displacement=displacement), require_finite(applied_force=applied_force)
    require_equal_length(displacement=x, applied_force=force)
    return x, force


def require_calibration_readings(*, displacement: ArrayLike, applied_force: ArrayLike) -> tuple[Floats, Floats]:
    """Displacement and force of a calibration as one-dimensional arrays of equal length; shape (samples,)."""
    x, force = require_readings(displacement=displacement, applied_force=applied_force)
    if x.size < 2 or np.ptp(x) == 0:
        raise InvalidInput("displacement does not vary")
    return x, force
