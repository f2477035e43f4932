"""What a sweep runs over: keys of a rig file with their values, on a grid, in a list or drawn."""

import copy
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube import __version__
from sonolube.checks import require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.rig import NUMBERS, Rig, read_rig, rig_content, rig_from
from sonolube.rig.file.uncertainty import number_keys

SETTINGS = {
    "contact.normal_load": require_positive,
    "drive.frequency": require_positive,
    "drive.voltage_offset": require_finite,
    "drive.voltage_peak_to_peak": require_non_negative,
    "sliding.sliding_speed": require_non_negative,
}
"""Keys that leave the rig as it is and only set how it runs, each with the check of its values; the last is fastest."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SweepPlan:
    """Points of a sweep.

    Parameters
    ----------
    content : dict
        The rig's file, as TOML gives it.
    values : dict of str to ndarray
        Values by dotted key, in SI or as text, those of a grid in the order of its axes, the last running fastest.
    grid : bool
        Whether every value meets every other, rather than the values of one row each other.
    """

    content: dict[str, Any]
    values: dict[str, NDArray[Any]]
    grid: bool

    @property
    def shape(self) -> tuple[int, ...]:
        """Points along each axis of the result."""
        sizes = tuple(array.size for array in self.values.values())
        return sizes if self.grid else sizes[:1]

    @property
    def points(self) -> int:
        """How many points there are."""
        return int(np.prod(self.shape))

    @property
    def digest(self) -> str:
        """Fingerprint of the points, the rig and the program."""
        told = json.dumps([__version__, self.content, self.grid, list(self.values)], sort_keys=True, default=str)
        mixed = hashlib.sha256(told.encode())
        for array in self.values.values():
            mixed.update(str(array.dtype).encode() + np.ascontiguousarray(array).tobytes())
        return mixed.hexdigest()

    def rows(self, start: int, stop: int) -> dict[str, NDArray[Any]]:
        """Return the values of the points from one place to before another, by key."""
        places = np.arange(start, stop)
        if not self.grid:
            return {key: array[places] for key, array in self.values.items()}
        indices = np.unravel_index(places, self.shape)
        return {key: array[index] for (key, array), index in zip(self.values.items(), indices, strict=True)}

    def rig(self, changes: Mapping[str, Any]) -> Rig:
        """Return the rig with some entries replaced.

        Raises
        ------
        InvalidInput
            If what comes out is no rig.
        """
        content = copy.deepcopy(self.content)
        for key, value in changes.items():
            *tables, name = key.split(".")
            place = content
            for table in tables:
                place = place.setdefault(table, {})
            place[name] = _as_in_a_file(key, value)
        return rig_from(content)

    @property
    def names(self) -> dict[str, str]:
        """Name of each key in the result: its last word where that is clear."""
        taken, names = {*NUMBERS, "status", "reason"}, {}
        last = [key.rpartition(".")[2] for key in self.values]
        for key, word in zip(self.values, last, strict=True):
            clear = last.count(word) == 1 and word not in taken
            names[key] = word if clear else key.replace(".", "_")
        return names


def grid_plan(rig_file: str | Path, *, over: Mapping[str, ArrayLike], changes: Sequence[str] = ()) -> SweepPlan:
    """Return a sweep in which every value of each key meets every value of the others.

    Parameters
    ----------
    rig_file : str or Path
        The rig.
    over : mapping of str to array_like
        Values by dotted key of the file, numbers in SI, or text.
    changes : sequence of str
        Entries of the file to replace first, such as "drive.frequency=21kHz".

    Returns
    -------
    SweepPlan
        Its axes stand so that points that share a rig, and then a vibration, are neighbours.

    Raises
    ------
    InvalidInput
        If a key is none of a rig file, or no value of it can be had.
    """
    order = [key for key in over if key not in SETTINGS] + [key for key in SETTINGS if key in over]
    return _plan(rig_file, {key: over[key] for key in order}, changes, grid=True)


def list_plan(rig_file: str | Path, *, over: Mapping[str, ArrayLike], changes: Sequence[str] = ()) -> SweepPlan:
    """Return a sweep over rows: the first values of all keys make one point, the second ones another.

    Parameters
    ----------
    rig_file : str or Path
        The rig.
    over : mapping of str to array_like
        Values by dotted key of the file, numbers in SI, or text; as many of each.
    changes : sequence of str
        Entries of the file to replace first.

    Returns
    -------
    SweepPlan

    Raises
    ------
    InvalidInput
        If a key is none of a rig file, no value of it can be had, or there are more values of one than of another.
    """
    return _plan(rig_file, over, changes, grid=False)


def latin_hypercube_plan(
    rig_file: str | Path,
    *,
    over: Mapping[str, tuple[float, float]],
    points: int,
    seed: int = 0,
    changes: Sequence[str] = (),
) -> SweepPlan:
    """Return a sweep over points drawn so that each key's range is covered evenly.

    Parameters
    ----------
    rig_file : str or Path
        The rig.
    over : mapping of str to pair of float
        Lowest and highest value by dotted key, in SI.
    points : int
        How many to draw.
    seed : int
        Of the random numbers; the same seed draws the same points.
    changes : sequence of str
        Entries of the file to replace first.

    Returns
    -------
    SweepPlan

    Raises
    ------
    InvalidInput
        If a key is none of a rig file, or a range is none.

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
    drawn = qmc.LatinHypercube(d=len(over), rng=np.random.default_rng(seed)).random(points)
    spread = {key: low + (high - low) * drawn[:, i] for i, (key, (low, high)) in enumerate(over.items())}
    return _plan(rig_file, spread, changes, grid=False)


def _plan(rig_file: str | Path, over: Mapping[str, ArrayLike], changes: Sequence[str], *, grid: bool) -> SweepPlan:
    if not over:
        raise InvalidInput("a sweep needs a key to run over, such as drive.voltage_peak_to_peak")
    values = {key: np.atleast_1d(np.asarray(array)) for key, array in over.items()}
    read_rig(rig_file, changes=changes)  # refuses a file that is none by its name
    plan = SweepPlan(content=rig_content(rig_file, changes=changes), values=values, grid=grid)
    for key, array in values.items():
        _check_values(plan, key, array)
    if not grid and len({array.size for array in values.values()}) > 1:
        sizes = ", ".join(f"{array.size} of {key}" for key, array in values.items())
        raise InvalidInput(f"a list needs as many values of each key, got {sizes}")
    return plan


def _check_values(plan: SweepPlan, key: str, array: NDArray[Any]) -> None:
    if array.ndim != 1 or not array.size:
        raise InvalidInput(f"{key}: values must be one row of at least one, got shape {array.shape}")
    if key in SETTINGS:
        SETTINGS[key](**{key.rpartition(".")[2]: array})
    refusal = None
    for value in (array[0], array[-1]):
        try:
            plan.rig({key: value})
        except SonolubeError as refused:
            refusal = refused
        else:
            return
    raise InvalidInput(str(refusal))


def _as_in_a_file(key: str, value: Any) -> Any:
    """Return a value in SI as a rig file holds it: text, or a number with its unit."""
    if isinstance(value, str):
        return str(value)
    unit = number_keys()[key].unit if key in number_keys() else ""
    return f"{float(value)!r} {unit}" if unit else float(value)
