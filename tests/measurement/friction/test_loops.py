"""Frictional work of loops with closed forms."""

import numpy as np
import xarray as xr
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.loops import _positive_reversals, friction_loops, friction_work
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


def test_work_distance_and_measured_time_follow_the_trapezoidal_rule() -> None:
    time = np.array([1.0, 2.0, 4.0, 5.0, 8.0])
    force = np.array([1.0, 2.0, np.nan, 3.0, 5.0])
    speed = np.array([2.0, -1.0, 1.0, -4.0, 2.0])
    # power 2, -2, nan, -12, 10 W: 1 s times 0, and 3 s times -1; speeds 2, 1 and 4, 2: 1.5 and 9 m
    work = friction_work(time=time, friction_force=force, relative_velocity=speed)
    assert work.frictional_power == approx([2, -2, np.nan, -12, 10], nan_ok=True)
    assert work.frictional_work == approx([0, 0, 0, 0, -3])
    assert work.sliding_distance == approx(1.5 + 9)
    assert work.friction_force == approx(-3 / 10.5)
    assert work.measured_fraction == approx(4 / 7)
    assert work.time.tolist() == time.tolist()


def test_no_sliding_and_fewer_than_two_reversals_are_refused() -> None:
    t = np.arange(10.0)
    with raises(InvalidInput, match="relative_velocity is zero wherever the friction is known"):
        friction_work(time=t, friction_force=np.ones(10), relative_velocity=np.zeros(10))
    with raises(InvalidInput, match="relative_velocity turns positive 1 times; a cycle needs two"):
        friction_loops(time=t, friction_force=np.ones(10), relative_velocity=t - 4.5)


def test_a_reversal_counts_beyond_a_tenth_of_the_peak_and_lies_between_its_samples() -> None:
    t = np.arange(12.0)
    # turns at 2.25, between -1 and 3; not at 5 to 6, within a tenth of 9; between 7 and 9, missing at 8
    v = np.array([-9.0, -9, -1, 3, 9, -0.8, 0.8, -5, np.nan, 9, 9, 9])
    reversals = _positive_reversals(t, v)
    assert reversals == approx([2.25, 7 + 2 * 5 / 14])
    loops = friction_loops(time=t, friction_force=np.full(12, 2.0) * np.sign(np.nan_to_num(v)), relative_velocity=v)
    assert loops.start_time == approx(reversals[:1])
    assert loops.end_time == approx(reversals[1:])


def test_a_loop_with_a_missing_force_has_the_work_of_the_rest_and_its_fraction() -> None:
    t = np.arange(0, 8, 0.5)
    v = np.where(t % 4 < 2, 1.0, -1.0)  # turns positive at 3.75 and 7.75
    f = 3.0 * v
    f[9] = np.nan  # at 4.5 s
    loops = friction_loops(
        time=np.append(t, [8.0, 8.5]), friction_force=np.append(f, [3, 3]), relative_velocity=np.append(v, [1, 1])
    )
    assert loops.start_time == approx([3.75])
    # a cycle of 4 s, of which 1 s about the missing sample is unknown; the speed is 1 m/s but for the linear passage
    # through zero over half a second at each reversal
    assert loops.measured_fraction == approx([0.75])
    # from 3.75: to 4.0 rising (0.125 m), 1 s missing, 5.0 to 5.5, 5.5 to 6 through zero (1 and -1: 0.5 m by the rule),
    # 6 to 7.5, and 7.5 to 7.75 (0.125 m)
    assert loops.sliding_distance == approx([0.125 + 0.5 + 0.5 + 1.5 + 0.125])
