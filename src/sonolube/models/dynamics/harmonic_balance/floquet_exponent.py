"""Stability of periodic motions: the largest Floquet exponent of each point of a batch."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, Integers
from sonolube.models.dynamics.gap_laws.protocol import GapLaw
from sonolube.models.dynamics.gap_laws.table import kernel_law
from sonolube.models.dynamics.harmonic_balance.floquet_kernel import SQUARINGS, monodromy_power_norms, period_workspace
from sonolube.models.dynamics.harmonic_balance.floquet_rows import power_norms_of_motions
from sonolube.models.dynamics.harmonic_balance.receptance import PoleResidueModel
from sonolube.models.dynamics.kernels.simd import uniform_blocks

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
    *,
    on_gpu: bool = False,
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
    if on_gpu:
        from sonolube.models.dynamics.harmonic_balance import jax_kernels  # an optional package

        settings = np.stack([omega, load, equilibrium, mean], axis=1)
        powers, norms = jax_kernels.monodromy_power_norms(gap_law, pairs, settings, drift, harmonics, kicks)
    elif monodromy_power_norms.takes_few(int(kicks.sum()), **_FEW):
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
