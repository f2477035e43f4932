"""Friction averages of motions with two extrema per period, for many sliding speeds, on SIMD rows.

The nodes are those of `sonolube.models.dynamics.friction_average.elliptic_quadrature`.
"""

from typing import Any, NamedTuple

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.execution.compilation import kernel
from sonolube.models.dynamics.friction_average.elliptic_quadrature import NODES_PER_PASS, EllipticNodes
from sonolube.models.dynamics.kernels.contact_kernel import KernelLaw, contact_force_rows
from sonolube.models.dynamics.kernels.simd import INNER, KERNEL, LANES, block_maximum, gather

# Rows of a block: Moebius parameters, angular frequency, dead load, mean displacement and equilibrium coordinate of
# each motion (columns of `settings`); then at a node: mapped node and its powers, displacement, velocity, weight, and
# contact force (followed by stiffness and damping).
ALPHA, ROTATION_RE, ROTATION_IM, OMEGA, LOAD, MEAN, EQUILIBRIUM = range(7)
Z_RE, Z_IM, POWER_RE, POWER_IM, DISPLACEMENT, VELOCITY, WEIGHT, FORCE = range(7, 15)
_SINGLE_PRECISION_TOLERANCE = 1e-5  # tolerance above which single precision suffices


class FrictionWorkspace(NamedTuple):
    """Rows in which a block of motions is averaged."""

    rows: Floats  # (17, lanes): ALPHA to FORCE, and the contact's stiffness and damping
    motion: Floats  # (2 H, lanes): real and imaginary parts of harmonics in turn
    nodes: Floats  # (4, 3, lanes): squared velocity, weight and weighted force at four nodes
    sums: Floats  # (2, s, lanes)


def sum_precision(tolerance: float) -> type[np.floating[Any]]:
    """Floating-point type of the sums for states of a relative tolerance: single precision holds 1e-5."""
    return np.float32 if tolerance >= _SINGLE_PRECISION_TOLERANCE else np.float64


def friction_workspace(harmonics: int, speeds: Floats) -> FrictionWorkspace:
    """Allocate the workspace of `elliptic_averages`, its sums of the precision of the speeds."""
    nodes = np.empty((NODES_PER_PASS, 3, LANES), speeds.dtype)
    sums = np.empty((2, speeds.size, LANES), speeds.dtype)
    return FrictionWorkspace(np.empty((17, LANES)), np.empty((2 * harmonics, LANES)), nodes, sums)


@kernel(**KERNEL)
def elliptic_averages(
    law: KernelLaw,
    settings: Floats,
    harmonics: Floats,
    count: Integers,
    table_row: Integers,
    chosen: Integers,
    speeds: Floats,
    nodes: EllipticNodes,
    work: FrictionWorkspace,
    averages: Floats,
) -> None:
    r"""Write the averages of v_r/sqrt(v_r^2 + v^2) over a period, plain and weighted by the contact force.

    `settings` has shape (p, 7). `harmonics` has shape (p, 2 H). `averages` has shape (2, p, s).

    .. math::
        \left\langle\frac{v_r}{\sqrt{v_r^2 + v^2}}\right\rangle, \qquad
        \left\langle\frac{F_n}{F_N}\,\frac{v_r}{\sqrt{v_r^2 + v^2}}\right\rangle
    """
    rows, motion, at_nodes, sums = work.rows, work.motion, work.nodes, work.sums
    for start in range(0, chosen.size, LANES):
        block = chosen[start : start + LANES]
        h, row = block_maximum(count, block), block_maximum(table_row, block)
        gather(settings, block, rows)
        gather(harmonics, block, motion[: 2 * h])
        sums[:] = 0.0
        for j in range(nodes.count[row]):
            _motion_at(nodes.cosine[row, j], nodes.sine[row, j], nodes.weight[row, j], motion, h, rows)
            contact_force_rows(law, rows[LOAD], rows[EQUILIBRIUM], rows[DISPLACEMENT], rows[VELOCITY], rows[FORCE:])
            _store_node(rows, at_nodes[j % NODES_PER_PASS])
            if j % NODES_PER_PASS == NODES_PER_PASS - 1:
                _accumulate(speeds, at_nodes, sums)
        for lane in range(block.size):
            for s in range(speeds.size):
                for which in range(2):
                    averages[which, block[lane], s] = sums[which, s, lane]


@kernel(**INNER)
def _motion_at(cosine: float, sine: float, weight: float, motion: Floats, h: int, rows: Floats) -> None:
    """Write displacement, velocity and weight at a node, mapped so that the nodes cluster at the extrema."""
    z_re, z_im, p_re, p_im = rows[Z_RE], rows[Z_IM], rows[POWER_RE], rows[POWER_IM]
    x, v = rows[DISPLACEMENT], rows[VELOCITY]
    for lane in range(LANES):
        # z = exp(i gamma) (w + alpha)/(1 + alpha w) for w = cosine + i sine
        alpha, rotation_re, rotation_im = rows[ALPHA, lane], rows[ROTATION_RE, lane], rows[ROTATION_IM, lane]
        below = 1 / (1 + 2 * alpha * cosine + alpha * alpha)
        w_re = (cosine * (1 + alpha * alpha) + 2 * alpha) * below
        stretch = (1 - alpha * alpha) * below
        z_re[lane] = rotation_re * w_re - rotation_im * sine * stretch
        z_im[lane] = rotation_re * sine * stretch + rotation_im * w_re
        rows[WEIGHT, lane] = weight * stretch
        p_re[lane], p_im[lane] = 1.0, 0.0
        x[lane], v[lane] = rows[MEAN, lane], 0.0
    for k in range(1, h + 1):
        a, b = motion[2 * k - 2], motion[2 * k - 1]
        for lane in range(LANES):
            q_re = p_re[lane] * z_re[lane] - p_im[lane] * z_im[lane]
            q_im = p_re[lane] * z_im[lane] + p_im[lane] * z_re[lane]
            x[lane] += a[lane] * q_re - b[lane] * q_im
            v[lane] -= k * (a[lane] * q_im + b[lane] * q_re)
            p_re[lane], p_im[lane] = q_re, q_im
    for lane in range(LANES):
        v[lane] *= rows[OMEGA, lane]


@kernel(**INNER)
def _store_node(rows: Floats, node: Floats) -> None:
    """Store squared velocity, weight, and contact force times weight over the dead load at a node."""
    for lane in range(LANES):
        node[0, lane] = rows[VELOCITY, lane] * rows[VELOCITY, lane]
        node[1, lane] = rows[WEIGHT, lane]
        node[2, lane] = rows[FORCE, lane] * rows[WEIGHT, lane] / rows[LOAD, lane]


@kernel(**INNER)
def _accumulate(speeds: Floats, nodes: Floats, sums: Floats) -> None:
    """Add the contributions of four nodes to the averages at every sliding speed."""
    for s in range(speeds.size):
        speed, plain, weighted = speeds[s], sums[0, s], sums[1, s]
        for lane in range(LANES):
            for node in range(NODES_PER_PASS):
                ratio = speed / np.sqrt(nodes[node, 0, lane] + speed * speed)
                plain[lane] += nodes[node, 1, lane] * ratio
                weighted[lane] += nodes[node, 2, lane] * ratio
