"""Polynomial approximations of Bessel functions against scipy."""

import numpy as np
from pytest import approx
from scipy.special import ive

from sonolube.models.dynamics.harmonic_balance.initial_guess import bessel_ratio, log_bessel_i0


def test_bessel_functions_agree_with_scipy() -> None:
    x = np.r_[0.0, np.geomspace(1e-3, 600.0, 2000)]
    assert bessel_ratio(x) == approx(ive(1, x) / ive(0, x), rel=2e-6)
    assert log_bessel_i0(x) == approx(x + np.log(ive(0, x)), abs=2e-6)
