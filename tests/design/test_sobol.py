"""Sobol indices and samples against functions whose indices have a closed form."""

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest import approx, raises
from scipy.special import ndtri

from sonolube.design import SobolIndices, saltelli_sample, sobol_indices, sobol_sample
from sonolube.errors import InvalidInput

ROWS = 4096


def ishigami(points: NDArray[np.float64]) -> NDArray[np.float64]:
    x = np.pi * (2 * points - 1)
    return np.asarray(np.sin(x[..., 0]) + 7 * np.sin(x[..., 1]) ** 2 + 0.1 * x[..., 2] ** 4 * np.sin(x[..., 0]))


def linear(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(ndtri(points) @ np.array([3.0, 2.0, 1.0, 0.0]) + 10)


def indices_of_ishigami(seed: int, rows: int = ROWS) -> SobolIndices:
    return sobol_indices(ishigami(saltelli_sample(3, samples=rows, seed=seed)[0]), seed=seed)


# variances of T. Ishigami and T. Homma, ISUMA 1990, with a = 7 and b = 0.1
FIRST_ORDER = np.array([0.5 * (1 + 0.1 * np.pi**4 / 5) ** 2, 49 / 8, 0.0])
INTERACTIONS = 0.01 * np.pi**8 * (1 / 18 - 1 / 50) * np.array([1, 0, 1])
VARIANCE = FIRST_ORDER.sum() + INTERACTIONS[0]


def test_the_indices_of_a_constant_outcome_are_zero_with_zero_intervals() -> None:
    found = sobol_indices(np.full((5, 64), 0.1))
    assert np.all(found.total_order_interval == 0)
    assert found.standard_deviation == 0


def test_an_outcome_that_varies_in_a_single_row_has_finite_intervals() -> None:
    outcomes = np.zeros((5, 64))
    outcomes[[0, 2, 4], 3] = 1.0  # of the second input alone; most resamples miss the row
    found = sobol_indices(outcomes)
    assert found.total_order[[0, 2]] == approx(0.0)
    assert found.total_order[1] > 0.4
    assert np.all(np.isfinite([found.first_order_interval, found.total_order_interval]))


def test_the_ishigami_function_has_its_closed_form_indices() -> None:
    found = indices_of_ishigami(0)
    assert found.first_order == approx(FIRST_ORDER / VARIANCE, abs=5e-3)
    assert found.total_order == approx((FIRST_ORDER + INTERACTIONS) / VARIANCE, abs=5e-3)
    assert found.standard_deviation == approx(np.sqrt(VARIANCE), rel=1e-3)


def test_the_coverage_of_the_bootstrap_intervals_is_at_least_nominal() -> None:
    covered = []
    for seed in range(10):
        found = indices_of_ishigami(seed, 512)
        for interval, exact in (
            (found.first_order_interval, FIRST_ORDER / VARIANCE),
            (found.total_order_interval, (FIRST_ORDER + INTERACTIONS) / VARIANCE),
        ):
            covered.append((interval[:, 0] <= exact) & (exact <= interval[:, 1]))
    assert np.mean(covered) >= 0.95


def test_in_a_linear_model_the_indices_are_proportional_to_the_squared_slopes() -> None:
    found = sobol_indices(linear(saltelli_sample(4, samples=ROWS)[0]))
    assert found.first_order == approx(np.array([9, 4, 1, 0]) / 14, abs=0.01)
    assert found.total_order == approx(np.array([9, 4, 1, 0]) / 14, abs=0.01)
    assert found.standard_deviation == approx(np.sqrt(14), rel=0.01)


def test_the_total_order_indices_of_a_product_both_contain_the_interaction() -> None:
    # X Y, means 1, variances a2 and b2: Var = a2 + b2 + a2 b2
    points, _ = saltelli_sample(2, samples=ROWS)
    x = 1 + np.array([0.5, 0.8]) * ndtri(points)
    found = sobol_indices(x[..., 0] * x[..., 1])
    a2, b2 = 0.25, 0.64
    whole = a2 + b2 + a2 * b2
    assert found.first_order == approx(np.array([a2, b2]) / whole, abs=0.01)
    assert found.total_order == approx(np.array([a2 * (1 + b2), b2 * (1 + a2)]) / whole, abs=0.01)


def test_the_indices_are_invariant_to_offset_and_scale_of_the_outcome() -> None:
    outcomes = ishigami(saltelli_sample(3, samples=256)[0])
    assert sobol_indices(1e6 - 1e-3 * outcomes).first_order == approx(sobol_indices(outcomes).first_order, abs=1e-6)


def test_the_indices_of_a_constant_outcome_are_zero() -> None:
    found = sobol_indices(np.full((5, 64), 0.35))
    assert not found.first_order.any()
    assert not found.total_order.any()
    assert found.standard_deviation == 0


def test_rows_of_the_sample_without_a_result_are_left_out() -> None:
    outcomes = linear(saltelli_sample(4, samples=ROWS)[0])
    outcomes[3, ::10] = np.nan
    found = sobol_indices(outcomes)
    assert found.rows == ROWS - len(range(0, ROWS, 10))
    assert found.first_order == approx(np.array([9, 4, 1, 0]) / 14, abs=0.05)


def test_each_matrix_a_b_takes_one_column_from_b() -> None:
    points, _ = saltelli_sample(3, samples=64)
    first, second = points[:2]
    for each in range(3):
        differs = (points[2 + each] != first).any(axis=0)
        assert differs.tolist() == [place == each for place in range(3)]
        assert np.array_equal(points[2 + each][:, each], second[:, each])


@pytest.mark.parametrize("inputs", [1, 7])
def test_every_subsequence_fills_the_cube_evenly(inputs: int) -> None:
    points, subsequence = sobol_sample(inputs, samples=1000)
    assert points.shape == (1024, inputs)
    assert 0 < points.min() < points.max() < 1
    for each in range(16):
        part = points[subsequence == each]
        assert part.mean(axis=0) == approx(np.full(inputs, 0.5), abs=0.02)
    whole = np.sort(points, axis=0)
    assert np.all(np.abs(whole - (np.arange(1024)[:, np.newaxis] + 0.5) / 1024) < 1 / 1024)  # one in each 1024th


def test_too_few_samples_inputs_or_rows_are_refused() -> None:
    with raises(InvalidInput, match=r"samples must be at least 32, got 8"):
        sobol_sample(2, samples=8)
    with raises(InvalidInput, match=r"inputs must be at least 1"):
        sobol_sample(0, samples=64)
    with raises(InvalidInput, match=r"at least 32 rows with a result, got 0"):
        sobol_indices(np.full((4, 64), np.nan))
