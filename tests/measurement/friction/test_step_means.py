"""Wobble taken off friction at voltage steps, whose amplitude is the same at every level or in proportion to it."""

import numpy as np
import pytest

from sonolube.measurement.friction.step_means import sampled_parts, without_wobble, wobble_columns

TIME = np.arange(0.0, 24.4, 2e-3)
PARTS = [slice(*np.searchsorted(TIME, ends)) for ends in ((1.0, 12.4), (13.0, 16.4), (17.0, 20.4), (21.0, 24.4))]
LEVELS = (0.9, 0.35, 0.2, 0.15)
TURNS = 0.75


@pytest.mark.parametrize("in_proportion", [True, False])
def test_a_wobble_of_either_kind_is_taken_off_down_to_the_noise(in_proportion: bool) -> None:
    noise = 1e-3 * np.random.default_rng(3).standard_normal(TIME.size)
    force = np.zeros(TIME.size)
    for part, level in zip(PARTS, LEVELS, strict=True):
        amplitude = 0.06 * (level if in_proportion else 1.0)
        force[part] = level + amplitude * np.cos(2 * np.pi * TURNS * TIME[part] + 1)
    parts = sampled_parts(PARTS, time=TIME, friction_force=force + noise)
    waves, _ = wobble_columns(parts, revolutions=[TURNS * time for time in parts.times], harmonics=2)
    left = without_wobble(parts, waves)
    assert max(float(np.std(each)) for each in left) < 1.1e-3
