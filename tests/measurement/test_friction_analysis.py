"""Friction analyses of recordings: channels, units, rotation and refusals."""

import numpy as np
import xarray as xr
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.rotation import MotorCalibration, disc_rotation
from sonolube.measurement.friction_analysis import (
    analyse_motor_current,
    analyse_rotation_speed,
    analyse_running_in,
    analyse_voltage_steps,
    analyse_windows,
    analyse_wobble,
)

RATE = 400.0  # Hz, D 2.3.2


def seconds(duration: float, rate: float = RATE) -> np.ndarray:
    return np.arange(round(duration * rate)) / rate


def recording(time: np.ndarray, **channels: np.ndarray) -> xr.Dataset:
    return xr.Dataset({name: ("time", values) for name, values in channels.items()}, coords={"time": time})


def test_a_missing_channel_is_refused_with_the_closest_name() -> None:
    with raises(InvalidInput, match="no channel 'friction_force'; did you mean friction_forces"):
        analyse_windows(recording(seconds(10), friction_forces=np.ones(4000)))


def steady(**channels: np.ndarray) -> xr.Dataset:
    t = seconds(20)
    return recording(t, **({"friction_force": 1 + 0.1 * np.cos(2 * np.pi * 0.75 * (t + 5))} | channels))


def test_the_unit_and_name_of_a_channel_go_with_its_windows() -> None:
    made = steady()
    made["friction_force"].attrs["units"] = "N"
    windows = analyse_windows(made, window_duration=4.0)
    assert (windows.channel, windows.unit, windows.window_duration) == ("friction_force", "N", 4.0)
    assert windows.mean == approx([1.0] * 5, abs=1e-9)
    running_in = analyse_running_in(made.isel(time=slice(0, 5200)), sliding_speed=0.5, window_duration=1.0)
    assert running_in.windows.window_duration == 1.0
    assert running_in.fluctuation.friction_force == approx(0.1 / np.sqrt(2), rel=0.3)


def test_the_wobble_is_taken_off_by_a_constant_speed_from_the_first_sample_on() -> None:
    clean = analyse_wobble(steady(), rotation_speed=0.75, harmonics=1)
    assert clean.wobble_amplitude == approx([0.1])
    assert clean.friction_force == approx(1.0)
    with raises(InvalidInput, match="give either rotation, from the pulses, or a constant rotation_speed"):
        analyse_wobble(steady())


def test_a_rotation_is_given_once_and_a_changing_speed_has_none() -> None:
    t = seconds(20)
    rotation = disc_rotation(time=np.arange(0, 20, 4 / 3), groove_diameter=0.05)
    made = steady(voltage_peak_to_peak=0 * t)
    with raises(InvalidInput, match="give one of rotation"):
        analyse_voltage_steps(made, rotation=rotation, rotation_speed=0.75)
    assert analyse_rotation_speed(made) == approx(0.75, rel=1e-3)
    assert analyse_rotation_speed(steady(voltage_peak_to_peak=0 * t, sliding_speed=0.02 + 0.02 * (t > 9))) is None
    for given in ({"rotation": rotation}, {"rotation_speed": 0.75}):
        (step,) = analyse_voltage_steps(made, settling_time=0.2, **given)
        assert step.friction_force == approx(1.0, abs=2e-3)
    with raises(InvalidInput, match="has no channel 'stack_voltage'"):
        analyse_voltage_steps(steady())


def test_the_set_speed_and_the_groove_tell_the_turns_of_a_disc_whose_speed_changes() -> None:
    t = seconds(20)
    slow = t < 10
    turns = np.where(slow, 0.3 * t, 3.0 + 0.8 * (t - 10))
    speed = np.pi * 0.02 * np.where(slow, 0.3, 0.8)
    force = np.where(slow, 1.0, 0.6) + 0.1 * np.cos(2 * np.pi * turns + 1)
    made = steady(friction_force=force, voltage_peak_to_peak=0 * t, sliding_speed_set=speed)
    steps = analyse_voltage_steps(made, settling_time=0.2, groove_diameter=0.02)
    assert [step.friction_force for step in steps] == approx([1.0, 0.6], abs=1e-3)
    with raises(InvalidInput, match="groove_diameter must be positive"):
        analyse_voltage_steps(made, groove_diameter=0.0)
    without = steady(voltage_peak_to_peak=0 * t)
    (step,) = analyse_voltage_steps(without, settling_time=0.2, groove_diameter=0.02)  # found in the friction
    assert step.friction_force == approx(1.0, abs=2e-3)


def test_a_motor_current_is_averaged_in_windows_of_two_samples_at_least() -> None:
    motor = MotorCalibration(torque_constant=0.4, idle_current=0.5, groove_diameter=0.1)
    current = np.tile([1.4, 1.6], 4000)
    made = recording(seconds(20), motor_current=current).isel(time=slice(0, 1601))
    trace = analyse_motor_current(made, motor=motor)
    assert trace.time == approx([1.0, 3.0])  # the single sample of a third window has no scatter
    assert trace.friction_force == approx([0.4 * 1.0 / 0.05] * 2)
    scatter = np.std(current[:800], ddof=1) / np.sqrt(800)
    assert trace.friction_force_uncertainty == approx([0.4 * scatter / 0.05] * 2)
