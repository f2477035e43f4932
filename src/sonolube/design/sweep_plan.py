"""Design of experiments over rig-file keys: full factorial grids, lists of points and Latin hypercube samples."""

import copy
import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube import __version__
from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.rig import NUMBERS, Rig, read_rig, rig_from
from sonolube.rig.file.entries import set_entry
from sonolube.rig.file.toml_file import number_keys

OPERATING_CONDITIONS: Mapping[str, Callable[..., Floats]] = {
    "contact.normal_load": require_positive,
    "drive.frequency": require_positive,
    "drive.voltage_offset": require_finite,
    "drive.voltage_peak_to_peak": require_non_negative,
    "sliding.sliding_speed": require_non_negative,
}
"""Keys of a rig file that set the operating condition but not the rig, each with the check of its values.

Points that differ in these alone are computed as one batch. The last key is the innermost axis of a grid.
"""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SweepPlan:
    """Points of a sweep: a rig file and the values that replace some of its entries.

    Parameters
    ----------
    content : dict
        Content of the rig file as parsed from TOML.
    values : dict of str to ndarray, shape (n,)
        Values by dotted key, numbers in SI or text; for a grid in the order of its axes, the last one innermost.
    grid : bool
        True for the full factorial design of all values, False for one point per row of values.
    """

    content: dict[str, Any]
    values: dict[str, NDArray[Any]]
    grid: bool

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of points along each dimension of the result."""
        sizes = tuple(array.size for array in self.values.values())
        return sizes if self.grid else sizes[:1]

    @property
    def points(self) -> int:
        """Total number of points."""
        return int(np.prod(self.shape))

    @property
    def digest(self) -> str:
        """SHA-256 digest of the program version, the rig file and all values, in hexadecimal."""
        identity = json.dumps([__version__, self.content, self.grid, list(self.values)], sort_keys=True, default=str)
        digest = hashlib.sha256(identity.encode())
        for array in self.values.values():
            digest.update(str(array.dtype).encode() + np.ascontiguousarray(array).tobytes())
        return digest.hexdigest()

    def rows(self, start: int, stop: int) -> dict[str, NDArray[Any]]:
        """Values by key at the points from flat index `start` to before `stop`."""
        points = np.arange(start, stop)
        if not self.grid:
            return {key: array[points] for key, array in self.values.items()}
        indices = np.unravel_index(points, self.shape)
        return {key: array[index] for (key, array), index in zip(self.values.items(), indices, strict=True)}

    def rig(self, changes: Mapping[str, Any]) -> Rig:
        """Rig of the file with some of its entries replaced.

        Raises
        ------
        InvalidInput
            If the changed file does not describe a rig.
        """
        content = copy.deepcopy(self.content)
        for key, value in changes.items():
            set_entry(content, key, _file_value(key, value))
        return rig_from(content)

    def own_rig(self) -> Rig | None:
        """Rig of the file as it stands; None where the file describes one only with the swept values."""
        try:
            return self.rig({})
        except SonolubeError:
            return None

    @property
    def names(self) -> dict[str, str]:
        """Name of each key in the resulting dataset: its last word, or the whole key where that is ambiguous."""
        reserved, names = {*NUMBERS, "status", "reason"}, {}
        last_words = [key.rpartition(".")[2] for key in self.values]
        for key, word in zip(self.values, last_words, strict=True):
            unambiguous = last_words.count(word) == 1 and word not in reserved
            names[key] = word if unambiguous else key.replace(".", "_")
        return names


def grid_plan(rig_file: str | Path | Rig, *, over: Mapping[str, ArrayLike], changes: Sequence[str] = ()) -> SweepPlan:
    """Full factorial design: every value of each key is combined with every value of the others.

    Parameters
    ----------
    rig_file : str, Path or Rig
    over : mapping of str to array_like, shape (n,)
        Values by dotted key of the file, numbers in SI or text.
    changes : sequence of str
        Entries of the file to replace first, such as "drive.frequency=21kHz".

    Returns
    -------
    SweepPlan
        With its axes ordered so that points of one rig, and of one vibration, are contiguous.

    Raises
    ------
    InvalidInput
        If a key is unknown to rig files, or neither its first nor its last value gives a rig.

    See Also
    --------
    list_plan, latin_hypercube_plan

    Examples
    --------
    >>> from sonolube.design import grid_plan
    >>> over = {"drive.voltage_peak_to_peak": [7.0, 14.0, 28.0], "contact.normal_load": [3.0, 5.0]}
    >>> plan = grid_plan("examples/rigs/tribometer.toml", over=over)
    >>> plan.shape, plan.points
    ((2, 3), 6)
    """
    order = [key for key in over if key not in OPERATING_CONDITIONS] + [
        key for key in OPERATING_CONDITIONS if key in over
    ]
    return _validated_plan(rig_file, {key: over[key] for key in order}, changes, grid=True)


def list_plan(rig_file: str | Path | Rig, *, over: Mapping[str, ArrayLike], changes: Sequence[str] = ()) -> SweepPlan:
    """List of points: the i-th values of all keys make the i-th point.

    Parameters
    ----------
    rig_file : str, Path or Rig
    over : mapping of str to array_like, shape (n,)
        Values by dotted key of the file, numbers in SI or text; the same number of each.
    changes : sequence of str
        Entries of the file to replace first.

    Returns
    -------
    SweepPlan

    Raises
    ------
    InvalidInput
        If a key is unknown to rig files, neither its first nor its last value gives a rig, or the numbers of values
        differ.

    See Also
    --------
    grid_plan, latin_hypercube_plan
    """
    return _validated_plan(rig_file, over, changes, grid=False)


def latin_hypercube_plan(
    rig_file: str | Path | Rig,
    *,
    over: Mapping[str, tuple[float, float]],
    points: int,
    seed: int = 0,
    changes: Sequence[str] = (),
) -> SweepPlan:
    """Latin hypercube sample: random points of which one lies in each of n equal intervals of every key.

    Parameters
    ----------
    rig_file : str, Path or Rig
    over : mapping of str to pair of float
        Lowest and highest value by dotted key, in SI.
    points : int
        Number of points n.
    seed : int
        Seed of the random numbers; the same seed gives the same points.
    changes : sequence of str
        Entries of the file to replace first.

    Returns
    -------
    SweepPlan

    Raises
    ------
    InvalidInput
        If a key is unknown to rig files, a range is empty, or there are no points.

    See Also
    --------
    grid_plan, list_plan

    References
    ----------
    .. [1] M. D. McKay, R. J. Beckman, W. J. Conover, Technometrics 21, 239 (1979). doi:10.1080/00401706.1979.10489755
    """
    from scipy.stats import qmc

    if points < 1:
        raise InvalidInput(f"points must be at least 1, got {points}")
    for key, (lowest, highest) in over.items():
        if not lowest < highest:
            raise InvalidInput(f"{key}: the lowest value, {lowest:g}, must lie below the highest, {highest:g}")
    sample = qmc.LatinHypercube(d=len(over), rng=np.random.default_rng(seed)).random(points)
    values = {key: low + (high - low) * sample[:, i] for i, (key, (low, high)) in enumerate(over.items())}
    return _validated_plan(rig_file, values, changes, grid=False)


def _validated_plan(
    rig_file: str | Path | Rig, over: Mapping[str, ArrayLike], changes: Sequence[str], *, grid: bool
) -> SweepPlan:
    """Plan whose rig file, keys and values have been checked."""
    if not over:
        raise InvalidInput("a sweep needs at least one key to vary, such as drive.voltage_peak_to_peak")
    values = {key: np.atleast_1d(np.asarray(array)) for key, array in over.items()}
    plan = SweepPlan(content=_content(rig_file, changes), values=values, grid=grid)
    for key, array in values.items():
        _check_values(plan, key, array)
    if not grid and len({array.size for array in values.values()}) > 1:
        sizes = ", ".join(f"{array.size} of {key}" for key, array in values.items())
        raise InvalidInput(f"a list of points needs the same number of values of each key, got {sizes}")
    return plan


def _content(rig_file: str | Path | Rig, changes: Sequence[str]) -> dict[str, Any]:
    """Content of the file of a rig."""
    if isinstance(rig_file, Rig):
        return rig_file.content()
    return read_rig(rig_file, changes=changes).content()  # errors in the file itself name the file


def _check_values(plan: SweepPlan, key: str, array: NDArray[Any]) -> None:
    """Raise if the values of a key are not one row, or neither the first nor the last gives a rig."""
    if array.ndim != 1 or not array.size:
        raise InvalidInput(f"{key}: values must have one axis and at least one entry, got shape {array.shape}")
    if key in OPERATING_CONDITIONS:
        OPERATING_CONDITIONS[key](**{key.rpartition(".")[2]: array})
    error = None
    for value in (array[0], array[-1]):
        try:
            plan.rig({key: value})
        except SonolubeError as refused:
            error = refused
        else:
            return
    raise InvalidInput(str(error))


def _file_value(key: str, value: Any) -> Any:
    """Value in SI as a rig file holds it: text, or a number with its unit."""
    if isinstance(value, str):
        return str(value)
    unit = number_keys()[key].unit if key in number_keys() else ""
    return f"{float(value)!r} {unit}" if unit else float(value)
