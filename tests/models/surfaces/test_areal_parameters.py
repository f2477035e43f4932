"""Areal parameters against closed forms of simple surfaces, and the symmetries that ISO 25178-2 implies."""

import math

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, mark, raises
from scipy.integrate import quad
from tests.tiers import examples

from sonolube.errors import InvalidInput
from sonolube.models.surfaces import (
    GaussianCorrelationSpectrum,
    HeightMap,
    autocorrelation,
    correlation_lengths,
    gaussian_surface,
    height_parameters,
    hybrid_parameters,
    spatial_parameters,
)

DX, DY = 1e-6, 2e-6
GRID_Y, GRID_X = np.meshgrid(DY * np.arange(200), DX * np.arange(400), indexing="ij")
WAVELENGTH, AMPLITUDE = 100e-6, 5e-6
WAVE = 2 * math.pi / WAVELENGTH
SHORT_WAVE = 5 * WAVE  # twenty to the map, so that its edges matter little


def surface_of(height: np.ndarray) -> HeightMap:
    return HeightMap(height=height, spacing_x=DX, spacing_y=DY)


def sine(direction: float = 0.0, *, waves: float = WAVE) -> HeightMap:
    along = GRID_X * math.cos(direction) + GRID_Y * math.sin(direction)
    return surface_of(AMPLITUDE * np.sin(waves * along + 0.3))


def holed(surface: HeightMap, *, share: float, seed: int = 0) -> HeightMap:
    height = surface.height.copy()
    height[np.random.default_rng(seed).random(height.shape) < share] = np.nan
    return surface.with_height(height)


RANDOM = gaussian_surface(
    rms_height=1e-6,
    spectrum=GaussianCorrelationSpectrum(correlation_length=10e-6),
    shape=(400, 500),
    spacing_x=DX,
    spacing_y=DY,
    seed=1,
)


def test_a_sine_has_the_height_parameters_of_a_sine() -> None:
    found = height_parameters(sine())
    assert found.arithmetic_mean_height == approx(2 * AMPLITUDE / math.pi, rel=1e-3)
    assert found.rms_height == approx(AMPLITUDE / math.sqrt(2), rel=1e-9)
    assert found.total_height == approx(2 * AMPLITUDE, rel=1e-3)
    assert found.maximum_peak_height + found.maximum_pit_depth == approx(found.total_height)
    assert found.skewness == approx(0, abs=1e-9)
    assert found.kurtosis == approx(1.5, rel=1e-9)


def test_the_parameters_of_four_pixels_are_those_computed_by_hand() -> None:
    found = height_parameters(surface_of(np.array([[0.0, 0.0], [0.0, 4.0]])))
    assert (found.arithmetic_mean_height, found.rms_height) == approx((1.5, math.sqrt(3)))
    assert (found.maximum_peak_height, found.maximum_pit_depth) == approx((3, 1))
    assert (found.skewness, found.kurtosis) == approx((6 / 3**1.5, 21 / 9))


def test_exponentially_distributed_heights_have_skewness_two_and_kurtosis_nine() -> None:
    quantiles = -np.log1p(-(np.arange(1_000_000) + 0.5) / 1_000_000)
    found = height_parameters(surface_of(quantiles.reshape(1000, 1000)))
    assert (found.skewness, found.kurtosis) == approx((2, 9), rel=5e-3)


@mark.parametrize("direction", [0.0, 0.4, math.pi / 2])
def test_a_sine_has_the_gradient_of_a_sine_in_any_direction(direction: float) -> None:
    steepness = AMPLITUDE * WAVE
    found = hybrid_parameters(sine(direction))
    whole_waves = direction in (0.0, math.pi / 2)
    assert found.rms_gradient == approx(steepness / math.sqrt(2), rel=4e-3 if whole_waves else 0.02)
    area = quad(lambda u: math.sqrt(1 + (steepness * math.cos(u)) ** 2), 0, math.pi)[0] / math.pi
    assert found.developed_interfacial_area_ratio == approx(area - 1, rel=8e-3 if whole_waves else 0.04)


def test_a_tilted_plane_has_its_gradient_at_any_spacing() -> None:
    found = hybrid_parameters(surface_of(0.3 * GRID_X - 0.4 * GRID_Y))
    assert found.rms_gradient == approx(0.5)
    assert found.developed_interfacial_area_ratio == approx(math.sqrt(1.25) - 1)


def test_the_developed_area_of_a_nearly_flat_surface_has_no_cancellation() -> None:
    assert hybrid_parameters(surface_of(1e-7 * GRID_X)).developed_interfacial_area_ratio == approx(
        5e-15, rel=1e-6, abs=0
    )


def test_a_missing_pixel_removes_only_the_cells_around_it() -> None:
    plane = 0.3 * GRID_X
    plane[50, 60] = plane[0, 0] = plane[-1, 7] = np.nan
    assert hybrid_parameters(surface_of(plane)).rms_gradient == approx(0.3)


@given(factor=st.floats(0.01, 100), shift=st.floats(-1e-3, 1e-3))
@examples(20)
def test_parameters_scale_with_the_heights_and_do_not_depend_on_the_datum(factor: float, shift: float) -> None:
    small = RANDOM.height[:40, :40]
    one, other = height_parameters(surface_of(small)), height_parameters(surface_of(factor * small + shift))
    for name in ("arithmetic_mean_height", "rms_height", "maximum_peak_height", "maximum_pit_depth", "total_height"):
        assert getattr(other, name) == approx(factor * getattr(one, name), rel=1e-6)
    assert (other.skewness, other.kurtosis) == approx((one.skewness, one.kurtosis), rel=1e-4, abs=1e-4)


