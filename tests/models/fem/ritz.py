"""Rayleigh-Ritz method for free prisms: blocks, bars and tubes in polynomials, without a mesh.

The prism has a constant cross-section along z that is symmetric about the planes x = 0 and y = 0, and a medium that is
symmetric about all three coordinate planes. Displacements are sums of products of polynomials orthonormal over the
cross-section and Legendre polynomials along z. They fall into eight uncoupled symmetry classes.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import eigh

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.fem.solver.model import Medium


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class CrossSection:
    """Cross-section of a prism, as a quadrature rule over it.

    Parameters
    ----------
    points : ndarray, shape (q, 2)
        Quadrature points x and y, in m.
    weights : ndarray, shape (q,)
        Quadrature weights, in m2.
    """

    points: Floats
    weights: Floats


def rectangular_section(*, length: float, width: float, order: int) -> CrossSection:
    """Rectangular cross-section, with quadrature exact for products of two polynomials of an order.

    Parameters
    ----------
    length, width : float
        Extent along x and y. [m]
    order : int
        Highest total degree of the polynomials.

    Returns
    -------
    CrossSection
    """
    require_positive(length=length, width=width)
    x, w = legendre.leggauss(order + 1)
    points = np.stack(np.meshgrid(length / 2 * x, width / 2 * x, indexing="ij"), axis=-1).reshape(-1, 2)
    return CrossSection(points=points, weights=np.outer(length / 2 * w, width / 2 * w).ravel())


def annular_section(*, outer_radius: float, inner_radius: float, order: int) -> CrossSection:
    """Circular or annular cross-section, with quadrature exact for products of two polynomials of an order.

    Parameters
    ----------
    outer_radius, inner_radius : float
        Radii, the inner zero for a solid bar. [m]
    order : int
        Highest total degree of the polynomials.

    Returns
    -------
    CrossSection

    Raises
    ------
    InvalidInput
        If a radius is negative or the inner one not the smaller.
    """
    require_positive(outer_radius=outer_radius)
    require_non_negative(inner_radius=inner_radius)
    if inner_radius >= outer_radius:
        raise InvalidInput(f"the wall has no thickness: inner_radius {inner_radius!r} m, outer {outer_radius!r} m")
    x, w = legendre.leggauss(order + 2)
    half_wall = (outer_radius - inner_radius) / 2
    r = inner_radius + half_wall * (1 + x)
    angles = 4 * order + 4
    angle = 2 * np.pi * (np.arange(angles) + 0.5) / angles
    points = np.stack([np.outer(r, np.cos(angle)), np.outer(r, np.sin(angle))], axis=-1).reshape(-1, 2)
    return CrossSection(points=points, weights=np.repeat(w * half_wall * r * 2 * np.pi / angles, angles))


def ritz_frequencies(section: CrossSection, *, length: float, medium: Medium, order: int) -> Floats:
    r"""Natural frequencies of a free elastic prism by the Rayleigh-Ritz method, without its six rigid-body modes.

    Parameters
    ----------
    section : CrossSection
        With quadrature for this order.
    length : float
        Extent of the prism along z. [m]
    medium : Medium
        Its piezoelectric constants are ignored; it must be symmetric about the coordinate planes.
    order : int
        Highest total degree of the polynomials.

    Returns
    -------
    ndarray
        In Hz, in ascending order. Each is an upper bound that converges from above as the order rises; about the lowest
        tenth of them is accurate.

    Raises
    ------
    InvalidInput
        If the medium or cross-section lacks the symmetry, or the order is below 2.

    Notes
    -----
    With basis functions f that are orthonormal over the prism the mass matrix is the density times the identity, and
    the frequencies follow from

    .. math::

        \det\left(\int c_{ikjm}\, \partial_k f_a\, \partial_m f_b\, dV
        - \rho \omega^2 \delta_{ij}\delta_{ab}\right) = 0

    See Also
    --------
    sonolube.models.fem.solver.modes.natural_modes : Bodies of any shape, by finite elements.

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
    across, degrees = _cross_section_integrals(section, order)
    along = _axial_integrals(length, order)
    pairs = [(a, k) for a in range(len(degrees)) for k in range(order + 1 - sum(degrees[a]))]
    parity = {pair: (degrees[pair[0]][0] % 2, degrees[pair[0]][1] % 2, pair[1] % 2) for pair in pairs}
    squares = [_class_eigenvalues(across, along, pairs, parity, odd, c) for odd in product((0, 1), repeat=3)]
    omega = np.sqrt(np.maximum(np.sort(np.concatenate(squares)) / medium.density, 0.0))
    return np.asarray(omega[6:] / (2 * np.pi))


_BasisIndices = list[tuple[int, int]]  # of the functions over the cross-section and along z
_SHEAR = {(1, 2): 3, (0, 2): 4, (0, 1): 5}  # rows in Voigt notation


def _class_eigenvalues(
    across: Floats,
    along: Floats,
    pairs: _BasisIndices,
    parity: Mapping[tuple[int, int], tuple[int, ...]],
    odd: tuple[int, ...],
    c: Floats,
) -> Floats:
    """Eigenvalues rho omega^2 of one symmetry class, in which component i is odd along j where odd_j + [i = j] is."""
    own = [[p for p in pairs if all(parity[p][j] == (odd[j] + (i == j)) % 2 for j in range(3))] for i in range(3)]
    section = [np.array([a for a, _ in component], dtype=int) for component in own]
    axial = [np.array([k for _, k in component], dtype=int) for component in own]

    def product_of(i: int, k: int, j: int, m: int) -> Floats:
        """Integrals of d_k u_i d_m u_j over the functions of components i and j."""
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


def _cross_section_integrals(section: CrossSection, order: int) -> tuple[Floats, list[tuple[int, int]]]:
    """Integrals over the cross-section of products of derivatives, [k, m, a, b], and the degrees of the functions.

    Derivative 2 is that along z, which over the cross-section is the function itself.
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


def _axial_integrals(length: float, order: int) -> Floats:
    """Integrals along z of products of orthonormal Legendre polynomials or their derivatives, [d, e, k, m]."""
    x, w = legendre.leggauss(order + 1)
    values, slopes = _legendre(x, order)
    norm = np.sqrt((2 * np.arange(order + 1) + 1) / length)[:, np.newaxis]
    both = np.array([values * norm, slopes * norm * 2 / length]) * np.sqrt(w * length / 2)
    return np.asarray(np.einsum("dkq,emq->dekm", both, both))


def _legendre(x: Floats, order: int) -> tuple[Floats, Floats]:
    """Legendre polynomials up to an order and their derivatives, shapes (order + 1, q)."""
    unit = np.eye(order + 1)
    values: Floats = legendre.legvander(x, order).T.astype(np.float64)
    return values, np.array([legendre.legval(x, legendre.legder(row)) for row in unit])
