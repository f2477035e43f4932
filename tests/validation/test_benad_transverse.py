"""J. Benad, K. Nakano, V. L. Popov and M. Popov, Friction 7, 74 (2019): oscillation across the sliding.

Their abstract: friction is a function of two numbers, a velocity and an amplitude; very large amplitudes give the known
solutions; of small ones the stiffness of the contact decides.
"""

from typing import Any

import numpy as np
import pytest
from pytest import approx
from scipy.integrate import quad

from sonolube.errors import ModelRangeWarning
from sonolube.models.friction import (
    SpringContact,
    approximate_transverse_ratio,
    combined_oscillation_ratio,
    transverse_static_ratio,
    transverse_vibration_ratio,
)

FLAT = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8)
SPHERE = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8, profile="parabolic")
DEPTH, SLIP, FREQUENCY = 1e-6, 0.5e-6, 20e3  # slip length mu k_z u/k_x


def marched(stroke: float, speed: float) -> float:
    """Return the mean friction of a unit spring; stroke in slip lengths, speed over the peak velocity."""
    n = 20_000
    across = np.diff(stroke * np.sin(2 * np.pi * np.arange(n + 1) / n)).tolist()
    along, (p, q), mean = 2 * np.pi * speed * stroke / n, (1.0, 0.0), 0.0
    for _ in range(4):
        mean = 0.0
        for move in across:
            p, q = p + along, q + move
            length = max(float(np.hypot(p, q)), 1.0)
            p, q = p / length, q / length
            mean += p / n
    return mean


@pytest.mark.parametrize(("stroke", "speed"), [(0.3, 0.5), (1.0, 0.4), (1.5, 0.7), (5.0, 0.5)])
def test_the_closed_form_is_near_a_spring_marched(stroke: float, speed: float) -> None:
    ratio = approximate_transverse_ratio(
        FLAT,
        approach=DEPTH,
        transverse_amplitude=stroke * SLIP,
        frequency=FREQUENCY,
        sliding_speed=speed * 2 * np.pi * FREQUENCY * stroke * SLIP,
    )
    assert -1e-3 < ratio - marched(stroke, speed) < (0.043 if speed < 0.5 else 0.021)


@pytest.mark.parametrize("contact", [FLAT, SPHERE])
@pytest.mark.parametrize(("least", "most"), [(0.3, 0.043), (0.5, 0.021), (0.7, 0.01)])
def test_it_is_nearer_the_faster_the_sliding(contact: SpringContact, least: float, most: float) -> None:
    strokes = np.array([0.1, 0.5, 1.0, 1.5, 2.0, 3.0, 10.0])[:, np.newaxis] * SLIP
    conditions: dict[str, Any] = {
        "approach": DEPTH,
        "frequency": FREQUENCY,
        "transverse_amplitude": strokes,
        "sliding_speed": np.array([least, 1.5 * least, 1.5]) * 2 * np.pi * FREQUENCY * strokes,
    }
    error = approximate_transverse_ratio(contact, **conditions) - combined_oscillation_ratio(
        contact, steps=512, **conditions
    )
    assert error.min() > -0.004
    assert 0.4 * most < error.max() < most


def test_a_long_stroke_turns_friction_as_rigid_bodies_do() -> None:
    conditions: dict[str, Any] = {"sliding_speed": 0.5, "frequency": FREQUENCY}
    long = approximate_transverse_ratio(FLAT, approach=1e-12, transverse_amplitude=5e-6, **conditions)
    rigid = transverse_vibration_ratio(sliding_speed=0.5, vibration_velocity=2 * np.pi * FREQUENCY * 5e-6)
    assert long == approx(float(rigid), rel=1e-9)


@pytest.mark.parametrize("stroke", [0.0, 0.3, 0.8, 1.0, 2.0])
def test_at_rest_the_force_across_leaves_the_other_side_of_the_triangle(stroke: float) -> None:
    flat, sphere = (
        transverse_static_ratio(contact, approach=DEPTH, transverse_amplitude=stroke * SLIP)
        for contact in (FLAT, SPHERE)
    )
    assert flat == approx(np.sqrt(max(1 - stroke**2, 0.0)), abs=1e-12)
    held = quad(lambda q: 1.5 * np.sqrt(max((1 - q * q) ** 2 - stroke**2, 0.0)), 0, np.sqrt(max(1 - stroke, 0.0)))[0]
    assert sphere == approx(held, abs=1e-7)


@pytest.mark.parametrize("contact", [FLAT, SPHERE])
@pytest.mark.parametrize("stroke", [0.3, 0.7])
def test_slow_sliding_comes_down_to_it(contact: SpringContact, stroke: float) -> None:
    amplitude = stroke * SLIP
    slow = combined_oscillation_ratio(
        contact,
        approach=DEPTH,
        frequency=FREQUENCY,
        sliding_speed=1e-3 * 2 * np.pi * FREQUENCY * amplitude,
        transverse_amplitude=amplitude,
    )
    static = transverse_static_ratio(contact, approach=DEPTH, transverse_amplitude=amplitude)
    assert slow == approx(float(static), abs=0.01)


def test_sliding_too_slow_for_the_closed_form_warns() -> None:
    with pytest.warns(ModelRangeWarning, match=r"below 0\.3 of the peak velocity"):
        approximate_transverse_ratio(
            FLAT, approach=DEPTH, transverse_amplitude=SLIP, frequency=FREQUENCY, sliding_speed=0.01
        )


VELOCITIES = np.array([0.1, 0.4, 0.9])  # over the peak velocity across


def exact(contact: SpringContact, stroke: float, *, depth: float = DEPTH, frequency: float = FREQUENCY) -> np.ndarray:
    amplitude = stroke * contact.slip_per_approach * depth
    return combined_oscillation_ratio(
        contact,
        approach=depth,
        transverse_amplitude=amplitude,
        frequency=frequency,
        sliding_speed=VELOCITIES * 2 * np.pi * frequency * amplitude,
        steps=4096 if stroke > 10 else 1024,
    )


@pytest.mark.parametrize("profile", ["flat", "parabolic"])
@pytest.mark.parametrize("stroke", [0.5, 2.0])
def test_velocity_over_the_peak_and_amplitude_over_the_slip_length_decide(profile: Any, stroke: float) -> None:
    one, other = (
        SpringContact(friction_coefficient=mu, mindlin_ratio=ratio, profile=profile)
        for mu, ratio in ((0.4, 0.8), (0.15, 0.65))
    )
    assert exact(other, stroke, depth=4e-6, frequency=31e3) == approx(exact(one, stroke), abs=1e-9)


@pytest.mark.parametrize("contact", [FLAT, SPHERE])
def test_very_large_amplitudes_give_the_known_solution(contact: SpringContact) -> None:
    rigid = transverse_vibration_ratio(sliding_speed=VELOCITIES, vibration_velocity=1.0)
    assert exact(contact, 200.0) == approx(rigid, abs=2e-3)


@pytest.mark.parametrize("contact", [FLAT, SPHERE])
def test_small_amplitudes_do_little_because_the_contact_yields(contact: SpringContact) -> None:
    assert np.all(exact(contact, 0.05) > 0.995)
    assert transverse_vibration_ratio(sliding_speed=VELOCITIES[0], vibration_velocity=1.0) < 0.25
