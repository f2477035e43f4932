"""Tables and values as arguments: measured runs, mappings of columns, tables of numbers, values of keys of a rig.

Values of a key are a text such as "20kHz:24kHz:50", or numbers in SI.
"""

import io
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias, cast

from sonolube.design.ranges import ends_of, values_of
from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.reader import mapping_by_name, recipes_first_in
from sonolube.measurement.run_sheet_file import has_runs_in_use
from sonolube.rig.file.rig_folder import INSTRUMENTS, RECORDS, RUNS_FILE, folder_of
from sonolube.storage.user_files import input_text
from sonolube.tasks.files import InputFile, NamedBytes, file_path, is_none
from sonolube.tasks.parameters import File, OwnRuns, RunsSource
from sonolube.tasks.task import refuse_unused, shown

if TYPE_CHECKING:
    import xarray as xr

    from sonolube.checks import Floats
    from sonolube.rig import Rig

Mapped = Annotated[
    InputFile | None, File("Of the columns: umt, anton-paar, t-11, rtec, pin-on-disc, or a file.", "NAME|MAPPING.toml")
]
MappedRuns = Annotated[
    InputFile | None,
    File("Of the columns of the runs whose headings are no names, as sonolube mapping writes it.", "MAPPING.toml"),
]
_CATALOGUE = "catalogue:"


def mapping_of(mapping: InputFile | None) -> RecordingMapping | None:
    """Meaning of columns by the name or the file of a mapping; None where none was given."""
    return None if mapping is None else mapping_by_name(str(file_path(mapping)))


def required_runs(runs: OwnRuns, mapping: InputFile | None = None, rig: "Rig | None" = None) -> "xr.Dataset":
    """Measured runs of a table that a task cannot do without, as `runs_of` reads them; a file may be called none."""
    folder = None if rig is None else folder_of(rig)
    with recipes_first_in(None if folder is None else folder / INSTRUMENTS):
        return _given_runs(runs, mapping, folder)


def runs_of(runs: RunsSource, mapping: InputFile | None = None, rig: "Rig | None" = None) -> "xr.Dataset | None":
    """Measured runs of a table, of a query of the catalogue, or of the folder of a rig; a dataset as it is.

    Where no table is given, the runs of the folder of the rig are taken, and a caveat says so. Recipes of its
    instruments come first.

    Raises
    ------
    InvalidInput
        If the table cannot be read, or a mapping was given without one.
    """
    folder = None if rig is None else folder_of(rig)
    with recipes_first_in(None if folder is None else folder / INSTRUMENTS):
        if runs is not None:
            return None if is_none(runs) else _given_runs(runs, mapping, folder)
        if folder is None or not has_runs_in_use(file := folder / RUNS_FILE):
            refuse_unused("mapping", because="without a table of runs")
            return None
        found = _given_runs(file, mapping, folder)
    said = (
        f"the runs of {folder.name or folder}/{RUNS_FILE} are taken as own runs; {shown('runs')} none leaves them out"
    )
    return found.assign_attrs(caveats="\n".join(each for each in (said, str(found.attrs.get("caveats", ""))) if each))


def _given_runs(runs: OwnRuns, mapping: InputFile | None, folder: Path | None) -> "xr.Dataset":
    """Measured runs of an argument; a query searches the records of the folder of the rig unless it names another."""
    is_query = isinstance(runs, str | Path) and str(runs).startswith(_CATALOGUE)
    if is_query or not isinstance(runs, str | Path | NamedBytes):
        if mapping is not None:
            raise InvalidInput(f"{shown('mapping')} has no meaning here; it is for files of runs", key="mapping")
        if not isinstance(runs, str | Path | NamedBytes):
            return cast("xr.Dataset", runs)  # a table of own runs was made a file where arguments are coerced
        from sonolube.laboratory.catalogue import catalogued_runs

        return catalogued_runs(str(runs), **({} if folder is None else {"place": folder / RECORDS}))
    from sonolube.measurement.measured_runs import read_runs

    path = file_path(runs)
    own = path / RUNS_FILE  # where the path is the folder of a rig
    return read_runs(own if own.is_file() else path, mapping=mapping_of(mapping))


def number_table(path: Path) -> "Floats":
    """Numbers of a CSV file without header, comments behind #, shape (rows, columns).

    Raises
    ------
    InvalidInput
        If the file is no table of numbers.
    """
    import numpy as np

    try:
        return np.loadtxt(io.StringIO(input_text(path)), delimiter=",", comments="#", ndmin=2, dtype=np.float64)
    except (OSError, ValueError) as failure:
        raise InvalidInput(f"{path}: is no table of numbers with commas between: {failure}") from None


Values: TypeAlias = Mapping[str, Any]
"""By dotted key of the rig file: first:last:count, first:last:count:log, one,two,..., or numbers in SI."""


def values_by_key(over: Values) -> dict[str, Any]:
    """Values of each key: numbers in SI, or text for keys that are no quantity.

    Raises
    ------
    InvalidInput
        If a text cannot be read.
    """
    return {
        key: values_of(key, values, option=shown("over")) if isinstance(values, str) else values
        for key, values in over.items()
    }


def ends_by_key(over: Values) -> dict[str, tuple[float, float]]:
    """Lowest and highest value of each key, in SI.

    Raises
    ------
    InvalidInput
        If a text cannot be read, or there are not two numbers.
    """
    return {key: _ends(key, values) for key, values in over.items()}


def refuse_replaced(rig: "Rig", over: Values) -> None:
    """Refuse a key of which the rig has an entry that was replaced when it was read.

    Raises
    ------
    InvalidInput
        For the first such key.
    """
    for key in (change.partition("=")[0].strip() for change in rig.changes):
        if key in over:
            raise InvalidInput(f"--set {key}: takes the values of {shown('over')} {key}; give it once")


def _ends(key: str, values: Any) -> tuple[float, float]:
    """Lowest and highest value of a key, as text or as numbers in SI."""
    if isinstance(values, str):
        return ends_of(key, values, option=shown("over"))
    import numpy as np

    numbers = np.asarray(values, float).ravel()
    if numbers.size != 2:
        raise InvalidInput(f"{shown('over')} {key}: points are drawn between two ends, got {numbers.size} numbers")
    return float(numbers[0]), float(numbers[1])
