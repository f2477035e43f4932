"""Wear models by name: ratios under a sine against closed forms and the tables of D."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx
from scipy.special import i0, i1

from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactMotion,
    ContactPair,
    RoughContact,
    separation,
    sinusoidal_motion,
)
from sonolube.models.surfaces import Roughness
from sonolube.models.wear import WEAR_MODELS, cube_wear_rate, vibrating_cube_wear_rate

ACORN_NUT_ON_DISC = RoughContact(  # D Table 3.2
    roughness=Roughness(rms_height=6e-6, summit_radius=1.5e-6, summit_density=4.7e10),
    pair=ContactPair(effective_modulus=59.6e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=0.8),
    nominal_area=2.25e-6,
    asperity=ASPERITY_LAWS["dong_2015"],
)
DECAY_LENGTH = 6e-6 / 3  # Rq/lambda


def sine(amplitude: float) -> ContactMotion:
    return sinusoidal_motion(ACORN_NUT_ON_DISC, normal_load=3.0, vibration_amplitude=amplitude, frequency=22e3)


def ratio(name: str, amplitude: float) -> float:
    return float(WEAR_MODELS[name](ACORN_NUT_ON_DISC, sine(amplitude)))


def test_over_the_full_period_vibration_raises_the_wear() -> None:
    assert ratio("dong_2015_full_period", 2.5e-6) == approx(1.31, abs=5e-3)


@pytest.mark.parametrize("amplitude", [0.1e-6, 2.5e-6, 14e-6])
def test_the_half_period_ratio_is_that_of_the_vibrating_cube(amplitude: float) -> None:
    vibrating = vibrating_cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=3.0, vibration_amplitude=amplitude)
    at_rest = cube_wear_rate(ACORN_NUT_ON_DISC, normal_load=3.0)
    assert ratio("dong_2015_half_period", amplitude) == approx(vibrating / at_rest, rel=3e-5)


def test_the_half_period_ratio_is_that_of_table_3_4() -> None:
    assert ratio("dong_2015_half_period", 2.5e-6) == approx(1.355 / 2.566, rel=1e-3)


@pytest.mark.parametrize("amplitude", [0.1e-6, 2.5e-6, 14e-6])
def test_about_the_load_balanced_mean_only_the_height_reduces_the_wear(amplitude: float) -> None:
    beta, d = amplitude / DECAY_LENGTH, float(separation(ACORN_NUT_ON_DISC, normal_load=3.0))
    expected = 1 + (DECAY_LENGTH * np.log(i0(beta)) - amplitude * i1(beta) / i0(beta)) / d
    assert ratio("dong_2015_load_balanced", amplitude) == approx(expected, rel=2e-5)


@pytest.mark.parametrize("name", WEAR_MODELS)
def test_without_vibration_every_model_gives_a_ratio_of_one(name: str) -> None:
    assert ratio(name, 0.0) == approx(1, rel=1e-12)


@pytest.mark.parametrize("name", WEAR_MODELS)
def test_a_shift_of_the_mean_gap_changes_no_ratio(name: str) -> None:
    shifted = replace(sine(2.5e-6), displacement=sine(2.5e-6).displacement + 0.7e-6)
    assert float(WEAR_MODELS[name](ACORN_NUT_ON_DISC, shifted)) == approx(ratio(name, 2.5e-6), rel=1e-9)
