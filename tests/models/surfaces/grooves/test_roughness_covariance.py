"""Covariance of roughness: the closed form of a spectrum, and its estimate from maps drawn from a known covariance."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pytest import approx

from sonolube.checks import Floats
from sonolube.models.surfaces import HeightMap
from sonolube.models.surfaces.grooves.roughness_covariance import (
    Cells,
    RoughnessCovariance,
    coverage_factor,
    roughness_covariance,
)

SHAPE, PIXEL, SQ, LENGTH = (80, 110), 10e-6, 0.5e-6, 40e-6


def exponential(rows: ArrayLike, columns: ArrayLike) -> Floats:
    """Covariance of heights whose spectrum has the Hurst exponent 1/2: SQ^2 exp(-r/LENGTH)."""
    return np.asarray(SQ**2 * np.exp(-PIXEL * np.hypot(np.asarray(rows, float), np.asarray(columns, float)) / LENGTH))


def drawn_map(seed: int, *, stretch: float = 1.0) -> Floats:
    """Heights with that covariance by circulant embedding, correlated farther along x by a factor."""
    sizes = [6 * n for n in SHAPE]
    rows, columns = (np.minimum(np.arange(n), n - np.arange(n)).astype(float) for n in sizes)
    power = np.maximum(np.fft.fft2(exponential(rows[:, None], columns[None] / stretch)).real, 0.0)
    noise = np.random.default_rng(seed).standard_normal((2, *sizes))
    field = np.fft.ifft2(np.sqrt(power) * np.fft.fft2(noise[0])).real
    return np.asarray(field[: SHAPE[0], : SHAPE[1]])


def fitted(height: Floats, counted: NDArray[np.bool_] | None = None) -> RoughnessCovariance:
    cells = Cells(HeightMap(height=height, spacing_x=PIXEL, spacing_y=PIXEL))
    return roughness_covariance(cells, height, np.ones(SHAPE, dtype=np.bool_) if counted is None else counted)


def of_mean(covariance: RoughnessCovariance, weights: Floats) -> float:
    return covariance.variance(weights)[0]


def middle_band(rows: int) -> Floats:
    """Weights of the mean over a band of rows in the middle."""
    weights = np.zeros(SHAPE)
    weights[(SHAPE[0] - rows) // 2 : (SHAPE[0] + rows) // 2] = 1.0
    return np.asarray(weights / weights.sum())


def exact_variance(weights: Floats) -> float:
    """Variance of a weighted sum by the sum over all pairs of the closed form, through lags."""
    size = [2 * n for n in SHAPE]
    pairs = np.fft.irfft2(np.abs(np.fft.rfft2(weights, size)) ** 2, size)
    rows, columns = (np.fft.fftfreq(n, 1 / n) for n in size)
    return float(np.sum(pairs * exponential(rows[:, None], columns[None])))


def test_a_hurst_exponent_of_one_half_has_the_exponential_covariance() -> None:
    theta = np.array([math.log(SQ**2), math.log(LENGTH), 0.0, 0.0, math.log(0.5), -80.0])
    known = RoughnessCovariance(
        parameters=theta, parameter_covariance=np.eye(6), cell_sides=(PIXEL, PIXEL), pixels_per_cell=1.0
    )
    single = np.zeros(SHAPE)
    single[40, 55] = 1.0
    spread = known.smeared(single)
    lags = np.arange(2, 25)
    assert spread[40, 55 + lags] == approx(exponential(0 * lags, lags), rel=0.02, abs=0.002 * SQ**2)
    assert spread[40 - lags, 55] == approx(exponential(0 * lags, lags), rel=0.02, abs=0.002 * SQ**2)
    weights = middle_band(20)
    assert of_mean(known, weights) == approx(exact_variance(weights), rel=0.01)


def test_the_variance_of_a_mean_is_estimated_from_one_map_within_its_uncertainty() -> None:
    weights = middle_band(20)
    exact, scores, logarithms = exact_variance(weights), [], []
    for seed in range(20):
        found = fitted(drawn_map(seed))
        variance, derivative = found.variance(weights)
        logarithms.append(math.log(variance / exact))
        scores.append(logarithms[-1] / found.uncertainty(variance, derivative))
    assert np.mean(logarithms) == approx(0.0, abs=0.1)
    assert 0.5 < math.sqrt(np.mean(np.square(scores))) < 1.6


def test_a_masked_band_changes_the_spectrum_little() -> None:
    # over 60 maps the mean logarithm is -0.12 +- 0.04 with the band masked, -0.05 +- 0.03 without
    counted = np.ones(SHAPE, dtype=np.bool_)
    counted[25:55] = False
    weights, exact = middle_band(20), exact_variance(middle_band(20))
    logarithms = [math.log(of_mean(fitted(drawn_map(seed), counted), weights) / exact) for seed in range(20)]
    assert np.mean(logarithms) == approx(0.0, abs=0.25)


def test_lay_makes_means_along_it_more_uncertain_than_across() -> None:
    along = np.zeros(SHAPE)
    along[40, 30:80] = 1 / 50
    across = np.zeros(SHAPE)
    across[15:65, 55] = 1 / 50
    found = fitted(drawn_map(3, stretch=4.0))
    ratio = of_mean(found, along) / of_mean(found, across)
    lags = np.arange(-49, 50)
    pairs = 50 - np.abs(lags)
    exact = np.sum(pairs * exponential(0 * lags, lags / 4)) / np.sum(pairs * exponential(lags, 0 * lags))
    assert ratio == approx(exact, rel=0.25)


def test_the_factor_of_a_known_variance_is_gaussian_and_that_of_eight_degrees_of_freedom_is_students() -> None:
    assert coverage_factor(0.0) == approx(1.960, abs=1e-3)
    assert coverage_factor(0.5) == approx(2.306, abs=1e-3)  # freedom 2/0.5^2, from printed tables
