"""Uncertainty of a rig carried through its models: every sample is a rig of its own, with a status."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube import __version__
from sonolube.checks import Floats
from sonolube.design.plan import SweepPlan, list_plan
from sonolube.design.sobol import STRETCHES, saltelli_points, sobol_points
from sonolube.design.sweep import Advance, sweep
from sonolube.errors import InvalidInput, SonolubeError, UnknownName
from sonolube.rig import (
    NUMBERS,
    ContactPoint,
    FrictionPoint,
    Rig,
    WearPoint,
    contact_point,
    friction_point,
    read_rig,
    wear_point,
)
from sonolube.vocabulary import quantities, quantity

if TYPE_CHECKING:
    import xarray as xr

_RIGS_AT_ONCE = 128  # of a chunk, which is kept and lost together
_POINTS: tuple[tuple[Any, Callable[[Rig], Any]], ...] = (
    (FrictionPoint, friction_point),
    (WearPoint, wear_point),
    (ContactPoint, contact_point),
)
_FOUND, _REFUSED = 0, 1
_BESIDE = ("uncertainty", "assumptions")  # what a sample needs no more


def outcomes_of(rig: Rig) -> tuple[str, ...]:
    """Return the quantities of a rig through which uncertainty can be carried.

    Parameters
    ----------
    rig : Rig

    Returns
    -------
    tuple of str
        Those of the steady vibration where the rig has a structure; then those of its friction, wear and contact.
    """
    swept = NUMBERS if rig.structure is not None else ()
    return tuple(dict.fromkeys((*swept, *(name for record, _ in _POINTS for name in _numbers_of(record)))))


def propagate(
    rig_file: str | Path,
    *,
    of: str = "friction_ratio",
    samples: int = 1024,
    indices: bool = False,
    over: Mapping[str, ArrayLike] | None = None,
    joint: Mapping[str, Floats] | None = None,
    seed: int = 0,
    changes: Sequence[str] = (),
    folder: str | Path | None = None,
    workers: int = 1,
    advance: Advance | None = None,
) -> "xr.Dataset":
    """Return what a rig does for samples of its uncertain entries.

    Parameters
    ----------
    rig_file : str or Path
        With the table `uncertainty`, unless `joint` is given.
    of : str
        The outcome that is wanted, one of `outcomes_of`; it decides which model runs.
    samples : int
        How many samples; taken up to the next power of two.
    indices : bool
        Whether to take the samples at which Sobol's indices can be had: as many times more as there are uncertain
        entries, and once more.
    over : mapping of str to array_like, optional
        Values by dotted key at each of which every sample is taken; a key of the table among them is no longer
        uncertain.
    joint : mapping of str to ndarray, shape (n,), optional
        Draws by dotted key that belong together, such as those of a posterior; they take the place of the table's.
    seed : int
        Of the samples.
    changes : sequence of str
        Entries of the file to replace first.
    folder : str or Path, optional
        Where parts are kept, so that a run that was broken off goes on where it stood; for outcomes of the steady
        vibration.
    workers : int
        Threads.
    advance : callable, optional
        Told how many points are done, and of how many.

    Returns
    -------
    xarray.Dataset
        Over `sample`, after `block` for indices and before the keys of `over`, with the uncertain entries as
        coordinates, `stretch`, and `status` and `reason` as `sweep` gives them.

    Raises
    ------
    InvalidInput
        If nothing is uncertain, indices are asked of what has none, or samples are fewer than 32.
    UnknownName
        If there is no such outcome.

    Notes
    -----
    Entries are independent of each other but for those of `joint`. A sample that cannot be had keeps its status, and
    NaN.
    """
    rig = read_rig(rig_file, changes=changes)
    if of not in outcomes_of(rig):
        raise UnknownName.among(outcomes_of(rig), kind="outcome", name=of)
    grid = {key: np.atleast_1d(np.asarray(values)) for key, values in (over or {}).items()}
    if indices and (grid or joint):
        raise InvalidInput("indices need independent entries and one outcome each: leave out over and joint")
    laws = {key: law for key, law in rig.uncertainty.items() if key not in grid and key not in (joint or {})}
    if not laws and not joint:
        raise InvalidInput(f"{rig_file}: the table uncertainty is missing, or names only what is swept")
    shares, stretch = (saltelli_points if indices else sobol_points)(
        len(laws) + (0 if joint is None else 1), samples=samples, seed=seed
    )
    drawn = {key: law.quantile(shares[..., place]) for place, (key, law) in enumerate(laws.items())}
    for key, draws in (joint or {}).items():
        drawn[key] = draws[(shares[..., -1] * draws.size).astype(int)]
    shape = shares.shape[:-1] + tuple(values.size for values in grid.values())
    plan = _plan(rig_file, drawn, grid, shape, changes)
    if of in NUMBERS and rig.structure is not None:
        per_rig = int(np.prod(shape[len(shares.shape) - 1 :]))
        found = sweep(plan, folder=folder, chunk_points=_RIGS_AT_ONCE * per_rig, workers=workers, advance=advance)
    else:
        found = _by_points(plan, of, advance)
    return _shaped(found, plan, rig, of, drawn, grid, shape, stretch, seed)


def _numbers_of(record: Any) -> list[str]:
    return [field.name for field in fields(record) if field.name in quantities()]


def _plan(
    rig_file: str | Path,
    drawn: Mapping[str, Floats],
    grid: Mapping[str, NDArray[Any]],
    shape: tuple[int, ...],
    changes: Sequence[str],
) -> SweepPlan:
    """Return one row to each sample at each value."""
    values = {}
    for key, column in drawn.items():
        wide = column.reshape(column.shape + (1,) * (len(shape) - column.ndim))
        values[key] = np.broadcast_to(wide, shape).ravel()
    for place, (key, each) in enumerate(reversed(tuple(grid.items()))):
        values[key] = np.broadcast_to(each.reshape(each.shape + (1,) * place), shape).ravel()
    plan = list_plan(rig_file, over=values, changes=changes)
    return replace(plan, content={key: part for key, part in plan.content.items() if key not in _BESIDE})


def _by_points(plan: SweepPlan, of: str, advance: Advance | None) -> "xr.Dataset":
    """Return one outcome of the models without a structure, point by point."""
    import xarray as xr

    model = next(model for record, model in _POINTS if of in _numbers_of(record))
    values, status = np.full(plan.points, np.nan), np.full(plan.points, _FOUND, dtype=np.int8)
    reason, texts = np.zeros(plan.points, dtype=np.int32), {"the model holds": 0}
    for point in range(plan.points):
        row = {key: array[0] for key, array in plan.rows(point, point + 1).items()}
        try:
            value = getattr(model(plan.rig(row)), of)
            if value is None:
                raise InvalidInput(f"the rig does not tell what {of} needs")
            values[point] = value
        except SonolubeError as refusal:
            status[point], reason[point] = _REFUSED, texts.setdefault(str(refusal), len(texts))
        if advance is not None and not (point + 1) % 64:
            advance(point + 1, plan.points)
    return xr.Dataset(
        {
            of: ("point", values, {"units": quantity(of).unit or "1", "long_name": quantity(of).meaning}),
            "status": ("point", status, {"flag_values": np.arange(2, dtype=np.int8), "flag_meanings": "found refused"}),
            "reason": ("point", reason),
            "reason_text": ("reasons", np.array(list(texts))),
        }
    )


def _shaped(
    found: "xr.Dataset",
    plan: SweepPlan,
    rig: Rig,
    of: str,
    drawn: Mapping[str, Floats],
    grid: Mapping[str, NDArray[Any]],
    shape: tuple[int, ...],
    stretch: NDArray[np.intp],
    seed: int,
) -> "xr.Dataset":
    import xarray as xr

    names = plan.names
    own = ("block", "sample") if len(shape) - len(grid) == 2 else ("sample",)
    dims = (*own, *(names[key] for key in grid))
    variables = {
        str(name): (dims, array.values.reshape(shape), array.attrs)
        for name, array in found.data_vars.items()
        if name in (of, *NUMBERS, "status", "reason")
    }
    coordinates: dict[str, Any] = {names[key]: (own, column, _labels(key)) for key, column in drawn.items()}
    coordinates |= {names[key]: (names[key], values, _labels(key)) for key, values in grid.items()}
    coordinates["stretch"] = ("sample", stretch, {"long_name": "Sixteenth of the sequence"})
    if own[0] == "block":
        coordinates["block"] = ["first", "second", *drawn]
    reasons = {"reason_text": ("reasons", found["reason_text"].values.astype(np.str_))}
    return xr.Dataset(
        variables | reasons,
        coords=coordinates,
        attrs={
            "title": f"Uncertainty of {rig.title}",
            "rig": rig.title,
            "of": of,
            "uncertain": list(drawn),
            "swept": list(grid),
            "seed": seed,
            "stretches": STRETCHES,
            "source": f"sonolube {__version__}",
        },
    )


def _labels(key: str) -> dict[str, str]:
    name = key.rpartition(".")[2]
    known = {"units": quantity(name).unit or "1", "long_name": quantity(name).meaning} if name in quantities() else {}
    return {"key": key, **known}
