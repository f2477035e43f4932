"""Tables of the dissertation as tidy data: one row for each condition, one column for each quantity."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal

from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.published.corrections import Correction
from sonolube.facts.published.printed_number import PrintedNumber, parse_printed, published_content
from sonolube.vocabulary import unit_of

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr
    from numpy.typing import NDArray

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
