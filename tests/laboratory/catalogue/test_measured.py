"""Friction of recorded runs: means and uncertainties of levels by hand, rows of runs, and recordings taken in."""

from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from pytest import approx

from sonolube.errors import InvalidInput
from sonolube.laboratory import Block, Channel
from sonolube.laboratory.catalogue import take_in
from sonolube.laboratory.catalogue.measured import (
    _cell,
    _conditions,
    _mean_of,
    _recordings,
    _separate_levels,
    _steady_change,
    catalogued_runs,
    level_rows,
)
from sonolube.laboratory.records import new_run, read_run


def level(change: float) -> xr.Dataset:
    """A minute at 400 Hz of 0.5 N with white noise of 30 mN and a steady change of the force. [N]"""
    time = np.arange(24_000) / 400
    noise = 0.03 * np.random.default_rng(5).standard_normal(time.size)
    return xr.Dataset({"friction_force": ("time", 0.5 + change * time / time[-1] + noise)}, {"time": time})


def test_a_force_without_a_steady_change_has_the_uncertainty_of_its_scatter() -> None:
    found = _mean_of(level(0.0), None)
    assert found is not None
    assert found[1] == approx(0.03 / np.sqrt(24_000), rel=0.3)


@pytest.mark.parametrize("change", [-0.2, 0.05])
def test_half_of_a_steady_change_counts_as_drift_of_the_gauge(change: float) -> None:
    found = _mean_of(level(change), None)
    assert found is not None
    level_found, uncertainty = found
    assert level_found == approx(0.5 + change / 2, abs=2e-3)
    assert uncertainty == approx(abs(change) / 2, rel=0.1)


def test_too_few_samples_behind_the_settling_have_no_mean() -> None:
    time = np.arange(300) / 100  # 0.5 s are left out: 50 samples
    force = xr.Dataset({"friction_force": ("time", np.where(time < 0.5, 9.0, 2.0))}, {"time": time})
    found = _mean_of(force.isel(time=slice(0, 70)), None)
    assert found is not None
    assert found[0] == approx(2.0)
    assert _mean_of(force.isel(time=slice(0, 69)), None) is None


def test_the_wobble_of_whole_turns_is_no_uncertainty_of_the_mean() -> None:
    time = np.arange(4000) / 200  # 19.5 s behind the settling
    noise = 0.01 * np.random.default_rng(5).standard_normal(time.size)
    wobbling = 2.0 + 0.4 * np.cos(2 * np.pi * 1.5 * time) + noise
    level = xr.Dataset({"friction_force": ("time", wobbling)}, {"time": time})
    without, found = _mean_of(level, None), _mean_of(level, 1.5)
    assert without is not None
    assert found is not None
    assert found[0] == approx(2.0, abs=2e-3)
    assert found[1] == approx(0.01 / np.sqrt(3900), rel=0.3)
    assert without[1] > 3 * found[1]


def test_half_of_the_change_is_that_along_the_line_of_least_squares() -> None:
    place = np.linspace(-1.0, 1.0, 101)
    for slope in (3.0, -3.0):
        half, rest = _steady_change(2.0 + slope * place)
        assert half == approx(3.0)
        assert rest == approx(2.0)
    half, _ = _steady_change(1.0 + place**2)
    assert half == approx(0.0, abs=1e-12)


def test_a_query_names_its_folder_and_conditions_with_commas_behind_a_backslash() -> None:
    text = r"catalogue: material = brass\,oiled , tag=a,tag=b,,in= over/there ,load=3N..6N"
    assert _conditions(text) == (
        Path("over/there"),
        {"material": ["brass,oiled"], "tag": ["a", "b"], "load": ["3N..6N"]},
    )
    assert _conditions("catalogue:") == (Path("runs"), {})


def test_a_cell_is_a_number_or_empty() -> None:
    assert [_cell(value) for value in (None, float("nan"), float("inf"), 2, 0.0)] == ["", "", "", "2.0", "0.0"]


def test_levels_without_one_at_rest_have_each_its_own_mean_behind_its_settling() -> None:
    time = np.arange(600) / 100
    volts = np.where(time < 3.0, 10.0, 20.0)
    force = np.where(time % 3.0 < 0.5, 9.0, np.where(time < 3.0, 0.6, 0.3))
    data = {"friction_force": ("time", force), "voltage_peak_to_peak": ("time", volts)}
    found = list(_separate_levels(xr.Dataset(data, {"time": time})))
    assert [each[:2] for each in found] == [(10.0, approx(0.6)), (20.0, approx(0.3))]
    assert [each[3:] for each in found] == [(None, None)] * 2
    short = xr.Dataset(data, {"time": time}).isel(time=slice(0, 351))
    assert [each[0] for each in _separate_levels(short)] == [10.0]  # one sample at 20 V is none
    with pytest.raises(InvalidInput, match="its voltage has no levels"):
        list(_separate_levels(xr.Dataset({"friction_force": ("time", force)}, {"time": time})))


