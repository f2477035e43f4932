"""Tables of the dissertation as tidy data, their printed numbers, and its errata.

One row for each condition, one column for each quantity. Digits of a printed number have their rounding interval,
stated scatter or stated range, converted to SI; errata and corrections of single cells have their evidence.
"""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal

from sonolube.errors import InvalidInput, UnknownName, entry_named
from sonolube.text.units import convert
from sonolube.vocabulary import unit_of

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr
    from numpy.typing import NDArray


@cache
def published_content(*path: str) -> dict[str, Any]:
    """Content of a TOML file of this package."""
    return tomllib.loads(files("sonolube.facts.published").joinpath(*path).read_text(encoding="utf-8"))


_DIGITS = r"(?:\d+(?:\.\d*)?|\.\d+)(?:e[-+]?\d+)?"
_PRINTED = re.compile(rf"(?P<first>[-+]?{_DIGITS})(?:±(?P<scatter>{_DIGITS})|-(?P<last>{_DIGITS}))?")


@dataclass(frozen=True, kw_only=True, slots=True)
class PrintedNumber:
    """Number as printed, with the interval that the print leaves open; in SI.

    Parameters
    ----------
    text : str
        Printed digits, such as "2.237", "1.024±0.063" or "10.73-13.02".
    value : float
        Value; of a range, its midpoint.
    low, high : float
        Limits of the stated range or scatter; where neither is stated, of the rounding interval.
    rounding_half_width : float
        Half-width of the rounding interval, half a unit of the last printed digit; of a range, that of the limit with
        more digits.
    """

    text: str
    value: float
    low: float
    high: float
    rounding_half_width: float

    def limits(self) -> "tuple[PrintedNumber, PrintedNumber]":
        """Lower and the upper limit of a printed range as numbers with their rounding intervals."""
        h = self.rounding_half_width
        low, high = (replace(self, value=limit, low=limit - h, high=limit + h) for limit in (self.low, self.high))
        return low, high


def parse_printed(text: str, unit: str = "", scale: float = 1.0, *, quantity: str = "") -> PrintedNumber:
    """Printed number with its interval, in SI.

    Parameters
    ----------
    text : str
        One number, "mean±scatter" or "low-high"; powers of ten as in "3.17e8".
    unit : str
        Printed unit, such as "mm/s" or "%".
    scale : float
        Power of ten that a table heading puts before the unit.
    quantity : str
        Quantity by its name in the vocabulary; empty for a pure number.

    Returns
    -------
    PrintedNumber

    Raises
    ------
    InvalidInput
        If the text has another form, the limits of a range are in falling order, or the unit is not one of the
        quantity.

    Examples
    --------
    >>> from sonolube.facts.published import parse_printed
    >>> speed = parse_printed("20.3", "mm/s", quantity="sliding_speed")
    >>> round(speed.low, 6), round(speed.high, 6)
    (0.02025, 0.02035)
    """
    match = _PRINTED.fullmatch(text)
    if match is None:
        raise InvalidInput(f"{text!r} is not a printed number; write one such as '2.237', '1.33±0.1' or '25-48'")
    first = float(match["first"])
    half_width = _rounding_half_width(match["first"])
    if match["last"]:
        low, high = first, float(match["last"])
        half_width = min(half_width, _rounding_half_width(match["last"]))
    else:
        scatter = float(match["scatter"]) if match["scatter"] else half_width
        low, high = first - scatter, first + scatter
    if low > high:
        raise InvalidInput(f"{text!r} is a range in falling order; write the smaller limit first")
    factor, origin = _conversion(unit, unit_of(quantity))
    step = factor * scale
    return PrintedNumber(
        text=text,
        value=origin + step * ((low + high) / 2 if match["last"] else first),
        low=origin + step * low,
        high=origin + step * high,
        rounding_half_width=step * half_width,
    )


def _rounding_half_width(digits: str) -> float:
    """Half a unit of the last digit of a number in decimal or exponential notation."""
    mantissa, _, exponent = digits.partition("e")
    decimals = len(mantissa.partition(".")[2])
    return float(f"5e{int(exponent or 0) - decimals - 1}")


@cache
def _conversion(unit: str, si_unit: str) -> tuple[float, float]:
    """Factor and origin of a unit in its SI unit, such as (1, 273.15) for degC in K."""
    if unit == si_unit:
        return 1.0, 0.0
    origin = convert(0.0, from_unit=unit, to_unit=si_unit)
    return convert(1.0, from_unit=unit, to_unit=si_unit) - origin, origin


@dataclass(frozen=True, kw_only=True, slots=True)
class Erratum:
    """Misprint or contradiction in D, with its correction, or a number that D averages in another way than it says.

    Parameters
    ----------
    id : str
        Number of the erratum, such as "E17".
    location : str
        Equation, table or section of D.
    printed : str
        Printed text.
    corrected : str
        Text that should stand there, or a note that all readings are kept.
    evidence : str
        Evidence for the correction.
    kind : "misprint" or "other averaging"
        The second where both numbers may stand, as of the same measurement averaged in two ways.
    """

    id: str
    location: str
    printed: str
    corrected: str
    evidence: str
    kind: Literal["misprint", "other averaging"] = "misprint"


@dataclass(frozen=True, kw_only=True, slots=True)
class Correction:
    """Correction of one cell or one heading of a table.

    Parameters
    ----------
    column : str
        Column of the table.
    printed : str
        Digits or heading as printed.
    corrected : str
        Corrected digits where arithmetic settles them, else words.
    evidence : str
        Evidence against the print.
    erratum : str
        Id of the erratum that the correction belongs to.
    row : int or None
        Row of the cell, counted from 0; None for the heading or the whole column.
    """

    column: str
    printed: str
    corrected: str
    evidence: str
    erratum: str
    row: int | None = None


