"""Numbers that the running text of the dissertation states, its figure captions, and the experiments that it reviews.

Quoted numbers have their relation, meaning and erratum.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

from sonolube.errors import UnknownName, entry_named
from sonolube.facts.published.printed_tables import PrintedNumber, parse_printed, published_content

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
    return entry_named(_by_id(), id, kind="statement")


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
    return entry_named(known, number, kind="figure")


@dataclass(frozen=True, kw_only=True, slots=True)
class PreviousStudy:
    """Experiment of other authors with one direction of vibration.

    Parameters
    ----------
    id : str
        Stable name.
    study : str
        Authors, as D names them.
    references : tuple of int
        Numbers in the bibliography of D.
    section : str
        Section of D that reviews it.
    direction : str
        Direction of the vibration relative to the sliding: "longitudinal", "transverse", "in plane" or
        "perpendicular"; empty where D does not state it.
    summary : str
        Content of the review in a few words.
    numbers : tuple of Statement
        Numbers that D quotes of it; nothing else of it is known.
    """

    id: str
    study: str
    references: tuple[int, ...]
    section: str
    direction: str
    summary: str
    numbers: tuple[Statement, ...]

    def number(self, quantity: str) -> PrintedNumber | None:
        """Quoted number of a quantity in SI; None where D quotes none.

        Parameters
        ----------
        quantity : str
            Name in the vocabulary.

        Returns
        -------
        PrintedNumber or None
        """
        return next((entry.number for entry in self.numbers if entry.quantity == quantity), None)


@cache
def previous_studies() -> tuple[PreviousStudy, ...]:
    """Reviewed experiments, in the order of the review in D 1.3.1 and 1.3.2."""
    return tuple(
        PreviousStudy(
            **entry
            | {
                "references": tuple(entry["references"]),
                "numbers": tuple(statement(name) for name in entry.get("numbers", ())),
            }
        )
        for entry in published_content("previous_studies.toml")["studies"]
    )
