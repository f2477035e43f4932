import numpy as np
import pytest
from hypothesis import assume, given, strategies as st
from pytest import approx, raises
from scipy import signal

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.dynamics.waveform import (
    WAVEFORMS,
    PiecewiseLinear,
    StartUpRamp,
    Waveform,
    drive_voltage,
    fourier_coefficients,
    jump_phases,
    ramp_factor,
    sampled_waveform,
    waveform_extremes,
    waveform_value,
)

PULSES = sampled_waveform([0, 0, 0, 1, 4, 1, 0, -0.5])
ALL = [*WAVEFORMS.values(), PULSES]
names = st.sampled_from(sorted(WAVEFORMS))
phases = st.floats(-100, 100)


def fundamental(name: str) -> float:
    return float(2 * np.abs(fourier_coefficients(WAVEFORMS[name], 1)[1]))


@pytest.mark.parametrize(
    ("name", "amplitude"), [("sine", 1.0), ("square", 4 / np.pi), ("triangle", 8 / np.pi**2), ("sawtooth", 2 / np.pi)]
)
def test_the_fundamental_amplitude_is_the_textbook_value(name: str, amplitude: float) -> None:
    assert 2 * fundamental(name) == approx(amplitude)


def test_the_fundamental_decreases_from_square_to_sine_to_triangle_to_sawtooth() -> None:
    # D 3.3.5, figure 3.18
    ranked = sorted(WAVEFORMS, key=fundamental, reverse=True)
    assert ranked == ["square", "sine", "triangle", "sawtooth"]


@pytest.mark.parametrize(
    ("name", "reference"),
    [
        ("sine", np.sin),
        ("square", signal.square),
        ("triangle", lambda theta: signal.sawtooth(theta + np.pi / 2, 0.5)),
        ("sawtooth", lambda theta: signal.sawtooth(theta + np.pi)),
    ],
)
def test_waveforms_are_half_those_of_scipy_signal(name: str, reference: object) -> None:
    theta = np.linspace(-9, 9, 501)
    assert callable(reference)
    assert waveform_value(WAVEFORMS[name], phase=theta) == approx(0.5 * reference(theta))


@pytest.mark.parametrize("waveform", ALL)
def test_the_mean_square_is_the_sum_of_squared_harmonics_by_parseval(waveform: Waveform) -> None:
    theta = (np.arange(200_000) + 0.5) * 2 * np.pi / 200_000
    mean_square = float(np.mean(waveform_value(waveform, phase=theta) ** 2))
    count = 100_000
    assert 2 * float(np.sum(np.abs(fourier_coefficients(waveform, count)) ** 2)) == approx(mean_square, abs=1e-5)


@pytest.mark.parametrize("waveform", ALL)
def test_coefficients_are_the_integrals_that_define_them(waveform: Waveform) -> None:
    points = 1 << 20
    samples = waveform_value(waveform, phase=(np.arange(points) + 0.5) * 2 * np.pi / points)
    k = np.arange(13)
    measured = np.fft.rfft(samples)[:13] / points * np.exp(-1j * np.pi * k / points)
    assert fourier_coefficients(waveform, 12) == approx(measured, abs=1e-9)


@pytest.mark.parametrize("waveform", ALL)
def test_the_fourier_series_converges_away_from_jumps(waveform: Waveform) -> None:
    theta = np.array([0.3, 1.1, 2.0, 2.9, 4.0, 5.5])

    def error(count: int) -> float:
        k = np.arange(1, count + 1)
        synthesis = 2 * (np.exp(1j * np.multiply.outer(theta, k)) @ fourier_coefficients(waveform, count)[1:]).real
        return float(np.abs(synthesis - waveform_value(waveform, phase=theta)).max())

    assert error(20_000) < 2e-4
    assert error(20_000) <= max(error(200), 1e-12)


@given(name=names, phase=phases)
def test_half_a_period_reverses_the_sign_of_all_but_the_sawtooth(name: str, phase: float) -> None:
    assume(name != "sawtooth")
    assume(abs(phase / np.pi - round(phase / np.pi)) > 1e-9)
    here = waveform_value(WAVEFORMS[name], phase=phase)
    assert waveform_value(WAVEFORMS[name], phase=phase + np.pi) == approx(-here, abs=1e-9)
    assert fourier_coefficients(WAVEFORMS[name], 8)[2::2] == approx(np.zeros(4), abs=1e-12)


@given(name=names, phase=phases)
def test_every_named_waveform_is_odd(name: str, phase: float) -> None:
    assume(abs(phase / np.pi - round(phase / np.pi)) > 1e-9)
    forth, back = waveform_value(WAVEFORMS[name], phase=[phase, -phase])
    assert forth == approx(-back, abs=1e-12)
    assert fourier_coefficients(WAVEFORMS[name], 8).real == approx(np.zeros(9), abs=1e-12)


def test_the_value_at_a_jump_is_the_one_after_it() -> None:
    assert (
        jump_phases(WAVEFORMS["sine"]).size == jump_phases(WAVEFORMS["triangle"]).size == jump_phases(PULSES).size == 0
    )
    assert jump_phases(WAVEFORMS["square"]) == approx(np.array([0, np.pi]))
    assert jump_phases(WAVEFORMS["sawtooth"]) == approx(np.pi)
    assert waveform_value(WAVEFORMS["square"], phase=[0.0, np.pi]) == approx(np.array([0.5, -0.5]))
    assert waveform_value(WAVEFORMS["sawtooth"], phase=np.pi) == approx(-0.5)


