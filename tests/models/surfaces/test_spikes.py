"""Spikes of a scan: found among rough heights, and none where a surface has steps, grooves and missing pixels."""

import numpy as np

from sonolube.models.surfaces import HeightMap, spike_heights

SCAN = np.random.default_rng(5).normal(0.0, 0.5e-6, (80, 90)).cumsum(axis=0).cumsum(axis=1) * 1e-2


def found(height: np.ndarray) -> np.ndarray:
    return spike_heights(HeightMap(height=height, spacing_x=1e-6, spacing_y=1e-6))


def test_pixels_far_out_of_their_neighbours_are_spikes_of_that_height() -> None:
    height = SCAN.copy()
    at = ([10, 40, 70], [20, 60, 5])
    height[at] += np.array([2e-4, -3e-4, 2e-4])
    heights = found(height)
    assert np.argwhere(heights).tolist() == [[10, 20], [40, 60], [70, 5]]
    assert np.allclose(heights[at], [2e-4, -3e-4, 2e-4], rtol=0.05)


def test_rough_surfaces_steps_grooves_and_missing_pixels_have_none() -> None:
    step = SCAN + np.where(np.arange(90) < 45, 0.0, 1e-4)
    groove = SCAN - 1e-4 * (np.abs(np.arange(90) - 45) < 3)
    missing = SCAN.copy()
    missing[20:25, 20:25] = np.nan
    for height in (SCAN, step, groove, missing, np.zeros((9, 9)), SCAN[:1]):
        assert not found(height).any()
