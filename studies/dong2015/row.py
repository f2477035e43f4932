"""Rows of the reproduction: a published number, the numbers computed for it, and the verdict of their comparison."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import partial
from typing import Final

from sonolube.facts.published import (
    ComputedValue,
    PrintedNumber,
    PublishedValue,
    erratum,
    propagate_rounding,
    published_value,
)
from sonolube.text.units import convert
from sonolube.vocabulary import unit_of


class RowKind(StrEnum):
    """Class of a comparison: what the computed number comes from, and what it is held against."""

    PUBLISHED_FORMULA = "published_formula"
    PUBLISHED_MODEL = "published_model"
    DEFAULT_MODEL = "default_model"


class Verdict(StrEnum):
    """Outcome of the comparison of a computed with a published number."""

    REPRODUCED = "reproduced"
    FITTED = "fitted"
    TRIVIALLY_MET = "trivially_met"
    MISPRINT = "misprint"
    OTHER_AVERAGING = "other_averaging"
    NOT_REPRODUCED = "not_reproduced"
    UNDETERMINED = "undetermined"
    NOT_COMPUTED = "not_computed"


@dataclass(frozen=True, kw_only=True, slots=True)
class Alternative:
    """Number that another model than that of the row gives for the same published number.

    Parameters
    ----------
    computed : float
        Computed value, in the printed unit.
    reproduced : bool
        Whether it is in the interval of the published number.
    note : str
        Method of the computation.
    """

    computed: float
    reproduced: bool
    note: str


Computed = ComputedValue | float
"""Computed number, in SI, with or without the interval that the rounding of its inputs leaves."""

_NO_EFFECT: Final = 0.01
"""Share of the largest reduction that a print leaves open, below which a computed one counts as none. []"""

_LEFT_OPEN: Final = 1 / 3
"""Share of a printed number to either side that its inputs leave open, from which agreement says nothing. []"""


@dataclass(frozen=True, kw_only=True, slots=True)
class Row:
    """One row of the reproduction report; numbers are in the printed unit.

    Parameters
    ----------
    id : str
        Stable id of the row.
    kind : RowKind
    chapter : int
        Chapter of the source.
    source : str
        Place in the source, such as "Table 3.4".
    quantity : str
        Name in the vocabulary.
    unit : str
        Printed unit.
    printed : str
        Printed digits, such as "62.22", "0.379±0.041" or "45.8-48.6"; of a limit of a range, those of the range.
    published : float
        Published value.
    published_low, published_high : float
        Interval in which a computed value counts as reproduced: that of the printed number (rounding, scatter or
        range), widened by the effect of the rounding of printed inputs on the computed value.
    computed : float or None
        Computed value; None where an input is missing.
    computed_low, computed_high : float or None
        What rounding and scatter of the inputs leave it; None where an input is missing.
    verdict : Verdict
    note : str
        Method of the computation, and evidence for the verdict.
    possible_low, possible_high : float or None
        Limits of the computed value over what an input that is not printed can be; None where all are printed or their
        values do not matter.
    alternatives : mapping of str to Alternative
        What other models give for the same number, by name. None of them affects the verdict.
    errata : tuple of str
        Ids of the errata by which the row is a misprint or of other averaging; empty under any other verdict.
    """

    id: str
    kind: RowKind
    chapter: int
    source: str
    quantity: str
    unit: str
    printed: str
    published: float
    published_low: float
    published_high: float
    computed: float | None
    verdict: Verdict
    note: str
    computed_low: float | None = None
    computed_high: float | None = None
    possible_low: float | None = None
    possible_high: float | None = None
    alternatives: Mapping[str, Alternative] = field(default_factory=dict)
    errata: tuple[str, ...] = ()

    @property
    def is_upper_limit(self) -> bool:
        """Whether the print says "less than" the published value."""
        return self.published_low == 0 < self.published == self.published_high

    @property
    def relative_error(self) -> float | None:
        """Computed over published value, minus one; None where either is missing or the published one is zero."""
        if self.computed is None or self.published == 0:
            return None
        return self.computed / self.published - 1


def comparison_row(
    published: PublishedValue | str,
    computed: Computed,
    note: str,
    *,
    kind: RowKind,
    suffix: str = "",
    fitted: str = "",
    trivial: str = "",
    possible: tuple[float, float] | None = None,
    alternatives: Mapping[str, tuple[Computed, str]] | None = None,
) -> Row:
    """Row that compares a computed with a published number.

    `undetermined` if some possible values agree with the print and others do not. Else `reproduced` within the interval
    that print, scatter and rounding leave, `fitted` if the number itself entered the computation, `trivially_met` if a
    reduction of zero is left open, as "less than 10 %" does, and none is computed, if the inputs leave a third of the
    number open to either side, or for a stated reason for which the comparison could not fail. Outside it, if the row
    is of a published formula, a correction with evidence is on record and the computed number agrees with it,
    `misprint`, or `other_averaging` where the erratum is of that kind; else `not_reproduced`: that a model misses a
    test says nothing against the print.
    """
    published = published_value(published) if isinstance(published, str) else published
    computed = _with_interval(computed)
    if possible is not None and not fitted and _is_open(published.number, computed, possible):
        verdict = Verdict.UNDETERMINED
    elif _agree(published.number, computed):
        verdict = _met(published, computed, fitted=fitted, trivial=trivial)
    elif kind is RowKind.PUBLISHED_FORMULA and _meets_correction(published, computed):
        verdict, note = _contradicted(published), f"{note.rstrip('.')}. {published.evidence}"
    else:
        verdict = Verdict.NOT_REPRODUCED
    if verdict is Verdict.FITTED:
        note = f"{note.rstrip('.')}. Fitted to this number: {fitted}."
    if verdict is Verdict.TRIVIALLY_MET and (reason := trivial or _left_open(published, computed)):
        note = f"{note.rstrip('.')}. Could not fail: {reason}."
    others = {
        name: Alternative(
            computed=_printed(published, _with_interval(other).value),
            reproduced=_agree(published.number, _with_interval(other)),
            note=other_note,
        )
        for name, (other, other_note) in (alternatives or {}).items()
    }
    interval = _interval(published.number, computed)
    row = replace(
        _row(published, suffix, interval, computed.value, verdict, note, kind=kind, alternatives=others),
        computed_low=_printed(published, computed.low),
        computed_high=_printed(published, computed.high),
    )
    if verdict in (Verdict.MISPRINT, Verdict.OTHER_AVERAGING):
        row = replace(row, errata=published.errata)
    if possible is None:
        return row
    low, high = (_printed(published, limit) for limit in sorted((*possible, computed.value))[::2])
    return replace(row, possible_low=low, possible_high=high)


published_formula_row: Final = partial(comparison_row, kind=RowKind.PUBLISHED_FORMULA)
"""Row of a published formula on published numbers."""
published_model_row: Final = partial(comparison_row, kind=RowKind.PUBLISHED_MODEL)
"""Row of a published model against a published test."""
default_model_row: Final = partial(comparison_row, kind=RowKind.DEFAULT_MODEL)
"""Row of a default model of this program against a published test."""


def formula_row(
    published: PublishedValue | str, note: str, formula: Callable[..., float], *inputs: PrintedNumber | str
) -> Row:
    """Row of a published number that follows from others by a formula, with their rounding propagated."""
    return published_formula_row(published, propagate_rounding(formula, *inputs), note)


def range_rows(published: str, low: Computed, high: Computed, note: str, *, high_note: str = "") -> Iterator[Row]:
    """Yield the rows of the limits of a published range that follow from a published formula."""
    lower, upper = published_value(published).limits()
    yield published_formula_row(lower, low, note)
    yield published_formula_row(upper, high, high_note or note)


def at_least(published: str, computed: Computed) -> PublishedValue:
    """Published lower limit, such as "more than 100 %", whose interval reaches up to a computed number above it."""
    value, number = published_value(published), published_value(published).number
    reached = max(number.value, _with_interval(computed).value)
    return replace(value, number=replace(number, low=number.value, high=reached))


def undetermined_row(published: str, missing: str, *, kind: RowKind = RowKind.PUBLISHED_FORMULA) -> Row:
    """Row of a published number that nobody can compute, for an input of it is not printed."""
    return _row_without_number(published, Verdict.UNDETERMINED, f"Missing: {missing}", kind=kind)


def not_computed_row(published: str, missing: str, *, kind: RowKind) -> Row:
    """Row of a published number that this installation cannot compute."""
    return _row_without_number(published, Verdict.NOT_COMPUTED, f"Not computed: {missing}", kind=kind)


def _row_without_number(published: str, verdict: Verdict, note: str, *, kind: RowKind) -> Row:
    """Row without a computed number."""
    value = published_value(published)
    return _row(value, "", (value.number.low, value.number.high), None, verdict, note, kind=kind)


def _with_interval(computed: Computed) -> ComputedValue:
    """Computed number with its interval, empty if none is given."""
    if isinstance(computed, ComputedValue):
        return computed
    return ComputedValue(value=computed, low=computed, high=computed)


def _met(published: PublishedValue, computed: ComputedValue, *, fitted: str, trivial: str) -> Verdict:
    """Verdict of a computed number that agrees with the print."""
    if fitted:
        return Verdict.FITTED
    could_not_fail = trivial or _is_trivial(published, computed) or _left_open(published, computed)
    return Verdict.TRIVIALLY_MET if could_not_fail else Verdict.REPRODUCED


def _left_open(published: PublishedValue, computed: ComputedValue) -> str:
    """What the inputs leave open, where that is a third of a number to either side; empty where it is less."""
    left, printed = computed.high - computed.low, abs(published.number.value)
    if not printed or left < 2 * _LEFT_OPEN * printed:
        return ""
    low, high = (_printed(published, limit) for limit in (computed.low, computed.high))
    return f"scatter and rounding of its inputs leave {low:.3g} to {high:.3g}".rstrip()


def _contradicted(published: PublishedValue) -> Verdict:
    """Verdict of a number that meets the correction of a print, by the kind of its erratum."""
    kinds = {erratum(name).kind for name in published.errata}
    return Verdict.OTHER_AVERAGING if kinds == {"other averaging"} else Verdict.MISPRINT


def _is_open(number: PrintedNumber, computed: ComputedValue, possible: tuple[float, float]) -> bool:
    """Whether some, and not all, of the possible values agree with a printed number."""
    low, high = _interval(number, computed)
    least, most = min(*possible, computed.value), max(*possible, computed.value)
    return least <= high and low <= most and not (low <= least and most <= high)


def _meets_correction(published: PublishedValue, computed: ComputedValue) -> bool:
    """Whether there is evidence against a print, and its correction, unless in words, is the computed number."""
    if not published.evidence:
        return False
    return not published.corrected or any(_agree(corrected, computed) for corrected in published.corrected)


def _is_trivial(published: PublishedValue, computed: ComputedValue) -> bool:
    """Whether print and scatter leave a reduction of zero open, as "less than 10 %", and no more is computed."""
    number = published.number
    return (
        published.quantity.endswith("_reduction")
        and number.low <= 0 < number.high
        and abs(computed.value) < _NO_EFFECT * number.high
    )


def _interval(number: PrintedNumber, computed: ComputedValue) -> tuple[float, float]:
    """Interval of a printed number, widened by that of the computed one, in SI."""
    return number.low - (computed.high - computed.value), number.high + (computed.value - computed.low)


def _agree(number: PrintedNumber, computed: ComputedValue) -> bool:
    """Whether a computed number lies in the widened interval of a printed one."""
    low, high = _interval(number, computed)
    slack = 1e-9 * max(abs(low), abs(high))  # binary rounding of decimal halves
    return low - slack <= computed.value <= high + slack


def _printed(published: PublishedValue, value: float) -> float:
    """Value in the printed unit."""
    return convert(value, from_unit=unit_of(published.quantity), to_unit=published.unit)


def _row(
    published: PublishedValue,
    suffix: str,
    interval: tuple[float, float],
    computed: float | None,
    verdict: Verdict,
    note: str,
    *,
    kind: RowKind,
    alternatives: Mapping[str, Alternative] | None = None,
) -> Row:
    """Row, its numbers converted to the printed unit."""
    low, high = interval
    return Row(
        id=f"{published.id}-{suffix}" if suffix else published.id,
        kind=kind,
        chapter=published.chapter,
        source=published.source,
        quantity=published.quantity,
        unit=published.unit,
        printed=published.number.text,
        published=_printed(published, published.number.value),
        published_low=_printed(published, low),
        published_high=_printed(published, high),
        computed=None if computed is None else _printed(published, computed),
        verdict=verdict,
        note=note,
        alternatives=alternatives or {},
    )
