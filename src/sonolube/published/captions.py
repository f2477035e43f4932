"""The figures of the dissertation: what each shows, and what the text says of it; no curve came along as data."""

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from sonolube.errors import UnknownName


@dataclass(frozen=True, kw_only=True, slots=True)
class Figure:
    """One figure of D, of which only the caption and the text's words are known.

    Parameters
    ----------
    number : str
        Its number, such as "2.13".
    section : str
        The section it belongs to.
    shows : str
        What it shows.
    no_data : bool
        True: no curve, picture or drawing came along, so no number may be read off it.
    statements : tuple of str
        What the text says of it.
    numbers : tuple of str
        The statements of the running text that put it in numbers, by name.
    """

    number: str
    section: str
    shows: str
    no_data: bool
    statements: tuple[str, ...] = ()
    numbers: tuple[str, ...] = ()


@cache
def figures() -> tuple[Figure, ...]:
    """Return all figures of D, in its order."""
    text = files("sonolube.published").joinpath("figures.toml").read_text(encoding="utf-8")
    return tuple(
        Figure(
            number=entry["number"],
            section=entry["section"],
            shows=entry["shows"],
            no_data=entry["no_data"],
            statements=tuple(entry.get("statements", ())),
            numbers=tuple(entry.get("numbers", ())),
        )
        for entry in tomllib.loads(text)["figures"]
    )


def figure(number: str) -> Figure:
    """Return one figure.

    Parameters
    ----------
    number : str
        Its number, such as "2.13" or "B.1".

    Returns
    -------
    Figure

    Raises
    ------
    UnknownName
        If there is none of that number.
    """
    known = {entry.number: entry for entry in figures()}
    if number not in known:
        raise UnknownName.among(known, kind="figure", name=number)
    return known[number]
