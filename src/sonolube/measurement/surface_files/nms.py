"""NMS files of NanoFocus' usurf confocal microscopes."""

import math
import struct
from datetime import datetime
from pathlib import Path
from typing import BinaryIO, ClassVar, final

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.surface_reading import FIXED_BY_FORMAT, SurfaceReading
from sonolube.measurement.surface_files.wyko import terminated_text

_SIGNATURE = b"OM_MS_2.0"
_SIGNATURE_AT = 32
_HEADER_SIZE = 3468
_SCALE = struct.Struct("<4i2d")  # type, dimension, lowest and highest number, and the heights of both in um
_TYPE_SHORT = 2
_GRID_AT, _GRID = 1368, struct.Struct("<2I2d")  # columns, rows, distance of both in nm
_INTENSITY_AT = 1416  # int32: whether intensities follow the heights
_TITLE_AT, _TIME_AT = 52, 1076
_TEXT_LENGTH = 64


@final
class NanoFocusNms:
    """NMS files of NanoFocus' usurf confocal microscopes.

    The header has 3468 little-endian bytes. The spacing at byte 1376 is in nanometres: in two files of 512 x 512
    pixels (SurfaceTopography's examples nms-1 and nms-2, both of a field of 160 um) it reads 312.49999,
    musurf-reader [1]_ and surfalize [2]_ divide it by 1000 to have micrometres, and as the millimetres for which
    SurfaceTopography 1.27.1 takes it (``IO/NMS.py``, ``dx_mm``, then times 1000 to micrometres) the field would be
    160 m. That library also scales heights by the 65534 of an older convention instead of the range at bytes 8 and
    12, and takes nms-2 for a MATLAB file; so this format is read here.

    References
    ----------
    .. [1] D. Mendroch, musurf-reader, https://github.com/drocheam/musurf-reader
    .. [2] F. Schell, surfalize, https://github.com/fredericjs/surfalize
    """

    name: ClassVar[str] = "NanoFocus NMS"
    suffixes: ClassVar[tuple[str, ...]] = (".nms",)

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the header carries the version's signature."""
        return head[_SIGNATURE_AT:].startswith(_SIGNATURE)

    def read(self, stream: BinaryIO, path: Path) -> SurfaceReading:
        """Heights of an NMS file.

        Pixels of zero intensity were not measured.
        """
        size = stream.seek(0, 2)
        stream.seek(0)
        header = stream.read(_HEADER_SIZE)
        if not self.recognises(header, path):
            raise InvalidInput(f"{path}: byte {_SIGNATURE_AT}: not an NMS file of version OM_MS_2.0, the one known")
        if len(header) < _HEADER_SIZE:
            raise InvalidInput(f"{path}: byte {size}: the file ends within the header of {_HEADER_SIZE} bytes")
        kind, _, lowest, highest, bottom, top = _SCALE.unpack_from(header)
        if kind != _TYPE_SHORT:
            raise InvalidInput(f"{path}: byte 0: heights of type {kind}; only {_TYPE_SHORT}, of two bytes, is known")
        if not (highest > lowest and math.isfinite(bottom) and bottom < top < math.inf):
            raise InvalidInput(f"{path}: byte 8: numbers {lowest} to {highest} stand for {bottom:g} um to {top:g} um")
        columns, rows, step_x, step_y = _GRID.unpack_from(header, _GRID_AT)
        if not (0 < step_x < math.inf and 0 < step_y < math.inf):
            raise InvalidInput(f"{path}: byte {_GRID_AT + 8}: distances of pixels of {step_x:g} nm and {step_y:g} nm")
        pixels = columns * rows
        has_intensity = struct.unpack_from("<i", header, _INTENSITY_AT)[0] > 0
        needed = _HEADER_SIZE + pixels * (3 if has_intensity else 2)
        if not _HEADER_SIZE < needed <= size:
            raise InvalidInput(f"{path}: byte {size}: {columns} x {rows} pixels should end at byte {needed}")
        numbers = np.frombuffer(stream.read(2 * pixels), dtype="<u2").astype(np.float64)
        with np.errstate(over="ignore"):
            height = 1e-6 * (bottom + (top - bottom) * ((numbers - lowest) / (float(highest) - lowest)))
        if has_intensity:
            height[np.frombuffer(stream.read(pixels), dtype=np.uint8) == 0] = np.nan
        return SurfaceReading(
            height=height.reshape(rows, columns),
            format_name=self.name,
            spacing_x=1e-9 * step_x,
            spacing_y=1e-9 * step_y,
            lateral_unit="nm",
            unit_origin=FIXED_BY_FORMAT,
            title=terminated_text(header[_TITLE_AT : _TITLE_AT + _TEXT_LENGTH]),
            measured_at=_measured_at(terminated_text(header[_TIME_AT : _TIME_AT + _TEXT_LENGTH])),
        )


def _measured_at(text: str) -> datetime | None:
    """Time of the measurement; None for other text."""
    try:
        return datetime.fromisoformat(text).replace(tzinfo=None)
    except ValueError:
        return None
