"""Figure of the channels of a run over time, each as the range of its samples."""

from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.figure import COLOURS, subplots
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_POINTS: Final = 1500  # along the axis, more than a page resolves
_WIDTH: Final = 7.0  # inch
_HEIGHT: Final = 1.4  # inch, of a channel


def channels_figure(recording: "xr.Dataset") -> "Figure":
    """Figure of all channels of a recording, one below the other.

    Parameters
    ----------
    recording : xarray.Dataset
        Over `time`.

    Returns
    -------
    matplotlib.figure.Figure
    """
    names = list(map(str, recording.data_vars))
    time = recording["time"].to_numpy()
    begins = np.unique(np.linspace(0, time.size, min(_POINTS, time.size), endpoint=False).astype(np.int64))
    figure, grid = subplots(len(names), 1, sharex=True, squeeze=False, figsize=(_WIDTH, 0.6 + _HEIGHT * len(names)))
    for axes, name in zip(grid[:, 0], names, strict=True):
        values = recording[name].to_numpy()
        low, high = np.fmin.reduceat(values, begins), np.fmax.reduceat(values, begins)
        axes.fill_between(time[begins], low, high, step="post", color=COLOURS[0], linewidth=0.8)
        known = quantities().get(name)
        symbol = name.replace("_", " ") if known is None else known.meaning.split(",")[0]
        axes.set_ylabel(f"{symbol}\n[{recording[name].attrs.get('units', '1')}]")
    grid[-1, 0].set_xlabel("time [s]")
    figure.align_ylabels()
    return figure
