"""Surface files in: a format found by its content, heights in metres, and where they came from."""

import hashlib
import warnings
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import BinaryIO

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.surface_reading import SurfaceReading
from sonolube.measurement.surface_files.surface_topography import read_with_surface_topography
from sonolube.measurement.surface_files.wyko import WYKO_MAGIC, read_wyko
from sonolube.measurement.surface_files.xyz import is_point, read_xyz
from sonolube.surfaces import HeightMap
from sonolube.units import convert

_NPY_MAGIC = b"\x93NUMPY"
_HEAD = 8192
_SPACING_ADVICE = "give spacing_x and spacing_y, the distances of columns and rows in m"
_UNIT_ADVICE = 'give length_unit, such as "um"'


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SurfaceFile:
    """A height map and where it came from.

    Parameters
    ----------
    height_map : HeightMap
        What was measured.
    path : Path
        The file it was read from.
    sha256 : str
        Digest of the file's bytes, in hexadecimal.
    format_name : str
        The file's format, such as "Wyko OPD".
    title, instrument : str
        As the file gives them; empty where it does not.
    measured_at : datetime or None
        When it was measured, by the instrument's clock; None where the file does not say.
    """

    height_map: HeightMap
    path: Path
    sha256: str
    format_name: str
    title: str = ""
    instrument: str = ""
    measured_at: datetime | None = None


def read_surface_file(
    path: Path | str,
    *,
    spacing_x: float | None = None,
    spacing_y: float | None = None,
    length_unit: str | None = None,
) -> SurfaceFile:
    """Read a surface file and its provenance.

    Parameters
    ----------
    path : Path or str
        Wyko OPD, NPY or XYZ text; with the extra ``surfaces`` also SUR, X3P, SDF, PLU, VK, AL3D, GWY, OPDx, MetroPro
        and the other formats of SurfaceTopography. The content decides, not the name.
    spacing_x, spacing_y : float, optional
        Distance of neighbouring columns and rows, only for a file that does not say, such as NPY. [m]
    length_unit : str, optional
        Unit of the lengths in a file that does not say, such as "um": needed for XYZ text; an NPY file without it
        holds metres.

    Returns
    -------
    SurfaceFile
        Heights in metres. Columns follow x and rows follow y as the file has them: where it holds a picture the first
        row is the top, where it holds positions (XYZ text) the first row has the smallest y.

    Raises
    ------
    InvalidInput
        If the file cannot be read, is truncated or damaged (naming the byte), holds no measured pixel, lacks a
        spacing or unit that was not given either, or states one that was given as well.

    Notes
    -----
    Memory stays within a small multiple of the file's size, whatever the file claims, for OPD, NPY and XYZ.
    """
    place = Path(path)
    try:
        with place.open("rb") as stream:
            digest = hashlib.file_digest(stream, "sha256").hexdigest()
            reading = _read(stream, place)
    except OSError as failure:
        raise InvalidInput(f"{place}: cannot be read: {failure.strerror or failure}") from None
    height_map = _height_map(reading, place, spacing_x=spacing_x, spacing_y=spacing_y, length_unit=length_unit)
    return SurfaceFile(
        height_map=height_map,
        path=place,
        sha256=digest,
        format_name=reading.format_name,
        title=reading.title,
        instrument=reading.instrument,
        measured_at=reading.measured_at,
    )


def read_height_map(
    path: Path | str,
    *,
    spacing_x: float | None = None,
    spacing_y: float | None = None,
    length_unit: str | None = None,
) -> HeightMap:
    """Read the heights of a surface file.

    Parameters
    ----------
    path : Path or str
        The file, in any format of `read_surface_file`.
    spacing_x, spacing_y : float, optional
        Distance of neighbouring columns and rows, only for a file that does not say, such as NPY. [m]
    length_unit : str, optional
        Unit of the lengths in a file that does not say, such as "um".

    Returns
    -------
    HeightMap

    Raises
    ------
    InvalidInput
        As `read_surface_file`.
    """
    return read_surface_file(path, spacing_x=spacing_x, spacing_y=spacing_y, length_unit=length_unit).height_map


def _read(stream: BinaryIO, path: Path) -> SurfaceReading:
    stream.seek(0)
    head = stream.read(_HEAD)
    if not head:
        raise InvalidInput(f"{path}: byte 0: the file is empty")
    suffix = path.suffix.lower()
    if head[2:].startswith(WYKO_MAGIC) or suffix == ".opd":
        return read_wyko(stream, name=str(path))
    if head.startswith(_NPY_MAGIC) or suffix == ".npy":
        return _read_npy(stream, path)
    if suffix == ".xyz" or _are_points(head):
        return read_xyz(stream, name=str(path))
    return read_with_surface_topography(path)


def _are_points(head: bytes) -> bool:
    """Return whether text ends in lines of three numbers."""
    whole_lines = head.splitlines()[: -1 if len(head) == _HEAD else None]
    return b"\0" not in head and len(whole_lines) > 3 and all(is_point(line) for line in whole_lines[-3:])


def _read_npy(stream: BinaryIO, path: Path) -> SurfaceReading:
    stream.seek(0)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of old headers
            mapped = np.load(path, mmap_mode="r", allow_pickle=False)  # mapped: refuses a size beyond the file's
            height = np.array(mapped, dtype=np.float64) if mapped.ndim == 2 and mapped.dtype.kind in "fiu" else None
    except Exception as failure:  # of a damaged header comes whatever evaluating it raises
        raise InvalidInput(f"{path}: not a whole NPY file: {' '.join(str(failure).split())[:200]}") from None
    if height is None:
        raise InvalidInput(f"{path}: heights are a matrix of numbers, got shape {mapped.shape} of {mapped.dtype}")
    return SurfaceReading(height=height, format_name="NPY", states_unit=False)


def _height_map(
    reading: SurfaceReading,
    path: Path,
    *,
    spacing_x: float | None,
    spacing_y: float | None,
    length_unit: str | None,
) -> HeightMap:
    if reading.states_unit and length_unit is not None:
        raise InvalidInput(f"{path}: {reading.format_name} states its unit; leave length_unit out")
    if not reading.states_unit and length_unit is None and reading.format_name != "NPY":
        raise InvalidInput(f"{path}: {reading.format_name} does not say its unit; {_UNIT_ADVICE}")
    unit = convert(1.0, from_unit=length_unit, to_unit="m") if length_unit else 1.0
    try:
        step_x, step_y = _spacings(reading, unit, spacing_x=spacing_x, spacing_y=spacing_y)
        return HeightMap(height=unit * reading.height, spacing_x=step_x, spacing_y=step_y)
    except InvalidInput as failure:
        raise InvalidInput(f"{path}: {failure}") from None


def _spacings(
    reading: SurfaceReading, unit: float, *, spacing_x: float | None, spacing_y: float | None
) -> tuple[float, float]:
    if reading.spacing_x is not None and reading.spacing_y is not None:
        if spacing_x is not None or spacing_y is not None:
            raise InvalidInput(f"{reading.format_name} states its spacing; leave spacing_x and spacing_y out")
        return unit * reading.spacing_x, unit * reading.spacing_y
    if spacing_x is None or spacing_y is None:
        raise InvalidInput(f"the distance of pixels is not in the file; {_SPACING_ADVICE}")
    return spacing_x, spacing_y
