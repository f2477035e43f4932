"""Command `mapping`: the task with a question on a terminal for each column that its heading does not tell."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sonolube.cli.console.options import ask, is_terminal
from sonolube.cli.generated import command_of
from sonolube.errors import InvalidInput
from sonolube.measurement.column_statements import mapping_of_statements
from sonolube.measurement.export_columns import export_with_times
from sonolube.measurement.recordings.reader import recipe_of_runs
from sonolube.measurement.run_headings import LEFT_OUT, samples, stated_columns
from sonolube.measurement.run_table import run_text
from sonolube.tasks.table import task_named


def _completed(given: dict[str, Any], typed: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments with the answers to questions for columns of unknown meaning."""
    del typed
    if "file" not in given:
        raise InvalidInput("missing FILE, a table of runs or a text export of an instrument")
    if not is_terminal():
        return given
    path = given["file"]
    answers = dict(given.get("column") or {})
    if (export := export_with_times(Path(path))) is not None:
        for each in export.columns:
            if each.is_asked and each.label and each.statement == LEFT_OUT and each.label not in answers:
                answers[each.label] = _asked(each.label, list(each.cells))
        return given | {"column": answers}
    table, _ = run_text(path)
    if not answers and recipe_of_runs(Path(path), table.labels) is not None:
        return given
    for label, found in stated_columns(table, answers, path).items():
        if found is None:
            answers[label] = _asked(label, samples(table, label))
    return given | {"column": answers}


def _asked(label: str, cells: list[str]) -> str:
    """Statement about a column that can be read."""
    holds = "; ".join(cells) or "empty cells"
    return ask(
        f"column {label!r}",
        f"Column {label!r} ({holds}): quantity and unit, such as 'friction_force N', or with a gain, such as"
        " 'friction_force 2 N/V', or - to leave it out",
        LEFT_OUT,
        lambda text: None if text.strip() == LEFT_OUT else mapping_of_statements({label: text}),
    )


mapping = command_of(task_named("mapping"), complete=_completed)
