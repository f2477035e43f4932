"""Batches of steady states on the GPU: points sent in chunks, and the solution assembled."""

import warnings

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.models.dynamics.gpu import fused_kernel as rows
from sonolube.models.dynamics.gpu.device import GPU_LOCK, THREADS, chunks, cuda
from sonolube.models.dynamics.gpu.friction_average import node_tables
from sonolube.models.dynamics.gpu.harmonic_balance import MOST_HARMONICS
from sonolube.models.dynamics.gpu.receptance import MOST_PAIRS, model_rows
from sonolube.models.dynamics.harmonic_balance.batch import BatchProblem, BatchSolution
from sonolube.models.dynamics.harmonic_balance.floquet_exponent import STABILITY_THRESHOLD, stability_undetermined
from sonolube.models.dynamics.kernels.contact_kernel import EXPONENTIAL

# Of the tolerance: a thread resolves its point alone, without the margin that neighbours in a block of SIMD lanes give.
_TOLERANCE_FACTOR = 0.1


def unsupported_steady_state(problem: BatchProblem) -> str:
    """Return why the kernel does not support the structure, contact law or drive of a batch; empty where it does.

    Parameters
    ----------
    problem : BatchProblem

    Returns
    -------
    str
    """
    law, pairs = problem.gap_law, problem.model.trace.size
    harmonics = max(problem.minimum_harmonics, problem.voltage.shape[1])
    if law.kind != EXPONENTIAL:
        return f"the GPU solves steady states of ExponentialGap only, not {type(law).__name__}"
    if law.force_damping > 0:
        return "the GPU solves steady states without force_damping only"
    if pairs > MOST_PAIRS:
        return f"the GPU solves steady states of structures with up to {MOST_PAIRS} modes, not {pairs}"
    if harmonics > MOST_HARMONICS:
        return f"the GPU solves steady states with up to {MOST_HARMONICS} harmonics, not {harmonics}"
    return ""


def solve_on_gpu(problem: BatchProblem) -> tuple[BatchSolution, NDArray[np.int64]]:
    """Return the steady states of a batch and their friction averages at the sliding speeds of the problem.

    Parameters
    ----------
    problem : BatchProblem
        One that `unsupported_steady_state` does not refuse.

    Returns
    -------
    BatchSolution
        Rows of points that are not `on_gpu` are undefined.
    ndarray of int, shape (4, p)
        Effort of each point: harmonics, samples, coupled harmonics, Newton steps.
    """
    model, speeds, points = problem.model, problem.speeds, problem.omega.size
    tolerance = _TOLERANCE_FACTOR * problem.tolerance
    length, slowest = problem.gap_law.kernel_parameter, speeds.min(initial=np.inf)
    constants = np.array([model.static_stiffness, model.clamped_capacitance, length, tolerance, slowest])
    choices = (problem.minimum_harmonics, problem.upper_branch, problem.stability, speeds.size > 0)
    averaged = speeds if speeds.size else np.ones(1)  # which the kernel ignores without sliding
    settings = np.stack([problem.omega, problem.load, problem.static_displacement])
    drive = np.ascontiguousarray(problem.voltage).view(np.float64).reshape(points, -1).T
    measures, harmonics = np.empty((rows.MEASURES, points)), np.empty((2 * MOST_HARMONICS, points))
    charge, averages = np.empty(drive.shape), np.empty((2, averaged.size, points))
    integers = np.empty((5, points), dtype=np.int64)
    results = (measures, harmonics, charge, averages, integers)
    with GPU_LOCK, warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Grid size")  # of a small batch that leaves the GPU idle
        fixed = [cuda.to_device(values) for values in (averaged, *node_tables(max(tolerance, 1e-7)))]
        pairs, numbers = cuda.to_device(model_rows(model)), cuda.to_device(constants)
        for own in chunks(points, sum(len(values.reshape(-1, points)) for values in (settings, drive, *results))):
            count = own.stop - own.start
            given = [cuda.to_device(np.ascontiguousarray(values[:, own])) for values in (settings, drive)]
            found = [cuda.device_array((*values.shape[:-1], count), values.dtype) for values in results]
            rows.KERNEL[-(-count // THREADS), THREADS](pairs, numbers, *choices, *given, *fixed, *found)
            for values, device in zip(results, found, strict=True):
                values[..., own] = device.copy_to_host()
    solved = integers[0] == rows.SOLVED
    if problem.stability:
        solved &= ~stability_undetermined(model, problem.omega)
    friction = np.moveaxis(averages[:, : speeds.size], 2, 0)
    return _solution(problem, measures, harmonics, charge, integers[1], friction, solved), integers[1:]


def _solution(
    problem: BatchProblem,
    measures: Floats,
    harmonics: Floats,
    charge: Floats,
    count: NDArray[np.int64],
    friction: Floats,
    solved: NDArray[np.bool_],
) -> BatchSolution:
    """Return the solution from results of the kernel, whose last axis is that of the points."""
    width = int(count[solved].max(initial=1))
    unstable = np.zeros(solved.size, dtype=np.bool_)
    if problem.stability:
        unstable = measures[rows.EXPONENT] > STABILITY_THRESHOLD
    return BatchSolution(
        mean_displacement=measures[rows.MEAN],
        harmonics=np.ascontiguousarray(harmonics[: 2 * width].T).view(np.complex128),
        mean_normal_force=measures[rows.MEAN_FORCE],
        charge_harmonics=np.ascontiguousarray(charge.T).view(np.complex128),
        vibration_amplitude=measures[rows.AMPLITUDE],
        extremum_phases=measures[[rows.MAXIMUM_PHASE, rows.MINIMUM_PHASE]].T,
        lowest_displacement=measures[rows.LOWEST_DISPLACEMENT],
        highest_normal_force=measures[rows.HIGHEST_FORCE],
        lowest_normal_force=measures[rows.LOWEST_FORCE],
        contact_loss_fraction=measures[rows.CONTACT_LOSS],
        unstable=unstable,
        coexisting_amplitude=np.full(solved.size, np.nan),
        harmonic_count=count,
        friction=friction,
        on_gpu=solved,
    )
