"""Figures of uncertainty: histogram of an outcome, its Sobol indices, and uncertainty bands over swept keys."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.design.figure_axes import scaled_label, set_log_scale_if_geometric
from sonolube.design.sobol import SobolIndices
from sonolube.design.statistics import QUANTILES, SampleStatistics, sample_statistics
from sonolube.design.uncertainty_summary import outcome_quantiles
from sonolube.errors import InvalidInput
from sonolube.figure import COLOURS
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_BINS = (10, 60)
_QUANTILE_LINES = {0.05: ":", 0.25: "--", 0.5: "-", 0.75: "--", 0.95: ":"}


def histogram_figure(propagated: "xr.Dataset") -> "Figure":
    """Histogram of an outcome with its quantiles, their confidence intervals, and its mean.

    Parameters
    ----------
    propagated : xarray.Dataset
        Result of `propagate` without swept keys.

    Returns
    -------
    matplotlib.figure.Figure

    See Also
    --------
    band_figure, sobol_figure
    """
    from matplotlib.figure import Figure

    statistics = outcome_statistics(propagated)
    values = propagated[propagated.attrs["outcome"]]
    values = values.isel(block=[0, 1]) if "block" in propagated.dims else values
    valid = values.values[np.isfinite(values.values)]
    scale, label = scaled_label(propagated.attrs["outcome"], valid)
    figure = Figure(figsize=(4.8, 3.4))
    axes = figure.subplots()
    bins = int(np.clip(np.sqrt(valid.size) / 1.5, *_BINS))
    weights = np.full(valid.size, 100 / valid.size)
    axes.hist(scale * valid, bins=bins, weights=weights, color=COLOURS[5], alpha=0.7)
    for probability, estimate in statistics.quantiles.items():
        value, lower, upper = (scale * end for end in (estimate.value, estimate.lower, estimate.upper))
        axes.axvspan(lower, upper, color=COLOURS[0], alpha=0.18, linewidth=0)
        axes.axvline(value, color=COLOURS[0], linestyle=_QUANTILE_LINES[probability])
        axes.annotate(
            f"{100 * probability:.0f} %",
            (value, 1),
            xycoords=("data", "axes fraction"),
            xytext=(0, 2),
            textcoords="offset points",
            ha="center",
            fontsize=7,
        )
    axes.plot([scale * statistics.mean.value], [0], "^", color=COLOURS[1], clip_on=False, zorder=5, label="mean")
    axes.plot([], [], color=COLOURS[0], label="quantile with 95 % interval")
    axes.set_xlabel(label)
    axes.set_ylabel("Fraction of the samples [%]")
    figure.legend(loc="outside lower center", ncols=2)
    figure.suptitle(propagated.attrs["rig"], fontsize=9)
    return figure


def sobol_figure(propagated: "xr.Dataset", indices: SobolIndices) -> "Figure":
    """Bar chart of first-order and total-order Sobol indices by entry, the largest total-order index on top.

    Parameters
    ----------
    propagated : xarray.Dataset
        Result of `propagate` with `indices=True`.
    indices : SobolIndices
        Of its outcome.

    Returns
    -------
    matplotlib.figure.Figure

    See Also
    --------
    histogram_figure
    """
    from matplotlib.figure import Figure

    keys, order = [str(key) for key in propagated["block"].values[2:]], np.argsort(indices.total_order)
    figure = Figure(figsize=(5.6, 0.9 + 0.42 * len(keys)))
    axes = figure.subplots()
    rows = np.arange(len(keys))
    for fractions, interval, shift, colour, hatch, label in (
        (indices.first_order, indices.first_order_interval, 0.2, COLOURS[0], None, "first order"),
        (indices.total_order, indices.total_order_interval, -0.2, COLOURS[4], "///", "total order"),
    ):
        low, high = interval[order].T
        error = np.maximum([fractions[order] - low, high - fractions[order]], 0)
        axes.barh(
            rows + shift,
            100 * fractions[order],
            0.38,
            xerr=100 * error,
            color=colour,
            hatch=hatch,
            edgecolor="white",
            error_kw={"elinewidth": 1, "capsize": 2},
            label=label,
        )
    axes.set_yticks(rows, [keys[i] for i in order])
    axes.set_xlabel("Sobol index, fraction of the variance, with 95 % interval [%]")
    axes.set_xlim(left=0)
    figure.suptitle(f"{propagated.attrs['rig']}\n{quantity(propagated.attrs['outcome']).meaning}", fontsize=9)
    axes.grid(visible=False, axis="y")
    axes.legend(loc="lower right")
    return figure


def band_figure(propagated: "xr.Dataset") -> "Figure":
    """Median, 50 % and 90 % range of an outcome over one swept key, or maps of median and 90 % range over two.

    Parameters
    ----------
    propagated : xarray.Dataset
        Result of `propagate` over one or two keys.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    InvalidInput
        If no key or more than two were swept, or a swept key has text values.

    See Also
    --------
    histogram_figure
    """
    names = [str(name) for name in propagated[propagated.attrs["outcome"]].dims[1:]]
    if not 1 <= len(names) <= 2:
        raise InvalidInput(f"an uncertainty band needs one or two swept keys, got {len(names)}")
    return _band_curves(propagated, names[0]) if len(names) == 1 else _band_maps(propagated, names[0], names[1])


def outcome_statistics(propagated: "xr.Dataset") -> SampleStatistics:
    """Sample statistics of the outcome of a propagation; for Saltelli's scheme over its independent blocks A and B.

    Parameters
    ----------
    propagated : xarray.Dataset
        Result of `propagate` without swept keys.

    Returns
    -------
    SampleStatistics
    """
    values, subsequence = propagated[propagated.attrs["outcome"]].values, propagated["subsequence"].values
    if "block" in propagated.dims:
        values, subsequence = values[:2].ravel(), np.tile(subsequence, 2)
    return sample_statistics(values, subsequence=subsequence)


def _band_curves(propagated: "xr.Dataset", name: str) -> "Figure":
    """Curves of the quantiles over one swept key."""
    from matplotlib.figure import Figure

    quantiles, (x_label, x) = outcome_quantiles(propagated, QUANTILES), _scaled_axis(propagated, name)
    scale, label = scaled_label(propagated.attrs["outcome"], quantiles)
    low, lower, median, upper, high = scale * quantiles
    figure = Figure(figsize=(4.8, 3.4))
    axes = figure.subplots()
    axes.fill_between(x, low, high, color=COLOURS[0], alpha=0.18, linewidth=0, label="90 % of the samples")
    axes.fill_between(x, lower, upper, color=COLOURS[0], alpha=0.32, linewidth=0, label="50 %")
    axes.plot(x, median, color=COLOURS[0], label="median")
    set_log_scale_if_geometric(axes, x)
    axes.set_xlabel(x_label)
    axes.set_ylabel(label)
    axes.set_xlim(x.min(), x.max())
    axes.legend()
    figure.suptitle(propagated.attrs["rig"], fontsize=9)
    return figure


def _band_maps(propagated: "xr.Dataset", first: str, second: str) -> "Figure":
    """Contour maps of the median and of the width of the 90 % range over two swept keys."""
    from matplotlib.figure import Figure
    from matplotlib.patheffects import Normal, Stroke

    quantiles = outcome_quantiles(propagated, QUANTILES)
    (x_label, x), (y_label, y) = _scaled_axis(propagated, first), _scaled_axis(propagated, second)
    scale, label = scaled_label(propagated.attrs["outcome"], quantiles)
    low, _, median, _, high = scale * quantiles
    figure = Figure(figsize=(7.2, 3.5))
    panels = figure.subplots(1, 2, sharey=True)
    for axes, surface, title in ((panels[0], median, "Median"), (panels[1], high - low, "Width of the 90 % range")):
        filled = axes.contourf(x, y, surface.T, levels=12, cmap="cividis")
        lines = axes.contour(filled, levels=filled.levels[1:-1:2], colors="white", linewidths=0.6)
        for text in axes.clabel(lines, fontsize=7, fmt="%.3g"):
            text.set_path_effects([Stroke(linewidth=1.5, foreground="black"), Normal()])
        axes.set_title(title, fontsize=9)
        axes.set_xlabel(x_label)
        axes.grid(visible=False)
        set_log_scale_if_geometric(axes, x)
        figure.colorbar(filled, ax=axes, format="%.3g")
    panels[0].set_ylabel(y_label)
    figure.suptitle(f"{propagated.attrs['rig']}\n{label}", fontsize=9)
    return figure


def _scaled_axis(propagated: "xr.Dataset", name: str) -> tuple[str, Floats]:
    """Axis label of a swept key, and its values in the unit of that label."""
    key, values = propagated[name].attrs["key"], propagated[name].values
    if values.dtype.kind == "U":
        raise InvalidInput(f"{key}: an uncertainty band needs numbers to sweep over, not text")
    scale, label = scaled_label(key.rpartition(".")[2], values)
    return label, scale * values
