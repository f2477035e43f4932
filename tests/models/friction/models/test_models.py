"""Friction models by name: the cube and the kinematic model against quadrature, and properties common to all."""

import numpy as np
import pytest
from pytest import approx, raises
from scipy.integrate import quad

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactMotion,
    ContactPair,
    RoughContact,
    cube_tangential_stiffness,
    load_balanced_motion,
    separation,
    sinusoidal_motion,
)
from sonolube.models.friction import (
    FRICTION_MODELS,
    Dong2015FullPeriod,
    Dong2015HalfPeriod,
    Dong2015LoadBalanced,
    Kinematic,
    dong_2015_half_period_ratio,
)
from sonolube.models.surfaces import Roughness

CONTACT = RoughContact(  # D Table 3.2
    roughness=Roughness(rms_height=6e-6, summit_radius=1.5e-6, summit_density=4.7e10),
    pair=ContactPair(effective_modulus=59.6e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=0.8),
    nominal_area=2.25e-6,
    asperity=ASPERITY_LAWS["dong_2015"],
)
LOAD, FREQUENCY, DECAY_LENGTH = 3.0, 22e3, 2e-6
OMEGA = 2 * np.pi * FREQUENCY
AT_REST = float(separation(CONTACT, normal_load=LOAD))
SPEEDS = np.array([20.3e-3, 40.6e-3, 87e-3])  # of D Table 2.3
HARD_MODELS = [name for name, model in FRICTION_MODELS.items() if not model.for_soft_bodies]


def sine(amplitude: float, *, samples: int = 256) -> ContactMotion:
    return sinusoidal_motion(
        CONTACT, normal_load=LOAD, vibration_amplitude=amplitude, frequency=FREQUENCY, samples=samples
    )


def model_ratio(name: str, motion: ContactMotion, speeds: np.ndarray) -> np.ndarray:
    return FRICTION_MODELS[name]().ratio(CONTACT, motion, sliding_speed=speeds, friction_coefficient=0.3)


def test_vibration_raises_friction_over_the_full_period_as_printed() -> None:
    assert Dong2015FullPeriod().ratio(CONTACT, sine(2.5e-6), sliding_speed=SPEEDS) == approx(
        [1.22, 1.91, 2.89], abs=6e-3
    )


def test_balancing_the_load_reduces_friction() -> None:
    assert Dong2015LoadBalanced().ratio(CONTACT, sine(2.5e-6), sliding_speed=SPEEDS) == approx(
        [0.507, 0.794, 1.204], abs=5e-4
    )


def test_the_kinematic_model_at_a_third_of_the_amplitude_approximates_the_measured_ratios() -> None:
    expected = [0.364, 0.556, 0.782]
    assert Kinematic().ratio(CONTACT, sine(0.78e-6), sliding_speed=SPEEDS) == approx(expected, abs=5e-4)
    assert Kinematic(amplitude_fraction=0.312).ratio(CONTACT, sine(2.5e-6), sliding_speed=SPEEDS) == approx(
        expected, abs=5e-4
    )


@pytest.mark.parametrize("amplitude", [0.1e-6, 2.5e-6, 14e-6])
@pytest.mark.parametrize("samples", [64, 256, 1000])
def test_the_means_are_those_of_adaptive_quadrature(amplitude: float, samples: int) -> None:
    motion, speeds = sine(amplitude, samples=samples), np.array([1e-4, 5e-3, 0.1, 2.0])
    at_rest = cube_tangential_stiffness(CONTACT, separation=AT_REST)

    def cosine(theta: float, v: float) -> float:
        return float(v / np.hypot(v, OMEGA * amplitude * np.sin(theta)))

    def weighted(theta: float, v: float) -> float:
        gap = AT_REST + amplitude * np.cos(theta)
        return cosine(theta, v) * float(cube_tangential_stiffness(CONTACT, separation=gap) / at_rest)

    for model, integrand in ((Kinematic(), cosine), (Dong2015FullPeriod(), weighted)):
        widths = [v / (OMEGA * amplitude) for v in speeds]
        means = [
            quad(
                integrand,
                0,
                np.pi,
                args=(v,),
                points=[min(near, 1.5) for near in (c, 10 * c)] + [np.pi - min(near, 1.5) for near in (c, 10 * c)],
                limit=500,
                epsrel=1e-9,
            )[0]
            / np.pi
            for v, c in zip(speeds, widths, strict=True)
        ]
        assert model.ratio(CONTACT, motion, sliding_speed=speeds) == approx(np.array(means), rel=1e-4, abs=1e-6)


def test_the_half_period_model_is_the_closed_form_of_the_cube_at_every_speed() -> None:
    for amplitude in (0.1e-6, 2.5e-6, 14e-6):
        expected = dong_2015_half_period_ratio(CONTACT, normal_load=LOAD, vibration_amplitude=amplitude)
        assert Dong2015HalfPeriod().ratio(CONTACT, sine(amplitude), sliding_speed=SPEEDS) == approx(
            np.full(3, expected), abs=2e-5
        )


@pytest.mark.parametrize("name", HARD_MODELS)
def test_without_vibration_every_model_gives_a_ratio_of_one(name: str) -> None:
    assert model_ratio(name, sine(0.0), SPEEDS) == approx([1, 1, 1], rel=1e-9)


@pytest.mark.parametrize("name", HARD_MODELS)
def test_results_have_the_shape_of_the_speeds_and_are_independent(name: str) -> None:
    motion, speeds = load_balanced_motion(CONTACT, sine(2.5e-6)), SPEEDS[:, np.newaxis] * [1.0, 2.0]
    together = model_ratio(name, motion, speeds)
    assert together.shape == (3, 2)
    assert model_ratio(name, motion, speeds[1, 1]) == approx(together[1, 1], rel=1e-4)


@pytest.mark.parametrize("name", HARD_MODELS)
def test_the_start_of_the_period_has_no_effect(name: str) -> None:
    motion = load_balanced_motion(CONTACT, sine(2.5e-6))
    later = ContactMotion(
        displacement=np.roll(motion.displacement, 71),
        normal_force=np.roll(motion.normal_force, 71),
        frequency=FREQUENCY,
        normal_load=LOAD,
    )
    assert model_ratio(name, later, SPEEDS) == approx(model_ratio(name, motion, SPEEDS), rel=1e-5)


def test_a_motion_that_closes_the_gap_is_refused() -> None:
    with raises(
        OutsideRange, match=r"the motion closes the gap: its smallest separation is -\S+ m, from 1\.55e-05 m at rest"
    ):
        Dong2015FullPeriod().ratio(CONTACT, sine(17e-6), sliding_speed=0.1)


def test_a_speed_of_zero_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"sliding_speed must be positive, got 0\.0 m/s"):
        Kinematic().ratio(CONTACT, sine(1e-6), sliding_speed=0.0)
