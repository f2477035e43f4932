"""Chunks of a sweep put together as one labelled dataset, in memory or in a file."""

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from sonolube import __version__
from sonolube.design.plan import SweepPlan
from sonolube.rig import NUMBERS, STATUSES, PointBatch
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

_CODES: dict[str, type[np.signedinteger[Any]]] = {"status": np.int8, "reason": np.int16}


class _Reasons:
    """One table of reasons from those of all chunks."""

    def __init__(self) -> None:
        self.places: dict[str, int] = {}

    def codes(self, batch: PointBatch) -> NDArray[np.int16]:
        own = [self.places.setdefault(text, len(self.places)) for text in batch.reasons]
        return np.array(own, dtype=np.int16)[batch.reason]


class InMemory:
    """A dataset in memory.

    Parameters
    ----------
    plan : SweepPlan
    device : str
        Name of the GPU at hand, which did what it serves, or empty.
    """

    def __init__(self, plan: SweepPlan, device: str = "") -> None:
        self._plan, self._device, self._reasons = plan, device, _Reasons()
        self._columns: dict[str, NDArray[Any]] = {name: np.empty(plan.points) for name in NUMBERS}
        self._columns |= {name: np.empty(plan.points, dtype=kind) for name, kind in _CODES.items()}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type | None, value: BaseException | None, trace: TracebackType | None) -> None:
        pass

    def take(self, start: int, batch: PointBatch) -> None:
        """Put a chunk in its place."""
        own = slice(start, start + batch.status.size)
        for name in NUMBERS:
            self._columns[name][own] = batch.numbers[name]
        self._columns["status"][own] = batch.status
        self._columns["reason"][own] = self._reasons.codes(batch)

    def dataset(self) -> "xr.Dataset":
        """Return all chunks."""
        import xarray as xr

        shape = self._plan.shape
        variables: dict[str, Any] = {
            name: (_dimensions(self._plan), array.reshape(shape), _labels(name))
            for name, array in self._columns.items()
        }
        texts = np.array(list(self._reasons.places), dtype=np.str_)
        variables["reason_text"] = ("reasons", texts, _labels("reason_text"))
        return xr.Dataset(variables, coords=_coordinates(self._plan), attrs=_attributes(self._plan, self._device))


class InFile:
    """A dataset in a netCDF file, written chunk by chunk.

    Parameters
    ----------
    plan : SweepPlan
    folder : Path
        Where the file sweep.nc is to appear.
    device : str
        Name of the GPU at hand, which did what it serves, or empty.
    """

    def __init__(self, plan: SweepPlan, folder: Path, device: str = "") -> None:
        self._plan, self._path, self._device, self._reasons = plan, folder / "sweep.nc", device, _Reasons()

    def __enter__(self) -> Self:
        import h5netcdf

        handle, name = tempfile.mkstemp(dir=self._path.parent, prefix=".sweep.nc.")
        os.close(handle)
        self._unfinished = Path(name)
        self._file: Any = h5netcdf.File(name, "w")
        self._file.dimensions = dict(zip(_dimensions(self._plan), self._plan.shape, strict=True))
        self._file.attrs.update(_attributes(self._plan, self._device))
        for name, (dimension, array, attributes) in _coordinates(self._plan).items():
            self._write_variable(name, (dimension,), array, attributes)
        for name in (*NUMBERS, *_CODES):
            made = self._file.create_variable(name, _dimensions(self._plan), _CODES.get(name, np.float64))
            made.attrs.update(_labels(name))
        return self

    def __exit__(self, kind: type | None, value: BaseException | None, trace: TracebackType | None) -> None:
        if self._file is not None:
            self._file.close()
        self._unfinished.unlink(missing_ok=True)

    def take(self, start: int, batch: PointBatch) -> None:
        """Put a chunk in its place."""
        columns: dict[str, NDArray[Any]] = {
            **batch.numbers,
            "status": batch.status,
            "reason": self._reasons.codes(batch),
        }
        for place, own in _slabs(self._plan.shape, start, start + batch.status.size):
            for name, column in columns.items():
                self._file[name][place] = column[own].reshape([part.stop - part.start for part in place])

    def dataset(self) -> "xr.Dataset":
        """Return all chunks, to be read from the file as they are needed."""
        import xarray as xr

        self._file.dimensions["reasons"] = len(self._reasons.places)
        self._write_variable("reason_text", ("reasons",), np.array(list(self._reasons.places)), _labels("reason_text"))
        self._file.close()
        self._file = None
        self._unfinished.chmod(0o644)
        self._unfinished.replace(self._path)
        return xr.open_dataset(self._path, engine="h5netcdf")

    def _write_variable(
        self, name: str, dims: tuple[str, ...], array: NDArray[Any], attributes: dict[str, Any]
    ) -> None:
        import h5py

        kind = h5py.string_dtype() if array.dtype.kind == "U" else array.dtype
        made = self._file.create_variable(name, dims, kind)
        made[...] = array.astype(object) if array.dtype.kind == "U" else array
        made.attrs.update(attributes)


def _slabs(shape: tuple[int, ...], start: int, stop: int) -> Iterator[tuple[tuple[slice, ...], slice]]:
    """Yield the blocks of an array that a run of its points fills, and which of the run goes to each."""
    inner = int(np.prod(shape[1:]))
    if len(shape) == 1:
        yield (slice(start, stop),), slice(0, stop - start)
        return
    at = start
    while at < stop:
        row, into = divmod(at, inner)
        if into == 0 and stop - at >= inner:
            rows = (stop - at) // inner
            whole = tuple(slice(0, size) for size in shape[1:])
            yield (slice(row, row + rows), *whole), slice(at - start, at - start + rows * inner)
            at += rows * inner
        else:
            end = min(stop, (row + 1) * inner)
            for place, own in _slabs(shape[1:], into, into + end - at):
                yield (slice(row, row + 1), *place), slice(at - start + own.start, at - start + own.stop)
            at = end


def _dimensions(plan: SweepPlan) -> tuple[str, ...]:
    return tuple(plan.names.values()) if plan.grid else ("point",)


def _coordinates(plan: SweepPlan) -> dict[str, tuple[str, NDArray[Any], dict[str, str]]]:
    return {
        name: (name if plan.grid else "point", plan.values[key], _labels(key.rpartition(".")[2]) | {"key": key})
        for key, name in plan.names.items()
    }


def _attributes(plan: SweepPlan, device: str) -> dict[str, str]:
    title = str(plan.content["title"])
    own = {"title": f"Sweep of {title}", "rig": title, "source": f"sonolube {__version__}", "sweep": plan.digest}
    return own | ({"device": device} if device else {})


def _labels(name: str) -> dict[str, Any]:
    if name == "status":
        return {
            "long_name": "What is known of the point",
            "flag_values": np.arange(len(STATUSES), dtype=np.int8),
            "flag_meanings": " ".join(STATUSES),
        }
    if name == "reason":
        return {"long_name": "Place of what the status means in reason_text"}
    if name == "reason_text":
        return {"long_name": "What a status means, and what to try"}
    if name not in quantities():
        return {"long_name": name.replace("_", " ")}
    known = quantities()[name]
    return {"units": known.unit or "1", "long_name": known.meaning}
