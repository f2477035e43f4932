"""Reading of surface files as height maps in metres with their provenance, in any format of `SURFACE_FORMATS`."""

import hashlib
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.file_format import detect_format, read_head, refuse_unreadable
from sonolube.measurement.surface_files.formats import SURFACE_FORMATS
from sonolube.measurement.surface_files.plausible_size import size_caveats
from sonolube.measurement.surface_files.surface_reading import ASSUMED_METRES, GIVEN_BY_USER, SurfaceReading
from sonolube.models.surfaces import HeightMap
from sonolube.storage.input_files import require_file
from sonolube.text.units import convert

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
    with refuse_unreadable(place), place.open("rb") as stream:
        digest = hashlib.file_digest(stream, "sha256").hexdigest()
        reading = file_format.read(stream, place)
    height_map = _height_map(reading, place, spacing_x=spacing_x, spacing_y=spacing_y, length_unit=length_unit)
    unit = _lateral_unit(reading, length_unit, spacing_x)
    sizes = size_caveats(
        height=height_map.height, spacing_x=height_map.spacing_x, spacing_y=height_map.spacing_y, unit=unit
    )
    return SurfaceFile(
        height_map=height_map,
        path=place,
        sha256=digest,
        format_name=reading.format_name,
        title=reading.title,
        instrument=reading.instrument,
        measured_at=reading.measured_at,
        lateral_unit=unit,
        caveats=(*reading.notes, *sizes),
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
        raise InvalidInput(f"{path}: {reading.format_name} does not state its unit; {_UNIT_ADVICE}")
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
        raise InvalidInput(f"{path}: {failure}") from None


def _spacings(
    reading: SurfaceReading, unit: float, *, spacing_x: float | None, spacing_y: float | None
) -> tuple[float, float]:
    """Spacings in metres, of the file or those given; refuse both and neither."""
    if reading.spacing_x is not None and reading.spacing_y is not None:
        if spacing_x is not None or spacing_y is not None:
            raise InvalidInput(f"{reading.format_name} states its spacing; leave spacing_x and spacing_y out")
        return unit * reading.spacing_x, unit * reading.spacing_y
    if spacing_x is None or spacing_y is None:
        raise InvalidInput(f"the distance of pixels is not in the file; {_SPACING_ADVICE}")
    return spacing_x, spacing_y
