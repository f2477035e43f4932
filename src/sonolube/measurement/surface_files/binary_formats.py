"""Binary files of surfaces that are read here: Wyko OPD, NanoFocus NMS, and NPY of numpy."""

import math
import struct
import warnings
from datetime import datetime
from pathlib import Path
from typing import BinaryIO, ClassVar, NamedTuple, final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.reader import FIXED_BY_FORMAT, SurfaceReading

_SIGNATURE = b"Directory"  # at byte 2

_ENTRY = struct.Struct("<16shiH")  # name, type, length, attribute
_ARRAY_HEADER = struct.Struct("<HHH")  # columns, rows, bytes an element
_ARRAY, _TEXT, _SHORT, _FLOAT, _DOUBLE, _STRING, _LONG = 3, 5, 6, 7, 8, 15, 12
_HEIGHT_BLOCKS = ("RAW_DATA", "RAW DATA", "Raw", "OPD", "SAMPLE_DATA")
_ELEMENTS = {1: "u1", 2: "<i2", 4: "<f4"}
_INVALID_FROM = {1: math.inf, 2: 32766, 4: float(np.float32(1e38))}  # by bytes per element: this and above is no data
_LONGEST_DIRECTORY = 1 << 20
_LONGEST_TEXT = 256
_STRING_MARK = b"\x12\x01"  # before the length and the characters of a short serialized string
_DATES = ("%m/%d/%Y %H:%M:%S", "%m/%d/%y %H:%M:%S", "%m/%d/%Y %I:%M:%S %p", "%m/%d/%y %I:%M:%S %p")


class _Block(NamedTuple):
    """One block of the file: name, type, offset and length in bytes."""

    name: str
    kind: int
    offset: int
    length: int


