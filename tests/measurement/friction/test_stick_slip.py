"""Stick-slip of signals with known frequency and amplitude."""

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from pytest import approx, raises
from scipy.signal import lfilter
from tests.same import same

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.stick_slip import estimate_stick_slip
from sonolube.measurement.friction_analysis import analyse_stick_slip

RNG = np.random.default_rng(7)
RATE = 400.0  # Hz, D 2.3.2


def seconds(duration: float, rate: float = RATE) -> np.ndarray:
    return np.arange(round(duration * rate)) / rate


def recording(time: np.ndarray, **channels: np.ndarray) -> xr.Dataset:
    return xr.Dataset({name: ("time", values) for name, values in channels.items()}, coords={"time": time})


@pytest.mark.parametrize("rate", [7.0, 13.7, 40.0])
def test_stick_slip_of_a_sawtooth_has_its_frequency_and_height(rate: float) -> None:
    t = seconds(10, 20_000)
    force = 1.0 + 0.25 * ((t * rate + 0.1) % 1.0)
    found = estimate_stick_slip(time=t, friction_force=force)
    assert found.detected
    assert found.stick_slip_frequency == approx(rate, rel=1e-3)
    assert found.spectral_frequency == approx(rate, rel=1e-3)
    assert found.stick_slip_amplitude == approx(0.25, rel=0.01)


def test_the_hundred_hertz_of_figure_2_17_cannot_be_seen_at_its_sampling_rate() -> None:
    t = seconds(2)
    found = analyse_stick_slip(recording(t, friction_force=1 + 0.28 * np.sin(2 * np.pi * 99 * t)))
    assert not found.detected
    assert not found.resolved
    assert found.spectral_frequency == approx(99, rel=0.01)
    assert "cannot be seen at this rate: the force swings at 99 Hz, 4 samples a period" in found.reason


def swinging(*, speed: float, rate: float, duration: float, seed: int = 1) -> tuple[np.ndarray, np.ndarray, float]:
    """Stick-slip of 50 g on 20 kN/m by the closed form of the slip, in noise of 30 mN; and the range of its force."""
    stiffness, pulse, excess = 20e3, np.sqrt(20e3 / 0.05), 0.315
    pull = stiffness * speed
    slip = 2 / pulse * (np.pi - np.arctan(pulse * excess / pull))
    period = slip + 2 * excess / pull
    t = seconds(duration, rate)
    since = (t + 0.0031) % period
    swing = excess * np.cos(pulse * since) + pull / pulse * np.sin(pulse * since)
    force = np.where(since < slip, swing, pull * (since - slip) - excess)
    noise = 0.03 * np.random.default_rng(seed).standard_normal(t.size)
    return t, 0.9 + force + noise, 2 * float(np.hypot(excess, pull / pulse))


@pytest.mark.parametrize("duration", [1.5, 4.4, 20.0])
@pytest.mark.parametrize("rate", [600.0, 1000.0, 10_000.0])
@pytest.mark.parametrize("speed", [1e-3, 5e-3, 10e-3, 20e-3])
def test_stick_slip_is_found_at_any_speed_rate_and_duration(speed: float, rate: float, duration: float) -> None:
    t, force, span = swinging(speed=speed, rate=rate, duration=duration)
    found = estimate_stick_slip(time=t, friction_force=force)
    assert found.detected
    assert found.stick_slip_amplitude == approx(span, rel=0.04)
    lower, upper = found.stick_slip_amplitude_interval
    assert lower < found.stick_slip_amplitude < upper <= np.ptp(force)
    assert lower - 0.02 * span < span < upper + 0.01 * span
    assert found.stick_slip_fraction > 0.9


@pytest.mark.parametrize("speed", [10e-3, 20e-3])
def test_below_six_samples_a_period_stick_slip_is_neither_found_nor_excluded(speed: float) -> None:
    t, force, _ = swinging(speed=speed, rate=400.0, duration=4.4)
    found = estimate_stick_slip(time=t, friction_force=force)
    assert (found.detected, found.resolved) == (False, False)


