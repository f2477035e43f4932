"""Reading of surface files as height maps in metres with their provenance, in any format of `SURFACE_FORMATS`.

A format is one class and one line of the table; detection and documentation derive from it.
"""

import hashlib
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import BinaryIO, Protocol

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import FileFormat, detect_format, read_head, refuse_unreadable, require_whole
from sonolube.models.surfaces import HeightMap
from sonolube.storage.user_files import require_file
from sonolube.text.units import convert, format_si
from sonolube.variants import VariantTable

STATED_BY_FILE = "stated in the file"
FIXED_BY_FORMAT = "fixed by the format"
LIBRARY_DEFAULT = "SurfaceTopography's default for the format"
GIVEN_BY_USER = "given by the user"
ASSUMED_METRES = "assumed, as the file states none and none was given"


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SurfaceReading:
    """Heights, spacings and provenance as a surface file states them.

    Parameters
    ----------
    height : ndarray, shape (rows, columns)
        Height, NaN where it was not measured; in the length unit of the file where it does not state that unit. A
        profile is one row. [m]
    format_name : str
        The file's format, such as "Wyko OPD".
    spacing_x, spacing_y : float or None
        Distance of neighbouring columns and rows, in the unit of the heights; None where the file states none. [m]
    states_unit : bool
        Whether the unit of its lengths is known from the file or its format; heights and spacings are in metres then.
    metres_by_default : bool
        Whether lengths without a stated unit are metres where the user gives no unit.
    lateral_unit : str
        Unit in which the file's spacings are written; empty where it is not known from the file or its format.
    unit_origin : str
        How that unit is known: `STATED_BY_FILE`, `FIXED_BY_FORMAT` or `LIBRARY_DEFAULT`; empty where it is not.
    title, instrument : str
        As the file states them; empty where it does not.
    measured_at : datetime or None
        Time of the measurement, by the instrument's clock.
    notes : tuple of str
        What was done to the heights in reading, such as interpolation at even steps.
    """

    height: Floats
    format_name: str
    spacing_x: float | None = None
    spacing_y: float | None = None
    states_unit: bool = True
    metres_by_default: bool = False
    lateral_unit: str = ""
    unit_origin: str = ""
    title: str = ""
    instrument: str = ""
    measured_at: datetime | None = None
    notes: tuple[str, ...] = ()


class SurfaceFormat(FileFormat, Protocol):
    """Reader of one file format of surfaces."""

    def read(self, stream: BinaryIO, path: Path) -> SurfaceReading:
        """Heights of a surface file and what else it states.

        Parameters
        ----------
        stream : binary file
            The file, open for reading; seekable.
        path : Path
            Of the file, for messages, and for libraries that open it themselves.

        Returns
        -------
        SurfaceReading

        Raises
        ------
        InvalidInput
            Naming the file, the byte where known, and the reason, if the file cannot be read.
        """


SURFACE_FORMATS: VariantTable[SurfaceFormat] = VariantTable(
    "surface format",
    {
        "Wyko OPD": "sonolube.measurement.surface_files.binary_formats:WykoOpd",
        "NanoFocus NMS": "sonolube.measurement.surface_files.binary_formats:NanoFocusNms",
        "NPY": "sonolube.measurement.surface_files.binary_formats:Npy",
        "XYZ text": "sonolube.measurement.surface_files.xyz:XyzText",
        "SurfaceTopography": "sonolube.measurement.surface_files.surface_topography:SurfaceTopographyFormats",
    },
    made=lambda known: known(),
)
"""File formats of surfaces in order of detection, the last one as fallback; a new one takes its file and one line."""


_LARGEST_FIELD = 0.5  # m, which no profilometer scans
_SMALLEST_FIELD = 1e-6  # m, below which only force microscopes scan


