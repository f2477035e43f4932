"""Files made to take memory, time or other files: each is read in a process of limited memory and time."""

import contextlib
import io
import os
import random
import resource
import signal
import struct
import tempfile
import time
import zipfile
import zlib
from collections import Counter
from collections.abc import Callable, Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from reliability.study import Measure, Record, Study
from sonolube.errors import SonolubeError
from sonolube.measurement.impedance.spectrum import read_impedance
from sonolube.measurement.measured_runs import read_runs
from sonolube.measurement.recordings.reader import read_recording
from sonolube.measurement.surface_files.reader import read_height_map
from sonolube.rig import read_rig
from sonolube.rig.file.modes_file import read_modes
from sonolube.text.units import to_si

_MEMORY = 10**9  # bytes beside those of the process
_SECONDS = 10  # of processor time
_PATIENCE = 60  # s, after which a process is ended
_READERS: dict[str, Callable[[Path], object]] = {
    ".csv": read_impedance,
    ".s1p": read_impedance,
    ".runs": read_runs,
    ".modes": read_modes,
    ".toml": read_rig,
    **dict.fromkeys((".x3p", ".npy", ".asc", ".opd"), read_height_map),
}


def _hdf5(path: Path, rng: random.Random, kind: str) -> None:
    """Write an HDF5 file, or by its suffix MATLAB 7.3, of one kind of hostility."""
    import h5py

    with h5py.File(path, "w", userblock_size=512 if path.suffix == ".mat" else 0) as file:
        file.attrs["sample_rate"] = 1000.0
        _fill_hdf5(file, rng, kind)
    if path.suffix == ".mat":
        with path.open("r+b") as stream:
            stream.write(b"MATLAB 7.3 MAT-file".ljust(124) + b"\0\2IM")


def _fill_hdf5(file: Any, rng: random.Random, kind: str) -> None:
    import h5py

    size = int(10 ** rng.uniform(6, 13))
    match kind:
        case "claim":
            layout = rng.choice(
                ({}, {"chunks": (rng.choice((1, 1000, 10**6)),)}, {"chunks": (1000,), "compression": 9})
            )
            file.create_dataset("force", (size,), "f8", **layout)
        case "zeros":
            file.create_dataset("force", data=np.zeros(rng.randrange(10**6, 3 * 10**7), "i1"), compression=9)
        case "chunk bomb":
            dataset = file.create_dataset("force", (1000,), "f8", chunks=(1000,), compression=9)
            dataset.id.write_direct_chunk((0,), zlib.compress(bytes(rng.randrange(10**7, 3 * 10**8)), 1))
        case "storage":
            file.create_dataset("force", (100,), "i1", external=[("/etc/passwd", 0, 100)])
        case "virtual":
            layout = h5py.VirtualLayout((size,), "f8")
            layout[:100] = h5py.VirtualSource("/tmp/other.h5", "x", (100,))
            file.create_virtual_dataset("force", layout)
        case _:
            _fill_with_objects(file, rng, kind)


def _fill_with_objects(file: Any, rng: random.Random, kind: str) -> None:
    import h5py

    match kind:
        case "many":
            for index in range(rng.randrange(500, 6000)):
                file[f"channel{index}"] = np.arange(3.0)
        case "deep":
            group = file
            for _ in range(rng.randrange(10, 600)):
                group = group.create_group("g")
            group["force"] = np.arange(3.0)
        case "links":
            file["force"] = rng.choice((h5py.ExternalLink("/etc/passwd", "x"), h5py.SoftLink("/force")))
            file.create_group("cycle")["up"] = file["/"]
        case _:
            file["time"], file["force"] = np.arange(10.0), np.arange(float(rng.randrange(2, 10)))


_HDF5_KINDS = ("claim", "zeros", "chunk bomb", "many", "deep", "links", "storage", "virtual", "lengths")


