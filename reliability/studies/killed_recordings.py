"""Runs that are recorded by a process which is killed at a random moment, then recovered."""

import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from reliability.study import Measure, Record, Study
from sonolube.laboratory.records import read_raw_blocks, read_run, recover_run, run_folders
from sonolube.measurement.recordings.reader import read_recording

_WRITER = """
import os, sys
import numpy as np
from pathlib import Path
from sonolube.laboratory.block import Block, Channel
from sonolube.laboratory.records import new_run
parent, parts, blocks, samples = Path(sys.argv[1]), *map(int, sys.argv[2:])
channels = [Channel(name=name, quantity=name) for name in ("friction_force", "temperature")]
os.write(1, b"0 0\\n")
recorder = new_run(parent, title="killed", protocol="title = 1", facts={"rig": "tribometer"})
for part in range(1, parts + 1):
    recorder.begin(channels, sample_rate=1e4)
    for number in range(blocks):
        first = number * samples
        values = np.arange(first, first + samples)[:, None] * [1.0, -1.0] + part
        recorder.append(Block(first_sample=first, sample_rate=1e4, values=values))
        os.write(1, b"%d %d\\n" % (part, first + samples))
        if number % 10 == 0:
            recorder.note("drive", sample=first + samples, voltage_peak_to_peak=float(number))
    recorder.end()
recorder.finish("completed")
os.write(1, b"-1 0\\n")
"""
_LATER = 0.05  # s, longest wait after the last line that is waited for


def _told(lines: Sequence[bytes]) -> tuple[dict[int, int], bool]:
    """Samples of each part that `append` had taken, and whether the run had ended, by whole lines."""
    told: dict[int, int] = {}
    for line in lines:
        if line.endswith(b"\n"):
            part, count = map(int, line.split())
            told[part] = count
    return told, -1 in told


def _files(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def _lost_and_wrong(folder: Path, told: dict[int, int]) -> tuple[int, int]:
    """Number of samples that had been taken and are missing, and of samples that are not as written."""
    lost = wrong = 0
    for part, count in told.items():
        if part < 1:
            continue
        found = 0
        for block in read_raw_blocks(folder / "raw" / f"blocks-{part}.bin"):
            numbers = np.arange(block.first_sample, block.next_sample, dtype=np.float64)
            wrong += int(np.sum(block.values != numbers[:, None] * [1.0, -1.0] + part))
            found += block.samples
        lost += max(0, count - found)
        recording = read_recording(folder / ("recording.nc" if part == 1 else f"recording-{part}.nc"))
        numbers = np.arange(found, dtype=np.float64)
        forces = recording["friction_force"].to_numpy()
        wrong += int(np.sum(forces != numbers + part)) if forces.size == found else found
    return lost, wrong


def _trial(seed: int) -> Record:
    rng = random.Random(seed)
    parts, blocks, samples = rng.randint(1, 3), rng.choice((20, 60, 200)), rng.choice((1, 50, 1000))
    waited = rng.randrange(parts * blocks + 2)
    with tempfile.TemporaryDirectory() as place:
        parent = Path(place)
        command = [sys.executable, "-c", _WRITER, place, str(parts), str(blocks), str(samples)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, bufsize=0) as writer:
            assert writer.stdout
            lines = [writer.stdout.readline() for _ in range(waited)]
            time.sleep(rng.uniform(0, _LATER) if rng.random() < 0.5 else 0)
            writer.send_signal(signal.SIGKILL)
            lines += writer.stdout.readlines()
        told, ended = _told(lines)
        folders = run_folders(parent)
        if not folders:
            return {"moment": "before", "kept": max(told, default=0) < 1, "true": True, "told": True, "once": True}
        (folder,) = folders
        recovery = recover_run(folder)
        lost, wrong = _lost_and_wrong(folder, told)
        outcome = read_run(folder).summary.outcome
        before = _files(folder)
        again = recover_run(folder).done
        return {
            "moment": "after" if ended else "recording",
            "kept": lost == 0,
            "true": wrong == 0,
            "told": outcome == "completed" if ended else outcome in ("interrupted", "completed"),
            "once": not again and _files(folder) == before,
            "aside": sum("cut off" in line for line in recovery.done),
        }


def _measures(records: Sequence[Record]) -> list[Measure]:
    total = len(records)
    labels = {
        "kept": "runs in which every sample that `append` had taken is in the recording",
        "true": "runs in which every sample has the value that was written, bit for bit",
        "told": "runs that end as interrupted, or as completed where they had ended",
        "once": "runs that a second recovery leaves as they are, byte for byte",
    }
    counts = {key: sum(bool(record[key]) for record in records) for key in labels}
    during = sum(record["moment"] == "recording" for record in records)
    aside = sum(int(str(record.get("aside", 0))) for record in records)
    return [
        *(
            Measure(label=label, value=f"{counts[key]} of {total}", bar="all", holds=counts[key] == total)
            for key, label in labels.items()
        ),
        Measure(label="runs killed while they were recorded or written", value=f"{during} of {total}"),
        Measure(label="unfinished blocks and documents kept aside", value=str(aside)),
    ]


STUDY = Study(
    title="Recordings killed",
    question="A process records a run of one to three parts, and SIGKILL ends it at a random moment, from its first"
    " step to the end. Recovered, it lacks nothing that `append` had taken, and has no wrong sample.",
    sources=("storage/growing_files.py", "storage/files.py", "laboratory/records/*.py", "laboratory/block.py"),
    trials=200,
    sample=3,
    trial=_trial,
    measures=_measures,
)