@cache
def errata() -> tuple[Erratum, ...]:
    """All errata of D, in the order of their numbers."""
    return tuple(Erratum(**entry) for entry in published_content("errata.toml")["errata"])


def erratum(id: str) -> Erratum:  # noqa: A002 - the field's own word
    """One erratum.

    Parameters
    ----------
    id : str
        Number of the erratum, such as "E17".

    Returns
    -------
    Erratum

    Raises
    ------
    UnknownName
        If no erratum has that number.

    Examples
    --------
    >>> from sonolube.facts.published import erratum
    >>> erratum("E17").location
    'Table 4.2'
    """
    known = {entry.id: entry for entry in errata()}
    return entry_named(known, id, kind="erratum")


Role = Literal["given", "measured", "derived", "modelled"]


@dataclass(frozen=True, kw_only=True, slots=True)
class Column:
    """One column of a table.

    Parameters
    ----------
    name : str
        Name, unique in the table.
    quantity : str
        Quantity by its name in the vocabulary; empty for a column of words.
    unit : str
        Printed unit.
    scale : float
        Power of ten that the heading puts before the unit.
    role : str
        "given" for a setting, "measured", "derived" from other printed numbers, or "modelled".
    meaning : str
        Content of the column in a few words.
    printed : tuple of str
        Cells as printed; empty text for an empty cell.
    cells : tuple of PrintedNumber or None
        Cells as numbers in SI; None for an empty cell and in a column of words.
    """

    name: str
    quantity: str
    unit: str
    scale: float
    role: Role
    meaning: str
    printed: tuple[str, ...]
    cells: tuple[PrintedNumber | None, ...]

    @property
    def values(self) -> "NDArray[np.float64]":
        """Numbers of the column in SI; NaN for empty cells.

        Raises
        ------
        InvalidInput
            If the column contains words.
        """
        import numpy as np

        if not self.quantity:
            raise InvalidInput(f"column {self.name} contains words, not numbers; use its attribute printed")
        return np.array([np.nan if cell is None else cell.value for cell in self.cells], dtype=np.float64)


@dataclass(frozen=True, kw_only=True, slots=True)
class Table:
    """One table of D.

    Parameters
    ----------
    id : str
        Number of the table, such as "2.3".
    title : str
        Content of the table.
    section : str
        Section of D that the table belongs to.
    columns : mapping of str to Column
        Columns of equal length by name.
    corrections : tuple of Correction
        Corrections of single cells or headings.
    layout : str
        Layout of the rows against the printed table, with cells whose places arithmetic settled.
    """

    id: str
    title: str
    section: str
    columns: Mapping[str, Column]
    corrections: tuple[Correction, ...]
    layout: str

    def to_dataset(self) -> "xr.Dataset":
        """Table as a dataset over dimension `row`, in SI, with units and long names."""
        import xarray as xr

        variables = {name: ("row", *_variable(column)) for name, column in self.columns.items()}
        return xr.Dataset(variables, attrs={"title": self.title, "source": f"D Table {self.id}"})


@cache
def table_ids() -> tuple[str, ...]:
    """Numbers of all tables, in the order of D."""
    names = (entry.name for entry in files("sonolube.facts.published").joinpath("tables").iterdir())
    ids = (name.removesuffix(".toml") for name in names if name.endswith(".toml"))
    return tuple(sorted(ids, key=lambda number: tuple(map(int, number.split(".")))))


def table(id: str) -> Table:  # noqa: A002 - the field's own word
    """One table.

    Parameters
    ----------
    id : str
        Number of the table, such as "2.3".

    Returns
    -------
    Table

    Raises
    ------
    UnknownName
        If no table has that number.

    Examples
    --------
    >>> from sonolube.facts.published import table
    >>> table("2.5").title
    'Wear rates, number of contacts and friction reduction at three speeds'
    """
    if id not in table_ids():
        raise UnknownName.among(table_ids(), kind="table", name=id)
    return _read(id)


@cache
def _read(number: str) -> Table:
    """Table from its file, its cells parsed and converted to SI."""
    entry = published_content("tables", f"{number}.toml")
    headings, cells = entry["columns"], zip(*entry["rows"], strict=True)
    columns = (_column(printed, **heading) for heading, printed in zip(headings, cells, strict=True))
    return Table(
        **{name: entry.get(name, "") for name in ("id", "title", "section", "layout")},
        columns=MappingProxyType({column.name: column for column in columns}),
        corrections=tuple(Correction(**correction) for correction in entry.get("corrections", ())),
    )


def _column(printed: tuple[str, ...], *, quantity: str, unit: str, scale: float = 1.0, **heading: Any) -> Column:
    """Column from its heading and its printed cells."""
    cells = (parse_printed(text, unit, scale, quantity=quantity) if quantity and text else None for text in printed)
    return Column(quantity=quantity, unit=unit, scale=scale, printed=printed, cells=tuple(cells), **heading)


def _variable(column: Column) -> "tuple[list[str] | NDArray[np.float64], dict[str, str]]":
    """Values and attributes of a column as a variable of a dataset."""
    attributes = {"long_name": column.meaning, "role": column.role}
    if not column.quantity:
        return list(column.printed), attributes
    return column.values, attributes | {"units": unit_of(column.quantity), "quantity": column.quantity}
