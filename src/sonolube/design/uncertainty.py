"""Uncertainty propagation: distributions of rig-file entries, or draws of an identified structure, through a rig."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube import __version__
from sonolube.checks import Floats
from sonolube.design.parameter_sweep import ProgressCallback, sweep
from sonolube.design.statistics import SUBSEQUENCES, saltelli_sample, sobol_sample
from sonolube.design.sweep_plan import SweepPlan, list_plan
from sonolube.errors import InvalidInput, SonolubeError, UnknownName
from sonolube.identification import Posterior, SingularDirection, posterior
from sonolube.models.friction.models.range_check import OUTSIDE_MODEL_RANGE
from sonolube.rig import NUMBERS, Rig, read_rig
from sonolube.rig.datasets import labels
from sonolube.rig.operating_conditions import REFUSED
from sonolube.rig.operating_point import COMPUTED, ContactPoint, FrictionPoint, WearPoint, contact_point
from sonolube.rig.simulation import friction_point, wear_point
from sonolube.validation.tribometer import (
    tribometer_identification,
    tribometer_model,
    tribometer_problem,
    tribometer_stack,
)
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

_RIGS_PER_CHUNK = 128
_POINT_MODELS: tuple[tuple[Any, Callable[[Rig], Any]], ...] = (
    (FrictionPoint, friction_point),
    (WearPoint, wear_point),
    (ContactPoint, contact_point),
)
_STATUSES = (COMPUTED, REFUSED, OUTSIDE_MODEL_RANGE)
_COMPUTED, _REFUSED, _OUTSIDE = range(3)
_POINTS_PER_REPORT = 64
_NOT_SAMPLED = ("uncertainty", "assumptions")  # tables of the file that a sample does not need


def available_outcomes(rig: Rig) -> tuple[str, ...]:
    """Names of the quantities of a rig through which uncertainty can be propagated.

    Parameters
    ----------
    rig : Rig

    Returns
    -------
    tuple of str
        For a rig with a structure those of its steady vibration first; then those of its friction, wear and contact.
    """
    by_vibration = NUMBERS if rig.structure is not None else ()
    return tuple(dict.fromkeys((*by_vibration, *(name for record, _ in _POINT_MODELS for name in _quantities(record)))))


def propagate(
    rig_file: str | Path | Rig,
    *,
    outcome: str = "friction_ratio",
    samples: int = 1024,
    indices: bool = False,
    over: Mapping[str, ArrayLike] | None = None,
    joint_samples: Mapping[str, Floats] | None = None,
    seed: int = 0,
    changes: Sequence[str] = (),
    folder: str | Path | None = None,
    workers: int = 1,
    advance: ProgressCallback | None = None,
) -> "xr.Dataset":
    r"""Outcome of a rig for samples of its uncertain entries, by inversion of their distribution functions.

    Parameters
    ----------
    rig_file : str, Path or Rig
        With the table `uncertainty`, unless `joint_samples` is given.
    outcome : str
        Quantity of interest, one of `available_outcomes`; it selects the model.
    samples : int
        Least number of samples; rounded up to a power of two.
    indices : bool
        Whether to take the samples of Saltelli's scheme, from which Sobol indices follow: for k uncertain entries
        k + 2 times as many.
    over : mapping of str to array_like, optional
        Values by dotted key at each of which every sample is computed; a key of the table among them is no longer
        uncertain.
    joint_samples : mapping of str to ndarray, shape (n,), optional
        Joint samples by dotted key, such as those of a posterior; they replace the distributions of the table.
    seed : int
        Seed of the sample.
    changes : sequence of str
        Entries of the file to replace first.
    folder : str or Path, optional
        Folder in which finished chunks are stored, so that an interrupted run resumes; for outcomes of the steady
        vibration.
    workers : int
        Number of threads.
    advance : callable, optional
        Called with the number of finished points and their total.

    Returns
    -------
    xarray.Dataset
        Over `sample`, preceded by `block` for indices and followed by the keys of `over`, with the uncertain entries
        and `subsequence` as coordinates, and `status` and `reason` as `sweep` gives them.

    Raises
    ------
    InvalidInput
        If nothing is uncertain, indices are requested together with `over` or `joint_samples`, or samples are fewer
        than 32.
    UnknownName
        If the rig has no such outcome.

    See Also
    --------
    sample_statistics, sobol_indices, sweep

    Notes
    -----
    An entry with the distribution function :math:`F_i`, truncated to the range of its quantity by `Distribution`, is
    sampled at

    .. math:: x_i = F_i^{-1}(u_i)

    with the points :math:`u` of a scrambled Sobol sequence. Entries are independent, but for those of `joint_samples`,
    which share one coordinate of the sequence. A sample without a result keeps its status, and NaN.
    """
    rig = rig_file if isinstance(rig_file, Rig) else read_rig(rig_file, changes=changes)
    if outcome not in available_outcomes(rig):
        raise UnknownName.among(available_outcomes(rig), kind="outcome", name=outcome)
    grid = {key: np.atleast_1d(np.asarray(values)) for key, values in (over or {}).items()}
    if indices and (grid or joint_samples):
        raise InvalidInput("Sobol indices need independent entries and one outcome: leave out over and joint_samples")
    distributions = {
        key: distribution
        for key, distribution in rig.uncertainty.items()
        if key not in grid and key not in (joint_samples or {})
    }
    if not distributions and not joint_samples:
        raise InvalidInput(
            f"{rig.file or rig.title}: the table uncertainty is missing, or names only keys that are swept"
        )
    points, subsequence = (saltelli_sample if indices else sobol_sample)(
        len(distributions) + (0 if joint_samples is None else 1), samples=samples, seed=seed
    )
    sample = {key: distribution.quantile(points[..., i]) for i, (key, distribution) in enumerate(distributions.items())}
    for key, values in (joint_samples or {}).items():
        sample[key] = values[(points[..., -1] * values.size).astype(int)]
    shape = points.shape[:-1] + tuple(values.size for values in grid.values())
    plan = _sample_plan(rig, sample, grid, shape)
    if outcome in NUMBERS and rig.structure is not None:
        chunk_points = _RIGS_PER_CHUNK * int(np.prod(shape[len(points.shape) - 1 :]))
        result = sweep(plan, folder=folder, chunk_points=chunk_points, workers=workers, advance=advance)
    else:
        result = _point_by_point(plan, outcome, advance)
    return _labelled(result, plan, rig, outcome, sample, grid, shape, subsequence, seed)


def _quantities(record: Any) -> list[str]:
    """Fields of a record that are quantities of the vocabulary."""
    return [field.name for field in fields(record) if field.name in quantities()]


def _sample_plan(
    rig: Rig, sample: Mapping[str, Floats], grid: Mapping[str, NDArray[Any]], shape: tuple[int, ...]
) -> SweepPlan:
    """List of points: every sample at every value of the grid."""
    values = {}
    for key, column in sample.items():
        expanded = column.reshape(column.shape + (1,) * (len(shape) - column.ndim))
        values[key] = np.broadcast_to(expanded, shape).ravel()
    for axis, (key, each) in enumerate(reversed(tuple(grid.items()))):
        values[key] = np.broadcast_to(each.reshape(each.shape + (1,) * axis), shape).ravel()
    plan = list_plan(rig, over=values)
    return replace(plan, content={key: part for key, part in plan.content.items() if key not in _NOT_SAMPLED})


def _point_by_point(plan: SweepPlan, outcome: str, advance: ProgressCallback | None) -> "xr.Dataset":
    """Outcome of a model that needs no structure, computed for one point after the other."""
    import xarray as xr

    model = next(model for record, model in _POINT_MODELS if outcome in _quantities(record))
    values, status = np.full(plan.points, np.nan), np.full(plan.points, _COMPUTED, dtype=np.int8)
    reason, texts = np.zeros(plan.points, dtype=np.int32), {"computed": 0}
    for point in range(plan.points):
        row = {key: array[0] for key, array in plan.rows(point, point + 1).items()}
        try:
            result = model(plan.rig(row))
            value = getattr(result, outcome)
            if value is None:
                raise InvalidInput(f"{outcome} cannot be computed: the rig file lacks an entry that it needs")
            values[point] = value
            if np.isnan(value):
                status[point], reason[point] = _OUTSIDE, texts.setdefault(result.reason, len(texts))
        except SonolubeError as refusal:
            status[point], reason[point] = _REFUSED, texts.setdefault(str(refusal), len(texts))
        if advance is not None and not (point + 1) % _POINTS_PER_REPORT:
            advance(point + 1, plan.points)
    flags = {"flag_values": np.arange(len(_STATUSES), dtype=np.int8), "flag_meanings": " ".join(_STATUSES)}
    return xr.Dataset(
        {
            outcome: ("point", values, labels(outcome)),
            "status": ("point", status, flags),
            "reason": ("point", reason),
            "reason_text": ("reasons", np.array(list(texts))),
        }
    )


def _labelled(
    result: "xr.Dataset",
    plan: SweepPlan,
    rig: Rig,
    outcome: str,
    sample: Mapping[str, Floats],
    grid: Mapping[str, NDArray[Any]],
    shape: tuple[int, ...],
    subsequence: NDArray[np.intp],
    seed: int,
) -> "xr.Dataset":
    """Dataset over blocks, samples and swept keys, from the flat results."""
    import xarray as xr

    # an entry that the outcome is called like, such as the stiffness of the contact, by its whole key
    names = {key: key.replace(".", "_") if name == outcome else name for key, name in plan.names.items()}
    sample_dims = ("block", "sample") if len(shape) - len(grid) == 2 else ("sample",)
    dims = (*sample_dims, *(names[key] for key in grid))
    variables = {
        str(name): (dims, array.values.reshape(shape), array.attrs)
        for name, array in result.data_vars.items()
        if name in (outcome, *NUMBERS, "status", "reason")
    }
    coordinates: dict[str, Any] = {names[key]: (sample_dims, column, _labels(key)) for key, column in sample.items()}
    coordinates |= {names[key]: (names[key], values, _labels(key)) for key, values in grid.items()}
    index = {"long_name": "Index of the subsequence of the Sobol sequence"}
    coordinates["subsequence"] = ("sample", subsequence, index)
    if sample_dims[0] == "block":
        coordinates["block"] = ["A", "B", *sample]
    reasons = {"reason_text": ("reasons", result["reason_text"].values.astype(np.str_))}
    return xr.Dataset(
        variables | reasons,
        coords=coordinates,
        attrs={
            "title": f"Uncertainty of {rig.title}",
            "rig": rig.title,
            "outcome": outcome,
            "uncertain": list(sample),
            "swept": list(grid),
            "seed": seed,
            "subsequences": SUBSEQUENCES,
            "source": f"sonolube {__version__}",
        },
    )


def _labels(key: str) -> dict[str, str]:
    """Attributes of the coordinate of a key: key, and unit and meaning where the vocabulary has them."""
    name = key.rpartition(".")[2]
    return {"key": key, **(labels(name) if name in quantities() else {})}


_STACK_FIELDS = 5  # leading fields of a stack that must agree with the tribometer's
_STACK_TOLERANCE = 0.01  # relative


@dataclass(frozen=True, kw_only=True, slots=True)
class IdentifiedStructure:
    """Draws of the parameters of a structure, and the directions in which the facts leave them free.

    Parameters
    ----------
    posterior : Posterior
    unidentifiable_directions : tuple of SingularDirection
    """

    posterior: Posterior
    unidentifiable_directions: tuple[SingularDirection, ...]

    def draws_by_key(self) -> dict[str, Floats]:
        """Draws by the keys of a rig file."""
        return {f"structure.{name}": values for name, values in self.posterior.draws.items()}


def identified_structure(
    rig: Rig, *, seed: int, advance: Callable[[int, int], None] | None = None
) -> IdentifiedStructure:
    """Posterior of the tribometer's masses, springs and dampers, given the published facts that are consistent."""
    stack, expected = rig.stack, astuple(tribometer_stack())[:_STACK_FIELDS]
    if stack is None or not all(
        own == other or (own and other and abs(own / other - 1) < _STACK_TOLERANCE)
        for own, other in zip(astuple(stack)[:_STACK_FIELDS], expected, strict=True)
    ):
        raise InvalidInput(
            f"{rig.file or rig.title}: an identified structure needs the tribometer's stack, which the facts are of"
        )
    identification, bounds = tribometer_identification(seed=seed), tribometer_problem().bounds
    consistent = [fact for fact in identification.facts if fact.name in identification.satisfied]
    drawn = posterior(tribometer_model(), facts=consistent, bounds=bounds, seed=seed, advance=advance)
    return IdentifiedStructure(posterior=drawn, unidentifiable_directions=identification.unidentifiable_directions)
