"""Labelled dataset of a sweep, in memory or in a netCDF file, and the store of its finished chunks in a folder."""

import hashlib
import io
import json
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from sonolube import __version__
from sonolube.design.sweep_plan import SweepPlan
from sonolube.errors import InvalidInput
from sonolube.operating_system import remove_file
from sonolube.rig import NUMBERS, STATUSES, PointBatch, amplitude_labels, operating_caveats
from sonolube.rig.datasets import labels
from sonolube.storage.files import clear_unfinished, locked_folder, unfinished_file, write_atomically
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

_MEANINGS = {"reason": "Index of the reason in reason_text", "reason_text": "Reason of a status, and remedy"}
_CODES: dict[str, type[np.signedinteger[Any]]] = {"status": np.int8, "reason": np.int16}


class FurtherColumns(Protocol):
    """Columns of a sweep beside the numbers of its points."""

    @property
    def labels(self) -> Mapping[str, Mapping[str, Any]]:
        """Attributes by the names of the columns; those with `flag_values` are codes of their type."""

    def of(self, rows: Mapping[str, NDArray[Any]], batch: PointBatch) -> Mapping[str, NDArray[Any]]:
        """Columns of some points with the values of the swept keys."""


def _kinds(further: FurtherColumns | None) -> dict[str, Any]:
    """Type of each further column."""
    if further is None:
        return {}
    return {
        name: attrs["flag_values"].dtype if "flag_values" in attrs else np.float64
        for name, attrs in further.labels.items()
    }


class _ReasonTable:
    """Distinct reasons of all chunks, each with its integer code."""

    def __init__(self) -> None:
        self.code_of: dict[str, int] = {}

    def codes(self, batch: PointBatch) -> NDArray[np.int16]:
        """Codes of the reasons of a batch, of which new ones are added to the table."""
        codes = [self.code_of.setdefault(text, len(self.code_of)) for text in batch.reasons]
        return np.array(codes, dtype=np.int16)[batch.reason]


class MemoryDatasetWriter:
    """Writer of a sweep's chunks to a dataset in memory.

    Parameters
    ----------
    plan : SweepPlan
    further : FurtherColumns, optional

    See Also
    --------
    NetCDFDatasetWriter
    """

    def __init__(self, plan: SweepPlan, further: FurtherColumns | None = None) -> None:
        self._plan, self._further, self._reasons = plan, further, _ReasonTable()
        self._columns: dict[str, NDArray[Any]] = {name: np.empty(plan.points) for name in NUMBERS}
        kinds = _CODES | _kinds(further)
        self._columns |= {name: np.empty(plan.points, dtype=kind) for name, kind in kinds.items()}

    def write(self, start: int, batch: PointBatch) -> None:
        """Write a chunk from a flat index on."""
        chunk = slice(start, start + batch.status.size)
        for name in NUMBERS:
            self._columns[name][chunk] = batch.numbers[name]
        self._columns["status"][chunk] = batch.status
        self._columns["reason"][chunk] = self._reasons.codes(batch)
        for name, column in _further_columns(self._further, self._plan, start, batch).items():
            self._columns[name][chunk] = column

    def dataset(self) -> "xr.Dataset":
        """Dataset of all chunks."""
        import xarray as xr

        shape = self._plan.shape
        variables: dict[str, Any] = {
            name: (_dimensions(self._plan), array.reshape(shape), _labels(name, self._further))
            for name, array in self._columns.items()
        }
        texts = np.array(list(self._reasons.code_of), dtype=np.str_)
        variables["reason_text"] = ("reasons", texts, _labels("reason_text"))
        return xr.Dataset(variables, coords=_coordinates(self._plan), attrs=_attributes(self._plan))


