"""MATLAB files: version 5 through scipy, version 7.3, which is HDF5, through h5py."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable, refuse_library_errors

FORMAT = "MATLAB"
_RATES = ("sample_rate", "sampling_rate", "fs", "Fs")


def read_matlab(path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
    """Return the vectors of a MATLAB file, those inside structures as `structure.field`.

    Parameters
    ----------
    path : Path
        Of the file, version 4 to 7.3.
    mapping : RecordingMapping or None
        Not needed here: vectors are all read.

    Returns
    -------
    Table
        A scalar called `sample_rate` or `fs` gives the time between samples, in Hz.

    Raises
    ------
    InvalidInput
        Naming the file, if it is no MATLAB file or holds no vector of numbers.
    """
    with refuse_library_errors(path, format_name=FORMAT):
        with path.open("rb") as stream:
            new = b"MATLAB 7.3" in stream.read(128)
        arrays = dict(_version_73(path) if new else _version_5(path))
    rates = [float(arrays[name].flat[0]) for name in _RATES if name in arrays and arrays[name].size == 1]
    interval = 1 / rates[0] if rates and rates[0] > 0 else None
    columns = tuple(
        RawColumn(label=name, values=array.ravel().astype(np.float64), interval=interval, start=0.0)
        for name, array in arrays.items()
        if array.size > 1 and max(array.shape) == array.size
    )
    if not columns:
        raise InvalidInput(f"{path}: holds no vector of numbers")
    return RawTable(columns=columns, format=FORMAT)


def _version_5(path: Path) -> Mapping[str, Any]:
    from scipy.io import loadmat

    arrays: dict[str, Any] = {}
    for name, value in loadmat(path, struct_as_record=True, squeeze_me=True).items():
        array = np.asarray(value)
        if array.dtype.names:
            fields = {f"{name}.{key}": np.asarray(array[key].item()) for key in array.dtype.names if array.size == 1}
            arrays |= {key: field for key, field in fields.items() if field.dtype.kind in "fiub"}
        elif not name.startswith("__") and array.dtype.kind in "fiub":
            arrays[name] = array
    return arrays


def _version_73(path: Path) -> Mapping[str, Any]:
    import h5py

    arrays: dict[str, Any] = {}

    def visit(name: str, item: Any) -> None:
        wanted = isinstance(item, h5py.Dataset) and item.dtype.kind in "fiub" and not name.startswith("#")
        if wanted and item.attrs.get("MATLAB_class") != b"char" and not item.attrs.get("MATLAB_empty", 0):
            arrays[name.replace("/", ".")] = np.asarray(item[()])

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    return arrays
