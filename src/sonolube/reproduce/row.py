"""Rows of the reproduction: a published number, the number computed for it, and the verdict of their comparison."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum

from sonolube.published import ComputedValue, PrintedNumber, PublishedValue, propagate_rounding, published_value
from sonolube.units import convert
from sonolube.vocabulary import unit_of


class Verdict(StrEnum):
    """Outcome of the comparison of a computed with a published number."""

    REPRODUCED = "reproduced"
    MISPRINT = "misprint"
    UNDETERMINED = "undetermined"
    MODEL_DISAGREES = "model_disagrees"


@dataclass(frozen=True, kw_only=True, slots=True)
class Row:
    """One row of the reproduction report; numbers are in the printed unit.

    Parameters
    ----------
    id : str
        Stable id of the row.
    chapter : int
        Chapter of the source.
    source : str
        Place in the source, such as "Table 3.4".
    quantity : str
        Name in the vocabulary.
    unit : str
        Printed unit.
    published : float
        Published value.
    published_low, published_high : float
        Interval in which a computed value counts as reproduced: that of the printed number (rounding, scatter or
        range), widened by the effect of the rounding of printed inputs on the computed value.
    computed : float or None
        Computed value; None where an input is missing.
    verdict : Verdict
    note : str
        Method of the computation, and evidence for the verdict.
    """

    id: str
    chapter: int
    source: str
    quantity: str
    unit: str
    published: float
    published_low: float
    published_high: float
    computed: float | None
    verdict: Verdict
    note: str

    @property
    def relative_error(self) -> float | None:
        """Computed over published value, minus one; None where either is missing or the published one is zero."""
        if self.computed is None or self.published == 0:
            return None
        return self.computed / self.published - 1


def comparison_row(
    published: PublishedValue | str, computed: ComputedValue | float, note: str, *, suffix: str = ""
) -> Row:
    """Return the row that compares a computed with a published number.

    Parameters
    ----------
    published : PublishedValue or str
        Published value, or its id.
    computed : ComputedValue or float
        Computed value, in SI.
    note : str
        Method of the computation.
    suffix : str
        Suffix of the row's id, where several numbers are computed for one published number.

    Returns
    -------
    Row
        `reproduced` within the interval that print and rounding leave; else `misprint` if a correction with evidence
        is on record and the computed number agrees with it; else `model_disagrees`.
    """
    published = published_value(published) if isinstance(published, str) else published
    if not isinstance(computed, ComputedValue):
        computed = ComputedValue(value=computed, low=computed, high=computed)
    if _agree(published.number, computed):
        verdict = Verdict.REPRODUCED
    elif published.evidence and (
        not published.corrected or any(_agree(corrected, computed) for corrected in published.corrected)
    ):
        verdict, note = Verdict.MISPRINT, f"{note.rstrip('.')}. {published.evidence}"
    else:
        verdict = Verdict.MODEL_DISAGREES
    return _row(published, suffix, _interval(published.number, computed), computed.value, verdict, note)


def formula_row(
    published: PublishedValue | str, note: str, formula: Callable[..., float], *inputs: PrintedNumber | str
) -> Row:
    """Return the row of a published number that follows from others by a formula, with their rounding propagated.

    Parameters
    ----------
    published : PublishedValue or str
        The published number, or its id.
    note : str
        Formula in words.
    formula : callable
        Function of the inputs.
    *inputs : PrintedNumber or str
        Published numbers, or their ids.

    Returns
    -------
    Row
    """
    return comparison_row(published, propagate_rounding(formula, *inputs), note)


def range_rows(
    published: str, low: ComputedValue | float, high: ComputedValue | float, note: str, *, high_note: str = ""
) -> Iterator[Row]:
    """Yield the rows of the limits of a published range.

    Parameters
    ----------
    published : str
        Id of the published range.
    low, high : ComputedValue or float
        Computed limits, in SI.
    note : str
        Method of the computation.
    high_note : str
        Method of the computation of the upper limit, if another.

    Yields
    ------
    Row
    """
    lower, upper = published_value(published).limits()
    yield comparison_row(lower, low, note)
    yield comparison_row(upper, high, high_note or note)


def undetermined_row(published: str, missing: str) -> Row:
    """Return the row of a published number that cannot be computed.

    Parameters
    ----------
    published : str
        Id of the published number.
    missing : str
        Inputs that are not printed.

    Returns
    -------
    Row
    """
    value = published_value(published)
    interval = value.number.low, value.number.high
    return _row(value, "", interval, None, Verdict.UNDETERMINED, f"Missing: {missing}")


def _interval(number: PrintedNumber, computed: ComputedValue) -> tuple[float, float]:
    """Return the interval of a printed number, widened by that of the computed one, in SI."""
    return number.low - (computed.high - computed.value), number.high + (computed.value - computed.low)


def _agree(number: PrintedNumber, computed: ComputedValue) -> bool:
    """Return whether a computed number lies in the widened interval of a printed one."""
    low, high = _interval(number, computed)
    slack = 1e-9 * max(abs(low), abs(high))  # binary rounding of decimal halves
    return low - slack <= computed.value <= high + slack


def _row(
    published: PublishedValue,
    suffix: str,
    interval: tuple[float, float],
    computed: float | None,
    verdict: Verdict,
    note: str,
) -> Row:
    """Return a row, its numbers converted to the printed unit."""

    def printed(value: float) -> float:
        return convert(value, from_unit=unit_of(published.quantity), to_unit=published.unit)

    low, high = interval
    return Row(
        id=f"{published.id}-{suffix}" if suffix else published.id,
        chapter=published.chapter,
        source=published.source,
        quantity=published.quantity,
        unit=published.unit,
        published=printed(published.number.value),
        published_low=printed(low),
        published_high=printed(high),
        computed=None if computed is None else printed(computed),
        verdict=verdict,
        note=note,
    )
