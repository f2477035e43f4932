"""Figures of sweeps: friction over what was swept, whatever it was."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.design.figure_axes import even_ratios_as_logarithms, scaled_label
from sonolube.figure import COLOURS, LINES, MARKERS

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_OF = "friction_ratio"
_LABEL = "Friction ratio, with over without vibration"
_BESIDE = {
    "vibration_amplitude": "Amplitude",
    "actuator_power": "Power of the amplifier",
    "dissipated_power": "Power dissipated",
}
_MOST_TAKEN = 50_000  # points that quantiles are taken of
_MOST_DRAWN = 3_000  # of them that a panel can show
_FEW = 7  # values that are drawn as a curve each
_BINS = 20


def sweep_figure(swept: "xr.Dataset") -> "Figure":
    """Return friction over what was swept.

    Parameters
    ----------
    swept : xarray.Dataset
        As `sweep` returns it.

    Returns
    -------
    matplotlib.figure.Figure
        Over one key curves of friction, amplitude and powers; over a grid of two keys curves or a map; over more keys,
        or points drawn or listed, the friction ratio over each key, with median and 90 % of the points.
    """
    names = swept_names(swept)
    if swept[_OF].dims == ("point",) or len(names) > 2:
        return _clouds(swept, names)
    if len(names) == 1:
        return _curves(swept, names[0])
    few = [name for name in names if _is_text(swept, name) or swept[name].size <= _FEW]
    if few:
        family = min(few, key=lambda name: (not _is_text(swept, name), swept[name].size))
        return _families(swept, across=next(name for name in names if name != family), family=family)
    return _map(swept, *names)


def swept_names(swept: "xr.Dataset") -> list[str]:
    """Return the names, in a dataset, of the keys that a sweep ran over, in its order."""
    return [str(name) for name, array in swept.variables.items() if "key" in array.attrs]


def _curves(swept: "xr.Dataset", name: str) -> "Figure":
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.2, 4.6))
    grid = figure.subplots(2, 2, sharex=True)
    for axes, (of, short) in zip(grid.flat, {_OF: "Friction ratio", **_BESIDE}.items(), strict=True):
        values = swept[of].values
        scale, label = scaled_label(of, values)
        x = _across(axes, swept, name)
        line = "none" if _is_text(swept, name) else "-"
        axes.plot(x, scale * values, marker="o" if x.size <= 60 else "", markersize=3, linestyle=line)
        axes.set_ylabel(short + label[label.find(" [") :] if " [" in label else short)
    for axes in grid[0]:
        axes.set_xlabel("")
    return figure


def _families(swept: "xr.Dataset", *, across: str, family: str) -> "Figure":
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.6, 3.6))
    axes = figure.subplots()
    x = _across(axes, swept, across)
    ratio = swept[_OF].transpose(family, across).values
    told = _told(swept, family)
    for index, (row, label) in enumerate(zip(ratio, told, strict=True)):
        line, marker = LINES[index % len(LINES)], MARKERS[index % len(MARKERS)] if x.size <= 60 else ""
        axes.plot(x, row, color=COLOURS[index % len(COLOURS)], linestyle=line, marker=marker, ms=3, label=label)
    axes.set_ylabel(_LABEL)
    figure.legend(loc="outside right upper", title=_title(swept, family))
    return figure


def _map(swept: "xr.Dataset", across: str, up: str) -> "Figure":
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.2, 3.8))
    axes = figure.subplots()
    (x, label_x), (y, label_y) = (_placed(swept, name) for name in (across, up))
    ratio = swept[_OF].transpose(up, across).values
    filled = axes.contourf(x, y, ratio, levels=12, cmap="cividis")
    axes.set(xlabel=label_x, ylabel=label_y, xlim=(x.min(), x.max()), ylim=(y.min(), y.max()))
    axes.grid(visible=False)
    even_ratios_as_logarithms(axes, x)
    figure.colorbar(filled, ax=axes, label=_LABEL)
    return figure


def _clouds(swept: "xr.Dataset", names: list[str]) -> "Figure":
    from matplotlib.figure import Figure

    columns = min(len(names), 3)
    rows = -(-len(names) // columns)
    figure = Figure(figsize=(2.5 * columns + 0.7, 2.5 * rows + 0.4))
    grid = figure.subplots(rows, columns, squeeze=False, sharey=True)
    ratio = swept[_OF]
    shown = _some(ratio.size)
    places = dict(zip(ratio.dims, np.unravel_index(shown, ratio.shape), strict=True))
    y = ratio.values.ravel()[shown]
    drawn = np.random.default_rng(0).permutation(shown.size)[:_MOST_DRAWN]
    for axes, name in zip(grid.flat, names, strict=False):
        x = _across(axes, swept, name)[places[swept[name].dims[0]]]
        axes.plot(x[drawn], y[drawn], ".", color="0.7", markersize=2, alpha=0.6, rasterized=True, label="points")
        middle, low, median, high = _quantiles(x, y)
        axes.fill_between(middle, low, high, color=COLOURS[0], alpha=0.2, linewidth=0, label="90 % of them")
        axes.plot(middle, median, color=COLOURS[0], label="median")
    for axes in grid[:, 0]:
        axes.set_ylabel("Friction ratio")
    for axes in list(grid.flat)[len(names) :]:
        axes.set_axis_off()
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=3)
    return figure


def _quantiles(x: Floats, y: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return middles, and the ends and the middle of the values there: at each value of few, else in equal shares."""
    known = np.isfinite(y)
    x, y = x[known], y[known]
    if x.size == 0:
        return (np.empty(0),) * 4
    single = np.unique(x)
    if single.size <= 3 * _BINS:
        groups = [(value, y[x == value]) for value in single]
    else:
        parts = np.array_split(np.argsort(x), _BINS)
        groups = [(float(np.median(x[part])), y[part]) for part in parts]
    found = np.array([[value, *np.quantile(own, (0.05, 0.5, 0.95))] for value, own in groups])
    middle, low, median, high = found.T
    return middle, low, median, high