@given(
    samples=st.lists(st.floats(-1e6, 1e6), min_size=2, max_size=30), scale=st.floats(0.1, 10), shift=st.floats(-10, 10)
)
def test_a_sampled_waveform_passes_through_its_normalised_samples(
    samples: list[float], scale: float, shift: float
) -> None:
    given_samples: Floats = np.array(samples)
    assume(np.ptp(given_samples) > 1e-3)
    waveform = sampled_waveform(given_samples)
    theta = np.arange(len(samples)) * 2 * np.pi / len(samples)
    normal = (given_samples - given_samples.mean()) / np.ptp(given_samples)
    # a sample may fall an ulp before its phase, on the piece that leads to it
    assert waveform_value(waveform, phase=theta + 1e-12) == approx(normal, abs=1e-9)
    lowest, highest = waveform_extremes(waveform)
    assert highest - lowest == approx(1.0)
    again = sampled_waveform(scale * given_samples + shift * np.ptp(given_samples))
    assert fourier_coefficients(again, 5) == approx(fourier_coefficients(waveform, 5), abs=1e-9)


def test_many_samples_of_a_sine_are_a_sine() -> None:
    sampled = sampled_waveform(np.sin(2 * np.pi * np.arange(1000) / 1000))
    assert fourier_coefficients(sampled, 5) == approx(fourier_coefficients(WAVEFORMS["sine"], 5), abs=1e-5)


def test_the_drive_voltage_oscillates_about_its_offset() -> None:
    t = np.linspace(0, 1 / 22e3, 10_001)
    volts = drive_voltage(
        WAVEFORMS["triangle"], voltage_offset=75.0, voltage_peak_to_peak=150.0, frequency=22e3, time=t
    )
    assert volts.min() == approx(0.0, abs=0.1)
    assert volts.max() == approx(150.0, abs=0.1)
    assert volts[:-1].mean() == approx(75.0)
    assert volts[0] == approx(volts[-1], abs=1e-6)


def test_a_drive_about_a_negative_offset_is_the_mirror_of_that_about_a_positive_one() -> None:
    t = np.linspace(0, 1 / 22e3, 1001)
    volts = drive_voltage(WAVEFORMS["sine"], voltage_offset=-75.0, voltage_peak_to_peak=150.0, frequency=22e3, time=t)
    assert volts.min() == approx(-150.0, abs=0.01)
    assert volts.max() == approx(0.0, abs=0.01)
    assert volts.mean() == approx(-75.0, abs=0.1)


@pytest.mark.parametrize("shape", ["linear", "cosine"])
def test_a_ramp_rises_from_zero_to_one(shape: str) -> None:
    ramp = StartUpRamp(duration=0.02, shape=shape)
    share = ramp_factor(ramp, time=[-1.0, 0.0, 0.01, 0.02, 5.0])
    assert share == approx(np.array([0, 0, 0.5, 1, 1]))
    assert np.all(np.diff(ramp_factor(ramp, time=np.linspace(0, 0.02, 100))) > 0)


def test_a_ramp_of_zero_duration_is_a_step() -> None:
    assert ramp_factor(StartUpRamp(duration=0.0), time=[-1e-9, 0.0, 1.0]).tolist() == [0, 1, 1]


# -- refusals


def test_a_sample_that_is_not_finite_is_refused_by_its_index() -> None:
    with raises(InvalidInput, match=r"samples\[2\] must be finite, got nan"):
        sampled_waveform([0, 1, np.nan, np.inf])


@pytest.mark.parametrize(
    ("samples", "message"),
    [
        ([1.0], r"samples must be at least two on one axis, got shape \(1,\)"),
        ([[1.0, 2.0]], r"samples must be at least two on one axis, got shape \(1, 2\)"),
        ([3.0, 3.0], r"samples must not all be equal, got 3\.0 throughout"),
    ],
)
def test_too_few_or_equal_samples_are_refused(samples: list[float], message: str) -> None:
    with raises(InvalidInput, match=message):
        sampled_waveform(samples)


@pytest.mark.parametrize(
    ("starts_at", "first", "last", "message"),
    [
        ([0.0, 7.0], [0.5, -0.5], [0.5, -0.5], r"starts_at must increase, and lie between 0 and 2 pi"),
        ([1.0, 0.0], [0.5, -0.5], [0.5, -0.5], r"starts_at must increase"),
        ([0.0], [0.5, -0.5], [0.5, -0.5], r"one axis and the same length"),
        ([0.0, np.pi], [1.0, 0.0], [1.0, 0.0], r"must have mean 0 and peak to peak 1, got 0\.5 and 1"),
        ([0.0, np.pi], [1.0, -1.0], [1.0, -1.0], r"must have mean 0 and peak to peak 1, got 0 and 2"),
    ],
)
def test_inconsistent_pieces_of_a_waveform_are_refused(
    starts_at: list[float], first: list[float], last: list[float], message: str
) -> None:
    with raises(InvalidInput, match=message):
        PiecewiseLinear(starts_at=np.array(starts_at), first=np.array(first), last=np.array(last))


def test_invalid_counts_durations_and_shapes_are_refused() -> None:
    with raises(InvalidInput, match=r"count must not be negative, got -1"):
        fourier_coefficients(WAVEFORMS["sine"], -1)
    with raises(InvalidInput, match=r"duration must not be negative, got -1\.0 s"):
        StartUpRamp(duration=-1.0)
    with raises(UnknownName, match=r"unknown ramp 'cosin'; did you mean cosine\?"):
        StartUpRamp(duration=1.0, shape="cosin")
    with raises(InvalidInput, match=r"frequency must be positive, got 0\.0 Hz"):
        drive_voltage(WAVEFORMS["sine"], voltage_offset=0, voltage_peak_to_peak=1, frequency=0, time=0)
