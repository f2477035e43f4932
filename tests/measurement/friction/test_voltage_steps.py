"""Friction at the voltage steps of D 4.1.2, found in recordings made of Table 4.2."""

import numpy as np
import pytest
import xarray as xr
from pytest import raises
from tests.same import approx

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.step_means import StepMeans
from sonolube.measurement.friction.voltage_steps import (
    VoltageStep,
    _reductions,
    _slid,
    _zero,
    friction_at_voltage_steps,
    rotation_speed_at_voltage_steps,
    rotation_speed_uncertainty,
    voltage_envelope,
)
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


def test_voltage_steps_without_one_at_zero_voltage_have_friction_but_no_reduction() -> None:
    t, force, volts = published_voltage_steps()
    steps = friction_at_voltage_steps(time=t, friction_force=force, voltage_peak_to_peak=volts + 5)
    assert [step.friction_force for step in steps] == approx(list(FORCES))
    assert [step.friction_reduction for step in steps] == 6 * [None]


def after_rest(seed: int = 3) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Coast-down for 0.3 s, rest to 2 s, a break-away peak, sliding to 32 s with steps from 12 s on, rest to 50 s."""
    t = seconds(50)
    volts = np.select([(t >= 12) & (t < 22), (t >= 22) & (t < 32)], [10.0, 20.0], 0.0)
    level = 0.9 * np.select([volts == 10, volts == 20], [0.6, 0.05], 1.0)
    moving = (t < 0.3) | ((t >= 2) & (t < 32))
    force = np.where(moving, level, 0.0) + np.where((t >= 2) & (t < 2.05), 0.4, 0.0)
    force += 0.03 * np.random.default_rng(seed).standard_normal(t.size)
    return t, force, volts, moving


@pytest.mark.parametrize("told_by", ["force", "measured speed", "motor as set"])
def test_rest_and_break_away_are_no_friction_without_vibration(told_by: str) -> None:
    t, force, volts, moving = after_rest()
    channels = {"measured speed": {"sliding_speed": 0.02 * moving}, "motor as set": {"motor_on": 1.0 * moving}}
    given = recording(t, friction_force=force, voltage_peak_to_peak=volts, **channels.get(told_by, {}))
    steps = analyse_voltage_steps(given)
    assert [step.voltage_peak_to_peak for step in steps] == [0, 10, 20]
    assert steps[0].start_time == approx(2, abs=0.1)
    assert steps[-1].end_time == approx(32, abs=0.15)
    assert [step.friction_force for step in steps] == approx([0.9, 0.54, 0.045], abs=0.005)
    assert [step.friction_reduction for step in steps[1:]] == approx([0.4, 0.95], abs=0.01)
    assert not any(step.stick_slip.detected for step in steps)


def test_a_step_at_which_vibration_leaves_almost_no_friction_is_no_rest() -> None:
    t, force, volts, _ = after_rest()
    force = np.where(volts == 20, 0.0, force)
    steps = friction_at_voltage_steps(time=t, friction_force=force, voltage_peak_to_peak=volts)
    assert steps[-1].friction_reduction == approx(1.0, abs=1e-3)


def test_a_change_of_the_speed_begins_a_step_with_its_own_reduction() -> None:
    t = seconds(40)
    volts, speed = np.where((t // 10) % 2 == 1, 20.0, 0.0), np.where(t < 20, 0.02, 0.06)
    level = np.select([t < 10, t < 20, t < 30], [0.9, 0.45, 0.6], 0.48)
    force = level + 0.02 * np.random.default_rng(5).standard_normal(t.size)
    given = recording(t, friction_force=force, voltage_peak_to_peak=volts, sliding_speed_set=speed)
    steps = analyse_voltage_steps(given)
    assert [step.sliding_speed for step in steps] == approx([0.02, 0.02, 0.06, 0.06])
    assert [step.friction_reduction for step in steps] == [None, approx(0.5, abs=0.01), None, approx(0.2, abs=0.01)]


def test_noise_of_the_channel_of_the_voltage_is_no_step() -> None:
    rng, t = np.random.default_rng(8), seconds(40)
    force, monitor = 0.9 + 0.03 * rng.standard_normal(t.size), 2e-3 * np.abs(rng.standard_normal(t.size))
    (step,) = friction_at_voltage_steps(time=t, friction_force=force, voltage_peak_to_peak=monitor)
    assert step.friction_reduction is None
    assert step.friction_force == approx(0.9, abs=0.005)


def test_the_envelope_of_a_sine_is_its_peak_to_peak_value() -> None:
    t = seconds(2, 10_000)
    envelope = voltage_envelope(time=t, stack_voltage=3 + 4 * np.sin(2 * np.pi * 331 * t))
    assert envelope == approx(8.0, rel=1e-2)


def stepped(
    seed: int, *, speed: float = 1 / 1.34, noise: float = 0.005, revolutions: bool = False
) -> list[VoltageStep]:
    """Steps of D 4.1.2 with a wobble of 60 and 24 mN and two bursts of stick-slip of 160 mN, at 1 kHz."""
    t, force, volts = published_voltage_steps(1000.0)
    force = force + 0.060 * np.cos(2 * np.pi * speed * t + seed) + 0.024 * np.cos(4 * np.pi * speed * t)
    for start, end in ((17.5, 19.0), (25.5, 27.0)):
        force += np.where((t >= start) & (t < end), 0.160 * ((10 * (t - start)) % 1 - 0.5), 0.0)
    force += noise * np.random.default_rng(seed).standard_normal(t.size)
    turned = speed * t if revolutions else None
    return list(friction_at_voltage_steps(time=t, friction_force=force, voltage_peak_to_peak=volts, revolutions=turned))


def test_means_and_reductions_under_wobble_and_stick_slip_err_by_as_much_as_is_stated() -> None:
    means, reductions = [], []
    for seed in range(12):
        steps = stepped(seed, revolutions=seed % 2 == 0)
        means += [(s.friction_force - f) / s.friction_force_uncertainty for s, f in zip(steps, FORCES, strict=True)]
        reductions += [
            ((s.friction_reduction or 0) - 1 + f / FORCES[0]) / (s.friction_reduction_uncertainty or 1)
            for s, f in zip(steps[1:], FORCES[1:], strict=True)
        ]
    assert np.sqrt(np.mean(np.square(means))) == approx(1.0, abs=0.3)
    assert np.sqrt(np.mean(np.square(reductions))) == approx(1.0, abs=0.3)


def test_stick_slip_is_found_at_the_steps_that_have_it_and_when() -> None:
    steps = stepped(1, noise=0.01)
    assert [step.stick_slip.detected for step in steps] == [False, False, True, False, True, False]
    (burst,) = steps[2].stick_slip.bursts
    assert burst.start_time == approx(17.5, abs=0.11)  # a period
    assert burst.end_time == approx(19.0, abs=0.11)
    assert steps[4].stick_slip.stick_slip_frequency == approx(10, rel=0.01)
    assert steps[4].stick_slip.stick_slip_fraction == approx(1.5 / 3.45, abs=0.05)


def test_a_step_shorter_than_a_turn_is_less_certain() -> None:
    slow, fast = stepped(2, speed=0.11, revolutions=True), stepped(2, revolutions=True)
    assert slow[1].friction_force_uncertainty > 1.05 * fast[1].friction_force_uncertainty
    assert slow[1].friction_force == approx(0.85, abs=5 * slow[1].friction_force_uncertainty)


def test_rest_before_the_motor_starts_and_a_run_in_leave_the_steady_mean() -> None:
    t, force, volts = published_voltage_steps(1000.0)
    force = np.where(t < 0.9, 0.0, force + 0.2 * np.exp(-(t - 0.9) / 1.5))
    force += 0.005 * np.random.default_rng(3).standard_normal(t.size)
    first = friction_at_voltage_steps(time=t, friction_force=force, voltage_peak_to_peak=volts)[0]
    assert first.friction_force == approx(0.89, abs=4 * first.friction_force_uncertainty)
    assert first.friction_force_uncertainty < 1e-3


def test_the_speed_of_the_disc_is_found_in_the_friction() -> None:
    t, force, volts = published_voltage_steps()
    wobbling = force + 0.03 * np.sin(2 * np.pi * t / 1.34)
    found = rotation_speed_at_voltage_steps(time=t, friction_force=wobbling, voltage_peak_to_peak=volts)
    assert found == approx(1 / 1.34, rel=1e-3)
    noise = force + 0.03 * np.random.default_rng(4).standard_normal(t.size)
    assert rotation_speed_at_voltage_steps(time=t, friction_force=noise, voltage_peak_to_peak=volts) is None


def test_an_envelope_needs_eight_samples_of_even_time_and_leaves_out_missing_ones() -> None:
    t = seconds(1, 1000)
    u = np.where(t < 0.5, 2.0, -1.0)
    u[700:] = np.nan
    found = voltage_envelope(time=t, stack_voltage=u, window_duration=0.009)  # nine samples: four on either side
    assert found[:496] == approx(0.0)
    assert found[496:504] == approx(3.0)
    assert found[504:704] == approx(0.0)
    assert np.isnan(found[704:]).all()
    with raises(InvalidInput, match=r"window_duration of 0\.007 s holds 7 samples; at least 8 are needed"):
        voltage_envelope(time=t, stack_voltage=u, window_duration=0.007)
    assert voltage_envelope(time=t, stack_voltage=u, window_duration=0.008).size == 1000
    with raises(InvalidInput, match="time must be evenly spaced"):
        voltage_envelope(time=np.delete(t, 300), stack_voltage=np.delete(u, 300))


def test_the_distance_slid_is_a_time_at_the_mean_speed_while_sliding() -> None:
    t, v = np.array([0.0, 1.0, 3.0, 4.0, 6.0]), np.array([0.0, -2.0, np.nan, -2.0, -4.0])
    # speeds 0, 2, 2, 2, 4: distances 0, 1, 5, 7, 13; mean while sliding 2.5
    assert _slid(t, v) == approx(np.array([0, 1, 5, 7, 13]) / 2.5)
    assert _slid(t + 3, 0 * t) == approx(t)


def test_a_force_at_rest_is_a_zero_up_to_three_tenths_of_the_level_from_twenty_samples_on() -> None:
    rest = 0.02 + 0.01 * np.tile([1.0, -1.0, -1.0, 1.0], 10)
    mean, variance = _zero(rest, np.array([1.0, 0.5]))
    assert mean == approx(0.02)
    assert np.sqrt(variance) == approx(np.std(rest, ddof=1) / np.sqrt(40), rel=0.3)
    assert _zero(rest[:19], np.array([1.0])) == (0.0, 0.0)
    assert _zero(rest[:20], np.array([1.0]))[0] == approx(0.02)
    assert _zero(rest + 0.27, np.array([1.0, 0.5]))[0] == approx(0.29)
    assert _zero(rest + 0.29, np.array([1.0, 0.5])) == (0.0, 0.0)  # of a holder under tension
    loud = 0.35 + 0.5 * np.tile([1.0, -1.0, -1.0, 1.0], 10)
    assert _zero(loud, np.array([1.0]))[0] == approx(0.35)  # below its own scatter


def test_a_reduction_is_against_the_weighted_levels_of_its_speed_with_the_covariance_of_all() -> None:
    force = np.array([1.0, 1.2, 0.4, 2.0, 0.5])
    covariance = np.diag([0.01, 0.02, 0.03, 0.04, 0.05]) + 0.001
    means = StepMeans(friction_force=force, covariance=covariance)
    without = np.array([True, True, False, True, False])
    speeds = [0.02, 0.0205, 0.02, 0.06, 0.09]
    found = _reductions(means, without, speeds, np.array([100, 300, 50, 80, 70]))
    assert [found[k] for k in (0, 1, 3, 4)] == [(None, None)] * 4  # at 0.09 m/s nothing is known without voltage
    intrinsic = 0.25 * 1.0 + 0.75 * 1.2
    reduction, error = found[2]
    assert reduction == approx(1 - 0.4 / intrinsic)
    gradient = np.array([0.25 * 0.4 / intrinsic**2, 0.75 * 0.4 / intrinsic**2, -1 / intrinsic, 0, 0])
    assert error == approx(np.sqrt(gradient @ covariance @ gradient))


def test_a_step_states_its_span_deviation_and_speed() -> None:
    t = seconds(20)
    force = 1 + 0.05 * np.random.default_rng(2).standard_normal(t.size)
    (step,) = friction_at_voltage_steps(
        time=t, friction_force=force, voltage_peak_to_peak=0 * t, sliding_speed=0 * t + 0.03, settling_time=2.0
    )
    assert (step.start_time, step.end_time) == approx((0.0, 19.9975))
    assert step.friction_force_deviation == approx(np.std(force[800:-80], ddof=1), rel=1e-3)
    independent = 0.05 / np.sqrt(7120)
    assert 0.8 * independent < step.friction_force_uncertainty < 5 * independent  # one part may settle, unseen
    assert (step.sliding_speed, step.force_zero, step.friction_reduction) == (approx(0.03), 0.0, None)
    with raises(InvalidInput, match="equal in length"):
        friction_at_voltage_steps(time=t, friction_force=force, voltage_peak_to_peak=0 * t, revolutions=t[:9])


def test_a_rotation_found_by_the_wobble_errs_as_its_uncertainty_states() -> None:
    t = np.arange(0, 30, 0.02)
    voltage = np.where(t > 15, 10.0, 0.0)
    wobble = 0.04 * np.cos(2 * np.pi * 0.7 * t + 1) + 0.01 * np.cos(4 * np.pi * 0.7 * t)
    deviations = []
    for seed in range(12):
        noise = 0.04 * np.random.default_rng(seed).standard_normal(t.size)
        force = np.where(t > 15, 0.6, 1.0) + wobble + noise
        speed = rotation_speed_at_voltage_steps(time=t, friction_force=force, voltage_peak_to_peak=voltage)
        assert speed is not None
        stated = rotation_speed_uncertainty(
            time=t, friction_force=force, voltage_peak_to_peak=voltage, rotation_speed=speed
        )
        deviations.append((speed - 0.7) / stated)
        # one harmonic of amplitude a in white noise s of N samples over T: s sqrt(6 / N) / (pi T a)
        assert stated == approx(0.04 * np.sqrt(6 / t.size) / (np.pi * 30 * 0.04), rel=0.4)
    assert 0.45 < np.sqrt(np.mean(np.square(deviations))) < 1.6  # of 12 standard normal numbers in 99.8 % of cases
