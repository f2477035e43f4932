"""The numeric datasets of an HDF5 file, found and read within the limits of measured files.

A dataset states a shape, not what is stored: chunks that were never written read as fill values, compressed zeros take
a thousandth of their size, external storage is any other file. All of that is checked before a value is read.
"""

import math
import zlib
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import require_channels, require_values

_MAX_LINKS = 30_000  # names of groups and datasets in a file
_DEEPEST = 64  # groups within groups
_CHUNKS_OF_ANY_FILE = 100_000
_BYTES_PER_CHUNK = 16  # a stored chunk takes more in the index of its dataset
_TRUSTED_STORAGE = 1 << 18  # bytes; deflate unpacks them to 258 MiB at most
_LARGEST_ATTRIBUTE = 1 << 16  # bytes; HDF5 keeps no more beside an object
_DEFLATE = 1
_ONE_FILE = "a recording is read from one file: copy the data into it, as h5repack does"


def numeric_datasets(
    file: Any, path: Path, *, wanted: Callable[[str, Any], bool] = lambda label, dataset: True
) -> Iterator[tuple[str, Any]]:
    """Yield label and dataset of each wanted array of numbers in an HDF5 file, once each, in order of the labels.

    `label`: Names of the groups and of the dataset, divided by "/". `dataset`: Stored in this file; all of them
    together are within the limits of `sonolube.measurement.measured_files`.
    """
    values = channels = 0
    for label, dataset in _datasets(file, path):
        if dataset.dtype.kind not in "fiub" or dataset.size is None or not wanted(label, dataset):
            continue
        _require_own_storage(dataset, label, path)
        values, channels = values + dataset.size, channels + 1
        require_values(values, path, part=f"dataset {label!r}")
        require_channels(channels, path, kind="datasets")
        _require_bounded_chunks(dataset, label, path)
        yield label, dataset


def attributes_of(item: Any, names: Iterable[str], path: Path) -> dict[str, Any]:
    """Those attributes of an HDF5 object that it has among some names; refuse one that states to be large."""
    found = {}
    for name in names:
        if name in item.attrs:
            stated = item.attrs.get_id(name)
            if math.prod(stated.shape or ()) * stated.dtype.itemsize > _LARGEST_ATTRIBUTE:
                raise InvalidInput(f"{path}: attribute {name!r} of {item.name!r} states to hold more than a text may")
            found[name] = item.attrs[name]
    return found


def _datasets(file: Any, path: Path) -> Iterator[tuple[str, Any]]:
    """Yield label and dataset of all groups in order of their names, each object once, so that cycles of links end.

    Soft links lead to an object that has a name of its own in the file, or to none. Groups whose name begins with "#"
    are those in which MATLAB keeps the cells of cell arrays.
    """
    import h5py

    seen = {_address(file)}
    links = 0
    groups = [("", file, iter(file))]
    while groups:
        prefix, group, names = groups[-1]
        if (name := next(names, None)) is None:
            groups.pop()
            continue
        links += 1
        if links > _MAX_LINKS or len(groups) > _DEEPEST:
            raise InvalidInput(
                f"{path}: holds more than {_MAX_LINKS} objects, or groups more than {_DEEPEST} deep;"
                " save those that are needed in a file of their own"
            )
        link = group.get(name, getlink=True)
        if isinstance(link, h5py.ExternalLink):
            raise InvalidInput(f"{path}: {prefix + name!r} is a link to another file; {_ONE_FILE}")
        if isinstance(link, h5py.SoftLink) or name.startswith("#"):
            continue
        item = group[name]
        if (address := _address(item)) in seen:
            continue
        seen.add(address)
        if isinstance(item, h5py.Dataset):
            yield prefix + name, item
        elif isinstance(item, h5py.Group):
            groups.append((f"{prefix}{name}/", item, iter(item)))


def _address(item: Any) -> int:
    """Address of an object in its file."""
    import h5py

    return int(h5py.h5o.get_info(item.id).addr)


def _require_own_storage(dataset: Any, label: str, path: Path) -> None:
    """Refuse a dataset whose values lie in other files."""
    if dataset.is_virtual:
        raise InvalidInput(f"{path}: dataset {label!r} is virtual, made of other datasets; {_ONE_FILE}")
    if dataset.external:
        raise InvalidInput(f"{path}: dataset {label!r} has its values in another file; {_ONE_FILE}")


def _require_bounded_chunks(dataset: Any, label: str, path: Path) -> None:
    """Refuse chunks that are too large, too many, or unpack to more than they state."""
    if dataset.chunks is None:
        return
    part = f"dataset {label!r}"
    held = math.prod(dataset.chunks)
    require_values(held, path, part=f"{part}, one chunk")
    most_chunks = _CHUNKS_OF_ANY_FILE + path.stat().st_size // _BYTES_PER_CHUNK
    chunks = math.prod(-(-length // step) for length, step in zip(dataset.shape, dataset.chunks, strict=True))
    if chunks > most_chunks:
        raise InvalidInput(
            f"{path}: {part} states {chunks} chunks, more than fit into the file; save it without chunks"
        )
    settings = dataset.id.get_create_plist()
    filters = [settings.get_filter(index)[0] for index in range(settings.get_nfilters())]
    if len(set(filters)) < len(filters):
        raise InvalidInput(f"{path}: {part} is compressed twice over; save it with one filter of each kind")
    if _DEFLATE in filters and dataset.id.get_storage_size() > _TRUSTED_STORAGE:
        _require_true_chunks(dataset, part, path, most=2 * held * dataset.dtype.itemsize + 64)


def _require_true_chunks(dataset: Any, part: str, path: Path, *, most: int) -> None:
    """Refuse a deflated dataset of which a chunk unpacks to more than `most` bytes."""
    chunks: list[tuple[int, tuple[int, ...]]] = []
    dataset.id.chunk_iter(lambda chunk: chunks.append((chunk.size, chunk.chunk_offset)))
    for size, offset in chunks:
        if size > path.stat().st_size:
            raise InvalidInput(f"{path}: {part}: a chunk of {size} bytes does not fit into the file; it is damaged")
        _, stored = dataset.id.read_direct_chunk(offset)
        if _deflates_beyond(stored, most):
            raise InvalidInput(f"{path}: {part}: the chunk from value {offset[0]} unpacks to more than it states")


def _deflates_beyond(stored: bytes, most: int) -> bool:
    """Whether deflated bytes unpack to more than `most` bytes; False where they are not deflated."""
    try:
        return len(zlib.decompressobj().decompress(stored, most + 1)) > most
    except zlib.error:
        return False
