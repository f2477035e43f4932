"""Arguments that tasks of the laboratory share: the folder of a run, the folder of all runs, protocol and tags."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from sonolube.tasks.parameters import Parameter

RUNS = "runs"
"""Folder of all runs, where none is given."""

RunFolder = Annotated[str | Path, Parameter(help="Folder of the run.", kind="RUN", is_file=True)]
AllRuns = Annotated[
    str | Path, Parameter(help="Folder of all runs; each has a new one in it.", kind="DIR", is_output=True)
]
Tags = Annotated[Sequence[str], Parameter(help="For the catalogue; may come again.", kind="TAG")]
Seed = Annotated[int, Parameter(help="Of a virtual tribometer.", lowest=0)]
RealTime = Annotated[bool, Parameter(help="Let a virtual test take its time.")]
Device = Annotated[str | Path, Parameter(help="What to run on.", kind="virtual|MAP.toml", option="--device")]
