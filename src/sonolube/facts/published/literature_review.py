"""Experiments of other authors that the dissertation reviews, with the numbers that its text quotes of them."""

from dataclasses import dataclass
from functools import cache

from sonolube.facts.published.printed_number import PrintedNumber, published_content
from sonolube.facts.published.running_text import Statement, statement


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
