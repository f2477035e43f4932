"""Stability of periodic motions: the largest Floquet exponent of each point of a batch.

For few points powers of monodromy matrices are computed by array operations over all kicks at once: the method is that
of `floquet_kernel`, which compiles; here a period is a product of matrices, taken in pairs.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, Integers
from sonolube.models.dynamics.gap_laws.closed_form import GapLaw
from sonolube.models.dynamics.gap_laws.table import kernel_law
from sonolube.models.dynamics.harmonic_balance.equations import PoleResidueModel
from sonolube.models.dynamics.harmonic_balance.floquet_kernel import (
    DISPLACEMENT_OUTPUT,
    INPUT,
    SQUARINGS,
    VELOCITY_OUTPUT,
    monodromy_power_norms,
    period_workspace,
)
from sonolube.models.dynamics.kernels.simd import uniform_blocks


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


STABILITY_THRESHOLD = 1e-6
"""Floquet exponent per period above which a motion counts as unstable, beyond rounding. []"""
_KICKS_PER_RADIAN = 8  # of the structure's fastest mode
_FEW: Final = {"most": 20_000, "at_first": 200_000}  # kicks for which arrays take less than loading and compiling
_HARMONICS_STEP = 4  # to which numbers of harmonics are rounded up
_MAX_KICKS = 2**22  # per period, which take seconds


def stability_undetermined(model: PoleResidueModel, omega: Floats) -> NDArray[np.bool_]:
    """At which angular frequencies a period holds too many cycles of the fastest mode to compute stability."""
    return np.asarray(_KICKS_PER_RADIAN * _fastest(model) > _MAX_KICKS * omega)


def floquet_exponents(
    model: PoleResidueModel,
    gap_law: GapLaw,
    omega: Floats,
    load: Floats,
    mean: Floats,
    harmonics: Complexes,
    count: Integers,
    samples: Integers,
) -> Floats:
    r"""Largest Floquet exponent of each motion, per period of the drive.

    `harmonics` has shape (p, H).

    Positive for unstable motions; compare with `STABILITY_THRESHOLD`.

    With the Floquet multipliers :math:`\mu_i`, the eigenvalues of the monodromy matrix M, the exponent is

    .. math:: \max_i \ln|\mu_i| = \lim_{n\to\infty} \frac1n \left(\ln\|M^{2n}\| - \ln\|M^n\|\right),

    whatever the eigenvectors; here 2n = 2^22. The norm of :math:`M^n` enters to within a factor of two, by the powers
    of two that scale the squarings.
    """
    law = kernel_law(gap_law)
    needed = np.where(stability_undetermined(model, omega), 0.0, np.ceil(_KICKS_PER_RADIAN * _fastest(model) / omega))
    kicks = np.maximum(samples, needed.astype(np.int64))
    kicks, count = _rounded_up(kicks), -(-count // _HARMONICS_STEP) * _HARMONICS_STEP  # so that few are alone
    drift = _transition_matrices(model, 2 * np.pi / (kicks * omega))
    pairs = np.hstack([model.contact_input, model.displacement_output, model.velocity_output])
    powers, norms = np.empty((2, omega.size))
    equilibrium = gap_law.equilibrium_coordinate(load)
    if monodromy_power_norms.takes_few(int(kicks.sum()), **_FEW):
        settings = np.stack([omega, load, mean], axis=1)
        with np.errstate(all="ignore"):
            for own in (np.flatnonzero(kicks == each) for each in np.unique(kicks)):
                motions = settings[own], drift[own], harmonics[own, : count[own].max()]
                powers[own], norms[own] = power_norms_of_motions(gap_law, pairs, *motions, int(kicks[own[0]]))
    else:
        settings = np.stack([omega, load, equilibrium, mean], axis=1)
        chosen = uniform_blocks(np.arange(omega.size), count, kicks)
        work = period_workspace(2 * model.trace.size, int(count.max(initial=0)))
        parts = np.ascontiguousarray(harmonics).view(np.float64)
        power_norms = monodromy_power_norms.compiled
        power_norms(law, pairs, settings, drift, parts, count, kicks, chosen, work, powers, norms)
    return np.asarray((powers * np.log(2.0) + 0.5 * np.log(norms)) / 2.0 ** (SQUARINGS - 1))


def _rounded_up(kicks: Integers) -> Integers:
    """Numbers of kicks rounded up to three binary digits."""
    unit = 2 ** np.maximum(np.floor(np.log2(kicks)) - 2, 0).astype(np.int64)
    return np.asarray(-(-kicks // unit) * unit)


def _fastest(model: PoleResidueModel) -> float:
    """Largest natural angular frequency of the structure, in rad/s."""
    return float(np.sqrt(np.abs(model.determinant).max()))


def _transition_matrices(model: PoleResidueModel, duration: Floats) -> Floats:
    r"""State transition matrices exp(A t) of every pair, shape (p, 4 m), row by row.

    Notes
    -----
    With :math:`A = h I + B`, h half the trace, :math:`B^2 = (h^2 - \det A) I =: \delta^2 I`, so that

    .. math:: e^{At} = e^{ht} \left(\cosh(\delta t)\, I + \frac{\sinh(\delta t)}{\delta}\, B\right),

    with cosine and sine where :math:`\delta^2 < 0`.
    """
    half = 0.5 * model.trace[:, np.newaxis]
    square = half * half - model.determinant[:, np.newaxis]
    angle = np.sqrt(np.abs(square)) * duration
    decay, overdamped = np.exp(half * duration), square > 0
    # overdamped: the slower and the faster exponential, neither of which overflows
    exponent = np.where(overdamped, angle, 0.0)
    slow, fast = np.exp(half * duration + exponent), np.exp(half * duration - exponent)
    even = np.where(overdamped, 0.5 * (slow + fast), decay * np.cos(angle))
    odd = np.where(overdamped, 0.5 * (slow - fast), decay * np.sin(angle))
    odd = np.where(angle > 1e-9, odd / np.maximum(angle, 1e-9), decay) * duration
    traceless = model.state_matrix - half[:, :, np.newaxis] * np.eye(2)
    moved = even.T[:, :, np.newaxis, np.newaxis] * np.eye(2) + np.einsum("mij,mp->pmij", traceless, odd)
    return np.asarray(moved.reshape(duration.size, 4 * model.trace.size))
