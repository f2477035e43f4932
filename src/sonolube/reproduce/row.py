"""One published number beside the number computed for it, and the verdict on the two."""

from dataclasses import dataclass
from enum import StrEnum

from sonolube.published import PrintedNumber
from sonolube.published.values import Computed, Published
from sonolube.units import convert
from sonolube.vocabulary import unit_of


class Verdict(StrEnum):
    """What a comparison shows."""

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
        Stable name of the row.
    chapter : int
        Chapter of the source.
    source : str
        Place in the source, such as "Table 3.4".
    quantity : str
        Name in the vocabulary.
    unit : str
        Unit as printed.
    published : float
        The printed value.
    published_low, published_high : float
        Range in which a computed value counts as reproduced: half the last printed digit or the stated scatter,
        widened by what the rounding of printed inputs does to the computed value.
    computed : float or None
        The computed value; None where an input is missing.
    verdict : Verdict
    note : str
        How it was computed, and what the verdict rests on.
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
        """Computed over published, less one; None where either is missing or zero was published."""
        if self.computed is None or self.published == 0:
            return None
        return self.computed / self.published - 1


def compare(published: Published, computed: Computed | float, note: str) -> Row:
    """Set a computed number beside a published one.

    Parameters
    ----------
    published : Published
    computed : Computed or float
        In SI.
    note : str
        How it was computed.

    Returns
    -------
    Row
        `reproduced` inside the range that print and rounding leave; else `misprint` where a correction with its
        evidence is on record and the computed number is what it says is right; else `model_disagrees`.
    """
    if not isinstance(computed, Computed):
        computed = Computed(value=computed, low=computed, high=computed)
    low, high = _range(published.number, computed)
    if _agree(published.number, computed):
        verdict = Verdict.REPRODUCED
    elif published.reason and (not published.right or any(_agree(right, computed) for right in published.right)):
        verdict, note = Verdict.MISPRINT, f"{note.rstrip('.')}. {published.reason}"
    else:
        verdict = Verdict.MODEL_DISAGREES
    return _row(published, low, high, computed.value, verdict, note)


def _range(number: PrintedNumber, computed: Computed) -> tuple[float, float]:
    return number.low - (computed.high - computed.value), number.high + (computed.value - computed.low)


def _agree(number: PrintedNumber, computed: Computed) -> bool:
    low, high = _range(number, computed)
    slack = 1e-9 * max(abs(low), abs(high))  # binary rounding of decimal halves
    return low - slack <= computed.value <= high + slack


def undetermined(published: Published, missing: str) -> Row:
    """Return the row of a number that cannot be computed, naming the missing input."""
    return _row(
        published, published.number.low, published.number.high, None, Verdict.UNDETERMINED, f"Missing: {missing}"
    )


def _row(published: Published, low: float, high: float, computed: float | None, verdict: Verdict, note: str) -> Row:
    def printed(value: float) -> float:
        return convert(value, from_unit=unit_of(published.quantity), to_unit=published.unit)

    return Row(
        id=published.id,
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
