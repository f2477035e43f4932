"""Figures of uncertainty: histogram of an outcome, its Sobol indices, and uncertainty bands over swept keys."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from sonolube.charts import Axis, Band as Shade, Bars, Chart, Field, Line, Note, Panel, Part, Points, Rule, one_panel
from sonolube.checks import Floats
from sonolube.design.figure_axes import contour_levels, scaled_axis
from sonolube.design.sobol import SobolIndices
from sonolube.design.statistics import QUANTILES, SampleStatistics, sample_statistics
from sonolube.design.uncertainty_summary import outcome_quantiles
from sonolube.errors import InvalidInput
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

_BINS = (10, 60)
_DASHES = {0.05: 3, 0.25: 1, 0.5: 0, 0.75: 1, 0.95: 3}  # of quantiles
_HEADROOM = 1.05  # height of the histogram over its highest bar


def histogram_chart(propagated: "xr.Dataset") -> Chart:
    """Histogram of an outcome with its quantiles, their confidence intervals, and its mean.

    Parameters
    ----------
    propagated : xarray.Dataset
        Result of `propagate` without swept keys.

    Returns
    -------
    Chart

    See Also
    --------
    band_chart, sobol_chart
    """
    outcome, statistics = propagated.attrs["outcome"], outcome_statistics(propagated)
    values = propagated[outcome]
    values = (values.isel(block=[0, 1]) if "block" in propagated.dims else values).values
    valid = values[np.isfinite(values)]
    scale, axis = scaled_axis(outcome, valid)
    counts, edges = np.histogram(scale * valid, bins=int(np.clip(np.sqrt(valid.size) / 1.5, *_BINS)))
    percent = 100 * counts / valid.size
    top = _HEADROOM * float(percent.max())
    bars = Bars(
        places=(edges[1:] + edges[:-1]) / 2, lengths=percent, breadth=float(edges[1] - edges[0]), along="y", colour=5
    )
    mean = Points(
        x=np.array([scale * statistics.mean.value]), y=np.zeros(1), label="mean", colour=1, marker=2, size=1.6
    )
    return one_panel(
        axis,
        Axis("Fraction of the samples", "%", lowest=0.0, highest=top),
        (bars, *_quantiles(statistics, scale, top), mean),
        size=(4.8, 3.4),
        title=propagated.attrs["rig"],
        legend="bottom",
    )


def _quantiles(statistics: SampleStatistics, scale: float, top: float) -> list[Part]:
    """Each quantile as a line up to a height, with its interval and its probability."""
    parts: list[Part] = []
    for probability, estimate in statistics.quantiles.items():
        value, lower, upper = (scale * end for end in (estimate.value, estimate.lower, estimate.upper))
        label = "quantile with 95 % interval" if probability == QUANTILES[len(QUANTILES) // 2] else ""
        ends = np.array([lower, upper])
        parts += [
            Shade(x=ends, low=np.zeros(2), high=np.full(2, top), opacity=0.18),
            Rule(value=value, label=label, colour=0, dash=_DASHES[probability]),
            Note(x=value, y=top, text=f"{100 * probability:.0f} %", side="above"),
        ]
    return parts


def sobol_chart(propagated: "xr.Dataset", indices: SobolIndices) -> Chart:
    """Bar chart of first-order and total-order Sobol indices by entry, the largest total-order index on top.

    Parameters
    ----------
    propagated : xarray.Dataset
        Result of `propagate` with `indices=True`.
    indices : SobolIndices
        Of its outcome.

    Returns
    -------
    Chart

    See Also
    --------
    histogram_chart
    """
    keys, order = [str(key) for key in propagated["block"].values[2:]], np.argsort(indices.total_order)
    bars = []
    for fractions, interval, shift, colour, hatch, label in (
        (indices.first_order, indices.first_order_interval, 0.2, 0, "", "first order"),
        (indices.total_order, indices.total_order_interval, -0.2, 4, "///", "total order"),
    ):
        low, high = interval[order].T
        error = np.maximum([fractions[order] - low, high - fractions[order]], 0)
        bars.append(
            Bars(
                places=np.arange(len(keys), dtype=np.float64) + shift,
                lengths=100 * fractions[order],
                breadth=0.38,
                error=100 * error,
                colour=colour,
                hatch=hatch,
                label=label,
            )
        )
    x = Axis("Sobol index, fraction of the variance, with 95 % interval", "%", lowest=0.0)
    panel = Panel(x=x, y=Axis(words=tuple(keys[place] for place in order)), parts=tuple(bars))
    title = f"{propagated.attrs['rig']}\n{quantity(propagated.attrs['outcome']).meaning}"
    return Chart(panels=(panel,), size=(5.6, 0.9 + 0.42 * len(keys)), title=title)


def band_chart(propagated: "xr.Dataset") -> Chart:
    """Median, 50 % and 90 % range of an outcome over one swept key, or maps of median and 90 % range over two.

    Parameters
    ----------
    propagated : xarray.Dataset
        Result of `propagate` over one or two keys.

    Returns
    -------
    Chart

    Raises
    ------
    InvalidInput
        If no key or more than two were swept, or a swept key has text values.

    See Also
    --------
    histogram_chart
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


def _band_curves(propagated: "xr.Dataset", name: str) -> Chart:
    """Curves of the quantiles over one swept key."""
    quantiles, (x, x_axis) = outcome_quantiles(propagated, QUANTILES), _swept_axis(propagated, name)
    scale, y_axis = scaled_axis(propagated.attrs["outcome"], quantiles)
    low, lower, median, upper, high = scale * quantiles
    parts = (
        Shade(x=x, low=low, high=high, label="90 % of the samples", opacity=0.18),
        Shade(x=x, low=lower, high=upper, label="50 %", opacity=0.32),
        Line(x=x, y=median, label="median"),
    )
    x_axis = replace(x_axis, lowest=float(x.min()), highest=float(x.max()))
    return one_panel(x_axis, y_axis, parts, size=(4.8, 3.4), title=propagated.attrs["rig"])


def _band_maps(propagated: "xr.Dataset", first: str, second: str) -> Chart:
    """Contour maps of the median and of the width of the 90 % range over two swept keys."""
    quantiles = outcome_quantiles(propagated, QUANTILES)
    (x, x_axis), (y, y_axis) = _swept_axis(propagated, first), _swept_axis(propagated, second)
    scale, axis = scaled_axis(propagated.attrs["outcome"], quantiles)
    low, _, median, _, high = scale * quantiles
    panels = []
    for values, title in ((median.T, "Median"), ((high - low).T, "Width of the 90 % range")):
        levels = contour_levels(values)
        field = Field(x=x, y=y, values=values, label=axis.label, unit=axis.unit, levels=levels, lines=levels[2:-1:3])
        panels.append(Panel(x=x_axis, y=y_axis, parts=(field,), title=title))
    return Chart(panels=tuple(panels), size=(7.2, 3.5), columns=2, title=propagated.attrs["rig"], shares_y=True)


def _swept_axis(propagated: "xr.Dataset", name: str) -> tuple[Floats, Axis]:
    """Values of a swept key in the unit of its axis, and that axis."""
    key, values = propagated[name].attrs["key"], propagated[name].values
    if values.dtype.kind == "U":
        raise InvalidInput(f"{key}: an uncertainty band needs numbers to sweep over, not text")
    scale, axis = scaled_axis(key.rpartition(".")[2], values)
    return scale * values, axis
