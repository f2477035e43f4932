"""Errata of the dissertation and corrections of single table cells, each with its evidence."""

from dataclasses import dataclass
from functools import cache

from sonolube.errors import UnknownName
from sonolube.facts.published.printed_number import published_content


@dataclass(frozen=True, kw_only=True, slots=True)
class Erratum:
    """Misprint or contradiction in D, with its correction.

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
    """

    id: str
    location: str
    printed: str
    corrected: str
    evidence: str


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
    if id not in known:
        raise UnknownName.among(known, kind="erratum", name=id)
    return known[id]
