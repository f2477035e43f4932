"""Parameter sweeps: operating points of a rig over any of its parameters, computed in chunks that can be resumed."""

from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, wait
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sonolube.design.sweep_dataset import ChunkStore, FurtherColumns, MemoryDatasetWriter, NetCDFDatasetWriter
from sonolube.design.sweep_plan import OPERATING_CONDITIONS, SweepPlan
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.execution.threads import thread_pool
from sonolube.extras import EXTRAS, missing_package
from sonolube.models.friction import SINE_TOLERANCE
from sonolube.rig import NUMBERS, STATUSES, PointBatch, point_batch
from sonolube.rig.operating_conditions import REFUSED

if TYPE_CHECKING:
    import xarray as xr

ProgressCallback = Callable[[int, int], None]
"""Called with the number of finished items and their total."""

CHUNK_POINTS = 100_000
"""Default number of points of a chunk, the unit in which results are computed and stored."""

_FINE, _FINE_POINTS = 1e-7, 200_000  # error of friction ratios, and the points of a sweep up to which it is kept


_FEW_POINTS = 512  # of a sweep, for which plain Python takes less than compiling


def sweep(
    plan: SweepPlan,
    *,
    folder: str | Path | None = None,
    chunk_points: int = CHUNK_POINTS,
    workers: int = 1,
    scheduler: str | None = None,
    advance: ProgressCallback | None = None,
    further: FurtherColumns | None = None,
) -> "xr.Dataset":
    """Operating points of a rig at every point of a plan, with a status for each.

    Parameters
    ----------
    plan : SweepPlan
    folder : str or Path, optional
        Folder in which finished chunks are stored, so that an interrupted sweep resumes from them; the result is then
        read lazily from the file sweep.nc in it. Without a folder the result is held in memory.
    chunk_points : int
        Points per chunk, which bounds the memory.
    workers : int
        Threads that compute chunks in parallel, or processes of a local cluster.
    scheduler : str, optional
        Address of a Dask scheduler, or "local" for a cluster of processes on this machine; needs the extra `cluster`.
    advance : callable, optional
        Called with the number of finished points and their total.
    further : FurtherColumns, optional
        Columns beside the numbers of the points, such as `predicted_results.PredictedColumns`.

    Returns
    -------
    xarray.Dataset
        Over the keys of a grid, or over `point`. `status` and `reason` are integer codes: the former indexes its
        attribute `flag_meanings`, the latter `reason_text`.

    Raises
    ------
    InvalidInput
        If the folder holds another sweep or another process sweeps into it, the disk is full,
        or Dask is missing.

    See Also
    --------
    grid_plan, list_plan, latin_hypercube_plan, compute_points

    Notes
    -----
    A point without a result does not end the sweep: it has a status, a reason and NaN. Each chunk depends on its own
    points alone, so threads, clusters and interruptions change no bit of the result. Another chunk size groups points
    into other simultaneous solves and changes the result by less than 1e-6. Friction ratios of asperity stick-slip
    are those of a single point up to 200,000 points, within 1e-4 of them beyond.
    """
    if chunk_points < 1 or workers < 1:
        raise InvalidInput(f"chunk_points and workers must be at least 1, got {chunk_points} and {workers}")
    if scheduler is not None and not EXTRAS["cluster"].is_installed:
        raise missing_package("cluster", remedy="leave the scheduler out")
    store = None
    if folder is not None:
        store = ChunkStore(folder=Path(folder), digest=plan.digest, chunk_points=chunk_points)
    count = -(-plan.points // chunk_points)
    with (
        nullcontext() if store is None else store.opened(),
        nullcontext(MemoryDatasetWriter(plan, further))
        if store is None
        else NetCDFDatasetWriter(plan, store.folder, further) as writer,
    ):
        done = 0
        missing = []
        for chunk in range(count):
            stored = None if store is None else store.read(chunk)
            if stored is None:
                missing.append(chunk)
            else:
                writer.write(chunk * chunk_points, stored)
                done += stored.status.size
        if advance is not None and done:
            advance(done, plan.points)
        with _executor(workers, scheduler, few_points=plan.points <= _FEW_POINTS) as pool:
            for chunk, batch in _computed_chunks(
                pool, partial(compute_points, plan), plan.points, missing, chunk_points, 2 * workers
            ):
                if store is not None:
                    store.write(chunk, batch)
                writer.write(chunk * chunk_points, batch)
                done += batch.status.size
                if advance is not None:
                    advance(done, plan.points)
        return writer.dataset()


def compute_points(plan: SweepPlan, start: int, stop: int) -> PointBatch:
    """Operating points of a contiguous range of a plan.

    Parameters
    ----------
    plan : SweepPlan
    start, stop : int
        First flat index, and that after the last.

    Returns
    -------
    PointBatch
    """
    rows = plan.rows(start, stop)
    conditions = {key.rpartition(".")[2]: rows[key] for key in OPERATING_CONDITIONS if key in rows}
    rig_entries = {key: array for key, array in rows.items() if key not in OPERATING_CONDITIONS}
    parts, indices = [], []
    for members in _points_by_rig(rig_entries, stop - start):
        changes = {key: array[members[0]] for key, array in rig_entries.items()}
        own = {name: array[members] for name, array in conditions.items()}
        parts.append(_points_of_one_rig(plan, changes, own, members.size))
        indices.append(members)
    return _merged(parts, indices, stop - start)


def _points_of_one_rig(
    plan: SweepPlan, changes: dict[str, Any], conditions: dict[str, NDArray[Any]], count: int
) -> PointBatch:
    """Operating points of one rig; all refused where the changes describe no rig."""
    try:
        rig = plan.rig(changes)
    except SonolubeError as refusal:
        return PointBatch(
            numbers={name: np.full(count, np.nan) for name in NUMBERS},
            status=np.full(count, STATUSES.index(REFUSED), dtype=np.int8),
            reason=np.zeros(count, dtype=np.int16),
            reasons=(str(refusal),),
        )
    if not conditions:
        conditions = {"sliding_speed": np.full(count, rig.sliding_speed)}
    tolerance = _FINE if plan.points <= _FINE_POINTS else SINE_TOLERANCE
    settings: dict[str, Any] = conditions
    return point_batch(rig, **settings, friction_tolerance=tolerance)


def _points_by_rig(rig_entries: dict[str, NDArray[Any]], count: int) -> list[NDArray[np.intp]]:
    """Indices of the points of each distinct rig."""
    if not rig_entries:
        return [np.arange(count)]
    codes = np.stack([np.unique(array, return_inverse=True)[1] for array in rig_entries.values()])
    _, rig_index = np.unique(codes, axis=1, return_inverse=True)
    order = np.argsort(rig_index.ravel(), kind="stable")
    return np.split(order, np.flatnonzero(np.diff(rig_index.ravel()[order])) + 1)


def _merged(parts: list[PointBatch], indices: list[NDArray[np.intp]], count: int) -> PointBatch:
    """One batch from the batches of several rigs, each placed at the indices of its points."""
    if len(parts) == 1:
        return parts[0]
    texts = {text: code for code, text in enumerate(dict.fromkeys(text for part in parts for text in part.reasons))}
    numbers = {name: np.empty(count) for name in NUMBERS}
    status, reason = np.empty(count, dtype=np.int8), np.empty(count, dtype=np.int16)
    for part, members in zip(parts, indices, strict=True):
        for name, column in part.numbers.items():
            numbers[name][members] = column
        status[members] = part.status
        reason[members] = np.array([texts[text] for text in part.reasons], dtype=np.int16)[part.reason]
    return PointBatch(numbers=numbers, status=status, reason=reason, reasons=tuple(texts))


def _computed_chunks(
    pool: Executor,
    compute: Callable[[int, int], PointBatch],
    points: int,
    chunks: list[int],
    chunk_points: int,
    most_pending: int,
) -> Iterator[tuple[int, PointBatch]]:
    """Yield chunks as they are finished, at most `most_pending` being submitted at a time."""
    remaining, pending = iter(chunks), {}
    try:
        while True:
            for chunk in remaining:
                stop = min((chunk + 1) * chunk_points, points)
                pending[pool.submit(compute, chunk * chunk_points, stop)] = chunk
                if len(pending) >= most_pending:
                    break
            if not pending:
                return
            for future in wait(pending, return_when=FIRST_COMPLETED).done:
                yield pending.pop(future), future.result()
    finally:
        for future in pending:
            future.cancel()


@contextmanager
def _executor(workers: int, scheduler: str | None, *, few_points: bool) -> Iterator[Executor]:
    """Yield a thread pool, or an executor of a Dask cluster."""
    if scheduler is None:
        with thread_pool(workers, few_points=few_points) as pool:
            yield pool
        return
    import distributed

    cluster: Any = distributed  # it has annotations in part
    own = {
        "n_workers": workers,
        "threads_per_worker": 1,
        "dashboard_address": "127.0.0.1:0",
    }  # any port: runs share 8787
    local = cluster.LocalCluster(**own) if scheduler == "local" else None
    with local or nullcontext(), cluster.Client(local or scheduler) as client:
        yield client.get_executor(pure=False)
