"""Contact stiffness from known resonances, and from spectra made by other code."""

import numpy as np
from pytest import approx, raises

from reliability import virtual_contact as virtual
from sonolube.errors import InvalidInput
from sonolube.measurement.contact_stiffness.analysis import MeasuredContactStiffness, measured_contact_stiffness
from sonolube.measurement.contact_stiffness.resonance_fit import Resonance
from sonolube.measurement.contact_stiffness.resonance_spectrum import ResonanceSpectrum, vibration_spectrum
from sonolube.measurement.contact_stiffness.stiffness_estimate import ContactStiffness, contact_stiffness, single_mode
from sonolube.models.dynamics import Structure

MASS, FREE, LOAD = 0.105, 22e3, 3.0
SLOW = np.linspace(70, 450, 381)


def seen(frequency: float, uncertainty: float) -> Resonance:
    return Resonance(frequency=frequency, frequency_uncertainty=uncertainty, quality_factor=1e4, relative_height=1.0)


def frequency_of(stiffness: float, *, mass: float = MASS, free: float = FREE) -> float:
    """Frequency of a mass on a spring with another one added."""
    return float(np.hypot(free, np.sqrt(stiffness / mass) / (2 * np.pi)))


def of_one_mode(pressed: Resonance, *free: Resonance, **more: float | Resonance) -> ContactStiffness:
    mode = single_mode(modal_mass=MASS, frequency=FREE)
    return contact_stiffness(mode, free=free, pressed=pressed, normal_load=LOAD, **more)  # type: ignore[arg-type]


def test_one_mass_gives_back_the_spring_that_was_added() -> None:
    found = of_one_mode(seen(frequency_of(1.5e6), 1e-3), seen(FREE, 1e-3))
    assert found.normal_stiffness is not None
    assert found.decay_length is not None
    assert found.normal_stiffness.median == approx(1.5e6, rel=1e-3)
    assert found.decay_length.median == approx(2e-6, rel=1e-3)


def test_the_uncertainty_is_that_of_the_first_order_formula() -> None:
    # ln k = ln m + ln(shift) + const: relative uncertainties of mass and shift add in squares
    shift = frequency_of(1.5e6) - FREE
    found = of_one_mode(seen(FREE + shift, 0.5), seen(FREE, 0.3), seen(FREE, 0.4), modal_mass_deviation=0.08)
    assert found.normal_stiffness is not None
    of_shift = np.sqrt(0.5**2 + (0.3**2 + 0.4**2) / 4) / shift
    assert found.normal_stiffness.log_deviation == approx(np.hypot(of_shift, 0.08), rel=0.01)


def test_drift_between_the_free_spectra_widens_the_interval() -> None:
    # anywhere between both with equal probability: the width over the root of 12
    found = of_one_mode(seen(frequency_of(1.5e6), 1e-3), seen(FREE - 2, 1e-3), seen(FREE + 2, 1e-3))
    assert found.drift == approx(4)
    assert found.shift_uncertainty == approx(4 / np.sqrt(12), rel=1e-3)
    assert not found.caveats
    assert "one free spectrum only" in of_one_mode(seen(frequency_of(1.5e6), 1e-3), seen(FREE, 1e-3)).caveats[0]


def test_a_shift_below_the_noise_is_a_sentence_and_no_number() -> None:
    found = of_one_mode(seen(FREE + 8, 5.0), seen(FREE, 5.0))
    assert found.normal_stiffness is None
    assert found.decay_length is None
    assert "the shift of 8 Hz is below three standard uncertainties of 7.1 Hz" in found.not_found[0]
    # 8 + 1.96 * 7.07 Hz at 8 pi^2 m f_0: 4.0 MN/m, and 3 N over it
    assert "k_n is below 4e+06 N/m and l above 0.75 um" in found.not_found[0]


def test_a_resonance_that_falls_in_contact_is_said_to_be_another_or_drifted() -> None:
    found = of_one_mode(seen(FREE - 8, 0.1), seen(FREE, 0.1))
    assert "a contact raises a resonance" in found.not_found[0]


def softened(length: float, amplitude: float) -> float:
    return virtual.equivalent_spring(LOAD / length, amplitude=amplitude, decay_length=length)


