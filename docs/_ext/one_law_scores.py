"""Blind scores of one law for all directions beside those of the two that ship, from the data of its study."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

DATA: Final = Path(__file__).parents[1] / "reliability" / "one_law.json"
"""Measures of the study `one_law`."""

HEADS: Final = (
    *("Law", "Along the normal within 50, 80, 95 %", "CRPS"),
    *("Within the plane within 50, 80, 95 %", "CRPS, mean of the sources"),
)
"""Heads of the table of scores."""


@dataclass(frozen=True, kw_only=True)
class LawScores:
    """Blind scores of a law, the numbers of tests within the intervals as text."""

    name: str
    along: str
    crps_along: float
    within: str
    crps_within: float

    @property
    def row(self) -> list[str]:
        """Cells of the table."""
        return [self.name, self.along, f"{self.crps_along:.3f}", self.within, f"{self.crps_within:.3f}"]

    @property
    def counts(self) -> list[int]:
        """Numbers of tests within the intervals, along the normal and within the plane."""
        return [int(count) for text in (self.along, self.within) for count in text.split(" of ")[0].split("/")]

    def is_worse_than(self, other: "LawScores") -> bool:
        """Whether any score is worse: a larger CRPS, or fewer tests within an interval."""
        fewer = any(own < its for own, its in zip(self.counts, other.counts, strict=True))
        return fewer or self.crps_along > other.crps_along or self.crps_within > other.crps_within


def law_scores(path: Path = DATA) -> list[LawScores]:
    """Scores of all laws that were tried, those that ship first."""
    measures = json.loads(path.read_text(encoding="utf-8"))["measures"]
    rows = [(each["label"].split(": ")[0], each["value"].split("; ")) for each in measures if "; " in each["value"]]
    return [
        LawScores(name=name, along=cells[0], crps_along=float(cells[1]), within=cells[2], crps_within=float(cells[3]))
        for name, cells in rows
    ]


def law_verdict(scores: Sequence[LawScores]) -> str:
    """By how much each law that was tried differs from those that ship, and whether any is worse in no score."""
    shipped, *tried = scores
    changes = "; ".join(
        f"{one.name}: CRPS {one.crps_along - shipped.crps_along:+.3f} along the normal and"
        f" {one.crps_within - shipped.crps_within:+.3f} within the plane"
        for one in tried
    )
    better = [one.name for one in tried if not one.is_worse_than(shipped)]
    if better:
        return f"Worse than the two laws that ship in no score: {', '.join(better)}. Against them, {changes}."
    return f"Each of these is worse than the two laws that ship in at least one score, so that none ships: {changes}."
