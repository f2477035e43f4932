"""Damaged recordings, impedance spectra and surfaces: small ones of every format, and real ones where present."""

import random
import tempfile
import warnings
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from reliability.damage import mutated
from reliability.study import Measure, Record, Study
from sonolube.errors import SonolubeError
from sonolube.measurement.impedance.spectrum import read_impedance
from sonolube.measurement.recordings.reader import read_recording
from sonolube.measurement.surface_files.reader import read_height_map

_ROOT = Path(__file__).parents[2]
_COMPLETED: dict[str, dict[str, Any]] = {".xyz": {"length_unit": "um"}, ".npy": {"spacing_x": 1e-6, "spacing_y": 1e-6}}
_READERS: dict[str, Callable[[Path], object]] = {
    "recordings": read_recording,
    "impedance": read_impedance,
    "surface_files": lambda path: read_height_map(path, **_COMPLETED.get(path.suffix, {})),
}
_REAL = {"recordings": "friction", "impedance": "impedance", "surface_files": "surfaces"}
_REAL_SHARE = 0.03  # of the trials; a real file takes a hundred times as long as one of the corpus


def _made_recordings(folder: Path) -> list[Path]:
    """Write small recordings of the formats of which the corpus has no file."""
    import h5py
    from scipy.io import netcdf_file, savemat

    time, force = np.linspace(0, 1, 50), np.sin(np.arange(50.0))
    with h5py.File(folder / "a.h5", "w") as file:
        file["time"], file["friction_force"] = time, force
        file.create_dataset("group/deflated", data=force, chunks=(10,), compression=4)
    savemat(folder / "a.mat", {"time": time, "force": force, "s": {"x": force}})
    savemat(folder / "deflated.mat", {"time": time, "force": force}, do_compression=True)
    savemat(folder / "old.mat", {"time": time, "force": force}, format="4")
    with netcdf_file(folder / "a.nc", "w") as file:
        file.createDimension("time", 50)
        for name, values in (("time", time), ("force", force)):
            file.createVariable(name, "d", ("time",))[:] = values
    return sorted(folder.iterdir())


@cache
def _originals(room: str, *, real: bool) -> tuple[tuple[str, bytes], ...]:
    """Suffix and content of the files of a room."""
    corpus = _ROOT / "tests" / "measurement" / room / "corpus"
    folder = _ROOT.parent / "shared" / "data" / _REAL[room] if real else corpus
    found = [(path.suffix, path.read_bytes()) for path in sorted(folder.iterdir())] if folder.is_dir() else []
    if room == "recordings" and not real:
        with tempfile.TemporaryDirectory() as made:
            found += [(path.suffix, path.read_bytes()) for path in _made_recordings(Path(made))]
    return tuple(found)


def _trial(seed: int) -> Record:
    rng = random.Random(seed)
    room = rng.choice(sorted(_READERS))
    real = rng.random() < _REAL_SHARE and bool(_originals(room, real=True))
    suffix, content = rng.choice(_originals(room, real=real))
    others = [other for _, other in _originals(room, real=False)]
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        path = Path(folder) / f"input{suffix}"
        path.write_bytes(mutated(content, rng, others=others))
        try:
            _READERS[room](path)
        except SonolubeError as refused:
            message = str(refused)
            clear = message.startswith(f"{path}: ") and "\n" not in message
            return {"room": room, "outcome": "refused" if clear else message}
    return {"room": room, "outcome": "read"}


def _measures(records: Sequence[Record]) -> list[Measure]:
    clear = sum(record["outcome"] in ("read", "refused") for record in records)
    read = sum(record["outcome"] == "read" for record in records)
    return [
        Measure(
            label="files read, or refused in one line that names them",
            value=f"{clear} of {len(records)}",
            bar="all",
            holds=clear == len(records),
        ),
        Measure(label="of these read in spite of the damage", value=f"{read / len(records):.0%}"),
    ]


STUDY = Study(
    title="Damaged files",
    question="A recording, impedance spectrum or surface of any format with bytes flipped, cut, doubled or replaced is"
    " read or refused in one line that names it.",
    sources=("measurement/**/*.py",),
    trials=28_000,
    sample=300,
    trial=_trial,
    measures=_measures,
)