FORCE = Channel(name="friction_force", quantity="friction_force")
HEAT = Channel(name="temperature", quantity="temperature")


def run_of(
    parent: Path,
    stretches: list[tuple[dict[str, Any], float]],
    *,
    channel: Channel = FORCE,
    direction: str | float | None = None,
) -> Path:
    """Folder of a run of 4 s each with what was set and the friction then."""
    facts: dict[str, Any] = {"block": 2, "nominal_area": 1.5e-6}
    facts |= {} if direction is None else {"vibration_direction": direction}
    recorder = new_run(parent, title="Levels", protocol="", facts=facts)
    recorder.note("prepared")
    recorder.begin([channel], sample_rate=100.0)
    rng = np.random.default_rng(1)
    for number, (told, force) in enumerate(stretches):
        for kind in ("conditions", "motor", "drive"):
            if facts_of := {key: value for key, value in told.items() if key in KEYS[kind]}:
                recorder.note(kind, sample=400 * number, **facts_of)
        values = force + 1e-3 * rng.standard_normal((400, 1))
        recorder.append(Block(first_sample=400 * number, sample_rate=100.0, values=values))
    return recorder.finish("completed").folder


KEYS = {
    "conditions": ("normal_load", "lubricant"),
    "motor": ("sliding_speed", "rotation_speed"),
    "drive": ("voltage_peak_to_peak", "frequency"),
}
SLIDES: dict[str, Any] = {"normal_load": 4.0, "sliding_speed": 0.03, "rotation_speed": 0.5, "voltage_peak_to_peak": 0.0}


def test_a_row_has_what_was_set_and_the_friction_of_each_level(tmp_path: Path) -> None:
    driven = {"voltage_peak_to_peak": 20.0, "frequency": 21e3}
    folder = run_of(tmp_path, [(SLIDES, 1.0), (driven, 0.4), ({"voltage_peak_to_peak": 0.0}, 1.0)])
    (head, *rows), left_out = level_rows([folder])
    assert left_out == []
    assert head[:6] == [
        *("run", "block", "normal_load [N]", "sliding_speed [m/s]", "voltage_peak_to_peak [V]", "frequency [Hz]")
    ]
    assert head[10:] == [
        *("nominal_area [m2]", "study", "source", "note", "vibration_direction [rad]"),
        *("friction_coefficient", "friction_coefficient_uncertainty"),
    ]
    told = [dict(zip(head, row, strict=True)) for row in rows]
    assert {(row["run"], row["block"], row["nominal_area [m2]"], row["study"], row["source"]) for row in told} == {
        (folder.name, "2", "1.5e-06", "Levels", str(folder))
    }
    assert {(row["normal_load [N]"], row["sliding_speed [m/s]"]) for row in told} == {("4.0", "0.03")}
    at = {row["voltage_peak_to_peak [V]"]: row for row in told}
    assert float(at["20.0"]["friction_force [N]"]) == approx(0.4, abs=2e-3)
    assert float(at["20.0"]["friction_reduction"]) == approx(0.6, abs=4e-3)
    assert 0 < float(at["20.0"]["friction_force_uncertainty [N]"]) < 2e-3
    assert 0 < float(at["20.0"]["friction_reduction_uncertainty"]) < 4e-3
    assert at["20.0"]["frequency [Hz]"] == "21000.0"
    assert {row["frequency [Hz]"] for row in told if row["voltage_peak_to_peak [V]"] == "0.0"} <= {""}


def test_a_stretch_of_one_voltage_has_a_force_without_a_reduction(tmp_path: Path) -> None:
    folder = run_of(tmp_path, [(SLIDES | {"voltage_peak_to_peak": 15.0, "frequency": 21e3}, 0.4)])
    (_, row), left_out = level_rows([folder])
    assert left_out == []
    assert row[2:6] == ["4.0", "0.03", "15.0", "21000.0"]
    assert float(row[6]) == approx(0.4, abs=1e-3)
    assert row[8:10] == ["", ""]


