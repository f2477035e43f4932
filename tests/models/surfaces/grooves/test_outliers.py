"""Outliers of single pixels: false alarms at a known level, and spikes that are found."""

import numpy as np
from pytest import mark

from sonolube.checks import Floats
from sonolube.models.surfaces import HeightMap
from sonolube.models.surfaces.grooves.groove import without_outliers

SHAPE = (300, 400)


def cleaned(height: Floats) -> Floats:
    return without_outliers(HeightMap(height=height, spacing_x=1e-6, spacing_y=1e-6)).height


@mark.parametrize("seed", range(3))
def test_no_pixel_of_white_gaussian_heights_is_an_outlier(seed: int) -> None:
    # beyond eight standard deviations lies a share of 1e-15: none of 120,000 pixels
    height = 1e-6 * np.random.default_rng(seed).standard_normal(SHAPE)
    assert np.isfinite(cleaned(height)).all()


def test_false_alarms_on_laplacian_heights_are_fewer_than_the_level_of_four_times_the_98th_percentile() -> None:
    # a deviation beyond that level has for an exponential tail the probability 0.02^4 = 1.6e-7: 0.02 of 120,000 pixels
    height = 1e-6 * np.random.default_rng(4).laplace(size=SHAPE)
    assert np.count_nonzero(~np.isfinite(cleaned(height))) <= 1


def test_spikes_of_thirty_standard_deviations_are_found_and_nothing_else() -> None:
    rng = np.random.default_rng(5)
    height = 1e-6 * rng.standard_normal(SHAPE)
    spikes = np.zeros(SHAPE, dtype=np.bool_)
    spikes[4::25, 7::25] = True
    height[spikes] += 30e-6 * rng.choice([-1, 1], int(spikes.sum()))
    np.testing.assert_array_equal(~np.isfinite(cleaned(height)), spikes)


def test_the_kinks_of_a_steep_groove_are_not_outliers() -> None:
    x = np.linspace(-1, 1, 400)
    height = np.tile(-30e-6 * np.clip(1 - np.abs(x) / 0.4, 0, None), (300, 1))
    assert np.isfinite(cleaned(height)).all()


def test_missing_pixels_stay_missing_and_their_neighbours_stay() -> None:
    rng = np.random.default_rng(6)
    height = 1e-6 * rng.standard_normal(SHAPE)
    height[rng.random(SHAPE) < 0.2] = np.nan
    np.testing.assert_array_equal(np.isfinite(cleaned(height)), np.isfinite(height))
