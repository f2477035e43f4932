"""Designs that reach a reduction of friction with a chance, by the distribution that `predict` has of the friction.

The friction model of a rig falls with the amplitude, as the chance of a reduction rises with it, so that a chance is
reached where the model has a lower ratio than the target: that of the least amplitude with the chance.
"""

from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Final, TypedDict, Unpack

import numpy as np

from sonolube.design.optimisation.evaluation import maximum_swing
from sonolube.design.optimisation.optimum import Optimum, optimise
from sonolube.design.optimisation.screening import DesignProblem
from sonolube.design.parameter_sweep import ProgressCallback
from sonolube.errors import OutsideRange, SonolubeError
from sonolube.prediction.chances import ReductionChances, odds_text, reduction_chances
from sonolube.prediction.evidence_posterior import EvidencePosterior
from sonolube.rig import Rig, friction_point, point_batch
from sonolube.rig.driven_rig import DrivenRig, driven_rig
from sonolube.text.units import format_si

if TYPE_CHECKING:
    import xarray as xr

_ROUNDS: Final = 4  # of moving the target of the friction model
_ENOUGH: Final = 0.005  # by which the chance of the best design may be lower
_HIGHEST_AMPLITUDE: Final = 1e-4  # m
_FREQUENCIES: Final = 41  # at which the highest chance is sought


class Searched(TypedDict, total=False):
    """Arguments of `optimise` beside the problem."""

    minimise: str
    second_objective: str | None
    samples: int
    advance: ProgressCallback | None


@dataclass(frozen=True, kw_only=True, slots=True)
class ReachedChance:
    """Chance that a design reaches a reduction, and what it makes of friction.

    Parameters
    ----------
    friction_reduction : float
        Target. []
    chance : float
        That it is reached.
    low, median, high : float
        Friction ratio of the design: median, and ends of the 80 % interval.
    wanted : float or None
        Chance that was asked for.
    caveats : tuple of str
        Own published tests that it was learned from too.
    """

    friction_reduction: float
    chance: float
    low: float
    median: float
    high: float
    wanted: float | None = None
    caveats: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """Chance and interval in words."""
        return (
            f"{100 * self.friction_reduction:.3g} % less friction with {odds_text(self.chance)}; friction ratio"
            f" {self.median:.2g}, {self.low:.2g} to {self.high:.2g} (80 %, `sonolube predict`)"
        )


def reached_chance(
    optimum: Optimum, chances: ReductionChances, *, friction_reduction: float, wanted: float | None = None
) -> ReachedChance:
    """Chance of a reduction by the best design of an optimum."""
    best = optimum.best
    at = {
        "vibration_amplitude": float(best.evaluation.quantities["vibration_amplitude"][0]),
        "frequency": best.frequency,
    }
    low, median, high = chances.interval(**at)
    chance = float(chances.of(friction_reduction, **at))
    return ReachedChance(
        friction_reduction=friction_reduction,
        chance=chance,
        low=low,
        median=median,
        high=high,
        wanted=wanted,
        caveats=chances.caveats,
    )


def computed_chances(
    rig: Rig, *, runs: "xr.Dataset | None" = None, evidence: EvidencePosterior | None = None
) -> ReductionChances:
    """Chances of a rig whose amplitude is that of its structure, as that of all designs is."""
    return reduction_chances(replace(driven_rig(rig), amplitude_source="computed"), runs=runs, evidence=evidence)


def optimum_with_chance(
    problem: DesignProblem,
    rig: Rig,
    *,
    confidence: float | None,
    runs: "xr.Dataset | None" = None,
    evidence: EvidencePosterior | None = None,
    **searched: Unpack["Searched"],
) -> tuple[Optimum, ReachedChance | None]:
    """Best designs for the friction ratio of a problem, and the chance that the best of them reaches it.

    Parameters
    ----------
    problem : DesignProblem
    rig : Rig
        That of the problem.
    confidence : float or None
        Chance with which the ratio is to be reached, by `confident_optimum`; that of the friction model alone where
        None.
    runs : xarray.Dataset, optional
        Own measured runs, as `predict` takes them.
    evidence : EvidencePosterior, optional
        Posterior by own published tests too, in place of the shipped one.
    searched : Searched
        Arguments of `optimise`.

    Returns
    -------
    Optimum
    ReachedChance or None
        None where no confidence is wanted and the chance is not known, as of a lubricated contact.

    Raises
    ------
    InvalidInput
        If a confidence is wanted, or runs or evidence are given, and nothing can be predicted of the rig.
    OutsideRange
        If no design reaches the ratio, or none with the chance.
    """
    reduction = 1 - problem.friction_ratio
    try:
        chances = computed_chances(rig, runs=runs, evidence=evidence)
    except SonolubeError:
        if not (confidence is None and runs is None and evidence is None):
            raise
        return optimise(problem, **searched), None
    if confidence is not None:
        return confident_optimum(problem, chances, friction_reduction=reduction, confidence=confidence, **searched)
    found = optimise(problem, **searched)
    return found, reached_chance(found, chances, friction_reduction=reduction)


