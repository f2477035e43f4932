"""Height distributions: normalization, the common tail, and refused parameters."""

import numpy as np
from hypothesis import given, strategies as st
from numpy.typing import ArrayLike, NDArray
from pytest import approx, raises
from scipy.integrate import quad
from scipy.stats import norm

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact import HEIGHT_DISTRIBUTIONS, ExponentialHeights, GaussianHeights, HeightDistribution


def density(heights: HeightDistribution, height: ArrayLike) -> NDArray[np.float64]:
    return np.exp(heights.log_density(np.asarray(height, dtype=np.float64)))


@given(ratio=st.floats(0.2, 1), height=st.floats(-3, 3))
def test_gaussian_heights_are_the_normal_law(ratio: float, height: float) -> None:
    heights = GaussianHeights(summit_deviation_ratio=ratio)
    assert density(heights, height) == approx(norm.pdf(height, scale=ratio), rel=1e-12, abs=0)


def test_the_published_exponential_law_is_17_exp_minus_3_z() -> None:
    z = np.array([0.0, 1.0, 3.0])
    assert density(ExponentialHeights(), z) == approx([17.0, 17 * 0.049787068, 17 * 1.2340980e-4])


def test_the_exponential_density_is_not_normalized() -> None:
    above = quad(lambda z: float(density(ExponentialHeights(), z)), 0, 20)[0]
    assert above == approx(17 / 3)


def test_the_published_law_follows_the_gaussian_tail_far_better_than_the_simple_one() -> None:
    # the claim of its authors against exp(-z), over the heights that touch
    z = np.linspace(1.0, 4.0, 31)
    gaussian = norm.pdf(z)
    published = density(ExponentialHeights(), z)
    simple = density(ExponentialHeights(amplitude=1, decay=1), z)
    assert np.abs(np.log(published / gaussian)).max() < np.log(4)
    assert np.abs(np.log(simple / gaussian)).max() > np.log(100)


def test_summit_heights_have_a_smaller_deviation_than_the_surface() -> None:
    # McCool at 0.04: sigma_s^2/sigma^2 = 1 - 3.717e-4/1.6e-3 = 0.7676875
    heights = GaussianHeights.from_roughness_parameter(roughness_parameter=0.04)
    assert heights.summit_deviation_ratio**2 == approx(0.7676875)


def test_a_surface_too_smooth_to_be_gaussian_is_refused() -> None:
    with raises(OutsideRange, match=r"roughness_parameter must exceed 0\.0193 for a Gaussian surface, got 0\.01"):
        GaussianHeights.from_roughness_parameter(roughness_parameter=0.01)


def test_a_deviation_of_summits_above_that_of_the_surface_is_refused() -> None:
    with raises(InvalidInput, match=r"summit_deviation_ratio must lie between 0 and 1, got 1\.5"):
        GaussianHeights(summit_deviation_ratio=1.5)


def test_an_exponential_distribution_without_decay_is_refused() -> None:
    with raises(InvalidInput, match=r"decay must be positive, got 0"):
        ExponentialHeights(decay=0)


def test_the_table_names_each_height_law_by_its_own_name() -> None:
    assert {name: law.name for name, law in HEIGHT_DISTRIBUTIONS.items()} == {
        "exponential": "exponential",
        "gaussian": "gaussian",
    }


def test_the_deviation_of_exponential_heights_is_that_of_the_exponential_law() -> None:
    decay = 3.0
    z = np.linspace(0, 20, 200_001)
    exact = decay * np.exp(-decay * z)
    mean = np.trapezoid(z * exact, z)
    deviation = np.sqrt(np.trapezoid((z - mean) ** 2 * exact, z))
    assert ExponentialHeights(decay=decay).standard_deviation == approx(deviation, rel=1e-6)
