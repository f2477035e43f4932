"""Own tables as arguments of tasks: measured runs, and the mapping of their columns."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, overload

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.instrument_mappings import mapping_by_name
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.tasks.files import InputFile, NamedBytes, file_path
from sonolube.tasks.parameters import File, OwnRuns, RunsSource
from sonolube.tasks.task import refuse_unused, shown

if TYPE_CHECKING:
    import xarray as xr

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


@overload
def runs_of(runs: OwnRuns, mapping: InputFile | None = None) -> "xr.Dataset": ...
@overload
def runs_of(runs: RunsSource, mapping: InputFile | None = None) -> "xr.Dataset | None": ...
def runs_of(runs: RunsSource, mapping: InputFile | None = None) -> "xr.Dataset | None":
    """Measured runs of a table or of a query of the catalogue; a dataset as it is.

    Raises
    ------
    InvalidInput
        If the table cannot be read, or a mapping was given without one.
    """
    if runs is None:
        refuse_unused("mapping", because="without a table of runs")
        return None
    is_query = isinstance(runs, str | Path) and str(runs).startswith(_CATALOGUE)
    if is_query or not isinstance(runs, str | Path | NamedBytes):
        if mapping is not None:
            raise InvalidInput(f"{shown('mapping')} has no meaning here; it is for files of runs", key="mapping")
        if not isinstance(runs, str | Path | NamedBytes):
            return runs
        from sonolube.laboratory.catalogue import catalogued_runs

        return catalogued_runs(str(runs))
    from sonolube.measurement.measured_runs import read_runs

    return read_runs(file_path(runs), mapping=mapping_of(mapping))