def confident_optimum(
    problem: DesignProblem,
    chances: ReductionChances,
    *,
    friction_reduction: float,
    confidence: float,
    **searched: Unpack["Searched"],
) -> tuple[Optimum, ReachedChance]:
    """Best designs that reach a reduction with a chance, as `optimise` finds them for a friction ratio.

    Parameters
    ----------
    problem : DesignProblem
        Whose friction ratio is replaced.
    chances : ReductionChances
        Of its rig with a computed amplitude.
    friction_reduction : float
        Target. []
    confidence : float
        Chance with which it is to be reached.
    searched : Searched
        Arguments of `optimise`.

    Returns
    -------
    Optimum
    ReachedChance
        Of its best design.

    Raises
    ------
    OutsideRange
        If no voltage within the limits gives the chance; the message has the highest one.
    """
    frequency = problem.space.rig.drive.frequency
    model_ratio = problem.friction_ratio
    for _ in range(_ROUNDS):
        amplitude = chances.least_amplitude(
            friction_reduction, confidence=confidence, highest=_HIGHEST_AMPLITUDE, frequency=frequency
        )
        if amplitude is None:
            break
        model_ratio = min(model_ratio, _model_ratio(problem.space.rig, amplitude=amplitude, frequency=frequency))
        try:
            found = optimise(replace(problem, friction_ratio=model_ratio), **searched)
        except OutsideRange:
            break
        reached = reached_chance(found, chances, friction_reduction=friction_reduction, wanted=confidence)
        if reached.chance >= confidence - _ENOUGH:
            return found, reached
        frequency, model_ratio = found.best.frequency, 0.97 * model_ratio
    raise OutsideRange(_out_of_reach(problem, chances, friction_reduction=friction_reduction, confidence=confidence))


def _model_ratio(rig: DrivenRig, *, amplitude: float, frequency: float) -> float:
    """Friction ratio by the rig's model under a sine of an amplitude."""
    shared = {field.name: getattr(rig, field.name) for field in fields(rig) if field.init}
    stated = {"structure": None, "stack": None, "amplitude_source": "measured", "vibration_amplitude": amplitude}
    drive = replace(rig.drive, voltage_peak_to_peak=None, voltage_offset=0.0)
    point = friction_point(
        replace(Rig(**shared | stated | {"drive": drive}), drive=replace(drive, frequency=frequency))
    )
    return float(point.friction_ratio)


def _out_of_reach(
    problem: DesignProblem, chances: ReductionChances, *, friction_reduction: float, confidence: float
) -> str:
    """Message with the highest chance that any voltage within the limits gives to the rig's own drive."""
    rig = replace(problem.space.rig, amplitude_source="computed")
    highest = maximum_swing(rig, problem.limits)
    f = np.linspace(*problem.space.frequencies, _FREQUENCIES)
    volts = np.full(f.shape, highest)
    points = point_batch(rig, frequency=f, voltage_peak_to_peak=volts, voltage_offset=rig.drive.offset_ratio * volts)
    amplitude = points.numbers["vibration_amplitude"]
    best = float(np.nanmax(chances.of(friction_reduction, vibration_amplitude=amplitude, frequency=f), initial=0.0))
    runs = "one run of your own would tell" if not chances.runs else "a further run would tell more"
    return (
        f"out of reach: {100 * friction_reduction:.3g} % less friction with {odds_text(confidence)}; no voltage up to"
        f" {format_si(highest, 'V')} peak to peak gives the rig's own drive more than {odds_text(best)};"
        f" {runs}"
    )
