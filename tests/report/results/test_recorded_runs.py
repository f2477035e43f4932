"""Recorded runs in rows, JSON and dataset: facts, events with their times since the begin, and runs that were found."""

from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from pytest import approx, mark

from sonolube.report.results import recorded_runs as results

FOLDER = Path("runs", "0715")


def note(number: int, **facts: Any) -> Any:
    return SimpleNamespace(kind="trip" if facts else "off", facts=facts, time=1000.0 + number, sample=number or None)


def run(notes: list[Any], *, reason: str = "limit", channels: bool = True) -> Any:
    named = {"f": SimpleNamespace(name="f", described="f [N]", quantity="friction_force", unit="N"),
             "u": SimpleNamespace(name="u", described="u [V]", quantity="voltage", unit="V")}  # fmt: skip
    return SimpleNamespace(
        summary=SimpleNamespace(
            folder=FOLDER, title="Brass", begun=1000.0, begun_text="2026-07-15T10:00:00Z", outcome="stopped",
            reason=reason, samples=50, duration=2.5, gaps=3, channels=("f", "u"),
        ),
        known=SimpleNamespace(
            facts={"operator": "Ann", "load": 3}, versions={"numpy": "2.0"}, files={"own.toml": "0123456789abcdef" * 4}
        ),
        channels=named if channels else {},
        clocks={"slow": (FOLDER / "a.nc", FOLDER / "b.nc")},
        recordings=(FOLDER / "part-1.nc",),
        notes=notes,
    )  # fmt: skip


def test_a_run_in_rows_has_outcome_channels_clocks_facts_versions_and_fingerprints() -> None:
    assert results.run_rows(run([])) == [
        ("begun", "2026-07-15T10:00:00Z"),
        ("outcome", "stopped: limit"),
        ("channels", "f [N], u [V]"),
        ("clock slow", "a.nc, b.nc"),
        ("recorded", "50 samples, 2.5 s, gaps: 3"),
        ("operator", "Ann"),
        ("load", "3"),
        ("version of numpy", "2.0"),
        ("own.toml", "sha256 0123456789abcdef..."),
    ]
    bare = results.run_rows(run([], reason="", channels=False))
    assert bare[1:3] == [("outcome", "stopped"), ("channels", "none")]


@mark.parametrize(("count", "more"), [(40, []), (41, ["  ... and 1 more events"]), (43, ["  ... and 3 more events"])])
def test_forty_events_are_listed_with_their_times_since_the_begin(count: int, more: list[str]) -> None:
    notes = [note(0), note(1, reason="hot", empty="", channel="T"), *map(note, range(2, count))]
    rows = results.event_rows(run(notes))
    assert len(rows) == 40
    assert rows[:3] == [("0.000 s", "off"), ("1.000 s, sample 1", "trip: reason hot, channel T"),
                        ("2.000 s, sample 2", "off")]  # fmt: skip
    assert results.further_events(run(notes)) == more


def test_a_run_in_json_has_facts_fingerprints_channels_and_every_event() -> None:
    assert results.run_object(run([note(1, reason="hot")])) == {
        "folder": str(FOLDER),
        "title": "Brass",
        "begun": "2026-07-15T10:00:00Z",
        "outcome": "stopped",
        "reason": "limit",
        "channels": ["f", "u"],
        "samples": 50,
        "duration": 2.5,
        "gaps": 3,
        "facts": {"operator": "Ann", "load": 3},
        "versions": {"numpy": "2.0"},
        "sha256": {"own.toml": "0123456789abcdef" * 4},
        "quantities": {"f": {"quantity": "friction_force", "unit": "N"}, "u": {"quantity": "voltage", "unit": "V"}},
        "recordings": [str(FOLDER / "part-1.nc")],
        "clocks": {"slow": [str(FOLDER / "a.nc"), str(FOLDER / "b.nc")]},
        "events": [{"kind": "trip", "time": 1001.0, "sample": 1, "facts": {"reason": "hot"}}],
    }


@dataclass
class Summary:
    folder: Path
    outcome: str = "completed"
    duration: float = 90.0
    samples: int = 9
    begun_text: str = "2026-07-15T10:00:00Z"


@dataclass
class Entry:
    summary: Summary
    pin_material: str = ""
    disc_material: str = ""
    normal_loads: tuple[float, ...] = ()
    sliding_speeds: tuple[float, ...] = ()
    tags: tuple[str, ...] = ()
    text: str = "words that are searched"
    normal_load: float | None = None
    sliding_speed: float | None = None


FULL: Any = Entry(
    Summary(FOLDER), "brass", "steel", (3.0, 5.0, 7.0), (0.02,), ("a", "b"), normal_load=None, sliding_speed=0.02
)
EMPTY: Any = Entry(Summary(Path("runs", "0716"), samples=0))


def test_a_run_that_was_found_has_the_ends_of_its_loads_and_dashes_for_what_is_not_known() -> None:
    assert results.found_row(FULL) == ["0715", "completed", "90 s", "brass", "steel", "3 N to 7 N", "20 mm/s", "a, b"]
    assert results.found_row(EMPTY) == ["0716", "completed", "-", "-", "-", "-", "-", "-"]


def test_a_run_that_was_found_in_json_has_no_text_that_is_searched() -> None:
    found = results.found_object(FULL)
    assert "text" not in found
    assert "summary" not in found
    assert (found["folder"], found["begun"], found["outcome"]) == (str(FOLDER), "2026-07-15T10:00:00Z", "completed")
    assert (found["normal_load"], found["sliding_speed"]) == (None, 0.02)
    assert found["normal_loads"] == (3.0, 5.0, 7.0)


def test_runs_that_were_found_are_a_dataset_over_the_names_of_their_folders() -> None:
    found = results.found_runs_dataset([FULL, EMPTY])
    assert found["run"].values.tolist() == ["0715", "0716"]
    assert found["duration"].values == approx([90.0, 90.0])
    assert found["sliding_speed"].values[0] == approx(0.02)
    assert np.isnan(found["sliding_speed"].values[1])
    assert np.isnan(found["normal_load"].values).all()
    assert {name: found[name].attrs["units"] for name in ("duration", "normal_load", "sliding_speed")} == {
        "duration": "s", "normal_load": "N", "sliding_speed": "m/s",
    }  # fmt: skip
    assert found["normal_load"].attrs["long_name"] == "normal load"
    assert found["tags"].values.tolist() == ["a, b", ""]
    assert found["pin_material"].values.tolist() == ["brass", ""]
    assert found["disc_material"].values.tolist() == ["steel", ""]
    assert found["folder"].values.tolist() == [str(FOLDER), str(Path("runs", "0716"))]
