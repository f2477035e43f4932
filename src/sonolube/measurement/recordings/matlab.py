"""MATLAB files: versions 4 to 7 by their own elements, version 7.3, which is HDF5, through h5py.

A file of version 4 to 7 is a sequence of variables, each with its class, dimensions and name before its values. Only
variables that are vectors of numbers, or structures with one element that have such fields, are read or uncompressed at
all; the bytes and values that they state are checked first.
"""

import math
import struct
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.hdf5_datasets import attributes_of, numeric_datasets
from sonolube.measurement.measured_files import (
    ClippedReader,
    most_unpacked_bytes,
    require_channels,
    require_unpacked_bytes,
    require_values,
)
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable, refuse_library_errors

_HEADER = 128  # bytes before the variables of version 5
_HEAD = 4096  # bytes of a variable in which its class, dimensions and name stand
_MATRIX, _COMPRESSED = 14, 15  # types of elements
_NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_STRUCTURES = (2, 3)  # classes: structure and object
_NUMERIC_CLASSES = range(6, 16)
_COMPLEX = 0x0800
_VERSION_4_HEADER = 20
_VERSION_4_NUMBERS = ("f8", "f4", "i4", "i2", "u2", "u1")

_Bytes = bytes | memoryview


class MatlabArray(NamedTuple):
    """A numeric array of a file: its name, with its structure's before a point, and its values in one row."""

    name: str
    values: Floats


class _Variable(NamedTuple):
    """Class, dimensions and name of a variable, and where in its bytes the values begin."""

    kind: int
    is_complex: bool
    shape: tuple[int, ...]
    name: str
    at: int

    @property
    def size(self) -> int:
        return math.prod(self.shape)

    @property
    def is_vector(self) -> bool:
        """Whether it is a row, a column or a single number, and real."""
        return self.kind in _NUMERIC_CLASSES and not self.is_complex and 0 < self.size == max(self.shape)

    @property
    def is_structure(self) -> bool:
        return self.kind in _STRUCTURES and self.size == 1


def matlab_arrays(path: Path) -> Iterator[MatlabArray]:
    """Yield the real vectors and numbers of a MATLAB file of version 4 to 7, and those in its structures."""
    with ClippedReader(path) as stream:
        head = stream.read(_HEADER)
        is_version_4 = 0 in head[:4]
        yield from _version_4(stream, path) if is_version_4 else _version_5(stream, head, path)


def _version_5(stream: ClippedReader, head: bytes, path: Path) -> Iterator[MatlabArray]:
    """Yield the arrays of a file of version 5 to 7."""
    if head[126:128] not in (b"IM", b"MI"):
        raise InvalidInput(f"{path}: byte 126: cannot be read as MATLAB: states no byte order, IM or MI")
    order = "<" if head[126:128] == b"IM" else ">"
    end, at, unpacked = path.stat().st_size, _HEADER, 0
    while at + 8 <= end:
        stream.seek(at)
        kind, length = struct.unpack(order + "II", stream.read(8))
        at += 8
        if at + length > end:
            raise InvalidInput(f"{path}: byte {at - 8}: a variable of {length} bytes ends beyond the file")
        if kind in (_MATRIX, _COMPRESSED) and length:
            content = _wanted_content(stream, length, order, path, is_compressed=kind == _COMPRESSED, before=unpacked)
            unpacked += len(content)
            yield from _arrays(content, order, path)
        at += length


def _wanted_content(
    stream: ClippedReader, length: int, order: str, path: Path, *, is_compressed: bool, before: int
) -> _Bytes:
    """Bytes of a variable without its tag where it is of a kind that is read, else none."""
    stored = stream.read(min(length, _HEAD))
    head = zlib.decompressobj().decompress(stored, _HEAD)[8:] if is_compressed else stored
    variable = _variable(head, order)
    if not variable.name or not (variable.is_vector or variable.is_structure):  # the workspace of functions has no name
        return b""
    stored += stream.read(length - len(stored))
    if not is_compressed:
        return stored
    content = zlib.decompressobj().decompress(stored, most_unpacked_bytes(path) + 1)
    require_unpacked_bytes(before + len(content), path, part=f"variable {variable.name!r}")
    return memoryview(content)[8:]


