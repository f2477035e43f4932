"""Counts and extremes over the points of a dataset, and the power beyond which friction saturates."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative

if TYPE_CHECKING:
    import xarray as xr


def status_counts(points: "xr.Dataset") -> dict[str, int]:
    """Number of points of each status."""
    values, counts = np.unique(points["status"].values, return_counts=True)
    names = points["status"].attrs.get("flag_meanings", "").split()
    return {str(names[value] if names else value): int(count) for value, count in zip(values, counts, strict=True)}


def failure_counts(points: "xr.Dataset", *, outcome: str) -> dict[str, int]:
    """Number of points without a result, by the reason."""
    failed = np.isnan(points[outcome].values)
    reasons, counts = np.unique(points["reason"].values[failed], return_counts=True)
    if "reason_text" in points:
        reasons = points["reason_text"].values[reasons]
    return {str(reason): int(count) for reason, count in zip(reasons, counts, strict=True)}


def extreme_place(points: "xr.Dataset", *, outcome: str, highest: bool = False) -> int | None:
    """Flat index of the point at which an outcome is least or greatest.

    In row-major order; None where no point has a result.
    """
    values = points[outcome].values
    if np.isnan(values).all():
        return None
    return int((np.nanargmax if highest else np.nanargmin)(values))


def extreme_point(points: "xr.Dataset", *, outcome: str, highest: bool = False) -> "xr.Dataset | None":
    """Point at which an outcome is least or greatest.

    The dataset at that point; None where no point has a result.
    """
    place = extreme_place(points, outcome=outcome, highest=highest)
    if place is None:
        return None
    index = np.unravel_index(place, points[outcome].shape)
    return points.isel(dict(zip(points[outcome].dims, map(int, index), strict=True)))


SATURATION_GAIN = 0.05
"""Additional friction reduction per doubling of the power below which the reduction counts as saturated. []"""


def saturation_power(*, friction_reduction: ArrayLike, actuator_power: ArrayLike) -> Floats:
    r"""Power beyond which doubling it reduces friction by no more than another 0.05. [W]

    Parameters
    ----------
    friction_reduction : array_like, shape (..., n)
        Friction reduction at each power, NaN where it is unknown. []
    actuator_power : array_like, shape (n,)
        Amplifier powers, increasing. [W]

    Returns
    -------
    ndarray, shape (...)
        NaN where doubling gains more up to the last power, or gains less everywhere.

    Raises
    ------
    InvalidInput
        If a power is negative or not finite.

    Notes
    -----
    The largest root :math:`P` of

    .. math:: \mu_r(2P) - \mu_r(P) = 0.05

    with the friction reduction :math:`\mu_r` interpolated linearly over the power.

    Examples
    --------
    >>> import numpy as np
    >>> from sonolube.design import saturation_power
    >>> power = np.linspace(0, 10, 1001)
    >>> round(float(saturation_power(friction_reduction=1 - np.exp(-power), actuator_power=power)), 2)
    2.94
    """
    power = require_non_negative(actuator_power=actuator_power)
    rows = np.asarray(friction_reduction, dtype=np.float64)
    lower = np.unique(np.concatenate([power, power / 2]))
    lower = lower[(lower >= power[0]) & (2 * lower <= power[-1])]
    saturation = np.full(rows.shape[:-1], np.nan)
    for index in np.ndindex(saturation.shape):
        excess = np.interp(2 * lower, power, rows[index]) - np.interp(lower, power, rows[index]) - SATURATION_GAIN
        above = np.flatnonzero(excess > 0)
        if above.size and above[-1] + 1 < lower.size and np.isfinite(excess).all():
            last = int(above[-1])
            fraction = excess[last] / (excess[last] - excess[last + 1])
            saturation[index] = lower[last] + fraction * (lower[last + 1] - lower[last])
    return saturation
