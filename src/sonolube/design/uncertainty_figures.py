"""Figures of uncertainty: how an outcome is spread, what brings it, and bands over what is swept."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.design.figure_axes import even_ratios_as_logarithms, scaled_label
from sonolube.design.sample_statistics import Spread, spread
from sonolube.design.sobol import SobolIndices
from sonolube.errors import InvalidInput
from sonolube.figure import COLOURS
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_BINS = (10, 60)
_QUANTILE_LINES = {0.05: ":", 0.25: "--", 0.5: "-", 0.75: "--", 0.95: ":"}


def spread_figure(propagated: "xr.Dataset") -> "Figure":
    """Return how an outcome is spread: a histogram, its quantiles with their intervals, and its mean.

    Parameters
    ----------
    propagated : xarray.Dataset
        As `propagate` returns it, nothing swept.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    found = spread_of(propagated)
    values = propagated[propagated.attrs["of"]]
    values = values.isel(block=[0, 1]) if "block" in propagated.dims else values
    known = values.values[np.isfinite(values.values)]
    scale, label = scaled_label(propagated.attrs["of"], known)
    figure = Figure(figsize=(4.8, 3.4))
    axes = figure.subplots()
    bins = int(np.clip(np.sqrt(known.size) / 1.5, *_BINS))
    weights = np.full(known.size, 100 / known.size)
    axes.hist(scale * known, bins=bins, weights=weights, color=COLOURS[5], alpha=0.7)
    for share, each in found.quantiles.items():
        value, lower, upper = (scale * end for end in (each.value, each.lower, each.upper))
        axes.axvspan(lower, upper, color=COLOURS[0], alpha=0.18, linewidth=0)
        axes.axvline(value, color=COLOURS[0], linestyle=_QUANTILE_LINES[share])
        axes.annotate(
            f"{100 * share:.0f} %",
            (value, 1),
            xycoords=("data", "axes fraction"),
            xytext=(0, 2),
            textcoords="offset points",
            ha="center",
            fontsize=7,
        )
    axes.plot([scale * found.mean.value], [0], "^", color=COLOURS[1], clip_on=False, zorder=5, label="mean")
    axes.plot([], [], color=COLOURS[0], label="share below, and its 95 % interval")
    axes.set_xlabel(label)
    axes.set_ylabel("Share of the samples [%]")
    figure.legend(loc="outside lower center", ncols=2)
    figure.suptitle(propagated.attrs["rig"], fontsize=9)
    return figure


