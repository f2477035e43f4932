"""Powers of monodromy matrices by array operations over all kicks at once, for few points.

The method is that of `floquet_kernel`, which compiles; here a period is a product of matrices, taken in pairs.
"""

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.models.dynamics.gap_laws.protocol import GapLaw
from sonolube.models.dynamics.harmonic_balance.floquet_kernel import (
    DISPLACEMENT_OUTPUT,
    INPUT,
    SQUARINGS,
    VELOCITY_OUTPUT,
)


def power_norms_of_motions(
    gap_law: GapLaw, pairs: Floats, settings: Floats, drift: Floats, harmonics: Complexes, kicks: int
) -> tuple[Floats, Floats]:
    """Norms of the monodromy matrices to the power 2^22, in two parts, as `monodromy_power_norms` writes them.

    `pairs` has shape (m, 6). `settings` has shape (p, 3). `drift` has shape (p, 4 m). `harmonics` has shape (p, H).
    Shape (p,).
    """
    omega, load, mean = settings.T[:, :, np.newaxis]
    orders = np.arange(1, harmonics.shape[1] + 1)
    turns = np.exp(2j * np.pi / kicks * (np.outer(orders, np.arange(kicks)) % kicks))
    x = mean + (harmonics @ turns).real
    force, stiffness = gap_law.force(x, load), gap_law.stiffness(x, load)
    duration = 2 * np.pi / (kicks * omega)
    into, displacement, velocity = (
        pairs[:, first : first + 2].ravel() for first in (INPUT, DISPLACEMENT_OUTPUT, VELOCITY_OUTPUT)
    )
    impulse = -(stiffness * duration)[..., np.newaxis] * displacement
    if gap_law.force_damping:
        factor = 1 - gap_law.force_damping * omega * (harmonics * (1j * orders) @ turns).real
        damping = np.where(factor > 0, gap_law.force_damping * force, 0.0)
        decay = float(velocity @ into) * damping * duration
        share = np.where(decay > 1e-12, -np.expm1(-decay) / np.maximum(decay, 1e-12), 1.0)
        impulse *= (np.maximum(factor, 0.0) * share)[..., np.newaxis]
        impulse -= (damping * duration * share)[..., np.newaxis] * velocity
    kicked = np.eye(into.size) + into[:, np.newaxis] * impulse[..., np.newaxis, :]
    return _power_norms(_product(_drift_matrices(drift)[:, np.newaxis] @ kicked))


def _drift_matrices(drift: Floats) -> Floats:
    """Block-diagonal matrices of the free motion of all pairs, shape (p, 2 m, 2 m)."""
    points, count = len(drift), drift.shape[1] // 4
    matrices = np.zeros((points, count, 2, count, 2))
    every = np.arange(count)
    matrices[:, every, :, every] = drift.reshape(points, count, 2, 2).transpose(1, 0, 2, 3)
    return matrices.reshape(points, 2 * count, 2 * count)


def _product(factors: Floats) -> Floats:
    """Product of matrices of shape (p, n, k, k) over n, the first of them applied first."""
    while factors.shape[1] > 1:
        odd = factors[:, -1:] if factors.shape[1] % 2 else factors[:, :0]
        factors = np.concatenate([factors[:, 1::2] @ factors[:, : factors.shape[1] - 1 : 2], odd], axis=1)
    return np.asarray(factors[:, 0])


def _power_norms(matrix: Floats) -> tuple[Floats, Floats]:
    """Binary exponents of matrices squared 22 times, and the squares of the remaining norms."""
    taken = np.zeros(len(matrix))
    for _ in range(SQUARINGS):
        power = np.frexp(np.einsum("pij,pij->p", matrix, matrix))[1] - 1 >> 1
        taken = 2 * taken + power
        matrix = np.ldexp(matrix, -power[:, np.newaxis, np.newaxis])
        matrix = matrix @ matrix
    return taken, np.einsum("pij,pij->p", matrix, matrix)
