"""All formats of the SurfaceTopography library, with the extra ``surfaces``.

Its allocations cannot be limited, so the sizes that a file states are checked before, and text readers are chosen by
the layout of the text.
"""

import codecs
import io
import math
import re
import warnings
import zipfile
import zlib
from collections.abc import Sequence
from contextlib import redirect_stdout
from datetime import datetime
from pathlib import Path
from typing import Any, BinaryIO, ClassVar, final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.extras import missing_package
from sonolube.measurement.hdf5_datasets import numeric_datasets
from sonolube.measurement.measured_files import (
    most_unpacked_bytes,
    require_channels,
    require_unpacked_bytes,
    require_values,
)
from sonolube.measurement.surface_files.reader import LIBRARY_DEFAULT, STATED_BY_FILE, SurfaceReading
from sonolube.measurement.surface_files.xyz import even_profile

_HDF5 = b"\x89HDF\r\n\x1a\n"
_HDF5_OFFSETS = (0, 512)  # that of MATLAB 7.3 is the second
_DEFLATED = (b"MATLAB 5", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1")  # files with zlib streams: MATLAB, and OLE as in MNT
_ZLIB_HEADER = re.compile(rb"\x78[\x01\x5e\x9c\xda]")
_LARGEST_XML = 1 << 22  # bytes; a parsed document takes thirty times as much, and heights have a part of their own


def require_stated_sizes(path: Path) -> None:
    """Refuse a file of which a container (ZIP, HDF5, zlib streams) states or unpacks to more than its size allows."""
    with path.open("rb") as stream:
        head = stream.read(_HDF5_OFFSETS[-1] + len(_HDF5))
    if any(head[at:].startswith(_HDF5) for at in _HDF5_OFFSETS):
        _require_bounded_hdf5(path)
    elif zipfile.is_zipfile(path):
        _require_bounded_zip(path)
    elif head.startswith(_DEFLATED):
        _require_bounded_zlib(path)


def _require_bounded_hdf5(path: Path) -> None:
    """Refuse links, shapes and chunks of HDF5 beyond the limits."""
    import h5py

    with h5py.File(path, "r") as file:
        for _ in numeric_datasets(file, path):
            pass


def _require_bounded_zip(path: Path) -> None:
    """Refuse an archive that unpacks to too much, or has too large an XML document or too many parts."""
    with zipfile.ZipFile(path) as archive:
        members = archive.infolist()
    require_channels(len(members), path, kind="parts")
    require_unpacked_bytes(sum(member.file_size for member in members), path)
    for member in members:
        if member.filename.lower().endswith(".xml") and member.file_size > _LARGEST_XML:
            raise InvalidInput(
                f"{path}: part {member.filename[:40]!r} is an XML document of {member.file_size} bytes, but at most"
                f" {_LARGEST_XML} are parsed; save the heights as binary data"
            )


def _require_bounded_zlib(path: Path) -> None:
    """Refuse a file whose zlib streams together unpack to too much."""
    content = path.read_bytes()
    most, unpacked = most_unpacked_bytes(path), 0
    for found in _ZLIB_HEADER.finditer(content):
        try:
            stream = zlib.decompressobj()
            unpacked += len(stream.decompress(memoryview(content)[found.start() :], most + 1 - unpacked))
        except zlib.error:
            continue
        require_unpacked_bytes(unpacked, path, part=f"byte {found.start()}")


_SMALL = 1 << 14  # bytes; whatever such a file holds, the readers end within seconds
_MAX_HEADER_LINES = 200  # that the reader of coordinates skips
_MAX_OTHER_LINES = 1000  # of headers between the blocks of a matrix file
_LONGEST_OTHER_LINE = 4096
_MAX_ROWS = 1_000_000  # of numbers, which the readers take 6 us each
_COORDINATES = (2, 3)  # columns
_SEPARATORS = str.maketrans(",;", "  ")
_MISSING = ("bad", "nan", "inf", "infinite")


def text_readers(path: Path) -> tuple[str, ...]:
    """Which text readers of SurfaceTopography may read a file: "xyz" (coordinates), "asc" (matrix), or neither.

    The reader of coordinates parses the whole file once for each header line that it may have, and the reader of a
    matrix searches thirty expressions in every line that is no row of numbers. On a long text that is no table they
    take hours.
    """
    if path.stat().st_size <= _SMALL:
        return ("xyz", "asc")
    content = path.read_bytes()
    encoding = "utf-16" if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) else "utf-8"
    text = content.decode(encoding, errors="replace")
    if "\0" in text:
        return ()
    lines = text.rstrip().split("\n")
    return () if text.count("\n") - len(lines) > _MAX_OTHER_LINES else _readers_of_lines(lines)


