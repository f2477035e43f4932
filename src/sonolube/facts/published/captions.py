"""Figure captions of the dissertation, with the statements of the running text on each figure."""

from dataclasses import dataclass
from functools import cache

from sonolube.errors import UnknownName
from sonolube.facts.published.printed_number import published_content


@dataclass(frozen=True, kw_only=True, slots=True)
class FigureCaption:
    """Content of one figure of D by its caption and the running text; no curve is available as data.

    Parameters
    ----------
    number : str
        Number of the figure, such as "2.13".
    section : str
        Section the figure belongs to.
    content : str
        Content by the caption.
    no_data : bool
        True: no curve, picture or drawing is available, so that no number may be read off the figure.
    remarks : tuple of str
        Statements of the running text on the figure, in words.
    statements : tuple of str
        Ids of the numbers that the running text states of the figure, as in `statement`.
    """

    number: str
    section: str
    content: str
    no_data: bool
    remarks: tuple[str, ...] = ()
    statements: tuple[str, ...] = ()


@cache
def figures() -> tuple[FigureCaption, ...]:
    """Captions of all figures, in the order of D."""
    return tuple(
        FigureCaption(**entry | {name: tuple(entry.get(name, ())) for name in ("remarks", "statements")})
        for entry in published_content("figures.toml")["figures"]
    )


def figure(number: str) -> FigureCaption:
    """Caption of one figure.

    Parameters
    ----------
    number : str
        Number of the figure, such as "2.13" or "B.1".

    Returns
    -------
    FigureCaption

    Raises
    ------
    UnknownName
        If no figure has that number.
    """
    known = {entry.number: entry for entry in figures()}
    if number not in known:
        raise UnknownName.among(known, kind="figure", name=number)
    return known[number]
