"""Catalogue: runs by material, load, speed, date, tag and text; the folders are the truth, the index is rebuilt."""

import sqlite3
import time
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from pytest import MonkeyPatch

from sonolube.errors import InvalidInput, UnknownName
from sonolube.laboratory import Block, Channel
from sonolube.laboratory.catalogue import CATALOGUE, catalogued_runs, query_from, query_runs, take_in
from sonolube.laboratory.records import new_run

FORCE = Channel(name="friction_force", quantity="friction_force")
PROTOCOL = """
title = "Voltage steps"
source = "test"
[limits]
voltage_maximum = "100 V"
duration_maximum = "1 h"
[metadata]
pin_material = "brass_c360"
disc_material = "stainless_steel_304"
normal_load = "5 N"
[[steps]]
kind = "motor_speed"
sliding_speed = "20 mm/s"
[[steps]]
kind = "wait"
duration = "1 s"
"""


def run_of(
    parent: Path,
    *,
    levels: Mapping[float, float] | None = None,
    title: str = "Voltage steps",
    protocol: str = PROTOCOL,
    **facts: str | float,
) -> Path:
    """Folder of a run with 3 s at each voltage, at which the friction has a mean, with little noise."""
    recorder = new_run(parent, title=title, protocol=protocol, facts=facts)
    recorder.begin([FORCE], sample_rate=200.0)
    rng = np.random.default_rng(0)
    for number, (voltage, force) in enumerate((levels or {0.0: 1.0, 10.0: 0.6}).items()):
        recorder.note("drive", sample=600 * number, voltage_peak_to_peak=voltage, frequency=22e3)
        values = force + 0.01 * rng.standard_normal((600, 1))
        recorder.append(Block(first_sample=600 * number, sample_rate=200.0, values=values))
    return recorder.finish("completed").folder


def names(parent: Path, **conditions: str) -> list[str]:
    """Names of the runs that conditions find."""
    found = query_runs(parent, query_from({key: [value] for key, value in conditions.items()}))
    return [entry.summary.folder.name for entry in found.entries]


@pytest.mark.parametrize(
    ("condition", "value", "finds"),
    [
        ("material", "brass", [0, 1]),
        ("material", "stainless", [0, 1, 2]),
        ("material", "m50", []),
        ("load", "5N", [0]),
        ("load", "3N..6N", [0, 1]),
        ("load", "5.5N..", [1, 2]),
        ("load", "..5N", [0]),
        ("speed", "10mm/s..30mm/s", [0, 1, 2]),
        ("speed", "0.2m/s", []),
        ("tag", "map", [1, 2]),
        ("tag", "ma", []),
        ("text", "Voltage STEPS", [0, 1]),
        ("outcome", "completed", [0, 1, 2]),
        ("outcome", "failed", []),
    ],
)
def test_each_condition_finds_its_runs(tmp_path: Path, condition: str, value: str, finds: list[int]) -> None:
    other = PROTOCOL.replace("brass_c360", "aluminium_2024").replace("Voltage", "V")
    folders = [
        run_of(tmp_path),
        run_of(tmp_path, normal_load=6.0, tags="map, first"),
        run_of(tmp_path, title="Other", protocol=other, normal_load=12.0, tags="Map"),
    ]
    assert names(tmp_path, **{condition: value}) == [folders[index].name for index in finds]


