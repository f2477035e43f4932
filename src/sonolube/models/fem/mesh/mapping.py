"""Isoparametric mapping of elements: Jacobian matrices at quadrature points, their determinants and inverses.

The two indices of the matrices come first, so that each component is an array over elements and points. That is many
times as fast as the routines of numpy for stacks of small matrices.
"""

import numpy as np

from sonolube.checks import Floats

_CYCLES = ((1, 2), (2, 0), (0, 1))  # the two indices that follow each index


def jacobian_matrices(nodes: Floats, gradient: Floats) -> Floats:
    r"""Jacobian matrices :math:`\partial x_k/\partial \xi_d` of elements at points.

    `nodes` has shape (e, a, 3). `gradient` has shape (a, d, q). Shape (d, 3, e, q).
    """
    by_direction = np.ascontiguousarray(np.moveaxis(nodes, -1, 0)) @ gradient.reshape(len(gradient), -1)
    return by_direction.reshape(3, len(nodes), *gradient.shape[1:]).transpose(2, 0, 1, 3)


def determinant(matrix: Floats) -> Floats:
    """Determinants of matrices of three rows and columns.

    `matrix` has shape (3, 3, ...). Shape (...).
    """
    return np.asarray(sum(matrix[0, k] * _cofactor(matrix, 0, k) for k in range(3)))


def adjugate(matrix: Floats) -> Floats:
    """Adjugates of matrices of three rows and columns: their inverses times their determinants.

    `matrix` has shape (3, 3, ...).
    """
    return np.array([[_cofactor(matrix, column, row) for column in range(3)] for row in range(3)])


def _cofactor(matrix: Floats, row: int, column: int) -> Floats:
    """Cofactors of one entry."""
    (a, b), (c, d) = _CYCLES[row], _CYCLES[column]
    return np.asarray(matrix[a, c] * matrix[b, d] - matrix[a, d] * matrix[b, c])
