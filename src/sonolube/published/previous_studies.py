"""The earlier experiments that the dissertation reviews, as far as its text puts them in words and numbers."""

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from sonolube.published.number import PrintedNumber
from sonolube.published.running_text import Statement, statement


@dataclass(frozen=True, kw_only=True, slots=True)
class PreviousStudy:
    """One earlier experiment with one direction of vibration.

    Parameters
    ----------
    id : str
        Its stable name.
    study : str
        Who made it.
    references : tuple of int
        Their numbers in D's bibliography.
    section : str
        Where D reviews it.
    direction : str
        How the vibration stood to the sliding: "longitudinal", "transverse", "in plane" or "perpendicular"; empty
        where D does not tell.
    told : str
        What D tells of it.
    numbers : tuple of Statement
        What D prints of it; the rest is not known.
    """

    id: str
    study: str
    references: tuple[int, ...]
    section: str
    direction: str
    told: str
    numbers: tuple[Statement, ...]

    def number(self, quantity: str) -> PrintedNumber | None:
        """Return the printed number of a quantity of the vocabulary in SI; None where D prints none.

        Parameters
        ----------
        quantity : str

        Returns
        -------
        PrintedNumber or None
        """
        return next((entry.number for entry in self.numbers if entry.quantity == quantity), None)


@cache
def previous_studies() -> tuple[PreviousStudy, ...]:
    """Return the earlier experiments, in the order of D's review."""
    text = files("sonolube.published").joinpath("previous_studies.toml").read_text(encoding="utf-8")
    return tuple(
        PreviousStudy(
            id=entry["id"],
            study=entry["study"],
            references=tuple(entry["references"]),
            section=entry["section"],
            direction=entry["direction"],
            told=entry["told"],
            numbers=tuple(statement(name) for name in entry.get("numbers", ())),
        )
        for entry in tomllib.loads(text)["studies"]
    )
