"""Random height maps written in surface formats with random units, whose sizes and heights are read back."""

import importlib.util
import struct
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from reliability.study import Measure, Record, Study
from sonolube.checks import Floats
from sonolube.measurement.surface_files.reader import read_surface_file

_UNITS = {"m": 1.0, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}
_BAR = 1e-6

Given = dict[str, float | str]
Writer = Callable[[Path, Floats, tuple[float, float], str], Given]
"""Writes heights and the distances of columns and rows, in m, with a unit; returns what the reader must be given."""


def _npy(path: Path, height: Floats, steps: tuple[float, float], unit: str) -> Given:
    np.save(path, height / _UNITS[unit])
    return {"spacing_x": steps[0], "spacing_y": steps[1], "length_unit": unit}


def _xyz(path: Path, height: Floats, steps: tuple[float, float], unit: str) -> Given:
    per = 1 / _UNITS[unit]
    path.write_text(
        "\n".join(
            f"{per * steps[0] * column:.12g} {per * steps[1] * row:.12g} {per * z:.12g}"
            for (row, column), z in np.ndenumerate(height)
        )
    )
    return {"length_unit": unit}


def _xz(path: Path, height: Floats, steps: tuple[float, float], unit: str) -> Given:
    per = 1 / _UNITS[unit]
    path.write_text("\n".join(f"{per * steps[0] * i:.12g};{per * z:.12g}" for i, z in enumerate(height[0])))
    return {"length_unit": unit}


def _opd(path: Path, height: Floats, steps: tuple[float, float], unit: str) -> Given:
    wavelength = 600.0  # nm
    waves = (height[::-1] / (1e-9 * wavelength)).T.astype("<f4")
    blocks = (
        (b"RAW_DATA", 3, struct.pack("<HHH", *waves.shape, 4) + waves.tobytes()),
        (b"Wavelength", 8, struct.pack("<d", wavelength)),
        (b"Pixel_size", 8, struct.pack("<d", 1e3 * steps[0])),
        (b"Aspect", 8, struct.pack("<d", steps[1] / steps[0])),
    )
    entry = struct.Struct("<16shiH")
    directory = entry.pack(b"Directory", 1, entry.size * (len(blocks) + 1), 0)
    directory += b"".join(entry.pack(name, kind, len(content), 0) for name, kind, content in blocks)
    path.write_bytes(b"\1\0" + directory + b"".join(content for _, _, content in blocks))
    return {}


def _nms(path: Path, height: Floats, steps: tuple[float, float], unit: str) -> Given:
    header = bytearray(3468)
    bottom, top = height.min(), height.max()
    struct.pack_into("<4i2d", header, 0, 2, 1, 0, 65535, 1e6 * bottom, 1e6 * top)
    header[32:41] = b"OM_MS_2.0"
    struct.pack_into("<2I2d", header, 1368, height.shape[1], height.shape[0], 1e9 * steps[0], 1e9 * steps[1])
    numbers = np.rint(65535 * (height - bottom) / (top - bottom))
    height[:] = bottom + (top - bottom) * numbers / 65535  # what 16 bits hold
    path.write_bytes(bytes(header) + numbers.astype("<u2").tobytes())
    return {}


def _sur(path: Path, height: Floats, steps: tuple[float, float], unit: str) -> Given:
    per = 1 / _UNITS[unit]
    quantum = float(np.float32(np.ptp(height) / 1e8 / 1e-9))  # nm
    numbers = np.rint(height / (1e-9 * quantum))
    height[:] = 1e-9 * quantum * numbers
    rows, columns = height.shape
    header = struct.pack("<12s4h30s30s7H", b"DIGITAL SURF", 0, 1, 1, 2, b"", b"", 0, 0, 0, 1, 0, 0, 0)
    header += struct.pack("<2HH4iI", 0, 0, 32, int(numbers.min()), int(numbers.max()), columns, rows, numbers.size)
    header += struct.pack("<3f", per * steps[0], per * steps[1], quantum)
    spelt = unit.replace("u", "\xb5").encode("latin-1")
    names = (b"X", b"Y", b"Z", spelt, spelt, b"nm", spelt, spelt, b"nm")
    header += b"".join(struct.pack("<16s", name) for name in names) + struct.pack("<3f", 1, 1, 1)
    path.write_bytes(header.ljust(512, b"\0") + numbers.astype("<i4").tobytes())
    return {}


