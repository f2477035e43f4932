"""A space looked over: many choices, each at many frequencies, with what each asks for."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.design.optimisation.assessment import CONSTRAINTS, Assessment, assess
from sonolube.design.optimisation.requirements import OBJECTIVES, Limits
from sonolube.design.optimisation.space import Choice, DesignSpace, Range, rig_of
from sonolube.design.optimisation.target import swings_for_ratio
from sonolube.design.optimisation.tolerance import Tolerance, deviations, over_deviations
from sonolube.errors import SonolubeError
from sonolube.rig import frequency_grid
from sonolube.rig.driven_rig import DrivenRig

Advance = Callable[[int, int], None]

_FREQUENCIES, _CROWDED = 60, 21


@dataclass(frozen=True, kw_only=True, slots=True)
class Task:
    """What is asked of a space.

    Parameters
    ----------
    space : DesignSpace
    friction_ratio : float
        Friction with vibration over friction without, to be had. []
    limits : Limits
    tolerance : Tolerance or None
        For which deviations it must be had.
    """

    space: DesignSpace
    friction_ratio: float
    limits: Limits = field(default_factory=Limits)
    tolerance: Tolerance | None = None


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Landscape:
    """Designs as columns, each array of one length.

    Parameters
    ----------
    choices : tuple of Choice
    which : ndarray of int
        Place of each design's choice among them.
    frequency : ndarray
        Frequency of the drive. [Hz]
    voltage_peak_to_peak : ndarray
        Swing that brings friction down as wanted; NaN where none does. [V]
    objectives : dict of str to ndarray
        By the names of `OBJECTIVES`.
    usage : dict of str to ndarray
        Share of each limit used, by the names of `CONSTRAINTS`.
    refused : dict of str to str
        Actuators that make no rig, and why.
    """

    choices: tuple[Choice, ...]
    which: NDArray[np.intp]
    frequency: Floats
    voltage_peak_to_peak: Floats
    objectives: dict[str, Floats]
    usage: dict[str, Floats]
    refused: dict[str, str]

    @property
    def most_used(self) -> Floats:
        """Largest share of any limit that each design uses."""
        return np.asarray(np.max(np.stack(list(self.usage.values())), axis=0))

    @property
    def feasible(self) -> NDArray[np.bool_]:
        """Which designs have a voltage and break no limit."""
        return np.isfinite(self.voltage_peak_to_peak) & (self.most_used <= 1)


def choices_of(space: DesignSpace, *, samples: int, seed: int = 0) -> tuple[Choice, ...]:
    """Return every actuator with every waveform, and entries drawn evenly from their ranges.

    Parameters
    ----------
    space : DesignSpace
    samples : int
        Entries to draw for each, where there are ranges; they spread evenly in ratio, both ends of each among them.
    seed : int
        Of the random numbers.

    Returns
    -------
    tuple of Choice
    """
    rows = drawn(space.ranges, samples=samples, seed=seed) if space.ranges else np.empty((1, 0))
    return tuple(
        Choice(actuator=actuator, waveform=waveform, entries=dict(zip(space.ranges, map(float, row), strict=True)))
        for actuator in space.actuators
        for waveform in space.waveforms
        for row in rows
    )


def drawn(ranges: Mapping[str, Range], *, samples: int, seed: int = 0) -> Floats:
    """Return rows of values drawn evenly in ratio from ranges, their corners first."""
    from scipy.stats import qmc

    bounds = np.log(np.array(list(ranges.values())))
    count = len(bounds)
    corners = np.array(np.meshgrid(*[[0.0, 1.0]] * count, indexing="ij")).reshape(count, -1).T
    inside = qmc.Sobol(d=count, rng=np.random.default_rng(seed)).random_base2(max(1, int(np.ceil(np.log2(samples)))))
    return np.asarray(np.exp(bounds[:, 0] + np.vstack([corners, inside]) * (bounds[:, 1] - bounds[:, 0])))


def looked_over(task: Task, choices: tuple[Choice, ...], *, advance: Advance | None = None) -> Landscape:
    """Return what every choice asks for at many frequencies, crowded at its resonances.

    Parameters
    ----------
    task : Task
    choices : tuple of Choice
    advance : callable, optional
        Told how many choices are done, and of how many.

    Returns
    -------
    Landscape
    """
    parts, refused = [], {}
    for place, choice in enumerate(choices):
        if choice.actuator not in refused:
            try:
                parts.append((place, *of_choice(task, choice)))
            except SonolubeError as refusal:
                refused[choice.actuator] = str(refusal)
        if advance is not None:
            advance(place + 1, len(choices))
    which = [np.full(frequency.size, place) for place, frequency, _ in parts]
    found = [assessed for *_, assessed in parts]
    return Landscape(
        choices=choices,
        which=np.concatenate([*which, np.zeros(0, dtype=np.intp)]).astype(np.intp),
        frequency=np.concatenate([*[frequency for _, frequency, _ in parts], np.zeros(0)]),
        voltage_peak_to_peak=_joined([part.voltage_peak_to_peak for part in found]),
        objectives={name: _joined([part.objectives[name] for part in found]) for name in OBJECTIVES},
        usage={name: _joined([part.usage[name] for part in found]) for name in CONSTRAINTS},
        refused=refused,
    )


def of_choice(task: Task, choice: Choice, *, frequency: Floats | None = None) -> tuple[Floats, Assessment]:
    """Return frequencies, and what one choice asks for at each of them, the worst of its deviations.

    Parameters
    ----------
    task : Task
    choice : Choice
    frequency : ndarray, optional
        Frequencies of the drive; many over the whole range where absent. [Hz]

    Returns
    -------
    tuple of ndarray and Assessment

    Raises
    ------
    InvalidInput
        If the choice makes no rig.
    """
    rigs = [rig_of(task.space, choice, deviation) for deviation in deviations(task.tolerance)]
    f = _grid(rigs[0], task) if frequency is None else frequency
    needed = np.stack(
        [swings_for_ratio(rig, task.limits, frequency=f, friction_ratio=task.friction_ratio) for rig in rigs]
    )
    volts = over_deviations(np.where(np.isnan(needed), np.inf, needed), task.tolerance)
    return f, worst_of(task, rigs, frequency=f, voltage_peak_to_peak=np.where(np.isinf(volts), np.nan, volts))


def worst_of(task: Task, rigs: list[DrivenRig], *, frequency: Floats, voltage_peak_to_peak: Floats) -> Assessment:
    """Return what drives ask of a rig and its deviations, at worst or at the quantile.

    Parameters
    ----------
    task : Task
    rigs : list of DrivenRig
        The one drawn first.
    frequency : ndarray, shape (n,)
        Frequency of each drive. [Hz]
    voltage_peak_to_peak : ndarray, shape (n,)
        Swing of each; NaN where none gives the friction. [V]

    Returns
    -------
    Assessment
        Of the numbers, those of the rig as drawn.
    """
    known = np.isfinite(voltage_peak_to_peak)
    if not known.any():
        nothing = np.full(frequency.shape, np.inf)
        return Assessment(
            voltage_peak_to_peak=voltage_peak_to_peak,
            objectives=dict.fromkeys(OBJECTIVES, nothing),
            usage=dict.fromkeys(CONSTRAINTS, nothing),
            numbers={},
        )
    parts = [
        assess(
            rig,
            task.limits,
            frequency=frequency[known],
            voltage_peak_to_peak=voltage_peak_to_peak[known],
            bolt=task.space.bolt,
        )
        for rig in rigs
    ]

    def spread(values: Floats) -> Floats:
        whole = np.full(frequency.shape, np.inf)
        whole[known] = values
        return whole

    def worst(of: Callable[[Assessment], Floats]) -> Floats:
        return spread(over_deviations(np.stack([of(part) for part in parts]), task.tolerance))

    return Assessment(
        voltage_peak_to_peak=voltage_peak_to_peak,
        objectives={name: worst(lambda part, name=name: part.objectives[name]) for name in OBJECTIVES},  # type: ignore[misc]
        usage={name: worst(lambda part, name=name: part.usage[name]) for name in CONSTRAINTS},  # type: ignore[misc]
        numbers={name: spread(values) for name, values in parts[0].numbers.items()},
    )


def _grid(rig: DrivenRig, task: Task) -> Floats:
    low, high = task.space.frequencies
    return frequency_grid(rig, lowest=low, highest=high, points=_FREQUENCIES, resonance_points=_CROWDED)


def _joined(parts: list[Floats]) -> Floats:
    return np.concatenate([*parts, np.zeros(0)])
