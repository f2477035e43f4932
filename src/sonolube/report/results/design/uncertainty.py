"""Uncertainty of an outcome: statistics, band, ranking of entries and their distributions, as rows and for JSON."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.design import IntervalEstimate, SampleStatistics
from sonolube.design.point_statistics import failure_counts, status_counts
from sonolube.design.uncertainty import IdentifiedStructure
from sonolube.design.uncertainty_summary import BAND, Band, BandPlace, RankedEntry, contact_loss_probability
from sonolube.report.blocks import Block, Rows, Table
from sonolube.report.page import Page, PageTable
from sonolube.report.results.design.sweep import failure_objects, status_tables
from sonolube.report.results.record_object import amplitude_object, amplitude_rows, rig_settings
from sonolube.rig import Distribution, Rig
from sonolube.text.units import format_quantity, format_si
from sonolube.vocabulary import quantity

if TYPE_CHECKING:
    import xarray as xr

_MIN_TRUNCATION = 1e-4  # fraction of a distribution that is cut off, from which on it is printed
_MIN_EXPONENT = 0.1  # of a parameter in a free direction, from which on it is printed


def distributions(rig: Rig, result: "xr.Dataset", structure: IdentifiedStructure | None) -> dict[str, Distribution]:
    """Distributions that samples were drawn from, by key, those of an identified structure apart."""
    joint = {} if structure is None else structure.draws_by_key()
    drawn = result.attrs["uncertain"]
    return {key: law for key, law in rig.uncertainty.items() if key in drawn and key not in joint}


def entry_rows(rig: Rig, result: "xr.Dataset", structure: IdentifiedStructure | None) -> list[tuple[str, str]]:
    """Uncertain entries with their distributions, or with median and 90 % interval of their posterior."""
    rows = []
    for key, law in distributions(rig, result, structure).items():
        cut = law.truncated_fraction
        remark = f"; {cut:.1%} of it is impossible and cut off" if cut > _MIN_TRUNCATION else ""
        rows.append((key, f"{law.text}{remark}"))
    if structure is None:
        return rows
    for key, (low, median, high) in _quantiles(structure).items():
        unit = quantity(key.rpartition(".")[2]).unit
        remark = "; no fact settles it" if key.removeprefix("structure.") in structure.posterior.unidentified else ""
        ends = f"{format_si(low, unit)} to {format_si(high, unit)}"
        rows.append((key, f"{format_si(median, unit)}, 90 % within {ends}{remark}"))
    return rows


def free_lines(structure: IdentifiedStructure | None) -> list[str]:
    """Directions in which the facts leave a structure free, and the convergence of its draws."""
    if structure is None:
        return []
    lines = []
    for direction in structure.unidentifiable_directions:
        exponents = {name: exponent for name, exponent in direction.exponents.items() if abs(exponent) > _MIN_EXPONENT}
        product = " ".join(f"{name}^{exponent:+.2f}" for name, exponent in exponents.items())
        lines.append(f"  left free by the facts, to a factor of e and more: {product}")
    return [*lines, f"  {agreement(structure)}"]


def agreement(structure: IdentifiedStructure) -> str:
    """Agreement of independent populations of draws, by their potential scale reduction."""
    posterior = structure.posterior
    agree = "agree" if posterior.has_converged else "do not agree yet: take the ends with caution"
    return f"independent populations of draws {agree} ({posterior.potential_scale_reduction:.2f})"


def posterior_object(structure: IdentifiedStructure) -> dict[str, Any]:
    """Posterior of a structure for JSON: convergence, free parameters and directions, quantiles."""
    posterior = structure.posterior
    return {
        "potential_scale_reduction": posterior.potential_scale_reduction,
        "settled": posterior.has_converged,
        "free": [f"structure.{name}" for name in posterior.unidentified],
        "unidentifiable_directions": [dict(direction.exponents) for direction in structure.unidentifiable_directions],
        "quantiles": _quantiles(structure),
    }


def _quantiles(structure: IdentifiedStructure) -> dict[str, list[float]]:
    """Quantiles of 5, 50 and 95 % of the draws of each parameter, by key."""
    return {key: np.quantile(values, BAND).tolist() for key, values in structure.draws_by_key().items()}


_RANKED = "which to measure better, by shares of the variance"
_RANKING_HEADS = ("entry", "share alone", "with the others", "deviation were it known")


def uncertainty_blocks(
    rig: Rig,
    result: "xr.Dataset",
    structure: IdentifiedStructure | None,
    *,
    ranking: Sequence[RankedEntry],
    facts: Sequence[tuple[str, str]],
    is_ranking_first: bool = False,
) -> list[Block]:
    """Statistics or band, statuses, uncertain entries, and their ranking, which may stand before the entries."""
    name = str(result.attrs["outcome"])
    rows, idle = _ranking_rows(ranking, name), _without_effect(ranking)
    failures = failure_counts(result, outcome=name)
    found: list[Block] = [
        f"{rig.title}, {result[name].size} points: {in_sentence(name)}",
        Rows([*amplitude_rows(rig), *facts]),
        *(f"  without result: {count}: {reason}" for reason, count in failures.items()),
        *_status_lines(result, name),
    ]
    entries: list[Block] = ["uncertain entries", Rows(entry_rows(rig, result, structure)), *free_lines(structure)]
    ranked: list[Block] = [
        *((_RANKED, Table(_RANKING_HEADS, rows)) if rows else ()),
        *([f"  without effect: {idle}"] if idle else []),
    ]
    return [*found, *ranked, *entries] if is_ranking_first else [*found, *entries, *ranked]


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