@final
class WykoOpd:
    """Wyko OPD files of Veeco's and Bruker's Vision software, in all its dialects.

    The file is little-endian: two bytes, a directory of entries of 24 bytes (name, type, length, attribute), the
    first of which describes the directory itself, and then the blocks one after the other in the directory's order.
    Dialects differ in which blocks they have and in the type they declare for a block, so a number is read by its
    length. Every size that the file states is checked against the size it has.
    """

    name: ClassVar[str] = "Wyko OPD"
    suffixes: ClassVar[tuple[str, ...]] = (".opd",)

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the directory begins at byte 2."""
        return head[2:].startswith(_SIGNATURE)

    def read(self, stream: BinaryIO, path: Path) -> SurfaceReading:
        r"""Heights of a Wyko OPD file.

        Its first row is the top of the picture as Vision shows it. Of several height arrays the first is read.

        Heights are stored in waves: with the wavelength in nm and the multiplier m of integer arrays,

        .. math:: z = 10^{-9} \frac{\lambda}{m}\, w .

        Pixels at or above 1e38, in integer arrays 32766, were not measured. The pixel size in mm is that of columns;
        rows are the aspect ratio times as far apart.
        """
        blocks = _directory(stream, path)
        wavelength = _number(stream, blocks, "Wavelength", path)
        if wavelength is None:
            raise InvalidInput(f"{path}: no block 'Wavelength' in the directory, so heights have no scale")
        multiplier = _number(stream, blocks, "Mult", path) or 1.0
        pixel_size = _number(stream, blocks, "Pixel_size", path)
        aspect = _number(stream, blocks, "Aspect", path) or 1.0
        waves = _waves(stream, blocks, path)
        with np.errstate(over="ignore", under="ignore"):
            height = waves * (1e-9 * wavelength / multiplier)
        if np.isinf(height).any():
            raise InvalidInput(f"{path}: wavelength {wavelength:g} nm over {multiplier:g} makes heights infinite")
        return SurfaceReading(
            height=height,
            format_name=self.name,
            spacing_x=None if pixel_size is None else 1e-3 * pixel_size,
            spacing_y=None if pixel_size is None else 1e-3 * pixel_size * aspect,
            lateral_unit="mm",
            unit_origin=FIXED_BY_FORMAT,
            title=_text(stream, blocks, "Title", path) or _text(stream, blocks, "DataSetName", path),
            measured_at=_measured_at(_text(stream, blocks, "Date", path) + " " + _text(stream, blocks, "Time", path)),
        )


def _directory(stream: BinaryIO, path: Path) -> dict[str, _Block]:
    """Blocks of the file by name, the first of each name."""
    size = stream.seek(0, 2)
    if size == 0:
        raise InvalidInput(f"{path}: byte 0: the file is empty")
    title, _, length, _ = _ENTRY.unpack(_bytes(stream, 2, _ENTRY.size, path, "the directory"))
    if terminated_text(title) != _SIGNATURE.decode():
        raise InvalidInput(f"{path}: byte 2: not a Wyko OPD file, which has 'Directory' here")
    if not _ENTRY.size <= length <= _LONGEST_DIRECTORY or length % _ENTRY.size:
        raise InvalidInput(f"{path}: byte 20: a directory of {length} bytes has no whole entries of {_ENTRY.size}")
    entries = _bytes(stream, 2, length, path, "the directory")
    blocks: dict[str, _Block] = {}
    offset = 2 + length
    for index, (raw_name, kind, block_length, _) in enumerate(_ENTRY.iter_unpack(entries)):
        if index == 0 or block_length <= 0:  # unused entries
            continue
        if offset + block_length > size:
            raise InvalidInput(
                f"{path}: byte {2 + _ENTRY.size * index}: block {terminated_text(raw_name)!r} should end at byte"
                f" {offset + block_length}, but the file ends at {size}; it is truncated or damaged"
            )
        blocks.setdefault(terminated_text(raw_name), _Block(terminated_text(raw_name), kind, offset, block_length))
        offset += block_length
    return blocks


def _waves(stream: BinaryIO, blocks: dict[str, _Block], path: Path) -> Floats:
    """First height array in waves, top row first, NaN where it was not measured."""
    found = next((block for block in blocks.values() if block.name in _HEIGHT_BLOCKS and block.kind == _ARRAY), None)
    if found is None:
        raise InvalidInput(f"{path}: no array of heights in the directory; looked for {', '.join(_HEIGHT_BLOCKS)}")
    header = _bytes(stream, found.offset, _ARRAY_HEADER.size, path, f"array {found.name!r}")
    columns, rows, element = _ARRAY_HEADER.unpack(header)
    if element not in _ELEMENTS:
        raise InvalidInput(f"{path}: byte {found.offset + 4}: elements of {element} bytes; 1, 2 and 4 are known")
    needed = columns * rows * element
    if not 0 < needed <= found.length - _ARRAY_HEADER.size:
        raise InvalidInput(
            f"{path}: byte {found.offset}: {columns} x {rows} elements of {element} bytes do not fit"
            f" into a block of {found.length} bytes"
        )
    content = _bytes(stream, found.offset + _ARRAY_HEADER.size, needed, path, f"array {found.name!r}")
    by_column = np.frombuffer(content, dtype=np.dtype(_ELEMENTS[element])).reshape(columns, rows)
    with np.errstate(invalid="ignore"):
        waves: Floats = by_column[:, ::-1].T.astype(np.float64)  # columns one after the other, each from the bottom up
        waves[~(np.abs(waves) < _INVALID_FROM[element]) if element == 4 else waves >= _INVALID_FROM[element]] = np.nan
    if np.isnan(waves).all():
        raise InvalidInput(f"{path}: byte {found.offset}: none of the {waves.size} pixels was measured")
    return waves


def _number(stream: BinaryIO, blocks: dict[str, _Block], block_name: str, path: Path) -> float | None:
    """Positive number in a block; None where there is no such block."""
    block = blocks.get(block_name)
    if block is None:
        return None
    _, kind, at, length = block
    layout = {
        (_SHORT, 2): "<h",
        (_SHORT, 4): "<i",
        (_FLOAT, 2): "<h",  # some dialects declare their short multiplier a float
        (_FLOAT, 4): "<f",
        (_DOUBLE, 8): "<d",
        (_LONG, 4): "<i",
    }.get((kind, length))
    if layout is None:
        raise InvalidInput(f"{path}: byte {at}: block {block_name!r} of type {kind} and {length} bytes is no number")
    value = float(struct.unpack(layout, _bytes(stream, at, length, path, f"block {block_name!r}"))[0])
    if not (math.isfinite(value) and value > 0):
        raise InvalidInput(f"{path}: byte {at}: {block_name} must be positive and finite, got {value!r}")
    return value


def _text(stream: BinaryIO, blocks: dict[str, _Block], block_name: str, path: Path) -> str:
    """Text in a block; empty where there is no such block or it holds no text."""
    block = blocks.get(block_name)
    if block is None or block.kind not in (_TEXT, _STRING):
        return ""
    content = _bytes(stream, block.offset, min(block.length, _LONGEST_TEXT), path, f"block {block_name!r}")
    if block.kind == _STRING:
        if len(content) < 3 or not content.startswith(_STRING_MARK):
            return ""
        content = content[3 : 3 + content[2]]
    return terminated_text(content)


def _measured_at(text: str) -> datetime | None:
    """Date and time in any of the spellings of Vision; None for other text."""
    for form in _DATES:
        try:
            return datetime.strptime(text.strip(), form)
        except ValueError:
            continue
    return None


def terminated_text(content: bytes) -> str:
    """Text of a binary file up to its first null byte."""
    return content.split(b"\0", 1)[0].decode("latin-1").strip()


def _bytes(stream: BinaryIO, offset: int, length: int, path: Path, part: str) -> bytes:
    """Some bytes of the file; refuse a file that ends within them."""
    stream.seek(offset)
    content = stream.read(length)
    if len(content) < length:
        raise InvalidInput(f"{path}: byte {offset + len(content)}: the file ends within {part}")
    return content


_NMS_SIGNATURE = b"OM_MS_2.0"
_NMS_SIGNATURE_AT = 32
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
        return head[_NMS_SIGNATURE_AT:].startswith(_NMS_SIGNATURE)

    def read(self, stream: BinaryIO, path: Path) -> SurfaceReading:
        """Heights of an NMS file.

        Pixels of zero intensity were not measured.
        """
        size = stream.seek(0, 2)
        stream.seek(0)
        header = stream.read(_HEADER_SIZE)
        if not self.recognises(header, path):
            raise InvalidInput(f"{path}: byte {_NMS_SIGNATURE_AT}: not an NMS file of version OM_MS_2.0, the one known")
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
            measured_at=_nms_time(terminated_text(header[_TIME_AT : _TIME_AT + _TEXT_LENGTH])),
        )


def _nms_time(text: str) -> datetime | None:
    """Time of the measurement; None for other text."""
    try:
        return datetime.fromisoformat(text).replace(tzinfo=None)
    except ValueError:
        return None


_NPY_SIGNATURE = b"\x93NUMPY"


@final
class Npy:
    """NPY files of numpy that hold a matrix of heights, in metres unless a unit is given."""

    name: ClassVar[str] = "NPY"
    suffixes: ClassVar[tuple[str, ...]] = (".npy",)

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the file begins with the signature of NPY."""
        return head.startswith(_NPY_SIGNATURE)

    def read(self, stream: BinaryIO, path: Path) -> SurfaceReading:
        """Heights of an NPY file.

        Without spacing and unit, which the format does not hold.
        """
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # about headers of old versions
                mapped = np.lib.format.open_memmap(path, mode="r")  # np.load leaves archives under this name open
                is_matrix = mapped.ndim == 2 and mapped.dtype.kind in "fiu"
                height = np.array(mapped, dtype=np.float64) if is_matrix else None
        except Exception as failure:  # numpy evaluates the header, which raises exceptions of any type
            raise InvalidInput(f"{path}: not a whole NPY file: {' '.join(str(failure).split())[:200]}") from None
        if height is None:
            raise InvalidInput(f"{path}: heights are a matrix of numbers, got shape {mapped.shape} of {mapped.dtype}")
        return SurfaceReading(height=height, format_name=self.name, states_unit=False, metres_by_default=True)