@given(share=st.floats(0.0, 0.9), seed=st.integers(0, 1000))
@examples(20)
def test_pixels_missing_at_random_change_the_deviation_within_its_sampling_error(share: float, seed: int) -> None:
    white = surface_of(np.random.default_rng(seed).standard_normal((200, 200)))
    sparse = holed(white, share=share, seed=seed + 1)
    left = np.count_nonzero(sparse.measured)
    error = math.sqrt((1 / left - 1 / white.height.size) / 2)  # of a sample's share, for Gaussian heights
    ratio = height_parameters(sparse).rms_height / height_parameters(white).rms_height
    assert ratio == approx(1, abs=5 * error + 1e-12)


def test_rotating_the_map_rotates_the_lay() -> None:
    found, turned = (spatial_parameters(sine(way, waves=SHORT_WAVE)) for way in (0.4, 0.4 + math.pi / 2))
    assert found.texture_direction == approx(0.4 + math.pi / 2, abs=0.02)
    assert turned.texture_direction == approx(0.4, abs=0.02)


def test_the_autocorrelation_of_a_wave_decays_to_a_fifth_where_the_cosine_does() -> None:
    found = spatial_parameters(sine(waves=SHORT_WAVE))
    assert found.autocorrelation_length == approx(math.acos(0.2) / SHORT_WAVE, rel=0.01)
    assert not found.decays_in_all_directions
    assert found.texture_aspect_ratio < 0.1
    assert found.texture_direction == approx(math.pi / 2, abs=0.02)


def test_the_autocorrelation_of_an_egg_box_is_a_product_of_cosines() -> None:
    box = surface_of(AMPLITUDE * np.cos(SHORT_WAVE * GRID_X) * np.cos(SHORT_WAVE * GRID_Y))
    found = autocorrelation(box)
    expected = np.outer(np.cos(SHORT_WAVE * found.lag_y), np.cos(SHORT_WAVE * found.lag_x))
    assert found.normalized == approx(expected, abs=0.06)  # parts of waves at the edges do not average out
    near = np.abs(found.lag_x) < 10e-6
    centre = found.lag_y.size // 2
    assert found.normalized[centre, near] == approx(expected[centre, near], abs=0.01)


def test_a_random_surface_has_the_autocorrelation_of_its_spectrum() -> None:
    found = correlation_lengths(
        autocorrelation(RANDOM), directions=[0.0, 0.7, math.pi / 2, 2.0], threshold=math.exp(-1)
    )
    assert found.decayed.all()
    assert found.distance == approx(10e-6, rel=0.05)
    isotropic = spatial_parameters(RANDOM)
    assert isotropic.autocorrelation_length == approx(10e-6 * math.sqrt(math.log(5)), rel=0.06)
    assert 0.85 < isotropic.texture_aspect_ratio <= 1
    assert isotropic.decays_in_all_directions


def direct_autocovariance(surface: HeightMap, down: int, right: int) -> float:
    z = surface.height - np.nanmean(surface.height)
    rows, columns = z.shape
    one = z[max(-down, 0) : rows - max(down, 0), max(-right, 0) : columns - max(right, 0)]
    other = z[max(down, 0) : rows + min(down, 0), max(right, 0) : columns + min(right, 0)]
    return float(np.nanmean(one * other))


@mark.parametrize("share", [0.0, 0.3])
@mark.parametrize(("down", "right"), [(0, 0), (3, 5), (-7, 2), (20, -24), (20, 24)])
def test_the_autocovariance_is_the_mean_product_of_measured_pairs(share: float, down: int, right: int) -> None:
    surface = holed(surface_of(RANDOM.height[:40, :49]), share=share)
    found = autocorrelation(surface)
    assert found.lag_y[20 + down] == approx(down * DY)
    assert found.lag_x[24 + right] == approx(right * DX)
    assert found.autocovariance[20 + down, 24 + right] == approx(
        direct_autocovariance(surface, down, right), rel=1e-6, abs=0
    )


@mark.parametrize("parameters", [height_parameters, hybrid_parameters, spatial_parameters])
@mark.parametrize("shape", [(1, 1), (1, 9), (9, 1)])
def test_a_line_has_no_areal_parameters(parameters: object, shape: tuple[int, int]) -> None:
    with raises(InvalidInput, match=f"at least 2 rows and 2 columns, got {shape[0]} x {shape[1]}"):
        parameters(surface_of(np.arange(shape[0] * shape[1], dtype=float).reshape(shape)))  # type: ignore[operator]


def test_a_flat_map_is_refused() -> None:
    with raises(InvalidInput, match=r"height must vary, got 0\.1 m in every measured pixel"):
        height_parameters(surface_of(np.full((3, 4), 0.1)))
    with raises(InvalidInput, match="flat map has no autocorrelation"):
        spatial_parameters(surface_of(np.full((3, 4), 0.1)))


def test_a_map_of_isolated_pixels_has_no_gradient() -> None:
    islands = np.full((6, 6), np.nan)
    islands[::2, ::2] = np.arange(9.0).reshape(3, 3)
    with raises(InvalidInput, match="four neighbouring measured pixels; with 75% of the pixels missing"):
        hybrid_parameters(surface_of(islands))


def test_a_row_without_a_measured_pixel_is_left_out() -> None:
    height = RANDOM.height.copy()
    height[17] = np.nan
    rest = height_parameters(surface_of(np.delete(height, 17, axis=0)))
    assert height_parameters(surface_of(height)).rms_height == approx(rest.rms_height)


def test_a_map_smaller_than_its_texture_is_refused() -> None:
    bowl = surface_of(np.full((6, 6), 0.0))
    tilted = bowl.with_height(np.sign(np.arange(6.0) - 2.5)[:, None] * np.array([[1, -1, 1, -1, 1, -1.0]]))
    assert spatial_parameters(tilted).autocorrelation_length < DX
