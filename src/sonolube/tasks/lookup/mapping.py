"""Task `mapping`: quantity and unit of each column of a text file, as a file for `--mapping`."""

import re
from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from sonolube.errors import InvalidInput
from sonolube.measurement.export_columns import ExportColumns, export_mapping, export_with_times, recording_text
from sonolube.measurement.measured_runs import read_runs, run_caveats, runs_text
from sonolube.measurement.recordings.mapping import RecordingMapping, mapping_toml
from sonolube.measurement.recordings.reader import keep_recipe, labels_of_runs, read_recording, recipe_of_runs
from sonolube.measurement.recordings.text_tables import decoded_text
from sonolube.measurement.run_headings import (
    LEFT_OUT,
    Meaning,
    RunHeading,
    columns_of_mapping,
    likely_statements,
    mapping_of_columns,
    samples,
    stated_columns,
)
from sonolube.measurement.run_table import run_table, run_text
from sonolube.tasks.answer import Answer, Block, Table, answer
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.parameters import File, KeyValues, Parameter, file_stem
from sonolube.tasks.task import refuse_unused, shown, task
from sonolube.text.units import format_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

_COLUMN = KeyValues(
    "Quantity and unit of a column, such as 'Kraft=friction_force N', or - to leave it out; may come again.",
    "LABEL=QUANTITY",
)


@task
def mapping(
    file: Annotated[InputFile, File("Table of runs, or text export of an instrument.", "FILE")],
    *,
    column: Annotated[Mapping[str, str] | None, _COLUMN] = None,
    decimal_sign: Annotated[
        Literal[".", ","] | None, Parameter("Decimal sign, where each may as well stand between thousands.")
    ] = None,
    instrument: Annotated[
        str | None,
        Parameter("Keep the mapping under this name: later files of the same labels are read by it unasked.", "NAME"),
    ] = None,
) -> "MappingAnswer":
    """Quantity and unit of each column of a table, by headings and answers to questions, as a file for --mapping.

    Example: sonolube mapping examples/tribometer-runs.csv

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.mapping("examples/tribometer-runs.csv")
    >>> answer.object()["columns"]["sliding_speed [mm/s]"]
    {'quantity': 'sliding_speed', 'unit': 'mm/s'}
    """
    path, name = file_path(file), f"{file_stem(file)}-mapping.toml"
    if (export := export_with_times(path)) is not None:
        refuse_unused("decimal_sign", because="for the export of a recording; it is for tables of runs")
        return _of_export(path, export, column or {}, instrument, name)
    table, _ = run_text(path)
    recipe = None if column or decimal_sign else recipe_of_runs(path, table.labels)
    if recipe is not None:
        return _of_runs(path, recipe, columns_of_mapping(table, recipe), instrument, name)
    columns = {}
    for label, found in stated_columns(table, column or {}, path).items():
        if found is None:
            likely = likely_statements(label) or ["friction_force N"]
            raise InvalidInput(
                f"{path}: line {table.line}: column {label!r} needs a quantity and its unit; state it by"
                f" {shown('column')}, such as {' or '.join(repr(f'{label}={each}') for each in likely)}, or"
                f" '{label}={LEFT_OUT}' to leave it out"
            )
        columns[label] = found
    _require_distinct(columns, path)
    known = mapping_of_columns(table, columns, decimal_sign=decimal_sign or "")
    return _of_runs(path, known, columns, instrument, name)


def _of_runs(
    path: Path, known: RecordingMapping, columns: Mapping[str, Meaning], instrument: str | None, name: str
) -> "MappingAnswer":
    """Mapping of a table of runs, kept as a recipe for tables of its labels where it has a name."""
    table, caveats = run_text(path)
    runs, refusal = (None, "") if known.axis is not None else _runs(path, known)
    told = [*(run_caveats(runs) if runs is not None else caveats), *([refusal] if refusal else [])]
    if known.recognised_by:
        told.append(f"read by the recipe {known.name!r}")
    if instrument is not None:
        if any(re.fullmatch(r"column \d+", label) for label in table.labels):
            raise InvalidInput(f"{path}: has no headings, by which later tables could be recognised", key="instrument")
        kept = keep_recipe(instrument, known, labels=labels_of_runs(table.labels))
        told.append(f"kept as {kept}")
    return MappingAnswer(
        rows=len(table.rows),
        cells={label: "; ".join(samples(table, label)) for label in columns},
        columns=columns,
        known=known,
        read=runs,
        told=told,
        name=name,
    )


