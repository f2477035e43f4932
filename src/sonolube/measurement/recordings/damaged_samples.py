"""Caveats on single samples far beyond all others of their channel, as a damaged line or a lost bit leaves them."""

import numpy as np

from sonolube.checks import Floats

_MOST = 3  # samples of a channel that can be damaged; more are a signal
_REACH = 20.0  # distance from the median over the largest of all other samples
_FEWEST = 20  # samples of a channel of which one can be judged


def damaged_sample_caveats(name: str, values: Floats, *, unit: str, axis: Floats, axis_label: str) -> tuple[str, ...]:
    """Return a caveat for every sample of a channel that lies far beyond all others.

    Parameters
    ----------
    name : str
        Of the channel.
    values : ndarray, shape (samples,)
        Of the channel; missing ones are NaN.
    unit : str
        Their unit.
    axis : ndarray, shape (samples,)
        Time or revolutions.
    axis_label : str
        Name and unit of the axis, such as "time [s]".

    Returns
    -------
    tuple of str
        Empty where more than three samples lie out, or none lies 20 times as far from the median as all the others:
        impacts, switches and starts of a drive are signals. Empty, too, for a channel that is constant but for them,
        such as a trigger.
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