def test_a_longer_recording_of_jittering_slips_is_no_weaker_evidence() -> None:
    rng, rate = np.random.default_rng(6), 5000.0
    t = seconds(20, rate)
    slips = np.cumsum(0.02 * (1 + 0.03 * rng.standard_normal(1100)))
    force = 0.16 * ((t - np.concatenate([[0], slips])[np.searchsorted(slips, t)]) / 0.02 - 0.5)
    force += 0.08 * rng.standard_normal(t.size)
    for samples in (7500, 22_000, 50_000, t.size):
        found = estimate_stick_slip(time=t[:samples], friction_force=force[:samples])
        assert found.detected
        assert found.stick_slip_frequency == approx(50, rel=0.02)


NOISE: dict[str, Callable[[np.random.Generator, int], np.ndarray]] = {
    "random walk": lambda rng, n: np.cumsum(rng.standard_normal(n)),
    "white": lambda rng, n: rng.standard_normal(n),
    "1/f": lambda rng, n: np.fft.irfft(
        np.concatenate([[0], np.arange(1, n // 2 + 1) ** -0.5])
        * (rng.standard_normal(n // 2 + 1) + 1j * rng.standard_normal(n // 2 + 1)),
        n,
    ),
}


@pytest.mark.parametrize("kind", NOISE)
def test_noise_has_a_positive_frequency_and_no_stick_slip(kind: str) -> None:
    for seed in range(40):
        rng, rate = np.random.default_rng([99, seed]), (400, 1000, 2000)[seed % 3]
        t = seconds((2, 4, 10)[seed % 3], rate)
        found = estimate_stick_slip(time=t, friction_force=10 + NOISE[kind](rng, t.size))
        assert not found.detected
        assert 0 < found.spectral_frequency <= rate / 2


def test_a_resonance_in_noise_is_no_cycle_however_narrow() -> None:
    for damping in (0.02, 0.005):
        pole = np.exp((-damping + 1j) * 2 * np.pi * 100 / 1000)
        for seed in range(10):
            drive = np.random.default_rng(seed).standard_normal(12_000)
            force = lfilter([1.0], [1.0, -2 * pole.real, abs(pole) ** 2], drive)[2000:]
            assert not estimate_stick_slip(time=seconds(10, 1000), friction_force=50 + force).detected


def test_noise_is_not_detected_as_stick_slip() -> None:
    t = seconds(10)
    assert not estimate_stick_slip(time=t, friction_force=np.ones(t.size)).detected
    slow = np.cos(2 * np.pi * 0.5 * t) + RNG.normal(0, 0.5, t.size)
    found = estimate_stick_slip(time=t, friction_force=slow)
    assert not found.detected
    assert "spectrum peaks" in found.reason


def test_a_gap_is_cut_out_and_what_stands_before_and_after_it_is_used() -> None:
    t = seconds(10, 1000)
    force = 1 + 0.25 * ((8 * t) % 1) + 0.01 * np.random.default_rng(3).standard_normal(t.size)
    kept = np.delete(np.arange(t.size), slice(4000, 5500))
    found = estimate_stick_slip(time=t[kept], friction_force=force[kept])
    assert found.detected
    assert found.stick_slip_frequency == approx(8, rel=0.01)
    assert found.stick_slip_amplitude == approx(0.25, rel=0.02)
    assert [burst.start_time < 4.0 for burst in found.bursts] == [True, False]
    assert not any(burst.start_time < 4.0 < burst.end_time - 0.2 for burst in found.bursts)
    missing = np.where((t >= 4) & (t < 5.5), np.nan, force)
    same(estimate_stick_slip(time=t, friction_force=missing).force_drops, found.force_drops)


@pytest.mark.parametrize("kind", ["rounded", "jittering"])
def test_an_uneven_clock_is_made_even(kind: str) -> None:
    t = seconds(10, 600)
    force = 1 + 0.25 * ((8 * t) % 1) + 0.01 * np.random.default_rng(3).standard_normal(t.size)
    clock = np.round(t, 3) if kind == "rounded" else t + 5e-4 * np.random.default_rng(4).uniform(-1, 1, t.size)
    found = estimate_stick_slip(time=clock, friction_force=force)
    assert found.stick_slip_frequency == approx(8, rel=0.01)
    assert found.stick_slip_amplitude == approx(0.25, rel=0.03)


def test_too_few_even_samples_are_refused() -> None:
    with raises(InvalidInput, match="100 samples without an even stretch of 64"):
        estimate_stick_slip(time=np.cumsum(np.where(np.arange(100) % 30, 1.0, 9.0)), friction_force=np.ones(100))


def sawtooth(rng: np.random.Generator, t: np.ndarray, *, noise: float) -> np.ndarray:
    """Twelve falls of 160 mN at 8 Hz in noise."""
    inside = (t >= 1.0) & (t < 2.5)
    return 0.9 + np.where(inside, 0.160 * ((8 * (t - 1.0)) % 1 - 0.5), 0.0) + noise * rng.standard_normal(t.size)


@pytest.mark.parametrize("noise", [0.005, 0.010, 0.020, 0.040, 0.080])
def test_noise_up_to_half_the_fall_neither_hides_nor_enlarges_the_fall(noise: float) -> None:
    rng, t = np.random.default_rng(8), seconds(4, 1000)
    found = [estimate_stick_slip(time=t, friction_force=sawtooth(rng, t, noise=noise)) for _ in range(20)]
    assert all(one.detected for one in found)
    falls = np.array([one.stick_slip_amplitude for one in found])
    errors = np.array([one.stick_slip_amplitude_uncertainty for one in found])
    assert np.mean(falls) == approx(0.160, abs=4 * np.sqrt(np.mean(errors**2) / 20) + 1e-4)
    covered = [one.stick_slip_amplitude_interval[0] <= 0.160 <= one.stick_slip_amplitude_interval[1] for one in found]
    assert np.mean(covered) >= 0.75  # 95 % but with a probability below 1e-3


def test_rises_as_sudden_as_slips_are_no_stick_slip() -> None:
    t = seconds(4, 1000)
    reversed_in_time = sawtooth(np.random.default_rng(9), t, noise=0.01)[::-1]
    assert not estimate_stick_slip(time=t, friction_force=reversed_in_time).detected


def test_hum_and_wobble_are_no_stick_slip() -> None:
    rng, t = np.random.default_rng(10), seconds(4, 1000)
    force = 0.05 * np.sin(2 * np.pi * 50 * t) + 0.06 * np.sin(2 * np.pi * 0.75 * t) + 0.01 * rng.standard_normal(t.size)
    assert not estimate_stick_slip(time=t, friction_force=1 + force).detected


def test_the_ringing_of_the_sensor_does_not_enlarge_the_fall() -> None:
    t = seconds(4, 2000)
    since = (8 * t) % 1 / 8
    ringing = 0.160 * np.exp(-0.02 * 2 * np.pi * 200 * since) * np.cos(2 * np.pi * 200 * since)
    force = 0.9 + 0.160 * 8 * since + ringing + 0.002 * np.random.default_rng(11).standard_normal(t.size)
    assert estimate_stick_slip(time=t, friction_force=force).stick_slip_amplitude == approx(0.160, rel=0.01)


def test_a_slip_that_takes_time_falls_by_less_than_the_extended_ramps() -> None:
    t = seconds(4, 2000)
    phase = (8 * t) % 1
    force = 0.9 + 0.160 * np.where(phase < 0.9, phase / 0.9, (1 - phase) / 0.1)
    force += 0.001 * np.random.default_rng(12).standard_normal(t.size)
    assert estimate_stick_slip(time=t, friction_force=force).stick_slip_amplitude == approx(0.160, rel=0.02)


def test_a_smaller_fall_than_asked_for_is_not_counted() -> None:
    t = seconds(4, 1000)
    force = sawtooth(np.random.default_rng(13), t, noise=0.01)
    found = estimate_stick_slip(time=t, friction_force=force, minimum_drop=0.3)
    assert not found.detected
    assert "falls by 0.1" in found.reason
