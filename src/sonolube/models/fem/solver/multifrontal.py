"""Multifrontal factorisation of symmetric quasi-definite mesh matrices in nested-dissection order.

The mesh is bisected recursively down to a few elements. The nodes that two halves share, their separator, are
eliminated after both, which keeps the dense frontal matrices small. The work is that of dense BLAS operations on these,
half of what it is without symmetry.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg.blas import dsyrk, dtrsm
from scipy.linalg.lapack import dpotrf

from sonolube.checks import Floats, Integers
from sonolube.errors import InvalidInput
from sonolube.models.fem.mesh.mesh import Mesh

_LEAF = 320  # nodes of the elements, counted in each, of a part that is not bisected further
_MIN_PART = 0.2  # of the elements, in the smaller part of a bisection
_IMBALANCE_PENALTY = 1.0  # relative increase of the weight of a separator from equal parts to an empty one
_NORMALS = np.array(
    [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1]]
)
"""Normals of the planes that are tried as cuts."""

_SINGULAR_PIVOT = 1e-14  # of the diagonal before elimination, up to which a pivot counts as rounding of zero
_Update = tuple[Integers, Floats]


def nested_dissection(mesh: Mesh) -> list[Integers]:
    """Nested-dissection ordering of the nodes of a mesh: separators of recursive geometric bisection.

    Groups of nodes in the order of elimination: the interiors of the smallest parts, and each separator after both
    parts that it separates. Every node is in one group.

    Elements are sorted by their centroids along nine directions. Of all cuts that leave a fifth of them or more on
    either side the one with the fewest nodes in its separator is taken, with a penalty on unequal parts.

    Source: A. George, SIAM J. Numer. Anal. 10, 345 (1973). doi:10.1137/0710032
    """
    normals = _NORMALS / np.linalg.norm(_NORMALS, axis=1, keepdims=True)
    projections = mesh.nodes[mesh.elements[:, :4]].mean(axis=1) @ normals.T
    free, groups = np.ones(mesh.node_count, dtype=bool), []
    parts = [np.arange(len(mesh.elements))]
    while parts:  # the part bisected last is eliminated first
        part = parts.pop()
        nodes = mesh.elements[part]
        own, local = np.unique(nodes, return_inverse=True)
        local = local.reshape(nodes.shape)
        is_free = free[own]  # not in a separator yet
        if nodes.size <= _LEAF:
            group = own[is_free]
        else:
            order, count, separator = _bisection(projections[part], local, is_free)
            group = own[separator]
            parts += [part[order[:count]], part[order[count:]]]
        if group.size:
            groups.append(group)
            free[group] = False
    return groups[::-1]


def _bisection(projections: Floats, local: Integers, free: NDArray[np.bool_]) -> tuple[Integers, int, Integers]:
    """Elements sorted along the best direction, the number of them before the cut, and the nodes of its separator."""
    elements, size = len(local), len(free)
    directions, bins = np.arange(projections.shape[1])[:, np.newaxis], elements + 1
    orders = np.argsort(projections.T, axis=1, kind="stable")
    nodes = (local[orders].reshape(len(directions), -1) + size * directions).ravel()
    ranks = np.tile(np.repeat(np.arange(elements), local.shape[1]), len(directions))
    first, last = (np.empty((len(directions), size), dtype=np.int64) for _ in range(2))
    last.ravel()[nodes] = ranks  # the last of repeated assignments holds
    first.ravel()[nodes[::-1]] = ranks[::-1]
    begun, ended = (
        np.bincount((ends[:, free] + 1 + bins * directions).ravel(), minlength=bins * directions.size)
        for ends in (first, last)
    )
    cut = np.cumsum((begun - ended).reshape(len(directions), -1), axis=1)  # nodes on both sides, by elements before
    least = max(1, round(_MIN_PART * elements))
    counts = np.arange(least, elements - least + 1)
    weights = cut[:, counts] * (1 + _IMBALANCE_PENALTY * (2 * counts / elements - 1) ** 2)
    best, position = np.unravel_index(np.argmin(weights), weights.shape)
    count = int(counts[position])
    return orders[best], count, np.flatnonzero(free & (first[best] < count) & (last[best] >= count))


def multifrontal_factor(
    matrix: sparse.csc_array, *, groups: Sequence[Integers], signs: Sequence[int]
) -> Callable[[Floats], Floats]:
    r"""Multifrontal factorisation of a real symmetric matrix in a given elimination order, without pivoting.

    `matrix` has shape (n, n).

    Solver, from the right-hand side, shape (n,) or (n, k), to the solution.

    With the permutation Q of the elimination order and the diagonal matrix S of the signs

    .. math:: Q A Q^\mathsf{T} = L S L^\mathsf{T}

    Each group has one dense frontal matrix, of its own unknowns and the later ones that they are coupled to. The
    Cholesky factor of its first block is a diagonal block of L, and the Schur complement of the second block is added
    to the fronts of later groups.

    See Also
    --------
    nested_dissection : The groups for the nodes of a mesh.
    sonolube.models.fem.solver.system.superlu_factor : General-purpose factorisation, of complex matrices too.

    References
    ----------
    .. [1] I. S. Duff and J. K. Reid, ACM Trans. Math. Softw. 9, 302 (1983). doi:10.1145/356044.356047
    .. [2] J. W. H. Liu, SIAM Rev. 34, 82 (1992). doi:10.1137/1034004
    """
    order = np.concatenate(groups)
    position = np.empty_like(order)
    position[order] = np.arange(len(order))
    fronts = list(_fronts(matrix, groups, signs, position))

    def solve(right: Floats) -> Floats:
        columns = np.ascontiguousarray(right[order].reshape(len(order), -1))
        for front in fronts:
            own = columns[front.own]
            dtrsm(1.0, front.diagonal, own.T, side=1, lower=1, trans_a=1, overwrite_b=1)
            columns[front.later] -= front.below @ own
        for front in reversed(fronts):
            own = columns[front.own]
            own *= front.sign
            own -= front.below.T @ columns[front.later]
            dtrsm(1.0, front.diagonal, own.T, side=1, lower=1, overwrite_b=1)
        return columns[position].reshape(right.shape)

    return solve


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class _Front:
    """Columns of the factor L for the unknowns eliminated together.

    Parameters
    ----------
    own : slice
        Positions of the unknowns in the order of elimination.
    later : ndarray of int, shape (b,)
        Sorted positions of the later unknowns that they are coupled to.
    sign : int
        Sign of the pivots.
    diagonal : ndarray, shape (a, a)
        Triangular diagonal block of L; entries above the diagonal are undefined.
    below : ndarray, shape (b, a)
        Rows of L of the later unknowns.
    """

    own: slice
    later: Integers
    sign: int
    diagonal: Floats
    below: Floats


def _fronts(
    matrix: sparse.csc_array, groups: Sequence[Integers], signs: Sequence[int], position: Integers
) -> Iterator[_Front]:
    """Fronts of a matrix in the order of elimination, in which each unknown has the given position."""
    index = _FrontIndex(len(position))
    updates: list[list[_Update]] = [[] for _ in groups]  # Schur complements to be added to each front
    group_at = np.repeat(np.arange(len(groups)), [len(group) for group in groups])
    stop = 0
    for group, sign, received in zip(groups, signs, updates, strict=True):
        size = len(group)
        start, stop = stop, stop + size
        entries, column = _column_entries(matrix, group)
        rows, values = position[matrix.indices[entries]], matrix.data[entries]
        later = index.union(rows, *(positions for positions, _ in received), after=stop)
        local = index.local(start, stop, later)
        shapes = (size, size), (len(later), size), (len(later), len(later))  # of the lower half of a frontal matrix
        diagonal, below, schur = (np.zeros(shape, order="F") for shape in shapes)
        is_own, is_later = (rows >= start) & (rows < stop), rows >= stop
        diagonal[local[rows[is_own]], column[is_own]] = values[is_own]
        below[local[rows[is_later]] - size, column[is_later]] = values[is_later]
        for positions, update in received:
            count, numbers = int(np.searchsorted(positions, stop)), local[positions]
            # Transposed, so that the order in memory is that of the indices; one axis at a time, which is faster.
            spread = np.zeros((len(positions), size + len(later)))
            spread[:, numbers] = update.T
            diagonal.T[numbers[:count]] += spread[:count, :size]
            below.T[numbers[:count]] += spread[:count, size:]
            schur.T[numbers[count:] - size] += spread[count:, size:]
        received.clear()
        diagonal = _cholesky(diagonal, sign)
        if later.size:
            below = dtrsm(sign, diagonal, below, side=1, lower=1, trans_a=1, overwrite_b=1)
            schur = dsyrk(-sign, below, beta=1.0, c=schur, lower=1, overwrite_c=1)
            updates[group_at[later[0]]].append((later, schur))
        yield _Front(own=slice(start, stop), later=later, sign=sign, diagonal=diagonal, below=below)


def _column_entries(matrix: sparse.csc_array, columns: Integers) -> tuple[Integers, Integers]:
    """Places in the arrays of a sparse matrix of the entries of some columns, and the number of the column of each."""
    first = matrix.indptr[columns]
    counts = matrix.indptr[columns + 1] - first
    number = np.repeat(np.arange(len(columns)), counts)
    return np.arange(len(number)) + (first - np.cumsum(counts) + counts)[number], number


class _FrontIndex:
    """Positions of the unknowns of a front and their local numbers, in work arrays shared by all fronts."""

    def __init__(self, size: int) -> None:
        self.marks = np.zeros(size, dtype=bool)
        self.numbers = np.empty(size, dtype=np.int64)

    def union(self, *positions: Integers, after: int) -> Integers:
        """Sorted union of positions, of those from `after` on."""
        for some in positions:
            self.marks[some] = True
        found = after + np.flatnonzero(self.marks[after:])
        for some in positions:
            self.marks[some] = False
        return found

    def local(self, start: int, stop: int, later: Integers) -> Integers:
        """Table from positions to the numbers in a front: first its own unknowns, then the later ones."""
        self.numbers[start:stop] = np.arange(stop - start)
        self.numbers[later] = stop - start + np.arange(len(later))
        return self.numbers


def _cholesky(block: Floats, sign: int) -> Floats:
    """Cholesky factor of a definite block times its sign, from its lower half; singular blocks are refused."""
    before = np.abs(block.diagonal())
    factor, failed = dpotrf(sign * block, lower=1, clean=0, overwrite_a=1)
    if failed or np.any(factor.diagonal() ** 2 <= _SINGULAR_PIVOT * before):
        raise InvalidInput(
            "the equations have no unique solution; hold the body, or ground an electrode of every piezoelectric part"
        )
    return np.asarray(factor)
