"""Trajectories sent to the GPU in chunks, and what they did brought back."""

import warnings

import numpy as np

from sonolube.checks import Floats
from sonolube.dynamics.first_order_modes import StatePairs
from sonolube.dynamics.gap_law import ExponentialGap, GapLaw, HertzGap, LinearGap, TabulatedGap
from sonolube.dynamics.gpu.device import THREADS, TURN, chunks, cuda
from sonolube.dynamics.gpu.marching_kernel import marching_kernel
from sonolube.dynamics.gpu.step_matrices import steps_of
from sonolube.dynamics.gpu.structure_rows import MOST_PAIRS
from sonolube.dynamics.time_marching.batch import Marched, Points, Schedule, elastic_extremes, law_constants
from sonolube.dynamics.time_marching.integrator import corners_within_steps
from sonolube.dynamics.time_marching.marching_kernel import STATISTICS


def unmarched(pairs: StatePairs, gap_law: GapLaw, schedule: Schedule) -> str:
    """Return why the kernel does not march a structure, a contact or a drive; empty where it does.

    Parameters
    ----------
    pairs : StatePairs
    gap_law : GapLaw
    schedule : Schedule

    Returns
    -------
    str
    """
    if not isinstance(gap_law, ExponentialGap | HertzGap | LinearGap | TabulatedGap):
        return f"the GPU marches no {type(gap_law).__name__}"
    modes = pairs.generator.shape[0]
    if modes > MOST_PAIRS:
        return f"the GPU marches structures of up to {MOST_PAIRS} modes, not {modes}"
    if corners_within_steps(schedule.waveform, schedule.steps).size:
        return f"the GPU marches waveforms with corners between steps, not within one of {schedule.steps}"
    return ""


def march_on_gpu(
    pairs: StatePairs, contact_rows: Floats, gap_law: GapLaw, points: Points, start: Floats, schedule: Schedule
) -> Marched:
    """March all points.

    Parameters
    ----------
    pairs : StatePairs
    contact_rows : ndarray, shape (2, n, 2)
        Displacement and velocity of the contact per state.
    gap_law : GapLaw
    points : Points
    start : ndarray, shape (2 n, points)
        State of each.
    schedule : Schedule

    Returns
    -------
    Marched
    """
    (m, count), periods = start.shape, schedule.periods
    settings = np.vstack(
        [
            points.frequency,
            points.voltage_peak_to_peak,
            points.voltage_offset,
            law_constants(gap_law, points.normal_load),
        ]
    )
    cells = gap_law.cells if isinstance(gap_law, TabulatedGap) else np.zeros((1, 4))
    steps = steps_of(pairs, contact_rows, schedule, float(points.frequency.min()))
    shapes = (
        (-(-periods // schedule.window), STATISTICS),
        (min(schedule.recorded, periods) * schedule.steps, m + 1),
        (min(schedule.strobed, periods), m),
        (m,),
        (2,),
    )
    answers = [np.empty((*shape, count)) for shape in shapes]
    choices = (float(schedule.ramp.duration), schedule.ramp.shape == "cosine", int(periods), int(schedule.window))
    kernel = marching_kernel(m // 2, gap_law.kind, gap_law.force_damping > 0)
    numbers = settings.shape[0] + m + sum(int(np.prod(shape)) for shape in shapes)
    with TURN, warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Grid size")  # few points keep a GPU idle, but are asked for
        fixed = [cuda.to_device(np.ascontiguousarray(values)) for values in (*steps, cells)]
        for own in chunks(count, numbers):
            given = [cuda.to_device(np.ascontiguousarray(values[:, own])) for values in (settings, start)]
            found = [cuda.device_array((*shape, own.stop - own.start), np.float64) for shape in shapes]
            kernel[-(-(own.stop - own.start) // THREADS), THREADS](*fixed, *choices, *given, *found)
            for values, device in zip(answers, found, strict=True):
                values[..., own] = device.copy_to_host()
    statistics, recorded, strobed, final, yielded = answers
    return Marched(
        statistics=elastic_extremes(statistics, gap_law, points.normal_load),
        recorded=recorded,
        strobed=strobed,
        final=final,
        yielded=yielded,
    )
