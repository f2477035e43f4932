"""MATLAB files: versions 4 to 7 by their own elements, version 7.3, which is HDF5, through h5py."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, ClassVar, final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.hdf5_datasets import attributes_of, numeric_datasets
from sonolube.measurement.limits import require_channels, require_values
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.matlab_elements import MatlabArray, matlab_arrays
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
