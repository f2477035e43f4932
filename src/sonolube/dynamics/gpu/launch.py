"""Points sent to the GPU in chunks, and answers brought back."""

import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats
from sonolube.dynamics.gap_law import GapLaw
from sonolube.dynamics.gpu import fused_kernel as rows
from sonolube.dynamics.gpu.balance import MOST_HARMONICS
from sonolube.dynamics.gpu.device import THREADS, TURN, chunks, cuda
from sonolube.dynamics.gpu.friction_average import crowded_levels
from sonolube.dynamics.gpu.structure_rows import MOST_PAIRS, structure_rows
from sonolube.dynamics.harmonic_balance.contact_kernel import EXPONENTIAL, Law
from sonolube.dynamics.harmonic_balance.floquet_exponent import GROWTH, too_slow
from sonolube.dynamics.harmonic_balance.receptance import ContactPort
from sonolube.dynamics.harmonic_balance.solver import Solutions

# Of the tolerance: a thread resolves its point alone, without the margin that neighbours in a block of lanes lend.
_SHARE = 0.1


class Fused(NamedTuple):
    """What the GPU found; rows of points that it left are not written."""

    solutions: Solutions
    means: Floats  # (2, p, s): friction factors, plain and weighted by the force
    done: NDArray[np.bool_]  # (p,)
    effort: NDArray[np.int64]  # (4, p): harmonics, samples, coupled harmonics, steps of Newton's method


def unserved(port: ContactPort, gap_law: GapLaw, *, harmonics: int) -> str:
    """Return why the kernel does not serve a structure, a contact or a drive; empty where it does.

    Parameters
    ----------
    port : ContactPort
    gap_law : GapLaw
    harmonics : int
        Harmonics to take at least, of the drive or of the contact.

    Returns
    -------
    str
    """
    if gap_law.kind != EXPONENTIAL:
        return f"the GPU serves ExponentialGap alone, not {type(gap_law).__name__}"
    if gap_law.force_damping > 0:
        return "the GPU serves contacts without force_damping"
    if port.trace.size > MOST_PAIRS:
        return f"the GPU serves structures of up to {MOST_PAIRS} modes, not {port.trace.size}"
    if harmonics > MOST_HARMONICS:
        return f"the GPU serves up to {MOST_HARMONICS} harmonics, not {harmonics}"
    return ""


def solve_on_gpu(
    port: ContactPort,
    law: Law,
    omega: Floats,
    load: Floats,
    voltage: Complexes,
    static_displacement: Floats,
    *,
    speeds: Floats,
    least: int,
    falling: bool,
    stability: bool,
    tolerance: float,
) -> Fused:
    """Find the steady states of points, and their mean friction at some sliding speeds.

    Parameters
    ----------
    port : ContactPort
    law : Law
    omega, load, static_displacement : ndarray, shape (p,)
        Angular frequency, in rad/s, dead load, in N, and mean displacement without contact, in m.
    voltage : ndarray of complex, shape (p, K)
        Harmonics of the drive, in V.
    speeds : ndarray, shape (s,)
        Sliding speeds, in m/s, none of them zero.
    least : int
        Harmonics to take and couple at least.
    falling : bool
        Whether to take the larger of several vibrations.
    stability : bool
        Whether to judge stability.
    tolerance : float
        Largest relative error of amplitude and force.

    Returns
    -------
    Fused
    """
    constants = np.array(
        [port.static_stiffness, port.clamped_capacitance, law.parameter, _SHARE * tolerance, speeds.min(initial=np.inf)]
    )
    choices = (least, falling, stability, speeds.size > 0)
    crowded = crowded_levels(max(_SHARE * tolerance, 1e-7))
    asked = speeds if speeds.size else np.ones(1)
    settings = np.stack([omega, load, static_displacement])
    drive = np.ascontiguousarray(voltage).view(np.float64).reshape(omega.size, -1).T
    measures, harmonics = np.empty((rows.MEASURES, omega.size)), np.empty((2 * MOST_HARMONICS, omega.size))
    charge, means = np.empty(drive.shape), np.empty((2, asked.size, omega.size))
    whole = np.empty((5, omega.size), dtype=np.int64)
    answers = (measures, harmonics, charge, means, whole)
    with TURN, warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Grid size")  # few points keep a GPU idle, but are asked for
        fixed = [cuda.to_device(values) for values in (asked, *crowded)]
        pairs, numbers = cuda.to_device(structure_rows(port)), cuda.to_device(constants)
        for own in chunks(
            omega.size, sum(len(values.reshape(-1, omega.size)) for values in (settings, drive, *answers))
        ):
            given = [cuda.to_device(np.ascontiguousarray(values[:, own])) for values in (settings, drive)]
            found = [cuda.device_array((*values.shape[:-1], own.stop - own.start), values.dtype) for values in answers]
            blocks = -(-(own.stop - own.start) // THREADS)
            rows.KERNEL[blocks, THREADS](pairs, numbers, *choices, *given, *fixed, *found)
            for values, device in zip(answers, found, strict=True):
                values[..., own] = device.copy_to_host()
    done = whole[0] == rows.DONE
    if stability:
        done &= ~too_slow(port, omega)
    solutions = _solutions(measures, harmonics, charge, whole[1], done, stability)
    return Fused(solutions, means[:, : speeds.size].swapaxes(1, 2), done, whole[1:])


def _solutions(
    measures: Floats,
    harmonics: Floats,
    charge: Floats,
    count: NDArray[np.int64],
    done: NDArray[np.bool_],
    stability: bool,
) -> Solutions:
    """Return answers, points last, as the processor gives its own."""
    width = int(count[done].max(initial=1))
    growing = measures[rows.GROWTH_RATE] > GROWTH if stability else np.zeros(done.size, dtype=np.bool_)
    return Solutions(
        measures[rows.MEAN],
        np.ascontiguousarray(harmonics[: 2 * width].T).view(np.complex128),
        measures[rows.MEAN_FORCE],
        np.ascontiguousarray(charge.T).view(np.complex128),
        measures[rows.AMPLITUDE],
        measures[[rows.UPPER, rows.LOWER]].T,
        measures[rows.LOWEST],
        measures[[rows.HIGHEST_FORCE, rows.LOWEST_FORCE]].T,
        measures[rows.SHARE_LOST],
        growing,
        np.full(done.size, np.nan),
        count,
    )
