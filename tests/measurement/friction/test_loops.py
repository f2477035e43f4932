"""Frictional work of loops with closed forms."""

import numpy as np
import xarray as xr
from pytest import approx

from sonolube.measurement.friction.loops import friction_loops, friction_work
from sonolube.measurement.friction_analysis import analyse_cycles

RATE = 400.0  # Hz, D 2.3.2


def seconds(duration: float, rate: float = RATE) -> np.ndarray:
    return np.arange(round(duration * rate)) / rate


def recording(time: np.ndarray, **channels: np.ndarray) -> xr.Dataset:
    return xr.Dataset({name: ("time", values) for name, values in channels.items()}, coords={"time": time})


def test_the_work_of_a_coulomb_loop_is_force_times_four_amplitudes() -> None:
    t = seconds(10, 2000)
    amplitude, rate = 5e-3, 2.0
    velocity = 2 * np.pi * rate * amplitude * np.cos(2 * np.pi * rate * t + 1.0)
    loops = friction_loops(time=t, friction_force=2.0 * np.sign(velocity) + 0.3, relative_velocity=velocity)
    assert loops.frictional_work.size == 19
    assert loops.sliding_distance == approx(4 * amplitude, rel=1e-4)
    assert loops.frictional_work == approx(2.0 * 4 * amplitude, rel=1e-4)  # the zero error of 0.3 N drops out
    assert loops.friction_force == approx(2.0, rel=1e-5)
    assert np.diff(loops.start_time) == approx(1 / rate, rel=1e-5)


def test_the_work_of_a_viscous_loop_is_pi_c_omega_a_squared() -> None:
    t = seconds(3, 4000)
    c, amplitude, omega = 7.0, 2e-3, 2 * np.pi * 5
    velocity = amplitude * omega * np.sin(omega * t - 0.3)
    loops = friction_loops(time=t, friction_force=c * velocity, relative_velocity=velocity)
    assert loops.frictional_work == approx(np.pi * c * omega * amplitude**2, rel=2e-5)


def test_the_work_of_a_steady_pull_is_force_times_distance() -> None:
    t = seconds(4)
    pulled = recording(t, friction_force=np.full(t.size, 1.5), relative_velocity=np.full(t.size, 0.02))
    cycles = analyse_cycles(pulled)
    assert cycles.loops is None
    assert cycles.work.frictional_work[-1] == approx(1.5 * 0.02 * t[-1])
    assert cycles.work.friction_force == approx(1.5)


def test_missing_values_add_no_work_and_lower_the_measured_fraction() -> None:
    t = seconds(10)
    force = np.where((t > 2) & (t < 4), np.nan, 1.0)
    work = friction_work(time=t, friction_force=force, relative_velocity=np.full(t.size, 0.1))
    assert work.measured_fraction == approx(0.8, abs=0.001)
    assert work.friction_force == approx(1.0)
