"""Numbers of the abstract, of summaries and of the conclusions, which repeat those of other sections.

Each is judged by what was computed for the number that it repeats: a summary that rounds, swaps or takes another range
has a verdict of its own.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Final

from dong2015.row import Row, RowKind, Verdict, comparison_row, undetermined_row
from sonolube.facts.published import ComputedValue, PublishedValue, published_number, published_value
from sonolube.text.units import convert
from sonolube.vocabulary import unit_of

_REPEATED: Final[Mapping[str, str]] = {
    "2.4.6-wear-reduction": "2.4.5-wear-reduction",
    "4.5.6-reduction-from": "4.5.4-reduction-from",
    "4.5.6-reduction-to": "4.5.4-reduction-to",
    "4.5.6-resonance": "4.5.3-mode-closed-top",
    "4.5.6-work-reduction": "4.5.4-work-reduction",
    "abstract-poisson-reduction-from": "2.1.7-transition-reduction-from",
    "abstract-poisson-reduction-to": "2.1.7-transition-reduction-to",
    "abstract-flextensional-reduction": "2.2.6-reduction",
    "5.1.1-poisson-reduction-from": "2.1.7-transition-reduction-from",
    "5.1.1-poisson-reduction-to": "2.1.7-transition-reduction-to",
    "5.1.1-flextensional-reduction": "2.2.6-reduction",
    "5.1.1-tribometer-friction-reduction": "2.3.7-friction-reduction",
    "5.1.1-tribometer-wear-reduction": "2.3.7-wear-reduction",
    "5.1.1-dots": "2.3.4-dots-measured",
    "5.1.1-indentations": "2.3.7-indentations",
    "5.1.1-stick-slip-frequency": "2.3.7-stick-slip-frequency",
    "5.1.1-stick-slip-reduction": "2.3.7-stick-slip-reduction",
    "5.1.1-high-stress": "2.4.6-stress",
    "5.1.1-high-speed": "2.4.6-sliding-speed",
    "5.1.1-high-stress-friction-reduction": "2.4.6-friction-reduction",
    "5.1.1-high-stress-wear-reduction": "2.4.5-wear-reduction",
    "5.1.1-m50-friction-reduction": "2.5.7-friction-reduction",
    "5.1.1-m50-wear-reduction": "2.5.7-wear-reduction",
    "5.1.2-friction-model-error": "3.1.5-error-3",
    "5.1.2-wear-model-error": "3.2.3-error",
    "5.1.2-multi-scale-error": "3.3.6-error",
    "5.1.3-collar-reduction-from": "4.5.4-reduction-from",
    "5.1.3-collar-reduction-to": "4.5.4-reduction-to",
    "5.1.3-collar-work-reduction": "4.5.4-work-reduction",
}
"""Ids of numbers that repeat others, and the rows of those."""

_SETTINGS: Final[Mapping[str, str]] = {
    "5.1.1-tribometer-load": "2.3.7-normal-load",
    "5.1.1-tribometer-amplitude": "2.3.1-amplitude",
    "5.1.1-tribometer-frequency": "2.3.1-frequency",
    "5.1.3-temperature-speed": "4.3.6-sliding-speed",
}
"""Ids of settings that repeat others."""

_STATED_ERRORS: Final = ("5.1.2-friction-model-error", "5.1.2-wear-model-error", "5.1.2-multi-scale-error")


def summary_rows(rows: Mapping[str, Row]) -> Iterator[Row]:
    """Yield the rows of numbers that repeat those of the given rows, by id; of those that are there."""
    for name, repeated in _REPEATED.items():
        if repeated in rows:
            yield _repeating(_published(name), rows[repeated])
    for name, repeated in _SETTINGS.items():
        yield comparison_row(
            name, published_number(repeated).value, f"As printed in {repeated}.", kind=RowKind.PUBLISHED_FORMULA
        )
    largest = max(published_number(name).value for name in _STATED_ERRORS)
    note = "The largest of the limits that D states of its three models in section 5.1.2."
    yield comparison_row("abstract-model-error", largest, note, kind=RowKind.PUBLISHED_FORMULA)


def _published(name: str) -> PublishedValue:
    """Published number by its id, also of one limit of a range."""
    for place, end in enumerate(("-from", "-to")):
        if name.endswith(end):
            return published_value(name.removesuffix(end)).limits()[place]
    return published_value(name)


def _repeating(published: PublishedValue, row: Row) -> Row:
    """Row of a number that repeats that of another row, by what was computed there."""
    note = f"As {row.id}: {row.note}"
    if row.computed is None or row.computed_low is None or row.computed_high is None:
        return replace(undetermined_row(published.id, "", kind=row.kind), verdict=row.verdict, note=note)
    possible = None
    if row.possible_low is not None and row.possible_high is not None:
        possible = (_in_si(row.possible_low, row), _in_si(row.possible_high, row))
    value, low, high = (_in_si(number, row) for number in (row.computed, row.computed_low, row.computed_high))
    computed = ComputedValue(value=value, low=low, high=high)
    fitted = f"as in {row.id}" if row.verdict is Verdict.FITTED else ""
    return comparison_row(published, computed, note, kind=row.kind, fitted=fitted, possible=possible)


def _in_si(value: float, row: Row) -> float:
    """Number of a row in SI."""
    return convert(value, from_unit=row.unit, to_unit=unit_of(row.quantity))