def test_dates_bound_the_runs(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    for moment in (1795000000.0, 1796000000.0):
        monkeypatch.setattr(time, "time", lambda moment=moment: moment)
        run_of(tmp_path)
    assert len(names(tmp_path, since="2026-11-01")) == 2
    assert names(tmp_path, since="2026-11-20") == ["20261130T005320Z-voltage-steps"]
    assert names(tmp_path, until="2026-11-20T00:00+01:00") == ["20261118T110640Z-voltage-steps"]


def test_new_changed_and_removed_folders_are_followed(tmp_path: Path) -> None:
    first, second = run_of(tmp_path), run_of(tmp_path)
    assert len(names(tmp_path)) == 2
    facts = (first / "run.json").read_text()
    (first / "run.json").write_text(facts.replace('"facts": {}', '"facts": {"tags": "redone"}'))
    assert names(tmp_path, tag="redone") == [first.name]
    second.rename(tmp_path.parent / second.name)
    assert names(tmp_path) == [first.name]


@pytest.mark.parametrize("damage", ["garbage", "cut", "old", "empty", "no table"])
def test_a_damaged_or_old_index_is_built_anew(tmp_path: Path, damage: str) -> None:
    run_of(tmp_path)
    before = names(tmp_path)
    path = tmp_path / CATALOGUE
    if damage in ("old", "no table"):
        with sqlite3.connect(path) as connection:
            connection.execute("PRAGMA user_version=99" if damage == "old" else "DROP TABLE runs")
        connection.close()
    else:
        content = path.read_bytes()
        path.write_bytes({"garbage": b"x" * 5000, "cut": content[:5000], "empty": b""}[damage])
    assert names(tmp_path) == before
    assert names(tmp_path) == before


def test_an_index_that_is_whole_is_used_again_without_a_word(tmp_path: Path) -> None:
    run_of(tmp_path)
    assert query_runs(tmp_path).caveats == ()
    made = (tmp_path / CATALOGUE).stat().st_ino
    assert query_runs(tmp_path).caveats == ()
    assert (tmp_path / CATALOGUE).stat().st_ino == made
    assert sorted(path.name for path in tmp_path.glob("catalogue*")) == [CATALOGUE]


def test_a_damaged_index_is_told_and_kept_aside(tmp_path: Path) -> None:
    run_of(tmp_path)
    (tmp_path / CATALOGUE).write_bytes(b"x" * 5000)
    assert query_runs(tmp_path).caveats == ("catalogue.sqlite was damaged or of another version, and is built anew",)
    assert (tmp_path / "catalogue.sqlite.damaged").read_bytes() == b"x" * 5000


def test_the_database_of_another_program_is_left_alone(tmp_path: Path) -> None:
    run_of(tmp_path)
    with sqlite3.connect(tmp_path / CATALOGUE) as connection:
        connection.execute("CREATE TABLE mine (x)")
    connection.close()
    before = (tmp_path / CATALOGUE).read_bytes()
    assert len(names(tmp_path)) == 1
    assert (tmp_path / CATALOGUE).read_bytes()[96:] == before[96:] or b"mine" in (tmp_path / CATALOGUE).read_bytes()


def test_a_run_with_damaged_facts_is_told_and_the_others_found(tmp_path: Path) -> None:
    (run_of(tmp_path) / "run.json").write_text("{")
    run_of(tmp_path)
    found = query_runs(tmp_path)
    assert (len(found.entries), len(found.caveats)) == (1, 1)


def test_recordings_made_elsewhere_are_taken_in_where_they_lie(tmp_path: Path) -> None:
    old = tmp_path / "old"
    old.mkdir()
    moments = 0.01 * np.arange(500)
    rows = np.stack([moments, 0.4 + 0.0 * moments], 1)
    np.savetxt(old / "a.csv", rows, delimiter=",", header="time (s),friction_force (N)", comments="")
    (old / "notes.md").write_text("not a recording")
    folder = take_in(tmp_path / "runs", old, facts={"pin_material": "brass_c360", "normal_load": 3.0})
    assert [path.name for path in folder.iterdir() if path.suffix == ".csv"] == []
    assert names(tmp_path / "runs", material="brass", load="3N") == [folder.name]
    (old / "a.csv").write_text("time,friction_force\n0,1\n1,2\n")
    assert "was changed" in query_runs_caveat(folder)
    with pytest.raises(InvalidInput, match="no recording"):
        take_in(tmp_path / "runs", old / "notes.md")


def query_runs_caveat(folder: Path) -> str:
    """Caveats of a run."""
    from sonolube.laboratory.records import read_run

    return " ".join(read_run(folder).caveats)


@pytest.mark.parametrize(
    ("conditions", "reason"),
    [
        ({"load": ["5"]}, "load"),
        ({"load": ["6N..3N"]}, "lower to the higher"),
        ({"load": ["1N", "2N"]}, "2 times"),
        ({"since": ["yesterday"]}, "must be a date"),
    ],
)
def test_conditions_that_cannot_be_read_are_refused(conditions: Mapping[str, list[str]], reason: str) -> None:
    with pytest.raises(InvalidInput, match=reason):
        query_from(conditions)


def test_an_unknown_condition_is_refused_with_the_nearest() -> None:
    with pytest.raises(UnknownName, match="did you mean material"):
        query_from({"matrial": ["brass"]})


def test_a_query_is_a_table_of_runs_with_the_friction_of_each_voltage(tmp_path: Path) -> None:
    run_of(tmp_path, levels={0.0: 1.0, 10.0: 0.6, 20.0: 0.3})
    runs = catalogued_runs(f"catalogue:material=brass,load=5N,in={tmp_path}")
    assert np.allclose(runs["voltage_peak_to_peak"], [10.0, 20.0])
    assert np.allclose(runs["friction_reduction"], [0.4, 0.7], atol=0.01)
    assert np.allclose(runs["sliding_speed"], 0.02)
    assert np.allclose(runs["normal_load"], 5.0)
    assert np.allclose(runs["frequency"], 22e3)


def test_runs_with_and_without_vibration_on_their_own_meet_by_load_and_speed(tmp_path: Path) -> None:
    run_of(tmp_path, levels={0.0: 1.0})
    run_of(tmp_path, levels={10.0: 0.6})
    runs = catalogued_runs(f"catalogue:in={tmp_path}")
    assert np.allclose(runs["friction_reduction"], [0.4], atol=0.01)


@pytest.mark.parametrize(
    ("query", "reason"), [("material=gold", "finds none of 1 runs"), ("material", "must be KEY=VALUE")]
)
def test_a_query_that_finds_nothing_is_refused(tmp_path: Path, query: str, reason: str) -> None:
    run_of(tmp_path)
    with pytest.raises(InvalidInput, match=reason):
        catalogued_runs(f"catalogue:in={tmp_path},{query}")


def test_a_load_or_speed_that_is_no_range_allows_one_percent() -> None:
    asked = query_from({"load": ["5 N"], "speed": ["20 mm/s"]})
    assert [values[0] for _, values in asked] == ["load", "speed"]
    assert [values[1:] for _, values in asked] == [pytest.approx((4.95, 5.05)), pytest.approx((19.8e-3, 20.2e-3))]