def test_what_is_lubricated_or_has_no_friction_is_left_out_with_a_line(tmp_path: Path) -> None:
    oiled = run_of(tmp_path, [(SLIDES | {"lubricant": "oil"}, 0.4)])
    warm = run_of(tmp_path, [(SLIDES, 0.4)], channel=HEAT)
    rows, left_out = level_rows([oiled, warm, tmp_path / "none"])
    assert len(rows) == 1
    assert left_out == [
        f"{oiled.name}: part 1 of the recording left out: lubricated, and models of friction are of dry contacts",
        f"{warm.name}: part 1 is left out: it has no channel friction_force, nor friction_coefficient",
        f"none: left out: {tmp_path / 'none'}: holds no run: it has no file run.json",
    ]


def recording(path: Path, **columns: np.ndarray) -> None:
    """Table of 5 s at 100 Hz with a column a channel."""
    heads = ["time (s)", *(f"{name} ({UNITS[name]})" if name in UNITS else name for name in columns)]
    values = np.stack([np.arange(500) / 100, *columns.values()], 1)
    np.savetxt(path, values, delimiter=",", header=",".join(heads), comments="")


@pytest.mark.parametrize(
    ("direction", "angle", "word"),
    [("along", 0.0, "along"), ("across", pi / 2, "across"), ("normal", np.nan, "normal"), (0.5, 0.5, None)],
)
def test_rows_have_the_direction_of_their_rig(
    direction: str | float, angle: float, word: str | None, tmp_path: Path
) -> None:
    run_of(tmp_path, [(SLIDES, 1.0), ({"voltage_peak_to_peak": 20.0, "frequency": 21e3}, 0.4)], direction=direction)
    found = catalogued_runs(f"catalogue:in={tmp_path}")
    assert found["vibration_direction"].to_numpy() == approx(np.full(found.sizes["run"], angle), nan_ok=True)
    if word is not None:
        assert set(found["vibration_direction_word"].to_numpy().tolist()) == {word}


UNITS = {"friction_force": "N", "voltage_peak_to_peak": "V", "temperature": "K"}


def test_recordings_that_were_taken_in_have_the_load_and_speed_of_their_facts(tmp_path: Path) -> None:
    recording(tmp_path / "b.csv", friction_force=np.full(500, 0.4))
    facts: dict[str, float | str] = {"normal_load": 3.0, "sliding_speed": 0.02, "frequency": 21e3, "tags": "old"}
    folder = take_in(tmp_path / "runs", tmp_path / "b.csv", facts=facts)
    (_, row), left_out = level_rows([folder])
    assert left_out == []
    assert row[2:5] == ["3.0", "0.02", ""]  # nobody says whether it vibrated
    assert row[5] == ""
    assert float(row[6]) == approx(0.4)
    run = read_run(folder)
    assert (run.summary.title, run.summary.outcome, run.summary.reason) == ("b", "completed", "")
    assert run.summary.begun == approx((tmp_path / "b.csv").stat().st_mtime, abs=1.0)
    assert [(note.kind, note.facts) for note in run.notes] == [("taken in", {"source": str(tmp_path / "b.csv")})]
    assert run.known.referenced == (str(tmp_path / "b.csv"),)
    assert not (folder / ".reserve").exists()
    half = np.repeat([10.0, 20.0], 250)
    recording(tmp_path / "c.csv", friction_force=np.repeat([0.6, 0.3], 250), voltage_peak_to_peak=half)
    stepped = take_in(tmp_path / "runs", tmp_path / "c.csv", facts=facts, title="Steps")
    (_, *rows), left_out = level_rows([stepped])
    assert [(row[4], row[5], round(float(row[6]), 6)) for row in rows] == [
        ("10.0", "21000.0", 0.6),
        ("20.0", "21000.0", 0.3),
    ]
    assert {row[11] for row in rows} == {"Steps"}


def test_a_coefficient_of_friction_counts_by_the_load_of_the_facts(tmp_path: Path) -> None:
    recording(tmp_path / "b.csv", friction_coefficient=np.full(500, 0.4))
    folder = take_in(tmp_path / "runs", tmp_path / "b.csv", facts={"normal_load": 3.0, "sliding_speed": 0.02})
    (_, row), left_out = level_rows([folder])
    assert left_out == []
    assert float(row[6]) == approx(1.2)


