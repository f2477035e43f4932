"""Numbers that the running text of the dissertation states: quoted numbers with relation, meaning and erratum."""

from dataclasses import dataclass
from functools import cache
from typing import Any

from sonolube.errors import UnknownName
from sonolube.facts.published.printed_number import PrintedNumber, parse_printed, published_content

_PARTS = ("abstract", "chapter1", "chapter2", "chapter3", "chapter4", "chapter5", "appendix")


@dataclass(frozen=True, kw_only=True, slots=True)
class Statement:
    """One number that the running text states.

    Parameters
    ----------
    id : str
        Stable id that begins with the section.
    section : str
        Section of D; "abstract" for the abstract, "A" and below for the protocol of the tests.
    quantity : str
        Quantity by its name in the vocabulary; empty for a pure number that has none.
    unit : str
        Printed unit.
    number : PrintedNumber
        Number with its rounding interval, in SI.
    relation : str
        Relation of the quantity to the number: "=", "about", "up to", "<" or ">".
    meaning : str
        Content of the statement.
    study : str
        Authors of the reviewed study that the number is quoted from; empty for a number of D.
    direction : str
        Direction of vibration in that study, where D states it.
    erratum : str
        Id of the erratum that corrects the number; empty where there is none.
    corrected : str
        Corrected number or reading; empty where nothing is to correct.
    evidence : str
        Evidence against the print; empty where there is none.
    """

    id: str
    section: str
    quantity: str
    unit: str
    number: PrintedNumber
    relation: str
    meaning: str
    study: str = ""
    direction: str = ""
    erratum: str = ""
    corrected: str = ""
    evidence: str = ""


def statements(chapter: int | None = None) -> tuple[Statement, ...]:
    """Numbers that the running text states, in its order.

    Parameters
    ----------
    chapter : int or None
        Chapter from 1 to 5; None for all of D, with abstract and appendix.

    Returns
    -------
    tuple of Statement

    Raises
    ------
    UnknownName
        If D has no such chapter.
    """
    if chapter is None:
        return tuple(entry for part in _PARTS for entry in _read(part))
    part = f"chapter{chapter}"
    if part not in _PARTS:
        raise UnknownName.among(_PARTS, kind="part of D", name=part)
    return _read(part)


def statement(id: str) -> Statement:  # noqa: A002 - the field's own word
    """One number that the running text states.

    Parameters
    ----------
    id : str
        Id, such as "2.5.2-friction-titanium-off".

    Returns
    -------
    Statement

    Raises
    ------
    UnknownName
        If no statement has that id.
    """
    if id not in _by_id():
        raise UnknownName.among(_by_id(), kind="statement", name=id)
    return _by_id()[id]


@cache
def _by_id() -> dict[str, Statement]:
    """All statements by id."""
    return {entry.id: entry for entry in statements()}


@cache
def _read(part: str) -> tuple[Statement, ...]:
    """Statements of one part of D from its file."""
    return tuple(_statement(**entry) for entry in published_content("statements", f"{part}.toml")["statements"])


def _statement(*, printed: str, quantity: str, unit: str = "", relation: str = "=", **entry: Any) -> Statement:
    """Statement from an entry of a file, its number parsed and converted to SI."""
    number = parse_printed(printed, unit, quantity=quantity)
    return Statement(quantity=quantity, unit=unit, number=number, relation=relation, **entry)
