"""Tables by Chebyshev polynomials against the polynomials by hand."""

import numpy as np
import pytest
from pytest import approx

from sonolube.design.fmu.chebyshev import ChebyshevTable, fitted, grown, nodes, of_one_variable, trimmed, unconverged


def test_nodes_are_the_zeros_of_the_polynomial_between_both_ends() -> None:
    # of T_3 = 4 x^3 - 3 x: 0 and +-sqrt(3)/2, about 5 with 2 to either side
    assert nodes((3.0, 7.0), 3) == approx([5 + np.sqrt(3), 5.0, 5 - np.sqrt(3)])
    assert nodes((4.0, 4.0), 1) == approx([4.0])


def test_a_table_is_the_sum_of_products_of_polynomials() -> None:
    # u = (x - 5)/2 and v = y/10: 2 + 3 v - u - 0.5 u v^2 with T_2(v) = 2 v^2 - 1
    coefficients = np.array([[2.0, 3.0, 0.0], [-1.25, 0.0, -0.25]])
    table = ChebyshevTable(ends=((3.0, 7.0), (-10.0, 10.0)), coefficients=coefficients)
    u, v = 0.4, -0.7
    expected = 2 + 3 * v - u - 0.5 * u * v**2
    assert float(table(5 + 2 * u, 10 * v)) == approx(expected)
    both = table(np.array([[5.8], [5.0]]), np.array([-7.0, 0.0]))
    assert both == approx(np.array([[expected, 2 - 0.4], [2 + 3 * v, 2.0]]))


def test_beyond_its_ends_a_table_keeps_the_value_of_the_nearer_end() -> None:
    table = ChebyshevTable(ends=((0.0, 2.0),), coefficients=np.array([1.0, 3.0]))
    assert table(np.array([-5.0, 0.0, 1.0, 2.0, 9.0])) == approx([-2.0, -2.0, 1.0, 4.0, 4.0])
    constant = ChebyshevTable(ends=((3.0, 3.0),), coefficients=np.array([7.0]))
    assert float(constant(100.0)) == 7.0


def test_a_fit_passes_through_a_polynomial_of_its_order_in_every_variable() -> None:
    ends = ((1.0, 3.0), (-2.0, 0.0), (5.0, 5.0))
    x, y = nodes(ends[0], 4), nodes(ends[1], 3)
    values = (x[:, None] ** 3 - 2 * x[:, None] * y**2 + 5)[..., None]
    table = fitted(values, ends)
    assert table.coefficients.shape == (4, 3, 1)
    assert float(table(1.7, -0.3, 5.0)) == approx(1.7**3 - 2 * 1.7 * 0.09 + 5)


def test_small_last_coefficients_are_left_out_by_their_part_of_the_greatest() -> None:
    coefficients = np.array([[10.0, 1e-3, 2e-5], [0.5, 0.0, 0.0], [-1e-4, 0.0, 1e-9]])
    table = ChebyshevTable(ends=((0.0, 1.0), (0.0, 1.0)), coefficients=coefficients)
    assert trimmed(table, 1e-3).coefficients == approx(coefficients[:2, :1])
    assert trimmed(table, 1e-5).coefficients == approx(coefficients[:, :2])  # 1e-4 of 10 stay, 2e-5 go
    assert trimmed(table, 1e-7).coefficients == approx(coefficients)


def test_convergence_is_judged_by_the_last_two_coefficients_of_each_variable() -> None:
    coefficients = np.array([[8.0, 0.4, 0.0], [0.0, 0.0, -0.2], [4.0, 0.0, 0.0]])
    table = ChebyshevTable(ends=((0.0, 1.0), (0.0, 1.0)), coefficients=coefficients)
    assert unconverged(table) == approx([4 / 8, 0.4 / 8])
    flat = ChebyshevTable(ends=((0.0, 1.0), (2.0, 2.0)), coefficients=coefficients)
    assert unconverged(flat) == approx([0.5, 0.0])
    assert unconverged(ChebyshevTable(ends=((0.0, 1.0),), coefficients=np.zeros(4))) == approx([0.0])
    even = ChebyshevTable(ends=((0.0, 1.0),), coefficients=np.array([8.0, 0.0, 4.0, 0.0, -1.0]))
    assert unconverged(even) == approx([1 / 8])


def test_too_few_nodes_become_half_as_many_again() -> None:
    assert [grown(order) for order in (8, 13, 20)] == [13, 20, 31]


@pytest.mark.parametrize("tolerance", [1e-3, 1e-9])
def test_a_function_of_one_variable_takes_the_nodes_that_it_needs(tolerance: float) -> None:
    seen: list[int] = []

    def function(x: np.ndarray) -> np.ndarray:
        seen.append(x.size)
        return np.asarray(np.exp(3 * x))

    table = of_one_variable(function, (0.0, 2.0), tolerance)
    x = np.linspace(0, 2, 50)
    assert table(x) == approx(np.exp(3 * x), abs=tolerance * np.exp(6))
    assert seen[0] == 8
    assert seen == sorted(seen)


def test_a_function_that_never_converges_ends_at_the_most_nodes_and_a_constant_one_at_one() -> None:
    seen: list[int] = []

    def step(x: np.ndarray) -> np.ndarray:
        seen.append(x.size)
        return np.where(x > 0.3, 1.0, 0.0)

    of_one_variable(step, (0.0, 1.0), 1e-9)
    assert seen == [8, 13, 20, 31, 47]  # half as many again, up to 64
    assert of_one_variable(lambda x: 5 * x, (2.0, 2.0), 1e-9).coefficients == approx([10.0])
