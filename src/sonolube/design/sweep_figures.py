"""Figures of parameter sweeps: curves, families, contour maps or scatter of friction over the swept keys."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.design.figure_axes import scaled_label, set_log_scale_if_geometric
from sonolube.figure import COLOURS, LINES, MARKERS

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_OUTCOME = "friction_ratio"
_OUTCOME_LABEL = "Friction ratio, with over without vibration"
_FURTHER_OUTCOMES = {
    "vibration_amplitude": "Amplitude",
    "actuator_power": "Power of the amplifier",
    "dissipated_power": "Power dissipated",
}
_MOST_SAMPLED = 50_000  # points from which quantiles are computed
_MOST_DRAWN = 3_000  # of these, drawn in a panel
_FAMILY_SIZE = 7  # values up to which each is drawn as a curve of its own
_BINS = 20
_MOST_MARKED = 60  # points of a curve up to which each has a marker


def sweep_figure(swept: "xr.Dataset") -> "Figure":
    """Friction ratio over the swept keys.

    Parameters
    ----------
    swept : xarray.Dataset
        Result of `sweep`.

    Returns
    -------
    matplotlib.figure.Figure
        For one key curves of friction ratio, amplitude and powers; for a grid of two keys a family of curves or a
        contour map; for more keys, and for points of a list or a Latin hypercube, the scatter of the friction ratio
        over each key, with its median and 90 % range.
    """
    names = swept_variables(swept)
    if swept[_OUTCOME].dims == ("point",) or len(names) > 2:
        return _scatter(swept, names)
    if len(names) == 1:
        return _curves(swept, names[0])
    few = [name for name in names if _is_text(swept, name) or swept[name].size <= _FAMILY_SIZE]
    if few:
        family = min(few, key=lambda name: (not _is_text(swept, name), swept[name].size))
        return _family_of_curves(swept, x_name=next(name for name in names if name != family), family=family)
    return _contour_map(swept, *names)


def swept_variables(swept: "xr.Dataset") -> list[str]:
    """Names of the coordinates of a sweep that are swept keys, in the order of the plan.

    Parameters
    ----------
    swept : xarray.Dataset
        Result of `sweep`.

    Returns
    -------
    list of str
    """
    return [str(name) for name, array in swept.variables.items() if "key" in array.attrs]


def _curves(swept: "xr.Dataset", name: str) -> "Figure":
    """Curves of friction ratio, amplitude and powers over one key, a panel for each that is known."""
    from matplotlib.figure import Figure

    every = {_OUTCOME: "Friction ratio", **_FURTHER_OUTCOMES}
    swept_quantity = str(swept[name].attrs["key"]).rpartition(".")[2]
    known = [
        outcome
        for outcome in every
        if outcome == _OUTCOME or (outcome != swept_quantity and np.isfinite(swept[outcome].values).any())
    ]
    columns = min(len(known), 2)
    rows = -(-len(known) // columns)
    figure = Figure(figsize=(7.2 if columns > 1 else 5.2, 2.3 * rows if columns > 1 else 3.4))
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes, outcome in zip(grid.flat, known, strict=False):
        values = swept[outcome].values
        scale, label = scaled_label(outcome, values)
        x = _set_x_axis(axes, swept, name)
        line = "none" if _is_text(swept, name) else "-"
        marker = "o" if x.size <= _MOST_MARKED else ""
        axes.plot(x, scale * values, marker=marker, markersize=3, linestyle=line)
        axes.set_ylabel(every[outcome] + label[label.find(" [") :] if " [" in label else every[outcome])
    for axes in list(grid.flat)[len(known) :]:
        axes.set_axis_off()
    unknown = [title.lower() for outcome, title in every.items() if outcome not in (*known, swept_quantity)]
    if unknown:
        figure.supxlabel(f"not known here: {', '.join(unknown)}", fontsize=8, color="0.4")
    return figure


def _family_of_curves(swept: "xr.Dataset", *, x_name: str, family: str) -> "Figure":
    """Curves of the friction ratio over one key, one for each value of the other."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.6, 3.6))
    axes = figure.subplots()
    x = _set_x_axis(axes, swept, x_name)
    ratio = swept[_OUTCOME].transpose(family, x_name).values
    for index, (row, label) in enumerate(zip(ratio, _value_labels(swept, family), strict=True)):
        line, marker = LINES[index % len(LINES)], MARKERS[index % len(MARKERS)] if x.size <= _MOST_MARKED else ""
        axes.plot(x, row, color=COLOURS[index % len(COLOURS)], linestyle=line, marker=marker, ms=3, label=label)
    axes.set_ylabel(_OUTCOME_LABEL)
    figure.legend(loc="outside right upper", title=_title(swept, family))
    return figure


