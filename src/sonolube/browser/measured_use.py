"""Requests for where measured numbers go: entries of a rig, the table of own runs, a table of all numbers."""

import csv
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

from sonolube import __version__
from sonolube.browser.requests import Places
from sonolube.browser.uploads import named_uploads, uploaded
from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping, read_mapping
from sonolube.measurement.run_columns import RUN_COLUMNS, SOURCE, SWITCH
from sonolube.measurement.run_sheet import (
    RunSheet,
    joined,
    read_sheet,
    sheet_of_rows,
    with_cell,
    with_switch,
    without_row,
)
from sonolube.measurement.run_sheet_file import SheetFile, store_sheet, stored_sheet
from sonolube.report.measured.further_use import result_numbers, result_rig_entries, result_run_rows
from sonolube.rig.file.rig_folder import RUNS_FILE
from sonolube.tasks.files import NamedBytes, file_path
from sonolube.text.units import to_si
from sonolube.vocabulary import quantities

_CONDITIONS: Final = (
    "voltage_peak_to_peak",
    "vibration_amplitude",
    "frequency",
    "sliding_speed",
    "normal_load",
    "vibration_direction",
)
_MAX_RESULTS: Final = 1000


def measured_use(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Entries of a rig and rows of own runs by the answer of a measurement, or by a table of runs.

    A request has `results` (of the answer in JSON) with `conditions` (texts by name) under which it was measured, or
    `table` (an upload) with `mapping` (text of a mapping), and optionally `runs`, the upload of the table to append to.
    """
    given = payload.get("conditions") or {}
    if not isinstance(given, Mapping):
        raise InvalidInput("conditions: give texts by name", key="conditions")
    conditions = {name: _quantity(name, given[name]) for name in _CONDITIONS if given.get(name)}
    results = payload.get("results") or []
    if not isinstance(results, list) or len(results) > _MAX_RESULTS or not all(isinstance(e, Mapping) for e in results):
        raise InvalidInput("results: give those of an answer in JSON", key="results")
    sheet = sheet_of_rows([row for result in results for row in result_run_rows(result, conditions)])
    with named_uploads():
        if payload.get("table"):
            name, path = _file(payload["table"], places)
            sheet = read_sheet(path, mapping=_mapping(payload.get("mapping")), source=name)
        before = read_sheet(_file(payload["runs"], places)[1]) if payload.get("runs") else RunSheet()
    entries = {key: entry for result in results for key, entry in result_rig_entries(result, conditions).items()}
    every, added = joined(before, sheet)
    return {"entries": [{"key": key, "text": text} for key, text in entries.items()]} | _sheet_object(every, added)


def own_runs(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Table of own runs after a change: cells by row and column, the rows that are used, and the table as text.

    A request has `runs` (an upload, or nothing for an empty table) and one change at most: `text` (rows of a
    spreadsheet to add), `edit` (`row` from 0, `name`, `text`; a row behind the last one is added), `switch` (`row`,
    `used`) or `remove` (a row).
    """
    with named_uploads():
        sheet = read_sheet(_file(payload["runs"], places)[1]) if payload.get("runs") else RunSheet()
        added = 0
        if payload.get("text"):
            sheet, added = joined(sheet, _pasted(str(payload["text"]), sheet))
    if isinstance(edit := payload.get("edit"), Mapping):
        sheet = with_cell(sheet, row=_row(edit), name=str(edit.get("name")), text=str(edit.get("text", "")))
    if isinstance(switch := payload.get("switch"), Mapping):
        sheet = with_switch(sheet, row=_row(switch), is_used=bool(switch.get("used")))
    if payload.get("remove") is not None:
        sheet = without_row(sheet, row=_row({"row": payload["remove"]}))
    return _sheet_object(sheet, added)


def folder_runs(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Table of own runs in the folder of the rig, with its state, after it was written where that is asked for.

    A request has nothing, or `keep` (an upload, or null for an empty table) and `state`, as of the table that was read.
    """
    if not places.folder:
        raise InvalidInput("the workbench was not opened with the folder of a rig")
    path = Path(places.folder, RUNS_FILE)
    if "keep" not in payload:
        sheet, file = stored_sheet(path)
        return _sheet_object(sheet, 0) | {"state": file.state}
    with named_uploads():
        sheet = read_sheet(_file(payload["keep"], places)[1]) if payload["keep"] else RunSheet()
    file = store_sheet(sheet, SheetFile(path=path, state=str(payload.get("state", ""))))
    return _sheet_object(sheet, 0) | {"state": file.state}


def _sheet_object(sheet: RunSheet, added: int) -> dict[str, Any]:
    """Table of own runs as a page shows it, with the number of rows that were added."""
    used = [sheet.is_used(row) for row in range(len(sheet.rows))]
    return {
        "csv": sheet.csv(),
        "added": added,
        "runs": len(sheet.rows),
        "used": used,
        "switched_off": used.count(False),
        "names": sheet.names,
        "headings": sheet.headings,
        "rows": sheet.rows,
        "choices": [(column.name, column.heading) for column in RUN_COLUMNS if column.name != SWITCH],
    }


def _row(change: Mapping[str, Any]) -> int:
    """Number of a row of a change."""
    row = change.get("row")
    if not isinstance(row, int) or isinstance(row, bool):
        raise InvalidInput(f"row: give a whole number, got {str(row)[:40]!r}", key="row")
    return row


def _pasted(text: str, sheet: RunSheet) -> RunSheet:
    """Rows of a spreadsheet as text, with headings or under those of the table."""
    path = file_path(NamedBytes("pasted.txt", text.encode()))
    try:
        return read_sheet(path, source="pasted")
    except InvalidInput:
        width = len(text.splitlines()[0].split("\t"))
        names = [name for name in sheet.names if name not in (SOURCE, SWITCH)]
        if width != len(names):
            raise
    headings = [heading for heading, name in zip(sheet.headings, sheet.names, strict=True) if name in names]
    path = file_path(NamedBytes("pasted.txt", "\n".join(["\t".join(headings), text]).encode()))
    return read_sheet(path, source="pasted")


def measured_table(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Numbers of several answers of measurements as one table of comma-separated values, in SI.

    A request has `answers`, a list of objects with `name` (of the file), `task` and `answer` (in JSON).
    """
    del places
    answers = payload.get("answers")
    if not isinstance(answers, list) or not all(isinstance(each, Mapping) for each in answers):
        raise InvalidInput("answers: give a list of answers in JSON", key="answers")
    out = io.StringIO()
    tasks = ", ".join(dict.fromkeys(str(each.get("task", "")) for each in answers))
    out.write(f"# sonolube {__version__}: {' '.join(tasks.split())}\n")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["file", "part", "quantity", "value", "standard uncertainty", "unit"])
    for each in answers:
        answer = each.get("answer")
        results = answer.get("results") if isinstance(answer, Mapping) else None
        for result in results if isinstance(results, list) else []:
            if isinstance(result, Mapping):
                writer.writerows([str(each.get("name", "")), *row] for row in result_numbers(result))
    return {"csv": out.getvalue()}


def _quantity(name: str, text: Any) -> float:
    """Condition in SI, refused by its name."""
    try:
        return float(to_si(str(text), unit=quantities()[name].unit, name=name.replace("_", " ")))
    except InvalidInput as failure:
        raise InvalidInput(str(failure), key=name) from None


def _file(file: Any, places: Places) -> tuple[str, Path]:
    """Name of an upload, and its path under this name."""
    name, path = uploaded(file, places)
    return name, file_path(NamedBytes(name, path.read_bytes()))


def _mapping(text: Any) -> RecordingMapping | None:
    """Mapping of a text; None for none."""
    return read_mapping(file_path(NamedBytes("mapping.toml", str(text).encode()))) if text else None
