"""The numbers that the dissertation states in its running text."""

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from sonolube.errors import UnknownName
from sonolube.published.number import PrintedNumber, parse_printed

_PARTS = ("abstract", "chapter1", "chapter2", "chapter3", "chapter4", "chapter5", "appendix")


@dataclass(frozen=True, kw_only=True, slots=True)
class Statement:
    """One number of the running text.

    Parameters
    ----------
    id : str
        Its stable name, the section first.
    section : str
        Where it stands; "abstract" and "A" for the abstract and the protocol.
    quantity : str
        What it is a number of, by its name in the vocabulary; empty for a pure number that has none.
    unit : str
        The unit printed.
    number : PrintedNumber
        The number, in SI.
    relation : str
        How the text relates the quantity to the number: "=", "about", "up to", "<" or ">".
    meaning : str
        What is stated.
    study : str
        The earlier study it comes from; empty for D's own numbers.
    direction : str
        How that study's vibration stood to the sliding, where D tells.
    erratum : str
        The erratum it belongs to; empty where nothing speaks against the number.
    right : str
        What it should be; empty where nothing speaks against it.
    reason : str
        What speaks against it; empty where nothing does.
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
    right: str = ""
    reason: str = ""


def statements(chapter: int | None = None) -> tuple[Statement, ...]:
    """Return the numbers of the running text, in its order.

    Parameters
    ----------
    chapter : int or None
        The chapter, from 1 to 5; None for all of D, with abstract and appendix.

    Returns
    -------
    tuple of Statement

    Raises
    ------
    UnknownName
        If there is no such chapter.
    """
    if chapter is None:
        return tuple(entry for part in _PARTS for entry in _read(part))
    part = f"chapter{chapter}"
    if part not in _PARTS:
        raise UnknownName.among(_PARTS, kind="part of D", name=part)
    return _read(part)


def statement(id: str) -> Statement:  # noqa: A002 - the field's own word
    """Return one number of the running text.

    Parameters
    ----------
    id : str
        Its name, such as "2.5.2-friction-titanium-off".

    Returns
    -------
    Statement

    Raises
    ------
    UnknownName
        If there is none of that name.
    """
    if id not in _by_id():
        raise UnknownName.among(_by_id(), kind="statement", name=id)
    return _by_id()[id]


@cache
def _by_id() -> dict[str, Statement]:
    return {entry.id: entry for entry in statements()}


@cache
def _read(part: str) -> tuple[Statement, ...]:
    text = files("sonolube.published").joinpath("statements", f"{part}.toml").read_text(encoding="utf-8")
    return tuple(_statement(**entry) for entry in tomllib.loads(text)["statements"])


def _statement(*, printed: str, quantity: str, unit: str = "", relation: str = "=", **entry: Any) -> Statement:
    number = parse_printed(printed, unit, quantity=quantity)
    return Statement(quantity=quantity, unit=unit, number=number, relation=relation, **entry)
