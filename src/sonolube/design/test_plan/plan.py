"""Plan of the next tests of a rig: points, replicates, order of the runs and their duration."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import ceil
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.design.test_plan.candidates import NO_LIMITS, Candidates, Factors, RigLimits, candidate_tests
from sonolube.design.test_plan.comparison import (
    BLOCKINGS,
    COMPARISONS,
    Blocking,
    Comparison,
    PlannedRun,
    RunPart,
    RunState,
    Scatter,
    assumed_scatter,
    published_scatter,
    randomised_runs,
    scatter_of_runs,
)
from sonolube.design.test_plan.information import Batch, best_batch, closure_outcomes, mutual_information
from sonolube.errors import InvalidInput
from sonolube.facts.published import column_numbers
from sonolube.prediction.evidence_posterior import EvidencePosterior, population_of
from sonolube.prediction.hierarchy import central_interval
from sonolube.prediction.inputs import RigInputs, own_runs, rig_inputs
from sonolube.prediction.posterior import Posterior, learned
from sonolube.prediction.predictive import rig_prediction
from sonolube.rig import Rig
from sonolube.text.units import format_si

if TYPE_CHECKING:
    import xarray as xr

MAX_RUNS: Final = 1000
"""Number of runs of a plan."""

_DRAWS: Final = 4000


@dataclass(frozen=True, kw_only=True, slots=True)
class Question:
    """Difference that the tests shall show, with significance and power.

    Parameters
    ----------
    difference : float
        Friction reduction to be shown.
    power : float
        Probability to show it where it is there.
    significance : float
        Probability to show it where it is not.
    comparison : Comparison
    scatter : float or None
        Of a friction force between runs, relative; by own runs or the dissertation where None.
    """

    difference: float = 0.1
    power: float = 0.9
    significance: float = 0.05
    comparison: Comparison = COMPARISONS["paired"]
    scatter: float | None = None

    def __post_init__(self) -> None:
        if not 0 < self.difference < 1:
            raise InvalidInput(f"difference must lie between 0 and 1 of the friction, got {self.difference:g}")
        if self.scatter is not None and not 0 < self.scatter < 1:
            raise InvalidInput(f"scatter must lie between 0 and 1 of the friction, got {self.scatter:g}")


@dataclass(frozen=True, kw_only=True, slots=True)
class Procedure:
    """Durations and rates of each run.

    Parameters
    ----------
    intrinsic_distance, vibrated_distance : float
        Sliding distances until friction is steady without and with vibration, in m; the latter also after a switch of
        the vibration.
    measuring_time : float
        Time in steady friction, without and with vibration, in s.
    blocking : Blocking
    """

    intrinsic_distance: float
    vibrated_distance: float
    measuring_time: float = 12.0
    blocking: Blocking = BLOCKINGS["day"]

    def __post_init__(self) -> None:
        require_non_negative(intrinsic_distance=self.intrinsic_distance, vibrated_distance=self.vibrated_distance)
        require_positive(measuring_time=self.measuring_time)

    def states(self, speed: float, vibrated: Sequence[bool]) -> tuple[RunState, ...]:
        """States of a part of a run at a sliding speed, in m/s; each kind shares the measuring time evenly.

        All states after the first settle equally long, so that those of `INTERLEAVED` have one mean time.
        """
        return tuple(
            RunState(
                vibrated=on,
                settling=float(ceil((self.vibrated_distance if place or on else self.intrinsic_distance) / speed)),
                measuring=self.measuring_time / list(vibrated).count(on),
            )
            for place, on in enumerate(vibrated)
        )


def published_distances() -> tuple[float, float]:
    """Longest distances until friction is steady without and with vibration, of D Table 2.3. [m]"""
    numbers = [number.value for _, number in sorted(column_numbers("2.3", "friction_distance").items())]
    return max(numbers[::2]), max(numbers[1::2])


@dataclass(frozen=True, kw_only=True, slots=True)
class TestPlan:
    """Plan of tests of a rig.

    Parameters
    ----------
    rig : Rig
    question : Question
    procedure : Procedure
    scatter : Scatter
    replicates : int
        Of each point.
    power : float
        Of the comparison at one point.
    candidates : Candidates
    information : ndarray, shape (m,)
        Expected information of the replicates at each candidate, in bits.
    batch : Batch
        Points of the plan, as indices of candidates; the rig's own first, where the limits allow it.
    interval : ndarray, shape (2, m)
        Limits of the predicted friction ratio, 80 %.
    median : ndarray, shape (m,)
        Of the predicted friction ratio.
    chance : ndarray, shape (m,)
        Probability that the reduction is at least the difference.
    weights : dict of str to float
        Probability of each closure.
    closure_medians : dict of str to ndarray, shape (m,)
        Friction ratio by each closure.
    friction_coefficient : float
        Intrinsic, by the rig or the own runs. []
    runs : tuple of PlannedRun
    limits : RigLimits
    materials : tuple of str or None
        Of pin and disc.
    caveats : tuple of str
    """

    __test__ = False

    rig: Rig
    question: Question
    procedure: Procedure
    scatter: Scatter
    replicates: int
    power: float
    candidates: Candidates
    information: Floats
    batch: Batch
    interval: Floats
    median: Floats
    chance: Floats
    weights: dict[str, float]
    closure_medians: dict[str, Floats]
    friction_coefficient: float
    runs: tuple[PlannedRun, ...]
    limits: RigLimits
    materials: tuple[str, str] | None
    caveats: tuple[str, ...]

    def candidate(self, run: PlannedRun) -> int:
        """Candidate of a run."""
        return self.batch.points[run.point]

    @property
    def entropy(self) -> float:
        """Entropy of the weights of the friction models: the most information that tests can give. [bit]"""
        weights = np.array(list(self.weights.values()))
        weights = weights[weights > 0]
        return float(-np.sum(weights * np.log2(weights)))

    @property
    def duration(self) -> float:
        """Time of all runs without mounting and cleaning. [s]"""
        return sum(state.duration for run in self.runs for part in run.parts for state in self.states(run, part))

    def states(self, run: PlannedRun, part: RunPart) -> tuple[RunState, ...]:
        """States of a part of a run."""
        speed = float(self.candidates.sliding_speed[self.candidate(run)])
        return self.procedure.states(speed, part.vibrated)


def plan_tests(
    rig: Rig,
    factors: Factors,
    *,
    question: Question,
    procedure: Procedure,
    points: int = 4,
    limits: RigLimits = NO_LIMITS,
    runs: "xr.Dataset | None" = None,
    evidence: EvidencePosterior | None = None,
    pin: str | None = None,
    disc: str | None = None,
    seed: int = 0,
) -> TestPlan:
    """Plan the next tests of a rig."""
    population = population_of(rig.direction, evidence)
    inputs = rig_inputs(rig)
    own = None if runs is None else own_runs(runs, inputs, title=rig.title)
    if own is not None and own.friction is not None:
        inputs = replace(inputs, friction=own.friction)
    scatter = _scatter(question, runs)
    comparison, deviation = question.comparison, question.comparison.deviation(scatter)
    needed = {"difference": question.difference, "deviation": deviation, "significance": question.significance}
    replicates = comparison.replicates(power=question.power, **needed)
    if points < 1 or points * replicates > MAX_RUNS:
        raise InvalidInput(f"{points} points with {replicates} replicates; a plan has 1 to {MAX_RUNS} runs")
    candidates = candidate_tests(rig, inputs, factors, limits=limits, pin=pin, disc=disc)
    at = inputs.at(vibration_amplitude=candidates.vibration_amplitude, sliding_speed=candidates.sliding_speed)
    tested = None if own is None else own.tested
    found = rig_prediction(population, at, count=_DRAWS, seed=seed, own=tested)
    ratios = found.ratios(at.conditions)
    chance = np.mean(1 - ratios >= question.difference, axis=0)
    allowed = _allowed(candidates, points)
    _require_effect(1 - np.median(ratios, axis=0)[allowed], question.difference)
    noise = np.full(at.conditions.sliding_speed.shape, deviation / np.sqrt(replicates))
    models = closure_outcomes(_compared(population), at, own=tested, seed=seed)
    first = [candidates.own] if candidates.own in allowed else []
    batch = best_batch(models, count=points, noise=noise, allowed=allowed, first=first, seed=seed)
    singles = [mutual_information(models, np.array([each]), noise=noise, seed=seed) for each in range(noise.size)]
    order = randomised_runs(points, replicates, blocking=procedure.blocking, specimens=comparison.specimens, seed=seed)
    plan = TestPlan(
        rig=rig,
        question=question,
        procedure=procedure,
        scatter=scatter,
        replicates=replicates,
        power=float(comparison.power(replicates=replicates, **needed)),
        candidates=candidates,
        information=np.array(singles),
        batch=batch,
        interval=np.array(central_interval(ratios, 0.8)),
        median=np.median(ratios, axis=0),
        chance=chance,
        weights={each.name: each.weight for each in models},
        closure_medians={each.name: np.median(each.means, axis=0) for each in models},
        friction_coefficient=inputs.friction.value,
        runs=order,
        limits=limits,
        materials=None if pin is None or disc is None else (pin, disc),
        caveats=() if own is None else own.caveats,
    )
    return replace(
        plan,
        caveats=(
            *_caveats(plan, inputs, contradicted=found.check is not None and found.check.contradicted),
            *plan.caveats,
            *_evidence_caveats(rig, evidence),
        ),
    )


def _compared(population: Posterior) -> tuple[Posterior, ...]:
    """Friction models that the tests are to tell apart, that which predicts by its population."""
    name = population.closure.name
    return tuple(population if each.closure.name == name else each for each in learned().compared)


def _evidence_caveats(rig: Rig, evidence: EvidencePosterior | None) -> tuple[str, ...]:
    """Own published tests that the prediction was learned from too, and the models that were not."""
    if evidence is None:
        return ()
    return (
        *evidence.caveats(rig.direction),
        "the friction models beside the one that predicts are learned from the tests that ship with sonolube alone",
    )


def _scatter(question: Question, runs: "xr.Dataset | None") -> Scatter:
    """Scatter as given, by own repeats, or of the dissertation."""
    if question.scatter is not None:
        return assumed_scatter(question.scatter)
    own = None if runs is None else scatter_of_runs(runs)
    return own or published_scatter()


def _allowed(candidates: Candidates, points: int) -> "np.ndarray[tuple[int], np.dtype[np.int64]]":
    """Candidates within the limits, at least as many as points."""
    allowed = np.flatnonzero([not reason for reason in candidates.refused])
    if allowed.size < points:
        reason = next((each for each in candidates.refused if each), "")
        left = f"; of the others: {reason}" if reason else ""
        raise InvalidInput(
            f"{points} points to choose among {allowed.size} that the rig can make{left}; give more values or fewer"
            " points"
        )
    return allowed


def _require_effect(reductions: Floats, difference: float) -> None:
    """Raise where no candidate is predicted to show the difference."""
    largest = float(np.max(reductions))
    if largest < difference:
        raise InvalidInput(
            f"--difference {difference:g} is larger than the effect: the friction reduction predicted is at most"
            f" {largest:.2g} (median) at any point; show a smaller difference, or vibrate more or slide slower"
        )


def _caveats(plan: TestPlan, inputs: RigInputs, *, contradicted: bool) -> Iterator[str]:
    """Reasons for caution about a plan."""
    if plan.scatter.caveat:
        yield plan.scatter.caveat
    refused = [(index, reason) for index, reason in enumerate(plan.candidates.refused) if reason]
    if refused:
        index, reason = refused[0]
        at = plan.candidates
        first = f"{format_si(at.sliding_speed[index], 'm/s')} and {format_si(at.vibration_amplitude[index], 'm')}"
        yield f"{len(refused)} of {len(at.refused)} points exceed a limit and are left out, such as {first}: {reason}"
    if plan.candidates.vibration_amplitude.max() > inputs.amplitude.value * (1 + 1e-9):
        yield "some amplitudes are above that of the rig file; check that actuator and amplifier reach them"
    if plan.candidates.refused[plan.candidates.own]:
        yield f"the rig's own operating point is none of the plan: {plan.candidates.refused[plan.candidates.own]}"
    doubtful = [number for number, each in enumerate(plan.batch.points, 1) if plan.chance[each] < 0.5]
    if doubtful:
        yield (
            f"at point {_listed(doubtful)} a reduction of {100 * plan.question.difference:.0f} % is less likely than"
            " not; it is there to tell the closures apart"
        )
    if contradicted:
        yield "the measured runs contradict every friction model; the plan tells models apart that are all in doubt"
    if np.unique(plan.candidates.normal_load).size > 1:
        yield "friction models depend on the load by the separation only; to test the load, keep speed and amplitude"


def _listed(numbers: Sequence[int]) -> str:
    """Numbers in words."""
    return " and ".join(filter(None, [", ".join(map(str, numbers[:-1])), str(numbers[-1])]))