def _of_export(
    path: Path, found: ExportColumns, stated: Mapping[str, str], instrument: str | None, name: str
) -> "MappingAnswer":
    """Mapping of the export of a recording, kept as that of an instrument where it has a name."""
    try:
        known = export_mapping(path, found, stated)
    except InvalidInput as failure:
        if failure.key is None:
            raise
        raise InvalidInput(
            f"{failure}: state what {failure.key!r} is by {shown('column')}, such as '{failure.key}=friction_force N',"
            f" or '{failure.key}=friction_force 2 N/V' with the gain of a sensor"
        ) from None
    recording = read_recording(path, mapping=known)
    told = str(recording.attrs.get("caveats", "")).splitlines()
    if instrument is not None:
        if not found.line:
            raise InvalidInput(f"{path}: is no text, by whose labels later files could be recognised", key="instrument")
        labels = decoded_text(path, encoding="")[0].splitlines()[found.line - 1]
        told.append(f"kept as {keep_recipe(instrument, known, labels=labels)}")
    channels = {source.column: (name, source) for name, source in known.channels.items()}
    if known.axis is not None:
        channels[known.axis.column] = (known.axis_quantity, known.axis)
    columns: dict[str, Meaning] = {
        each.label: RunHeading(meant[0], meant[1].unit or "") if (meant := channels.get(each.label)) else LEFT_OUT
        for each in found.columns
        if each.label
    }
    cells = {each.label: "; ".join(each.cells) for each in found.columns}
    rows = next(iter(recording.sizes.values()))
    return MappingAnswer(rows=rows, cells=cells, columns=columns, known=known, read=recording, told=told, name=name)


def _runs(path: Path, known: RecordingMapping) -> "tuple[xr.Dataset | None, str]":
    """Runs of a table by its mapping; or why there is none, where its cells can be read."""
    run_table(path, mapping=known)
    try:
        return read_runs(path, mapping=known), ""
    except InvalidInput as failure:
        return None, f"no table of runs: {str(failure).removeprefix(f'{path}: ')}"


def _require_distinct(columns: Mapping[str, Meaning], path: Path) -> None:
    """Refuse two columns of one quantity."""
    labels: dict[str, str] = {}
    for label, each in columns.items():
        if isinstance(each, RunHeading) and labels.setdefault(each.name, label) != label:
            raise InvalidInput(
                f"{path}: columns {labels[each.name]!r} and {label!r} are both {each.name}; leave one out by"
                f" {shown('column')} '{label}={LEFT_OUT}'"
            )


_MAX_SHOWN = 3  # first values of a column


@answer
class MappingAnswer(Answer):
    """Quantity and unit of each column, the runs or the recording that follow, and the file of the mapping."""

    rows: int
    cells: Mapping[str, str]
    columns: Mapping[str, Meaning]
    known: RecordingMapping
    read: "xr.Dataset | None"
    told: Sequence[str]
    name: str

    def blocks(self) -> Sequence[Block]:
        """Columns with quantity, unit, first cells and the values that are read; the friction of the first runs."""
        rows = []
        for label, found in self.columns.items():
            named = (found.name, found.unit) if isinstance(found, RunHeading) else (_words(found), "")
            rows.append((label, *named, self.cells[label], self._values(found)))
        return [
            f"{len(self.columns)} columns, {self.rows} rows",
            Table(("column", "quantity", "unit", "cells", "read as"), rows),
            *self._told(),
        ]

    def _told(self) -> list[str]:
        """What the file was read as, in a line."""
        if self.read is None:
            return []
        return [recording_text(self.read) if self.is_recording else runs_text(self.read)]

    @property
    def is_recording(self) -> bool:
        """Whether the file is a recording, not a table of runs."""
        return self.read is not None and "run" not in self.read.sizes

    def _values(self, found: Meaning) -> str:
        """First values of a column of runs in SI."""
        if self.read is None or not isinstance(found, RunHeading) or found.name not in self.read.variables:
            return ""
        values = self.read[found.name].to_numpy()[:_MAX_SHOWN]
        if values.dtype.kind != "f":
            return "; ".join(map(str, values))
        unit = quantities()[found.name].unit
        return "; ".join(format_si(float(each), unit, digits=4) if isfinite(each) else "-" for each in values)

    def object(self) -> dict[str, Any]:
        """Quantity and unit by column, null where it is left out; number of runs and their friction ratios."""
        has_ratios = self.read is not None and not self.is_recording
        ratios = (
            (1 - self.read["friction_reduction"].to_numpy()).tolist() if self.read is not None and has_ratios else []
        )
        return {
            "columns": {
                label: {"quantity": found.name, "unit": found.unit} if isinstance(found, RunHeading) else None
                for label, found in self.columns.items()
            },
            "friction_ratios": ratios,
        }

    def caveats(self) -> Sequence[str]:
        """What was assumed and left out, and why there are no runs."""
        return self.told

    def files(self) -> Mapping[str, str]:
        """Mapping as TOML."""
        return {self.name: mapping_toml(self.known)}

    def keeps(self, name: str, present: str) -> bool:
        """Whether a mapping of this name was changed since it was written."""
        return present != self.files().get(name)


def _words(found: str) -> str:
    """Meaning of a column that is no quantity, in words."""
    return "left out" if found == LEFT_OUT else found
