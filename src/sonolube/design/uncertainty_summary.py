"""Summaries and figures of a propagated uncertainty: bands, ranking by Sobol indices, histogram, contact loss."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.charts import Axis, Band as Shade, Bars, Chart, Field, Line, Note, Panel, Part, Points, Rule, one_panel
from sonolube.checks import Floats
from sonolube.design.statistics import (
    QUANTILES,
    IntervalEstimate,
    SampleStatistics,
    SobolIndices,
    sample_statistics,
    sobol_indices,
)
from sonolube.design.sweep_figures import contour_levels, scaled_axis
from sonolube.errors import InvalidInput
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

BAND = (0.05, 0.5, 0.95)
"""Probabilities of the quantiles that bound and halve a band."""

_SHARES = ("first_order", "total_order", "first_order_interval", "total_order_interval")
_MIN_SHARE = 0.005  # of the variance, which is printed as 0 %


@dataclass(frozen=True, kw_only=True, slots=True)
class BandPlace:
    """Median and 90 % interval of an outcome at one place of a swept band.

    Parameters
    ----------
    at : dict of str to float or str
        Value of each swept key, SI.
    median, lower, upper : float
        Quantiles of the outcome at 50, 5 and 95 %, SI.
    """

    at: dict[str, Any]
    median: float
    lower: float
    upper: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Band:
    """Width of the 90 % interval of an outcome over swept keys.

    Parameters
    ----------
    mean_width : float or None
        Mean width, SI; None where no sample has a result.
    narrowest, widest : BandPlace or None
    """

    mean_width: float | None
    narrowest: BandPlace | None
    widest: BandPlace | None


@dataclass(frozen=True, kw_only=True, slots=True)
class RankedEntry:
    """Contribution of one uncertain entry to the variance of an outcome.

    Parameters
    ----------
    key : str
        Of the rig file.
    first, total : IntervalEstimate
        First-order and total Sobol index with their 95 % intervals.
    deviation_if_known : float
        Standard deviation of the outcome that would remain were the entry known, SI.
    matters : bool
        Whether the outcome depends on the entry beyond doubt: the interval of the total index is above zero.
    """

    key: str
    first: IntervalEstimate
    total: IntervalEstimate
    deviation_if_known: float
    matters: bool


def outcome_indices(propagated: "xr.Dataset") -> SobolIndices:
    """Sobol indices of the outcome of a propagation that was made for them.

    Estimates and intervals cut off at 0 and 1, between which all indices lie.
    """
    found = sobol_indices(propagated[propagated.attrs["outcome"]].values, seed=propagated.attrs["seed"])
    return replace(found, **{name: np.clip(getattr(found, name), 0.0, 1.0) for name in _SHARES})


def ranked_entries(propagated: "xr.Dataset") -> list[RankedEntry]:
    r"""Uncertain entries by falling first-order Sobol index, then by falling total index.

    With the standard deviation :math:`\sigma` of the outcome and the first-order index :math:`S_i` of an entry, the
    deviation that remains were the entry known is :math:`\sigma \sqrt{1 - S_i}`.
    """
    indices = outcome_indices(propagated)
    rows = [
        RankedEntry(
            key=key,
            first=IntervalEstimate(value=first, lower=first_ends[0], upper=first_ends[1]),
            total=IntervalEstimate(value=total, lower=total_ends[0], upper=total_ends[1]),
            deviation_if_known=indices.standard_deviation * float(np.sqrt(1 - first)),
            matters=total_ends[0] > _MIN_SHARE,
        )
        for key, first, first_ends, total, total_ends in zip(
            propagated.attrs["uncertain"],
            indices.first_order.tolist(),
            indices.first_order_interval.tolist(),
            indices.total_order.tolist(),
            indices.total_order_interval.tolist(),
            strict=True,
        )
    ]
    return sorted(rows, key=lambda row: (-row.first.value, -row.total.value))


def contact_loss_probability(propagated: "xr.Dataset") -> float | None:
    """Fraction of the points with a vibration that lose contact for part of the time. []

    None where contact loss was not computed.
    """
    if "contact_loss_fraction" not in propagated:
        return None
    lost = propagated["contact_loss_fraction"].values
    known = np.isfinite(lost)
    return float(np.mean(lost[known] > 0)) if known.any() else None


def outcome_quantiles(propagated: "xr.Dataset", probabilities: Sequence[float]) -> Floats:
    """Quantiles of an outcome over the samples.

    One row per probability; NaN where no sample has a result.
    """
    samples = propagated[propagated.attrs["outcome"]].values
    valid = np.isfinite(samples).any(axis=0)
    quantiles = np.full((len(probabilities), *samples.shape[1:]), np.nan)
    quantiles[:, valid] = np.nanquantile(samples[:, valid], probabilities, axis=0)
    return quantiles


def outcome_band(propagated: "xr.Dataset") -> Band:
    """Median and 90 % interval of an outcome where the interval is narrowest and widest, and its mean width."""
    outcome = propagated[propagated.attrs["outcome"]]
    low, median, high = outcome_quantiles(propagated, BAND)
    if np.isnan(median).all():
        return Band(mean_width=None, narrowest=None, widest=None)
    width = high - low

    def place(flat: int) -> BandPlace:
        index = np.unravel_index(flat, width.shape)
        at = {
            str(propagated[name].attrs["key"]): propagated[name].values[own].item()
            for name, own in zip(outcome.dims[1:], index, strict=True)
        }
        return BandPlace(at=at, median=float(median[index]), lower=float(low[index]), upper=float(high[index]))

    return Band(
        mean_width=float(np.nanmean(width)),
        narrowest=place(int(np.nanargmin(width))),
        widest=place(int(np.nanargmax(width))),
    )


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