def test_the_ratio_of_shifts_gives_the_decay_length_whatever_the_modal_mass() -> None:
    large = seen(frequency_of(softened(2e-6, 5e-6)), 1e-3)
    for told in (0.05, 0.105, 0.3):
        found = contact_stiffness(
            single_mode(modal_mass=told, frequency=FREE),
            free=[seen(FREE, 1e-3)],
            pressed=seen(frequency_of(1.5e6), 1e-3),
            normal_load=LOAD,
            large=large,
            vibration_amplitude=5e-6,
        )
        assert found.decay_length_by_ratio is not None
        assert found.decay_length_by_ratio.median == approx(2e-6, rel=1e-3)
        assert found.decay_length_by_ratio.log_deviation == approx(0.05, rel=0.02)
        assert (found.decay_length_combined is not None) == (told == MASS)
        assert any("contradict" in caveat for caveat in found.caveats) == (told != MASS)


def test_both_routes_together_weigh_by_their_variances() -> None:
    # independent errors: of the modal mass by one route, of the amplitude by the other
    found = of_one_mode(
        seen(frequency_of(1.5e6), 1e-4),
        seen(FREE, 1e-4),
        large=seen(frequency_of(softened(2e-6, 5e-6)), 1e-4),
        vibration_amplitude=5e-6,
        modal_mass_deviation=0.1,
        log_amplitude_deviation=0.1,
    )
    assert found.decay_length_combined is not None
    assert found.decay_length_combined.log_deviation == approx(0.1 / np.sqrt(2), rel=1e-3)


def test_a_ratio_that_is_one_within_its_noise_is_a_sentence() -> None:
    found = of_one_mode(
        seen(frequency_of(1.5e6), 0.2),
        seen(FREE, 0.2),
        large=seen(frequency_of(softened(2e-6, 0.2e-6)), 0.2),
        vibration_amplitude=0.2e-6,
    )
    assert found.decay_length_by_ratio is None
    assert "is not resolved from 1" in found.not_found[-1]


def test_a_large_vibration_without_amplitude_is_refused() -> None:
    with raises(InvalidInput, match="vibration_amplitude is missing"):
        of_one_mode(seen(frequency_of(1.5e6), 1.0), seen(FREE, 1.0), large=seen(FREE + 5, 1.0))


def chain() -> Structure:
    mass, damping, stiffness = virtual.TRIBOMETER.matrices()
    return Structure(
        mass_matrix=mass,
        damping_matrix=damping,
        stiffness_matrix=stiffness,
        drive_vector=np.zeros(3),
        contact_vector=np.array([1.0, 0.0, 0.0]),
        clamped_capacitance=1e-9,
    )


def spectrum(spring: float, seed: int) -> ResonanceSpectrum:
    rng = np.random.default_rng(seed)
    values = virtual.velocity(virtual.TRIBOMETER, SLOW, spring=spring)
    return vibration_spectrum(frequency=SLOW, response=virtual.noisy(rng, values, 1e-3), quantity="velocity")


def of_chain(mode_near: float) -> MeasuredContactStiffness:
    return measured_contact_stiffness(
        [spectrum(0, 1), spectrum(0, 2)],
        spectrum(3 / 0.7e-6, 3),
        normal_load=LOAD,
        structure=chain(),
        mode_near=mode_near,
        modal_mass_deviation=0.0,
    )


def test_a_slow_resonance_of_quality_factor_four_tells_the_stiffness_within_a_percent() -> None:
    found = of_chain(153.0).stiffness
    assert found.mode == 1
    assert found.normal_stiffness is not None
    assert found.normal_stiffness.median == approx(3 / 0.7e-6, rel=0.01)
    assert found.normal_stiffness.log_deviation < 0.01


def test_a_mode_that_floats_when_lifted_tells_it_by_its_pressed_frequency() -> None:
    found = of_chain(0.0).stiffness
    assert found.free_frequency == 0
    assert found.normal_stiffness is not None
    assert found.normal_stiffness.median == approx(3 / 0.7e-6, rel=0.02)
    assert "rests on the masses" in found.caveats[0]


def test_neither_structure_nor_modal_mass_is_refused() -> None:
    with raises(InvalidInput, match="modal_mass is missing"):
        measured_contact_stiffness([spectrum(0, 1)], spectrum(1e6, 3), normal_load=LOAD)
