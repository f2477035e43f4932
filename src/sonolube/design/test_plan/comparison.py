"""Comparison of friction with and without vibration: replicates, scatter between runs, and order of the runs.

Running-in shifts friction over a run. A run on one pair of bodies is without vibration, with it, and without again, so
that both states have the same mean time: the difference of their means holds nothing of a drift that is linear in time
or distance. Runs on pairs of their own begin with and without vibration in turn.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, Integers, require_positive
from sonolube.errors import InvalidInput
from sonolube.facts.published import column_numbers
from sonolube.measurement.measured_runs import resolution

if TYPE_CHECKING:
    import xarray as xr

_TABLE: Final = "2.3"
_FEWEST: Final = 3  # degrees of freedom from which repeats give the scatter
_NO_SCATTER: Final = 1e-9  # of repeats, that of the arithmetic
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
        " give own repeats, or their scatter",
    )


def assumed_scatter(value: float) -> Scatter:
    """Scatter as a user states it, the same with and without vibration."""
    return Scatter(intrinsic=value, vibrated=value, reduction=float(np.hypot(value, value)), source="as given")


def scatter_of_runs(runs: "xr.Dataset") -> Scatter | None:
    """Scatter of own runs about the means of their conditions, at least that of the digits as they are written.

    None where fewer than four repeats do not give it, or they are equal and no digits are known.
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
    digits = float(np.sqrt(np.mean(resolution(runs) ** 2)))
    if not max(both, digits) > _NO_SCATTER:
        return None
    return Scatter(
        intrinsic=max(forces[0], digits),
        vibrated=max(forces[1], digits),
        reduction=max(both, digits),
        source=f"repeats of the own runs, {free} degrees of freedom",
        caveat=""
        if both >= digits
        else "the own repeats scatter by less than the last digit that is written: that of"
        " the digits is taken, and other specimens usually scatter by more",
    )


def _means(values: Floats, group: Integers) -> Floats:
    """Mean of the group of each value."""
    return np.asarray((np.bincount(group, weights=values) / np.bincount(group))[group])


def _within(values: Floats, group: Integers, free: int) -> float:
    """Standard deviation about the means of groups."""
    return float(np.sqrt(np.sum((values - _means(values, group)) ** 2) / free))


MAX_REPLICATES: Final = 1000
"""Number of replicates beyond which no plan is made."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Comparison:
    """Way to compare friction with and without vibration.

    Parameters
    ----------
    name : str
        As typed.
    title : str
        Name of the test.
    degrees_of_freedom : callable
        Of the number of replicates.
    deviation : callable
        Standard deviation of one difference, relative to the friction without vibration, of a `Scatter`.
    specimens : int
        Pairs of bodies for one replicate.
    """

    name: str
    title: str
    degrees_of_freedom: Callable[[ArrayLike], Floats]
    deviation: Callable[[Scatter], float]
    specimens: int

    def power(
        self, *, difference: ArrayLike, deviation: ArrayLike, replicates: ArrayLike, significance: float
    ) -> Floats:
        r"""Probability that the two-sided t-test finds a difference.

        With n replicates the statistic has Student's noncentral distribution with the noncentrality
        :math:`\sqrt n\, \Delta/s` and n - 1 degrees of freedom where a run has both states (paired), 2 n - 2 where the
        states have runs of their own: there :math:`s^2 = s_0^2 + s_1^2`, and the scatters are taken as equal.

        Source: J. Cohen, Statistical Power Analysis for the Behavioral Sciences, 2nd ed., Erlbaum 1988, chapter 2.
        """
        from scipy.stats import nct, t

        free = self.degrees_of_freedom(replicates)
        noncentrality = np.sqrt(replicates) * np.asarray(difference) / np.asarray(deviation)
        critical = t.isf(significance / 2, free)
        # far from zero the lower tail underflows, and scipy may give NaN for it
        lower = np.nan_to_num(nct.cdf(-critical, free, noncentrality))
        return np.asarray(nct.sf(critical, free, noncentrality) + lower)

    def replicates(self, *, difference: float, deviation: float, power: float, significance: float) -> int:
        """Least number of replicates with which a difference is found with a probability."""
        require_positive(difference=difference, deviation=deviation)
        for name, value in (("power", power), ("significance", significance)):
            if not 0 < value < 1:
                raise InvalidInput(f"{name} must lie between 0 and 1, got {value:g}; usual are 0.8 and 0.05")
        if power <= significance:
            raise InvalidInput(f"power {power:g} must be above the significance {significance:g}")
        counts = np.arange(2, MAX_REPLICATES + 1)
        found = self.power(difference=difference, deviation=deviation, replicates=counts, significance=significance)
        if found[-1] < power:
            raise InvalidInput(
                f"a difference of {difference:g} under a scatter of {deviation:.2g} needs more than {MAX_REPLICATES}"
                f" replicates for a power of {power:g}; show a larger difference or reduce the scatter"
            )
        return int(counts[np.argmax(found >= power)])


COMPARISONS: Final[Mapping[str, Comparison]] = MappingProxyType(
    {
        each.name: each
        for each in (
            Comparison(
                name="paired",
                title="paired t-test, each run without, with and again without vibration",
                degrees_of_freedom=lambda replicates: np.asarray(replicates) - 1.0,
                deviation=lambda scatter: scatter.reduction,
                specimens=1,
            ),
            Comparison(
                name="separate",
                title="two-sample t-test, runs with and without vibration on specimens of their own",
                degrees_of_freedom=lambda replicates: 2.0 * np.asarray(replicates) - 2.0,
                deviation=lambda scatter: float(np.hypot(scatter.intrinsic, scatter.vibrated)),
                specimens=2,
            ),
        )
    }
)
"""Comparisons by name."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Blocking:
    """Conditions that the runs of a block share.

    Parameters
    ----------
    name : str
        As typed.
    title : str
        In the sheet.
    shares_specimens : bool
        Whether the runs of a block are made on the same bodies.
    """

    name: str
    title: str
    shares_specimens: bool


