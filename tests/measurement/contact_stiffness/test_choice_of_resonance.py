"""Fits of resonances of one known mode, the choice among several, and the first-order formulas of the estimate."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.contact_stiffness.analysis import _between, _fit, _pressed, measured_contact_stiffness
from sonolube.measurement.contact_stiffness.large_vibration import equivalent_stiffness_ratio
from sonolube.measurement.contact_stiffness.resonance_fit import (
    Resonance,
    ResonanceFit,
    _overlap,
    _Problem,
    _Solution,
    fit_resonances,
)
from sonolube.measurement.contact_stiffness.resonance_spectrum import (
    ResonanceSpectrum,
    read_resonance_spectrum,
    vibration_spectrum,
)
from sonolube.measurement.contact_stiffness.stiffness_estimate import LogEstimate, contact_stiffness, single_mode

F = np.linspace(900.0, 1100.0, 201)


def mode(frequency: float, quality: float) -> np.ndarray:
    """Response of one mode whose magnitude is 1 at its frequency."""
    return np.asarray(frequency**2 / quality / (frequency**2 - F**2 + 1j * F * frequency / quality))


def resonance(frequency: float, *, uncertainty: float = 1.0, height: float = 0.5) -> Resonance:
    return Resonance(
        frequency=frequency, frequency_uncertainty=uncertainty, quality_factor=50.0, relative_height=height
    )


def fit_of(*resonances: Resonance) -> ResonanceFit:
    return ResonanceFit(
        spectrum=vibration_spectrum(frequency=F, response=mode(1000.0, 50.0)),
        resonances=resonances,
        fitted=mode(1000.0, 50.0),
        residual_correlation=1.0,
        caveats=(),
    )


@pytest.mark.parametrize("with_phase", [True, False])
def test_one_mode_has_its_frequency_quality_height_and_error(with_phase: bool) -> None:
    noise, errors, found = 2e-3, [], []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        response = 3 * mode(1003.0, 60.0) + 3 * noise * (rng.standard_normal(F.size) + 1j * rng.standard_normal(F.size))
        fit = fit_resonances(
            vibration_spectrum(frequency=F, response=response if with_phase else np.abs(response)), modes=1
        )
        (one,) = fit.resonances
        found.append(one.frequency)
        errors.append(one.frequency_uncertainty)
        assert one.quality_factor == approx(60.0, rel=0.03)
        assert one.relative_height == approx(1.0, abs=0.05)
        assert one.half_width == approx(one.frequency / 2 / one.quality_factor)
        assert np.abs(fit.fitted) == approx(np.abs(response), abs=5 * 3 * noise)
        assert fit.caveats == ()
        assert fit.residual_correlation < 3
    assert np.mean(found) == approx(1003.0, abs=4 * np.mean(errors) / np.sqrt(12))
    assert np.std(found) == approx(np.mean(errors), rel=0.6)


def test_a_weak_mode_beside_a_strong_one_is_found_by_the_criterion() -> None:
    rng = np.random.default_rng(1)
    noise = 1e-3 * (rng.standard_normal(F.size) + 1j * rng.standard_normal(F.size))
    fit = fit_resonances(vibration_spectrum(frequency=F, response=mode(960.0, 80.0) + 0.2 * mode(1050.0, 90.0) + noise))
    assert [one.frequency for one in fit.resonances] == approx([960.0, 1050.0], abs=0.3)
    assert [one.relative_height for one in fit.resonances] == approx([1.0, 0.2], abs=0.03)
    assert fit.strongest().frequency == approx(960.0, abs=0.3)
    assert fit.nearest(1010.0).frequency == approx(1050.0, abs=0.3)


def test_a_sweep_that_shows_more_than_its_modes_is_said() -> None:
    response = mode(1000.0, 50.0) + 0.1 * np.sin(F / 4)
    fit = fit_resonances(vibration_spectrum(frequency=F, response=response), modes=1)
    assert "residuals of the fit are correlated over" in fit.caveats[0]
    assert fit.residual_correlation > 3


def test_the_criterion_counts_three_parameters_for_each_shape() -> None:
    solution = _Solution(
        shape=np.zeros(4), residuals=np.array([0.1, -0.3, 0.2]), covariance=np.zeros((4, 4)), correlation=1.0
    )
    assert solution.criterion == approx(3 * np.log(0.14 / 3) + 12 * np.log(3))
    exact = replace(solution, residuals=np.zeros(3))
    assert exact.criterion == approx(3 * np.log(1e-24) + 12 * np.log(3))


def test_two_modes_overlap_within_an_eighth_of_the_narrower_width() -> None:
    # widths 10 and 20 Hz
    assert _overlap(np.array([[1001.2, 50.06], [1000.0, 100.0]]))
    assert not _overlap(np.array([[1001.3, 50.065], [1000.0, 100.0]]))
    assert not _overlap(np.array([[1000.0, 100.0]]))


def test_a_mode_lies_within_the_sweep_or_near_its_ends_and_no_further() -> None:
    problem = _Problem(vibration_spectrum(frequency=F, response=mode(1000.0, 50.0)))
    assert problem.is_within(900 / 1.59, 50.0)
    assert not problem.is_within(900 / 1.61, 50.0)
    assert problem.is_within(1100 * 1.59, 50.0)
    assert not problem.is_within(1100 * 1.61, 50.0)
    assert not problem.is_within(1000.0, 0.59)
    assert problem.is_within(1000.0, 0.61)
    assert not problem.is_within(1000.0, 1.1e7)
    shape = np.log([1100.5, 50.0, 950.0, 50.0, 899.0, 50.0, 920.0, 9.0])
    solution = _Solution(shape=shape, residuals=np.zeros(3), covariance=np.eye(8), correlation=1.0)
    assert problem.inside(solution) == [3, 1]
    for variance, determined in ((0.29**2, True), (0.31**2, False)):
        covariance = np.diag([9.0, 9, 0.01, 0.01, 9, 9, 0.01, variance])  # those outside do not count
        assert problem.is_determined(replace(solution, covariance=covariance)) == determined


def test_the_pressed_resonance_is_near_a_stated_frequency_or_the_next_above_the_free_one() -> None:
    fit = fit_of(*(resonance(f) for f in (940.0, 985.0, 1030.0)))
    free = [resonance(1000.0)]
    assert _pressed(fit, free, 930.0).frequency == 940.0
    assert _pressed(fit, [], None).frequency == 940.0
    assert _pressed(fit, free, None).frequency == 1030.0
    # room of four times both uncertainties: 8 Hz, and with 2 Hz each 16 Hz
    assert _pressed(fit, [resonance(1000.0, uncertainty=3.0)], None).frequency == 985.0
    assert _pressed(fit, [resonance(1000.0), resonance(1009.0)], None).frequency == 985.0  # of their spread too
    assert _pressed(fit, [resonance(1090.0)], None).frequency == 1030.0  # none above: the nearest


def test_the_resonance_at_large_drive_is_the_strongest_between_free_and_pressed() -> None:
    fit = fit_of(resonance(940.0, height=0.9), resonance(985.0, height=0.2), resonance(1030.0, height=0.4))
    assert _between(fit, [resonance(950.0)], resonance(1040.0)).frequency == 1030.0
    assert _between(fit, [resonance(950.0)], resonance(1000.0)).frequency == 985.0
    assert _between(fit, [resonance(930.0), resonance(960.0)], resonance(1000.0)).frequency == 940.0
    assert _between(fit, [], resonance(1040.0)).frequency == 940.0
    assert _between(fit, [resonance(1050.0)], resonance(1060.0)).frequency == 1030.0


def test_a_spectrum_is_fitted_within_a_factor_of_two_of_a_stated_frequency() -> None:
    wide = np.linspace(300.0, 3000.0, 271)
    response = wide**0 / (1000.0**2 - wide**2 + 1j * wide * 20.0)
    spectrum = vibration_spectrum(frequency=wide, response=response)
    near = _fit(spectrum, 1000.0).spectrum.frequency
    assert (near[0], near[-1]) == (500.0, 2000.0)
    assert _fit(spectrum, None).spectrum is spectrum
    assert spectrum.between(1000.0, 1100.0) is spectrum  # eleven points are too few
    assert spectrum.between(1000.0, 1110.0).frequency.size == 12


def test_vibration_of_any_order_is_a_displacement_with_the_noise_of_its_reading() -> None:
    f = np.linspace(100.0, 200.0, 12)
    x = np.full(12, 2.0 + 1j)
    for quantity, order in (("displacement", 0), ("velocity", 1), ("mobility", 1), ("acceleration", 2)):
        found = vibration_spectrum(frequency=f, response=x * (1j * f / 200) ** order, quantity=quantity)
        assert found.response == approx(x)
        assert found.weight == approx((f / 200) ** order)
        assert (found.has_phase, found.quantity) == (True, quantity)
    real = vibration_spectrum(frequency=f, response=f / 100, quantity="velocity")
    assert not real.has_phase
    assert real.response == approx(np.full(12, 2.0))
    with raises(InvalidInput, match="quantity must be one of displacement, amplitude"):
        vibration_spectrum(frequency=f, response=x, quantity="force")


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        (
            {"frequency": np.arange(1.0, 12.0), "response": np.ones(11), "weight": np.ones(11)},
            "at least 12 points, got 11",
        ),
        ({"frequency": np.ones(12)}, "frequency must increase"),
        ({"response": np.zeros(12)}, "response must not be zero at every frequency"),
        ({"weight": np.zeros(12)}, "weight must be positive"),
        ({"weight": np.ones(13)}, "one-dimensional and equal in length"),
    ],
)
def test_what_is_no_spectrum_is_refused(changed: dict[str, np.ndarray], words: str) -> None:
    given = {"frequency": np.arange(1.0, 13.0), "response": np.ones(12), "weight": np.ones(12)} | changed
    with raises(InvalidInput, match=words):
        ResonanceSpectrum(**given)


def test_a_table_of_magnitudes_in_any_order_with_comments_is_read(tmp_path: Path) -> None:
    rows = [f"{1200 - 10 * k};{k + 1},5" for k in range(12)]
    path = tmp_path / "sweep.txt"
    path.write_text("# a comment\nfrequency (Hz);acceleration (m/s2)\n" + "\n".join([rows[0], "# x", "", *rows[1:]]))
    found = read_resonance_spectrum(path)
    assert found.frequency == approx(1090 + 10 * np.arange(12.0))
    assert not found.has_phase
    assert found.quantity == "acceleration"
    assert np.abs(found.response[0]) == approx(12.5 / (1090 / 1200) ** 2)
    assert found.file_name == "sweep.txt"
    with raises(InvalidInput, match="is a table of one spectrum of vibration; leave sweep 'a' out"):
        read_resonance_spectrum(path, sweep="a")


MASS, FREE, LOAD = 0.1, 1000.0, 2.0


def pressed_by(stiffness: float) -> float:
    return float(np.sqrt(FREE**2 + stiffness / MASS / (2 * np.pi) ** 2))


def test_the_uncertainty_of_the_stiffness_has_its_first_order_parts() -> None:
    stiffness, u_free, u_pressed, mass = 4e5, 0.4, 0.7, 0.05
    pressed = pressed_by(stiffness)
    found = contact_stiffness(
        single_mode(modal_mass=MASS, frequency=FREE),
        free=[replace(resonance(FREE), frequency_uncertainty=u_free)],
        pressed=replace(resonance(pressed), frequency_uncertainty=u_pressed),
        normal_load=LOAD,
        modal_mass_deviation=mass,
    )
    # k = m w^2 (f^2 - f_0^2): of the logarithm, 2 f/(f^2 - f_0^2) and 2 f_0/(f^2 - f_0^2)
    square = pressed**2 - FREE**2
    parts = [2 * FREE / square * u_free, 2 * pressed / square * u_pressed, mass]
    assert found.normal_stiffness is not None
    assert found.decay_length is not None
    assert found.normal_stiffness.median == approx(stiffness, rel=1e-6)
    assert found.normal_stiffness.log_deviation == approx(np.linalg.norm(parts), rel=0.01)
    assert found.decay_length.median == approx(LOAD / stiffness, rel=1e-6)
    assert found.decay_length.log_deviation == found.normal_stiffness.log_deviation
    assert found.frequency_shift == approx(pressed - FREE)
    assert found.shift_uncertainty == approx(np.hypot(u_free, u_pressed))
    assert found.best_stiffness is found.normal_stiffness
    assert (found.free_frequency, found.free_uncertainty, found.drift, found.mode) == (FREE, u_free, None, 0)


def test_the_interval_of_a_logarithmic_estimate_is_that_of_a_normal_logarithm() -> None:
    low, high = LogEstimate(median=2.0, log_deviation=0.1).interval
    assert (low, high) == approx((2 * np.exp(-0.196), 2 * np.exp(0.196)), rel=1e-3)


def test_both_routes_are_combined_by_their_least_variance() -> None:
    length, amplitude = 5e-6, 12e-6
    stiffness = LOAD / length
    ratio = float(equivalent_stiffness_ratio(vibration_amplitude=amplitude, decay_length=length))
    found = contact_stiffness(
        single_mode(modal_mass=MASS, frequency=FREE),
        free=[resonance(FREE, uncertainty=1e-6)] * 2,
        pressed=resonance(pressed_by(stiffness), uncertainty=1e-6),
        normal_load=LOAD,
        large=resonance(pressed_by(ratio * stiffness), uncertainty=1e-6),
        vibration_amplitude=1.1 * amplitude,  # as stated, a tenth too large
        modal_mass_deviation=0.1,
        log_amplitude_deviation=0.2,
    )
    assert found.decay_length is not None
    assert found.decay_length_by_ratio is not None
    assert found.decay_length_combined is not None
    assert found.stiffness_ratio == approx(ratio, rel=1e-5)
    assert found.decay_length.log_deviation == approx(0.1, rel=1e-3)
    assert found.decay_length_by_ratio.median == approx(1.1 * length, rel=1e-4)
    assert found.decay_length_by_ratio.log_deviation == approx(0.2, rel=1e-3)
    # independent: weights 4/5 and 1/5
    assert found.decay_length_combined.median == approx(length * 1.1**0.2, rel=1e-3)
    assert found.decay_length_combined.log_deviation == approx(0.1 * 0.2 / np.hypot(0.1, 0.2), rel=1e-3)
    assert found.best_stiffness is not None
    assert found.best_stiffness.median == approx(LOAD / found.decay_length_combined.median)
    assert found.caveats == ()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"normal_load": 0.0}, "normal_load must be positive"),
        ({"modal_mass_deviation": -0.1}, "modal_mass_deviation must not be negative"),
        ({"free": [resonance(FREE)] * 3}, "free must hold at most two resonances, got 3"),
        ({"free": []}, "the structure has no rigid-body mode that moves its contact"),
    ],
)
def test_what_gives_no_estimate_is_refused(given: dict[str, object], words: str) -> None:
    arguments = {"free": [resonance(FREE)], "pressed": resonance(1200.0), "normal_load": LOAD} | given
    with raises(InvalidInput, match=words):
        contact_stiffness(single_mode(modal_mass=MASS, frequency=FREE), **arguments)  # type: ignore[arg-type]


def test_a_free_resonance_far_from_the_mode_of_the_structure_has_a_caveat() -> None:
    found = contact_stiffness(
        single_mode(modal_mass=MASS, frequency=700.0),
        free=[resonance(FREE)] * 2,
        pressed=resonance(1200.0),
        normal_load=LOAD,
    )
    assert "the free resonance at 1000 Hz is 30% off the nearest mode of the structure, 700 Hz" in found.caveats[0]


def test_spectra_of_one_mass_give_its_spring_with_what_was_chosen() -> None:
    rng = np.random.default_rng(3)
    f = np.linspace(850.0, 1250.0, 401)

    def spectrum(frequency: float, name: str) -> ResonanceSpectrum:
        noise = 1e-3 * (rng.standard_normal(f.size) + 1j * rng.standard_normal(f.size))
        response = frequency**2 / 40 / (frequency**2 - f**2 + 1j * f * frequency / 40) + noise
        return replace(vibration_spectrum(frequency=f, response=response), file_name=name, caveats=("assumed",))

    pressed = pressed_by(1e6)
    found = measured_contact_stiffness(
        [spectrum(FREE, "a.csv"), spectrum(FREE + 0.5, "b.csv")],
        spectrum(pressed, "c.csv"),
        normal_load=LOAD,
        modal_mass=MASS,
    )
    assert found.stiffness.normal_stiffness is not None
    assert found.stiffness.normal_stiffness.median == approx(1e6, rel=0.01)
    assert [one.frequency for one in found.chosen] == approx([FREE, pressed, FREE + 0.5], abs=0.1)
    assert found.stiffness.drift == approx(0.5, abs=0.1)
    assert found.large is None
    assert {"a.csv: assumed", "b.csv: assumed", "c.csv: assumed"} <= set(found.caveats)
    with raises(InvalidInput, match="free must hold one or two spectra, got 0"):
        measured_contact_stiffness([], spectrum(pressed, "c.csv"), normal_load=LOAD, modal_mass=MASS)
    with raises(InvalidInput, match="mode_near 0 Hz is a rigid-body mode of a structure"):
        measured_contact_stiffness(
            [spectrum(FREE, "a.csv")], spectrum(pressed, "c.csv"), normal_load=LOAD, modal_mass=MASS, mode_near=0.0
        )
