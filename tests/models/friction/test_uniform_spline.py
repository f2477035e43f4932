"""Splines on uniform grids: polynomials, order of convergence, one point and many."""

import numpy as np
import pytest
from pytest import approx
from tests.same import same

from sonolube.models.friction.uniform_spline import bicubic_value, in_chunks, spline_coefficients, spline_values


def test_a_cubic_polynomial_is_interpolated_exactly_up_to_both_ends() -> None:
    nodes, places = np.arange(9.0), np.linspace(0, 8, 101)
    coefficients = spline_coefficients(2 - nodes + nodes**2 / 3 - nodes**3 / 50)
    assert spline_values(coefficients, places) == approx(2 - places + places**2 / 3 - places**3 / 50, abs=1e-13)


def test_a_product_of_cubic_polynomials_is_interpolated_exactly_by_arrays_and_one_by_one() -> None:
    x, y = np.arange(7.0), np.arange(11.0)
    coefficients = spline_coefficients((x**3 - 4 * x)[:, None] * (1 + y**2 / 7))
    rng = np.random.default_rng(0)
    p, q = 6 * rng.random(40), 10 * rng.random(40)
    exact = (p**3 - 4 * p) * (1 + q**2 / 7)
    assert spline_values(coefficients, p, q) == approx(exact, abs=1e-10)
    assert [bicubic_value.interpreted(coefficients, a, b) for a, b in zip(p, q, strict=True)] == approx(
        exact, abs=1e-10
    )


@pytest.mark.parametrize(("count", "error"), [(33, 2e-5), (65, 1.3e-6)])
def test_the_error_falls_with_the_fourth_power_of_the_step(count: int, error: float) -> None:
    places = np.linspace(0, count - 1, 999)
    found = spline_values(spline_coefficients(np.exp(-np.linspace(0, 4, count))), places)
    assert np.abs(found - np.exp(-places * 4 / (count - 1))).max() < error


def test_values_by_parts_keep_the_order_and_shape_of_arrays_that_broadcast() -> None:
    one, other = np.arange(300.0)[:, None], np.arange(70.0)
    same(in_chunks(lambda a, b: 100 * a + b, one, other), 100 * one + other)


@pytest.mark.parametrize("shape", [(4,), (5,), (6, 4), (97, 33)])
def test_the_coefficients_hold_the_values_and_the_end_conditions(shape: tuple[int, ...]) -> None:
    values = np.random.default_rng(5).normal(size=shape)
    found = spline_coefficients(values)
    for axis in range(len(shape)):  # their own axis at a time, in the dense system
        count = shape[axis]
        system = np.zeros((count + 2, count + 2))
        for node in range(count):
            system[node + 1, node : node + 3] = 1 / 6, 2 / 3, 1 / 6
        system[0, :5] = system[-1, -5:] = 1, -4, 6, -4, 1
        padded = np.zeros((count + 2, *np.delete(values.shape, axis)))
        padded[1:-1] = np.moveaxis(values, axis, 0)
        values = np.moveaxis(np.tensordot(np.linalg.inv(system), padded, axes=1), 0, axis)
    assert found == approx(values, rel=1e-9, abs=1e-11)
