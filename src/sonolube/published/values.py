"""Published numbers with their place, range and errata, and computed numbers with the range that rounding leaves."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import product

from sonolube.errors import InvalidInput
from sonolube.published.number import PrintedNumber, parse_printed
from sonolube.published.running_text import statement
from sonolube.published.tidy_table import table

_PROTOCOL_CHAPTER = 2  # appendix A is the protocol of that chapter's tests


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
    reason : str
        Why the printed number cannot be right; empty where nothing speaks against it.
    right : tuple of PrintedNumber
        What it should have been, where the correction is a number.
    """

    id: str
    chapter: int
    source: str
    quantity: str
    unit: str
    number: PrintedNumber
    reason: str
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
    corrections = [each for each in source.corrections if (each.column, each.row) == (column, row)]
    return Published(
        id=f"table-{table_id}-{column}-{row + 1}".replace("_", "-"),
        chapter=int(table_id[0]),
        source=f"Table {table_id}",
        quantity=printed.quantity,
        unit=printed.unit,
        number=number,
        reason=" ".join(f"{each.reason} [{each.erratum}]" for each in corrections),
        right=tuple(
            number
            for each in corrections
            for number in _alternatives(each.right, printed.quantity, printed.unit, printed.scale)
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
        reason=f"{source.reason} [{source.erratum}]" if source.reason else "",
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