def test_a_coefficient_of_friction_without_a_load_counts_as_it_is(tmp_path: Path) -> None:
    voltage = np.repeat([0.0, 20.0], 250)
    recording(tmp_path / "b.csv", friction_coefficient=np.repeat([0.4, 0.1], 250), voltage_peak_to_peak=voltage)
    folder = take_in(tmp_path / "runs", tmp_path / "b.csv", facts={"sliding_speed": 0.02, "frequency": 20e3})
    (head, *rows), left_out = level_rows([folder])
    assert left_out == []
    found = [dict(zip(head, row, strict=True)) for row in rows]
    assert [float(row["friction_coefficient"]) for row in found] == approx([0.4, 0.1], abs=1e-6)
    assert {row["friction_force [N]"] for row in found} == {""}
    runs = catalogued_runs(f"catalogue:in={tmp_path / 'runs'}")
    assert 1 - runs["friction_reduction"].to_numpy() == approx([0.25], abs=1e-3)


def test_of_a_folder_the_recordings_alone_are_taken_in_by_name(tmp_path: Path) -> None:
    old = tmp_path / "old"
    (old / "deeper").mkdir(parents=True)
    for name in ("b.csv", "a.csv", ".hidden.csv"):
        recording(old / name, friction_force=np.full(500, 0.4))
    (old / "notes.md").write_text("time,friction_force\n")
    (old / "other.bin").write_bytes(b"\0" * 100)
    folder = take_in(tmp_path / "runs", old)
    assert read_run(folder).known.referenced == (str(old / "a.csv"), str(old / "b.csv"))
    assert read_run(folder).summary.title == "old"


def test_recordings_of_a_folder_are_parts_in_the_order_of_their_names_however_the_disk_lists_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in "abc":
        recording(tmp_path / f"{name}.csv", friction_force=np.full(500, 0.4))
    listed = [tmp_path / f"{name}.csv" for name in "cab"]
    monkeypatch.setattr(Path, "iterdir", lambda path: iter(listed))
    assert _recordings(tmp_path) == sorted(listed)


def test_a_stretch_of_one_voltage_is_not_searched_for_steps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def steps(piece: xr.Dataset, *, rotation_speed: float | None) -> tuple[()]:
        asked.append((piece.sizes["time"], rotation_speed))
        return ()

    monkeypatch.setattr("sonolube.laboratory.catalogue.measured.analyse_voltage_steps", steps)
    monkeypatch.setattr("sonolube.laboratory.catalogue.measured.analyse_rotation_speed", lambda piece: 0.25)
    run = run_of(tmp_path, [(SLIDES, 0.4)])
    assert len(level_rows([run])[0]) == 2
    assert asked == []
    driven = run_of(tmp_path, [(SLIDES, 1.0), ({"voltage_peak_to_peak": 20.0, "frequency": 21e3}, 0.4)])
    (_, *rows), _ = level_rows([driven])
    assert asked == [(800, 0.25)]
    # steps that are none leave the means of both levels
    assert [row[4:6] for row in rows] == [["0.0", ""], ["20.0", "21000.0"]]
    assert [float(row[6]) for row in rows] == approx([1.0, 0.4], abs=2e-3)


PROTOCOL = """title = "speeds"
source = "none"
[limits]
voltage_maximum = "30 V"
duration_maximum = "60 s"
[metadata]
normal_load = "3 N"
"""
SPEED = '[[steps]]\nkind = "motor_speed"\nsliding_speed = "{} mm/s"\n[[steps]]\nkind = "wait"\nduration = "4 s"\n'


@pytest.mark.parametrize(("speeds", "lines"), [((20, 40), 1), ((20,), 0)])
def test_of_a_run_without_set_points_several_speeds_are_said_once_to_be_unknown(
    speeds: tuple[int, ...], lines: int, tmp_path: Path
) -> None:
    text = PROTOCOL + "".join(SPEED.format(speed) for speed in speeds)
    recorder = new_run(tmp_path, title="Levels", protocol=text, facts={"groove_diameter": 0.05})
    for part in range(2):
        recorder.begin([FORCE], sample_rate=100.0)
        values = 0.5 + 1e-3 * np.random.default_rng(part).standard_normal((400, 1))
        recorder.append(Block(first_sample=0, sample_rate=100.0, values=values))
        recorder.end()
    folder = recorder.finish("completed").folder
    rows, left_out = level_rows([folder])
    unknown = f"{folder.name}: has no set points, so that load or speed of its rows is not known"
    assert left_out == [unknown] * lines
    assert [row[3] for row in rows[1:]] == (["0.02"] if lines == 0 else [""]) * 2
