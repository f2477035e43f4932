"""What the analysis of tests finds of the disturbances of a virtual one, or says that it cannot find."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from pytest import approx

from sonolube.laboratory import connect_devices
from sonolube.laboratory.virtual_tribometer import UNDISTURBED, Disturbances, virtual_tribometer
from sonolube.measurement.friction.rotation import disc_rotation, hall_pulse_times, revolutions_at
from sonolube.measurement.friction.wobble import remove_wobble
from sonolube.measurement.friction_analysis import RunningIn, analyse_running_in
from sonolube.rig import read_rig

RIG = read_rig(Path(__file__).parents[3] / "examples" / "rigs" / "power_map.toml")
SPEED, DIAMETER, RATE = 0.0655, 0.028, 400.0
BASE = replace(UNDISTURBED, sensor_noise=0.03, flux_noise=0.02)


def recorded(sizes: Disturbances, *, duration: float = 60.0, seed: int = 2) -> tuple[xr.Dataset, xr.Dataset]:
    """Recording of steady sliding without vibration, and what it was made of."""
    virtual = virtual_tribometer(RIG, seed=seed, disturbances=sizes, groove_diameter=DIAMETER)
    devices = virtual.devices
    connect_devices(devices)
    devices.acquisition.start(["friction_force", "gaussmeter"], sample_rate=RATE)
    devices.motor.turn(SPEED / (np.pi * DIAMETER))
    devices.acquisition.read(round(0.2 * RATE))  # the motor reaches its speed
    force, flux = devices.acquisition.read(round(duration * RATE)).values.T
    time = np.arange(force.size) / RATE
    data = {"friction_force": ("time", force), "magnetic_flux_density": ("time", flux)}
    return xr.Dataset(data, {"time": time}), virtual.truth()


def running_in(recording: xr.Dataset) -> RunningIn:
    return analyse_running_in(recording, sliding_speed=SPEED, window_duration=1.0)


def test_the_orders_of_the_wobble_are_found_by_the_pulses_of_the_disc() -> None:
    recording, truth = recorded(replace(BASE, wobble_1=0.04, wobble_2=0.015))
    time = recording["time"].to_numpy()
    pulses = hall_pulse_times(time=time, magnetic_flux_density=recording["magnetic_flux_density"].to_numpy())
    inside = (time >= pulses[0]) & (time <= pulses[-1])
    revolutions = revolutions_at(disc_rotation(time=pulses, groove_diameter=DIAMETER), time=time[inside])
    force = recording["friction_force"].to_numpy()[inside]
    found = remove_wobble(revolutions=revolutions, friction_force=force)
    uncertainty = found.friction_force_deviation * np.sqrt(2 / force.size)
    mean = float(truth["friction_coefficient"]) * RIG.normal_load
    expected = np.array([float(truth["wobble_1"]), float(truth["wobble_2"]), 0.0]) * mean
    assert np.all(np.abs(found.wobble_amplitude - expected) < 4 * uncertainty)


def test_the_length_of_the_run_in_is_found() -> None:
    recording, truth = recorded(replace(BASE, run_in_share=0.3, run_in_distance=0.4))
    found = running_in(recording).friction
    assert found.steady
    half_width = max(3 * found.friction_force_deviation, 0.01 * found.friction_force)
    share = float(truth["run_in_share"] * truth["friction_coefficient"]) * RIG.normal_load / half_width
    assert found.sliding_distance == approx(float(truth["run_in_distance"]) * np.log(share), abs=2 * SPEED)


def test_a_drift_of_the_gauge_is_told_and_steady_friction_is_not_claimed() -> None:
    recording, truth = recorded(replace(BASE, drift_rate=5e-3))
    rate = float(truth["force_drift_rate"])
    found = running_in(recording).friction
    assert not found.steady
    direction = "rises" if rate > 0 else "falls"
    assert f"still {direction} by" in found.reason
    told = float(found.reason.split(" by ")[1].split(" N")[0])
    assert told == approx(abs(rate) * 20.0, rel=0.1)  # over the last third of a minute


@pytest.mark.parametrize("seed", [2, 3, 4])
def test_without_drift_friction_is_steady_at_the_level_that_was_given(seed: int) -> None:
    recording, truth = recorded(BASE, seed=seed)
    found = running_in(recording).friction
    expected = float(truth["friction_coefficient"]) * RIG.normal_load
    assert found.steady
    assert found.friction_force == approx(expected, abs=4 * found.friction_force_uncertainty)


def test_the_whole_record_repeats_the_scatter_of_friction_in_the_dissertation() -> None:
    recording, _ = recorded(Disturbances(), duration=12.0)
    later = recording["friction_force"].to_numpy()[round(3 * RATE) :]
    assert 0.02 < np.std(later) < 0.08  # ± 0.04 N at 0.89 N in D Table 4.2
