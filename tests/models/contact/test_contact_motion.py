"""Motions of the gap: load balance, derivatives and resampling of sines, and inconsistent samples."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx, raises
from scipy.special import i0

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactMotion,
    ContactPair,
    GaussianHeights,
    RoughContact,
    load_balanced_motion,
    normal_force,
    separation,
    sinusoidal_motion,
)
from sonolube.models.contact.contact_motion import delayed_oscillation
from sonolube.models.contact.period_mean import richardson_period_mean, richardson_period_means
from sonolube.models.surfaces import Roughness

CONTACT = RoughContact(  # D Table 3.2
    roughness=Roughness(rms_height=6e-6, summit_radius=1.5e-6, summit_density=4.7e10),
    pair=ContactPair(effective_modulus=59.6e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=0.8),
    nominal_area=2.25e-6,
    asperity=ASPERITY_LAWS["dong_2015"],
)
LOAD, FREQUENCY, DECAY_LENGTH = 3.0, 22e3, 2e-6
OMEGA = 2 * np.pi * FREQUENCY


def sine(amplitude: float, *, samples: int = 256) -> ContactMotion:
    return sinusoidal_motion(
        CONTACT, normal_load=LOAD, vibration_amplitude=amplitude, frequency=FREQUENCY, samples=samples
    )


@pytest.mark.parametrize("amplitude", [0.1e-6, 2.5e-6, 14e-6])
def test_the_load_balanced_mean_of_a_sine_rises_by_the_logarithm_of_a_bessel_function(amplitude: float) -> None:
    balanced = load_balanced_motion(CONTACT, sine(amplitude))
    assert np.mean(balanced.displacement) == approx(DECAY_LENGTH * np.log(i0(amplitude / DECAY_LENGTH)), rel=1e-9)
    assert np.mean(balanced.normal_force) == approx(LOAD, rel=1e-12)


def test_gaussian_heights_are_load_balanced_too() -> None:
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


def test_velocities_are_those_of_the_sine() -> None:
    theta = 2 * np.pi * np.arange(64) / 64
    assert sine(2.5e-6, samples=64).velocity == approx(-2.5e-6 * OMEGA * np.sin(theta), abs=1e-12)


def test_a_resampled_motion_lies_on_the_same_sine() -> None:
    assert sine(2.5e-6, samples=16).resampled(48).displacement == approx(
        sine(2.5e-6, samples=48).displacement, rel=1e-6, abs=1e-18
    )


def test_forces_and_displacements_of_different_length_are_refused() -> None:
    with raises(InvalidInput, match=r"got shapes \(8,\) and \(9,\)"):
        ContactMotion(displacement=np.zeros(8), normal_force=np.ones(9), frequency=1.0, normal_load=1.0)


def test_a_period_mean_with_an_error_of_second_order_is_extrapolated_until_it_is_exact() -> None:
    # an error of 1e5/n^2 at n phases: 1.5 at 256 phases, below 1e-5 from 2^17 phases on, without extrapolation
    counts: list[int] = []

    def mean(motion: ContactMotion) -> np.ndarray:
        counts.append(motion.displacement.size)
        return np.asarray(2.0 + 1e5 / motion.displacement.size**2)

    assert richardson_period_mean(mean, sine(1e-6), tolerance=1e-4) == approx(2.0, abs=1e-12)
    assert counts == [256 * 2**k for k in range(8)]  # the first whose error, 9e-5, is within the tolerance


def test_a_period_mean_that_does_not_converge_is_refused() -> None:
    with raises(OutsideRange, match="does not converge with 65536 samples"):
        richardson_period_mean(lambda motion: np.asarray(float(motion.displacement.size)), sine(1e-6))


def test_a_delayed_oscillation_lags_by_the_phase_of_its_fundamental_and_has_no_mean() -> None:
    theta = 2 * np.pi * np.arange(32) / 32
    delayed = delayed_oscillation(4 + np.cos(theta) + 0.3 * np.sin(3 * theta), phase=0.7)
    assert delayed == approx(np.cos(theta - 0.7) + 0.3 * np.sin(3 * (theta - 0.7)), abs=1e-12)


def test_averages_of_many_motions_are_those_of_each_alone() -> None:
    motions = [sine(amplitude) for amplitude in (1e-8, 3e-7, 1e-6)]

    def sharp(displacement: np.ndarray) -> np.ndarray:
        return np.asarray(np.mean(np.abs(displacement - 1e-7), axis=-1) / 1e-7)

    seen: list[int] = []

    def every(rows: np.ndarray, displacement: np.ndarray, force: np.ndarray) -> np.ndarray:
        seen.append(rows.size)
        return sharp(displacement)

    together = richardson_period_means(every, motions, tolerance=1e-9)
    alone = [
        float(richardson_period_mean(lambda one: sharp(one.displacement), motion, tolerance=1e-9)) for motion in motions
    ]
    assert together == approx(np.array(alone), rel=1e-12)
    assert seen[0] == 3
    assert seen[-1] < 3  # motions that are done take no further samples


def test_parts_of_a_motion_within_the_plane_are_resampled_with_it() -> None:
    phase = 2 * np.pi * np.arange(256) / 256
    motion = replace(sine(2e-6), along=1e-6 * np.sin(phase), across=3e-7 * np.cos(phase - 0.4))
    fine = 2 * np.pi * np.arange(640) / 640
    found = load_balanced_motion(CONTACT, motion).resampled(640)
    assert found.along == approx(1e-6 * np.sin(fine), abs=1e-18)
    assert found.across == approx(3e-7 * np.cos(fine - 0.4), abs=1e-18)
    assert sine(2e-6).resampled(640).along is None


def test_a_part_within_the_plane_has_the_phases_of_the_normal_one() -> None:
    with raises(InvalidInput, match=r"across must have the phases of displacement, got shapes \(8,\) and \(256,\)"):
        replace(sine(2e-6), across=np.zeros(8))
