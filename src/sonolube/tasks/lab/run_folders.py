"""Arguments that tasks of the laboratory share: the folder of a run, the folder of all runs, protocol and tags."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

from sonolube.errors import InvalidInput
from sonolube.tasks.parameters import File, OwnFolder, Parameter
from sonolube.tasks.task import shown

RUNS = "runs"
"""Folder of all runs, where none is given."""

RunFolder = Annotated[str | Path, File("Folder of the run.", "RUN")]
AllRuns = Annotated[str | Path, OwnFolder("Folder of all runs; each has a new one in it.", "DIR")]
Tags = Annotated[Sequence[str], Parameter("For the catalogue; may come again.", "TAG")]
Seed = Annotated[int, Parameter("Of a virtual tribometer.", lowest=0)]
RealTime = Annotated[bool, Parameter("Let a virtual test take its time.")]
Device = Annotated[str | Path, Parameter("What to run on.", "virtual|MAP.toml", option="--device")]


def facts_of(given: Mapping[str, str | float]) -> dict[str, str | float]:
    """Facts with numbers in SI as numbers.

    Raises
    ------
    InvalidInput
        If a name is none.
    """
    facts: dict[str, str | float] = {}
    for name, value in given.items():
        if not name.isidentifier():
            raise InvalidInput(f"{shown('fact')} {name}={value} must be NAME=VALUE, such as normal_load=5")
        try:
            facts[name] = float(value)
        except ValueError:
            facts[name] = str(value)
    return facts
