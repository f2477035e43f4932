"""Reference simplices: shape functions at their nodes, and quadrature of powers against exact integrals."""

import math

import numpy as np
import pytest
from pytest import approx

from sonolube.models.fem.mesh.mesh import lagrange_nodes, shape_functions, simplex_quadrature

ORDERS = (2, 3, 4, 5, 6)


@pytest.mark.parametrize("order", ORDERS)
def test_shape_functions_are_one_at_their_own_node_and_sum_to_one(order: int) -> None:
    nodes = lagrange_nodes(order, corners=4)
    values, slopes = shape_functions(order, nodes / order)
    assert values == approx(np.eye(len(nodes)), abs=1e-9)
    assert slopes.sum(axis=0) == approx(0.0, abs=1e-9)


@pytest.mark.parametrize("degree", [1, 4, 9, 12])
def test_quadrature_integrates_powers_as_dirichlets_formula(degree: int) -> None:
    # int x^a y^b z^c dV = a! b! c!/(a + b + c + 3)! over the unit tetrahedron, alike with two coordinates.
    places, weights = simplex_quadrature(degree, corners=4)
    for a, b, c in ((degree, 0, 0), (degree // 2, degree - degree // 2, 0), (degree // 3, degree // 3, degree // 3)):
        exact = math.factorial(a) * math.factorial(b) * math.factorial(c) / math.factorial(a + b + c + 3)
        assert weights @ (places[:, 1] ** a * places[:, 2] ** b * places[:, 3] ** c) == approx(exact, rel=1e-12)
    places, weights = simplex_quadrature(degree, corners=3)
    assert weights @ places[:, 1] ** degree == approx(1 / ((degree + 1) * (degree + 2)), rel=1e-12)
    assert np.all(weights > 0)
