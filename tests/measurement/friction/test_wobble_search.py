"""Rotation of a disc found in friction forces with a known wobble."""

import numpy as np
import pytest
from pytest import approx

from sonolube.measurement.friction.wobble import find_rotation_speed

PARTS = [np.arange(start, end, 0.016) for start, end in ((1.0, 12.4), (13.0, 16.4), (17.0, 20.4), (21.0, 24.4))]


@pytest.mark.parametrize("speed", [0.15, 1 / 1.34, 2.7])
def test_the_speed_of_a_wobble_is_found_at_every_level(speed: float) -> None:
    rng = np.random.default_rng(4)
    forces = [
        1 / (1 + part)
        + 0.06 * np.cos(2 * np.pi * speed * t + 1)
        + 0.024 * np.cos(4 * np.pi * speed * t)
        + 0.02 * rng.standard_normal(t.size)
        for part, t in enumerate(PARTS)
    ]
    assert find_rotation_speed(PARTS, forces) == approx(speed, abs=0.1 / 24)  # a tenth of a turn over the recording


def test_no_rotation_is_found_in_noise() -> None:
    rng = np.random.default_rng(5)
    assert all(find_rotation_speed(PARTS, [rng.standard_normal(t.size) for t in PARTS]) is None for _ in range(20))


def test_a_wave_in_one_part_only_is_no_rotation() -> None:
    rng = np.random.default_rng(6)
    forces = [0.01 * rng.standard_normal(t.size) + (j == 2) * np.sin(2 * np.pi * 2 * t) for j, t in enumerate(PARTS)]
    assert find_rotation_speed(PARTS, forces) is None


def test_a_wobble_in_proportion_to_friction_is_found_where_little_friction_is_left() -> None:
    rng = np.random.default_rng(7)
    forces = [
        level * (1 + 0.05 * np.cos(2 * np.pi * 0.75 * t)) + 0.004 * rng.standard_normal(t.size)
        for level, t in zip((0.9, 0.35, 0.2, 0.15), PARTS, strict=True)
    ]
    assert find_rotation_speed(PARTS, forces) == approx(0.75, abs=0.1 / 24)


def test_the_rotation_is_found_in_two_samples_a_second_too() -> None:
    rng = np.random.default_rng(3)
    t = np.arange(0, 6000, 0.5)
    force = 1 + 0.2 * np.cos(2 * np.pi * 0.15 * t + 1) + 0.05 * np.cos(4 * np.pi * 0.15 * t)
    found = find_rotation_speed([t], [force + 0.02 * rng.standard_normal(t.size)], harmonics=2)
    assert found == approx(0.15, rel=1e-3)
