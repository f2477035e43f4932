"""Free blocks, bars and tubes by Rayleigh and Ritz: polynomials in place of meshes, an independent check of both.

A prism of constant section along z, symmetric about the planes x = 0 and y = 0, of a medium that is symmetric about
all three: displacements are sums of polynomials, orthonormal over the section, times Legendre polynomials along z.
Symmetry splits them into eight classes that do not mix.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import eigh

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.fem.solver.medium import Medium


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class CrossSection:
    """Points and weights that integrate over the section of a prism.

    Parameters
    ----------
    points : ndarray, shape (q, 2)
        Coordinates across, in m.
    weights : ndarray, shape (q,)
        Areas, in m2.
    """

    points: Floats
    weights: Floats


def rectangular_section(*, length: float, width: float, order: int) -> CrossSection:
    """Return a rectangular section, exact for products of polynomials of that order.

    Parameters
    ----------
    length, width : float
        Extent along x and y. [m]
    order : int
        Highest total degree of the polynomials.

    Returns
    -------
    Section
    """
    require_positive(length=length, width=width)
    x, w = legendre.leggauss(order + 1)
    points = np.stack(np.meshgrid(length / 2 * x, width / 2 * x, indexing="ij"), axis=-1).reshape(-1, 2)
    return CrossSection(points=points, weights=np.outer(length / 2 * w, width / 2 * w).ravel())


def annular_section(*, outer_radius: float, inner_radius: float, order: int) -> CrossSection:
    """Return the section of a round bar or tube, exact for products of polynomials of that order.

    Parameters
    ----------
    outer_radius, inner_radius : float
        Radii, the inner zero for a bar. [m]
    order : int
        Highest total degree of the polynomials.

    Returns
    -------
    Section
    """
    require_positive(outer_radius=outer_radius)
    require_non_negative(inner_radius=inner_radius)
    if inner_radius >= outer_radius:
        raise InvalidInput(f"the wall has no thickness: inner_radius {inner_radius!r} m, outer {outer_radius!r} m")
    x, w = legendre.leggauss(order + 2)
    half = (outer_radius - inner_radius) / 2
    r = inner_radius + half * (1 + x)
    turns = 4 * order + 4
    angle = 2 * np.pi * (np.arange(turns) + 0.5) / turns
    points = np.stack([np.outer(r, np.cos(angle)), np.outer(r, np.sin(angle))], axis=-1).reshape(-1, 2)
    return CrossSection(points=points, weights=np.repeat(w * half * r * 2 * np.pi / turns, turns))


def ritz_frequencies(section: CrossSection, *, length: float, medium: Medium, order: int) -> Floats:
    """Return the natural frequencies of a free prism in Hz, in order, its six rigid motions left out.

    Parameters
    ----------
    section : Section
        Made for this order.
    length : float
        Extent of the prism along z. [m]
    medium : Medium
        Its piezoelectric constants are not used; its planes of symmetry must be those of the axes.
    order : int
        Highest total degree of the polynomials.

    Returns
    -------
    ndarray
        Each lies above the true one and falls to it as the order grows; about the lower tenth is good.

    Raises
    ------
    InvalidInput
        If the medium or section has not the symmetry, or the order is below 2.

    References
    ----------
    .. [1] W. M. Visscher, A. Migliori, T. M. Bell and R. A. Reinert, J. Acoust. Soc. Am. 90, 2154 (1991).
       doi:10.1121/1.401643
    """
    require_positive(length=length)
    if order < 2:
        raise InvalidInput(f"order must be at least 2, got {order}")
    c = medium.elastic_stiffness
    if np.abs(c[3:, :3]).max() + np.abs(c[3:, 3:] - np.diag(c[3:, 3:].diagonal())).max() > 1e-9 * np.abs(c).max():
        raise InvalidInput("the medium is not symmetric about the planes of the axes; compute it with finite elements")
    centre = section.weights @ section.points / section.weights.sum()
    if np.abs(centre).max() > 1e-9 * np.abs(section.points).max():
        raise InvalidInput("the section is not symmetric about x = 0 and y = 0")
    across, degrees = _across(section, order)
    along = _along(length, order)
    pairs = [(a, k) for a in range(len(degrees)) for k in range(order + 1 - sum(degrees[a]))]
    parity = {pair: (degrees[pair[0]][0] % 2, degrees[pair[0]][1] % 2, pair[1] % 2) for pair in pairs}
    squares = [_class_squares(across, along, pairs, parity, odd, c) for odd in product((0, 1), repeat=3)]
    omega = np.sqrt(np.maximum(np.sort(np.concatenate(squares)) / medium.density, 0.0))
    return np.asarray(omega[6:] / (2 * np.pi))


Pairs = list[tuple[int, int]]
_SHEAR = {(1, 2): 3, (0, 2): 4, (0, 1): 5}  # rows of Voigt's notation


def _class_squares(
    across: Floats,
    along: Floats,
    pairs: Pairs,
    parity: Mapping[tuple[int, int], tuple[int, ...]],
    odd: tuple[int, ...],
    c: Floats,
) -> Floats:
    """Return omega^2 times density of one class of symmetry; component i is odd along j where odd_j + [i = j] is."""
    own = [[p for p in pairs if all(parity[p][j] == (odd[j] + (i == j)) % 2 for j in range(3))] for i in range(3)]
    section = [np.array([a for a, _ in component], dtype=int) for component in own]
    axial = [np.array([k for _, k in component], dtype=int) for component in own]

    def product_of(i: int, k: int, j: int, m: int) -> Floats:
        """Return int d_k u_i d_m u_j over the functions of components i and j."""
        return np.asarray(
            across[k, m][np.ix_(section[i], section[j])] * along[int(k == 2), int(m == 2)][np.ix_(axial[i], axial[j])]
        )

    blocks = [[np.empty((0, 0))] * 3 for _ in range(3)]
    for i, j in product(range(3), repeat=2):
        if i == j:
            shears = [k for k in range(3) if k != i]
            blocks[i][i] = c[i, i] * product_of(i, i, i, i) + sum(
                c[v, v] * product_of(i, k, i, k) for k in shears for v in [_SHEAR[min(i, k), max(i, k)]]
            )
        else:
            v = _SHEAR[min(i, j), max(i, j)]
            blocks[i][j] = c[i, j] * product_of(i, i, j, j) + c[v, v] * product_of(i, j, j, i)
    return np.asarray(eigh(np.block(blocks), eigvals_only=True))


def _across(section: CrossSection, order: int) -> tuple[Floats, list[tuple[int, int]]]:
    """Return integrals over the section of products of derivatives, [k, m, a, b], and the degrees of the functions.

    Derivative 2 is that along z: across the section it leaves the function as it is.
    """
    scale = np.abs(section.points).max(axis=0)
    degrees = [(i, j) for total in range(order + 1) for i in range(total, -1, -1) for j in [total - i]]
    tables = [_legendre(section.points[:, axis] / scale[axis], order) for axis in range(2)]
    f = np.array([tables[0][0][i] * tables[1][0][j] for i, j in degrees])
    fx = np.array([tables[0][1][i] * tables[1][0][j] for i, j in degrees]) / scale[0]
    fy = np.array([tables[0][0][i] * tables[1][1][j] for i, j in degrees]) / scale[1]
    root = np.sqrt(section.weights)
    triangle = np.linalg.qr((f * root).T).R
    orthonormal = np.linalg.solve(triangle.T, np.array([fx, fy, f]) * root)
    return np.einsum("kaq,mbq->kmab", orthonormal, orthonormal, optimize=True), degrees


def _along(length: float, order: int) -> Floats:
    """Return integrals along z of products of orthonormal Legendre polynomials or their derivatives, [d, e, k, m]."""
    x, w = legendre.leggauss(order + 1)
    values, slopes = _legendre(x, order)
    norm = np.sqrt((2 * np.arange(order + 1) + 1) / length)[:, np.newaxis]
    both = np.array([values * norm, slopes * norm * 2 / length]) * np.sqrt(w * length / 2)
    return np.asarray(np.einsum("dkq,emq->dekm", both, both))


def _legendre(x: Floats, order: int) -> tuple[Floats, Floats]:
    unit = np.eye(order + 1)
    values: Floats = legendre.legvander(x, order).T.astype(np.float64)
    return values, np.array([legendre.legval(x, legendre.legder(row)) for row in unit])
