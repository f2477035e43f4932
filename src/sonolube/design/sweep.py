"""Sweeps: any parameters of a rig over grids, lists or drawn points, in chunks that a second run need not do again."""

from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sonolube.design.chunk_dataset import InFile, InMemory
from sonolube.design.chunk_store import ChunkStore
from sonolube.design.plan import SETTINGS, SweepPlan
from sonolube.dynamics.backend import Backend, device_name, usable_backend
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.rig import NUMBERS, STATUSES, PointBatch, point_batch
from sonolube.threads import thread_pool

if TYPE_CHECKING:
    import xarray as xr

CHUNK_POINTS = 100_000
"""Points that are computed, kept and lost together."""

Advance = Callable[[int, int], None]


def sweep(
    plan: SweepPlan,
    *,
    folder: str | Path | None = None,
    chunk_points: int = CHUNK_POINTS,
    workers: int = 1,
    scheduler: str | None = None,
    advance: Advance | None = None,
    backend: Backend = "cpu",
) -> "xr.Dataset":
    """Return what a rig does at every point of a plan, with a status for each.

    Parameters
    ----------
    plan : SweepPlan
    folder : str or Path, optional
        Where chunks are kept, so that a run that was broken off goes on where it stood; the result is then the file
        sweep.nc in it, read as it is needed. Without a folder all is held in memory.
    chunk_points : int
        Points to a chunk, which bounds the memory.
    workers : int
        Threads to share the chunks, or processes of a local cluster.
    scheduler : str, optional
        Address of a Dask scheduler, or "local" for a cluster of this machine's processes; needs the extra `cluster`.
    advance : callable, optional
        Told how many points are done, and of how many.
    backend : {"cpu", "gpu"}
        Whether an NVIDIA GPU finds the vibrations that it can; its name then stands in the attribute `device`.

    Returns
    -------
    xarray.Dataset
        Over the keys of a grid, or over `point`. `status` and `reason` are codes: the former named by its attribute
        `flag_meanings`, the latter a place in `reason_text`.

    Raises
    ------
    InvalidInput
        If the rig has no structure, the folder holds another sweep, or Dask is missing.

    Warns
    -----
    GpuUnused
        If a GPU was asked for and there is none here, or it does not serve a rig's contact or structure.

    Notes
    -----
    A point that cannot be had is no reason to stop: it gets its status, and NaN. Each chunk depends on its points
    alone, so that threads, clusters and interruptions change no bit of the result; chunks of another size, whose points
    share their solves otherwise, change it by less than 1e-6. So does a GPU, whose sweeps have folders of their own.
    """
    if chunk_points < 1 or workers < 1:
        raise InvalidInput(f"chunk_points and workers must be at least 1, got {chunk_points} and {workers}")
    backend = usable_backend(backend)
    device, store = device_name(backend), None
    if folder is not None:
        store = ChunkStore(
            folder=Path(folder), digest=plan.digest + ("-gpu" if device else ""), chunk_points=chunk_points
        )
        store.open()
    count = -(-plan.points // chunk_points)
    with InMemory(plan, device) if store is None else InFile(plan, store.folder, device) as gathered:
        done = 0
        missing = []
        for chunk in range(count):
            kept = None if store is None else store.read(chunk)
            if kept is None:
                missing.append(chunk)
            else:
                gathered.take(chunk * chunk_points, kept)
                done += kept.status.size
        if advance is not None and done:
            advance(done, plan.points)
        with _executor(workers, scheduler) as pool:
            for chunk, batch in _computed(
                pool, partial(points_of, plan, backend=backend), plan.points, missing, chunk_points, 2 * workers
            ):
                if store is not None:
                    store.write(chunk, batch)
                gathered.take(chunk * chunk_points, batch)
                done += batch.status.size
                if advance is not None:
                    advance(done, plan.points)
        return gathered.dataset()


def points_of(plan: SweepPlan, start: int, stop: int, *, backend: Backend = "cpu") -> PointBatch:
    """Return the points of a plan from one place to before another.

    Parameters
    ----------
    plan : SweepPlan
    start, stop : int
        Places among all points.
    backend : {"cpu", "gpu"}
        Whether an NVIDIA GPU finds the vibrations that it can.

    Returns
    -------
    PointBatch
    """
    rows = plan.rows(start, stop)
    settings = {key.rpartition(".")[2]: rows[key] for key in SETTINGS if key in rows}
    others = {key: array for key, array in rows.items() if key not in SETTINGS}
    parts, places = [], []
    for members in _alike(others, stop - start):
        changes = {key: array[members[0]] for key, array in others.items()}
        own = {name: array[members] for name, array in settings.items()}
        parts.append(_points_of_one_rig(plan, changes, own, members.size, backend))
        places.append(members)
    return _joined(parts, places, stop - start)


def _points_of_one_rig(
    plan: SweepPlan, changes: dict[str, Any], settings: dict[str, NDArray[Any]], count: int, backend: Backend
) -> PointBatch:
    try:
        rig = plan.rig(changes)
    except SonolubeError as refusal:
        return PointBatch(
            numbers={name: np.full(count, np.nan) for name in NUMBERS},
            status=np.full(count, len(STATUSES) - 1, dtype=np.int8),
            reason=np.zeros(count, dtype=np.int16),
            reasons=(str(refusal),),
        )
    if not settings:
        settings = {"sliding_speed": np.full(count, rig.sliding_speed)}
    return point_batch(rig, **settings, backend=backend)


def _alike(others: dict[str, NDArray[Any]], count: int) -> list[NDArray[np.intp]]:
    """Return the places of the points that share a rig."""
    if not others:
        return [np.arange(count)]
    codes = np.stack([np.unique(array, return_inverse=True)[1] for array in others.values()])
    _, which = np.unique(codes, axis=1, return_inverse=True)
    order = np.argsort(which.ravel(), kind="stable")
    return np.split(order, np.flatnonzero(np.diff(which.ravel()[order])) + 1)


def _joined(parts: list[PointBatch], places: list[NDArray[np.intp]], count: int) -> PointBatch:
    if len(parts) == 1:
        return parts[0]
    texts = {text: code for code, text in enumerate(dict.fromkeys(text for part in parts for text in part.reasons))}
    numbers = {name: np.empty(count) for name in NUMBERS}
    status, reason = np.empty(count, dtype=np.int8), np.empty(count, dtype=np.int16)
    for part, members in zip(parts, places, strict=True):
        for name, column in part.numbers.items():
            numbers[name][members] = column
        status[members] = part.status
        reason[members] = np.array([texts[text] for text in part.reasons], dtype=np.int16)[part.reason]
    return PointBatch(numbers=numbers, status=status, reason=reason, reasons=tuple(texts))


def _computed(
    pool: Executor, computed: Callable[[int, int], PointBatch], points: int, chunks: list[int], size: int, ahead: int
) -> Iterator[tuple[int, PointBatch]]:
    """Yield chunks as they are done, a few at a time under way."""
    waiting, under_way = iter(chunks), {}
    try:
        while True:
            for chunk in waiting:
                stop = min((chunk + 1) * size, points)
                under_way[pool.submit(computed, chunk * size, stop)] = chunk
                if len(under_way) >= ahead:
                    break
            if not under_way:
                return
            for done in _first_done(under_way):
                yield under_way.pop(done), done.result()
    finally:
        for future in under_way:
            future.cancel()


def _first_done(under_way: dict[Future[PointBatch], int]) -> set[Future[PointBatch]]:
    return wait(under_way, return_when=FIRST_COMPLETED).done


@contextmanager
def _executor(workers: int, scheduler: str | None) -> Iterator[Executor]:
    if scheduler is None:
        with thread_pool(workers) as pool:
            yield pool
        return
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        raise InvalidInput(
            "a cluster needs Dask, which is not installed: pip install 'sonolube[cluster]', or leave the scheduler out"
        ) from None
    local = LocalCluster(n_workers=workers, threads_per_worker=1) if scheduler == "local" else None
    with local or nullcontext(), Client(local or scheduler) as client:
        yield client.get_executor(pure=False)