def _matlab(rng: random.Random) -> bytes:
    """A MATLAB file of version 4 or 5 that states or unpacks to more than it holds."""
    size = int(10 ** rng.uniform(3, 9))
    if rng.random() < 0.3:
        return struct.pack("<5i", 0, size, 1, 0, 2) + b"x\0" + bytes(rng.randrange(3000))
    held = min(size, rng.choice((100, 2 * 10**7)))
    flags = struct.pack("<4I", 6, 8, rng.choice((6, 2, 1, 4)), 0)
    dimensions = struct.pack("<2I2i", 5, 8, 1, size)
    name = struct.pack("<2I", 1, 1) + b"x".ljust(8, b"\0")
    content = flags + dimensions + name + struct.pack("<2I", 9, (8 * size) & 0xFFFFFFFF) + bytes(8 * held)
    element = struct.pack("<2I", 14, len(content) & 0xFFFFFFFF) + content
    packed = zlib.compress(element, 1)
    return b"MATLAB 5.0".ljust(124) + b"\0\1IM" + struct.pack("<2I", 15, len(packed)) + packed


def _netcdf(rng: random.Random) -> bytes:
    """A classic netCDF file that states a dimension of any length."""
    length = rng.choice((5, rng.randrange(1 << 31), (1 << 31) - 1))
    name = struct.pack(">i", 1) + b"x\0\0\0"
    dimensions = struct.pack(">2i", 10, 1) + name + struct.pack(">i", length)
    variables = struct.pack(">2i", 11, 1) + name + struct.pack(">7i", 1, 0, 0, 0, 6, (8 * length) & 0x7FFFFFF8, 100)
    return b"CDF\1" + struct.pack(">i", rng.choice((0, length))) + dimensions + bytes(8) + variables + bytes(100)


def _x3p(rng: random.Random) -> bytes:
    """An X3P archive with a bomb of zeros, of entities or of elements, or of a matrix that is not there."""
    entities = "".join(f'<!ENTITY e{at} "{f"&e{at - 1};" * 10}">' for at in range(1, 12))
    lengths = f"<SizeX>{rng.randrange(1 << 20)}</SizeX><SizeY>{rng.randrange(1 << 20)}</SizeY><SizeZ>1</SizeZ>"
    main = rng.choice((
        f'<!DOCTYPE a [<!ENTITY e0 "laugh">{entities}]><a>&e11;</a>',
        "<a>" + "<b/>" * rng.randrange(10**6) + "</a>",
        f"<p:ISO5436_2><Record3><MatrixDimension>{lengths}</MatrixDimension></Record3></p:ISO5436_2>",
    ))  # fmt: skip
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        archive.writestr("main.xml", main)
        archive.writestr("bindata/data.bin", bytes(rng.randrange(3 * 10**8)))
    return stream.getvalue()


def _npy(rng: random.Random) -> bytes:
    """An NPY file that states any shape and type."""
    shape = (rng.randrange(1 << 40), rng.randrange(1 << 20))
    header = f"{{'descr': '{rng.choice(('<f8', '|O', '<i1'))}', 'fortran_order': False, 'shape': {shape}}}\n".encode()
    return b"\x93NUMPY\1\0" + struct.pack("<H", len(header)) + header + bytes(200)


