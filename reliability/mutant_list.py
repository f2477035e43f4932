"""List of mutants drawn from rooms, and the study that runs each: ``python -m reliability.mutant_list NAME SEED``."""

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from reliability.mutation import ROOT, SOURCE, Mutant, entries_of, first_failure, room_of, sampled, tests_of
from reliability.reach import MAP, picked, reaching, reaching_file, with_their_files
from reliability.study import Measure, Record, Study


@dataclass(frozen=True, kw_only=True)
class MutantList:
    """Mutants of rooms, the test that failed with each, or why it changes nothing.

    Parameters
    ----------
    name : str
        Of the study and of the list, reliability/NAME.json.
    title, question : str
        Of the study.
    rooms : mapping of str to int
        Folders below src/sonolube and how many mutants each is to have.
    room_bar : float
        Share of the mutants that tests of their own room are to kill; 0 where that is not asked.
    bar : float
        Share that all tests that reach the line are to kill.
    max_equivalent : float
        Share that may be said to change nothing, each with its reason.
    """

    name: str
    title: str
    question: str
    rooms: Mapping[str, int]
    room_bar: float = 0.0
    bar: float
    max_equivalent: float = 1.0

    @property
    def file(self) -> Path:
        """Where the list is kept."""
        return Path(__file__).parent / f"{self.name}.json"

    @cached_property
    def entries(self) -> list[dict[str, Any]]:
        """Entries: a mutant, the test that failed with it, or why it changes nothing; survivors have none."""
        entries: list[dict[str, Any]] = json.loads(self.file.read_text("utf-8")) if self.file.exists() else []
        return entries

    def draw(self, seed: int) -> None:
        """Fill the list up to the number of every room; entries whose line is gone are drawn anew."""
        kept = entries_of(self.file)
        for mutant in sampled(self.rooms, kept=[Mutant(**entry["mutant"]) for entry in kept], seed=seed):
            kept.append({"mutant": asdict(mutant), "killed_by": "", "equivalent": ""})
        self.file.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")

    def study(self) -> Study:
        """Study of all mutants of the list."""
        return Study(
            title=self.title,
            question=self.question,
            sources=tuple(f"{room}/**/*.py" for room in self.rooms),
            trials=len(self.entries),
            sample=min(1, len(self.entries)),
            trial=self._trial,
            measures=self._measures,
        )

    def _trial(self, seed: int) -> Record:
        entry = self.entries[seed]
        mutant = Mutant(**entry["mutant"])
        if entry["equivalent"]:
            return {"room": self.room(mutant), "killed": "", "own": False, "equivalent": True}
        own, other = stages_of(mutant, known=entry["killed_by"])
        killed = first_failure(mutant, [own])
        if killed:
            return {"room": self.room(mutant), "killed": killed, "own": True, "equivalent": False}
        return {"room": self.room(mutant), "killed": first_failure(mutant, other), "own": False, "equivalent": False}

    def room(self, mutant: Mutant) -> str:
        """Room of the list that a mutant is of."""
        return next(room for room in self.rooms if mutant.file.startswith(f"{room}/"))

    def _measures(self, records: Sequence[Record]) -> list[Measure]:
        killable = [record for record in records if not record["equivalent"]]
        survivors = [self.entries[int(str(r["seed"]))]["mutant"] for r in killable if not r["killed"]]
        names = "".join(f"; survives `{mutant['file']}`: `{mutant['line']}`" for mutant in survivors)
        own = sum(bool(record["own"]) for record in killable)
        killed = sum(bool(record["killed"]) for record in killable)
        equivalent = len(records) - len(killable)
        measures = [
            Measure(
                label=f"mutants that change nothing, with their reason in reliability/{self.name}.json",
                value=str(equivalent),
                bar=f"at most {self.max_equivalent:.0%}" if self.max_equivalent < 1 else "",
                holds=equivalent <= self.max_equivalent * len(records),
            ),
            Measure(
                label="other mutants that fail a test",
                value=f"{_share(killed, len(killable))}{names}",
                bar=f"at least {self.bar:.0%}",
                holds=killed >= self.bar * len(killable),
            ),
        ]
        if not self.room_bar:
            return measures
        by_room = [
            Measure(label=f"of these in {room}: own tests, all tests", value=_of_room(room, killable))
            for room in self.rooms
            if any(record["room"] == room for record in killable)
        ]
        kept = Measure(
            label="that fail a test of their own room",
            value=_share(own, len(killable)),
            bar=f"at least {self.room_bar:.0%}",
            holds=own >= self.room_bar * len(killable),
        )
        return [*measures, kept, *by_room]


def _share(part: int, whole: int) -> str:
    return f"{part} of {whole} ({part / max(whole, 1):.1%})"


def _of_room(room: str, records: Sequence[Record]) -> str:
    own = [record for record in records if record["room"] == room]
    counts = (sum(bool(record[key]) for record in own) for key in ("own", "killed"))
    return ", ".join(f"{count} of {len(own)}" for count in counts)


def stages_of(mutant: Mutant, *, known: str = "") -> tuple[list[str], list[list[str]]]:
    """Tests of a mutant's own room, then stages of the others: those that reach its line, of a minute each.

    Where these take less than a minute, the others of their files follow, and in the own room those that reach another
    line of the file: a line that runs at import is seen in tests that start a program alone, one below a cache in the
    first test that asks for it.

    Without a map of lines (`python -m reliability.reach`) those that name what its module defines.

    Parameters
    ----------
    mutant : Mutant
    known : str
        A test that failed with it before, the first of its stage.
    """
    room = f"tests/{room_of(mutant.file).as_posix()}/"
    row = mutant.row((SOURCE / mutant.file).read_text(encoding="utf-8"))
    own: list[str]
    if MAP.exists() and row is not None and (tests := reaching(mutant.file, row + 1)):
        near = [test for test in tests if test[0].startswith(room)]
        beside = [test for test in reaching_file(mutant.file) if test[0].startswith(room) and test not in near]
        own = picked([*with_their_files(near), *(test for test in with_their_files(beside) if test not in near)])
        rest = [picked(with_their_files([test for test in tests if not test[0].startswith(room)]))]
    else:
        first, second, above = tests_of(mutant.file)
        own, rest = [*first, *second], [above]
    if not known or not (ROOT / known.partition("::")[0]).exists():
        return own, rest
    return ([known, *own], rest) if known.startswith(room) else (own, [[known], *rest])


def main(name: str, seed: str) -> None:
    """Fill a list up to the numbers of its rooms, from a seed."""
    from reliability.studies import mutants_above_models, mutants_of_models  # which take their lists from here

    lists = {each.name: each for each in (mutants_above_models.LIST, mutants_of_models.LIST)}
    lists[name].draw(int(seed))


if __name__ == "__main__":
    main(*sys.argv[1:])
