"""Marching of many points side by side: points into lanes, lanes onto threads, results back."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.dynamics.first_order_modes import StatePairs
from sonolube.dynamics.gap_law import ExponentialGap, GapLaw, HertzGap, LinearGap, TabulatedGap
from sonolube.dynamics.time_marching.integrator import StepFilter, step_filter
from sonolube.dynamics.time_marching.marching_kernel import LANES, STATISTICS, march_lanes, rows
from sonolube.dynamics.waveform import StartUpRamp, Waveform, jumps
from sonolube.errors import InvalidInput
from sonolube.threads import threads

_BLOCK = 32 * LANES  # points whose tables are in memory together


@dataclass(frozen=True, kw_only=True, slots=True)
class Schedule:
    """How long to march, how finely, and what to keep.

    Parameters
    ----------
    waveform : Waveform
    ramp : StartUpRamp
    steps : int
        Steps a period, a multiple of 4, at least 8, such that the waveform jumps between steps.
    periods : int
        Periods to march.
    window : int
        Periods to an entry of the statistics.
    recorded : int
        Periods at the end of which every step is kept.
    strobed : int
        Periods at the end of which the last instant is kept.

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
        turns = jumps(self.waveform) / (2 * np.pi)
        if _off_steps(turns, self.steps):
            fitting = [steps for steps in range(8, 513, 4) if not _off_steps(turns, steps)]
            advice = f"take a multiple of {fitting[0]} steps" if fitting else "move it to a multiple of 1/512 period"
            raise InvalidInput(f"steps_per_period = {self.steps} lets the waveform jump within a step; {advice}")
        return np.round(turns * self.steps).astype(np.int64)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Marched:
    """What the kernel found, points last.

    Parameters
    ----------
    statistics : ndarray, shape (windows, 8, points)
        Of the steps in each window: highest and lowest displacement of the contact, its sum and its sums weighted by
        cosine and sine of the drive's phase; sum, highest and lowest of the contact force.
    recorded : ndarray, shape (steps, 2 n + 1, points)
        States, then the contact force less the load that the step was made with.
    strobed : ndarray, shape (periods, 2 n, points)
    final : ndarray, shape (2 n, points)
    yielded : ndarray, shape (2, points)
        Displacement and velocity of the contact after one step of a constant unit force.
    """

    statistics: Floats
    recorded: Floats
    strobed: Floats
    final: Floats
    yielded: Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Points:
    """What differs from point to point.

    Parameters
    ----------
    normal_load : ndarray, shape (points,)
        Dead load. [N]
    frequency : ndarray, shape (points,)
        Frequency of the drive. [Hz]
    voltage_peak_to_peak : ndarray, shape (points,)
        Drive voltage, peak to peak. [V]
    voltage_offset : ndarray, shape (points,)
        Its mean. [V]
    """

    normal_load: Floats
    frequency: Floats
    voltage_peak_to_peak: Floats
    voltage_offset: Floats