def _contour_map(swept: "xr.Dataset", x_name: str, y_name: str) -> "Figure":
    """Filled contours of the friction ratio over two keys."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.2, 3.8))
    axes = figure.subplots()
    (x, x_label), (y, y_label) = (_axis_values(swept, name) for name in (x_name, y_name))
    ratio = swept[_OUTCOME].transpose(y_name, x_name).values
    filled = axes.contourf(x, y, ratio, levels=12, cmap="cividis")
    axes.set(xlabel=x_label, ylabel=y_label, xlim=(x.min(), x.max()), ylim=(y.min(), y.max()))
    axes.grid(visible=False)
    set_log_scale_if_geometric(axes, x)
    figure.colorbar(filled, ax=axes, label=_OUTCOME_LABEL)
    return figure


def _scatter(swept: "xr.Dataset", names: list[str]) -> "Figure":
    """Scatter of the friction ratio over each key, with median and 90 % range, a panel each."""
    from matplotlib.figure import Figure

    columns = min(len(names), 3)
    rows = -(-len(names) // columns)
    figure = Figure(figsize=(2.5 * columns + 0.7, 2.5 * rows + 0.4))
    grid = figure.subplots(rows, columns, squeeze=False, sharey=True)
    ratio = swept[_OUTCOME]
    sampled = _sampled_points(ratio.size)
    indices = dict(zip(ratio.dims, np.unravel_index(sampled, ratio.shape), strict=True))
    y = ratio.values.ravel()[sampled]
    drawn = np.random.default_rng(0).permutation(sampled.size)[:_MOST_DRAWN]
    for axes, name in zip(grid.flat, names, strict=False):
        x = _set_x_axis(axes, swept, name)[indices[swept[name].dims[0]]]
        axes.plot(x[drawn], y[drawn], ".", color="0.7", markersize=2, alpha=0.6, rasterized=True, label="points")
        centre, low, median, high = _binned_quantiles(x, y)
        axes.fill_between(centre, low, high, color=COLOURS[0], alpha=0.2, linewidth=0, label="90 % of them")
        axes.plot(centre, median, color=COLOURS[0], label="median")
    for axes in grid[:, 0]:
        axes.set_ylabel("Friction ratio")
    for axes in list(grid.flat)[len(names) :]:
        axes.set_axis_off()
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=3)
    return figure


def _binned_quantiles(x: Floats, y: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Bin centres and the 5, 50 and 95 % quantiles there; a bin per distinct value of few, else of equal counts."""
    valid = np.isfinite(y)
    x, y = x[valid], y[valid]
    if x.size == 0:
        return (np.empty(0),) * 4
    distinct = np.unique(x)
    if distinct.size <= 3 * _BINS:
        bins = [(value, y[x == value]) for value in distinct]
    else:
        parts = np.array_split(np.argsort(x), _BINS)
        bins = [(float(np.median(x[part])), y[part]) for part in parts]
    centre, low, median, high = np.array([[value, *np.quantile(own, (0.05, 0.5, 0.95))] for value, own in bins]).T
    return centre, low, median, high


def _sampled_points(points: int) -> NDArray[np.intp]:
    """Flat indices of all points, or of a random subset of many."""
    if points <= _MOST_SAMPLED:
        return np.arange(points)
    return np.unique(np.random.default_rng(0).integers(0, points, _MOST_SAMPLED))


def _set_x_axis(axes: "Axes", swept: "xr.Dataset", name: str) -> Floats:
    """Set label, ticks and scale of the x axis for a swept key; return its values in the unit of that label."""
    x, label = _axis_values(swept, name)
    if _is_text(swept, name):
        words = list(dict.fromkeys(_value_labels(swept, name)))
        axes.set_xticks(range(len(words)), words)
        axes.set_xlim(-0.5, len(words) - 0.5)
    else:
        set_log_scale_if_geometric(axes, x)
    axes.set_xlabel(label)
    return x


def _axis_values(swept: "xr.Dataset", name: str) -> tuple[Floats, str]:
    """Values of a swept key in the unit of its axis label, and that label; text values are numbered."""
    values = swept[name].values
    if _is_text(swept, name):
        words = list(dict.fromkeys(map(str, values)))
        return np.array([words.index(str(value)) for value in values], dtype=np.float64), _title(swept, name)
    scale, label = scaled_label(_quantity_name(swept, name), values)
    return scale * values, label


def _value_labels(swept: "xr.Dataset", name: str) -> list[str]:
    """Values of a swept key as text with their unit."""
    if _is_text(swept, name):
        return [str(value).replace("_", " ") for value in swept[name].values]
    scale, label = scaled_label(_quantity_name(swept, name), swept[name].values)
    unit = label.partition("[")[2].rstrip("]")
    return [f"{scale * value:.4g} {unit}".strip() for value in swept[name].values]


def _title(swept: "xr.Dataset", name: str) -> str:
    """Meaning of a swept key without its unit."""
    return scaled_label(_quantity_name(swept, name), np.ones(1))[1].partition(" [")[0].capitalize()


def _quantity_name(swept: "xr.Dataset", name: str) -> str:
    """Name of the quantity of a swept key: its last word."""
    return str(swept[name].attrs["key"]).rpartition(".")[2]


def _is_text(swept: "xr.Dataset", name: str) -> bool:
    """Whether the values of a swept key are text."""
    return swept[name].dtype.kind not in "fiu"
