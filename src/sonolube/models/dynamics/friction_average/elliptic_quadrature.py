r"""Nodes and weights for averages over a period of functions of v_r/sqrt(v_r^2 + v^2), by elliptic substitution.

The integrand has branch points near the real axis wherever the vibration velocity v passes through zero, so that the
trapezoidal rule converges slowly for slow sliding. For a sinusoidal motion the substitution
:math:`\theta = \mathrm{am}(u\,|\,m)` with Jacobi's amplitude moves the branch points away from the axis, whatever the
sliding speed; for a motion with two extrema, a Moebius map of the unit circle first moves these half a period apart.
What remains is analytic in a wide strip, in which the trapezoidal rule converges geometrically.
"""

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from sonolube.checks import Complexes, Floats, Integers

NODES_PER_PASS = 4
"""Nodes that a kernel accumulates at once, which saves memory traffic of the sums. []"""
_ROWS_PER_DECADE = 4  # rows of the node table per decade of the ratio of sliding speed to peak velocity
_LAST_ROW = 24
# Acceleration of the higher harmonics over that of the first, and factors on the number of nodes between these limits.
_ACCELERATION_RATIOS, _NODE_FACTORS = np.array([0.1, 1.0, 2.0]), np.array([1, 2, 4, 16])


class EllipticNodes(NamedTuple):
    """Nodes exp(i phi) on the unit circle, clustered at +-i, one row per speed ratio; the weights of a row sum to 1."""

    cosine: Floats  # (rows, most)
    sine: Floats
    weight: Floats  # zero beyond the row's count
    count: Integers  # type: ignore[assignment]


@lru_cache(maxsize=64)
def elliptic_nodes(extra: int, tolerance: float = 1e-6) -> EllipticNodes:
    r"""Table of nodes for each ratio of sliding speed to peak velocity.

    Row r for the ratio :math:`q = 10^{-r/4}`.

    With the complementary parameter :math:`m_1 = q^2/(1 + q^2)`, n nodes are at

    .. math:: \varphi_j = \mathrm{am}\!\left(\tfrac{4 K}{n}\left(j + \tfrac12\right) \Big|\, 1 - m_1\right),
              \qquad w_j \propto \sqrt{m_1 + (1 - m_1)\cos^2\varphi_j} .
    """
    ratios = 10.0 ** (-np.arange(_LAST_ROW + 1) / _ROWS_PER_DECADE)
    digits = -np.log10(tolerance)  # each requires one node per e-fold of 4/q
    count = NODES_PER_PASS * np.ceil((digits * np.log(4 / ratios) + extra + 4) / NODES_PER_PASS).astype(np.int64)
    cosine, sine, weight = np.zeros((3, ratios.size, count.max()))
    for row, (ratio, nodes) in enumerate(zip(ratios, count, strict=True)):
        complement = ratio**2 / (1 + ratio**2)
        u = 4 * _complete_integral(complement) * (np.arange(nodes) + 0.5) / nodes
        phase = _jacobi_amplitude(u, complement)
        density = np.sqrt(complement + (1 - complement) * np.cos(phase) ** 2)
        cosine[row, :nodes], sine[row, :nodes] = np.cos(phase), np.sin(phase)
        weight[row, :nodes] = density / density.sum()
    return EllipticNodes(cosine, sine, weight, count)


def _complete_integral(complement: float) -> float:
    """Complete elliptic integral K(1 - complement) by the arithmetic-geometric mean."""
    mean, root = 1.0, math.sqrt(complement)
    while abs(mean - root) > 1e-15 * mean:
        mean, root = 0.5 * (mean + root), math.sqrt(mean * root)
    return 0.5 * math.pi / mean


def _jacobi_amplitude(u: Floats, complement: float) -> Floats:
    """Am(u | 1 - complement) by descending Landen transformations, accurate for a complement near zero."""
    means, differences = [1.0], [0.0]
    root = np.sqrt(complement)
    while abs(means[-1] - root) > 1e-16 * means[-1] and len(means) < 12:
        differences.append(0.5 * (means[-1] - root))
        means, root = [*means, 0.5 * (means[-1] + root)], np.sqrt(means[-1] * root)
    phase = 2.0 ** (len(means) - 1) * means[-1] * u
    for mean, difference in zip(means[:0:-1], differences[:0:-1], strict=True):
        phase = 0.5 * (phase + np.arcsin(difference / mean * np.sin(phase)))
    return np.asarray(phase)


def moebius_parameters(extremum_phases: Floats) -> Floats:
    r"""Moebius map of the unit circle that moves +-i to the two extrema of each motion.

    `extremum_phases` has shape (p, 2).

    Shape (3, p). Parameter :math:`\alpha`, and cosine and sine of the rotation :math:`\gamma`.

    .. math:: z = e^{i\gamma}\,\frac{w + \alpha}{1 + \alpha w}
    """
    half = 0.5 * (extremum_phases[:, 0] - extremum_phases[:, 1]) % np.pi
    rotation = extremum_phases[:, 0] - half
    return np.array([np.tan(0.25 * np.pi - 0.5 * half), np.cos(rotation), np.sin(rotation)])


def node_table_row(ratio: Floats) -> Integers:
    """Row of `elliptic_nodes` for a ratio of sliding speed to peak velocity."""
    smallest = 10.0 ** (-_LAST_ROW / _ROWS_PER_DECADE)
    steps = np.ceil(-_ROWS_PER_DECADE * np.log10(np.fmax(ratio, smallest)))  # the smallest for NaN, too
    return np.asarray(np.maximum(steps, 0).astype(np.int64))


def node_count_factor(harmonics: Complexes) -> Integers:
    """Factor on the number of nodes that motions with two extrema require for their higher harmonics.

    `harmonics` has shape (p, H).

    1, 2, 4 or 16.

    A velocity that nearly vanishes between the extrema brings further branch points close to the real axis. Twice the
    nodes square the error; the factors hold 1e-5 for sliding speeds down to a thousandth of the peak velocity.
    """
    parts = np.abs(np.ascontiguousarray(harmonics).view(np.float64))
    squared_orders = np.repeat(np.arange(1.0, harmonics.shape[1] + 1) ** 2, 2)
    first = parts[:, 0] + parts[:, 1]
    acceleration_ratio = (parts @ squared_orders - first) / np.maximum(first, 1e-300)
    return np.asarray(_NODE_FACTORS[np.searchsorted(_ACCELERATION_RATIOS, acceleration_ratio)])


def quadrature_nodes(extremum_phases: Floats, ratio: float, factor: int) -> tuple[Complexes, Floats]:
    """Nodes exp(i theta) and weights for averages over one period of one motion.

    Equally spaced for a motion with more than two extrema.
    """
    if np.isnan(extremum_phases[0]):
        samples = 2**15
        return np.exp(2j * np.pi * np.arange(samples) / samples), np.full(samples, 1 / samples)
    alpha, cosine, sine = moebius_parameters(extremum_phases[np.newaxis])[:, 0]
    table = elliptic_nodes(32, 1e-6**factor)
    row = int(node_table_row(np.float64(ratio)))  # type: ignore[arg-type]
    inside = slice(0, table.count[row])
    w = table.cosine[row, inside] + 1j * table.sine[row, inside]
    density = (1 - alpha**2) / np.abs(1 + alpha * w) ** 2
    nodes = complex(cosine, sine) * (w + alpha) / (1 + alpha * w)
    return nodes, table.weight[row, inside] * density
