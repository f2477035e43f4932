"""Uncertainty of an outcome: rows and objects for JSON of its statistics, its band and the ranking of entries."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from sonolube.design import IntervalEstimate, SampleStatistics
from sonolube.design.identified_structure import IdentifiedStructure
from sonolube.design.point_statistics import failure_counts, status_counts
from sonolube.design.uncertainty_summary import Band, BandPlace, RankedEntry, contact_loss_probability
from sonolube.report.blocks import Block, Rows, Table
from sonolube.report.page import Page, PageTable
from sonolube.report.results.design.status_tables import failure_objects, status_tables
from sonolube.report.results.design.uncertain_entries import distributions, entry_rows, free_lines, posterior_object
from sonolube.report.results.rig_text import amplitude_object, amplitude_rows, rig_settings
from sonolube.rig import Rig
from sonolube.text.units import format_quantity
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr


_RANKED = "which to measure better, by shares of the variance"
_RANKING_HEADS = ("entry", "share alone", "with the others", "deviation were it known")


def uncertainty_blocks(
    rig: Rig,
    result: "xr.Dataset",
    structure: IdentifiedStructure | None,
    *,
    ranking: Sequence[RankedEntry],
    facts: Sequence[tuple[str, str]],
) -> list[Block]:
    """Statistics or band, statuses, uncertain entries, and their ranking."""
    name = str(result.attrs["outcome"])
    rows, idle = _ranking_rows(ranking, name), _without_effect(ranking)
    failures = failure_counts(result, outcome=name)
    return [
        f"{rig.title}, {result[name].size} points: {in_sentence(name)}",
        Rows([*amplitude_rows(rig), *facts]),
        *(f"  without result: {count}: {reason}" for reason, count in failures.items()),
        *_status_lines(result, name),
        "uncertain entries",
        Rows(entry_rows(rig, result, structure)),
        *free_lines(structure),
        *((_RANKED, Table(_RANKING_HEADS, rows)) if rows else ()),
        *([f"  without effect: {idle}"] if idle else []),
    ]


def sampled_object(rig: Rig, result: "xr.Dataset", structure: IdentifiedStructure | None) -> dict[str, Any]:
    """Statuses and uncertain entries, for JSON."""
    name = str(result.attrs["outcome"])
    content: dict[str, Any] = {
        "rig": rig.title,
        **amplitude_object(rig),
        "of": name,
        "unit": quantity(name).unit,
        "points": int(result[name].size),
        "statuses": status_counts(result),
        "without_result": failure_objects(failure_counts(result, outcome=name)),
        "contact_lost": contact_loss_probability(result),
        "uncertain": {
            key: {"distribution": law.text, "truncated_fraction": law.truncated_fraction}
            for key, law in distributions(rig, result, structure).items()
        },
    }
    return content if structure is None else content | {"identified": posterior_object(structure)}


def uncertainty_page(
    rig: Rig,
    result: "xr.Dataset",
    structure: IdentifiedStructure | None,
    *,
    ranking: Sequence[RankedEntry],
    facts: Sequence[tuple[str, str]],
) -> Page:
    """Page of an uncertainty: statistics or band, uncertain entries, their ranking, and statuses."""
    name, lost, idle = str(result.attrs["outcome"]), contact_loss_probability(result), _without_effect(ranking)
    entries, rows = tuple(entry_rows(rig, result, structure)), tuple(_ranking_rows(ranking, name))
    tables = [
        PageTable(title="Uncertain entries", heads=("entry", "distribution"), rows=entries),
        PageTable(title=_RANKED.capitalize(), heads=_RANKING_HEADS, rows=rows),
    ]
    return Page(
        name="uncertainty",
        title=f"Uncertainty of the {in_sentence(name)}: {rig.title}",
        settings=rig_settings(rig),
        facts=[
            ("points", f"{result[name].size}"),
            *facts,
            *([("contact lost", f"for part of the time in {lost:.1%} of the points")] if lost else []),
            *([("without effect", idle)] if idle else []),
        ],
        tables=[
            *(table for table in tables if table.rows),
            *status_tables(result, failure_counts(result, outcome=name)),
        ],
    )


def _without_effect(ranking: Sequence[RankedEntry]) -> str:
    """Entries that the outcome was not seen to depend on: to know them better changes nothing."""
    return ", ".join(row.key for row in ranking if not row.matters)


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


def _ranking_rows(ranking: Sequence[RankedEntry], name: str) -> list[tuple[str, str, str, str]]:
    """Entries that matter with their contributions, alone and with others, and the deviation that would remain."""
    return [
        (row.key, _percent(row.first), _percent(row.total), format_quantity(row.deviation_if_known, name))
        for row in ranking
        if row.matters
    ]


def _status_lines(result: "xr.Dataset", name: str) -> list[str]:
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