def _size_caveats(height_map: HeightMap, *, unit: str) -> tuple[str, ...]:
    """Caveats of an implausible size of a field or range of its heights, one line each.

    Empty for a field from 1 um to 0.5 m along its longer side with a range of heights below that side.
    """
    height, (rows, columns) = height_map.height, height_map.height.shape
    sides = (columns * height_map.spacing_x, *([] if rows == 1 else [rows * height_map.spacing_y]))
    field = " x ".join(format_si(side, "m", digits=4) for side in sides)
    check = f"check the lateral unit ({unit})"
    found = []
    if max(sides) > _LARGEST_FIELD:
        found.append(f"the field is {field}, beyond the {_LARGEST_FIELD:g} m that profilometers reach: {check}")
    if max(sides) < _SMALLEST_FIELD:
        found.append(f"the field is {field}, which only a force microscope scans: {check}")
    height_range = float(np.nanmax(height) - np.nanmin(height))
    if height_range > max(sides):
        span = format_si(height_range, "m", digits=4)
        found.append(f"heights range over {span}, more than the field of {field}: {check}, and that of the heights")
    return tuple(found)


_LARGEST_SPACING = 1e6  # m, beyond which areas and slopes lose their digits
_SPACING_ADVICE = "give spacing_x and spacing_y, the distances of columns and rows in m"
_UNIT_ADVICE = 'give length_unit, such as "um"'


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SurfaceFile:
    """A height map and its provenance.

    Parameters
    ----------
    height_map : HeightMap
        The measured heights.
    path : Path
        The file it was read from.
    sha256 : str
        Digest of the file's bytes, in hexadecimal.
    format_name : str
        The file's format, such as "Wyko OPD".
    title, instrument : str
        As the file states them; empty where it does not.
    measured_at : datetime or None
        Time of the measurement by the instrument's clock; None where the file does not state it.
    lateral_unit : str
        Unit of the lengths along the surface and how it is known, such as "um, stated in the file".
    caveats : tuple of str
        What was done to the heights in reading, and what is implausible about their size.
    """

    height_map: HeightMap
    path: Path
    sha256: str
    format_name: str
    title: str = ""
    instrument: str = ""
    measured_at: datetime | None = None
    lateral_unit: str = ""
    caveats: tuple[str, ...] = ()


def read_surface_file(
    path: Path | str, *, spacing_x: float | None = None, spacing_y: float | None = None, length_unit: str | None = None
) -> SurfaceFile:
    """Height map of a surface file with its provenance.

    Parameters
    ----------
    path : Path or str
        In any format of `SURFACE_FORMATS`, which is detected by content and then by suffix: Wyko OPD, NanoFocus NMS,
        NPY or XYZ text (of a profile also in two columns); with the extra ``surfaces`` also SUR, X3P, SDF, PLU, VK,
        AL3D, GWY, OPDx, MetroPro and the other formats of SurfaceTopography.
    spacing_x, spacing_y : float, optional
        Distance of neighbouring columns and rows, only for a file that does not state it, such as NPY. [m]
    length_unit : str, optional
        Unit of the lengths in a file that does not state it, such as "um": required for XYZ text; an NPY file without
        it is in metres.

    Returns
    -------
    SurfaceFile
        A profile is a map of one row.
        Heights in metres. Columns follow x and rows follow y as in the file: where it holds a picture the first row is
        the top, where it holds positions (XYZ text) the first row has the smallest y.

    Raises
    ------
    InvalidInput
        If the file cannot be read, is truncated or damaged (naming the byte), holds no measured pixel, lacks a
        spacing or unit that was not given either, or states one that was given as well.

    Notes
    -----
    For OPD, NMS, NPY and XYZ files memory stays within a small multiple of the file's size, whatever size it states.
    """
    place = Path(path)
    with refuse_unreadable(place):
        require_file(place)
    formats = tuple(SURFACE_FORMATS.values())
    file_format = detect_format(formats, read_head(place), place) or formats[-1]
    require_whole(place)
    with refuse_unreadable(place), place.open("rb") as stream:
        digest = hashlib.file_digest(stream, "sha256").hexdigest()
        reading = file_format.read(stream, place)
    height_map = _height_map(reading, place, spacing_x=spacing_x, spacing_y=spacing_y, length_unit=length_unit)
    unit = _lateral_unit(reading, length_unit, spacing_x)
    return SurfaceFile(
        height_map=height_map,
        path=place,
        sha256=digest,
        format_name=reading.format_name,
        title=reading.title,
        instrument=reading.instrument,
        measured_at=reading.measured_at,
        lateral_unit=unit,
        caveats=(*reading.notes, *_size_caveats(height_map, unit=unit)),
    )