def _arrays(content: _Bytes, order: str, path: Path) -> Iterator[MatlabArray]:
    """Yield the vector in the bytes of a variable, or those in its fields."""
    if not content:
        return
    variable = _variable(content, order)
    if variable.is_vector:
        yield MatlabArray(variable.name, _numbers(content, variable, order, path))
        return
    at = variable.at
    if variable.kind == 3:  # an object has the name of its class before its fields
        _, _, at = _element(content, at, order)
    _, width, at = _element(content, at, order)
    _, names, at = _element(content, at, order)
    (step,) = struct.unpack(order + "i", width[:4])
    if step < 1:
        raise InvalidInput(f"{path}: structure {variable.name!r} has names of {step} characters; it is damaged")
    for start in range(0, len(names), step):
        _, field, at = _element(content, at, order)
        if not len(field):
            continue
        inner = _variable(field, order)
        if inner.is_vector:
            name = f"{variable.name}.{_text(names[start : start + step])}"
            yield MatlabArray(name, _numbers(field, inner._replace(name=name), order, path))


def _variable(content: _Bytes, order: str) -> _Variable:
    """Header of a variable, before its values."""
    _, flags, at = _element(content, 0, order)
    _, dimensions, at = _element(content, at, order)
    _, name, at = _element(content, at, order)
    (word,) = struct.unpack(order + "I", flags[:4])
    shape = struct.unpack(f"{order}{len(dimensions) // 4}i", dimensions)
    is_absurd = any(length < 0 for length in shape) or not shape
    return _Variable(word & 0xFF, bool(word & _COMPLEX), (0,) if is_absurd else shape, _text(name), at)