def _matrix(path: Path, height: Floats, steps: tuple[float, float], unit: str) -> Given:
    rows, columns = height.shape
    sizes = (columns * steps[0] / _UNITS[unit], rows * steps[1] / _UNITS[unit])
    spelt = unit.replace("u", "\xb5")
    header = (
        f"# Channel: Height\n# Width: {sizes[0]:.12g} {spelt}\n# Height: {sizes[1]:.12g} {spelt}\n# Value units: m\n"
    )
    path.write_text(header + "\n".join(" ".join(f"{z:.12g}" for z in row) for row in height) + "\n", encoding="utf-8")
    return {}


def _by_library(suffix: str) -> Writer:
    def write(path: Path, height: Floats, steps: tuple[float, float], unit: str) -> Given:
        import SurfaceTopography

        sizes = (height.shape[1] * steps[0] / _UNITS[unit], height.shape[0] * steps[1] / _UNITS[unit])
        spelt = unit.replace("u", "\xb5")
        topography = SurfaceTopography.Topography(height.T / _UNITS[unit], sizes, unit=spelt)
        getattr(topography, {"x3p": "to_x3p", "gwy": "to_gwy", "nc": "to_netcdf"}[suffix])(str(path))
        return {}

    return write


_OWN: dict[str, Writer] = {"npy": _npy, "xyz": _xyz, "txt": _xz, "opd": _opd, "nms": _nms}
_LIBRARY: dict[str, Writer] = {
    "sur": _sur,
    "asc": _matrix,
    "x3p": _by_library("x3p"),
    "gwy": _by_library("gwy"),
    "nc": _by_library("nc"),
}
_WRITERS = _OWN | (_LIBRARY if importlib.util.find_spec("SurfaceTopography") else {})


def _trial(seed: int) -> Record:
    rng = np.random.default_rng(seed)
    suffix = list(_WRITERS)[seed % len(_WRITERS)]
    unit = str(rng.choice(list(_UNITS)))
    step = 10 ** rng.uniform(-7.3, -4)
    steps = (step, step * rng.uniform(0.5, 2))
    height = rng.uniform(0.001, 0.2) * step * rng.standard_normal((rng.integers(4, 20), rng.integers(30, 60)))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"plate.{suffix}"
        given = _WRITERS[suffix](path, height, steps, unit)
        found = read_surface_file(path, **given)  # type: ignore[arg-type]
    surface = found.height_map
    expected = height[:1] if suffix == "txt" else height
    if surface.height.shape != expected.shape:
        return {"format": suffix, "size": 1.0, "height": 1.0, "unit": found.lateral_unit}
    errors = [abs(surface.spacing_x / steps[0] - 1)]
    if suffix != "txt":
        errors.append(abs(surface.spacing_y / steps[1] - 1))
    return {
        "format": suffix,
        "size": float(max(errors)),
        "height": float(np.abs(surface.height - expected).max() / np.ptp(expected)),
        "unit": found.lateral_unit,
    }


def _measures(records: Sequence[Record]) -> list[Measure]:
    formats = Counter(str(record["format"]) for record in records)
    origins = sum(", " in str(record["unit"]) for record in records)
    return [
        _worst(records, "size", "greatest relative deviation of the distance of pixels"),
        _worst(records, "height", "greatest deviation of a height, over their range"),
        Measure(
            label="files whose lateral unit and its origin are stated",
            value=f"{origins} of {len(records)}",
            bar="all",
            holds=origins == len(records),
        ),
        Measure(label="formats", value=", ".join(sorted(formats))),
    ]


def _worst(records: Sequence[Record], key: str, label: str) -> Measure:
    worst = max(float(str(record[key])) for record in records)
    return Measure(label=label, value=f"{worst:.2g}", bar=f"{_BAR:g} at most", holds=worst <= _BAR)


STUDY = Study(
    title="Sizes of surface files",
    question="Height maps of random size, height and unit, written in ten formats, are read back with their distances"
    " of pixels and heights, and with the origin of their lateral unit.",
    sources=("measurement/surface_files/*.py",),
    trials=1500,
    sample=20,
    trial=_trial,
    measures=_measures,
)
