"""Material ratio curves and their parameters for height distributions in closed form."""

import math

import numpy as np
from hypothesis import given, settings, strategies as st
from pytest import approx, raises
from scipy.integrate import quad
from scipy.stats import norm

from sonolube.errors import InvalidInput
from sonolube.models.surfaces import HeightMap, functional_parameters, material_ratio_curve

SHARES = (np.arange(1_000_000) + 0.5) / 1_000_000
MIXED = np.random.default_rng(0).permutation(1_000_000)


def surface_of(heights: np.ndarray) -> HeightMap:
    return HeightMap(height=heights[MIXED].reshape(1000, 1000), spacing_x=1e-6, spacing_y=2e-6)


GAUSSIAN = surface_of(norm.isf(SHARES))
RAMP = surface_of(3.0 * SHARES)


def test_gaussian_heights_have_the_material_ratio_of_the_normal_law() -> None:
    curve = material_ratio_curve(GAUSSIAN)
    heights = np.array([-2.0, -0.5, 0.0, 1.0, 3.0])
    assert curve.ratio_above(intersection_height=heights) == approx(norm.sf(heights), rel=1e-3)
    shares = np.array([0.01, 0.1, 0.5, 0.8, 0.999])
    assert curve.height_at(material_ratio=shares) == approx(norm.isf(shares), abs=1e-3)


def test_gaussian_heights_have_the_core_of_the_line_through_the_middle_of_their_curve() -> None:
    found = functional_parameters(GAUSSIAN)
    # least squares over 30 to 70 % of the material, the flattest 40 % by symmetry
    first = quad(lambda p: (p - 0.5) * norm.isf(p), 0.3, 0.7)[0]
    core = -first / (0.4**3 / 12)
    share = norm.sf(core / 2)
    area = quad(lambda z: norm.sf(z), core / 2, 12)[0]
    assert found.core_height == approx(core, rel=1e-3)
    assert found.peak_material_ratio == approx(share, rel=3e-3)
    assert found.valley_material_ratio == approx(1 - share, rel=3e-3)
    assert found.reduced_peak_height == approx(2 * area / share, rel=2e-3)
    assert found.reduced_valley_depth == approx(2 * area / share, rel=2e-3)


def test_gaussian_heights_have_the_volumes_of_the_normal_law() -> None:
    found = functional_parameters(GAUSSIAN)
    z1, z2 = norm.isf([0.1, 0.8])
    above = [quad(norm.sf, z, 12)[0] for z in (z1, z2)]
    below = [quad(norm.cdf, -12, z)[0] for z in (z1, z2)]
    assert found.peak_material_volume == approx(above[0], rel=1e-4)
    assert found.core_material_volume == approx(above[1] - above[0], rel=1e-4)
    assert found.core_void_volume == approx(below[0] - below[1], rel=1e-4)
    assert found.valley_void_volume == approx(below[1], rel=1e-4)


def test_uniformly_distributed_heights_are_all_core() -> None:
    found = functional_parameters(RAMP)
    assert found.core_height == approx(3.0)
    assert found.reduced_peak_height == approx(0, abs=1e-5)
    assert found.reduced_valley_depth == approx(0, abs=1e-5)
    assert (found.peak_material_ratio, found.valley_material_ratio) == approx((0, 1), abs=1e-5)
    assert found.peak_material_volume == approx(3 * 0.1**2 / 2, rel=1e-4)
    assert found.valley_void_volume == approx(3 * 0.2**2 / 2, rel=1e-4)


def test_a_plateau_with_valleys_has_deep_valleys_and_low_peaks() -> None:
    grooves = np.where(SHARES < 0.1, -20.0, 0.0) + 0.1 * norm.isf(1 - SHARES)
    found = functional_parameters(surface_of(grooves))
    assert found.valley_material_ratio == approx(0.9, abs=0.03)
    assert found.reduced_valley_depth > 10 * found.reduced_peak_height


def test_missing_pixels_do_not_change_the_material_ratio() -> None:
    height = GAUSSIAN.height.copy()
    height[np.random.default_rng(1).random(height.shape) < 0.3] = np.nan
    sparse = material_ratio_curve(GAUSSIAN.with_height(height))
    assert sparse.ratio_above(intersection_height=0.5) == approx(norm.sf(0.5), abs=3e-3)


@given(heights=st.lists(st.integers(-20, 20), min_size=6, max_size=6, unique=True), share=st.floats(0.1, 0.9))
@settings(deadline=None)
def test_height_and_ratio_are_inverse_to_each_other(heights: list[int], share: float) -> None:
    curve = material_ratio_curve(HeightMap(height=np.array(heights, float).reshape(2, 3), spacing_x=1.0, spacing_y=1.0))
    there = curve.height_at(material_ratio=share)
    assert curve.ratio_above(intersection_height=there) == approx(share)
    assert curve.ratio_above(intersection_height=[math.nextafter(curve.height[0], np.inf), -100.0]) == approx([0, 1])


def test_pixels_of_one_height_have_one_ratio() -> None:
    curve = material_ratio_curve(HeightMap(height=np.array([[0.0, 0, 0], [4, 4, 4]]), spacing_x=1.0, spacing_y=1.0))
    assert curve.ratio_above(intersection_height=[2.1, 1.9, -2.1]) == approx([0, 0.5, 1], abs=0.1)


def test_a_map_that_is_flat_or_a_point_is_refused() -> None:
    with raises(InvalidInput, match="two measured pixels, got 1"):
        material_ratio_curve(HeightMap(height=np.zeros((1, 1)), spacing_x=1.0, spacing_y=1.0))
    with raises(InvalidInput, match="ten measured pixels of different heights"):
        functional_parameters(HeightMap(height=np.ones((9, 9)), spacing_x=1.0, spacing_y=1.0))
