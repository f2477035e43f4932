"""Time marching of a batch of points: problem, solution, distribution on lanes and threads, accuracy of steps."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.execution.threads import thread_pool
from sonolube.models.dynamics.gap_laws.closed_form import GapLaw, damped_force
from sonolube.models.dynamics.gap_laws.table import kernel_law
from sonolube.models.dynamics.kernels.contact_kernel import EXPONENTIAL
from sonolube.models.dynamics.linear import FirstOrderModes
from sonolube.models.dynamics.time_marching.integrator import ExponentialIntegrator
from sonolube.models.dynamics.time_marching.marching_kernel import LANES, STATISTICS, march_lanes, row_layout
from sonolube.models.dynamics.waveform import StartUpRamp, Waveform, jump_phases

_BLOCK = 32 * LANES  # points whose integrators are in memory together


@dataclass(frozen=True, kw_only=True, slots=True)
class MarchingSchedule:
    """Drive waveform, ramp, time steps and recording of a march, common to all points.

    Parameters
    ----------
    waveform : Waveform
    ramp : StartUpRamp
    steps : int
        Steps per period, a multiple of 4, at least 8, such that the waveform jumps between steps.
    periods : int
        Number of drive periods.
    window : int
        Periods per entry of the statistics.
    recorded : int
        Number of periods, at the end, of which every step is recorded.
    strobed : int
        Number of periods, at the end, of which the last instant is recorded.

    Raises
    ------
    InvalidInput
        If a count is out of range or the waveform jumps within a step.
    """

    waveform: Waveform
    ramp: StartUpRamp
    steps: int
    periods: int
    window: int
    recorded: int
    strobed: int

    def __post_init__(self) -> None:
        if self.steps < 8 or self.steps % 4:
            raise InvalidInput(f"steps_per_period must be a multiple of 4, at least 8, got {self.steps!r}")
        for name, count in {
            "periods": self.periods,
            "periods_per_window": self.window,
            "recorded_periods": self.recorded,
            "strobed_periods": self.strobed,
        }.items():
            if count < 1:
                raise InvalidInput(f"{name} must be at least 1, got {count!r}")
        _ = self.jump_steps

    @property
    def jump_steps(self) -> NDArray[np.int64]:
        """Steps of a period before which the waveform jumps."""
        jumps = jump_phases(self.waveform) / (2 * np.pi)
        if _within_steps(jumps, self.steps):
            fitting = [steps for steps in range(8, 513, 4) if not _within_steps(jumps, steps)]
            advice = f"take a multiple of {fitting[0]} steps" if fitting else "move it to a multiple of 1/512 period"
            raise InvalidInput(f"steps_per_period = {self.steps} lets the waveform jump within a step; {advice}")
        return np.round(jumps * self.steps).astype(np.int64)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MarchingProblem:
    """Trajectories to compute: one structure, contact law and schedule, and the operating points.

    Parameters
    ----------
    modes : FirstOrderModes
    contact_output : ndarray, shape (2, n, 2)
        Displacement and velocity of the contact per state.
    gap_law : GapLaw
    schedule : MarchingSchedule
    normal_load : ndarray, shape (points,)
        Dead load. [N]
    frequency : ndarray, shape (points,)
        Frequency of the drive. [Hz]
    voltage_peak_to_peak : ndarray, shape (points,)
        Peak-to-peak drive voltage. [V]
    voltage_offset : ndarray, shape (points,)
        Mean drive voltage. [V]
    start : ndarray, shape (2 n, points)
        Initial states.
    """

    modes: FirstOrderModes
    contact_output: Floats
    gap_law: GapLaw
    schedule: MarchingSchedule
    normal_load: Floats
    frequency: Floats
    voltage_peak_to_peak: Floats
    voltage_offset: Floats
    start: Floats

    def law_rows(self) -> Floats:
        """Rows by which kernels evaluate the contact law, shape (5, points): load, three numbers, damping.

        The numbers are the parameter of the law (the inverse decay length of an exponential one), its equilibrium
        coordinate, and the logarithm of the load.
        """
        law, load = self.gap_law, self.normal_load
        parameter = 1 / law.kernel_parameter if law.kind == EXPONENTIAL else law.kernel_parameter
        parameters, dampings = np.full_like(load, parameter), np.full_like(load, law.force_damping)
        return np.stack([load, parameters, law.equilibrium_coordinate(load), np.log(load), dampings])


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MarchingSolution:
    """Trajectories of a batch as the kernels return them, points last.

    Parameters
    ----------
    statistics : ndarray, shape (windows, 8, points)
        Over the steps of each window: highest and lowest displacement of the contact, its sum and its sums weighted by
        cosine and sine of the drive's phase; sum, highest and lowest of the contact force.
    recorded : ndarray, shape (steps, 2 n + 1, points)
        States, then the contact force less the load that the step was computed with.
    strobed : ndarray, shape (periods, 2 n, points)
        States at the ends of periods.
    final : ndarray, shape (2 n, points)
        States at the end.
    step_response : ndarray, shape (2, points)
        Displacement and velocity of the contact after one step of a constant unit force.
    """

    statistics: Floats
    recorded: Floats
    strobed: Floats
    final: Floats
    step_response: Floats


def march_on_threads(problem: MarchingProblem, workers: int) -> MarchingSolution:
    """Trajectories of a batch by threads of the CPU."""
    if workers < 1:
        raise InvalidInput(f"workers must be at least 1, got {workers!r}")
    schedule, gap_law = problem.schedule, problem.gap_law
    m, count = problem.start.shape
    width, chunks = min(count, LANES), -(-count // LANES)
    steps, periods = schedule.steps, schedule.periods
    statistics = np.empty((chunks, -(-periods // schedule.window), STATISTICS, width))
    recorded = np.empty((chunks, min(schedule.recorded, periods) * steps, m + 1, width))
    strobed = np.empty((chunks, min(schedule.strobed, periods), m, width))
    final = np.empty((chunks, 1, m, width))
    step_response = np.empty((2, count))
    pairs = (0,) * (m // 2)
    state = row_layout(pairs).state
    law = kernel_law(gap_law)
    law_rows = problem.law_rows()

    def march_chunk(
        chunk: int, integrator: ExponentialIntegrator, which: NDArray[np.intp], points: NDArray[np.intp]
    ) -> None:
        numbers = _lane_rows(problem, law_rows[:, points], integrator, which, points)
        drive, table = _drive_rows(problem, integrator, which, points), _aligned(np.empty((steps + 4) * m * LANES))
        march_lanes(
            pairs,
            law,
            numbers,
            drive,
            table,
            schedule.ramp.duration * problem.frequency[points] * steps,
            schedule.ramp.shape == "cosine",
            integrator.backward.ravel(),
            schedule.jump_steps,
            steps,
            periods,
            schedule.window,
            statistics[chunk],
            recorded[chunk],
            strobed[chunk],
        )
        final[chunk, 0] = numbers[state : state + m * LANES].reshape(m, LANES)[:, :width]

    with thread_pool(workers) as pool:
        for block in _blocks(count):
            frequency, where = np.unique(problem.frequency[block], return_inverse=True)
            integrator = ExponentialIntegrator(
                problem.modes, problem.contact_output, frequency=frequency, steps=steps, waveform=schedule.waveform
            )
            step_response[:, block] = integrator.ahead[where, :, 0].sum(axis=-1).T
            jobs = [
                pool.submit(march_chunk, (block.start + first) // LANES, integrator, where[own], block.start + own)
                for first, own in _lanes(block.stop - block.start)
            ]
            for job in jobs:
                job.result()
    found = _points_last(statistics, count)  # shape (windows, 8, points)
    if gap_law.force_damping == 0:  # the extremes of the force are those at the extremes of the displacement
        found[:, 6] = gap_law.force(found[:, 1], problem.normal_load)
        found[:, 7] = gap_law.force(found[:, 0], problem.normal_load)
    return MarchingSolution(
        statistics=found,
        recorded=_points_last(recorded, count),
        strobed=_points_last(strobed, count),
        final=_points_last(final, count)[0],
        step_response=step_response,
    )


def _within_steps(jumps: Floats, steps: int) -> bool:
    """Whether a jump, at a fraction of the period, falls within a step."""
    return bool(np.any(np.abs(jumps * steps - np.round(jumps * steps)) > 1e-9))


def _blocks(count: int) -> Iterator[slice]:
    """Blocks of points."""
    return (slice(first, min(first + _BLOCK, count)) for first in range(0, count, _BLOCK))


def _lanes(count: int) -> Iterator[tuple[int, NDArray[np.intp]]]:
    """Points of each set of SIMD lanes; surplus lanes repeat the last point."""
    return ((first, np.minimum(np.arange(first, first + LANES), count - 1)) for first in range(0, count, LANES))


def _points_last(chunks: Floats, count: int) -> Floats:
    """Results of chunks as one array with the points as last axis."""
    moved = np.moveaxis(chunks, 0, -2)
    return moved.reshape(*moved.shape[:-2], -1)[..., :count]


def _drive_rows(
    problem: MarchingProblem, integrator: ExponentialIntegrator, which: NDArray[np.intp], points: NDArray[np.intp]
) -> Floats:
    """Drive of each lane, flattened from shape (3, steps, states, lanes)."""
    swing, offset = problem.voltage_peak_to_peak[points], problem.voltage_offset[points]
    drive = np.einsum("l,lknma->knmal", swing, integrator.wave[which])
    drive += np.einsum("l,lkma->kmal", offset, integrator.offset[which])[:, np.newaxis]
    return _aligned(drive)


def _lane_rows(
    problem: MarchingProblem,
    law_rows: Floats,
    integrator: ExponentialIntegrator,
    which: NDArray[np.intp],
    points: NDArray[np.intp],
) -> Floats:
    """Rows of the kernel, flattened, in the order of `row_layout`."""
    output, start = problem.contact_output, problem.start
    same = np.broadcast_to(output[..., np.newaxis], (*output.shape, LANES))
    at = row_layout((0,) * output.shape[1])
    groups = [
        np.moveaxis(integrator.propagator[which], 0, -1),
        np.moveaxis(integrator.oldest[which], 0, -1),
        same[0],
        same[1],
        start[:, points],
        start[:, points],
        np.moveaxis(integrator.recent[which], 0, -1),
        np.moveaxis(integrator.predictor[which], 0, -1),
        np.zeros(5 * LANES),
        law_rows,
        np.zeros(at.x_ahead - at.statistics),
        np.moveaxis(integrator.ahead[which], 0, -1),
        np.zeros(LANES),
    ]
    return _aligned(np.concatenate([group.reshape(-1, LANES) for group in groups]))


def _aligned(values: Floats) -> Floats:
    """Flat copy aligned to a cache line, for vector loads."""
    padded = np.empty(values.size + 8)
    first = -(padded.ctypes.data // 8) % 8
    flat = padded[first : first + values.size]
    flat[:] = values.ravel()
    return flat


_LARGEST_FORCE = 1e12  # over the load, beyond which a solution has diverged
_LARGEST_DISPLACEMENT = 1.0  # in m, likewise
_LARGEST_ERROR = 1e-3  # of the force in a step, over the largest force, beyond which steps are coarse
_LARGEST_FEEDBACK = 0.1  # relative change of the force by its own effect in a step, above which it may be unstable


def assess_steps(
    problem: MarchingProblem, solution: MarchingSolution
) -> tuple[NDArray[np.str_], NDArray[np.str_], Floats]:
    """Status, advice and error of the steps of each point, by two errors of the force and by its feedback on itself.

    One error is the difference of the predicted force and the force of the corrected state; the other is the effect on
    the mean of aliased harmonics beyond half the steps per period, if these decay like those of a pulse. The feedback
    is the relative change of the force through its own effect over a step, at the stiffest instant of the whole march:
    above a tenth an explicit step can be unstable, with spurious loss of contact.
    """
    gap_law, load, steps = problem.gap_law, problem.normal_load, problem.schedule.steps
    last = solution.recorded[-steps:]
    x, v = (np.einsum("m,tml->lt", row.ravel(), last[:, :-1]) for row in problem.contact_output)
    predicted = last[:, -1].T + load[:, np.newaxis]
    farthest, closest, strongest, weakest = solution.statistics[:, [0, 1, 6, 7]].transpose(1, 2, 0)
    with np.errstate(over="ignore", invalid="ignore"):
        bounded = strongest < _LARGEST_FORCE * load[:, np.newaxis]
        bounded &= np.maximum(farthest, -closest) < _LARGEST_DISPLACEMENT
        diverged = ~(np.all(bounded, axis=1) & np.all(np.isfinite(x), axis=1))
        largest = np.maximum(predicted.max(axis=1), load)
        corrected = np.abs(damped_force(gap_law, x, v, load[:, np.newaxis]) - predicted).max(axis=1) / largest
        harmonics = np.abs(np.fft.rfft(predicted, axis=1))
        aliased = 2 * (harmonics[:, -1] / np.maximum(harmonics[:, 0], 1e-9 * load)) ** 4
        feedback = gap_law.stiffness(closest.min(axis=1), load) * np.abs(solution.step_response[0])
        feedback += gap_law.force_damping * strongest.max(axis=1) * np.abs(solution.step_response[1])
    error = np.where(diverged, np.inf, np.maximum(corrected, aliased))
    unstable, coarse = ~(2 * feedback <= _LARGEST_FEEDBACK), error > _LARGEST_ERROR
    finer = 4 * np.ceil(steps / 4 * np.clip(np.sqrt(4 * feedback / _LARGEST_FEEDBACK), 2.0, 4.0))
    corner = np.any(weakest == 0, axis=1) & (gap_law.has_corner or gap_law.force_damping > 0)
    advice = [""] * load.size
    for i in np.flatnonzero(diverged | unstable | coarse | corner):
        advice[i] = _advice(diverged[i], unstable[i], coarse[i], corner[i], finer[i], steps)
    return np.where(diverged, "diverged", np.where(unstable | coarse, "coarse", "marched")), np.array(advice), error


def _advice(diverged: bool, unstable: bool, coarse: bool, corner: bool, finer: float, steps: int) -> str:
    """Advice for one point: the foremost failure with its remedy, and the order at corners of the force."""
    remedy = f"take {finer:.0f} steps a period, or less voltage" if np.isfinite(finer) else "take less voltage"
    reasons = {
        f"the solution grew without bound; {remedy}": diverged,
        f"{steps} steps a period are too few for the contact at its stiffest; take {finer:.0f}": unstable,
        f"{steps} steps a period leave an error of the force above {_LARGEST_ERROR:g}; take {finer:.0f}": coarse,
    }
    foremost = [text for text, true in reasons.items() if true][:1]
    order = ["the force has a corner at the loss of contact, where the error falls only as the square of the step"]
    return "; ".join(foremost + (order if corner else []))
