"""One published number beside the number computed for it, and the verdict on the two."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from enum import StrEnum
from itertools import product

from sonolube.errors import InvalidInput
from sonolube.published import PrintedNumber, parse_printed, statement, table
from sonolube.units import convert
from sonolube.vocabulary import unit_of

_PROTOCOL_CHAPTER = 2  # appendix A is the protocol of that chapter's tests


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


@dataclass(frozen=True, kw_only=True, slots=True)
class Published:
    """One published number in its place.

    Parameters
    ----------
    id, source, quantity, unit : str
        As in `Row`.
    chapter : int
        As in `Row`.
    number : PrintedNumber
        The number and its range, in SI.
    doubt : str
        Why the printed number cannot be right; empty where nothing speaks against it.
    right : tuple of PrintedNumber
        What it should have been, where the doubt puts that in numbers.
    """

    id: str
    chapter: int
    source: str
    quantity: str
    unit: str
    number: PrintedNumber
    doubt: str
    right: tuple[PrintedNumber, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class Computed:
    """A computed number, with the range that the rounding of its printed inputs leaves open; in SI."""

    value: float
    low: float
    high: float


def cell(table_id: str, column: str, row: int) -> Published:
    """Return one cell of a published table; `row` counts from 0.

    Raises
    ------
    UnknownName
        If there is no such table.
    """
    source = table(table_id)
    printed = source.columns[column]
    number = printed.cells[row]
    assert number is not None, f"table {table_id}, {column}, row {row} is empty"
    doubts = [doubt for doubt in source.doubts if (doubt.column, doubt.row) == (column, row)]
    return Published(
        id=f"table-{table_id}-{column}-{row + 1}".replace("_", "-"),
        chapter=int(table_id[0]),
        source=f"Table {table_id}",
        quantity=printed.quantity,
        unit=printed.unit,
        number=number,
        doubt=" ".join(f"{doubt.reason} [{doubt.erratum}]" for doubt in doubts),
        right=tuple(
            number
            for doubt in doubts
            for number in _alternatives(doubt.right, printed.quantity, printed.unit, printed.scale)
        ),
    )


def stated(statement_id: str) -> Published:
    """Return one number of the running text.

    Raises
    ------
    UnknownName
        If there is no such statement.
    """
    source = statement(statement_id)
    in_appendix = source.section.startswith("A")
    return Published(
        id=statement_id,
        chapter=_PROTOCOL_CHAPTER if in_appendix else int(source.section[0]),
        source=f"Appendix {source.section}" if in_appendix else f"Section {source.section}",
        quantity=source.quantity,
        unit=source.unit,
        number=replace(source.number, low=0.0, high=source.number.value) if source.relation == "<" else source.number,
        doubt=f"{source.doubt} [{source.erratum}]" if source.doubt else "",
        right=_alternatives(source.right, source.quantity, source.unit, 1.0),
    )


def _alternatives(text: str, quantity: str, unit: str, scale: float) -> tuple[PrintedNumber, ...]:
    """Return the numbers of a correction such as "40-240 or 60-240"; none of one in words."""
    numbers = []
    for alternative in text.split(" or "):
        with suppress(InvalidInput):
            numbers.append(parse_printed(alternative.replace(" to ", "-"), unit, scale, quantity=quantity))
    return tuple(numbers)


def over_rounding(function: Callable[..., float], *inputs: PrintedNumber) -> Computed:
    """Evaluate `function` at printed inputs and at every corner of their rounding.

    Parameters
    ----------
    function : callable
        Of as many numbers in SI as there are inputs; monotone in each over half a digit.
    *inputs : PrintedNumber
        What it is evaluated at.

    Returns
    -------
    Computed
    """
    corners = product(*[(number.value - number.half_digit, number.value + number.half_digit) for number in inputs])
    values = [float(function(*corner)) for corner in corners]
    return Computed(value=float(function(*[number.value for number in inputs])), low=min(values), high=max(values))


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
        `reproduced` inside the range that print and rounding leave; else `misprint` where a doubt with its evidence is
        on record and the computed number is what it says is right; else `model_disagrees`.
    """
    if not isinstance(computed, Computed):
        computed = Computed(value=computed, low=computed, high=computed)
    low, high = _range(published.number, computed)
    if _agree(published.number, computed):
        verdict = Verdict.REPRODUCED
    elif published.doubt and (not published.right or any(_agree(right, computed) for right in published.right)):
        verdict, note = Verdict.MISPRINT, f"{note.rstrip('.')}. {published.doubt}"
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
