"""Runs for the tests: a ramp of force that tells every sample, and the writing of a run of it."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sonolube.laboratory import Block, Channel
from sonolube.laboratory.records import RunRecorder, new_run

RATE = 1000.0
CHANNELS = (
    Channel(name="friction_force", quantity="friction_force", lowest=-20.0, highest=20.0),
    Channel(name="temperature", quantity="temperature"),
)
PROTOCOL = 'title = "test"\n'


def values_of(first: int, samples: int) -> NDArray[np.float64]:
    """Values that are those of their sample and of no other."""
    number = np.arange(first, first + samples, dtype=np.float64)
    return np.stack([1e-6 * number, 293.0 + 1e-3 * number], axis=1)


def block_of(first: int, samples: int, rate: float = RATE) -> Block:
    """Block from a sample on."""
    return Block(first_sample=first, sample_rate=rate, values=values_of(first, samples))


def begun(parent: Path, **facts: str | float) -> RunRecorder:
    """Run that is being recorded."""
    recorder = new_run(parent, title="Map test", protocol=PROTOCOL, files={"rig.toml": "a = 1\n"}, facts=facts)
    recorder.begin(CHANNELS, sample_rate=RATE)
    return recorder


def recorded(parent: Path, *, sizes: Sequence[int] = (50, 70, 30), **facts: str | float) -> Path:
    """Folder of a run of blocks of these sizes that was completed."""
    recorder = begun(parent, **facts)
    first = 0
    for size in sizes:
        recorder.append(block_of(first, size))
        first += size
    return recorder.finish("completed").folder


def documents(folder: Path) -> list[tuple[str, dict[str, Any]]]:
    """Documents of a run."""
    return [tuple(json.loads(line)) for line in (folder / "documents.jsonl").read_text().splitlines()]


def contents(folder: Path) -> dict[str, bytes]:
    """Every file of a folder."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
