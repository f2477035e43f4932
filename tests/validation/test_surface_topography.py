"""SurfaceTopography 1.27 (MIT), the program: roughness, slopes and spectra of one surface by both."""

import numpy as np
import pytest
from pytest import approx

from sonolube.models.surfaces import (
    HeightMap,
    SelfAffineSpectrum,
    areal_spectrum,
    gaussian_surface,
    height_parameters,
    hybrid_parameters,
    profile_spectrum,
    radial_spectrum,
    spectral_moments,
)

SurfaceTopography = pytest.importorskip("SurfaceTopography")
pytestmark = pytest.mark.filterwarnings("ignore")

SURFACE = gaussian_surface(
    rms_height=1e-6,
    spectrum=SelfAffineSpectrum(
        hurst_exponent=0.8, longest_wavelength=256e-6, rolloff_wavelength=128e-6, shortest_wavelength=8e-6
    ),
    shape=(150, 400),
    spacing_x=1e-6,
    spacing_y=2e-6,
    seed=1,
)


def theirs(surface: HeightMap, *, periodic: bool) -> object:
    return SurfaceTopography.Topography(surface.height.T.copy(), (400e-6, 300e-6), periodic=periodic)


def test_both_find_the_same_deviation_and_gradient() -> None:
    topography = theirs(SURFACE, periodic=False)
    assert height_parameters(SURFACE).rms_height == approx(topography.rms_height_from_area())  # type: ignore[attr-defined]
    assert hybrid_parameters(SURFACE).rms_gradient == approx(topography.rms_gradient(), rel=2e-3)  # type: ignore[attr-defined]


def test_both_find_the_same_slope_and_curvature_along_rows() -> None:
    row_wise = HeightMap(height=SURFACE.height, spacing_x=1e-6, spacing_y=1e6)  # columns then add nothing to the mean
    moments = spectral_moments(row_wise)
    topography = theirs(SURFACE, periodic=True)
    slope = topography.rms_slope_from_profile()  # type: ignore[attr-defined]
    curvature = topography.rms_curvature_from_profile()  # type: ignore[attr-defined]
    assert 2 * moments.slope_variance == approx(slope**2, rel=0.01)  # theirs also crosses the edge
    assert 2 * moments.curvature_variance == approx(curvature**2, rel=0.02)


def test_both_find_the_same_spectrum_of_profiles() -> None:
    wavenumber, density = theirs(SURFACE, periodic=True).power_spectrum_from_profile(  # type: ignore[attr-defined]
        reliable=False, resampling_method=None
    )
    found = profile_spectrum(SURFACE, window="none")
    assert found.wavenumber[1:200] == approx(wavenumber[1:200] / (2 * np.pi))
    assert found.profile_spectral_density[1:200] == approx(density[1:200], rel=1e-6)


def test_both_find_the_same_spectrum_averaged_over_direction() -> None:
    wavenumber, density = theirs(SURFACE, periodic=True).power_spectrum_from_area(  # type: ignore[attr-defined]
        reliable=False, collocation="linear", nb_points=60
    )
    found = radial_spectrum(areal_spectrum(SURFACE, window="none"))
    inside = (found.wavenumber > 2e4) & (found.wavenumber < 0.11e6)
    there = np.interp(2 * np.pi * found.wavenumber[inside], np.asarray(wavenumber), np.asarray(density))
    assert np.median(found.areal_spectral_density[inside] / there) == approx(1, abs=0.05)