class NetCDFDatasetWriter:
    """Writer of a sweep's chunks to a netCDF file, which is renamed to sweep.nc once it is complete.

    Parameters
    ----------
    plan : SweepPlan
    folder : Path
        Folder of the file.
    further : FurtherColumns, optional

    See Also
    --------
    MemoryDatasetWriter
    """

    def __init__(self, plan: SweepPlan, folder: Path, further: FurtherColumns | None = None) -> None:
        self._plan, self._path, self._reasons = plan, folder / "sweep.nc", _ReasonTable()
        self._further = further

    def __enter__(self) -> Self:
        import h5netcdf

        with ExitStack() as stack:
            self._unfinished = stack.enter_context(unfinished_file(self._path))
            self._file: Any = stack.enter_context(h5netcdf.File(self._unfinished, "w"))
            self._define_variables()
            self._open = stack.pop_all()
        return self

    def __exit__(self, kind: type | None, value: BaseException | None, trace: TracebackType | None) -> None:
        try:
            self._open.close()
        finally:
            self._unfinished.check()  # tells more than what HDF5 makes of it

    def _define_variables(self) -> None:
        """Write the coordinates, and define the variables of the points."""
        self._file.dimensions = dict(zip(_dimensions(self._plan), self._plan.shape, strict=True))
        self._file.attrs.update(_attributes(self._plan))
        for name, (dimension, array, attributes) in _coordinates(self._plan).items():
            self._write_variable(name, (dimension,), array, attributes)
        kinds: dict[str, Any] = dict.fromkeys(NUMBERS, np.float64) | _CODES | _kinds(self._further)
        for name, kind in kinds.items():
            variable = self._file.create_variable(name, _dimensions(self._plan), kind)
            variable.attrs.update(_labels(name, self._further))

    def write(self, start: int, batch: PointBatch) -> None:
        """Write a chunk from a flat index on."""
        codes: dict[str, NDArray[Any]] = {"status": batch.status, "reason": self._reasons.codes(batch)}
        columns = {**batch.numbers, **codes, **_further_columns(self._further, self._plan, start, batch)}
        try:
            for block, part in _blocks(self._plan.shape, start, start + batch.status.size):
                for name, column in columns.items():
                    self._file[name][block] = column[part].reshape([axis.stop - axis.start for axis in block])
        finally:
            self._unfinished.check()

    def dataset(self) -> "xr.Dataset":
        """Dataset of all chunks, read lazily from the completed file."""
        import xarray as xr

        self._file.dimensions["reasons"] = len(self._reasons.code_of)
        self._write_variable("reason_text", ("reasons",), np.array(list(self._reasons.code_of)), _labels("reason_text"))
        self._file.close()
        self._unfinished.complete()
        return xr.open_dataset(self._path, engine="h5netcdf")

    def _write_variable(self, name: str, dims: tuple[str, ...], array: NDArray[Any], attrs: dict[str, Any]) -> None:
        import h5py

        kind = h5py.string_dtype() if array.dtype.kind == "U" else array.dtype
        variable = self._file.create_variable(name, dims, kind)
        variable[...] = array.astype(object) if array.dtype.kind == "U" else array
        variable.attrs.update(attrs)


def _further_columns(
    further: FurtherColumns | None, plan: SweepPlan, start: int, batch: PointBatch
) -> Mapping[str, NDArray[Any]]:
    """Further columns of a chunk from a flat index on."""
    return {} if further is None else further.of(plan.rows(start, start + batch.status.size), batch)


def _blocks(shape: tuple[int, ...], start: int, stop: int) -> Iterator[tuple[tuple[slice, ...], slice]]:
    """Yield the rectangular blocks of an array that a flat range covers, each with its part of the range."""
    inner = int(np.prod(shape[1:]))
    if len(shape) == 1:
        yield (slice(start, stop),), slice(0, stop - start)
        return
    index = start
    while index < stop:
        row, offset = divmod(index, inner)
        if offset == 0 and stop - index >= inner:
            rows = (stop - index) // inner
            whole = tuple(slice(0, size) for size in shape[1:])
            yield (slice(row, row + rows), *whole), slice(index - start, index - start + rows * inner)
            index += rows * inner
        else:
            end = min(stop, (row + 1) * inner)
            for block, part in _blocks(shape[1:], offset, offset + end - index):
                yield (slice(row, row + 1), *block), slice(index - start + part.start, index - start + part.stop)
            index = end


def _dimensions(plan: SweepPlan) -> tuple[str, ...]:
    """Dimensions of the result: one per key of a grid, else `point`."""
    return tuple(plan.names.values()) if plan.grid else ("point",)


def _coordinates(plan: SweepPlan) -> dict[str, tuple[str, NDArray[Any], dict[str, str]]]:
    """Dimension, values and attributes of the coordinate of each key."""
    return {
        name: (name if plan.grid else "point", plan.values[key], _labels(key.rpartition(".")[2]) | {"key": key})
        for key, name in plan.names.items()
    }