def indices_figure(propagated: "xr.Dataset", found: SobolIndices) -> "Figure":
    """Return what each uncertain entry brings to the variance of an outcome, the most first.

    Parameters
    ----------
    propagated : xarray.Dataset
        As `propagate` returns it for indices.
    found : SobolIndices
        The indices of its outcome.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    keys, order = [str(key) for key in propagated["block"].values[2:]], np.argsort(found.total)
    figure = Figure(figsize=(5.6, 0.9 + 0.42 * len(keys)))
    axes = figure.subplots()
    places = np.arange(len(keys))
    for shares, interval, shift, colour, hatch, label in (
        (found.first, found.first_interval, 0.2, COLOURS[0], None, "alone (first)"),
        (found.total, found.total_interval, -0.2, COLOURS[4], "///", "with the others (total)"),
    ):
        low, high = interval[order].T
        error = np.maximum([shares[order] - low, high - shares[order]], 0)
        axes.barh(
            places + shift,
            100 * shares[order],
            0.38,
            xerr=100 * error,
            color=colour,
            hatch=hatch,
            edgecolor="white",
            error_kw={"elinewidth": 1, "capsize": 2},
            label=label,
        )
    axes.set_yticks(places, [keys[place] for place in order])
    axes.set_xlabel("Share of the variance, with its 95 % interval [%]")
    axes.set_xlim(left=0)
    figure.suptitle(_heading(propagated), fontsize=9)
    axes.grid(visible=False, axis="y")
    axes.legend(loc="lower right")
    return figure


def band_figure(propagated: "xr.Dataset") -> "Figure":
    """Return the median and the 50 and 90 % intervals of an outcome over what was swept.

    Parameters
    ----------
    propagated : xarray.Dataset
        As `propagate` returns it, over one or two keys.

    Returns
    -------
    matplotlib.figure.Figure
        Curves over one key; over two a map of the median beside one of the interval's width.

    Raises
    ------
    InvalidInput
        If more than two keys were swept.
    """
    names = [str(name) for name in propagated[propagated.attrs["of"]].dims[1:]]
    if not 1 <= len(names) <= 2:
        raise InvalidInput(f"a band needs one or two swept keys, got {len(names)}")
    return _curves(propagated, names[0]) if len(names) == 1 else _maps(propagated, names[0], names[1])


def spread_of(propagated: "xr.Dataset") -> Spread:
    """Return how the outcome is spread; of samples for indices, over the two blocks that are independent."""
    values, stretch = propagated[propagated.attrs["of"]].values, propagated["stretch"].values
    if "block" in propagated.dims:
        values, stretch = values[:2].ravel(), np.tile(stretch, 2)
    return spread(values, stretch=stretch)


def _curves(propagated: "xr.Dataset", name: str) -> "Figure":
    from matplotlib.figure import Figure

    found, (across, x) = _quantiles(propagated), _axis(propagated, name)
    scale, label = scaled_label(propagated.attrs["of"], found)
    low, lower, median, upper, high = scale * found
    figure = Figure(figsize=(4.8, 3.4))
    axes = figure.subplots()
    axes.fill_between(x, low, high, color=COLOURS[0], alpha=0.18, linewidth=0, label="90 % of the samples")
    axes.fill_between(x, lower, upper, color=COLOURS[0], alpha=0.32, linewidth=0, label="50 %")
    axes.plot(x, median, color=COLOURS[0], label="median")
    even_ratios_as_logarithms(axes, x)
    axes.set_xlabel(across)
    axes.set_ylabel(label)
    axes.set_xlim(x.min(), x.max())
    axes.legend()
    figure.suptitle(propagated.attrs["rig"], fontsize=9)
    return figure


def _maps(propagated: "xr.Dataset", first: str, second: str) -> "Figure":
    from matplotlib.figure import Figure
    from matplotlib.patheffects import Normal, Stroke

    found = _quantiles(propagated)
    (across, x), (up, y) = _axis(propagated, first), _axis(propagated, second)
    scale, label = scaled_label(propagated.attrs["of"], found)
    low, _, median, _, high = scale * found
    figure = Figure(figsize=(7.2, 3.5))
    panels = figure.subplots(1, 2, sharey=True)
    for axes, shown, title in ((panels[0], median, "Median"), (panels[1], high - low, "Width of the 90 % interval")):
        filled = axes.contourf(x, y, shown.T, levels=12, cmap="cividis")
        lines = axes.contour(filled, levels=filled.levels[1:-1:2], colors="white", linewidths=0.6)
        for text in axes.clabel(lines, fontsize=7, fmt="%.3g"):
            text.set_path_effects([Stroke(linewidth=1.5, foreground="black"), Normal()])
        axes.set_title(title, fontsize=9)
        axes.set_xlabel(across)
        axes.grid(visible=False)
        even_ratios_as_logarithms(axes, x)
        figure.colorbar(filled, ax=axes, format="%.3g")
    panels[0].set_ylabel(up)
    figure.suptitle(f"{propagated.attrs['rig']}\n{label}", fontsize=9)
    return figure


def _quantiles(propagated: "xr.Dataset") -> Floats:
    values = propagated[propagated.attrs["of"]].values
    shares = (0.05, 0.25, 0.5, 0.75, 0.95)
    known = np.isfinite(values).any(axis=0)
    found = np.full((len(shares), *values.shape[1:]), np.nan)
    found[:, known] = np.nanquantile(values[:, known], shares, axis=0)
    return found


def _axis(propagated: "xr.Dataset", name: str) -> tuple[str, Floats]:
    """Return the label of a swept key and its values as they stand at an axis."""
    key, values = propagated[name].attrs["key"], propagated[name].values
    if values.dtype.kind == "U":
        raise InvalidInput(f"{key}: a band needs numbers to run over, not words")
    scale, label = scaled_label(key.rpartition(".")[2], values)
    return label, scale * values


def _heading(propagated: "xr.Dataset") -> str:
    return f"{propagated.attrs['rig']}\n{quantity(propagated.attrs['of']).meaning}"
