"""Task `mapping`: quantity and unit of each column of a text file, as a file for `--mapping`."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import mapping_toml
from sonolube.measurement.recordings.text_tables import TextTable
from sonolube.measurement.run_headings import LEFT_OUT, Meaning, RunHeading, mapping_of_columns, samples, stated_columns
from sonolube.measurement.run_table import run_text
from sonolube.tasks.answer import Answer, Block, Table, answer
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.parameters import File, KeyValues, file_stem
from sonolube.tasks.task import shown, task

_COLUMN = KeyValues(
    "Quantity and unit of a column, such as 'Kraft=friction_force N', or - to leave it out; may come again.",
    "LABEL=QUANTITY",
)


@task
def mapping(
    file: Annotated[InputFile, File("Table of runs, or text export of an instrument.", "FILE")],
    *,
    column: Annotated[Mapping[str, str] | None, _COLUMN] = None,
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
    path = file_path(file)
    table, _ = run_text(path)
    columns = {}
    for label, found in stated_columns(table, column or {}, path).items():
        if found is None:
            raise InvalidInput(
                f"{path}: line {table.line}: column {label!r} needs a quantity and its unit; state it by"
                f" {shown('column')}, such as '{label}=friction_force N', or '{label}={LEFT_OUT}' to leave it out"
            )
        columns[label] = found
    _require_distinct(columns, path)
    return MappingAnswer(table=table, columns=columns, name=f"{file_stem(file)}-mapping.toml")


def _require_distinct(columns: Mapping[str, Meaning], path: Path) -> None:
    """Refuse two columns of one quantity."""
    labels: dict[str, str] = {}
    for label, each in columns.items():
        if isinstance(each, RunHeading) and labels.setdefault(each.name, label) != label:
            raise InvalidInput(
                f"{path}: columns {labels[each.name]!r} and {label!r} are both {each.name}; leave one out by"
                f" {shown('column')} '{label}={LEFT_OUT}'"
            )


@answer
class MappingAnswer(Answer):
    """Quantity and unit of each column, and the file of the mapping."""

    table: TextTable
    columns: Mapping[str, Meaning]
    name: str

    def blocks(self) -> Sequence[Block]:
        """Columns with quantity, unit and first cells."""
        rows = []
        for label, found in self.columns.items():
            named = (found.name, found.unit) if isinstance(found, RunHeading) else ("left out", "")
            rows.append((label, *named, "; ".join(samples(self.table, label))))
        count = f"{len(self.columns)} columns, {len(self.table.rows)} rows"
        return [count, Table(("column", "quantity", "unit", "cells"), rows)]

    def object(self) -> dict[str, Any]:
        """Quantity and unit by column; null where it is left out."""
        return {
            "columns": {
                label: {"quantity": found.name, "unit": found.unit} if isinstance(found, RunHeading) else None
                for label, found in self.columns.items()
            }
        }

    def files(self) -> Mapping[str, str]:
        """Mapping as TOML."""
        return {self.name: mapping_toml(mapping_of_columns(self.table, self.columns))}

    def keeps(self, name: str, present: str) -> bool:
        """Whether a mapping of this name was changed since it was written."""
        return present != self.files().get(name)
