"""Sizes that a surface file states, checked before a library reads it whose allocations cannot be limited."""

import re
import zipfile
import zlib
from pathlib import Path

from sonolube.errors import InvalidInput
from sonolube.measurement.hdf5_datasets import numeric_datasets
from sonolube.measurement.limits import most_unpacked_bytes, require_channels, require_unpacked_bytes

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
