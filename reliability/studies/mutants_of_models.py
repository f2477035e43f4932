"""Mutants of the models, kept in mutants.json: each is to fail a test."""

import json
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

from reliability.mutation import ROOMS, Mutant, killed_by
from reliability.study import Measure, Record, Study

LIST = Path(__file__).parents[1] / "mutants.json"


@cache
def kept() -> list[dict[str, Any]]:
    """Entries of the list: a mutant, the test that failed with it, or why it changes nothing; survivors have none."""
    entries: list[dict[str, Any]] = json.loads(LIST.read_text(encoding="utf-8"))
    return entries


def _trial(seed: int) -> Record:
    entry = kept()[seed]
    if entry["equivalent"]:
        return {"killed": "", "equivalent": True}
    return {"killed": killed_by(Mutant(**entry["mutant"]), first=entry["killed_by"]), "equivalent": False}


def _measures(records: Sequence[Record]) -> list[Measure]:
    killable = [record for record in records if not record["equivalent"]]
    survivors = [Mutant(**kept()[int(str(r["seed"]))]["mutant"]) for r in killable if not r["killed"]]
    killed = len(killable) - len(survivors)
    names = "; ".join(f"`{mutant.file}`: `{mutant.line}`" for mutant in survivors)
    share = f"{killed} of {len(killable)} ({killed / max(len(killable), 1):.1%})"
    return [
        Measure(
            label="mutants that change nothing, with their reason in reliability/mutants.json",
            value=str(len(records) - len(killable)),
        ),
        Measure(
            label="other mutants that fail a test",
            value=f"{share}: all but {names}" if names else share,
            bar="at least 95 %",
            holds=killed >= 0.95 * len(killable),
        ),
    ]


STUDY = Study(
    title="Mutants of the models",
    question="One operator, number or function of a model is changed: does a test of its line, its room or the rooms"
    " above fail? The list is a random sample of all rooms of models; each mutant is run against the test that failed"
    " before, then against the others.",
    sources=tuple(f"{room}/**/*.py" for room in ROOMS),
    trials=len(kept()) if LIST.exists() else 0,
    sample=1,
    trial=_trial,
    measures=_measures,
)
