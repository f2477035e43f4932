"""Summit statistics of surfaces with known summits, and of Gaussian surfaces against Nayak's theory."""

import math

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, mark, raises
from tests.models.surfaces.spectral_moments import moments

from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.surfaces import (
    GaussianCorrelationSpectrum,
    HeightMap,
    HeightSpectrum,
    Roughness,
    SelfAffineSpectrum,
    SpectralMoments,
    combined_roughness,
    contact_roughness,
    gaussian_surface,
    nayak_summit_statistics,
    sampling_dependence,
    spectral_moments,
    summit_statistics,
)

SINGLE_SCALE = GaussianCorrelationSpectrum(correlation_length=12e-6)
SELF_AFFINE = SelfAffineSpectrum(
    hurst_exponent=0.8, longest_wavelength=256e-6, rolloff_wavelength=128e-6, shortest_wavelength=16e-6
)


def random_surface(spectrum: HeightSpectrum, *, seed: int, rms_height: float = 1e-6) -> HeightMap:
    return gaussian_surface(
        rms_height=rms_height, spectrum=spectrum, shape=(800, 1024), spacing_x=1e-6, spacing_y=1.25e-6, seed=seed
    )


@mark.parametrize("spectrum", [SINGLE_SCALE, SELF_AFFINE], ids=["single scale", "self-affine"])
def test_summits_of_a_gaussian_surface_are_those_of_nayak(spectrum: HeightSpectrum) -> None:
    theory = nayak_summit_statistics(moments(spectrum, rms_height=1e-6))
    counted = [summit_statistics(random_surface(spectrum, seed=seed)) for seed in range(3)]
    number = sum(one.summit_density for one in counted) * 800 * 1.25e-6 * 1024e-6
    scatter = 3 / math.sqrt(number)
    sampling = 0.03  # finite differences at 16 points to the shortest wave

    def found(name: str) -> float:
        return float(np.mean([getattr(one, name) for one in counted]))

    assert number > 1500
    assert found("summit_density") == approx(theory.summit_density, rel=scatter + sampling)
    assert found("mean_summit_curvature") == approx(theory.mean_summit_curvature, rel=scatter + sampling)
    assert found("summit_height_deviation") == approx(theory.summit_height_deviation, rel=scatter + 0.02)
    assert found("mean_summit_height") == approx(theory.mean_summit_height, rel=2 * scatter)


@mark.parametrize("spectrum", [SINGLE_SCALE, SELF_AFFINE], ids=["single scale", "self-affine"])
def test_finite_differences_give_the_moments_of_the_spectrum(spectrum: HeightSpectrum) -> None:
    found, exact = spectral_moments(random_surface(spectrum, seed=9)), moments(spectrum, rms_height=1e-6)
    assert found.height_variance == approx(exact.height_variance, rel=0.12, abs=0)
    assert found.slope_variance == approx(exact.slope_variance, rel=0.04)
    assert found.curvature_variance == approx(exact.curvature_variance, rel=0.04)


def test_the_moments_of_a_map_with_missing_pixels_are_means_over_the_measured_neighbours() -> None:
    rng = np.random.default_rng(4)
    z = 1e-6 * rng.standard_normal((40, 50))
    z[rng.random(z.shape) < 0.1] = np.nan
    dx, dy = 1e-6, 1.25e-6
    found = spectral_moments(HeightMap(height=z, spacing_x=dx, spacing_y=dy))
    for order, value in ((1, found.slope_variance), (2, found.curvature_variance)):
        along_x, along_y = np.diff(z, order, axis=1) / dx**order, np.diff(z, order, axis=0) / dy**order
        assert value == approx((np.nanmean(along_x**2) + np.nanmean(along_y**2)) / 2)


def test_waves_of_one_length_in_all_directions_have_the_least_bandwidth() -> None:
    # m2 = m0 q^2/2 and m4 = m0 3 q^4/8 of a ring in the plane of wavenumbers
    moments = SpectralMoments(height_variance=2.0, slope_variance=9.0, curvature_variance=2.0 * 81 * 3 / 8)
    assert moments.bandwidth == approx(1.5)


def test_theory_gives_the_roughness_parameter_of_mccool() -> None:
    # beta^2 = 3.717e-4/(1 - (sigma_s/Rq)^2) ties density, radius and deviation for every bandwidth
    for curvature in (2.0, 10.0, 1000.0):
        moments = SpectralMoments(height_variance=1.0, slope_variance=1.0, curvature_variance=curvature)
        found = nayak_summit_statistics(moments)
        beta = found.summit_density * found.summit_radius
        assert beta**2 == approx(3.717e-4 / (1 - found.summit_height_deviation**2), rel=1e-3)


