"""Estimates of flow stress under vibration against a stress integrated over its period."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.facts.published import statement
from sonolube.models.friction import (
    ZINC_STRESS_RATIO,
    acoustic_intensity,
    acoustic_softening_ratio,
    reference_intensity_from_test,
    superposed_mean_stress,
)


@pytest.mark.parametrize("strain", [0.0, 1e-4, 1e-3, 1.3e-3, 5e-3, 0.1])
def test_the_mean_stress_is_that_of_a_stress_with_yielding_once_a_period(strain: float) -> None:
    # elastic-perfectly plastic, a tool in compression only, 70 GPa and 100 MPa
    theta = (np.arange(200_000) + 0.5) * 2 * np.pi / 200_000
    stress = np.maximum(100e6 - 70e9 * strain * (1 - np.cos(theta)), 0)
    found = superposed_mean_stress(yield_strength=100e6, youngs_modulus=70e9, strain_amplitude=strain)
    assert found == approx(stress.mean(), rel=1e-5)


@given(strain=st.floats(1e-6, 0.1))
def test_the_mean_stress_falls_with_the_amplitude(strain: float) -> None:
    small, large = superposed_mean_stress(
        yield_strength=100e6, youngs_modulus=70e9, strain_amplitude=[strain, 1.1 * strain]
    )
    assert 0 < large < small < 100e6


def test_the_intensity_is_that_of_a_travelling_wave() -> None:
    # 2700 kg/m3, 5000 m/s, 20 kHz and 5 um: 0.628 m/s peak, 13.5 MPa s/m
    found = acoustic_intensity(density=2700.0, wave_speed=5000.0, frequency=20e3, vibration_amplitude=5e-6)
    assert found == approx(2.665e6, rel=1e-3)


def test_the_reference_intensity_of_a_test_reproduces_the_test() -> None:
    reference = reference_intensity_from_test(stress_ratio=0.6, acoustic_intensity=1e4)
    assert acoustic_softening_ratio(acoustic_intensity=1e4, reference_intensity=reference) == approx(0.6)
    assert acoustic_softening_ratio(acoustic_intensity=4e4, reference_intensity=reference) == approx(0.2)
    assert acoustic_softening_ratio(acoustic_intensity=1e9, reference_intensity=reference) == 0


def test_the_stress_ratio_of_zinc_is_that_cited_from_blaha_and_langenecker() -> None:
    assert approx(1 - statement("2.4.1-blaha-force-reduction").number.value) == ZINC_STRESS_RATIO


def test_a_stress_ratio_of_one_gives_no_reference_intensity() -> None:
    with raises(InvalidInput, match="stress_ratio must be positive"):
        reference_intensity_from_test(stress_ratio=1.0, acoustic_intensity=1e4)
