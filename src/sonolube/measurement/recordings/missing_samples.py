"""Caveats on samples that a channel misses, as NaN or a column that ends early leave them."""

import numpy as np

from sonolube.checks import Floats

_SET_POINT = "_set"  # end of the names of set points, which are unknown before they are set


def missing_sample_caveat(name: str, values: Floats, *, axis: Floats, axis_label: str) -> tuple[str, ...]:
    """Return a caveat for a channel that misses samples, with the first of them or the end of its column.

    Parameters
    ----------
    name : str
        Of the channel.
    values : ndarray, shape (samples,)
        Of the channel; missing ones are NaN.
    axis : ndarray, shape (samples,)
        Time or revolutions.
    axis_label : str
        Name and unit of the axis, such as "time [s]".

    Returns
    -------
    tuple of str
        Empty where none is missing, and for set points.
    """
    missing = np.flatnonzero(~np.isfinite(values))
    if not missing.size or name.endswith(_SET_POINT):
        return ()
    if missing.size == values.size:
        return (f"{name} holds no value",)
    first = missing[0]
    if missing.size == values.size - first:
        where = f"ends at {axis_label} = {axis[first - 1]:.6g}, before the recording"
    else:
        where = f"misses {missing.size} of {values.size} samples, the first at {axis_label} = {axis[first]:.6g}"
    return (f"{name} {where}: numbers are of the others",)
