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
