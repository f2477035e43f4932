"""Stick-slip of signals with known frequency and amplitude."""

import numpy as np
import pytest
import xarray as xr
from pytest import approx, raises

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


def test_the_hundred_hertz_of_figure_2_17_are_detected_at_its_sampling_rate() -> None:
    t = seconds(2)
    found = analyse_stick_slip(recording(t, friction_force=1 + 0.28 * np.sin(2 * np.pi * 99 * t)))
    assert found.detected
    assert found.stick_slip_frequency == approx(99, rel=0.01)


def test_noise_is_not_detected_as_stick_slip() -> None:
    t = seconds(10)
    assert not estimate_stick_slip(time=t, friction_force=np.ones(t.size)).detected
    slow = np.cos(2 * np.pi * 0.5 * t) + RNG.normal(0, 0.5, t.size)
    found = estimate_stick_slip(time=t, friction_force=slow)
    assert not found.detected
    assert "spectrum peaks" in found.reason


def test_stick_slip_in_a_recording_with_a_gap_is_refused_with_its_time() -> None:
    t = np.delete(seconds(10), slice(1000, 1003))
    with raises(InvalidInput, match=r"after 2\.4975 s samples were dropped"):
        estimate_stick_slip(time=t, friction_force=np.sin(t))


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