def _attributes(plan: SweepPlan) -> dict[str, str]:
    """Attributes of the dataset: title, rig, program version, and digest of the plan."""
    title = str(plan.content["title"])
    attributes = {
        "result": "sweep",
        "title": f"Sweep of {title}",
        "rig": title,
        "source": f"sonolube {__version__}",
        "sweep": plan.digest,
    }
    assumed: dict[str, str] = plan.content.get("assumptions", {})
    attributes["assumptions"] = "\n".join(f"{key}: {reason}" for key, reason in assumed.items())
    if (rig := plan.own_rig()) is not None:
        attributes |= amplitude_labels(rig)
        if "friction.model" not in plan.values:
            attributes["friction_model"] = rig.friction_model.name
        attributes["caveats"] = "\n".join(operating_caveats(rig))
    return attributes


def _labels(name: str, further: FurtherColumns | None = None) -> dict[str, Any]:
    """Attributes of a variable: unit and meaning from the vocabulary, or the meaning of codes."""
    if further is not None and name in further.labels:
        return dict(further.labels[name])
    if name == "status":
        flags = {"flag_values": np.arange(len(STATUSES), dtype=np.int8), "flag_meanings": " ".join(STATUSES)}
        return {"long_name": "Status of the point"} | flags
    if name in quantities():
        return labels(name)
    return {"long_name": _MEANINGS.get(name) or name.replace("_", " ")}


_MANIFEST = "sweep.json"
_EARLIER = (".sweep.nc.*", ".sweep.json.*", ".chunk-*.npz.*")  # unfinished files of earlier versions


@dataclass(frozen=True, kw_only=True, slots=True)
class ChunkStore:
    """Folder with the finished chunks of one sweep.

    Parameters
    ----------
    folder : Path
    digest : str
        Digest of the sweep's plan.
    chunk_points : int
        Points per chunk.

    Notes
    -----
    The manifest sweep.json holds the digest and the chunk size, so that a folder is never continued with another
    sweep. A chunk is the file chunk-NNNNNN.HASH.npz with 32 hexadecimal digits of the SHA-256 hash of its content; a
    file that does not match its name is damaged and is computed anew.
    """

    folder: Path
    digest: str
    chunk_points: int

    @contextmanager
    def opened(self) -> Iterator[None]:
        """Lock the folder inside a `with` block; create its manifest, or check that it is of the same sweep."""
        with locked_folder(self.folder, purpose="sweep"):
            self._check_manifest()
            clear_unfinished(self.folder, *_EARLIER)
            yield

    def read(self, chunk: int) -> PointBatch | None:
        """Chunk of an index, or None where it is missing or damaged; damaged files are removed."""
        batch = None
        for path in self.folder.glob(f"chunk-{chunk:06d}.*.npz"):
            content = path.read_bytes()
            if path.name == _file_name(chunk, content):
                batch = _decoded(content)
            else:
                remove_file(path)
        return batch

    def write(self, chunk: int, batch: PointBatch) -> None:
        """Write a chunk to its file."""
        content = _encoded(batch)
        write_atomically(self.folder / _file_name(chunk, content), content)

    def _check_manifest(self) -> None:
        """Create the manifest, or check that an existing one is of the same sweep."""
        manifest = self.folder / _MANIFEST
        expected = {"sweep": self.digest, "chunk_points": self.chunk_points}
        if not manifest.exists():
            write_atomically(manifest, json.dumps(expected))
            return
        try:
            found = json.loads(manifest.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            found = None
        if found != expected:
            raise InvalidInput(
                f"{self.folder}: holds another sweep, of another rig, other values or another version;"
                " name another folder, or remove this one"
            )


def _file_name(chunk: int, content: bytes) -> str:
    """Name of a chunk's file from its index and the hash of its content."""
    return f"chunk-{chunk:06d}.{hashlib.sha256(content).hexdigest()[:32]}.npz"


def _encoded(batch: PointBatch) -> bytes:
    """Batch as an uncompressed NPZ archive."""
    buffer = io.BytesIO()
    np.savez(
        buffer,
        allow_pickle=False,
        numbers=np.stack([batch.numbers[name] for name in NUMBERS]),
        status=batch.status,
        reason=batch.reason,
        reasons=np.array(batch.reasons, dtype=np.str_),
    )
    return buffer.getvalue()


def _decoded(content: bytes) -> PointBatch:
    """Batch from an NPZ archive."""
    with np.load(io.BytesIO(content), allow_pickle=False) as archive:
        return PointBatch(
            numbers=dict(zip(NUMBERS, archive["numbers"], strict=True)),
            status=archive["status"],
            reason=archive["reason"],
            reasons=tuple(str(text) for text in archive["reasons"]),
        )
