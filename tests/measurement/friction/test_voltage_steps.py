"""Friction at the voltage steps of D 4.1.2, found in recordings made of Table 4.2."""

import numpy as np
import xarray as xr
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.voltage_steps import friction_at_voltage_steps, voltage_envelope
from sonolube.measurement.friction_analysis import analyse_voltage_steps

RATE = 400.0  # Hz, D 2.3.2


def seconds(duration: float, rate: float = RATE) -> np.ndarray:
    return np.arange(round(duration * rate)) / rate


def recording(time: np.ndarray, **channels: np.ndarray) -> xr.Dataset:
    return xr.Dataset({name: ("time", values) for name, values in channels.items()}, coords={"time": time})


VOLTS = (0.0, 5.1, 10.3, 15.5, 20.7, 25.9)
FORCES = (0.89, 0.85, 0.67, 0.32, 0.12, 0.04)
STARTS = (0.0, 12.5, 16.5, 20.5, 24.5, 28.5)


def published_voltage_steps(rate: float = RATE) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    t = seconds(32.5, rate)
    step = np.searchsorted(STARTS, t, side="right") - 1
    return t, np.array(FORCES)[step], np.array(VOLTS)[step]


def test_the_voltage_steps_of_table_4_2_are_recovered_from_a_recording() -> None:
    t, force, volts = published_voltage_steps()
    force = force + 0.03 * np.sin(2 * np.pi * t / 1.34)
    steps = analyse_voltage_steps(recording(t, friction_force=force, voltage_peak_to_peak=volts))
    assert [step.voltage_peak_to_peak for step in steps] == approx(list(VOLTS))
    assert [step.start_time for step in steps] == approx(list(STARTS), abs=0.11)
    assert [step.friction_force for step in steps] == approx(list(FORCES), abs=0.006)
    assert steps[0].friction_reduction is None
    # E17: 4.5, 24.7, 64.0, 86.5, 95.5 % follow from the mean forces
    reductions = [step.friction_reduction for step in steps[1:]]
    assert reductions == approx([0.045, 0.247, 0.640, 0.865, 0.955], abs=0.007)


def test_the_steps_are_found_in_an_alternating_voltage() -> None:
    t, force, volts = published_voltage_steps()
    alternating = volts / 2 * np.sin(2 * np.pi * 22_087 * t)  # aliased, as at 400 Hz it must be
    steps = analyse_voltage_steps(recording(t, friction_force=force, stack_voltage=alternating))
    assert [step.voltage_peak_to_peak for step in steps] == approx(list(VOLTS), rel=0.03)
    assert [step.friction_force for step in steps] == approx(list(FORCES))


def test_a_short_voltage_disturbance_begins_no_step() -> None:
    t, force, volts = published_voltage_steps()
    volts[2000:2010] = 25.9
    steps = friction_at_voltage_steps(time=t, friction_force=force, voltage_peak_to_peak=volts)
    assert len(steps) == 6


def test_voltage_steps_without_one_at_zero_voltage_are_refused() -> None:
    t, force, volts = published_voltage_steps()
    with raises(InvalidInput, match="no step without voltage; the lowest is 5"):
        friction_at_voltage_steps(time=t, friction_force=force, voltage_peak_to_peak=volts + 5)


def test_the_envelope_of_a_sine_is_its_peak_to_peak_value() -> None:
    t = seconds(2, 10_000)
    envelope = voltage_envelope(time=t, stack_voltage=3 + 4 * np.sin(2 * np.pi * 331 * t))
    assert envelope == approx(8.0, rel=1e-2)