def _text(rng: random.Random) -> bytes:
    """A long text of one pattern."""
    pattern = rng.choice(
        (b"\n", b"1 ", b"1\n", b"# a = b\n", b"x,", b"f,", b"1;", b" ", b"[", b"a.", b"Hz ", b"1 2 3 4\n", b'"')
    )
    head = rng.choice(
        (b"", b"# ", b"f,R,X\n", b"chunk;timestamp;size;fieldname\n0;0;0;frequency;", b"a = ", b"-1\n58\n")
    )
    return head + pattern * (rng.randrange(2 * 10**6) // len(pattern))


def _make(folder: Path, rng: random.Random) -> tuple[str, Path]:
    """Write a hostile file; its kind and path."""
    if rng.random() < 0.5:
        kind = rng.choice(_HDF5_KINDS)
        path = folder / rng.choice(("a.h5", "a.mat", "a.asc"))
        _hdf5(path, rng, kind)
        return kind, path
    make, suffixes = rng.choice((
        (_matlab, (".mat", ".asc")), (_netcdf, (".nc",)), (_x3p, (".x3p",)), (_npy, (".npy",)),
        (_text, (".csv", ".s1p", ".runs", ".modes", ".toml", ".asc", ".uff", ".lvm")),
    ))  # fmt: skip
    path = folder / f"a{rng.choice(suffixes)}"
    path.write_bytes(make(rng))
    return make.__name__.strip("_"), path


def _read(path: Path) -> str:
    """What comes of reading a file, in this process."""
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + _MEMORY, resource.RLIM_INFINITY))
    try:
        _READERS.get(path.suffix, read_recording)(path)
    except SonolubeError as refused:
        message = str(refused)
        if "MemoryError" in message or "llocate" in message:
            return f"memory: {message}"
        return "refused" if "\n" not in message else f"more than one line: {message}"
    except MemoryError:
        return "memory"
    except BaseException as failure:  # a traceback to the user
        return f"{type(failure).__name__}: {failure}"
    return "read"


@cache
def _import_libraries() -> None:
    """Import what the readers import on first use, which is no part of the time for a file."""
    for name in ("h5py", "xarray", "pyuff", "scipy.io", "nptdms", "pandas", "SurfaceTopography"):
        with contextlib.suppress(ImportError):
            import_module(name)
    to_si("1 mm", unit="m", name="length")


def _outcome(path: Path) -> tuple[str, float]:
    """What comes of reading a file in a process of limited memory, and its processor time. [s]"""
    _import_libraries()
    reading, writing = os.pipe()
    started = time.monotonic()
    child = os.fork()
    if child == 0:
        os.write(writing, _read(path)[:500].encode())
        os._exit(0)
    os.close(writing)
    ended, _, used = os.wait4(child, os.WNOHANG)
    while not ended:
        if time.monotonic() - started > _PATIENCE:
            os.kill(child, signal.SIGKILL)
        time.sleep(0.005)
        ended, _, used = os.wait4(child, os.WNOHANG)
    seconds = used.ru_utime + used.ru_stime
    with os.fdopen(reading, "rb") as stream:
        outcome = stream.read().decode()
    ended_by_force = time.monotonic() - started > _PATIENCE
    return "hang" if ended_by_force or seconds > _SECONDS else outcome or "killed", seconds


def _trial(seed: int) -> Record:
    with tempfile.TemporaryDirectory() as folder:
        kind, path = _make(Path(folder), random.Random(seed))
        outcome, seconds = _outcome(path)
        return {"kind": kind, "suffix": path.suffix, "outcome": outcome, "seconds": round(seconds, 3)}


def _measures(records: Sequence[Record]) -> list[Measure]:
    outcomes = [str(record["outcome"]) for record in records]
    counts = Counter(
        "memory" if outcome.startswith("memory") or outcome == "killed" else
        outcome if outcome in ("read", "refused", "hang") else "traceback"
        for outcome in outcomes
    )  # fmt: skip
    slowest = max(float(str(record["seconds"])) for record in records)
    return [
        Measure(label=label, value=str(counts[key]), bar="0", holds=counts[key] == 0)
        for label, key in (
            (f"files that take more than {_SECONDS} s", "hang"),
            (f"files that take more than {_MEMORY / 1e9:.0f} GB", "memory"),
            ("tracebacks", "traceback"),
        )
    ] + [
        Measure(label="longest time for a file", value=f"{slowest:.1f} s"),
        Measure(label="files refused in one line; the others hold what they state", value=str(counts["refused"])),
    ]


STUDY = Study(
    title="File bombs",
    question="A file below 10 MB that states huge sizes, unpacks to zeros, has thousands of datasets, cyclic or outward"
    " links, or text without end is read or refused in one line, within 10 s and 1 GB above the process that reads it.",
    sources=("measurement/**/*.py", "rig/file/*.py"),
    trials=1000,
    sample=25,
    trial=_trial,
    measures=_measures,
)
