"""Asperity stick-slip against elements integrated in time, closed forms and limits."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises
from scipy.special import i0, i0e

from sonolube.errors import InvalidInput
from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactMotion,
    ContactPair,
    RoughContact,
    load_balanced_motion,
    normal_force,
    separation,
    sinusoidal_motion,
)
from sonolube.models.friction import AsperityStickSlip, mindlin_memory_length, sine_stick_slip_ratio
from sonolube.models.surfaces import Roughness

CONTACT = RoughContact(  # D Table 3.2
    roughness=Roughness(rms_height=6e-6, summit_radius=1.5e-6, summit_density=4.7e10),
    pair=ContactPair(effective_modulus=59.6e9, poisson_ratio=0.33, yield_strength=410e6, mindlin_ratio=0.8),
    nominal_area=2.25e-6,
    asperity=ASPERITY_LAWS["dong_2015"],
)
DECAY_LENGTH, MEMORY_LENGTH, FREQUENCY, LOAD = 2e-6, 1.5e-6, 22e3, 3.0
OMEGA = 2 * np.pi * FREQUENCY


def ratio(beta: float, v: float) -> float:
    amplitude = beta * DECAY_LENGTH
    return float(
        sine_stick_slip_ratio(
            decay_length=DECAY_LENGTH,
            vibration_amplitude=amplitude,
            frequency=FREQUENCY,
            sliding_speed=v * OMEGA * amplitude * MEMORY_LENGTH / DECAY_LENGTH,
            memory_length=MEMORY_LENGTH,
        )
    )


def integrated(gap: np.ndarray, slides: np.ndarray, *, elements: int = 1500, periods: int = 3) -> float:
    """Return friction over mean limit of many elements by time integration; gap and slide per step in decay lengths."""
    contact_gap = np.linspace(gap.min(), gap.max() + 25, elements)
    density = np.exp(-(contact_gap - gap.min()))
    friction, limits = np.zeros(elements), np.zeros(elements)
    force = np.maximum(
        contact_gap - gap.max(), 0
    )  # permanently loaded elements start at their limit; from rest they would take long
    for period in range(periods):
        for x, slide in zip(gap, slides, strict=True):
            limit = np.maximum(contact_gap - x, 0)
            force = np.clip(force + slide, -limit, limit)
            if period == periods - 1:
                friction += force
                limits += limit
    return float(np.trapezoid(density * friction, contact_gap) / np.trapezoid(density * limits, contact_gap))


@pytest.mark.parametrize(
    ("beta", "v", "expected"), [(1.25, 0.3, 0.663), (5, 0.1, 0.3235), (20, 0.3, 0.93655), (40, 0.05, 0.41473)]
)
def test_the_ratio_is_that_of_a_time_integration(beta: float, v: float, expected: float) -> None:
    assert ratio(beta, v) == approx(expected, abs=5e-4 if beta < 10 else 1e-5)


@pytest.mark.parametrize(("beta", "v"), [(0.3, 0.5), (1.25, 0.3), (1.25, 0.9), (5, 0.1)])
def test_the_ratio_is_that_of_elements_integrated_one_by_one(beta: float, v: float) -> None:
    steps = 4000
    theta = 2 * np.pi * np.arange(steps) / steps
    assert ratio(beta, v) == approx(
        integrated(beta * np.cos(theta), np.full(steps, v * beta * 2 * np.pi / steps)), abs=2e-3
    )


@pytest.mark.parametrize("beta", [0.1, 1.25, 7.0, 100.0])
def test_slow_sliding_has_the_friction_of_the_smallest_normal_force(beta: float) -> None:
    assert ratio(beta, 1e-9) == approx(np.exp(-2 * beta) / i0e(beta), abs=1e-6)


@given(beta=st.floats(1e-3, 100), v=st.floats(1.0, 100.0))
def test_beyond_the_critical_speed_friction_is_exactly_that_without_vibration(beta: float, v: float) -> None:
    assert ratio(beta, v * (1 + 1e-12)) == 1


@given(beta=st.floats(1e-3, 60), v=st.floats(1e-4, 0.999), faster=st.floats(1.01, 3))
def test_friction_grows_with_speed_from_the_static_ratio_to_one(beta: float, v: float, faster: float) -> None:
    static = np.exp(-2 * beta) / i0e(beta)
    assert static - 1e-9 <= ratio(beta, v) <= ratio(beta, v * faster) + 1e-9 <= 1 + 2e-9


def test_without_vibration_the_ratio_is_one() -> None:
    assert sine_stick_slip_ratio(
        decay_length=2e-6, vibration_amplitude=[0.0, 0.0], frequency=22e3, sliding_speed=[1e-6, 1.0]
    ) == approx([1, 1])


@pytest.mark.parametrize("amplitude", [0.1e-6, 1e-6, 2.5e-6, 6e-6, 14e-6])
def test_a_sampled_sine_gives_the_closed_form(amplitude: float) -> None:
    speeds = np.geomspace(1e-3, 2, 12)
    motion = load_balanced_motion(
        CONTACT, sinusoidal_motion(CONTACT, normal_load=LOAD, vibration_amplitude=amplitude, frequency=FREQUENCY)
    )
    closed = sine_stick_slip_ratio(
        decay_length=DECAY_LENGTH, vibration_amplitude=amplitude, frequency=FREQUENCY, sliding_speed=speeds
    )
    assert AsperityStickSlip().ratio(CONTACT, motion, sliding_speed=speeds) == approx(closed, abs=1e-4)


def two_harmonics(samples: int = 256) -> ContactMotion:
    theta = 2 * np.pi * np.arange(samples) / samples
    x = 2e-6 * np.cos(theta) + 0.8e-6 * np.sin(2 * theta + 0.4)
    forces = normal_force(CONTACT, separation=separation(CONTACT, normal_load=LOAD) + x)
    return load_balanced_motion(
        CONTACT, ContactMotion(displacement=x, normal_force=forces, frequency=FREQUENCY, normal_load=LOAD)
    )


@pytest.mark.parametrize(("fraction", "lag"), [(0.0, 0.0), (0.3, 1.0), (0.8, -0.5)])
def test_any_motion_has_the_ratio_of_elements_integrated_one_by_one(fraction: float, lag: float) -> None:
    speed, steps = 0.05, 4000
    theta = 2 * np.pi * np.arange(steps) / steps
    motion = two_harmonics()
    mean = motion.displacement.mean()
    gap = mean + 2e-6 * np.cos(theta) + 0.8e-6 * np.sin(2 * theta + 0.4)
    in_plane = fraction * (2e-6 * np.cos(theta - lag) + 0.8e-6 * np.sin(2 * (theta - lag) + 0.4))
    slides = speed / FREQUENCY / steps + in_plane - np.roll(in_plane, 1)
    computed = AsperityStickSlip(in_plane_fraction=fraction, in_plane_phase=lag, memory_length=MEMORY_LENGTH).ratio(
        CONTACT, motion, sliding_speed=speed
    )
    assert computed == approx(integrated(gap / DECAY_LENGTH, slides / MEMORY_LENGTH), abs=2e-3)


def test_fast_sliding_about_the_separation_at_rest_has_the_mean_normal_force() -> None:
    motion = sinusoidal_motion(CONTACT, normal_load=LOAD, vibration_amplitude=2.5e-6, frequency=FREQUENCY)
    assert AsperityStickSlip().ratio(CONTACT, motion, sliding_speed=10.0) == approx(i0(1.25), rel=1e-5)


def test_mindlins_memory_length_is_hand_computed() -> None:
    # mu l k_n/k_t = 0.3 * 2 um/0.8
    assert mindlin_memory_length(CONTACT, friction_coefficient=0.3, normal_load=LOAD) == approx(0.75e-6)


def test_a_memory_length_of_zero_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"memory_length must be positive, got 0\.0 m"):
        AsperityStickSlip(memory_length=0.0).ratio(CONTACT, two_harmonics(), sliding_speed=0.1)


@given(beta=st.floats(1e-3, 40), short=st.floats(0, 1e-9))
def test_a_speed_below_the_critical_one_by_rounding_error_gives_a_ratio_of_one(beta: float, short: float) -> None:
    assert ratio(beta, 1 - short) == approx(1, abs=1e-12)
