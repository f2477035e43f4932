"""Time marching of batches on the GPU: trajectories sent in chunks, and the solution assembled."""

import warnings

import numpy as np

from sonolube.models.dynamics.gap_laws.table import is_compiled, kernel_law
from sonolube.models.dynamics.gpu.device import GPU_LOCK, THREADS, chunks, cuda
from sonolube.models.dynamics.gpu.integrator import step_tables
from sonolube.models.dynamics.gpu.marching_kernel import marching_kernel
from sonolube.models.dynamics.gpu.receptance import MOST_PAIRS
from sonolube.models.dynamics.time_marching.batch import MarchingProblem, MarchingSolution, with_force_extremes
from sonolube.models.dynamics.time_marching.integrator import corners_within_steps
from sonolube.models.dynamics.time_marching.row_layout import STATISTICS


def unsupported_march(problem: MarchingProblem) -> str:
    """Return why the kernel does not support the structure, contact law or drive of a march; empty where it does.

    Parameters
    ----------
    problem : MarchingProblem

    Returns
    -------
    str
    """
    schedule, pairs = problem.schedule, problem.modes.state_matrix.shape[0]
    if not is_compiled(problem.gap_law):
        return f"the GPU marches no {type(problem.gap_law).__name__}"
    if pairs > MOST_PAIRS:
        return f"the GPU marches structures with up to {MOST_PAIRS} modes, not {pairs}"
    if corners_within_steps(schedule.waveform, schedule.steps).size:
        return f"the GPU marches waveforms with corners between steps, not within one of {schedule.steps}"
    return ""


def march_on_gpu(problem: MarchingProblem) -> MarchingSolution:
    """Return the trajectories of a batch.

    Parameters
    ----------
    problem : MarchingProblem
        One that `unsupported_march` does not refuse.

    Returns
    -------
    MarchingSolution
    """
    schedule, gap_law, start = problem.schedule, problem.gap_law, problem.start
    (m, count), periods = start.shape, schedule.periods
    settings = np.vstack([problem.frequency, problem.voltage_peak_to_peak, problem.voltage_offset, problem.law_rows()])
    cells = kernel_law(gap_law)[1].cells
    shapes = (
        (-(-periods // schedule.window), STATISTICS),
        (min(schedule.recorded, periods) * schedule.steps, m + 1),
        (min(schedule.strobed, periods), m),
        (m,),
        (2,),
    )
    results = [np.empty((*shape, count)) for shape in shapes]
    choices = (float(schedule.ramp.duration), schedule.ramp.shape == "cosine", int(periods), int(schedule.window))
    kernel = marching_kernel(m // 2, gap_law.kind, gap_law.force_damping > 0)
    numbers = settings.shape[0] + m + sum(int(np.prod(shape)) for shape in shapes)
    tables = (*step_tables(problem), cells if cells.size else np.zeros((1, 4)))
    with GPU_LOCK, warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Grid size")  # of a small batch that leaves the GPU idle
        fixed = [cuda.to_device(np.ascontiguousarray(values)) for values in tables]
        for own in chunks(count, numbers):
            given = [cuda.to_device(np.ascontiguousarray(values[:, own])) for values in (settings, start)]
            found = [cuda.device_array((*shape, own.stop - own.start), np.float64) for shape in shapes]
            kernel[-(-(own.stop - own.start) // THREADS), THREADS](*fixed, *choices, *given, *found)
            for values, device in zip(results, found, strict=True):
                values[..., own] = device.copy_to_host()
    statistics, recorded, strobed, final, step_response = results
    return MarchingSolution(
        statistics=with_force_extremes(statistics, gap_law, problem.normal_load),
        recorded=recorded,
        strobed=strobed,
        final=final,
        step_response=step_response,
    )
