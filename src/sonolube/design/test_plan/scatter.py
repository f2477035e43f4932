"""Scatter of friction between runs: of a user's own repeats, or of the dissertation's test."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats, Integers
from sonolube.facts.published import column_numbers

if TYPE_CHECKING:
    import xarray as xr

_TABLE: Final = "2.3"
_FEWEST: Final = 3  # degrees of freedom from which repeats give the scatter
_SMALLEST: Final = 1e-30  # of any condition, in SI
_CONDITIONS: Final = ("normal_load", "sliding_speed", "voltage_peak_to_peak", "vibration_amplitude")


@dataclass(frozen=True, kw_only=True, slots=True)
class Scatter:
    """Standard deviations between runs at the same conditions, relative to the friction without vibration.

    Parameters
    ----------
    intrinsic, vibrated : float
        Of the friction force without and with vibration.
    reduction : float
        Of the friction reduction of one run with both states.
    source : str
        Where they come from.
    caveat : str
        What speaks against them; empty where nothing does.
    """

    intrinsic: float
    vibrated: float
    reduction: float
    source: str
    caveat: str = ""


def published_scatter() -> Scatter:
    """Scatter of the steady friction of D Table 2.3, root mean square over its three speeds.

    The scatters there are of the windows of one test. States of one run are taken as independent, so that the
    scatter of the reduction is that of both.
    """
    numbers = [number for _, number in sorted(column_numbers(_TABLE, "friction_force").items())]
    without = np.array([number.value for number in numbers[::2]])
    scatter = np.array([(number.high - number.low) / 2 for number in numbers])
    relative = [scatter[start::2] / without for start in (0, 1)]
    intrinsic, vibrated = (float(np.sqrt(np.mean(each**2))) for each in relative)
    return Scatter(
        intrinsic=intrinsic,
        vibrated=vibrated,
        reduction=float(np.hypot(intrinsic, vibrated)),
        source="D Table 2.3, steady friction at three speeds",
        caveat="the scatter is that of windows within one test (D Table 2.3); between specimens it is usually larger:"
        " give own repeats by --runs, or --scatter",
    )


def assumed_scatter(value: float) -> Scatter:
    """Scatter as a user states it, the same with and without vibration."""
    return Scatter(intrinsic=value, vibrated=value, reduction=float(np.hypot(value, value)), source="as given")


def scatter_of_runs(runs: "xr.Dataset") -> Scatter | None:
    """Scatter of own runs about the means of their conditions.

    None where fewer than four repeats do not give it.
    """
    present = [name for name in _CONDITIONS if name in runs]
    reduction = runs["friction_reduction"].to_numpy()
    stated = np.stack([runs[name].to_numpy() for name in present] or [np.ones(reduction.size)])
    keys = np.round(np.nan_to_num(np.log(np.maximum(stated, _SMALLEST))), 2)
    _, group = np.unique(keys, axis=1, return_inverse=True)
    group = group.ravel()
    free = reduction.size - int(group.max()) - 1
    if free < _FEWEST:
        return None
    both = _within(reduction, group, free)
    forces = both / np.sqrt(2), both / np.sqrt(2)
    if "friction_force" in runs and "intrinsic_friction_force" in runs:
        vibrated, without = (runs[name].to_numpy() for name in ("friction_force", "intrinsic_friction_force"))
        mean = _means(without, group)
        if np.all(np.isfinite(vibrated + mean)):
            forces = _within(without / mean, group, free), _within(vibrated / mean, group, free)
    return Scatter(
        intrinsic=forces[0],
        vibrated=forces[1],
        reduction=both,
        source=f"repeats of the own runs, {free} degrees of freedom",
    )


def _means(values: Floats, group: Integers) -> Floats:
    """Mean of the group of each value."""
    return np.asarray((np.bincount(group, weights=values) / np.bincount(group))[group])


def _within(values: Floats, group: Integers, free: int) -> float:
    """Standard deviation about the means of groups."""
    return float(np.sqrt(np.sum((values - _means(values, group)) ** 2) / free))
