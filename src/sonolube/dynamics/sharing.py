"""Who does the points asked for: threads of the processor, or a GPU and the processor what the GPU leaves."""

from collections.abc import Callable
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats
from sonolube.dynamics.backend import Backend, available, unused
from sonolube.dynamics.first_order_modes import StatePairs
from sonolube.dynamics.gap_law import GapLaw
from sonolube.dynamics.harmonic_balance.contact_kernel import law_of
from sonolube.dynamics.harmonic_balance.receptance import ContactPort
from sonolube.dynamics.harmonic_balance.solver import Solutions, solve
from sonolube.dynamics.time_marching.batch import Marched, Points, Schedule, march_points
from sonolube.dynamics.warm_up import compiling_alongside
from sonolube.errors import InvalidInput
from sonolube.threads import threads

Result = TypeVar("Result")

_CHUNK = 16384  # points that a thread solves together at most, to bound the memory


class Asked(NamedTuple):
    """Points to solve, as `sonolube.dynamics.harmonic_balance.solver.solve` takes them."""

    port: ContactPort
    gap_law: GapLaw
    omega: Floats
    load: Floats
    voltage: Complexes
    static_displacement: Floats
    least: int
    falling: bool
    stability: bool
    tolerance: float


class Shared(NamedTuple):
    """Steady states, and means of friction of those points that a GPU did."""

    solutions: Solutions
    means: Floats  # (2, p, s): plain and weighted by the force
    done: NDArray[np.bool_]  # (p,): by the GPU


def shared(asked: Asked, speeds: Floats, *, workers: int, backend: Backend) -> Shared:
    """Solve the points on the backend asked for.

    Parameters
    ----------
    asked : Asked
    speeds : ndarray, shape (s,)
        Sliding speeds to average friction at where a GPU does it, in m/s, none of them zero.
    workers : int
        Threads of the processor.
    backend : {"cpu", "gpu"}

    Returns
    -------
    Shared
    """
    if not _on_gpu(asked, backend):
        means, done = np.empty((2, asked.omega.size, 0)), np.zeros(asked.omega.size, dtype=bool)
        return Shared(_on_cpu(asked, np.arange(asked.omega.size), workers), means, done)
    from sonolube.dynamics.gpu import solve_on_gpu

    found = solve_on_gpu(
        asked.port,
        law_of(asked.gap_law)[1],
        asked.omega,
        asked.load,
        asked.voltage,
        asked.static_displacement,
        speeds=speeds,
        least=asked.least,
        falling=asked.falling,
        stability=asked.stability,
        tolerance=asked.tolerance,
    )
    left = np.flatnonzero(~found.done)
    solutions = _filled(found.solutions, left, _on_cpu(asked, left, workers)) if left.size else found.solutions
    return Shared(solutions, found.means, found.done)


def shared_march(
    pairs: StatePairs,
    contact_rows: Floats,
    gap_law: GapLaw,
    points: Points,
    start: Floats,
    schedule: Schedule,
    *,
    workers: int,
    backend: Backend,
) -> Marched:
    """March the points on the backend asked for.

    Parameters
    ----------
    pairs, contact_rows, gap_law, points, start, schedule
        As `march_points` takes them.
    workers : int
        Threads of the processor.
    backend : {"cpu", "gpu"}

    Returns
    -------
    Marched
    """
    if available(backend) == "gpu":
        from sonolube.dynamics.gpu import march_on_gpu, unmarched

        reason = unmarched(pairs, gap_law, schedule)
        if not reason:
            return march_on_gpu(pairs, contact_rows, gap_law, points, start, schedule)
        unused(reason)
    return march_points(pairs, contact_rows, gap_law, points, start, schedule, workers)


def _on_gpu(asked: Asked, backend: Backend) -> bool:
    """Return whether a GPU is asked for, there, and serves the points; warn where it is not or does not."""
    if available(backend) == "cpu":
        return False
    from sonolube.dynamics.gpu import unserved

    reason = unserved(asked.port, asked.gap_law, harmonics=max(asked.least, asked.voltage.shape[1]))
    return not reason or unused(reason) == "gpu"


def _on_cpu(asked: Asked, chosen: NDArray[np.intp], workers: int) -> Solutions:
    def part(own: slice) -> Solutions:
        points = chosen[own]
        return solve(
            asked.port,
            asked.gap_law,
            asked.omega[points],
            asked.load[points],
            asked.voltage[points],
            asked.static_displacement[points],
            least=asked.least,
            falling=asked.falling,
            stability=asked.stability,
            tolerance=asked.tolerance,
        )

    compiled, _ = law_of(asked.gap_law)
    with compiling_alongside(compiled, stability=asked.stability, tolerance=asked.tolerance):
        return _gather(in_threads(part, chosen.size, workers))


def in_threads(part: Callable[[slice], Result], points: int, workers: int) -> list[Result]:
    """Return what `part` makes of one chunk of the points after another, shared among threads."""
    if workers < 1:
        raise InvalidInput(f"workers must be at least 1, got {workers!r}")
    size = min(_CHUNK, max(-(-points // workers), 1))
    chunks = [slice(start, start + size) for start in range(0, max(points, 1), size)]
    if workers == 1:
        return [part(chunk) for chunk in chunks]
    with threads(workers) as pool:
        return list(pool.map(part, chunks))


def _gather(parts: list[Solutions]) -> Solutions:
    if len(parts) == 1:
        return parts[0]
    room = max(part.harmonics.shape[1] for part in parts)
    harmonics = np.zeros((sum(part.mean.size for part in parts), room), dtype=np.complex128)
    start = 0
    for part in parts:
        harmonics[start : start + part.mean.size, : part.harmonics.shape[1]] = part.harmonics
        start += part.mean.size
    narrow = (part._replace(harmonics=part.harmonics[:0, :1]) for part in parts)
    gathered = Solutions(*(np.concatenate(columns) for columns in zip(*narrow, strict=True)))
    return gathered._replace(harmonics=harmonics)


def _filled(found: Solutions, left: NDArray[np.intp], others: Solutions) -> Solutions:
    """Return solutions of which some rows come from elsewhere."""
    room = max(found.harmonics.shape[1], others.harmonics.shape[1])
    harmonics = np.zeros((found.mean.size, room), dtype=np.complex128)
    harmonics[:, : found.harmonics.shape[1]] = found.harmonics
    harmonics[left] = 0.0
    harmonics[left, : others.harmonics.shape[1]] = others.harmonics
    for name in Solutions._fields:
        if name != "harmonics":
            getattr(found, name)[left] = getattr(others, name)
    return found._replace(harmonics=harmonics)
