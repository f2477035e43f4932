"""Uncertainty of an outcome: rows and objects for JSON of its statistics, its band and the ranking of entries."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from sonolube.design import IntervalEstimate, SampleStatistics
from sonolube.design.point_statistics import status_counts
from sonolube.design.uncertainty_summary import Band, BandPlace, RankedEntry, contact_loss_probability
from sonolube.units import format_quantity
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr


def statistics_rows(found: SampleStatistics, name: str) -> list[tuple[str, str]]:
    """Mean, deviation and quantiles of a quantity with their intervals, and their convergence."""
    rows = {"mean": found.mean, "standard deviation": found.standard_deviation}
    for share, each in found.quantiles.items():
        rows["median" if share == 0.5 else f"{100 * share:.0f} % lie below"] = each
    texts = [(label, _with_interval(each, name)) for label, each in rows.items()]
    return [*texts, ("convergence", convergence(found))] if found.has_converged else texts


def statistics_object(found: SampleStatistics) -> dict[str, Any]:
    """Mean, deviation and quantiles with their intervals, and their convergence."""
    return {
        "mean": asdict(found.mean),
        "standard_deviation": asdict(found.standard_deviation),
        "quantiles": {str(share): asdict(each) for share, each in found.quantiles.items()},
        "relative_error": found.relative_error,
        "converged": found.has_converged,
    }


def convergence(found: SampleStatistics) -> str:
    """Width of the intervals of the statistics over the deviation of the samples."""
    if found.has_converged:
        return f"intervals of 95 % within {found.relative_error:.1%} of the spread"
    return f"not converged: an interval takes {found.relative_error:.1%} of the spread; take more samples"


def band_rows(band: Band, name: str) -> list[tuple[str, str]]:
    """Median and interval of a quantity where its band is narrowest and widest, with the swept values there."""
    return [(label, _place_text(place, name)) for label, place in _places(band).items()]


def band_object(band: Band) -> dict[str, Any]:
    """Mean width of a band, and where it is narrowest and widest."""
    return {"mean_width": band.mean_width} | {label: asdict(place) for label, place in _places(band).items()}


def ranking_rows(ranking: Sequence[RankedEntry], name: str) -> list[tuple[str, str, str, str]]:
    """Entries that matter with their contributions, alone and with others, and the deviation that would remain."""
    return [
        (row.key, _percent(row.first), _percent(row.total), format_quantity(row.deviation_if_known, name))
        for row in ranking
        if row.matters
    ]


def status_lines(result: "xr.Dataset", name: str) -> list[str]:
    """Fractions of the points by status, and of those that lose contact."""
    points, lost = result[name].size, contact_loss_probability(result)
    shares = ", ".join(f"{status} {count / points:.1%}" for status, count in status_counts(result).items())
    more = [f"  contact lost for part of the time in {lost:.1%} of them"] if lost else []
    return [f"  {shares} of the points", *more]


def in_sentence(name: str) -> str:
    """Meaning of a quantity within a sentence."""
    meaning = quantity(name).meaning
    return meaning[:1].lower() + meaning[1:]


def _places(band: Band) -> dict[str, BandPlace]:
    """Where a band is narrowest and widest."""
    places = {"narrowest": band.narrowest, "widest": band.widest}
    return {label: place for label, place in places.items() if place is not None}


def _place_text(place: BandPlace, name: str) -> str:
    """Median and interval of a band at a place, with the swept values there."""
    low, median, high = (format_quantity(value, name) for value in (place.lower, place.median, place.upper))
    at = [
        value if isinstance(value, str) else format_quantity(value, key.rpartition(".")[2])
        for key, value in place.at.items()
    ]
    return f"{median}, 90 % within {low} to {high}, at {', '.join(at)}"


def _with_interval(each: IntervalEstimate, name: str) -> str:
    """Estimate with its 95 % interval."""
    value, low, high = (format_quantity(end, name) for end in (each.value, each.lower, each.upper))
    return f"{value} ({low} to {high})"


def _percent(share: IntervalEstimate) -> str:
    """Fraction in percent with its interval."""
    value, low, high = (100 * end for end in (share.value, share.lower, share.upper))
    return f"{value:.1f} % ({low:.0f} to {high:.0f})"
