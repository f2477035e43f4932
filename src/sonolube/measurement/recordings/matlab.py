"""MATLAB files: versions 4 to 7 through scipy, version 7.3, which is HDF5, through h5py."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar, final

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable, refuse_library_errors

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
        """Return whether the file begins with the signature of versions 5 to 7.3."""
        return head.startswith(_SIGNATURE)

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        """Return the vectors of a MATLAB file; those inside structures are labelled `structure.field`.

        Parameters
        ----------
        path : Path
            Of the file.
        mapping : RecordingMapping or None
            Not used: all vectors are read.

        Returns
        -------
        RawTable
            A scalar called `sample_rate`, `sampling_rate` or `fs` gives the sample interval, in Hz.

        Raises
        ------
        InvalidInput
            Naming the file, if it is no MATLAB file or holds no vector of numbers.
        """
        with refuse_library_errors(path, format_name=self.name):
            with path.open("rb") as stream:
                is_hdf5 = b"MATLAB 7.3" in stream.read(128)
            arrays = dict(_arrays_of_version_7_3(path) if is_hdf5 else _arrays_before_version_7_3(path))
        rates = [float(arrays[name].flat[0]) for name in _RATE_NAMES if name in arrays and arrays[name].size == 1]
        interval = 1 / rates[0] if rates and rates[0] > 0 else None
        columns = tuple(
            RawColumn(label=name, values=array.ravel().astype(np.float64), interval=interval, start=0.0)
            for name, array in arrays.items()
            if array.size > 1 and max(array.shape) == array.size
        )
        if not columns:
            raise InvalidInput(f"{path}: holds no vector of numbers")
        return RawTable(columns=columns, format_name=self.name)


def _arrays_before_version_7_3(path: Path) -> Mapping[str, Any]:
    """Return the numeric arrays of a file of version 4 to 7, and those of its structures."""
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


def _arrays_of_version_7_3(path: Path) -> Mapping[str, Any]:
    """Return the numeric arrays of a file of version 7.3, and those of its structures."""
    import h5py

    arrays: dict[str, Any] = {}

    def visit(name: str, item: Any) -> None:
        is_numeric = isinstance(item, h5py.Dataset) and item.dtype.kind in "fiub" and not name.startswith("#")
        if is_numeric and item.attrs.get("MATLAB_class") != b"char" and not item.attrs.get("MATLAB_empty", 0):
            arrays[name.replace("/", ".")] = np.asarray(item[()])

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    return arrays
