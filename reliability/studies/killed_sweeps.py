"""Sweeps into a folder that a signal ends at a random moment."""

import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from reliability.study import Measure, Record, Study
from sonolube.design import grid_plan, sweep
from sonolube.tasks.own_tables import values_by_key

_RIG = Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml"
_KEY, _VALUES, _CHUNK, _CHUNKS = "sliding.sliding_speed", "10mm/s:90mm/s:400", 10, 40
_PROGRAM = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # a background job ignores it
    "import sonolube.cli; print(flush=True); sonolube.cli.main()"
)
_SIGNALS = {signal.SIGKILL: (-9, ""), signal.SIGTERM: (143, "terminated"), signal.SIGINT: (130, "interrupted")}
_LONGEST = 3.0  # s, from the start


def _sweep(folder: Path) -> dict[str, bytes]:
    """Contents of the folder of a sweep that ends undisturbed: chunks, manifest and dataset."""
    sweep(grid_plan(_RIG, over=values_by_key({_KEY: _VALUES})), folder=folder, chunk_points=_CHUNK).close()
    pages = {"sweep.html", "sweep.png", "sweep.svg"}
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.name not in pages}


@cache
def _undisturbed() -> dict[str, bytes]:
    with tempfile.TemporaryDirectory() as folder:
        return _sweep(Path(folder))


def _wait(rng: random.Random, run: "subprocess.Popen[str]", folder: Path) -> None:
    """Wait for a random time, or for a random number of finished chunks."""
    if rng.random() < 0.3:
        time.sleep(rng.uniform(0, _LONGEST))
        return
    chunks, rest = rng.randrange(_CHUNKS), rng.uniform(0, 0.02)
    while run.poll() is None and len(list(folder.glob("chunk-*"))) < chunks:
        time.sleep(0.002)
    time.sleep(rest)


def _unfinished(folder: Path) -> list[str]:
    return [path.name for path in folder.rglob("*") if path.name.startswith(".")]


_PROGRESS = re.compile(r"^\w+: .*\(.*\)\n", re.MULTILINE)


def _trial(seed: int) -> Record:
    rng = random.Random(seed)
    number = rng.choice(list(_SIGNALS))
    code, word = _SIGNALS[number]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "out"
        words = ("sweep", str(_RIG), "--over", f"{_KEY}={_VALUES}", "--chunk", str(_CHUNK), "--out", str(folder))
        command = [sys.executable, "-c", _PROGRAM, *words]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as run:
            assert run.stdout
            run.stdout.readline()
            _wait(rng, run, folder)
            run.send_signal(number)
            _, err = run.communicate(timeout=300)
        err = _PROGRESS.sub("", err)  # which a slow machine tells
        ended = run.returncode == 0 and not err
        told = ended or (run.returncode == code and err == (f"sonolube: {word}\n" if word else ""))
        clean = number == signal.SIGKILL or not _unfinished(Path(place))
        chunks = len(list(folder.glob("chunk-*")))
        contents = _sweep(folder)
        record = {
            "moment": "after the end" if ended else ("before the first chunk" if chunks == 0 else "among the chunks"),
            "told": told,
            "clean": clean,
            "equal": contents == _undisturbed(),
            "left": len(_unfinished(Path(place))),
        }
    return record if told else {**record, "case": f"{number.name}: {run.returncode} {err[-200:]}"}


def _measures(records: Sequence[Record]) -> list[Measure]:
    total = len(records)
    labels = {
        "told": "runs that end with the status of the signal and at most one line",
        "clean": "runs that leave nothing unfinished, unless killed",
        "equal": "second runs whose files are those of an undisturbed run, bit for bit",
    }
    counts = {key: sum(bool(record[key]) for record in records) for key in labels}
    left = sum(int(str(record["left"])) for record in records)
    among = sum(record["moment"] == "among the chunks" for record in records)
    first = next((f", first: {record['case']}" for record in records if "case" in record), "")
    return [
        *(
            Measure(
                label=label,
                value=f"{counts[key]} of {total}{first if key == 'told' else ''}",
                bar="all",
                holds=counts[key] == total,
            )
            for key, label in labels.items()
        ),
        Measure(label="unfinished files after the second run", value=str(left), bar="0", holds=left == 0),
        Measure(label="signals that came while chunks were being computed", value=f"{among} of {total}"),
    ]


STUDY = Study(
    title="Sweeps ended by signals",
    question="SIGKILL, SIGTERM or SIGINT ends a sweep into a folder at a random moment. A second run completes it with"
    " the bits of an undisturbed one, and nothing unfinished stays.",
    sources=(
        "storage/files.py",
        "storage/interruption.py",
        "design/sweep_dataset.py",
        "design/sweep_dataset.py",
        "cli/__init__.py",
    ),
    trials=60,
    sample=2,
    trial=_trial,
    measures=_measures,
)
