"""Sections of a friction sheet by recordings made by hand: coefficient, cycles, wobble, motor and joined files."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from pytest import MonkeyPatch, approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.rotation import MotorCalibration
from sonolube.measurement.friction.stated_load import StatedLoad
from sonolube.measurement.friction.windows import SteadyStateOnset
from sonolube.report.measured import friction, friction_steps
from sonolube.report.measured.friction import (
    FrictionSettings,
    _rest_caveat,
    _steady_part,
    friction_sheet,
    joined_friction_sheet,
    recording_sheet,
)
from sonolube.report.measured.sheet import Sheet

TIME, FORCE, VELOCITY = "time (s)", "friction_force (N)", "relative_velocity (m/s)"
T = np.arange(4000) / 200


def written(path: Path, **channels: np.ndarray) -> Path:
    np.savetxt(path, np.stack(list(channels.values()), 1), delimiter=",", header=",".join(channels), comments="")
    return path


def values(sheet: Sheet) -> dict[str, float]:
    return {value.name: value.value for value in sheet.values}


def uncertainty(sheet: Sheet, name: str) -> float | None:
    return next(value.uncertainty for value in sheet.values if value.name == name)


def test_a_coefficient_has_its_mean_scatter_windows_and_steady_state_and_no_force(tmp_path: Path) -> None:
    noise = 0.01 * np.random.default_rng(3).standard_normal(T.size)
    path = written(tmp_path / "mu.csv", **{TIME: T, "friction_coefficient": 0.3 + noise})
    sheet = friction_sheet(path, settings=FrictionSettings(sliding_speed=0.02, window_duration=0.5))
    found = values(sheet)
    assert found["mean_coefficient"] == approx(0.3, abs=1e-3)
    assert found["friction_coefficient_deviation"] == approx(0.01, rel=0.05)
    assert found["friction_coefficient_fluctuation"] == approx(0.01, rel=0.05)
    assert found["steady_friction_coefficient"] == approx(0.3, abs=1e-3)
    assert not any("force" in name for name in found)
    assert any("which a stated load gives" in reason for reason in sheet.not_found)
    assert {value.unit for value in sheet.values} == {"", "m", "s"}
    assert next(each for each in sheet.values if each.name == "mean_coefficient").label == (
        "Mean coefficient of the whole recording"
    )


def stepped(folder: Path, *, factor: float = 1.0, channel: str = "friction_coefficient") -> Path:
    """Coefficient of 0.30 without and of 0.12 at 20 V, times a factor, in steps of 5 s; 0.001 of noise."""
    driven = (T // 5) % 2 == 1
    noise = 0.001 * np.random.default_rng(5).standard_normal(T.size)
    channels = {channel: factor * (np.where(driven, 0.12, 0.30) + noise), "voltage_peak_to_peak (V)": 20.0 * driven}
    return written(folder / "steps.csv", **{TIME: T}, **channels)


def steps_of(sheet: Sheet) -> dict[str, list[float | None]]:
    table = next(table for table in sheet.tables if table.name == "steps")
    names = [column.name for column in table.columns]
    return {name: [row[at] for row in table.rows] for at, name in enumerate(names)}  # type: ignore[misc]


def test_a_coefficient_has_its_reduction_at_the_steps_of_the_voltage_without_a_load(tmp_path: Path) -> None:
    sheet = friction_sheet(stepped(tmp_path), settings=FrictionSettings())
    found = steps_of(sheet)
    assert found["friction_coefficient"] == approx([0.30, 0.12, 0.30, 0.12], abs=2e-4)
    assert found["friction_reduction"][1] == approx(0.6, abs=1e-3)
    assert not any("force" in name for name in found)
    assert not any(table.name.startswith("stick_slip") for table in sheet.tables)


@pytest.mark.parametrize(("channel", "factor"), [("friction_coefficient", 1.0), (FORCE, 5.0)])
def test_a_load_gives_force_and_coefficient_with_the_uncertainties_of_load_and_zero(
    channel: str, factor: float, tmp_path: Path
) -> None:
    # At 5 N with 0.1 N and a zero of 0.02 N: sqrt(0.02^2 + (0.30 0.1)^2)/5 = 0.0072111 and
    # sqrt(0.02^2 + (0.12 0.1)^2)/5 = 0.0046648; the zero in the reduction, 0.6 0.02/1.5 = 0.008.
    load = StatedLoad(normal_load=5.0, normal_load_uncertainty=0.1, force_zero_uncertainty=0.02)
    path = stepped(tmp_path, factor=factor, channel=channel)
    found = steps_of(friction_sheet(path, settings=FrictionSettings(load=load)))
    assert found["friction_force"] == approx([1.50, 0.60, 1.50, 0.60], abs=1e-3)
    assert found["friction_coefficient"] == approx([0.30, 0.12, 0.30, 0.12], abs=2e-4)
    uncertainties = found["friction_coefficient_uncertainty"]
    assert uncertainties == approx([0.0072111, 0.0046648, 0.0072111, 0.0046648], rel=5e-3)
    assert found["friction_reduction_uncertainty"][1] == approx(0.008, rel=0.02)


def test_the_levels_of_a_force_have_their_coefficients_under_a_load(tmp_path: Path) -> None:
    noise = 0.01 * np.random.default_rng(3).standard_normal(T.size)
    path = written(tmp_path / "force.csv", **{TIME: T, FORCE: 1.5 + noise})
    load = StatedLoad(normal_load=5.0, normal_load_uncertainty=0.1)
    sheet = friction_sheet(path, settings=FrictionSettings(sliding_speed=0.02, window_duration=0.5, load=load))
    found = values(sheet)
    assert found["mean_coefficient"] == approx(0.3, abs=1e-3)
    assert found["steady_friction_coefficient"] == approx(0.3, abs=1e-3)
    assert uncertainty(sheet, "mean_coefficient") == approx(0.3 * 0.1 / 5.0, rel=0.01)


def test_a_load_without_uncertainties_leaves_an_unknown_one_unknown() -> None:
    coefficient, deviation = StatedLoad(normal_load=5.0).coefficient(1.5, uncertainty=None)
    assert coefficient == approx(0.3)
    assert deviation is None
    with raises(InvalidInput, match="normal_load must be positive"):
        StatedLoad(normal_load=0.0)


def test_a_value_a_cycle_has_a_mean_and_its_figure_alone() -> None:
    data = xr.Dataset(
        {"friction_coefficient": ("cycle", np.array([0.2, 0.3, 0.4])), "revolutions": ("cycle", np.array([1.0, 2, 3]))}
    )
    sheet = recording_sheet(data, title="cycles", settings=FrictionSettings())
    assert values(sheet)["mean_coefficient"] == approx(0.3)
    assert len(sheet.figures) == 1


def test_work_of_a_reciprocating_motion_is_that_of_its_rectangles(tmp_path: Path) -> None:
    # 0.5 N against 10 mm/s to and fro each second: 20 s of 5 mW, 10 cycles of 2 s and 10 mJ
    velocity = np.where(T % 2 < 1, 0.01, -0.01)
    path = written(tmp_path / "cycles.csv", **{TIME: T, FORCE: 0.5 * np.sign(velocity), VELOCITY: velocity})
    sheet = friction_sheet(path, settings=FrictionSettings())
    found = values(sheet)
    assert found["frictional_work"] == approx(0.5 * 0.01 * T[-1], rel=0.01)
    assert found["sliding_distance"] == approx(0.01 * T[-1], rel=0.01)
    assert found["work_per_cycle"] == approx(0.01, rel=0.02)
    error = uncertainty(sheet, "work_per_cycle")
    assert error is not None
    assert 0 <= error < 1e-4


def test_a_wobble_has_its_amplitude_at_each_multiple_and_what_is_left_without_it(tmp_path: Path) -> None:
    noise = 0.01 * np.random.default_rng(4).standard_normal(T.size)
    turning = 0.2 * np.cos(2 * np.pi * 1.5 * T) + 0.05 * np.sin(2 * np.pi * 3.0 * T)
    path = written(tmp_path / "wobble.csv", **{TIME: T, FORCE: 1.0 + turning + noise})
    found = values(friction_sheet(path, settings=FrictionSettings(rotation_speed=1.5)))
    assert found["wobble_amplitude_1"] == approx(0.2, abs=2e-3)
    assert found["wobble_amplitude_2"] == approx(0.05, abs=2e-3)
    assert found["deviation_without_wobble"] == approx(0.01, rel=0.05)
    assert "wobble_amplitude_1" not in values(friction_sheet(path, settings=FrictionSettings()))


def test_the_motor_tells_friction_by_its_torque_over_the_radius_with_the_error_of_its_constants(tmp_path: Path) -> None:
    # (0.5 A - 0.1 A) times 0.05 N m/A over 20 mm is 1 N; 2 % of the constant and 4 mA of 400 mA add in squares
    path = written(tmp_path / "motor.csv", **{TIME: T, "motor_current (A)": np.full(T.size, 0.5)})
    motor = MotorCalibration(
        torque_constant=0.05,
        idle_current=0.1,
        groove_diameter=0.04,
        torque_constant_uncertainty=0.001,
        idle_current_uncertainty=0.004,
    )
    sheet = friction_sheet(path, settings=FrictionSettings(motor=motor))
    assert values(sheet) == {"friction_force": approx(1.0)}
    assert uncertainty(sheet, "friction_force") == approx(np.hypot(0.02, 0.01), rel=1e-6)
    assert len(sheet.figures) == 1


def onset(**change: object) -> SteadyStateOnset:
    made: dict[str, object] = {
        "steady": True,
        "reason": "because",
        "start_time": 12.0,
        "sliding_distance": 0.24,
        "friction_force": 0.8,
        "friction_force_deviation": 0.02,
        "friction_force_uncertainty": 0.005,
    }
    return SteadyStateOnset(**made | change)  # type: ignore[arg-type]


def test_a_steady_state_has_level_time_and_distance_and_one_that_is_none_its_reason() -> None:
    sheet = _steady_part(onset(), onset(sliding_distance=0.5))
    assert values(sheet) == {
        "steady_friction_force": approx(0.8),
        "steady_time": approx(12.0),
        "steady_distance": approx(0.24),
        "steady_fluctuation_distance": approx(0.5),
    }
    assert uncertainty(sheet, "steady_friction_force") == approx(0.005)
    assert sheet.not_found == ()
    sheet = _steady_part(onset(), onset(steady=False))
    assert "steady_fluctuation_distance" not in values(sheet)
    assert sheet.not_found == ("steady fluctuation: because",)
    sheet = _steady_part(onset(steady=False), onset())
    assert values(sheet) == {}
    assert sheet.not_found == ("steady friction: because",)


def test_the_rotation_of_steps_is_the_stated_one_or_that_of_the_wobble(monkeypatch: MonkeyPatch) -> None:
    class Asked(Exception): ...

    def steps(recording: object, *, rotation_speed: float | None) -> None:
        raise Asked(rotation_speed)

    monkeypatch.setattr(friction_steps, "analyse_rotation_speed", lambda recording: 0.75)
    monkeypatch.setattr(friction_steps, "analyse_voltage_steps", steps)
    for stated, taken in ((2.0, 2.0), (None, 0.75)):
        with raises(Asked) as asked:
            friction_steps.step_sheet(xr.Dataset(), rotation_speed=stated)
        assert asked.value.args == (taken,)


@pytest.mark.parametrize("moving", [True, False])
def test_files_of_one_test_have_a_row_each_with_its_time_friction_and_work(tmp_path: Path, moving: bool) -> None:
    t = np.arange(400) / 100
    paths = []
    for number, level in enumerate((0.5, 0.7)):
        force = level + 0.01 * np.where(np.arange(400) % 2, 1, -1)
        channels = {TIME: t, FORCE: force} | ({VELOCITY: np.full(400, 0.02)} if moving else {})
        paths.append(written(tmp_path / f"{number}.csv", **channels))
    sheet = joined_friction_sheet(paths, settings=FrictionSettings())
    assert sheet.title == "2 files as one test"
    table = next(each for each in sheet.tables if each.name == "files")
    rows = [dict(zip([column.name for column in table.columns], row, strict=True)) for row in table.rows]
    assert [row["file"] for row in rows] == ["0.csv", "1.csv"]
    assert [row["friction_force"] for row in rows] == approx([0.5, 0.7])
    assert [row["friction_force_deviation"] for row in rows] == approx([0.01 * np.sqrt(400 / 399)] * 2)
    for row in rows:
        assert isinstance(row["end_time"], float)
        assert isinstance(row["start_time"], float)
        assert row["end_time"] - row["start_time"] == approx(3.99)
    assert rows[1]["start_time"] >= rows[0]["end_time"]  # type: ignore[operator]
    assert ("frictional_work" in rows[0]) == moving
    if moving:
        assert [row["frictional_work"] for row in rows] == approx([0.5 * 0.02 * 3.99, 0.7 * 0.02 * 3.99], rel=1e-3)
        assert [row["sliding_distance"] for row in rows] == approx([0.02 * 3.99] * 2, rel=1e-3)


def test_a_large_file_is_read_in_blocks_only_where_the_whole_of_it_is_wanted(
    tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    path = written(tmp_path / "large.csv", **{TIME: T, FORCE: np.full(T.size, 0.5)})
    monkeypatch.setattr(friction, "_streamed", lambda path, settings: "streamed")
    monkeypatch.setattr(friction, "recording_sheet", lambda recording, *, title, settings: "whole")
    monkeypatch.setattr(friction, "_LARGE", path.stat().st_size)
    monkeypatch.setattr(friction, "recording_format_name", lambda path: friction.TDMS)  # type: ignore[attr-defined]
    assert friction_sheet(path, settings=FrictionSettings()) == "whole"  # type: ignore[comparison-overlap]
    monkeypatch.setattr(friction, "_LARGE", path.stat().st_size - 1)
    assert friction_sheet(path, settings=FrictionSettings()) == "streamed"  # type: ignore[comparison-overlap]
    monkeypatch.setattr(friction, "recording_format_name", lambda path: "CSV")
    assert friction_sheet(path, settings=FrictionSettings()) == "whole"  # type: ignore[comparison-overlap]


def test_speeds_and_windows_of_the_settings_are_positive() -> None:
    for given in ({"sliding_speed": 0.0}, {"rotation_speed": -1.0}, {"window_duration": 0.0}):
        with raises(InvalidInput, match=f"{next(iter(given))} must be positive"):
            FrictionSettings(**given)  # type: ignore[arg-type]


@pytest.mark.parametrize(("rests", "ending"), [(3, "7 s"), (4, "7 s and 1 more"), (5, "7 s and 2 more")])
def test_three_rests_are_named_and_the_others_counted_and_short_ones_are_none(rests: int, ending: str) -> None:
    # rests of a second from 0, 3, 6, 9 and 12 s on, and one of 0.4 s from 20 s on
    time = np.arange(2500) / 100
    rest = np.zeros(time.size, dtype=bool)
    for number in range(rests):
        rest[300 * number : 300 * number + 101] = True
    rest[2000:2040] = True
    (told,) = _rest_caveat(xr.Dataset({"friction_force": ("time", time)}, {"time": time}), rest)
    by = "at rest by the force, below half of that without voltage"
    assert told.caveats == (f"{by}, and left out: 0 s to 1 s, 3 s to 4 s, 6 s to {ending}",)
    assert _rest_caveat(xr.Dataset({}, {"time": time}), np.zeros(time.size, dtype=bool)) == []
