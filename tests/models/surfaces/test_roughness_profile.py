"""Profile parameters against closed forms of waves."""

import math

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, mark, raises
from tests.same import same
from tests.tiers import examples

from sonolube.errors import InvalidInput
from sonolube.models.surfaces import HeightMap, profile_parameters, profile_statistics

SPACING = 0.5e-6
X = SPACING * np.arange(2000)
WAVELENGTH = 50e-6  # twenty waves, four to a section


def sine(amplitude: float = 2e-6) -> np.ndarray:
    return np.asarray(amplitude * np.sin(2 * math.pi * X / WAVELENGTH + 0.4))


def test_a_sine_has_the_parameters_of_a_sine() -> None:
    found = profile_parameters(height=sine(), spacing=SPACING)
    assert found.arithmetic_mean_height == approx(4e-6 / math.pi, rel=1e-3)
    assert found.rms_height == approx(2e-6 / math.sqrt(2))
    assert (found.maximum_peak_height, found.maximum_pit_depth) == approx((2e-6, 2e-6), rel=1e-3)
    assert found.total_height == approx(found.maximum_peak_height + found.maximum_pit_depth)
    assert found.mean_section_height == approx(4e-6, rel=1e-3)
    assert found.skewness == approx(0, abs=1e-9)
    assert found.kurtosis == approx(1.5)
    assert found.mean_profile_element_spacing == approx(WAVELENGTH, rel=1e-6)


def test_the_maximum_height_is_the_mean_of_five_sections_and_the_total_height_that_of_the_profile() -> None:
    growing = np.repeat([1.0, 2.0, 3.0, 4.0, 5.0], 400) * sine()
    found = profile_parameters(height=growing, spacing=SPACING)
    assert found.mean_section_height == approx(3 * 4e-6, rel=1e-3)
    assert found.total_height == approx(5 * 4e-6, rel=1e-3)


def test_the_section_length_can_be_given() -> None:
    growing = np.repeat([1.0, 2.0, 3.0, 4.0, 5.0], 400) * sine()
    found = profile_parameters(height=growing, spacing=SPACING, section_length=2 * 400 * SPACING)
    assert found.mean_section_height == approx((2 + 4) / 2 * 4e-6, rel=1e-3)  # the last half section is left out


def test_a_short_profile_is_one_section() -> None:
    found = profile_parameters(height=sine()[:49], spacing=SPACING)
    assert found.mean_section_height == approx(found.total_height)
    assert found.mean_profile_element_spacing is None


def test_ripples_below_a_tenth_of_the_maximum_height_make_no_profile_elements() -> None:
    rippled = sine() + 0.1e-6 * np.sin(2 * math.pi * X / 1.7e-6)
    assert profile_parameters(height=rippled, spacing=SPACING).mean_profile_element_spacing == approx(
        WAVELENGTH, rel=0.01
    )


@given(share=st.floats(0.0, 0.5), seed=st.integers(0, 100))
@examples(15)
def test_missing_points_do_not_change_the_parameters_beyond_sampling_error(share: float, seed: int) -> None:
    height = sine()
    height[np.random.default_rng(seed).random(height.size) < share] = np.nan
    found = profile_parameters(height=height, spacing=SPACING)
    assert found.rms_height == approx(2e-6 / math.sqrt(2), rel=0.05)
    assert found.mean_profile_element_spacing == approx(WAVELENGTH, rel=0.01)


@given(factor=st.floats(0.01, 100), shift=st.floats(-1e-3, 1e-3))
@examples(15)
def test_parameters_scale_with_the_heights_and_do_not_depend_on_the_datum(factor: float, shift: float) -> None:
    noise = 1e-6 * np.random.default_rng(1).standard_normal(500)
    one = profile_parameters(height=noise, spacing=SPACING)
    other = profile_parameters(height=factor * noise + shift, spacing=SPACING)
    assert other.mean_section_height == approx(factor * one.mean_section_height, rel=1e-6)
    assert other.kurtosis == approx(one.kurtosis, rel=1e-4)
    assert other.mean_profile_element_spacing == approx(one.mean_profile_element_spacing, rel=1e-6)


def test_rows_and_columns_of_a_map_have_their_own_profiles() -> None:
    amplitudes = np.array([1e-6, 2e-6, 3e-6, 6e-6])
    height = amplitudes[:, None] * np.sin(2 * math.pi * X / WAVELENGTH)[None, :]
    surface = HeightMap(height=height, spacing_x=SPACING, spacing_y=7e-6)
    found = profile_statistics(surface)
    assert found.mean.rms_height == approx(3e-6 / math.sqrt(2))
    assert found.standard_deviation.rms_height == approx(np.std(amplitudes) / math.sqrt(2))
    assert found.mean.mean_profile_element_spacing == approx(WAVELENGTH)
    assert (found.profile_count, found.excluded_count) == (4, 0)
    turned = HeightMap(height=height.T, spacing_x=7e-6, spacing_y=SPACING)
    same(profile_statistics(turned, along="columns"), found)


def test_profiles_without_heights_are_left_out_and_counted() -> None:
    height = np.vstack([sine(), np.full(X.size, np.nan), np.zeros(X.size)])
    found = profile_statistics(HeightMap(height=height, spacing_x=SPACING, spacing_y=SPACING))
    assert (found.profile_count, found.excluded_count) == (1, 2)
    same(found.mean, profile_parameters(height=sine(), spacing=SPACING))


@mark.parametrize(
    ("height", "message"),
    [
        (np.full(9, np.nan), "must have two different measured values, got 0 measured"),
        (np.zeros(9), "two different measured values, got 9 measured"),
        (np.zeros((2, 9)), r"one-dimensional array of numbers, got shape \(2, 9\)"),
        (np.array([0.0, np.inf]), "infinite"),
        (np.array([1.0]), "got 1 measured"),
    ],
)
def test_heights_of_no_profile_are_refused(height: np.ndarray, message: str) -> None:
    with raises(InvalidInput, match=message):
        profile_parameters(height=height, spacing=SPACING)


def test_a_map_without_profiles_and_a_section_longer_than_the_profile_are_refused() -> None:
    with raises(InvalidInput, match="none of the 2 rows has two different measured heights"):
        profile_statistics(HeightMap(height=np.ones((2, 3)), spacing_x=1.0, spacing_y=1.0))
    with raises(InvalidInput, match=r"section_length must lie between .* got 0\.01 m"):
        profile_parameters(height=sine(), spacing=SPACING, section_length=0.01)