def march_points(
    pairs: StatePairs,
    contact_rows: Floats,
    gap_law: GapLaw,
    points: Points,
    start: Floats,
    schedule: Schedule,
    workers: int,
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
    workers : int
        Threads to march with.

    Returns
    -------
    Marched

    Raises
    ------
    InvalidInput
        If there are no workers.
    """
    if workers < 1:
        raise InvalidInput(f"workers must be at least 1, got {workers!r}")
    count, m = points.frequency.size, start.shape[0]
    width, chunks = min(count, LANES), -(-count // LANES)
    steps, periods = schedule.steps, schedule.periods
    statistics = np.empty((chunks, -(-periods // schedule.window), STATISTICS, width))
    recorded = np.empty((chunks, min(schedule.recorded, periods) * steps, m + 1, width))
    strobed = np.empty((chunks, min(schedule.strobed, periods), m, width))
    final = np.empty((chunks, 1, m, width))
    yielded = np.empty((2, count))
    state = rows((0,) * (m // 2)).state
    cells = gap_law.cells if isinstance(gap_law, TabulatedGap) else np.empty((0, 4))

    def march_chunk(chunk: int, filters: StepFilter, which: NDArray[np.intp], lanes: NDArray[np.intp]) -> None:
        numbers = _numbers(contact_rows, gap_law, filters, which, points, start, lanes)
        march_lanes(
            (0,) * (m // 2),
            (0,) * gap_law.kind,
            (0,) * (gap_law.force_damping > 0),
            cells,
            numbers,
            _drive(filters, which, points, lanes),
            _aligned(np.empty((steps + 4) * m * LANES)),
            schedule.ramp.duration * points.frequency[lanes] * steps,
            schedule.ramp.shape == "cosine",
            filters.backward.ravel(),
            schedule.jump_steps,
            steps,
            periods,
            schedule.window,
            statistics[chunk],
            recorded[chunk],
            strobed[chunk],
        )
        final[chunk, 0] = numbers[state : state + m * LANES].reshape(m, LANES)[:, :width]

    with threads(workers) as pool:
        for block in _blocks(count):
            found, where = np.unique(points.frequency[block], return_inverse=True)
            filters = step_filter(pairs, contact_rows, frequency=found, steps=steps, waveform=schedule.waveform)
            yielded[:, block] = filters.ahead[where, :, 0].sum(axis=-1).T
            jobs = [
                pool.submit(march_chunk, (block.start + first) // LANES, filters, where[lanes], block.start + lanes)
                for first, lanes in _lanes(block.stop - block.start)
            ]
            for job in jobs:
                job.result()
    return Marched(
        statistics=elastic_extremes(_points_last(statistics, count), gap_law, points.normal_load),
        recorded=_points_last(recorded, count),
        strobed=_points_last(strobed, count),
        final=_points_last(final, count)[0],
        yielded=yielded,
    )


def elastic_extremes(statistics: Floats, gap_law: GapLaw, load: Floats) -> Floats:
    """Return statistics whose highest and lowest force, where nothing damps the contact, are those of its extremes."""
    if gap_law.force_damping == 0:
        statistics[:, 6] = gap_law.force(statistics[:, 1], load)
        statistics[:, 7] = gap_law.force(statistics[:, 0], load)
    return statistics


def _off_steps(turns: Floats, steps: int) -> bool:
    return bool(np.any(np.abs(turns * steps - np.round(turns * steps)) > 1e-9))


def _blocks(count: int) -> Iterator[slice]:
    return (slice(first, min(first + _BLOCK, count)) for first in range(0, count, _BLOCK))


def _lanes(count: int) -> Iterator[tuple[int, NDArray[np.intp]]]:
    """Return the points of each set of lanes; lanes left over repeat the last point."""
    return ((first, np.minimum(np.arange(first, first + LANES), count - 1)) for first in range(0, count, LANES))


def _points_last(chunks: Floats, count: int) -> Floats:
    moved = np.moveaxis(chunks, 0, -2)
    return moved.reshape(*moved.shape[:-2], -1)[..., :count]


def _drive(filters: StepFilter, which: NDArray[np.intp], points: Points, lanes: NDArray[np.intp]) -> Floats:
    """Return the drive of each lane, of shape (3, steps, states, lanes) before it is made flat."""
    swing, offset = points.voltage_peak_to_peak[lanes], points.voltage_offset[lanes]
    drive = np.einsum("l,lknma->knmal", swing, filters.wave[which])
    drive += np.einsum("l,lkma->kmal", offset, filters.offset[which])[:, np.newaxis]
    return _aligned(drive)


def _numbers(
    contact_rows: Floats,
    gap_law: GapLaw,
    filters: StepFilter,
    which: NDArray[np.intp],
    points: Points,
    start: Floats,
    lanes: NDArray[np.intp],
) -> Floats:
    """Return the rows of the kernel, in the order of `marching_kernel.rows`."""
    same = np.broadcast_to(contact_rows[..., np.newaxis], (*contact_rows.shape, LANES))
    at = rows((0,) * contact_rows.shape[1])
    groups = [
        np.moveaxis(filters.propagator[which], 0, -1),
        np.moveaxis(filters.oldest[which], 0, -1),
        same[0],
        same[1],
        start[:, lanes],
        start[:, lanes],
        np.moveaxis(filters.recent[which], 0, -1),
        np.moveaxis(filters.foreseen[which], 0, -1),
        np.zeros(5 * LANES),
        law_constants(gap_law, points.normal_load[lanes]),
        np.zeros(at.x_ahead - at.statistics),
        np.moveaxis(filters.ahead[which], 0, -1),
        np.zeros(LANES),
    ]
    return _aligned(np.concatenate([group.reshape(-1, LANES) for group in groups]))


def _aligned(values: Floats) -> Floats:
    """Return a flat copy that starts where a line of the cache does, as vector loads like it."""
    room = np.empty(values.size + 8)
    first = -(room.ctypes.data // 8) % 8
    flat = room[first : first + values.size]
    flat[:] = values.ravel()
    return flat


def law_constants(gap_law: GapLaw, load: Floats) -> Floats:
    """Return the rows that evaluate a contact law: dead load, three constants, damping; points last."""
    none = np.zeros_like(load)
    match gap_law:
        case ExponentialGap():
            first, second, third = 1 / gap_law.decay_length, none, none
        case HertzGap():
            first, second, third = gap_law.coefficient, (load / gap_law.coefficient) ** (2 / 3), none
        case LinearGap():
            first, second, third = gap_law.normal_stiffness, none, none
        case TabulatedGap():
            first, second, third = gap_law.cells_per_length, gap_law.rest_position(load), np.log(load)
        case _:
            raise InvalidInput(f"gap_law must be one that marching knows, got {type(gap_law).__name__}")
    return np.stack([load, np.full_like(load, first), second, third, np.full_like(load, gap_law.force_damping)])
