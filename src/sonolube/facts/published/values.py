"""Published values by id: number, rounding interval, place in the dissertation and errata.

The id of a quoted number is that of its `Statement`, such as "2.1.3-first-mode-steel". The id of a table cell joins
number of the table, column and row, counted from 1: "table-2.3-friction-force-2". Rounding intervals of printed inputs
propagate to a computed value by evaluation at their corners.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from typing import Final

from sonolube.errors import InvalidInput
from sonolube.facts.published.printed_tables import PrintedNumber, parse_printed, table
from sonolube.facts.published.running_text import Statement, statement

ABOUT: Final = 0.1
"""Share of a number that D states as "about" by which another may differ from it; a convention, D gives none. []"""

_CHAPTERS = {"A": 2, "a": 5}  # of the appendix, protocol of the tests of that chapter, and of the abstract, a summary


@dataclass(frozen=True, kw_only=True, slots=True)
class PublishedValue:
    """One published number with its place and its errata.

    Parameters
    ----------
    id : str
        Id of the statement or table cell.
    chapter : int
        Chapter of D; 2 for appendix A, 5 for the abstract.
    source : str
        Place in D, such as "Table 3.4".
    quantity : str
        Name in the vocabulary; empty for a pure number that has none.
    unit : str
        Printed unit.
    number : PrintedNumber
        Number with its interval, in SI. That of a statement "less than" runs from zero, that of one "about" over at
        least `ABOUT` of the number to either side.
    evidence : str
        Evidence against the print with the id of the erratum; empty where there is none.
    errata : tuple of str
        Ids of the errata that the evidence belongs to.
    corrected : tuple of PrintedNumber
        Corrected numbers, in SI; empty where there is no correction or it is in words.
    """

    id: str
    chapter: int
    source: str
    quantity: str
    unit: str
    number: PrintedNumber
    evidence: str
    errata: tuple[str, ...]
    corrected: tuple[PrintedNumber, ...]

    def limits(self) -> "tuple[PublishedValue, PublishedValue]":
        """Limits of a published range as two values, their ids ending in "-from" and "-to"."""
        low, high = self.number.limits()
        return replace(self, id=f"{self.id}-from", number=low), replace(self, id=f"{self.id}-to", number=high)


@cache
def published_value(id: str) -> PublishedValue:  # noqa: A002 - the field's own word
    """Published number with its place and its errata.

    Parameters
    ----------
    id : str
        Id of a statement, such as "2.1.3-first-mode-steel", or of a table cell, such as "table-2.3-friction-force-2";
        the column may keep its underscores.

    Returns
    -------
    PublishedValue

    Raises
    ------
    UnknownName
        If there is no such table or statement.
    InvalidInput
        If the table has no such column or row, or the cell has no number.
    """
    return _table_cell(id) if id.startswith("table-") else _quoted_number(id)


def published_number(id: str) -> PrintedNumber:  # noqa: A002 - the field's own word
    """Published number with its printed digits and interval, in SI.

    Parameters
    ----------
    id : str
        As in `published_value`.

    Returns
    -------
    PrintedNumber

    Examples
    --------
    >>> from sonolube.facts.published import published_number
    >>> number = published_number("table-2.5-wear-reduction-1")
    >>> number.text, number.value
    ('45.76', 0.4576)
    """
    return _table_cell(id).number if id.startswith("table-") else statement(id).number


def si_value(id: str) -> float:  # noqa: A002 - the field's own word
    """Published number as a float in SI; of a range, its midpoint.

    Parameters
    ----------
    id : str
        As in `published_value`.

    Returns
    -------
    float
    """
    return published_number(id).value


def column_numbers(table_id: str, column: str) -> dict[int, PrintedNumber]:
    """Numbers of a table column by row, counted from 1; empty cells are left out.

    Parameters
    ----------
    table_id : str
        Number of the table, such as "4.1".
    column : str
        Name of the column.

    Returns
    -------
    dict of int to PrintedNumber
    """
    cells = enumerate(table(table_id).columns[column].cells, start=1)
    return {row: number for row, number in cells if number is not None}


@cache
def _table_cell(id: str) -> PublishedValue:  # noqa: A002 - the field's own word
    """Published value of a table cell by its id."""
    _, table_id, *words, last = id.split("-")
    source, name = table(table_id), "_".join(words)
    column = source.columns.get(name)
    if column is None:
        raise InvalidInput(f"{id}: table {table_id} has no column {name}; its columns: {', '.join(source.columns)}")
    row = int(last) - 1 if last.isdigit() else -1
    number = column.cells[row] if 0 <= row < len(column.cells) else None
    if number is None:
        raise InvalidInput(f"{id}: table {table_id} has no number in row {last} of column {name}")
    corrections = [each for each in source.corrections if (each.column, each.row) == (name, row)]
    return PublishedValue(
        id=id.replace("_", "-"),
        chapter=int(table_id[0]),
        source=f"Table {table_id}",
        quantity=column.quantity,
        unit=column.unit,
        number=number,
        evidence=" ".join(f"{each.evidence} [{each.erratum}]" for each in corrections),
        errata=tuple(each.erratum for each in corrections),
        corrected=tuple(
            corrected
            for each in corrections
            for corrected in _corrected_numbers(each.corrected, column.quantity, column.unit, column.scale)
        ),
    )


def _quoted_number(id: str) -> PublishedValue:  # noqa: A002 - the field's own word
    """Published value of a number in the running text by its id."""
    source = statement(id)
    first = source.section[0]
    place = {"A": f"Appendix {source.section}", "a": "Abstract"}.get(first, f"Section {source.section}")
    return PublishedValue(
        id=id,
        chapter=_CHAPTERS[first] if first in _CHAPTERS else int(first),
        source=place,
        quantity=source.quantity,
        unit=source.unit,
        number=_number_in_words(source),
        evidence=f"{source.evidence} [{source.erratum}]" if source.evidence else "",
        errata=(source.erratum,) if source.erratum else (),
        corrected=_corrected_numbers(source.corrected, source.quantity, source.unit, 1.0),
    )


def _number_in_words(source: Statement) -> PrintedNumber:
    """Number of a statement with the interval that the words before it leave: "less than" or "about"."""
    number = source.number
    if source.relation == "<":
        return replace(number, low=0.0, high=number.value)
    if source.relation == "about":
        reach = ABOUT * abs(float(number.text))
        widened = parse_printed(f"{number.text}±{reach:f}", source.unit, quantity=source.quantity)
        return replace(number, low=min(number.low, widened.low), high=max(number.high, widened.high))
    return number


def _corrected_numbers(text: str, quantity: str, unit: str, scale: float) -> tuple[PrintedNumber, ...]:
    """Numbers of a correction such as "40-240 or 60-240"; none of one in words."""
    numbers = []
    for alternative in text.split(" or "):
        with suppress(InvalidInput):
            numbers.append(parse_printed(alternative.replace(" to ", "-"), unit, scale, quantity=quantity))
    return tuple(numbers)


@dataclass(frozen=True, kw_only=True, slots=True)
class ComputedValue:
    """Value computed from printed inputs, with the interval that their rounding leaves; in SI.

    Parameters
    ----------
    value : float
        Value at the printed inputs.
    low, high : float
        Limits of the interval.

    Notes
    -----
    Computed values are ordered by `value`, so that `max` and `min` select the largest and the smallest one.
    """

    value: float
    low: float
    high: float

    def __lt__(self, other: "ComputedValue") -> bool:
        return self.value < other.value


def propagate_rounding(function: Callable[..., float], *inputs: PrintedNumber | str) -> ComputedValue:
    r"""Function of printed numbers with the interval that their rounding leaves.

    Parameters
    ----------
    function : callable
        Function of as many numbers in SI as there are inputs; monotonic in each over its rounding interval.
    *inputs : PrintedNumber or str
        Printed numbers, or ids of published ones as in `published_number`.

    Returns
    -------
    ComputedValue

    See Also
    --------
    as_exact, as_setting : Printed numbers without a rounding interval.

    Notes
    -----
    .. math:: \left[\min_s f(x_1 + s_1 h_1, \dots), \max_s f(x_1 + s_1 h_1, \dots)\right], \qquad s_i = \pm 1

    with the printed values x and the half-widths h of their rounding intervals. The corners of the box of inputs bound
    a function that is monotonic in each input.

    Examples
    --------
    >>> from sonolube.facts.published import parse_printed, propagate_rounding
    >>> forces = [parse_printed(text, "N", quantity="friction_force") for text in ("1.02", "0.36")]
    >>> reduction = propagate_rounding(lambda without, under: 1 - under / without, *forces)
    >>> round(reduction.low, 3), round(reduction.high, 3)  # 1 - 0.365/1.015, 1 - 0.355/1.025
    (0.64, 0.654)
    """
    numbers = [published_number(number) if isinstance(number, str) else number for number in inputs]
    intervals = [
        (number.value - number.rounding_half_width, number.value + number.rounding_half_width) for number in numbers
    ]
    values = [float(function(*corner)) for corner in product(*intervals)]
    return ComputedValue(
        value=float(function(*[number.value for number in numbers])), low=min(values), high=max(values)
    )


def as_exact(id: str) -> PrintedNumber:  # noqa: A002 - the field's own word
    """Published number without a rounding interval: that of a nominal setting."""
    number = published_number(id)
    return replace(number, low=number.value, high=number.value, rounding_half_width=0.0)


def as_setting(id: str) -> PrintedNumber:  # noqa: A002 - the field's own word
    """Published setting: exact if printed as a whole number, such as 11 turns or 4 h, else rounded."""
    return published_number(id) if "." in published_number(id).text else as_exact(id)
