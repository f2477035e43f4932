"""Caveats on samples far beyond all others of their channel, as a lost bit leaves them, and on missing ones."""

import numpy as np

from sonolube.checks import Floats

_MOST = 3  # samples of a channel that can be damaged; more are a signal
_REACH = 20.0  # distance from the median over the largest of all other samples
_FEWEST = 20  # samples of a channel of which one can be judged
_SET_POINT = "_set"  # end of the names of set points, which are unknown before they are set


def damaged_sample_caveats(name: str, values: Floats, *, unit: str, axis: Floats, axis_label: str) -> tuple[str, ...]:
    """Caveat for every sample of a channel that lies far beyond all others.

    Empty where more than three samples lie out, or none lies 20 times as far from the median as all the others:
    impacts, switches and starts of a drive are signals. Empty, too, for a channel that is constant but for them, such
    as a trigger.
    """
    known = np.flatnonzero(np.isfinite(values))
    if known.size < _FEWEST:
        return ()
    with np.errstate(over="ignore"):
        distance = np.abs(values[known] - np.median(values[known]))
    ordered = np.sort(distance)
    count = next((k for k in range(1, _MOST + 1) if ordered[-k] > _REACH * ordered[-k - 1] > 0), 0)
    if not count:
        return ()
    return tuple(
        f"{name} is {values[place]:.3g} {unit} at {axis_label} = {axis[place]:.6g}, {_REACH:g} times or more as far"
        " from its median as every other sample: a damaged sample, which each mean contains; leave its line out"
        for place in known[np.sort(np.argsort(distance)[-count:])]
    )


def missing_sample_caveat(name: str, values: Floats, *, axis: Floats, axis_label: str) -> tuple[str, ...]:
    """Caveat for a channel that misses samples, with the first of them or the end of its column.

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