def test_spherical_caps_have_their_number_and_radius() -> None:
    radius, pitch, count = 40e-6, 20, 8
    offset = (np.arange(pitch * count) % pitch - pitch // 2) * 1e-6
    height = np.sqrt(radius**2 - offset[:, None] ** 2 - offset[None, :] ** 2)
    heights = np.kron(np.random.default_rng(0).permutation(count**2).reshape(count, count), np.ones((pitch, pitch)))
    found = summit_statistics(HeightMap(height=height + 1e-7 * heights, spacing_x=1e-6, spacing_y=1e-6))
    area = (pitch * count - 2) ** 2 * 1e-12
    assert found.summit_density * area == approx(count**2)
    assert found.summit_radius == approx(radius, rel=1e-3)
    assert found.summit_height_deviation == approx(1e-7 * math.sqrt((count**4 - 1) / 12))


@mark.parametrize("missing", [False, True])
def test_an_egg_box_has_one_summit_per_cell_and_its_curvature(missing: bool) -> None:
    x, y = 0.5e-6 * np.arange(800), 1e-6 * np.arange(400)
    wave = 2 * math.pi / 20e-6
    height = 1e-6 * (np.cos(wave * (x[None, :] - 5e-6)) + np.cos(wave * (y[:, None] - 5e-6)))
    if missing:
        height[100:200, 200:480] = np.nan
    found = summit_statistics(HeightMap(height=height, spacing_x=0.5e-6, spacing_y=1e-6))
    assert found.summit_density == approx(1 / 20e-6**2, rel=0.015)
    assert found.mean_summit_curvature == approx(1e-6 * wave**2, rel=0.006)
    assert found.summit_height_deviation == approx(0, abs=1e-15)


def test_coarser_sampling_finds_fewer_and_blunter_summits() -> None:
    surface = random_surface(SELF_AFFINE, seed=2)
    found = sampling_dependence(surface, sampling_interval=[1.2e-6, 3e-6, 6e-6, 12e-6])
    assert found.sampling_interval == approx(np.sqrt(1e-6 * 1.25e-6 * np.array([1, 3 * 2, 6 * 5, 12 * 10])))
    assert np.all(np.diff(found.summit_density) < 0)
    assert np.all(np.diff(found.summit_radius) > 0)
    exact = nayak_summit_statistics(moments(SELF_AFFINE, rms_height=1e-6))
    assert found.summit_density[0] == approx(exact.summit_density, rel=0.1)


def test_both_methods_give_the_same_contact_roughness() -> None:
    surface = random_surface(SINGLE_SCALE, seed=4)
    counted, inferred = contact_roughness(surface), contact_roughness(surface, method="moments")
    assert counted.rms_height == approx(inferred.rms_height, rel=0.05)
    assert counted.summit_radius == approx(inferred.summit_radius, rel=0.05)
    assert counted.summit_density == approx(inferred.summit_density, rel=0.05)


def test_the_combined_roughness_is_that_of_the_sum_of_the_heights() -> None:
    first = random_surface(SINGLE_SCALE, seed=1)
    second = random_surface(SELF_AFFINE, seed=2, rms_height=3e-6)
    gap = first.with_height(first.height + second.height)
    both = combined_roughness(contact_roughness(first, method="moments"), contact_roughness(second, method="moments"))
    added = contact_roughness(gap, method="moments")
    assert both.rms_height == approx(added.rms_height, rel=0.01)
    assert both.summit_radius == approx(added.summit_radius, rel=0.01)
    assert both.summit_density == approx(added.summit_density, rel=0.01)


sizes = st.floats(1e-8, 1e-4)


@given(rms=sizes, radius=sizes, density=st.floats(1e8, 1e13))
def test_two_equal_surfaces_have_the_roughness_of_one_times_root_two(rms: float, radius: float, density: float) -> None:
    one = Roughness(rms_height=rms, summit_radius=radius, summit_density=density)
    both = combined_roughness(one, one)
    assert both.rms_height == approx(math.sqrt(2) * rms, rel=1e-6)
    assert both.summit_radius == approx(radius / math.sqrt(2))
    assert both.summit_density == approx(density)


def test_a_surface_without_summits_is_refused() -> None:
    plane = HeightMap(height=np.add.outer(np.arange(5.0), np.arange(6.0)), spacing_x=1e-6, spacing_y=1e-6)
    with raises(InvalidInput, match="require two summits, got 0 among 12 pixels"):
        summit_statistics(plane)
    with raises(InvalidInput, match="curvature_variance must be positive"):
        spectral_moments(plane)
    for shape in ((1, 1), (1, 9)):
        line = HeightMap(height=np.arange(math.prod(shape), dtype=float).reshape(shape), spacing_x=1e-6, spacing_y=1e-6)
        with raises(InvalidInput, match="two summits"):
            summit_statistics(line)
        with raises(InvalidInput, match="three neighbouring measured pixels"):
            spectral_moments(line)


def test_a_bandwidth_that_no_profile_has_is_refused() -> None:
    with raises(InvalidInput, match=r"bandwidth must exceed 1, got 0\.5"):
        nayak_summit_statistics(SpectralMoments(height_variance=1.0, slope_variance=2.0, curvature_variance=2.0))


def test_an_unknown_method_and_a_finer_interval_than_the_map_are_refused() -> None:
    surface = random_surface(SINGLE_SCALE, seed=4)
    with raises(UnknownName, match="unknown method 'summit'; did you mean summits"):
        contact_roughness(surface, method="summit")
    with raises(InvalidInput, match="sampling_interval must be at least the spacing"):
        sampling_dependence(surface, sampling_interval=1e-7)
