"""Covariance of a roughness with a given spectrum against its closed form in space."""

import math

import numpy as np
from pytest import approx, mark
from scipy.special import gamma, kv

from sonolube.models.surfaces.grooves.roughness_covariance import RoughnessCovariance

VARIANCE, CELL = 4e-12, 10e-6


def matern(distance: float, hurst: float) -> float:
    """Return the correlation of a roughness with the spectrum (1 + k^2)^(-1 - H) in a plane."""
    if distance == 0:
        return 1.0
    return float(2 ** (1 - hurst) / gamma(hurst) * distance**hurst * kv(hurst, distance))


@mark.parametrize(("hurst", "ratio"), [(1.0, 1.0), (2.5, 1.0), (2.5, 2.0)])
def test_the_covariance_of_two_cells_is_that_of_matern(hurst: float, ratio: float) -> None:
    # roll-off lengths l sqrt(ratio) along x and l/sqrt(ratio) along y
    length = 8.0
    covariance = RoughnessCovariance(
        parameters=np.array([math.log(VARIANCE), math.log(length * CELL), math.log(ratio), 0, math.log(hurst), -90.0]),
        parameter_covariance=np.zeros((6, 6)),
        cell_sides=(CELL, CELL),
        pixels_per_cell=1.0,
    )
    one = np.zeros((180, 180))
    one[0, 0] = 1.0
    found = covariance.smeared(one)
    for lag in (0, 5, 12):
        along_x, along_y = lag / length / math.sqrt(ratio), lag / length * math.sqrt(ratio)
        assert found[0, lag] / VARIANCE == approx(matern(along_x, hurst), abs=0.02)
        assert found[lag, 0] / VARIANCE == approx(matern(along_y, hurst), abs=0.02)