def _element(content: _Bytes, at: int, order: str) -> tuple[int, _Bytes, int]:
    """Type and bytes of the element at a byte, and where the next one begins."""
    kind, length = struct.unpack_from(order + "II", content, at)
    if kind >> 16:  # up to four bytes are stored within the tag
        return kind & 0xFFFF, content[at + 4 : at + 4 + min(kind >> 16, 4)], at + 8
    return kind, content[at + 8 : at + 8 + length], at + 8 + -(-length // 8) * 8


def _numbers(content: _Bytes, variable: _Variable, order: str, path: Path) -> Floats:
    """Values of a vector."""
    kind, stored, _ = _element(content, variable.at, order)
    if kind not in _NUMBERS:
        raise InvalidInput(f"{path}: {variable.name!r} has values of type {kind}, which is none of numbers")
    return _as_floats(stored, np.dtype(order + _NUMBERS[kind]), variable.size, variable.name, path)


def _version_4(stream: ClippedReader, path: Path) -> Iterator[MatlabArray]:
    """Yield the arrays of a file of version 4."""
    end, at = path.stat().st_size, 0
    while at + _VERSION_4_HEADER <= end:
        stream.seek(at)
        head = stream.read(_VERSION_4_HEADER)
        order = "<" if 0 <= struct.unpack("<i", head[:4])[0] <= 5000 else ">"
        code, rows, columns, has_imaginary, name_length = struct.unpack(order + "5i", head)
        precision, kind = code // 10 % 10, code % 10
        if not (0 <= code <= 5000 and min(rows, columns) >= 0 < name_length) or precision >= len(_VERSION_4_NUMBERS):
            raise InvalidInput(f"{path}: byte {at}: no variable of a MATLAB file of version 4 begins here")
        dtype = np.dtype(order + _VERSION_4_NUMBERS[precision])
        size = rows * columns * dtype.itemsize
        values_at = at + _VERSION_4_HEADER + name_length
        at = values_at + size * (2 if has_imaginary else 1)
        if at > end:
            raise InvalidInput(f"{path}: byte {values_at}: a variable of {rows} x {columns} values exceeds the file")
        if kind == 0 and not has_imaginary and 1 in (rows, columns):
            name = _text(stream.read(name_length))
            yield MatlabArray(name, _as_floats(stream.read(size), dtype, rows * columns, name, path))


def _as_floats(stored: _Bytes, dtype: "np.dtype[np.generic]", size: int, name: str, path: Path) -> Floats:
    """Stored numbers as doubles; refuse another number of them than is stated."""
    if len(stored) != size * dtype.itemsize:
        held = len(stored) // dtype.itemsize
        raise InvalidInput(f"{path}: {name!r} states {size} values and holds {held}; the file is cut or damaged")
    values: NDArray[np.generic] = np.frombuffer(stored, dtype=dtype)
    return values.astype(np.float64)


def _text(stored: _Bytes) -> str:
    """Name, without the null characters that fill it up."""
    return bytes(stored).split(b"\0", 1)[0].decode("latin-1")


_SIGNATURE = b"MATLAB "
_RATE_NAMES = ("sample_rate", "sampling_rate", "fs", "Fs")


@final
class Matlab:
    """MATLAB files of version 4 to 7.3 whose numeric vectors are channels.

    Notes
    -----
    Version 4 has no signature and is detected by its suffix.
    """

    name: ClassVar[str] = "MATLAB"
    suffixes: ClassVar[tuple[str, ...]] = (".mat",)

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the file begins with the signature of versions 5 to 7.3."""
        return head.startswith(_SIGNATURE)

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        """Vectors of a MATLAB file; those inside structures are labelled `structure.field`.

        A scalar called `sample_rate`, `sampling_rate` or `fs` gives the sample interval, in Hz.
        """
        with refuse_library_errors(path, format_name=self.name):
            with path.open("rb") as stream:
                is_hdf5 = b"MATLAB 7.3" in stream.read(128)
            arrays, repeated = _within_limits(_arrays_of_version_7_3(path) if is_hdf5 else matlab_arrays(path), path)
        rates = [float(arrays[name][0]) for name in _RATE_NAMES if name in arrays and arrays[name].size == 1]
        interval = 1 / rates[0] if rates and rates[0] > 0 else None
        columns = tuple(
            RawColumn(label=name, values=array, interval=interval, start=0.0)
            for name, array in arrays.items()
            if array.size > 1
        )
        if not columns:
            raise InvalidInput(f"{path}: holds no vector of numbers")
        caveats = tuple(f"variable {name} is stored more than once; the last is read" for name in repeated)
        return RawTable(columns=columns, format_name=self.name, caveats=caveats)


def _within_limits(arrays: Iterable[MatlabArray], path: Path) -> tuple[dict[str, Floats], tuple[str, ...]]:
    """Arrays by name, the last of each name, and names of several; refuse more than a file may hold."""
    found: dict[str, Floats] = {}
    repeated: dict[str, None] = {}
    values = 0
    for name, array in arrays:
        values += array.size
        require_values(values, path, part=f"variable {name!r}")
        if array.size > 1 or name in _RATE_NAMES:
            if name in found:
                repeated[name] = None
            found[name] = array
            require_channels(len(found), path, kind="vectors")
    return found, tuple(repeated)


def _arrays_of_version_7_3(path: Path) -> Iterator[MatlabArray]:
    """Yield the numeric vectors of a file of version 7.3, and those of its structures."""
    import h5py

    with h5py.File(path, "r") as file:
        for label, dataset in numeric_datasets(file, path, wanted=_is_vector):
            yield MatlabArray(label.replace("/", "."), np.asarray(dataset[()]).ravel().astype(np.float64, copy=False))


def _is_vector(label: str, dataset: Any) -> bool:
    """Whether a dataset is a vector or a number of MATLAB, neither text nor an empty array."""
    kind = attributes_of(dataset, ("MATLAB_class", "MATLAB_empty"), Path(dataset.file.filename))
    is_number = kind.get("MATLAB_class") != b"char" and not kind.get("MATLAB_empty", 0)
    return is_number and max(dataset.shape, default=1) == dataset.size