def read_height_map(
    path: Path | str, *, spacing_x: float | None = None, spacing_y: float | None = None, length_unit: str | None = None
) -> HeightMap:
    """Height map of a surface file.

    Parameters
    ----------
    path : Path or str
        The file, in any format of `read_surface_file`.
    spacing_x, spacing_y : float, optional
        Distance of neighbouring columns and rows, only for a file that does not state it, such as NPY. [m]
    length_unit : str, optional
        Unit of the lengths in a file that does not state it, such as "um".

    Returns
    -------
    HeightMap

    Raises
    ------
    InvalidInput
        As `read_surface_file`.

    See Also
    --------
    read_surface_file : the same with provenance.
    """
    return read_surface_file(path, spacing_x=spacing_x, spacing_y=spacing_y, length_unit=length_unit).height_map


def _lateral_unit(reading: SurfaceReading, length_unit: str | None, spacing_x: float | None) -> str:
    """Unit of lengths along the surface and how it is known."""
    if spacing_x is not None:
        return f"m, {GIVEN_BY_USER} as the distance of pixels"
    if length_unit is not None:
        return f"{length_unit}, {GIVEN_BY_USER}"
    return f"{reading.lateral_unit}, {reading.unit_origin}" if reading.states_unit else f"m, {ASSUMED_METRES}"


def _height_map(
    reading: SurfaceReading, path: Path, *, spacing_x: float | None, spacing_y: float | None, length_unit: str | None
) -> HeightMap:
    """Height map in metres, with the unit and spacings of the file or those given."""
    if reading.states_unit and length_unit is not None:
        raise InvalidInput(f"{path}: {reading.format_name} states its unit; leave length_unit out")
    if length_unit is None and not (reading.states_unit or reading.metres_by_default):
        raise InvalidInput(f"{path}: {reading.format_name} does not state its unit; {_UNIT_ADVICE}", key="length_unit")
    unit = convert(1.0, from_unit=length_unit, to_unit="m") if length_unit else 1.0
    try:
        step_x, step_y = _spacings(reading, unit, spacing_x=spacing_x, spacing_y=spacing_y)
        if max(step_x, step_y) > _LARGEST_SPACING:
            too_large = f"spacing must not exceed {_LARGEST_SPACING:g} m, got {max(step_x, step_y):g} m"
            raise InvalidInput(f"{too_large}; check its unit")
        with np.errstate(over="ignore"):  # the height map refuses infinite heights
            height = unit * reading.height
        return HeightMap(height=height, spacing_x=step_x, spacing_y=step_y)
    except InvalidInput as failure:
        raise InvalidInput(f"{path}: {failure}", key=failure.key) from None


def _spacings(
    reading: SurfaceReading, unit: float, *, spacing_x: float | None, spacing_y: float | None
) -> tuple[float, float]:
    """Spacings in metres, of the file or those given; refuse both and neither."""
    if reading.spacing_x is not None and reading.spacing_y is not None:
        if spacing_x is not None or spacing_y is not None:
            raise InvalidInput(f"{reading.format_name} states its spacing; leave spacing_x and spacing_y out")
        return unit * reading.spacing_x, unit * reading.spacing_y
    if spacing_x is None or spacing_y is None:
        raise InvalidInput(f"the distance of pixels is not in the file; {_SPACING_ADVICE}", key="spacing")
    return spacing_x, spacing_y
