"""Requests for where measured numbers go: entries of a rig, rows of a table of own runs, a table of all numbers."""

import csv
import io
from collections.abc import Mapping
from typing import Any, Final

from sonolube import __version__
from sonolube.browser.requests import Places
from sonolube.browser.uploads import named_uploads, uploaded
from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping, read_mapping
from sonolube.measurement.run_rows import rows_of_table, run_rows_csv
from sonolube.report.measured.further_use import result_numbers, result_rig_entries, result_run_rows
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
    rows = [row for result in results for row in result_run_rows(result, conditions)]
    with named_uploads():
        if payload.get("table"):
            rows = rows_of_table(_path(payload["table"], places), mapping=_mapping(payload.get("mapping")))
        before = rows_of_table(_path(payload["runs"], places)) if payload.get("runs") else []
    entries = {key: entry for result in results for key, entry in result_rig_entries(result, conditions).items()}
    return {
        "entries": [{"key": key, "text": text} for key, text in entries.items()],
        "csv": run_rows_csv([*before, *rows]) if before or rows else "",
        "added": len(rows),
        "runs": len(before) + len(rows),
    }


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


def _path(file: Any, places: Places) -> Any:
    """Path of an upload under its own name."""
    name, path = uploaded(file, places)
    return file_path(NamedBytes(name, path.read_bytes()))


def _mapping(text: Any) -> RecordingMapping | None:
    """Mapping of a text; None for none."""
    return read_mapping(file_path(NamedBytes("mapping.toml", str(text).encode()))) if text else None
