"""Friction reduction between two parts of a recording: its uncertainty against Monte Carlo, and refusals."""

import numpy as np
from pytest import approx, raises
from scipy.signal import lfilter

from sonolube.errors import InvalidInput
from sonolube.measurement.friction.reduction import estimate_friction_reduction

RNG = np.random.default_rng(7)


def autoregressive(phi: float, shape: tuple[int, ...], rng: np.random.Generator = RNG) -> np.ndarray:
    start = rng.normal(size=(*shape[:-1], 1)) / np.sqrt(1 - phi**2)
    noise = rng.normal(size=shape)
    return np.asarray(lfilter([1], [1, -phi], noise, zi=phi * start)[0])


def test_the_uncertainty_of_a_reduction_agrees_with_monte_carlo() -> None:
    off = 1.0 + 0.2 * autoregressive(0.7, (600, 2000))
    on = 0.4 + 0.1 * autoregressive(0.7, (600, 2000))
    estimates = [
        estimate_friction_reduction(intrinsic_friction_force=a, reduced_friction_force=b)
        for a, b in zip(off, on, strict=True)
    ]
    scatter = np.std([estimate.friction_reduction for estimate in estimates], ddof=1)
    assert np.mean([e.friction_reduction_uncertainty for e in estimates]) == approx(scatter, rel=0.1)
    assert np.mean([e.friction_reduction for e in estimates]) == approx(0.6, abs=0.002)


def test_a_reduction_relative_to_zero_friction_is_refused() -> None:
    with raises(InvalidInput, match=r"intrinsic_friction_force must be positive, got 0\.0 N"):
        estimate_friction_reduction(intrinsic_friction_force=np.zeros(10), reduced_friction_force=np.ones(10))
