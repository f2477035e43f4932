"""Runs on disk as page Lab lists, shows, compares and mends them."""

from collections.abc import Mapping
from pathlib import Path, PurePath
from typing import Any, Final

from sonolube.browser.answers import answer_object
from sonolube.browser.requests import Places
from sonolube.charts import chart_object, chart_tables
from sonolube.errors import InvalidInput
from sonolube.laboratory.catalogue import CatalogueEntry, level_rows, query_runs
from sonolube.laboratory.records import read_run
from sonolube.laboratory.records.run_folder import is_run_folder, read_run_facts
from sonolube.report.results.compared_runs import level_objects, level_table, levels_chart, levels_csv

_MOST: Final = 50  # runs in one table


def runs(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """All runs, the latest first."""
    del payload
    parent = Path(places.runs)
    if not parent.is_dir():
        return {"runs": [], "folder": parent.name, "caveats": []}
    found = query_runs(parent)
    listed = [_listed(entry) for entry in reversed(found.entries)]
    return {"runs": listed, "folder": parent.name, "caveats": list(found.caveats)}


def _listed(entry: CatalogueEntry) -> dict[str, Any]:
    """Run in the list."""
    summary, known = entry.summary, read_run_facts(entry.summary.folder)
    facts = known.facts
    device = facts.get("device_device") or facts.get("device_rig") or facts.get("rig") or ""
    return {
        "id": summary.folder.name,
        "title": summary.title,
        "created": summary.begun,
        "state": summary.outcome,
        "reason": summary.reason,
        "device": str(device),
        "rig": str(facts.get("rig_title", "")),
        "protocol": str(facts.get("protocol", "")),
        "seed": facts.get("seed"),
        "recordings": len(known.recordings) or len(known.referenced),
        "duration": summary.duration,
        "tags": list(entry.tags),
        "version": str(known.versions.get("sonolube", "")),
    }


def shown(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Answer of `lab show` to a run."""
    from sonolube.tasks.lab.run_folders import show

    return answer_object(show(run_folder(payload.get("id"), places)))


def recording(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Path of a part of the recording of a run, and the name under which it is uploaded."""
    folder, part = run_folder(payload.get("id"), places), payload.get("part", 1)
    parts = read_run(folder).recordings
    if not parts:
        raise InvalidInput(f"{folder.name}: has no recording; recover the run where it was killed", key="id")
    if isinstance(part, bool) or not isinstance(part, int) or not 1 <= part <= len(parts):
        raise InvalidInput(f"part: must be one of 1 to {len(parts)}", key="part")
    path = parts[part - 1]
    name = f"{folder.name}{path.suffix}" if len(parts) == 1 else f"{folder.name}-part-{part}{path.suffix}"
    return {"path": str(path), "name": name, "part": part, "parts": len(parts)}


def compared(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Levels of several runs in one table, with what was left out, and the table as CSV."""
    ids = payload.get("runs")
    if not isinstance(ids, list) or not 1 <= len(ids) <= _MOST:
        raise InvalidInput(f"runs: give 1 to {_MOST} runs", key="runs")
    folders = [run_folder(each, places) for each in dict.fromkeys(map(str, ids))]
    rows, left_out = level_rows(folders)
    if len(rows) == 1:
        raise InvalidInput(f"no friction can be measured: {left_out[-1] if left_out else 'the runs have no levels'}")
    caveats = [*left_out, *(f"{folder.name}: {each}" for folder in folders for each in _caveats(folder))]
    levels = level_objects(rows)
    table, chart = level_table(levels), levels_chart(levels)
    return {
        "answer": {"levels": levels, "caveats": caveats},
        "blocks": [
            {"kind": "text", "text": f"{len(levels)} levels of {len(folders)} runs"},
            {"kind": "table", "heads": list(table.heads), "rows": [list(row) for row in table.rows]},
        ],
        "leading_caveats": [],
        "caveats": caveats,
        "assumptions": {},
        "refusals": {},
        "charts": [
            {
                "name": "compared-runs",
                "caption": "Friction over the drive voltage; bars are two standard uncertainties.",
                "chart": chart_object(chart),
                "tables": chart_tables(chart),
            }
        ],
        "table": levels_csv(rows),
        "name": "compared-runs.csv",
    }


def _caveats(folder: Path) -> list[str]:
    """Caveats of a run, and that it is a virtual one."""
    found = read_run(folder)
    virtual = ["a virtual tribometer's friction is no measurement"] if found.facts.get("simulated") else []
    return [*found.caveats, *virtual]


def recovered(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """What was mended of the record of a run that was killed."""
    from sonolube.tasks.lab.run_folders import recover

    folder = str(payload.get("folder", ""))
    if not folder or not is_run_folder(Path(folder)):
        return {"text": "the run was killed before it had a record", "done": [], "run": ""}
    del places  # the record lies where the run was started
    answer = recover(Path(folder))
    if answer.refused:
        raise InvalidInput(next(iter(answer.refused.values())))
    (found,) = answer.recovered.values()
    text = f"recovered: {found.summary.outcome}, {found.summary.samples} samples"
    return {"text": text, "done": list(found.done), "run": Path(folder).name}


def run_folder(name: Any, places: Places) -> Path:
    """Folder of a run by its name.

    Raises
    ------
    InvalidInput
        If there is none.
    """
    text = str(name)
    if PurePath(text).name == text and not text.startswith(".") and "\0" not in text:
        folder = Path(places.runs, text)
        if is_run_folder(folder):
            return folder
    raise InvalidInput(f"runs: there is no run {text[:80]!r}", key="id")