def _some(points: int) -> NDArray[np.intp]:
    """Return all places, or enough of them, drawn without regard to the grid."""
    if points <= _MOST_TAKEN:
        return np.arange(points)
    return np.unique(np.random.default_rng(0).integers(0, points, _MOST_TAKEN))


def _across(axes: "Axes", swept: "xr.Dataset", name: str) -> Floats:
    """Give an axes a swept key to run over, and return its values as they stand there."""
    x, label = _placed(swept, name)
    if _is_text(swept, name):
        words = list(dict.fromkeys(_told(swept, name)))
        axes.set_xticks(range(len(words)), words)
        axes.set_xlim(-0.5, len(words) - 0.5)
    else:
        even_ratios_as_logarithms(axes, x)
    axes.set_xlabel(label)
    return x


def _placed(swept: "xr.Dataset", name: str) -> tuple[Floats, str]:
    values = swept[name].values
    if _is_text(swept, name):
        words = list(dict.fromkeys(map(str, values)))
        return np.array([words.index(str(value)) for value in values], dtype=np.float64), _title(swept, name)
    scale, label = scaled_label(_word(swept, name), values)
    return scale * values, label


def _told(swept: "xr.Dataset", name: str) -> list[str]:
    if _is_text(swept, name):
        return [str(value).replace("_", " ") for value in swept[name].values]
    scale, label = scaled_label(_word(swept, name), swept[name].values)
    unit = label.partition("[")[2].rstrip("]")
    return [f"{scale * value:.4g} {unit}".strip() for value in swept[name].values]


def _title(swept: "xr.Dataset", name: str) -> str:
    return scaled_label(_word(swept, name), np.ones(1))[1].partition(" [")[0].capitalize()


def _word(swept: "xr.Dataset", name: str) -> str:
    return str(swept[name].attrs["key"]).rpartition(".")[2]


def _is_text(swept: "xr.Dataset", name: str) -> bool:
    return swept[name].dtype.kind not in "fiu"