BLOCKINGS: Final[Mapping[str, Blocking]] = MappingProxyType(
    {
        each.name: each
        for each in (
            Blocking(name="day", title="one day, every run on new specimens", shares_specimens=False),
            Blocking(name="pair", title="one pair of pin and disc, cleaned between runs", shares_specimens=True),
        )
    }
)
"""Kinds of blocks, by name."""


INTERLEAVED: Final = (False, True, False)
"""States of the vibration in a run on one pair of bodies, True for on; the middle one lasts twice as long."""


@dataclass(frozen=True, kw_only=True, slots=True)
class RunState:
    """Part of a run without or with vibration.

    Parameters
    ----------
    vibrated : bool
    settling : float
        Time until friction is steady, in s.
    measuring : float
        Time in which friction is measured, in s.
    """

    vibrated: bool
    settling: float
    measuring: float

    @property
    def duration(self) -> float:
        """Duration of the part, in s."""
        return self.settling + self.measuring


@dataclass(frozen=True, kw_only=True, slots=True)
class RunPart:
    """Part of a run on one pair of bodies.

    Parameters
    ----------
    specimen : str
        Pair of bodies.
    vibrated : tuple of bool
        Whether the vibration is on, in each of its states.
    """

    specimen: str
    vibrated: tuple[bool, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class PlannedRun:
    """Run of a plan.

    Parameters
    ----------
    run : int
        Place in the order, from 1.
    block : int
        From 1.
    point : int
        Index of the point of the plan.
    parts : tuple of RunPart
        The one on one pair of bodies, or those without and with vibration in their order.
    """

    run: int
    block: int
    point: int
    parts: tuple[RunPart, ...]

    @property
    def specimens(self) -> tuple[str, ...]:
        """Pairs of bodies, in the order in which they are used."""
        return tuple(part.specimen for part in self.parts)


def randomised_runs(
    points: int, replicates: int, *, blocking: Blocking, specimens: int, seed: int
) -> tuple[PlannedRun, ...]:
    """Runs of a plan in their order: the first point first, then each block has every point once, in random order.

    Source: D. C. Montgomery, Design and Analysis of Experiments, 8th ed., Wiley 2013, chapter 4.
    """
    rng = np.random.default_rng(seed)
    runs: list[PlannedRun] = []
    for block in range(1, replicates + 1):
        order = [int(point) for point in rng.permutation(points)]
        if block == 1:
            order.sort(key=lambda point: point != 0)
        for point in order:
            number = len(runs) + 1
            first = block if blocking.shares_specimens else number
            parts = _separate(first, reverse=block % 2 == 0) if specimens > 1 else _together(first)
            runs.append(PlannedRun(run=number, block=block, point=point, parts=parts))
    return tuple(runs)


def _together(number: int) -> tuple[RunPart, ...]:
    """Both states on one pair of bodies."""
    return (RunPart(specimen=f"{number}", vibrated=INTERLEAVED),)


def _separate(number: int, *, reverse: bool) -> tuple[RunPart, ...]:
    """Each state on a pair of bodies of its own."""
    parts = tuple(
        RunPart(specimen=f"{number}{letter}", vibrated=(vibrated,)) for letter, vibrated in (("a", False), ("b", True))
    )
    return parts[::-1] if reverse else parts
