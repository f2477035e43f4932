"""M. Popov and Q. Li, Phys. Mesomech. 21, 24 (2018): oscillation along the normal and along the sliding at once.

Their abstract, for constant stiffness: three numbers decide the law of friction, and by them it is (a) the same both
ways, (b) not the same, though without a force at rest, a ratchet, or (c) one with a force at rest, an actuator.
"""

import numpy as np
import pytest
from pytest import approx

from sonolube.models.friction import SpringContact, combined_oscillation_ratio

SPEEDS = np.array([0.002, 0.05, 0.3, 1.0])  # over slip length times angular frequency


def both_ways(
    apart: float,
    along: float,
    phase: float,
    *,
    coefficient: float = 0.4,
    ratio: float = 0.8,
    depth: float = 1e-6,
    frequency: float = 20e3,
) -> tuple[np.ndarray, np.ndarray]:
    """Return friction over that without, forwards and backwards; amplitudes over depth and over slip length."""
    contact = SpringContact(friction_coefficient=coefficient, mindlin_ratio=ratio)
    slip = coefficient / ratio * depth
    forwards, backwards = (
        combined_oscillation_ratio(
            contact,
            approach=depth,
            normal_amplitude=apart * depth,
            in_plane_amplitude=along * slip,
            in_plane_phase=lag,  # backwards, half a turn later in the mirror
            frequency=frequency,
            sliding_speed=SPEEDS * 2 * np.pi * frequency * slip,
        )
        for lag in (phase, phase + np.pi)
    )
    return forwards, backwards


@pytest.mark.parametrize(("apart", "along", "phase"), [(0.3, 0.8, 0.0), (0.6, 1.5, 2.0), (0.9, 0.3, 4.0)])
def test_two_amplitudes_and_a_phase_decide(apart: float, along: float, phase: float) -> None:
    one = both_ways(apart, along, phase)
    other = both_ways(apart, along, phase, coefficient=0.15, ratio=0.65, depth=5e-6, frequency=31e3)
    assert np.array(other) == approx(np.array(one), abs=1e-9)


def test_a_quarter_turn_apart_short_strokes_leave_friction_the_same_both_ways() -> None:
    forwards, backwards = both_ways(0.3, 0.3, np.pi / 2)
    assert forwards == approx(backwards, abs=1e-3)
    assert 0.5 < forwards[0] < 0.7


def test_in_step_short_strokes_make_a_ratchet() -> None:
    # pulled forwards it creeps from 0.4 of its friction on, backwards from the whole: left alone it rests
    forwards, backwards = both_ways(0.3, 0.3, 0.0)
    assert forwards[0] == approx(0.4, abs=0.02)
    assert backwards == approx(1.0, abs=1e-9)


@pytest.mark.parametrize(("apart", "along", "phase"), [(0.3, 0.8, 0.0), (0.6, 1.5, np.pi / 2), (0.9, 3.0, 0.0)])
def test_longer_strokes_make_an_actuator(apart: float, along: float, phase: float) -> None:
    # a force is left at rest: one that drives forwards and holds against going backwards
    forwards, backwards = both_ways(apart, along, phase)
    assert forwards[0] < -0.05
    assert backwards[0] > 0.05


def test_an_actuator_whose_springs_all_slide_has_one_force_at_rest() -> None:
    forwards, backwards = both_ways(0.6, 3.0, 0.0)
    assert forwards[0] == approx(-backwards[0], abs=0.01)


@pytest.mark.parametrize("phase", [0.0, np.pi / 2])
def test_sliding_faster_than_both_swings_leaves_friction_whole(phase: float) -> None:
    # the limit falls by 0.3 of a slip length a radian at most, the end swings by as much
    for way in both_ways(0.3, 0.3, phase):
        assert way[-1] == approx(1.0, abs=1e-9)
