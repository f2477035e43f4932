"""V. L. Popov, J. Starcevic and A. E. Filippov, Tribol. Lett. 39, 25 (2010): oscillation along the sliding."""

import warnings

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, ModelRangeWarning
from sonolube.models.friction import (
    SpringContact,
    approximate_longitudinal_ratio,
    longitudinal_oscillation_ratio,
    longitudinal_static_ratio,
)

FLAT = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8)
SPHERE = SpringContact(friction_coefficient=0.4, mindlin_ratio=0.8, profile="parabolic")
DEPTH, SLIP = 1e-6, 0.5e-6  # mu k_z u/k_x
SPEEDS = np.linspace(0.004, 1.0, 250)


def off(contact: SpringContact, stroke: float) -> np.ndarray:
    """Return approximate less exact ratios up to the peak velocity."""
    amplitude = stroke * SLIP
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelRangeWarning)
        found, exact = (
            ratio(
                contact,
                approach=DEPTH,
                in_plane_amplitude=amplitude,
                frequency=20e3,
                sliding_speed=SPEEDS * 2 * np.pi * 20e3 * amplitude,
            )
            for ratio in (approximate_longitudinal_ratio, longitudinal_oscillation_ratio)
        )
    return found - exact


@pytest.mark.parametrize("stroke", [0.1, 0.6, 0.95, 1.3])
def test_a_spring_holds_what_the_oscillation_leaves_of_its_limit(stroke: float) -> None:
    # pulled by a constant mean stretch until the strokes wear it down to what stays: unit limit and slip length
    stretch = mean = 0.0
    moves = np.diff(stroke * np.sin(np.linspace(0, 2 * np.pi, 2001)))
    for period in range(40):
        mean = 0.0
        for move in moves:
            stretch = min(max(stretch + move + (1e-3 if period < 20 else 0.0), -1.0), 1.0)
            mean += stretch / moves.size
    ratio = longitudinal_static_ratio(FLAT, approach=DEPTH, in_plane_amplitude=stroke * SLIP)
    assert ratio == approx(max(1 - stroke, 0.0))
    assert mean == approx(max(1 - stroke, 0.0), abs=0.01)


@pytest.mark.parametrize("stroke", [0.05, 0.3, 0.6, 0.9, 1.0])
def test_flat_the_published_form_carried_over_stays_just_below_the_exact_ratio(stroke: float) -> None:
    error = off(FLAT, stroke)
    assert error.max() < 2e-5
    assert -0.0144 * stroke < error.min() < -0.0140 * stroke


@pytest.mark.parametrize(("stroke", "most"), [(0.1, 0.002), (0.3, 0.005), (0.5, 0.017), (1.0, 0.11)])
def test_on_a_sphere_it_holds_up_to_half_the_slip_length(stroke: float, most: float) -> None:
    assert 0.8 * most < np.abs(off(SPHERE, stroke)).max() < most


@pytest.mark.parametrize(("contact", "stroke"), [(FLAT, 1.1), (SPHERE, 0.6)])
def test_a_stroke_that_slides_back_warns(contact: SpringContact, stroke: float) -> None:
    with pytest.warns(ModelRangeWarning, match="reverses the slip of springs"):
        approximate_longitudinal_ratio(
            contact, approach=DEPTH, in_plane_amplitude=stroke * SLIP, frequency=20e3, sliding_speed=0.01
        )


def test_without_oscillation_or_beyond_its_peak_velocity_friction_is_whole() -> None:
    for amplitude, speed in ((0.0, 0.01), (0.2e-6, 0.03)):
        ratio = approximate_longitudinal_ratio(
            FLAT, approach=DEPTH, in_plane_amplitude=amplitude, frequency=20e3, sliding_speed=speed
        )
        assert ratio == 1.0


def test_a_negative_amplitude_is_refused_by_name() -> None:
    with raises(InvalidInput, match="in_plane_amplitude must not be negative"):
        longitudinal_static_ratio(FLAT, approach=DEPTH, in_plane_amplitude=-1e-9)


@pytest.mark.parametrize("sliding_speed", [1e-9, 5.0, 1e3])
def test_without_oscillation_friction_is_whole_at_any_speed(sliding_speed: float) -> None:
    ratio = approximate_longitudinal_ratio(
        FLAT, approach=DEPTH, in_plane_amplitude=0.0, frequency=20e3, sliding_speed=sliding_speed
    )
    assert ratio == approx(1.0)
