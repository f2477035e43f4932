"""Averages over alternatives of a regression, against normal densities computed whole."""

import numpy as np
from pytest import approx
from scipy.stats import multivariate_normal, norm

from sonolube.measurement.statistics.autocorrelation import noise_of_regression, whitened
from sonolube.measurement.statistics.averaged_regression import Alternative, _half_width, averaged_regression

RNG = np.random.default_rng(8)
COUNT = 400
LEVEL = np.ones((COUNT, 1))
SLOPE = np.linspace(-1, 1, COUNT)[:, np.newaxis]
NOTHING = Alternative(columns=(), deviations=(), probability=0.5)
SLOPES = Alternative(columns=(0,), deviations=(0.3,), probability=0.5)


def test_the_weight_of_an_alternative_is_its_normal_density() -> None:
    series = 2 + 0.11 * SLOPE[:, 0] + RNG.standard_normal(COUNT)
    found = averaged_regression(
        [series],
        [LEVEL],
        offered=[SLOPE],
        alternatives=[NOTHING, SLOPES],
        beside=[()],
        functions=np.array([[1.0, 0.0], [0.0, 1.0]]),
    )
    phi, theta = noise_of_regression([series], [LEVEL])
    y, x, z = whitened(np.column_stack([series, LEVEL, SLOPE]), phi, theta).T
    variance = float(np.var(y - x * (x @ y) / (x @ x), ddof=1))
    spread = variance * np.eye(COUNT) + 1e6 * np.outer(x, x)  # nearly a flat prior of the level
    logs = [
        float(multivariate_normal.logpdf(y, np.zeros(COUNT), spread + own * np.outer(z, z))) for own in (0.0, 0.3**2)
    ]
    share = 1 / (1 + np.exp(logs[0] - logs[1]))
    assert found.probabilities == approx([1 - share, share], abs=0.02)
    slope = share * (z @ y) / (z @ z + variance / 0.3**2)  # the columns are nearly orthogonal
    assert found.means == approx([float(series.mean()), slope], abs=5e-3)
    within = share * variance / (z @ z + variance / 0.3**2)
    between = share * (1 - share) * (slope / share) ** 2
    moments = np.sqrt(within + between)
    assert 0.5 * moments < np.sqrt(found.covariance[1, 1]) < 1.3 * moments


def test_a_clear_slope_is_taken_and_hardly_drawn_to_its_prior() -> None:
    series = 5 + 2 * SLOPE[:, 0] + 0.1 * RNG.standard_normal(COUNT)
    found = averaged_regression(
        [series[:150], series[150:]],
        [LEVEL[:150], LEVEL[150:]],
        offered=[SLOPE[:150], SLOPE[150:]],
        alternatives=[NOTHING, SLOPES],
        beside=[(), (0,)],
        functions=np.eye(2),
    )
    assert found.probabilities == approx([0, 1], abs=1e-6)
    assert found.means == approx([5, 2], abs=0.03)
    assert np.sqrt(np.diag(found.covariance)) == approx([0.005, 0.00866], rel=0.2)  # 0.1 / 20, times sqrt(3)


def test_an_offered_column_without_size_changes_nothing() -> None:
    series = RNG.standard_normal(COUNT)
    found = averaged_regression(
        [series],
        [LEVEL],
        offered=[np.zeros((COUNT, 1))],
        alternatives=[NOTHING, SLOPES],
        beside=[(), (0,)],
        functions=np.array([[1.0, 0.0]]),
    )
    assert found.probabilities == approx([0.5, 0.5], abs=1e-3)
    assert found.means == approx([series.mean()], abs=0.02)


def test_half_the_interval_of_a_mixture_by_its_distribution() -> None:
    assert _half_width(np.array([1.0]), np.zeros(1), np.array([2.0])) == approx(2 * 1.959964, rel=1e-5)
    # 2 % far off on either side: 1 % of the rest is to be beyond, which is 0.01 / 0.96 of a normal density
    half = _half_width(np.array([0.02, 0.96, 0.02]), np.array([-50.0, 0.0, 50.0]), np.ones(3))
    assert half == approx(norm.isf(0.01 / 0.96 / 2), rel=1e-5)