def _readers_of_lines(lines: list[str]) -> tuple[str, ...]:
    """Which readers may read some lines of text."""
    columns: set[int] = set()
    header_lines = other_lines = rows = 0
    for line in lines:
        words = line.translate(_SEPARATORS).split()
        if words and _is_row(words):
            columns.add(len(words))
            rows += 1
            continue
        header_lines += not columns
        other_lines += 1
        if other_lines > _MAX_OTHER_LINES or len(line) > _LONGEST_OTHER_LINE:
            return ()
    later_lines = other_lines - header_lines
    if rows > _MAX_ROWS:
        return ()
    is_table = len(columns) == 1 and columns <= set(_COORDINATES) and not later_lines
    return ("xyz", "asc") if is_table and header_lines <= _MAX_HEADER_LINES else ("asc",)


def _is_row(words: list[str]) -> bool:
    """Whether all words of a line are numbers or stand for a missing one."""
    try:
        for word in words:
            if word.lower() not in _MISSING:
                float(word)
    except ValueError:
        return False
    return True


_HEAD_OF_LIBRARY = 512  # bytes from which its readers tell their formats
_TEXTS = ("xyz", "asc")
_BY_SUFFIX = ("hgt", "nms")  # formats that any bytes of a suitable number are
_TITLE_KEYS = ("Title", "DataSetName", "object_name")

UNIT_BY_LIBRARY = frozenset(  # as of version 1.27.1
    (
        *("al3d", "frt", "lext", "metropro", "nms", "opd", "os3d", "plu", "plux"),
        *("ps", "qep", "sdf", "tmd", "vk", "x3p", "zmg", "zon"),
    )
)
"""Formats whose lateral unit is a constant of SurfaceTopography's reader; the others state it in the file or not."""

_MISREAD = {"nms": "its lateral unit is misread by SurfaceTopography, and the version OM_MS_2.0, read here, is not it"}


@final
class SurfaceTopographyFormats:
    """All formats of the SurfaceTopography library: SUR, X3P, SDF, PLU, VK, AL3D, GWY, OPDx, MetroPro and more.

    Notes
    -----
    The fallback: the readers of SurfaceTopography are tried in their order, without those whose signature the file does
    not have. HGT and NMS have none and need their suffix; readers of text are tried where the text is a table.

    References
    ----------
    .. [1] M. C. Röttger et al., Surf. Topogr.: Metrol. Prop. 10, 035032 (2022). doi:10.1088/2051-672X/ac860a
    """

    name: ClassVar[str] = "SurfaceTopography"
    suffixes: ClassVar[tuple[str, ...]] = ()

    def recognises(self, head: bytes, path: Path) -> bool:
        """True: the library detects its formats itself."""
        return True

    def read(self, stream: BinaryIO, path: Path) -> SurfaceReading:
        """Default channel of a file in any format of SurfaceTopography.

        Rows and columns as SurfaceTopography orders y and x. A profile becomes one row of square pixels, its heights
        interpolated at even steps where its positions are uneven.
        """
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of the library's dependencies, about missing optional parts
            try:
                from SurfaceTopography.IO import readers
            except ImportError:
                raise missing_package("surfaces", context=str(path)) from None
            format_name = ""
            try:
                require_stated_sizes(path)
                reader = _opened(readers, path)
                format_name = str(reader.name())
                return _reading(reader, path=path)
            except InvalidInput:
                raise
            except Exception as failure:  # its readers raise exceptions of any type
                raise InvalidInput(f"{path}: {_cause(failure, format_name)}") from None


