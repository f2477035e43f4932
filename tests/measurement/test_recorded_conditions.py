"""Conditions that a recording states: voltage, speed, rest, set points, and the impedance of a recorded sweep."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.sliding import stretches
from sonolube.measurement.recorded_conditions import (
    recorded_rest,
    recorded_speed,
    recorded_voltage,
    set_conditions,
    speed_changes,
    speed_of_one_direction,
    swept_impedance,
)

T = np.arange(200) * 0.05


def recording(time: np.ndarray = T, **channels: np.ndarray) -> xr.Dataset:
    made = {name: ("time", np.asarray(values, dtype=float)) for name, values in channels.items()}
    return xr.Dataset(made, coords={"time": time})


def test_a_peak_to_peak_voltage_is_taken_as_recorded_and_none_is_none() -> None:
    volts = np.where(T > 5, 28.0, 0.0)
    found = recorded_voltage(recording(voltage_peak_to_peak=volts))
    assert found is not None
    assert found.tolist() == volts.tolist()
    assert recorded_voltage(recording(friction_force=volts)) is None
    assert recorded_speed(recording(friction_force=volts)) is None


def test_the_motor_stops_the_speed_that_is_set() -> None:
    motor = np.where(T < 2, 0.0, 1.0)
    found = recorded_speed(recording(sliding_speed_set=np.full(200, 0.05), motor_on=motor))
    assert found is not None
    assert found[T < 2].tolist() == [0.0] * 40
    assert found[T >= 2] == approx(0.05)


def test_the_speed_of_a_reciprocating_motion_separates_no_steps() -> None:
    forth = np.where(T % 2 < 1, 0.02, -0.02)
    assert speed_of_one_direction(recording(relative_velocity=forth)) is None
    steady = np.full(200, -0.02)
    steady[:5] = 0.02  # a fortieth is no stroke
    found = speed_of_one_direction(recording(relative_velocity=steady))
    assert found is not None
    assert found[50] == -0.02
    assert speed_of_one_direction(recording(friction_force=steady)) is None


@pytest.mark.parametrize(
    ("speed", "changes"),
    [
        (np.where(T < 5, 1.0, 1.09), False),
        (np.where(T < 5, 1.0, 1.13), True),
        (np.where(T < 5, 0.0, 1.0), False),  # rest is no other speed
        (np.where(T < 5, -1.0, 1.0), False),
        (np.where(T < 9.8, 1.0, 3.0), False),  # for a fiftieth of the time
        (np.full(200, np.nan), False),
    ],
)
def test_speeds_differ_by_over_a_tenth(speed: np.ndarray, changes: bool) -> None:
    assert speed_changes(recording(relative_velocity=speed)) == changes


def test_rest_is_that_of_the_speed_or_of_the_force_without_voltage() -> None:
    force = np.where(T < 2, 0.0, 1.0)
    by_speed = recorded_rest(recording(friction_force=force, sliding_speed=np.where(T < 4, 0.0, 0.02)))
    assert stretches(by_speed) == [(0, 80)]
    by_force = recorded_rest(recording(friction_force=force, voltage_peak_to_peak=0 * T))
    assert stretches(by_force) == [(0, 40)]
    assert not recorded_rest(recording(friction_force=force)).any()


def test_set_points_are_cut_into_stretches_of_constant_conditions_and_drive_levels() -> None:
    motor = np.where(T < 2, 0.0, 1.0)
    speed = np.select([T < 2, T < 6], [np.nan, 0.02], 0.05)
    lubricant = np.where(T < 6, np.nan, 2.0)
    volts = np.where((T >= 3) & (T < 4), 28.0, 0.0)
    frequency = np.where((T >= 3) & (T < 3.5), 22e3, 0.0)
    given = recording(
        motor_on=motor,
        sliding_speed_set=speed,
        lubricant_set=lubricant,
        voltage_peak_to_peak_set=volts,
        frequency_set=frequency,
    )
    rest, slow, fast = set_conditions(given)
    assert (rest.samples, slow.samples, fast.samples) == (slice(0, 40), slice(40, 120), slice(120, 200))
    assert (rest.slides, slow.slides, fast.slides) == (False, True, True)
    assert np.isnan(rest.sliding_speed)
    assert (slow.sliding_speed, fast.sliding_speed) == (0.02, 0.05)
    assert np.isnan(slow.normal_load)
    assert (slow.lubricant, fast.lubricant) == (0, 2)
    assert rest.levels == ((slice(0, 40), 0.0, 0.0),)
    assert slow.levels == (
        (slice(40, 60), 0.0, 0.0),
        (slice(60, 70), 28.0, 22e3),
        (slice(70, 80), 28.0, 0.0),
        (slice(80, 120), 0.0, 0.0),
    )
    plain = set_conditions(recording(motor_on=np.ones(200)))
    assert plain[0].levels == ((slice(0, 200), 0.0, 0.0),)  # a drive that was not used
    assert set_conditions(recording(friction_force=np.ones(200))) == ()


RATE = 2000.0


def sweep(path: Path, *, rate: float = RATE, frequencies: tuple[float, ...] = (50.0, 80.0), each: int = 400) -> Path:
    """Voltage of 10 V on 30 - 40j ohm at each frequency in turn, with a disturbed current in the first tenth."""
    frequency = np.repeat([0.0, *frequencies], each)
    time = np.arange(frequency.size) / rate
    voltage = 0.5 + 10 * np.cos(2 * np.pi * frequency * time + 0.3) * (frequency > 0)
    phase = np.angle(30 - 40j)
    current = 0.2 + 0.2 * np.cos(2 * np.pi * frequency * time + 0.3 - phase) * (frequency > 0)
    settling = np.tile(np.arange(each) < each // 10, len(frequencies) + 1)
    current[settling] = 7.0
    made = {"stack_voltage": ("V", voltage), "stack_current": ("A", current), "frequency_set": ("Hz", frequency)}
    data = xr.Dataset(
        {name: ("time", values, {"units": unit}) for name, (unit, values) in made.items()},
        coords={"time": ("time", time, {"units": "s"})},
        attrs={"sample_rate": rate},
    )
    data.to_netcdf(path, engine="h5netcdf")
    return path


def test_the_impedance_of_a_recorded_sweep_is_voltage_over_current_after_settling(tmp_path: Path) -> None:
    found = swept_impedance(sweep(tmp_path / "sweep.nc", frequencies=(80.0, 50.0)))
    assert found is not None
    assert found.frequency.tolist() == [50.0, 80.0]
    assert found.impedance == approx([30 - 40j] * 2, rel=1e-9)
    assert found.file_name == "sweep.nc"
    assert found.file_format.endswith(", a sweep")
    assert len(found.sha256) == 64


def test_a_sweep_needs_two_and_a_half_samples_a_period_and_thirty_two_a_step(tmp_path: Path) -> None:
    with raises(InvalidInput, match=r"100 Hz do not resolve a drive at 50 Hz; record at 2\.5 times its frequency"):
        swept_impedance(sweep(tmp_path / "coarse.nc", rate=100.0, frequencies=(50.0,)))
    assert swept_impedance(sweep(tmp_path / "enough.nc", rate=126.0, frequencies=(50.0,))) is not None
    with raises(InvalidInput, match="its drive holds no frequency for 32 samples"):
        swept_impedance(sweep(tmp_path / "short.nc", each=34))
    assert swept_impedance(sweep(tmp_path / "long.nc", each=36)) is not None
    other = tmp_path / "sweep.csv"
    other.write_text("frequency (Hz),R,X\n1,2,3\n")
    assert swept_impedance(other) is None
