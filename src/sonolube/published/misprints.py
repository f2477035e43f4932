"""What is wrong in the dissertation, with the evidence."""

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from sonolube.errors import UnknownName


@dataclass(frozen=True, kw_only=True, slots=True)
class Erratum:
    """One misprint or contradiction.

    Parameters
    ----------
    id : str
        Its number, such as "E17".
    where : str
        Equation, table or section of D.
    printed : str
        What stands there.
    right : str
        What should stand there, or that both readings are kept.
    evidence : str
        Why.
    """

    id: str
    where: str
    printed: str
    right: str
    evidence: str


@dataclass(frozen=True, kw_only=True, slots=True)
class Correction:
    """What speaks against one cell or one heading of a table.

    Parameters
    ----------
    column : str
        Column of the table.
    printed : str
        The digits or the heading at issue.
    right : str
        What they should be: digits where arithmetic settles it, else words.
    reason : str
        The evidence.
    erratum : str
        The erratum it belongs to.
    row : int or None
        Row of the cell, counted from 0; None for the heading or the whole column.
    """

    column: str
    printed: str
    right: str
    reason: str
    erratum: str
    row: int | None = None


@cache
def errata() -> tuple[Erratum, ...]:
    """Return all errata of D, in the order of their numbers."""
    text = files("sonolube.published").joinpath("errata.toml").read_text(encoding="utf-8")
    return tuple(Erratum(**entry) for entry in tomllib.loads(text)["errata"])


def erratum(id: str) -> Erratum:  # noqa: A002 - the field's own word
    """Return one erratum.

    Parameters
    ----------
    id : str
        Its number, such as "E17".

    Returns
    -------
    Erratum

    Raises
    ------
    UnknownName
        If there is none of that number.
    """
    known = {entry.id: entry for entry in errata()}
    if id not in known:
        raise UnknownName.among(known, kind="erratum", name=id)
    return known[id]