def _opened(readers: Sequence[Any], path: Path) -> Any:
    """First reader of the library that can open the file."""
    from SurfaceTopography.IO import MagicMatch

    with path.open("rb") as stream:
        head = stream.read(_HEAD_OF_LIBRARY)
    possible = [reader for reader in readers if reader.can_read(head) != MagicMatch.NO]
    texts = text_readers(path) if {*_TEXTS} & {reader.format() for reader in possible} else ()
    for reader in possible:
        name = reader.format()
        if name in _BY_SUFFIX and path.suffix.lower() != f".{name}":
            continue
        if name in _TEXTS and name not in texts:
            continue
        try:
            with redirect_stdout(io.StringIO()):  # readers of others' files print what they find
                return reader(str(path))
        except Exception:  # of any type where the file has another format
            continue
    if not texts and b"\0" not in head:
        raise InvalidInput(
            f"{path}: is no surface file by its signature, and as text no table of heights, whose lines are x z, x y z"
            " or rows of a matrix, with few others before them"
        )
    raise InvalidInput(f"{path}: damaged, or of no format of SurfaceTopography")


def _cause(failure: Exception, format_name: str) -> str:
    """Why the library fails on a file: its own sentence, or what an exception of its code without one means."""
    said = " ".join(str(failure).split())
    if said and not isinstance(failure, (LookupError, TypeError, AttributeError, AssertionError, UnicodeError)):
        return f"SurfaceTopography cannot read it: {said[:200]}"
    kind = f"{format_name} file" if format_name else "file"
    return (
        f"a damaged {kind}, or a variant of it that SurfaceTopography does not read (its reader stops with"
        f" {type(failure).__name__})"
    )


def _reading(reader: Any, *, path: Path) -> SurfaceReading:
    """Default channel of an open reader of the library."""
    known_as = str(reader.format())
    if known_as in _MISREAD:
        raise InvalidInput(f"{path}: looks like {reader.name()}: {_MISREAD[known_as]}")
    if not reader.channels:
        raise InvalidInput(f"{path}: SurfaceTopography takes it for {reader.name()}, but finds no heights in it")
    channel = reader.default_channel
    require_values(math.prod(channel.nb_grid_pts), path, part=f"{channel.nb_grid_pts} points")
    states_unit, states_size = channel.unit is not None, channel.physical_sizes is not None
    assumed: dict[str, Any] = {} if states_unit else {"unit": "m"}
    if not states_size:
        assumed["physical_sizes"] = channel.nb_grid_pts
    topography = reader.topography(channel_index=channel.index, **assumed).to_unit("m")
    height, spacing_x, spacing_y, notes = _heights(topography)
    info = topography.info
    return SurfaceReading(
        height=height,
        format_name=str(reader.name()),
        spacing_x=spacing_x if states_size else None,
        spacing_y=spacing_y if states_size else None,
        states_unit=states_unit,
        lateral_unit=str(channel.unit).replace("µ", "u") if states_unit else "",
        unit_origin=(LIBRARY_DEFAULT if known_as in UNIT_BY_LIBRARY else STATED_BY_FILE) if states_unit else "",
        title=next((str(found) for key in _TITLE_KEYS if (found := info.get("raw_metadata", {}).get(key))), ""),
        instrument=_instrument(info.get("instrument", {})),
        measured_at=_measured_at(info.get("acquisition_time")),
        notes=notes,
    )


def _heights(topography: Any) -> tuple[Floats, float, float, tuple[str, ...]]:
    """Heights of a topography or line scan with the distances of its columns and rows."""
    by_column = np.ma.filled(np.ma.asarray(topography.heights(), dtype=np.float64), np.nan)
    if not topography.is_uniform:
        row, step, notes = even_profile(np.asarray(topography.positions(), dtype=np.float64), by_column)
        return row, step, step, notes
    steps = np.atleast_1d(topography.pixel_size)
    return np.atleast_2d(by_column.T), float(steps[0]), float(steps[-1]), ()


def _instrument(known: dict[str, Any]) -> str:
    """Vendor, name and serial number of the instrument, as far as they are stated."""
    return " ".join(str(known[key]) for key in ("vendor", "name", "serial") if known.get(key))


def _measured_at(stated: Any) -> datetime | None:
    """Date without time zone; None for text that is no date and for the epoch, which stands for none."""
    try:
        moment = stated if isinstance(stated, datetime) else datetime.fromisoformat(str(stated))
    except ValueError:
        return None
    return None if moment.year <= 1970 else moment.replace(tzinfo=None)
