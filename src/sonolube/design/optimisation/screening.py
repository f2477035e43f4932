"""Screening of a design space: objectives and constraints of many candidates at many drive frequencies."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.checks import Floats
from sonolube.design.optimisation.evaluation import (
    CONSTRAINTS,
    Evaluation,
    estimate_swings,
    evaluate,
    maximum_swing,
    refine_swing,
)
from sonolube.design.optimisation.requirements import OBJECTIVES, Limits, Tolerance, deviations, worst_or_quantile
from sonolube.design.optimisation.space import Candidate, DesignSpace, Range, candidate_rig
from sonolube.design.parameter_sweep import ProgressCallback
from sonolube.errors import SonolubeError
from sonolube.rig import frequency_grid
from sonolube.rig.driven_rig import DrivenRig
from sonolube.rig.record import Rig

_FREQUENCIES, _RESONANCE_FREQUENCIES = 60, 21


@dataclass(frozen=True, kw_only=True, slots=True)
class DesignProblem:
    """Optimisation problem: a design space, the target friction ratio, limits and tolerances.

    Parameters
    ----------
    space : DesignSpace
    friction_ratio : float
        Target of friction with vibration over friction without. []
    limits : Limits
    tolerance : Tolerance or None
        Manufacturing tolerance at which the target must be reached; None for the nominal design.
    """

    space: DesignSpace
    friction_ratio: float
    limits: Limits = field(default_factory=Limits)
    tolerance: Tolerance | None = None

    def evaluated(self, rig: Rig, *, frequency: ArrayLike, voltage_peak_to_peak: ArrayLike) -> Evaluation:
        """Objectives and constraints of several drives of a rig under the limits of the problem."""
        return evaluate(
            rig, self.limits, frequency=frequency, voltage_peak_to_peak=voltage_peak_to_peak, bolt=self.space.bolt
        )

    def required_swing(self, rig: Rig, *, frequency: float, near: float | None = None) -> float:
        """Peak-to-peak voltage for the target friction ratio, NaN where none reaches it, from a first estimate. [V]"""
        highest = maximum_swing(rig, self.limits)
        start = 0.3 * highest if near is None else near
        return refine_swing(rig, frequency=frequency, friction_ratio=self.friction_ratio, near=start, highest=highest)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ScreeningResult:
    """Screened designs as columns, each a candidate at a drive frequency; every array has one entry per design.

    Parameters
    ----------
    candidates : tuple of Candidate
    candidate_index : ndarray of int, shape (n,)
        Index of the candidate of each design.
    frequency : ndarray, shape (n,)
        Drive frequency. [Hz]
    voltage_peak_to_peak : ndarray, shape (n,)
        Drive voltage for the target friction ratio; NaN where none reaches it. [V]
    objectives : dict of str to ndarray
        By the names of `OBJECTIVES`, in W, W and V.
    utilisation : dict of str to ndarray
        Demand over limit by the names of `CONSTRAINTS`.
    refused : dict of str to str
        Reason by actuator that cannot be used.
    """

    candidates: tuple[Candidate, ...]
    candidate_index: NDArray[np.intp]
    frequency: Floats
    voltage_peak_to_peak: Floats
    objectives: dict[str, Floats]
    utilisation: dict[str, Floats]
    refused: dict[str, str]

    @property
    def maximum_utilisation(self) -> Floats:
        """Largest utilisation of any constraint by each design."""
        return np.asarray(np.max(np.stack(list(self.utilisation.values())), axis=0))

    @property
    def feasible(self) -> NDArray[np.bool_]:
        """Which designs reach the target and violate no constraint."""
        return np.isfinite(self.voltage_peak_to_peak) & (self.maximum_utilisation <= 1)


def enumerate_candidates(space: DesignSpace, *, samples: int, seed: int = 0) -> tuple[Candidate, ...]:
    """Candidates of a space: every actuator with every waveform and every sampled structure.

    Parameters
    ----------
    space : DesignSpace
    samples : int
        Least number of structures sampled inside the ranges, rounded up to a power of two; the corners of the ranges
        are added.
    seed : int
        Seed of the sample.

    Returns
    -------
    tuple of Candidate

    See Also
    --------
    sample_ranges
    """
    rows = sample_ranges(space.ranges, samples=samples, seed=seed) if space.ranges else np.empty((1, 0))
    return tuple(
        Candidate(actuator=actuator, waveform=waveform, entries=dict(zip(space.ranges, map(float, row), strict=True)))
        for actuator in space.actuators
        for waveform in space.waveforms
        for row in rows
    )


def sample_ranges(ranges: Mapping[str, Range], *, samples: int, seed: int = 0) -> Floats:
    """Corners of ranges and a scrambled Sobol sample inside them, uniform in the logarithm.

    Shape (points, variables). The corners first.
    """
    from scipy.stats import qmc

    bounds = np.log(np.array(list(ranges.values())))
    count = len(bounds)
    corners = np.array(np.meshgrid(*[[0.0, 1.0]] * count, indexing="ij")).reshape(count, -1).T
    inside = qmc.Sobol(d=count, rng=np.random.default_rng(seed)).random_base2(max(1, int(np.ceil(np.log2(samples)))))
    return np.asarray(np.exp(bounds[:, 0] + np.vstack([corners, inside]) * (bounds[:, 1] - bounds[:, 0])))


def screen(
    problem: DesignProblem, candidates: tuple[Candidate, ...], *, advance: ProgressCallback | None = None
) -> ScreeningResult:
    """Objectives and constraints of every candidate over the frequency range, with a finer grid at its resonances.

    Parameters
    ----------
    problem : DesignProblem
    candidates : tuple of Candidate
    advance : callable, optional
        Called with the number of finished candidates and their total.

    Returns
    -------
    ScreeningResult

    See Also
    --------
    enumerate_candidates, evaluate_candidate, optimise
    """
    parts, refused = [], {}
    for index, candidate in enumerate(candidates):
        if candidate.actuator not in refused:
            try:
                parts.append((index, *evaluate_candidate(problem, candidate)))
            except SonolubeError as refusal:
                refused[candidate.actuator] = str(refusal)
        if advance is not None:
            advance(index + 1, len(candidates))
    indices = [np.full(frequency.size, index) for index, frequency, _ in parts]
    evaluations = [evaluation for *_, evaluation in parts]
    return ScreeningResult(
        candidates=candidates,
        candidate_index=np.concatenate([*indices, np.zeros(0, dtype=np.intp)]).astype(np.intp),
        frequency=_concatenated([frequency for _, frequency, _ in parts]),
        voltage_peak_to_peak=_concatenated([each.voltage_peak_to_peak for each in evaluations]),
        objectives={name: _concatenated([each.objectives[name] for each in evaluations]) for name in OBJECTIVES},
        utilisation={name: _concatenated([each.utilisation[name] for each in evaluations]) for name in CONSTRAINTS},
        refused=refused,
    )


def evaluate_candidate(
    problem: DesignProblem, candidate: Candidate, *, frequency: Floats | None = None
) -> tuple[Floats, Evaluation]:
    """Evaluation of a candidate over drive frequencies, each at the voltage for the target friction ratio.

    Parameters
    ----------
    problem : DesignProblem
    candidate : Candidate
    frequency : ndarray, shape (n,), optional
        Drive frequencies; where absent a grid over the whole range, finer at the resonances. [Hz]

    Returns
    -------
    tuple of ndarray and Evaluation
        Frequencies, and the worst case or quantile over the deviations.

    Raises
    ------
    SonolubeError
        If the candidate does not make a rig.
    """
    rigs = [candidate_rig(problem.space, candidate, deviation) for deviation in deviations(problem.tolerance)]
    f = _default_frequencies(rigs[0], problem) if frequency is None else frequency
    swings = np.stack(
        [estimate_swings(rig, problem.limits, frequency=f, friction_ratio=problem.friction_ratio) for rig in rigs]
    )
    volts = worst_or_quantile(np.where(np.isnan(swings), np.inf, swings), problem.tolerance)
    volts = np.where(np.isinf(volts), np.nan, volts)
    return f, evaluate_with_tolerance(problem, rigs, frequency=f, voltage_peak_to_peak=volts)


def evaluate_with_tolerance(
    problem: DesignProblem, rigs: list[DrivenRig], *, frequency: Floats, voltage_peak_to_peak: Floats
) -> Evaluation:
    """Worst case or quantile of objectives and utilisation over a rig and its deviations.

    Parameters
    ----------
    problem : DesignProblem
    rigs : list of DrivenRig
        By the deviations of `deviations`, the nominal one first.
    frequency : ndarray, shape (n,)
        Drive frequencies. [Hz]
    voltage_peak_to_peak : ndarray, shape (n,)
        Drive voltages; NaN where none reaches the target. [V]

    Returns
    -------
    Evaluation
        Infinite without a voltage; its `quantities` are those of the nominal rig.
    """
    reached = np.isfinite(voltage_peak_to_peak)
    if not reached.any():
        infinite = np.full(frequency.shape, np.inf)
        return Evaluation(
            voltage_peak_to_peak=voltage_peak_to_peak,
            objectives=dict.fromkeys(OBJECTIVES, infinite),
            utilisation=dict.fromkeys(CONSTRAINTS, infinite),
            quantities={},
        )
    evaluations = [
        problem.evaluated(rig, frequency=frequency[reached], voltage_peak_to_peak=voltage_peak_to_peak[reached])
        for rig in rigs
    ]

    def expanded(values: Floats) -> Floats:
        """Values of all designs, infinite for those without a voltage."""
        column = np.full(frequency.shape, np.inf)
        column[reached] = values
        return column

    def over_deviations(values_of: Callable[[Evaluation], Floats]) -> Floats:
        """Worst case or quantile over the deviations."""
        return expanded(worst_or_quantile(np.stack([values_of(each) for each in evaluations]), problem.tolerance))

    return Evaluation(
        voltage_peak_to_peak=voltage_peak_to_peak,
        objectives={name: over_deviations(lambda each, name=name: each.objectives[name]) for name in OBJECTIVES},  # type: ignore[misc]
        utilisation={name: over_deviations(lambda each, name=name: each.utilisation[name]) for name in CONSTRAINTS},  # type: ignore[misc]
        quantities={name: expanded(values) for name, values in evaluations[0].quantities.items()},
    )


def _default_frequencies(rig: DrivenRig, problem: DesignProblem) -> Floats:
    """Grid over the frequency range, finer at the resonances of a rig."""
    low, high = problem.space.frequencies
    return frequency_grid(rig, lowest=low, highest=high, points=_FREQUENCIES, resonance_points=_RESONANCE_FREQUENCIES)


def _concatenated(parts: list[Floats]) -> Floats:
    """Arrays joined to one, empty where there are none."""
    return np.concatenate([*parts, np.zeros(0)])
