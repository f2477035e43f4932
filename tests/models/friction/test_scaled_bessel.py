"""Scaled Bessel function without special functions, against scipy."""

import numpy as np
from pytest import approx
from scipy.special import i0e

from sonolube.execution.compilation import few_points
from sonolube.models.friction.scaled_bessel import scaled_bessel_i0


def test_few_points_have_the_values_of_scipy_at_all_sizes() -> None:
    x = np.append(0.0, np.geomspace(1e-6, 1e8, 300))
    with few_points():
        assert scaled_bessel_i0(x) == approx(i0e(x), rel=1e-13)
