"""Writers on a disk that is full after a random number of bytes."""

import random
import resource
import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import numpy as np
import xarray as xr

from reliability.study import Measure, Record, Study
from sonolube.design import grid_plan, sweep
from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.reader import write_recording
from sonolube.rig import write_netcdf
from sonolube.storage.files import write_atomically

_RIG = Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml"
_SPEEDS = np.linspace(0.01, 0.1, 200)


@contextmanager
def _largest_file(size: int) -> Iterator[None]:
    """Let no file of this process grow beyond a size, as a full disk does."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def _page(folder: Path) -> None:
    write_atomically(folder / "page.html", "<p>friction</p>" * 4000)


def _dataset() -> xr.Dataset:
    rng = np.random.default_rng(0)
    values = {name: ("time", rng.standard_normal(2000)) for name in ("friction_force", "normal_force")}
    return xr.Dataset(values, coords={"time": np.arange(2000.0)})


def _netcdf(folder: Path) -> None:
    write_netcdf(_dataset(), path=folder / "results.nc")


def _recording(folder: Path) -> None:
    write_recording(_dataset(), path=folder / "recording.nc")


def _sweep(folder: Path) -> None:
    sweep(grid_plan(_RIG, over={"sliding.sliding_speed": _SPEEDS}), folder=folder, chunk_points=25).close()


_WRITERS: dict[str, Callable[[Path], None]] = {
    "page": _page,
    "netCDF": _netcdf,
    "recording": _recording,
    "sweep": _sweep,
    "sweep with chunks missing": _sweep,
}


@cache
def _written(name: str) -> tuple[tempfile.TemporaryDirectory[str], dict[str, bytes]]:
    """Folder with what a writer writes, and its contents."""
    folder = tempfile.TemporaryDirectory()
    _WRITERS[name](Path(folder.name))
    return folder, _contents(Path(folder.name))


def _contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def _trial(seed: int) -> Record:
    rng = random.Random(seed)
    name = rng.choice(list(_WRITERS))
    finished, whole = _written(name)
    size = rng.randrange(max(map(len, whole.values())))
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place) / "out"
        shutil.copytree(finished.name, folder)
        removed = rng.sample([name for name in whole if name.startswith("chunk-")], 3) if "missing" in name else []
        for each in removed:
            (folder / each).unlink()
        try:
            with _largest_file(size):
                _WRITERS[name](folder)
            message = "nothing"
        except InvalidInput as refusal:
            message = str(refusal)
        after = _contents(folder)
        kept = all(after.get(each) == whole[each] for each in whole if each not in removed)
        clear = message.startswith(f"{folder}/") and message.endswith(": cannot be written: File too large")
        left = [each for each in after if each not in whole or after[each] != whole[each]]
        _WRITERS[name](folder)
        record = {"refused": clear, "kept": kept, "left": len(left), "finished": _contents(folder) == whole}
    return record if clear else {**record, "case": f"{name}, {size} bytes: {message}"}


def _measures(records: Sequence[Record]) -> list[Measure]:
    total = len(records)
    labels = {
        "refused": "writers that end with one line that names the file and the reason",
        "kept": "trials after which every earlier file is as before",
        "finished": "trials that a second run on a disk with space completes, bits equal",
    }
    counts = {key: sum(bool(record[key]) for record in records) for key in labels}
    left = sum(int(str(record["left"])) for record in records)
    first = next((f", first: {record['case']}" for record in records if "case" in record), "")
    return [
        *(
            Measure(
                label=label,
                value=f"{counts[key]} of {total}{first if key == 'refused' else ''}",
                bar="all",
                holds=counts[key] == total,
            )
            for key, label in labels.items()
        ),
        Measure(label="unfinished or damaged files left", value=str(left), bar="0", holds=left == 0),
    ]


STUDY = Study(
    title="Full disk",
    question="A page, a dataset, a recording or a sweep is written over its earlier self where files end at a random"
    " size. One line says so; nothing that stood before is lost, nothing unfinished stays.",
    sources=("storage/files.py", "design/sweep_dataset.py", "rig/datasets.py"),
    trials=500,
    sample=10,
    trial=_trial,
    measures=_measures,
)
