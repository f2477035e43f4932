"""Random surfaces: deviation, spectrum and moments as specified, and grids that cannot represent them."""

import math
from itertools import pairwise

import numpy as np
from pytest import approx, mark, raises
from scipy.integrate import quad
from tests.models.surfaces.spectral_moments import moments
from tests.same import same

from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.surfaces import (
    GaussianCorrelationSpectrum,
    HeightMap,
    HeightSpectrum,
    SelfAffineSpectrum,
    gaussian_surface,
)

SINGLE_SCALE = GaussianCorrelationSpectrum(correlation_length=8e-6)
SELF_AFFINE = SelfAffineSpectrum(
    hurst_exponent=0.6, longest_wavelength=200e-6, rolloff_wavelength=50e-6, shortest_wavelength=5e-6
)


def made(spectrum: HeightSpectrum = SINGLE_SCALE, *, seed: int = 0, spacing_x: float = 1e-6) -> HeightMap:
    return gaussian_surface(
        rms_height=3e-6, spectrum=spectrum, shape=(255, 400), spacing_x=spacing_x, spacing_y=2e-6, seed=seed
    )


@mark.parametrize("spectrum", [SINGLE_SCALE, SELF_AFFINE], ids=["single scale", "self-affine"])
def test_heights_have_the_specified_deviation_and_zero_mean(spectrum: HeightSpectrum) -> None:
    variances = [np.var(made(spectrum, seed=seed).height) for seed in range(12)]
    assert math.sqrt(np.mean(variances)) == approx(3e-6, rel=0.05)
    assert np.mean(made(spectrum).height) == approx(0, abs=1e-18)


def test_the_seed_determines_the_surface() -> None:
    same(made(seed=1).height, made(seed=1).height)
    assert not np.array_equal(made(seed=1).height, made(seed=2).height)


@mark.parametrize(
    "spectrum",
    [
        SINGLE_SCALE,
        SELF_AFFINE,
        SelfAffineSpectrum(
            hurst_exponent=1.0, longest_wavelength=90e-6, rolloff_wavelength=90e-6, shortest_wavelength=9e-6
        ),
    ],
)
def test_moments_are_integrals_of_the_spectral_density(spectrum: HeightSpectrum) -> None:
    def moment(power: int) -> float:
        def integrand(k: float) -> float:
            return float(spectrum.relative_spectral_density(wavenumber=np.array(k * 1e6)) * k ** (power + 1))

        return math.fsum(quad(integrand, a, b, epsabs=0)[0] for a, b in pieces)

    ends = [1e-12, 0.005, 0.02, 0.2] if spectrum is SELF_AFFINE else [1e-12, 1e-6 / 9e-5, 1 / 9, 0.5]
    pieces = list(pairwise(ends))
    found = moments(spectrum, rms_height=3e-6)
    q = 2 * math.pi * 1e6
    assert found.height_variance == approx(9e-12, rel=1e-6, abs=0)
    assert found.slope_variance == approx(9e-12 * q**2 / 2 * moment(2) / moment(0), rel=1e-6)
    assert found.curvature_variance == approx(9e-12 * q**4 * 3 / 8 * moment(4) / moment(0), rel=1e-6)


def test_a_grid_too_coarse_or_too_small_is_refused() -> None:
    with raises(OutsideRange, match="at most half the shortest wavelength, 8e-06 m; got 5e-06 m and 2e-06 m"):
        made(spacing_x=5e-6)
    with raises(OutsideRange, match=r"must be at least .* long in both directions"):
        made(GaussianCorrelationSpectrum(correlation_length=1e-3))


def test_wavelengths_out_of_order_are_refused() -> None:
    with raises(InvalidInput, match="must be in descending order"):
        SelfAffineSpectrum(
            hurst_exponent=0.5, longest_wavelength=1e-6, rolloff_wavelength=2e-6, shortest_wavelength=1e-7
        )
