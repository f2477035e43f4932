"""Friction out of recordings: signals made with known answers, statistics against Monte Carlo and closed forms."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from nptdms import ChannelObject, TdmsWriter
from pytest import approx, raises
from scipy.signal import lfilter

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.loops import friction_loops, friction_work
from sonolube.measurement.friction.motor_current import (
    MotorCalibration,
    friction_from_motor_current,
)
from sonolube.measurement.friction.reduction import estimate_friction_reduction
from sonolube.measurement.friction.running_in import steady_state_onset
from sonolube.measurement.friction.stick_slip import estimate_stick_slip
from sonolube.measurement.friction.voltage_steps import friction_at_voltage_steps, voltage_envelope
from sonolube.measurement.friction.windows import streamed_window_statistics, window_statistics
from sonolube.measurement.friction.wobble import remove_wobble
from sonolube.measurement.friction_analysis import (
    analyse_cycles,
    analyse_motor_current,
    analyse_rotation,
    analyse_running_in,
    analyse_stick_slip,
    analyse_voltage_steps,
    analyse_windows,
    analyse_wobble,
)
from sonolube.measurement.statistics.autocorrelation import correlated_mean, correlation_time, statistical_inefficiency

RNG = np.random.default_rng(7)
RATE = 400.0  # Hz, D 2.3.2


def seconds(duration: float, rate: float = RATE) -> np.ndarray:
    return np.arange(round(duration * rate)) / rate


def recording(time: np.ndarray, **channels: np.ndarray) -> xr.Dataset:
    return xr.Dataset({name: ("time", values) for name, values in channels.items()}, coords={"time": time})


def autoregressive(phi: float, shape: tuple[int, ...], rng: np.random.Generator = RNG) -> np.ndarray:
    start = rng.normal(size=(*shape[:-1], 1)) / np.sqrt(1 - phi**2)
    noise = rng.normal(size=shape)
    return np.asarray(lfilter([1], [1, -phi], noise, zi=phi * start)[0])


# -- windows


def test_a_sine_fluctuates_by_its_amplitude_over_root_two_in_every_window() -> None:
    t = seconds(60)
    windows = window_statistics(1.0 + 0.3 * np.sin(2 * np.pi * 100 * t + 0.4), time=t)
    assert windows.time == approx(np.arange(30) * 2 + 1)
    assert windows.samples.tolist() == [800] * 30
    assert windows.mean == approx(1.0)
    assert windows.fluctuation == approx(0.3 / np.sqrt(2))
    assert windows.deviation == approx(0.3 / np.sqrt(2) * np.sqrt(800 / 799))


@given(st.lists(st.floats(-1e3, 1e3) | st.just(np.nan), min_size=2, max_size=200), st.floats(0.1, 30))
@settings(max_examples=100, deadline=None)
def test_windows_hold_what_numpy_finds_in_them(values: list[float], window: float) -> None:
    x = np.array(values)
    if np.isnan(x).all():
        return
    t = np.arange(x.size) * 0.5
    windows = window_statistics(x, time=t, window_duration=window)
    number = np.floor(t / window + 1e-9)
    for i, which in enumerate(np.unique(number)):
        own = x[number == which]
        own = own[np.isfinite(own)]
        assert windows.samples[i] == own.size
        if own.size:
            assert windows.mean[i] == approx(own.mean(), abs=1e-9)
            assert windows.fluctuation[i] == approx(own.std(), abs=1e-9)


def test_dropped_samples_leave_the_windows_where_they_are() -> None:
    t = seconds(20)
    kept = (t < 5) | (t > 9.1)
    windows = window_statistics(np.floor(t / 2)[kept], time=t[kept])
    assert windows.time.tolist() == [1, 3, 5, 9, 11, 13, 15, 17, 19]
    assert windows.mean.tolist() == [0, 1, 2, 4, 5, 6, 7, 8, 9]


@pytest.mark.parametrize("block", [37, 800, 4096, 100_000])
def test_streamed_windows_are_those_of_the_whole(block: int, tmp_path: Path) -> None:
    path = tmp_path / "long.tdms"
    t = seconds(31.3)
    force = RNG.normal(1.0, 0.1, t.size)
    force[100:105] = np.nan
    with TdmsWriter(path) as writer:
        for part in np.array_split(force, 7):
            writer.write_segment([ChannelObject("g", "friction_force", part, {"wf_increment": 1 / RATE})])
    streamed = streamed_window_statistics(path, block_samples=block)["friction_force"]
    whole = window_statistics(force, time=t)
    assert streamed.unit == "N"
    assert streamed.time == approx(whole.time)
    assert streamed.samples.tolist() == whole.samples.tolist()
    assert streamed.mean == approx(whole.mean, rel=1e-13)
    assert streamed.deviation == approx(whole.deviation, rel=1e-10)


@pytest.mark.parametrize("block", [200, 800, 10_000])
def test_a_sensor_that_fails_for_a_while_empties_its_windows_only(block: int, tmp_path: Path) -> None:
    path = tmp_path / "failing.tdms"
    force, nothing = np.ones(4000), np.full(4000, np.nan)
    force[800:2400] = np.nan
    waves = {"wf_increment": 1 / RATE}
    with TdmsWriter(path) as writer:
        writer.write_segment(
            [ChannelObject("g", "friction_force", force, waves), ChannelObject("g", "temperature", nothing, waves)]
        )
    windows = streamed_window_statistics(path, channels=["friction_force"], block_samples=block)["friction_force"]
    assert windows.samples.tolist() == [800, 0, 0, 800, 800]
    assert windows.mean == approx([1, np.nan, np.nan, 1, 1], nan_ok=True)
    with raises(InvalidInput, match="channel 'temperature' holds no value"):
        streamed_window_statistics(path, block_samples=block)


# -- standard errors


@pytest.mark.parametrize("phi", [0.0, 0.5, 0.9])
def test_the_standard_error_is_the_scatter_of_repeated_means(phi: float) -> None:
    tests = autoregressive(phi, (400, 5000))
    claimed = np.array([correlated_mean(test).uncertainty for test in tests])
    assert np.mean(claimed) == approx(np.std(tests.mean(axis=1), ddof=1), rel=0.12)  # 400 means: 3.5 % each


def test_the_correlation_of_an_autoregressive_process_is_its_closed_form() -> None:
    x = autoregressive(0.8, (400_000,))
    assert statistical_inefficiency(x) == approx(1.8 / 0.2, rel=0.05)
    assert correlation_time(x, sample_interval=0.01) == approx(0.045, rel=0.05)


def test_a_constant_is_known_exactly() -> None:
    estimate = correlated_mean(np.full(1000, 0.89))
    assert (estimate.mean, estimate.uncertainty) == approx((0.89, 0.0), abs=1e-15)


def test_the_uncertainty_of_a_reduction_is_that_of_monte_carlo() -> None:
    off = 1.0 + 0.2 * autoregressive(0.7, (600, 2000))
    on = 0.4 + 0.1 * autoregressive(0.7, (600, 2000))
    estimates = [
        estimate_friction_reduction(intrinsic_friction_force=a, reduced_friction_force=b)
        for a, b in zip(off, on, strict=True)
    ]
    scatter = np.std([estimate.friction_reduction for estimate in estimates], ddof=1)
    assert np.mean([e.friction_reduction_uncertainty for e in estimates]) == approx(scatter, rel=0.1)
    assert np.mean([e.friction_reduction for e in estimates]) == approx(0.6, abs=0.002)


def test_a_reduction_from_no_friction_is_refused() -> None:
    with raises(InvalidInput, match=r"intrinsic_friction_force must be positive, got 0\.0 N"):
        estimate_friction_reduction(intrinsic_friction_force=np.zeros(10), reduced_friction_force=np.ones(10))


# -- running in


def test_running_in_ends_where_the_exponential_enters_the_band() -> None:
    t = np.arange(1, 2000, 2.0)  # windows of 2 s
    force = 1.024 * (1 - np.exp(-(t - 1) * 0.0203 / 1.5))  # over distance, characteristic 1.5 m
    found = steady_state_onset(time=t, friction_force=force, sliding_speed=0.0203)
    assert found.steady
    assert found.sliding_distance == approx(1.5 * np.log(100), abs=2 * 0.0203)  # within 1 % from there, one window
    assert found.friction_force == approx(1.024, rel=0.002)


def test_running_in_with_scatter_ends_within_three_scatters() -> None:
    t = np.arange(1, 4000, 2.0)
    force = 1.0 - 0.7 * np.exp(-t / 100) + RNG.normal(0, 0.02, t.size)
    found = steady_state_onset(time=t, friction_force=force, sliding_speed=1.0)
    assert found.steady
    expected = 100 * np.log(0.7 / 0.06)  # 246 s: the mean enters the band of 0.06 N
    assert 0.6 * expected < found.sliding_distance < 1.2 * expected
    assert found.friction_force_deviation == approx(0.02, rel=0.1)


def test_a_test_that_still_drifts_is_not_called_steady() -> None:
    t = np.arange(1, 400, 2.0)
    found = steady_state_onset(time=t, friction_force=0.5 + 0.002 * t, sliding_speed=0.02)
    assert not found.steady
    assert "still rises" in found.reason


def test_the_fluctuation_may_settle_later_than_the_friction() -> None:
    t = seconds(400)
    amplitude = 0.1 + 0.4 * np.exp(-t / 40)
    force = 1.0 - np.exp(-t / 5) + amplitude * np.sin(2 * np.pi * 25 * t)
    found = analyse_running_in(recording(t, friction_force=force), sliding_speed=0.0203)
    assert found.friction.start_time == approx(5 * np.log(100), abs=3)
    assert found.fluctuation.start_time == approx(40 * np.log(4 / 0.01), abs=4)
    assert found.fluctuation.friction_force == approx(0.1 / np.sqrt(2), rel=0.01)


# -- the staircase of D 4.1.2

VOLTS = (0.0, 5.1, 10.3, 15.5, 20.7, 25.9)
FORCES = (0.89, 0.85, 0.67, 0.32, 0.12, 0.04)
STARTS = (0.0, 12.5, 16.5, 20.5, 24.5, 28.5)


def published_staircase(rate: float = RATE) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    t = seconds(32.5, rate)
    step = np.searchsorted(STARTS, t, side="right") - 1
    return t, np.array(FORCES)[step], np.array(VOLTS)[step]


def test_the_staircase_of_table_4_2_is_read_back_from_its_recording() -> None:
    t, force, volts = published_staircase()
    force = force + 0.03 * np.sin(2 * np.pi * t / 1.34)
    steps = analyse_voltage_steps(recording(t, friction_force=force, voltage_peak_to_peak=volts))
    assert [step.voltage_peak_to_peak for step in steps] == approx(list(VOLTS))
    assert [step.start_time for step in steps] == approx(list(STARTS), abs=0.11)
    assert [step.friction_force for step in steps] == approx(list(FORCES), abs=0.006)
    assert steps[0].friction_reduction is None
    # E17: 4.5, 24.7, 64.0, 86.5, 95.5 % follow from the mean forces
    reductions = [step.friction_reduction for step in steps[1:]]
    assert reductions == approx([0.045, 0.247, 0.640, 0.865, 0.955], abs=0.007)


def test_the_steps_are_found_in_the_alternating_voltage() -> None:
    t, force, volts = published_staircase()
    alternating = volts / 2 * np.sin(2 * np.pi * 22_087 * t)  # aliased, as at 400 Hz it must be
    steps = analyse_voltage_steps(recording(t, friction_force=force, stack_voltage=alternating))
    assert [step.voltage_peak_to_peak for step in steps] == approx(list(VOLTS), rel=0.03)
    assert [step.friction_force for step in steps] == approx(list(FORCES))


def test_a_glitch_of_the_voltage_begins_no_step() -> None:
    t, force, volts = published_staircase()
    volts[2000:2010] = 25.9
    steps = friction_at_voltage_steps(time=t, friction_force=force, voltage_peak_to_peak=volts)
    assert len(steps) == 6


def test_a_staircase_that_is_never_off_is_refused() -> None:
    t, force, volts = published_staircase()
    with raises(InvalidInput, match="no step without voltage; the lowest is 5"):
        friction_at_voltage_steps(time=t, friction_force=force, voltage_peak_to_peak=volts + 5)


def test_the_envelope_of_a_sine_is_its_peak_to_peak() -> None:
    t = seconds(2, 10_000)
    envelope = voltage_envelope(time=t, stack_voltage=3 + 4 * np.sin(2 * np.pi * 331 * t))
    assert envelope == approx(8.0, rel=1e-2)


# -- loops and work


def test_a_coulomb_loop_takes_four_amplitudes_of_work() -> None:
    t = seconds(10, 2000)
    amplitude, rate = 5e-3, 2.0
    velocity = 2 * np.pi * rate * amplitude * np.cos(2 * np.pi * rate * t + 1.0)
    loops = friction_loops(time=t, friction_force=2.0 * np.sign(velocity) + 0.3, relative_velocity=velocity)
    assert loops.frictional_work.size == 19
    assert loops.sliding_distance == approx(4 * amplitude, rel=1e-4)
    assert loops.frictional_work == approx(2.0 * 4 * amplitude, rel=1e-4)  # the zero error of 0.3 N drops out
    assert loops.friction_force == approx(2.0, rel=1e-5)
    assert np.diff(loops.start_time) == approx(1 / rate, rel=1e-5)


def test_viscous_friction_takes_pi_c_omega_a_squared() -> None:
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


def test_unknown_stretches_add_no_work_and_are_told() -> None:
    t = seconds(10)
    force = np.where((t > 2) & (t < 4), np.nan, 1.0)
    work = friction_work(time=t, friction_force=force, relative_velocity=np.full(t.size, 0.1))
    assert work.measured_fraction == approx(0.8, abs=0.001)
    assert work.friction_force == approx(1.0)


# -- stick-slip


@pytest.mark.parametrize("rate", [7.0, 13.7, 40.0])
def test_a_sawtooth_slips_at_its_rate_by_its_height(rate: float) -> None:
    t = seconds(10, 20_000)
    force = 1.0 + 0.25 * ((t * rate + 0.1) % 1.0)
    found = estimate_stick_slip(time=t, friction_force=force)
    assert found.detected
    assert found.stick_slip_frequency == approx(rate, rel=1e-3)
    assert found.spectral_frequency == approx(rate, rel=1e-3)
    assert found.stick_slip_amplitude == approx(0.25, rel=0.01)


def test_the_hundred_hertz_of_figure_2_17_are_seen_at_its_sampling_rate() -> None:
    t = seconds(2)
    found = analyse_stick_slip(recording(t, friction_force=1 + 0.28 * np.sin(2 * np.pi * 99 * t)))
    assert found.detected
    assert found.stick_slip_frequency == approx(99, rel=0.01)


def test_noise_is_no_stick_slip() -> None:
    t = seconds(10)
    assert not estimate_stick_slip(time=t, friction_force=np.ones(t.size)).detected
    slow = np.cos(2 * np.pi * 0.5 * t) + RNG.normal(0, 0.5, t.size)
    found = estimate_stick_slip(time=t, friction_force=slow)
    assert not found.detected
    assert "spectrum peaks" in found.reason


def test_stick_slip_in_a_recording_with_a_gap_is_refused_at_the_gap() -> None:
    t = np.delete(seconds(10), slice(1000, 1003))
    with raises(InvalidInput, match=r"after 2\.4975 s samples were dropped"):
        estimate_stick_slip(time=t, friction_force=np.sin(t))


# -- wobble


def test_a_known_wobble_is_removed_and_the_rest_left() -> None:
    t = seconds(134)
    turns = t / 1.34  # D 4.1.2: a turn in 1.34 s
    rest = 0.89 + 0.1 * np.sin(2 * np.pi * 10.5 * turns)  # between the harmonics, over whole turns
    wobble = 0.04 * np.cos(2 * np.pi * turns - 0.7) + 0.01 * np.cos(4 * np.pi * turns + 2.0)
    clean = remove_wobble(revolutions=turns, friction_force=rest + wobble, harmonics=2, trend_degree=0)
    assert np.max(np.abs(clean.friction_force - rest)) < 1e-12
    assert clean.wobble_amplitude == approx([0.04, 0.01])
    assert clean.phase == approx([0.7, -2.0])


@given(st.floats(0.001, 10), st.floats(-3, 3), st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_gaps_do_not_disturb_the_removal(amplitude: float, phase: float, seed: int) -> None:
    turns = np.linspace(0, 23.4, 5000)
    rest = 2.0 - 0.05 * turns
    force = rest + amplitude * np.cos(6 * np.pi * turns - phase)
    force[np.random.default_rng(seed).random(turns.size) < 0.3] = np.nan
    force[1000:1600] = np.nan
    clean = remove_wobble(revolutions=turns, friction_force=force)
    known = np.isfinite(force)
    assert np.max(np.abs(clean.friction_force - rest)[known]) < 1e-12 * max(1.0, amplitude)
    assert np.isnan(clean.friction_force[~known]).all()


def test_wobble_at_a_changing_speed_is_removed_by_the_pulses() -> None:
    t = seconds(60)
    turns = 0.5 * t + 0.004 * t**2  # quickening from 0.5 turns a second
    pulses = np.exp(-(((turns + 0.5) % 1 - 0.5) ** 2) / 2e-4)
    force = 0.9 + 0.05 * np.cos(2 * np.pi * turns)
    made = recording(t, friction_force=force, magnetic_flux_density=pulses)
    rotation = analyse_rotation(made, groove_diameter=28e-3)
    clean = analyse_wobble(made, rotation=rotation)
    between = (t > rotation.time[0]) & (t < rotation.time[-1])
    assert clean.friction_force[between] == approx(0.9, abs=1e-3)  # of 0.05


def test_less_than_a_turn_tells_no_wobble() -> None:
    with raises(InvalidInput, match=r"revolutions cover 0\.9 of a revolution"):
        remove_wobble(revolutions=np.linspace(0, 0.9, 100), friction_force=np.ones(100))


def test_a_harmonic_beyond_the_sampling_is_refused() -> None:
    with raises(InvalidInput, match="sampled too coarsely for 3 harmonics"):
        remove_wobble(revolutions=np.arange(0, 50, 0.25), friction_force=np.ones(200))


# -- motor


MOTOR = MotorCalibration(
    torque_constant=0.4,
    idle_current=0.55,
    groove_diameter=60e-3,
    torque_constant_uncertainty=0.02,
    idle_current_uncertainty=0.01,
)


def test_the_motor_current_balances_the_torque_of_friction() -> None:
    # 12 N at 30 mm are 0.36 N m, which at 0.4 N m/A take 0.9 A beyond the no-load current
    force, _ = friction_from_motor_current(MOTOR, motor_current=[1.45, 0.55])
    assert force[0] == approx(12.0)
    assert force[1] == 0.0


def test_the_uncertainty_from_the_motor_is_that_of_monte_carlo() -> None:
    n = 200_000
    torque_constant, no_load = RNG.normal(0.4, 0.02, n), RNG.normal(0.55, 0.01, n)
    force = torque_constant * (RNG.normal(1.45, 0.03, n) - no_load) / 30e-3
    _, uncertainty = friction_from_motor_current(MOTOR, motor_current=1.45, motor_current_uncertainty=0.03)
    assert uncertainty == approx(np.std(force), rel=0.01)


def test_a_recorded_current_becomes_friction_in_windows() -> None:
    t = seconds(10)
    trace = analyse_motor_current(recording(t, motor_current=np.where(t < 4, 1.45, 1.0)), motor=MOTOR)
    assert trace.friction_force == approx([12, 12, 6, 6, 6])
    assert trace.friction_force_uncertainty[0] == approx(np.hypot(0.4 * 0.01, 0.02 * 0.9) / 30e-3)


# -- what is refused


def test_a_missing_channel_is_named() -> None:
    with raises(InvalidInput, match="no channel 'friction_force'; did you mean friction_forces"):
        analyse_windows(recording(seconds(10), friction_forces=np.ones(4000)))


@pytest.mark.parametrize(
    ("force", "match"),
    [(np.full(10, np.nan), "holds no value among 10"), (np.full(10, np.inf), "infinite"), (np.ones(9), "must hold 10 numbers")],
)
def test_signals_without_sense_are_refused(force: np.ndarray, match: str) -> None:
    with raises(InvalidInput, match=match):
        friction_work(time=np.arange(10.0), friction_force=force, relative_velocity=np.ones(10))


def test_unsorted_time_is_refused() -> None:
    with raises(InvalidInput, match="time must increase, got 1 s"):
        window_statistics(np.ones(3), time=np.array([0.0, 2.0, 1.0]))
