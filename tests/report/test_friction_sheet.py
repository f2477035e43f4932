"""Sheet of a friction recording: what is left out as rest, what a mean is called, and what is said of gaps."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from sonolube.report.measured.friction import FrictionSettings, friction_sheet
from sonolube.report.measured.sheet import Column, Sheet, Table
from sonolube.tasks.measure import friction

RATE = 200.0  # Hz


def sheet_of(folder: Path, **channels: np.ndarray) -> Sheet:
    """Sheet of channels by their headings."""
    path = folder / "test.csv"
    np.savetxt(path, np.stack(list(channels.values()), 1), delimiter=",", header=",".join(channels), comments="")
    return friction_sheet(path, settings=FrictionSettings())


def first_level(sheet: Sheet) -> tuple[float, float]:
    """Friction and its standard error at the first step."""
    names = [column.name for column in sheet.tables[0].columns]
    row = sheet.tables[0].rows[0]
    level, error = (row[names.index(name)] for name in ("friction_force", "friction_force_uncertainty"))
    assert isinstance(level, float)
    assert isinstance(error, float)
    return level, error


def moving_from_two_to_twenty(seed: int = 1) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, force of 0.8 N while the disc turns, and its speed."""
    t = np.arange(int(40 * RATE)) / RATE
    moving = (t >= 2) & (t < 20)
    return t, 0.8 * moving + 0.02 * np.random.default_rng(seed).standard_normal(t.size), 0.03 * moving


VOLTAGE = "voltage_peak_to_peak (V)"
TIME, FORCE, SPEED = "time (s)", "friction_force (N)", "sliding_speed (m/s)"


@pytest.mark.parametrize("with_speed", [False, True])
def test_friction_without_vibration_is_that_of_sliding_and_rest_is_named(tmp_path: Path, with_speed: bool) -> None:
    t, force, speed = moving_from_two_to_twenty()
    found = sheet_of(tmp_path, **{TIME: t, FORCE: force, VOLTAGE: 0 * t} | ({SPEED: speed} if with_speed else {}))
    assert found.values[0].name == "friction_force"
    assert found.values[0].value == approx(0.8, abs=0.005)
    told_by = "the speed" if with_speed else "the force, below half of that without voltage"
    said = next(line for line in found.caveats if "at rest" in line and "left out" in line)
    assert said.startswith(f"at rest by {told_by}, and left out: 0 s to ")
    assert said.endswith("40 s")


def test_a_mean_of_a_recording_without_a_known_vibration_is_no_friction_force(tmp_path: Path) -> None:
    t, force, _ = moving_from_two_to_twenty()
    found = sheet_of(tmp_path, **{TIME: t, FORCE: force})
    assert [value.name for value in found.values[:1]] == ["mean_force"]
    assert found.values[0].label == "Mean force of the whole recording"
    stepped = sheet_of(tmp_path, **{TIME: t, FORCE: force, VOLTAGE: np.where(t > 10, 20.0, 0.0)})
    assert stepped.values[0].name == "mean_force"


def test_the_zero_at_rest_is_taken_off_where_a_speed_tells_the_rest_and_is_said(tmp_path: Path) -> None:
    t, force, speed = moving_from_two_to_twenty()
    found = sheet_of(tmp_path, **{TIME: t, FORCE: force + 0.03, VOLTAGE: 0 * t, SPEED: speed})
    level, error = first_level(found)
    assert level == approx(0.8, abs=4 * error)
    assert any("mN, the mean force at rest before sliding, is taken off as its zero" in line for line in found.caveats)
    without = sheet_of(tmp_path, **{TIME: t, FORCE: force + 0.03, VOLTAGE: 0 * t})
    level, error = first_level(without)
    assert level == approx(0.83, abs=0.003)
    assert error < 0.002
    assert not any("zero" in line for line in without.caveats)


@pytest.mark.parametrize("name", [FORCE, VOLTAGE, SPEED])
@pytest.mark.parametrize("ends", [False, True])
def test_a_channel_that_misses_samples_or_ends_early_is_said(tmp_path: Path, name: str, ends: bool) -> None:
    t, force, speed = moving_from_two_to_twenty()
    channels = {TIME: t, FORCE: force, VOLTAGE: 0 * t, SPEED: speed}
    channels[name] = channels[name].copy()
    channels[name][2000 : None if ends else 2100] = np.nan
    found = sheet_of(tmp_path, **channels)
    quantity = name.split(" ", maxsplit=1)[0]
    said = (
        f"{quantity} ends at time [s] = 9.995"
        if ends
        else f"{quantity} misses 100 of 8000 samples, the first at time [s] = 10"
    )
    assert any(line.startswith(said) for line in found.caveats)
    assert first_level(found)[0] == approx(0.8, abs=0.01)


def test_an_unforeseen_error_at_one_file_does_not_lose_the_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    t, force, _ = moving_from_two_to_twenty()
    paths = [tmp_path / name for name in ("a.csv", "b.csv", "c.csv")]
    for path in paths:
        np.savetxt(path, np.stack([t, force], 1), delimiter=",", header=f"{TIME},{FORCE}", comments="")

    def failing(path: Path, *, settings: FrictionSettings) -> Sheet:
        if path.name == "b.csv":
            raise ZeroDivisionError("float division by zero")
        return friction_sheet(path, settings=settings)

    monkeypatch.setattr("sonolube.tasks.measure.recordings.friction_sheet", failing)
    answer = friction(paths)
    assert [each["title"] for each in answer.object()["results"]] == ["a.csv", "c.csv"]
    ((name, reason),) = answer.refusals().items()
    assert name.endswith("b.csv")
    assert reason.startswith(
        "a fault of sonolube itself, not of your input: ZeroDivisionError (float division by zero)"
    )
    assert "please report it" in reason


def test_columns_without_a_value_are_left_out_of_text_and_stay_in_the_record() -> None:
    columns = (Column("a", "A", "N"), Column("b", "B"), Column("c", "C", "s"))
    table = Table(name="t", title="T", columns=columns, rows=((1.0, None, 2.0), (None, float("nan"), 3.0)))
    assert table.texts() == (["A", "C"], [["1 N", "2 s"], ["", "3 s"]])
    assert [column.name for column in table.columns] == ["a", "b", "c"]
