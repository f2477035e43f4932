"""Power spectra: Parseval's theorem, single waves, and moments in closed form."""

import math

import numpy as np
from pytest import approx, mark, raises
from tests.models.surfaces.spectral_moments import moments, moments_of_spectrum

from sonolube.errors import InvalidInput
from sonolube.models.surfaces import (
    GaussianCorrelationSpectrum,
    HeightMap,
    SelfAffineSpectrum,
    areal_spectrum,
    gaussian_surface,
    profile_spectrum,
    radial_spectrum,
)

DX, DY = 1e-6, 2e-6
SPECTRUM = GaussianCorrelationSpectrum(correlation_length=8e-6)
RANDOM = gaussian_surface(rms_height=1e-6, spectrum=SPECTRUM, shape=(512, 1024), spacing_x=DX, spacing_y=DY, seed=7)


def cut(rows: int, columns: int) -> HeightMap:
    return HeightMap(height=RANDOM.height[:rows, :columns], spacing_x=DX, spacing_y=DY)


@mark.parametrize("shape", [(32, 40), (33, 40), (32, 41), (31, 37)])
def test_the_spectrum_integrates_to_the_variance(shape: tuple[int, int]) -> None:
    surface = cut(*shape)
    assert areal_spectrum(surface, window="none").height_variance == approx(surface.height.var(), rel=1e-9, abs=0)
    lines = surface.height - surface.height.mean(axis=1, keepdims=True)
    assert profile_spectrum(surface, window="none").height_variance == approx(lines.var(), rel=1e-9, abs=0)


def test_a_window_does_not_change_the_level_of_the_spectrum() -> None:
    assert areal_spectrum(RANDOM).height_variance == approx(RANDOM.height.var(), rel=0.1, abs=0)
    assert profile_spectrum(RANDOM, along="columns").height_variance == approx(RANDOM.height.var(), rel=0.1, abs=0)


def test_missing_pixels_do_not_change_the_level_of_the_spectrum() -> None:
    height = RANDOM.height.copy()
    height[np.random.default_rng(0).random(height.shape) < 0.2] = np.nan
    height[11] = np.nan
    sparse = RANDOM.with_height(height)
    assert areal_spectrum(sparse).height_variance == approx(areal_spectrum(RANDOM).height_variance, rel=0.02, abs=0)
    assert profile_spectrum(sparse).height_variance == approx(profile_spectrum(RANDOM).height_variance, rel=0.02, abs=0)


def test_a_wave_has_its_peak_at_its_wavenumber_at_any_spacing() -> None:
    y, x = np.meshgrid(DY * np.arange(60), DX * np.arange(100), indexing="ij")
    wave = HeightMap(height=np.cos(2 * math.pi * (0.05e6 * x - 0.1e6 * y)), spacing_x=DX, spacing_y=DY)
    found = areal_spectrum(wave, window="none")
    row, column = np.unravel_index(found.areal_spectral_density.argmax(), found.areal_spectral_density.shape)
    assert (found.wavenumber_y[row], found.wavenumber_x[column]) == approx((-0.1e6, 0.05e6))
    # half of the variance of 1/2 in each of two cells of the plane
    assert found.areal_spectral_density[row, column] == approx(0.25 * (100 * DX) * (60 * DY))
    ring = radial_spectrum(found)
    assert ring.wavenumber[ring.areal_spectral_density.argmax()] == approx(math.hypot(0.05e6, 0.1e6), rel=0.05)


def test_the_radial_spectrum_is_that_of_the_synthesis() -> None:
    found = radial_spectrum(areal_spectrum(RANDOM, window="none"))
    length = SPECTRUM.correlation_length
    expected = 1e-12 * math.pi * length**2 * np.exp(-((math.pi * length * found.wavenumber) ** 2))
    inside = (found.wavenumber > 2 / (1024 * DX)) & (found.wavenumber < 0.8 / length)
    scatter = 4 / np.sqrt(math.pi * np.arange(1, found.wavenumber.size + 1))  # about pi n independent cells to a ring
    assert np.all(np.abs(found.areal_spectral_density / expected - 1)[inside] < scatter[inside])


def test_the_spectrum_of_profiles_is_that_of_the_autocorrelation_along_them() -> None:
    length = SPECTRUM.correlation_length
    for along in ("rows", "columns"):
        found = profile_spectrum(RANDOM, along=along)
        expected = 1e-12 * math.sqrt(math.pi) * length * np.exp(-((math.pi * length * found.wavenumber) ** 2))
        inside = (found.wavenumber > 5e3) & (found.wavenumber < 6e4)
        assert found.profile_spectral_density[inside] == approx(expected[inside], rel=0.35, abs=0)


SELF_AFFINE = SelfAffineSpectrum(
    hurst_exponent=0.7, longest_wavelength=256e-6, rolloff_wavelength=64e-6, shortest_wavelength=8e-6
)


@mark.parametrize("spectrum", [SPECTRUM, SELF_AFFINE], ids=["single scale", "self-affine"])
def test_moments_of_a_generated_surface_are_the_closed_forms(
    spectrum: GaussianCorrelationSpectrum | SelfAffineSpectrum,
) -> None:
    surface = gaussian_surface(
        rms_height=2e-6, spectrum=spectrum, shape=(512, 1024), spacing_x=DX, spacing_y=DY, seed=5
    )
    found = moments_of_spectrum(areal_spectrum(surface, window="none"))
    exact = moments(spectrum, rms_height=2e-6)
    assert found.height_variance == approx(exact.height_variance, rel=0.1, abs=0)
    assert found.slope_variance == approx(exact.slope_variance, rel=0.03)
    assert found.curvature_variance == approx(exact.curvature_variance, rel=0.02)


def test_a_line_an_unknown_window_or_direction_are_refused() -> None:
    line = HeightMap(height=np.arange(9.0)[None, :], spacing_x=DX, spacing_y=DY)
    with raises(InvalidInput, match="at least 2 rows and 2 columns, got 1 x 9"):
        radial_spectrum(areal_spectrum(line))
    with raises(InvalidInput, match="window must be hann or none, got 'kaiser'"):
        areal_spectrum(RANDOM, window="kaiser")  # type: ignore[arg-type]
    with raises(InvalidInput, match="along must be rows or columns, got 'x'"):
        profile_spectrum(RANDOM, along="x")  # type: ignore[arg-type]
    with raises(InvalidInput, match="two measured pixels"):
        profile_spectrum(line, along="columns")
