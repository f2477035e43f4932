"""Significant peaks of surfaces with known hills, with and without Wolf pruning."""

import math

import numpy as np
from pytest import approx, mark, raises
from tests.same import same

from sonolube.errors import InvalidInput
from sonolube.models.surfaces import (
    GaussianCorrelationSpectrum,
    HeightMap,
    feature_parameters,
    gaussian_surface,
    summit_statistics,
)

PERIOD = 20e-6
WAVE = 2 * math.pi / PERIOD
X, Y = np.meshgrid(0.5e-6 * np.arange(400), 1e-6 * np.arange(300))
EGG_BOX = -1e-6 * (np.cos(WAVE * X) + np.cos(WAVE * Y))  # valleys at the edges


def surface_of(height: np.ndarray) -> HeightMap:
    return HeightMap(height=height, spacing_x=0.5e-6, spacing_y=1e-6)


def test_an_egg_box_has_one_hill_per_cell_and_the_curvature_of_its_waves() -> None:
    found = feature_parameters(surface_of(EGG_BOX))
    assert found.peak_density == approx(1 / PERIOD**2, rel=1e-12)
    assert found.mean_peak_curvature == approx(1e-6 * WAVE**2, rel=0.006)


def test_peaks_below_the_pruning_threshold_are_not_significant() -> None:
    ripple = 0.08e-6 * np.sin(8 * WAVE * X)  # of 0.16 um, against 0.2 um that 5 % of Sz ask for
    rippled = surface_of(EGG_BOX + ripple)
    assert feature_parameters(rippled).peak_density == approx(1 / PERIOD**2, rel=1e-12)
    assert feature_parameters(rippled, pruning=0.0).peak_density > 1.5 / PERIOD**2


def ridge_with_saddle(depth: float) -> HeightMap:
    ridge = np.interp(np.arange(41), [0, 10, 20, 30, 40], [0, 1, 0.9 - depth, 0.9, 0])
    height = ridge[None, :] * np.interp(np.arange(21), [0, 10, 20], [0, 1, 0])[:, None]
    return HeightMap(height=height, spacing_x=1e-6, spacing_y=1e-6)


def hills(surface: HeightMap) -> float:
    return feature_parameters(surface).peak_density * np.count_nonzero(surface.measured) * 1e-12


@mark.parametrize(("depth", "expected"), [(0.04, 1), (0.06, 2)])
def test_a_saddle_separates_two_hills_from_a_twentieth_of_the_height_on(depth: float, expected: int) -> None:
    assert hills(ridge_with_saddle(depth)) == approx(expected)


def test_missing_pixels_separate_hills() -> None:
    whole = ridge_with_saddle(0.02)
    cut = whole.height.copy()
    cut[:, 20] = np.nan
    assert hills(whole) == approx(1)
    assert hills(whole.with_height(cut)) == approx(2)


def test_the_density_of_significant_peaks_is_not_that_of_summits() -> None:
    rough = gaussian_surface(
        rms_height=1e-6,
        spectrum=GaussianCorrelationSpectrum(correlation_length=10e-6),
        shape=(300, 400),
        spacing_x=1e-6,
        spacing_y=1e-6,
        seed=3,
    )
    noisy = rough.with_height(rough.height + 0.05e-6 * np.random.default_rng(0).standard_normal(rough.height.shape))
    assert summit_statistics(noisy).summit_density > 5 * feature_parameters(noisy).peak_density
    assert feature_parameters(noisy).peak_density == approx(feature_parameters(rough).peak_density, rel=0.2)


def test_scaled_or_shifted_heights_have_the_same_hills() -> None:
    one, other = feature_parameters(surface_of(EGG_BOX)), feature_parameters(surface_of(3 * EGG_BOX - 1e-3))
    same(other.peak_density, one.peak_density)
    assert other.mean_peak_curvature == approx(3 * one.mean_peak_curvature)


def test_a_surface_without_hills_is_refused() -> None:
    with raises(InvalidInput, match="flat map has no hills"):
        feature_parameters(surface_of(np.ones((4, 4))))
    with raises(InvalidInput, match="none of the 1 peaks has four measured neighbours"):
        feature_parameters(surface_of(np.add.outer(np.arange(4.0), np.arange(4.0))))
    with raises(InvalidInput, match="none of the 1 peaks has four measured neighbours"):
        feature_parameters(surface_of(np.arange(4.0)[None, :]))
    with raises(InvalidInput, match="pruning must lie between 0 and 1"):
        feature_parameters(surface_of(EGG_BOX), pruning=2.0)
