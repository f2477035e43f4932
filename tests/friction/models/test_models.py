import numpy as np
import pytest
from pytest import approx, raises
from scipy.integrate import quad
from scipy.special import i0

from sonolube.contact import (
    ASPERITY_LAWS,
    ContactPair,
    GapMotion,
    GaussianHeights,
    RoughContact,
    cube_tangential_stiffness,
    load_balanced_motion,
    normal_force,
    separation,
    sinusoidal_motion,
)
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.friction import (
    FRICTION_MODELS,
    Dong2015FullPeriod,
    Dong2015HalfPeriod,
    Dong2015LoadBalanced,
    Kinematic,
    dong_2015_half_period_ratio,
)
from sonolube.surfaces import Roughness

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


def sine(amplitude: float, *, samples: int = 256) -> GapMotion:
    return sinusoidal_motion(
        CONTACT, normal_load=LOAD, vibration_amplitude=amplitude, frequency=FREQUENCY, samples=samples
    )


def named(name: str, motion: GapMotion, speeds: np.ndarray) -> np.ndarray:
    return FRICTION_MODELS[name]().ratio(CONTACT, motion, sliding_speed=speeds, friction_coefficient=0.3)


def test_as_printed_vibration_raises_friction() -> None:
    assert Dong2015FullPeriod().ratio(CONTACT, sine(2.5e-6), sliding_speed=SPEEDS) == approx(
        [1.22, 1.91, 2.89], abs=6e-3
    )


def test_balancing_the_load_lowers_it() -> None:
    assert Dong2015LoadBalanced().ratio(CONTACT, sine(2.5e-6), sliding_speed=SPEEDS) == approx(
        [0.507, 0.794, 1.204], abs=5e-4
    )


def test_the_direction_alone_at_a_third_of_the_amplitude_comes_near_the_measured_ratios() -> None:
    known = [0.364, 0.556, 0.782]
    assert Kinematic().ratio(CONTACT, sine(0.78e-6), sliding_speed=SPEEDS) == approx(known, abs=5e-4)
    assert Kinematic(amplitude_fraction=0.312).ratio(CONTACT, sine(2.5e-6), sliding_speed=SPEEDS) == approx(
        known, abs=5e-4
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
        crowded = [v / (OMEGA * amplitude) for v in speeds]
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
            for v, c in zip(speeds, crowded, strict=True)
        ]
        assert model.ratio(CONTACT, motion, sliding_speed=speeds) == approx(np.array(means), rel=1e-4, abs=1e-6)


def test_the_separating_half_is_that_of_the_cube_at_every_speed() -> None:
    for amplitude in (0.1e-6, 2.5e-6, 14e-6):
        expected = dong_2015_half_period_ratio(CONTACT, normal_load=LOAD, vibration_amplitude=amplitude)
        assert Dong2015HalfPeriod().ratio(CONTACT, sine(amplitude), sliding_speed=SPEEDS) == approx(
            np.full(3, expected), abs=2e-5
        )


@pytest.mark.parametrize("amplitude", [0.1e-6, 2.5e-6, 14e-6])
def test_the_balanced_mean_of_a_sine_rises_by_the_logarithm_of_bessels_function(amplitude: float) -> None:
    balanced = load_balanced_motion(CONTACT, sine(amplitude))
    assert np.mean(balanced.displacement) == approx(DECAY_LENGTH * np.log(i0(amplitude / DECAY_LENGTH)), rel=1e-9)
    assert np.mean(balanced.normal_force) == approx(LOAD, rel=1e-12)


def test_gaussian_heights_are_balanced_too() -> None:
    contact = RoughContact(
        roughness=CONTACT.roughness,
        pair=CONTACT.pair,
        nominal_area=2.25e-6,
        heights=GaussianHeights(),
        asperity=ASPERITY_LAWS["dong_2015"],
    )
    motion = sinusoidal_motion(contact, normal_load=LOAD, vibration_amplitude=2.5e-6, frequency=FREQUENCY)
    balanced = load_balanced_motion(contact, motion)
    gaps = separation(contact, normal_load=LOAD) + balanced.displacement
    assert np.mean(normal_force(contact, separation=gaps)) == approx(LOAD, rel=1e-10)


@pytest.mark.parametrize("name", FRICTION_MODELS)
def test_without_vibration_every_closure_leaves_friction_alone(name: str) -> None:
    assert named(name, sine(0.0), SPEEDS) == approx([1, 1, 1], rel=1e-9)


@pytest.mark.parametrize("name", FRICTION_MODELS)
def test_speeds_come_back_in_their_shape_and_each_by_itself(name: str) -> None:
    motion, speeds = load_balanced_motion(CONTACT, sine(2.5e-6)), SPEEDS[:, np.newaxis] * [1.0, 2.0]
    together = named(name, motion, speeds)
    assert together.shape == (3, 2)
    assert named(name, motion, speeds[1, 1]) == approx(together[1, 1], rel=1e-4)


@pytest.mark.parametrize("name", FRICTION_MODELS)
def test_where_a_period_begins_does_not_matter(name: str) -> None:
    motion = load_balanced_motion(CONTACT, sine(2.5e-6))
    later = GapMotion(
        displacement=np.roll(motion.displacement, 71),
        normal_force=np.roll(motion.normal_force, 71),
        frequency=FREQUENCY,
        normal_load=LOAD,
    )
    assert named(name, later, SPEEDS) == approx(named(name, motion, SPEEDS), rel=1e-5)


def test_velocities_are_those_of_the_sine() -> None:
    theta = 2 * np.pi * np.arange(64) / 64
    assert sine(2.5e-6, samples=64).velocity == approx(-2.5e-6 * OMEGA * np.sin(theta), abs=1e-12)


def test_more_phases_of_a_motion_lie_on_the_same_sine() -> None:
    assert sine(2.5e-6, samples=16).resampled(48).displacement == approx(sine(2.5e-6, samples=48).displacement)


def test_a_motion_that_closes_the_gap_is_refused() -> None:
    with raises(OutsideRange, match=r"the motion closes the gap: from a separation of 1\.55e-05 m at rest"):
        Dong2015FullPeriod().ratio(CONTACT, sine(17e-6), sliding_speed=0.1)


def test_a_speed_of_zero_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"sliding_speed must be positive, got 0\.0 m/s"):
        Kinematic().ratio(CONTACT, sine(1e-6), sliding_speed=0.0)


def test_forces_of_another_length_than_the_displacements_are_refused() -> None:
    with raises(InvalidInput, match=r"got shapes \(8,\) and \(9,\)"):
        GapMotion(displacement=np.zeros(8), normal_force=np.ones(9), frequency=1.0, normal_load=1.0)
