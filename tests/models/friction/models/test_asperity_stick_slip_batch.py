"""Batched stick-slip ratios against single sines, single motions and bounds."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises
from scipy.special import i0e
from tests.tiers import examples

from sonolube.errors import InvalidInput
from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactMotion,
    ContactPair,
    GapMotionBatch,
    RoughContact,
    load_balanced_motion,
    normal_force,
    separation,
)
from sonolube.models.friction import SINE_TOLERANCE, AsperityStickSlip, batched_stick_slip_ratio, sine_stick_slip_ratio
from sonolube.models.surfaces import Roughness

CONTACT = RoughContact(  # D Table 3.2
    roughness=Roughness(rms_height=6e-6, summit_radius=1.5e-6, summit_density=4.7e10),
    pair=ContactPair(effective_modulus=59.6e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=0.8),
    nominal_area=2.25e-6,
    asperity=ASPERITY_LAWS["dong_2015"],
)
DECAY_LENGTH, MEMORY_LENGTH, FREQUENCY, LOAD = 2e-6, 1.5e-6, 22e3, 3.0
OMEGA = 2 * np.pi * FREQUENCY


def balanced_mean(harmonics: np.ndarray) -> float:
    """Return the load-balanced mean displacement of exponential heights under a motion, by 4096 phases."""
    rotations = np.exp(2j * np.pi * np.multiply.outer(np.arange(4096) / 4096, np.arange(1, harmonics.size + 1)))
    return float(DECAY_LENGTH * np.log(np.mean(np.exp(-(rotations @ harmonics).real / DECAY_LENGTH))))


def motions(means: list[float], harmonics: list[Any]) -> GapMotionBatch:
    frequency = np.full(len(means), FREQUENCY)
    return GapMotionBatch(mean_displacement=np.array(means), harmonics=np.array(harmonics), frequency=frequency)


def ratios(harmonics: np.ndarray, speeds: np.ndarray) -> np.ndarray:
    return batched_stick_slip_ratio(
        motions([balanced_mean(harmonics)], [harmonics]),
        decay_length=DECAY_LENGTH,
        sliding_speed=speeds,
        motion=np.zeros(speeds.size, dtype=int),
        memory_length=MEMORY_LENGTH,
    )


@pytest.mark.parametrize("harmonics", [[3e-6 + 0j], [3e-6 + 0j, 1e-7j], [1e-6 + 0j, 1e-12j]])
@pytest.mark.parametrize("raised", [-1e-6, 2e-6])
@pytest.mark.parametrize("tolerance", [1e-7, SINE_TOLERANCE])
def test_a_gap_about_a_wider_mean_scales_friction_as_it_scales_the_normal_force(
    harmonics: list[complex], raised: float, tolerance: float
) -> None:
    mean, factor = balanced_mean(np.array(harmonics)), np.exp(-raised / DECAY_LENGTH)
    balanced, shifted = (
        batched_stick_slip_ratio(
            GapMotionBatch(
                mean_displacement=np.array([mean + by]),
                harmonics=np.array([harmonics]),
                frequency=np.array([FREQUENCY]),
                mean_force_ratio=np.array([np.exp(-by / DECAY_LENGTH)]),
            ),
            decay_length=DECAY_LENGTH,
            sliding_speed=[0.02, 0.1, 3.0],
            motion=[0, 0, 0],
            memory_length=MEMORY_LENGTH,
            tolerance=tolerance,
        )
        for by in (0.0, raised)
    )
    assert shifted == approx(factor * balanced, rel=1e-4)
    assert balanced[-1] == 1.0


@examples(60)
@given(log_beta=st.floats(-7, 5), log_v=st.floats(-12, 1))
def test_a_sine_has_the_closed_form_ratio(log_beta: float, log_v: float) -> None:
    amplitude = np.exp(log_beta) * DECAY_LENGTH
    speed = np.exp(log_v) * OMEGA * amplitude * MEMORY_LENGTH / DECAY_LENGTH
    beta = np.exp(log_beta)
    batched = batched_stick_slip_ratio(
        motions([DECAY_LENGTH * (np.log(i0e(beta)) + beta)], [[amplitude + 0j]]),
        decay_length=DECAY_LENGTH,
        sliding_speed=[speed],
        motion=[0],
        memory_length=MEMORY_LENGTH,
    )
    expected = sine_stick_slip_ratio(
        decay_length=DECAY_LENGTH,
        vibration_amplitude=amplitude,
        frequency=FREQUENCY,
        sliding_speed=speed,
        memory_length=MEMORY_LENGTH,
    )
    assert batched[0] == approx(float(expected), abs=5e-6)


@pytest.mark.parametrize(
    "harmonics",
    [
        [2.5e-6, 3e-10],
        [2.5e-6 * np.exp(0.7j), 4e-8 * np.exp(2j)],
        [6e-6, 2e-7 * np.exp(-1j), 4e-8j],
        [1e-5 * np.exp(-2j), 3e-7, 5e-8 * np.exp(1j)],
    ],
)
def test_a_motion_with_harmonics_has_the_ratio_of_elements_integrated_in_time(harmonics: list[complex]) -> None:
    amplitudes = np.array(harmonics, dtype=complex)
    rotations = np.exp(2j * np.pi * np.multiply.outer(np.arange(2048) / 2048, np.arange(1, amplitudes.size + 1)))
    x = (rotations @ amplitudes).real
    force = normal_force(CONTACT, separation=separation(CONTACT, normal_load=LOAD) + x)
    motion = load_balanced_motion(
        CONTACT, ContactMotion(displacement=x, normal_force=force, frequency=FREQUENCY, normal_load=LOAD)
    )
    speeds = np.array([5e-3, 40e-3, 0.2, 0.5])
    sampled = AsperityStickSlip(memory_length=MEMORY_LENGTH, in_plane_fraction=1e-15)  # its own quadrature
    expected = sampled.ratio(CONTACT, motion, sliding_speed=speeds)
    assert ratios(amplitudes, speeds) == approx(expected, abs=3e-5 + SINE_TOLERANCE * (abs(amplitudes[1]) < 1e-9))


@examples(40)
@given(fraction=st.floats(1e-5, 0.03), lag=st.floats(-np.pi, np.pi), speed=st.floats(2e-3, 0.6))
def test_harmonics_change_friction_by_no_more_than_they_change_the_gap(
    fraction: float, lag: float, speed: float
) -> None:
    amplitude = 3e-6
    amplitudes = np.array([amplitude, fraction * amplitude * np.exp(1j * lag)])
    beta = amplitude / DECAY_LENGTH
    sine = float(
        sine_stick_slip_ratio(
            decay_length=DECAY_LENGTH,
            vibration_amplitude=amplitude,
            frequency=FREQUENCY,
            sliding_speed=speed,
            memory_length=MEMORY_LENGTH,
        )
    )
    about_the_same_mean = sine * i0e(beta) * np.exp(beta - balanced_mean(amplitudes) / DECAY_LENGTH)
    change = np.log(ratios(amplitudes, np.array([speed]))[0] / about_the_same_mean)
    assert abs(change) <= fraction * beta + 1e-5


def test_under_a_small_vibration_elements_carry_the_least_of_their_past_limits_and_slides() -> None:
    # lengths in decay lengths: the force of the element in contact below gap y is min over the past of limit plus slide
    beta, n = 0.1, 4096
    amplitudes = DECAY_LENGTH * beta * np.array([1.0, 0.06 * np.exp(4j)])
    phases = 2 * np.pi * np.arange(2 * n) / n
    x = (np.exp(1j * np.outer(phases, [1, 2])) @ amplitudes).real / DECAY_LENGTH
    nodes, weights = np.polynomial.legendre.leggauss(60)
    half = (x.max() - x.min()) / 2
    y = x.min() + half * (1 + nodes)
    expected = []
    for v in (relative_speeds := np.array([1e-3, 1e-2, 0.1])):
        slide = beta * v * phases
        limits = np.maximum(np.append(y, x.max())[:, np.newaxis] - x, 0.0)
        force = (np.minimum.accumulate(limits - slide, axis=1) + slide)[:, n:].mean(axis=1)
        always = np.exp(-x.max()) * (force[-1] + 1)  # elements that always touch carry their height above x.max() more
        expected.append((half * weights @ (np.exp(-y) * force[:-1]) + always) / np.exp(-x).mean())
    speeds = relative_speeds * beta * OMEGA * MEMORY_LENGTH
    assert ratios(amplitudes, speeds) == approx(np.array(expected), abs=2e-5)


def test_a_gap_held_wider_than_balanced_transmits_friction_less_by_the_exponential_law() -> None:
    beta, wider, speed = 1.5, 0.3, 0.02
    sine = sine_stick_slip_ratio(
        decay_length=DECAY_LENGTH,
        vibration_amplitude=beta * DECAY_LENGTH,
        frequency=FREQUENCY,
        sliding_speed=speed,
        memory_length=MEMORY_LENGTH,
    )
    found = batched_stick_slip_ratio(
        motions([DECAY_LENGTH * (np.log(i0e(beta)) + beta + wider)], [[beta * DECAY_LENGTH + 0j]]),
        decay_length=DECAY_LENGTH,
        sliding_speed=[speed],
        motion=[0],
        memory_length=MEMORY_LENGTH,
    )
    assert found[0] == approx(float(sine) * np.exp(-wider), abs=5e-6)


def test_a_motion_that_closes_twice_in_a_period_gives_nan() -> None:
    assert np.isnan(ratios(np.array([1e-6, 2e-6]), np.array([0.05])))


def test_inconsistent_arguments_are_refused_by_name() -> None:
    one = motions([0.0], [[1e-6]])
    with raises(InvalidInput, match="motion must lie between 0 and 0, got 1 to 1"):
        batched_stick_slip_ratio(one, decay_length=2e-6, sliding_speed=[0.1], motion=[1])
    with raises(InvalidInput, match="sliding_speed must be positive"):
        batched_stick_slip_ratio(one, decay_length=2e-6, sliding_speed=[0.0], motion=[0])
    with raises(InvalidInput, match="sliding_speed and motion must have the same shape"):
        batched_stick_slip_ratio(one, decay_length=2e-6, sliding_speed=[0.1, 0.2], motion=[0])
    with raises(InvalidInput, match="must have one row per motion"):
        GapMotionBatch(mean_displacement=np.zeros(1), harmonics=np.ones((1, 1), dtype=complex), frequency=np.ones(2))
