"""Factors of symmetric matrices of meshes, front by front.

A mesh is halved, and its halves again, down to a few elements. Nodes that two halves share are eliminated after both,
so that what is dense stays small and the work is that of dense blocks, half as much as without symmetry.
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
from sonolube.fem.solver.mesh import Mesh

_LEAF = 5  # elements that are not halved any more
_LEAST_HALF = 0.2  # share of the elements in the smaller half
_UNEVEN = 1.0  # share by which a cut into nothing and all counts as larger than one into halves
_CUTS = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1]])
"""Directions across which a mesh is cut."""

_SINGULAR = 1e-14  # share of a pivot that elimination leaves where rounding is all there is
_Change = tuple[Integers, Floats]


def nested_dissection(mesh: Mesh) -> list[Integers]:
    """Return the nodes of a mesh in groups, each to be eliminated after those it parts.

    Parameters
    ----------
    mesh : Mesh

    Returns
    -------
    list of ndarray of int
        Every node is in one group.

    References
    ----------
    .. [1] A. George, SIAM J. Numer. Anal. 10, 345 (1973). doi:10.1137/0710032
    """
    along = mesh.nodes[mesh.elements[:, :4]].mean(axis=1) @ (_CUTS / np.linalg.norm(_CUTS, axis=1, keepdims=True)).T
    free, groups = np.ones(mesh.node_count, dtype=bool), []
    parts = [np.arange(len(mesh.elements))]
    while parts:  # what is cut last is eliminated first
        part = parts.pop()
        nodes = mesh.elements[part]
        known, local = np.unique(nodes, return_inverse=True)
        local = local.reshape(nodes.shape)
        open_ = free[known]
        if len(part) <= _LEAF:
            group = known[open_]
        else:
            order, count, shared = _cut(along[part], local, open_)
            group = known[shared]
            parts += [part[order[:count]], part[order[count:]]]
        if group.size:
            groups.append(group)
            free[group] = False
    return groups[::-1]


def _cut(along: Floats, local: Integers, free: NDArray[np.bool_]) -> tuple[Integers, int, Integers]:
    """Return elements in the order of the best direction, how many come before the cut, and the free nodes on it."""
    cuts = [_cut_across(direction, local, free) for direction in along.T]
    _, order, count, shared = min(cuts, key=lambda cut: cut[0])
    return order, count, shared


def _cut_across(direction: Floats, local: Integers, free: NDArray[np.bool_]) -> tuple[float, Integers, int, Integers]:
    """Return the weight of the best cut across one direction, and of it what `_cut` returns."""
    elements = len(local)
    order = np.argsort(direction, kind="stable")
    nodes, place = local[order].ravel(), np.repeat(np.arange(elements), local.shape[1])
    first, last = np.empty(len(free), dtype=np.int64), np.empty(len(free), dtype=np.int64)
    last[nodes] = place  # of what is written twice the latter stays
    first[nodes[::-1]] = place[::-1]
    begun, ended = (np.bincount(ends[free] + 1, minlength=elements + 1) for ends in (first, last))
    least = max(1, round(_LEAST_HALF * elements))
    counts = np.arange(least, elements - least + 1)
    weights = np.cumsum(begun - ended)[counts] * (1 + _UNEVEN * (2 * counts / elements - 1) ** 2)
    best = int(np.argmin(weights))
    count = int(counts[best])
    return float(weights[best]), order, count, np.flatnonzero(free & (first < count) & (last >= count))


def multifrontal_factor(
    matrix: sparse.csc_array, *, groups: Sequence[Integers], signs: Sequence[int]
) -> Callable[[Floats], Floats]:
    """Return what solves with a real symmetric matrix whose groups of unknowns can be eliminated without pivoting.

    Parameters
    ----------
    matrix : sparse matrix, shape (n, n)
    groups : sequence of ndarray of int
        Unknowns in the order of elimination, each in one group.
    signs : sequence of int
        1 where what is left of the matrix is positive definite in a group once those before are eliminated, -1 where
        it is negative definite.

    Returns
    -------
    callable
        From the right side, shape (n,) or (n, k), to the solution.

    Raises
    ------
    InvalidInput
        If the matrix is singular.

    References
    ----------
    .. [1] J. W. H. Liu, SIAM Rev. 34, 82 (1992). doi:10.1137/1034004
    """
    order = np.concatenate(groups)
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    fronts = list(_fronts(matrix[:, order], place, [len(group) for group in groups], signs))

    def solve(right: Floats) -> Floats:
        columns = np.ascontiguousarray(right[order].reshape(len(order), -1))
        for front in fronts:
            own = columns[front.own]
            dtrsm(1.0, front.head, own.T, side=1, lower=1, trans_a=1, overwrite_b=1)
            columns[front.beyond] -= front.tail @ own
        for front in reversed(fronts):
            own = columns[front.own]
            own *= front.sign
            own -= front.tail.T @ columns[front.beyond]
            dtrsm(1.0, front.head, own.T, side=1, lower=1, overwrite_b=1)
        return columns[place].reshape(right.shape)

    return solve


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class _Front:
    """Unknowns eliminated together, and their columns of the factor L of L S L^T, where S holds signs.

    Parameters
    ----------
    own : slice
        Places of the unknowns in the order of elimination.
    beyond : ndarray of int, shape (b,)
        Places of the later unknowns that they touch.
    sign : int
    head : ndarray, shape (a, a)
        Rows of their own; what stands above the diagonal has no meaning.
    tail : ndarray, shape (b, a)
        Rows of the later ones.
    """

    own: slice
    beyond: Integers
    sign: int
    head: Floats
    tail: Floats


def _fronts(columns: sparse.csc_array, place: Integers, sizes: Sequence[int], signs: Sequence[int]) -> Iterator[_Front]:
    """Yield the fronts of columns already in the order of elimination, whose rows have their `place` in it."""
    later = _Later(len(place))
    changes: list[list[_Change]] = [[] for _ in sizes]  # of each group by those eliminated before
    group_at = np.repeat(np.arange(len(sizes)), sizes)
    stop = 0
    for size, sign, onto in zip(sizes, signs, changes, strict=True):
        start, stop = stop, stop + size
        entries = slice(columns.indptr[start], columns.indptr[stop])
        rows, values = place[columns.indices[entries]], columns.data[entries]
        owners = np.repeat(np.arange(size), np.diff(columns.indptr[start : stop + 1]))
        beyond = later.met(rows, *(touched for touched, _ in onto), after=stop)
        within = later.numbered(start, stop, beyond)
        head, tail, rest = (np.zeros(shape, order="F") for shape in _shapes(size, len(beyond)))
        inside, outside = (rows >= start) & (rows < stop), rows >= stop
        head[within[rows[inside]], owners[inside]] = values[inside]
        tail[within[rows[outside]], owners[outside]] = values[outside]
        for touched, change in onto:
            count = int(np.searchsorted(touched, stop))
            here, there = within[touched[:count]], within[touched[count:]]
            # Transposed, so that the order in memory is that of the indices.
            head.T[here[:, np.newaxis], here] += change.T[:count, :count]
            tail.T[here[:, np.newaxis], there] += change.T[:count, count:]
            rest.T[there[:, np.newaxis], there] += change.T[count:, count:]
        onto.clear()
        head = _triangle(head, sign)
        if beyond.size:
            tail = dtrsm(sign, head, tail, side=1, lower=1, trans_a=1, overwrite_b=1)
            rest = dsyrk(-sign, tail, beta=1.0, c=rest, lower=1, overwrite_c=1)
            changes[group_at[beyond[0]]].append((beyond, rest))
        yield _Front(own=slice(start, stop), beyond=beyond, sign=sign, head=head, tail=tail)


class _Later:
    """Which unknowns a group touches, and where they stand among them: tables that groups use in turn."""

    def __init__(self, size: int) -> None:
        self.marks = np.zeros(size, dtype=bool)
        self.numbers = np.empty(size, dtype=np.int64)

    def met(self, *places: Integers, after: int) -> Integers:
        """Return the places from `after` on, in order, each once."""
        for some in places:
            self.marks[some] = True
        found = after + np.flatnonzero(self.marks[after:])
        for some in places:
            self.marks[some] = False
        return found

    def numbered(self, start: int, stop: int, beyond: Integers) -> Integers:
        """Return a table of where places stand: own ones from zero on, and those beyond from zero on."""
        self.numbers[start:stop] = np.arange(stop - start)
        self.numbers[beyond] = np.arange(len(beyond))
        return self.numbers


def _shapes(own: int, beyond: int) -> tuple[tuple[int, int], ...]:
    return (own, own), (beyond, own), (beyond, beyond)


def _triangle(block: Floats, sign: int) -> Floats:
    """Return the lower triangular factor of a definite block, of which the lower half is given."""
    before = np.abs(block.diagonal())
    factor, failed = dpotrf(sign * block, lower=1, clean=0, overwrite_a=1)
    if failed or np.any(factor.diagonal() ** 2 <= _SINGULAR * before):
        raise InvalidInput(
            "the equations have no unique solution; hold the body, or ground an electrode of every piezoelectric part"
        )
    return np.asarray(factor)
