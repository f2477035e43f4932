"""Which hypothesis about the decay length a run with switched vibration supports, and whether that decides."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
from scipy.stats import chi2

from sonolube.checks import Floats
from sonolube.identification.decay_length.posterior import DECISION_TEXTS, HYPOTHESES, RunPosterior
from sonolube.identification.decay_length.run_model import DIFFERENCE, Channel, run_channels
from sonolube.identification.decay_length.switch_table import SwitchConditions, SwitchTable
from sonolube.identification.decay_length.zero_error import ZeroEvidence, zero_evidence

_READINGS: Final[Mapping[str, str]] = DECISION_TEXTS["readings"]
_ALONE: Final = "so that one quantity changes at a time: tare at each switch, and track the resonance"


class Undecided(NamedTuple):
    """Sentence that says why nothing is decided, and what to measure next."""

    verdict: str
    advice: str


def decided_sentence(leading: str, probabilities: Mapping[str, float]) -> str:
    """Sentence of the hypothesis that is decided, with its probability and that of the next."""
    hypothesis = HYPOTHESES[leading]
    others = sorted((p, other) for other, p in probabilities.items() if other != leading)
    following = HYPOTHESES[others[-1][1]].title
    return (
        f"{hypothesis.title} ({_percent(probabilities[leading])}): {hypothesis.meaning}; next {following}"
        f" ({_percent(others[-1][0])})"
    )


def misfit_reason(readings: Sequence[str]) -> Undecided:
    """Reason where readings change in a way that no hypothesis gives."""
    named = " and ".join(_READINGS[name] for name in readings)
    verb = "change" if len(readings) > 1 else "changes"
    return Undecided(
        verdict=f"not decided: {named} {verb} in a way that no hypothesis explains together with the other readings",
        advice=f"check how {named} {'are' if len(readings) > 1 else 'is'} read, then repeat on a fresh track",
    )


def other_reason(probability: float) -> Undecided:
    """Reason where the friction ratio changes while nothing else that is read does."""
    return Undecided(
        verdict=f"not decided: the friction ratio changes ({_percent(probability)}) while decay length, zero and"
        " amplitude stay: by none of the three",
        advice="repeat with the debris removed, and read load, speed and temperature at each switch",
    )


def several_reason(probability: float, parts: Sequence[str]) -> Undecided:
    """Reason where more than one quantity changes."""
    named = " and ".join(HYPOTHESES[name].title for name in parts)
    return Undecided(
        verdict=f"not decided: more than one quantity changes ({_percent(probability)}): {named}",
        advice=f"repeat {_ALONE}",
    )


def rivals_reason(probabilities: Mapping[str, float], missing: Sequence[str]) -> Undecided:
    """Reason where no hypothesis is probable enough."""
    first, second = sorted(probabilities, key=lambda name: -probabilities[name])[:2]
    both = " or ".join(f"{HYPOTHESES[name].title} ({_percent(probabilities[name])})" for name in (first, second))
    advice = DECISION_TEXTS["apart"].get("-".join(sorted((first, second))), f"repeat {_ALONE}")
    if missing:
        advice += f"; this run lacks {', '.join(_READINGS[name].removeprefix('the ') for name in missing)}"
    return Undecided(verdict=f"not decided: {both}", advice=advice)


def unsteady_reason(name: str, factor: float, steady: float) -> Undecided:
    """Reason where nothing changes enough to explain the sets, but something may change."""
    return Undecided(
        verdict=f"not decided: no change explains the difference between the published sets, but"
        f" {HYPOTHESES[name].change} up to {factor:.2f} (steady is {steady:.2f})",
        advice="read more switches, over a longer distance",
    )


def too_little_reason(leading: str, factor: float, sufficient: float) -> Undecided:
    """Reason where the change that leads is too small for the difference between the published sets."""
    return Undecided(
        verdict=f"not decided: {HYPOTHESES[leading].change} {factor:.2f}, too little for the 2.9 between the published"
        f" sets (a third of it in the logarithm is {sufficient:.2f})",
        advice="slide farther on a fresh track, or repeat under the conditions of a set with the other decay length",
    )


def _percent(probability: float) -> str:
    """Probability in per cent, never rounded to certainty."""
    if probability > 0.995:
        return "over 99 %"
    return "below 1 %" if probability < 0.005 else f"{100 * probability:.0f} %"


DECIDING_PROBABILITY: Final = 0.9
"""Posterior probability from which a hypothesis counts as decided."""

SUFFICIENT_FACTOR: Final = float(np.exp(DIFFERENCE / 3))
"""Factor in amplitude over decay length from which a change explains the sets: a third of ln(2 um/0.7 um)."""

STEADY_FACTOR: Final = float(np.exp(DIFFERENCE / 8))
"""Factor below which a change counts as none, with a probability of 0.9: an eighth of that difference."""

_LIKELY: Final = 0.5  # from which several changes, or another, are said rather than two rivals
_MISFIT: Final = 1e-3  # probability of a chi-squared below which a reading is not explained


@dataclass(frozen=True, kw_only=True, slots=True)
class Interval:
    """Median of a quantity with its 80 % interval.

    Parameters
    ----------
    median, lower, upper : float
        In the unit of the quantity.
    """

    median: float
    lower: float
    upper: float


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class DecayLengthDecision:
    """Posterior of the hypotheses about the decay length after one run.

    Parameters
    ----------
    probabilities : mapping of str to float
        Posterior probability of each of `HYPOTHESES`.
    decided : bool
        Whether one of them but "several" and "other" has 0.9, its change is large enough, and it fits every reading.
    leading : str
        Name of the most probable one.
    verdict : str
        One sentence: the hypothesis with its probability, or why nothing is decided.
    advice : str
        What to repeat or add; empty where it is decided.
    growth, fall : Interval
        Factors by which the decay length grows and the amplitude falls over the run.
    zero_factor : Interval
        Largest factor by which the zero makes the decay length wrong where it is not subtracted.
    length_at_start, length_at_end : Interval
        Decay length at the first and at the last switch, in m.
    misfits : mapping of str to float
        Probability of a misfit as large as that of the leading hypothesis, by reading.
    effective_draws : float
        Least number of effective draws of a model that matters.
    zero : ZeroEvidence
    courses : mapping of str to mapping of str to ndarray
        Fitted readings at all switches by hypothesis and reading, in SI.
    channels : tuple of Channel
        Readings that entered beside the zero.
    """

    probabilities: Mapping[str, float]
    decided: bool
    leading: str
    verdict: str
    advice: str
    growth: Interval
    fall: Interval
    zero_factor: Interval
    length_at_start: Interval
    length_at_end: Interval
    misfits: Mapping[str, float]
    effective_draws: float
    zero: ZeroEvidence
    courses: Mapping[str, Mapping[str, Floats]]
    channels: tuple[Channel, ...]


def decide_decay_length(
    table: SwitchTable, conditions: SwitchConditions | None = None, *, seed: int = 0
) -> DecayLengthDecision:
    r"""Posterior probabilities of the hypotheses about what sets the decay length, from the switches of one run.

    Parameters
    ----------
    table : SwitchTable
    conditions : SwitchConditions, optional
        5 N, 2.3 um, 22 kHz and 65 mm/s by default.
    seed : int
        Of the random numbers; equal seeds give equal results.

    Returns
    -------
    DecayLengthDecision

    See Also
    --------
    recorded_switches : Table of a recording.
    switch_table : Table of a file.

    Notes
    -----
    Three changes are each present or absent: over the run the decay length grows by :math:`e^g`, the amplitude falls by
    :math:`e^d`, and the zero is off by z. Where absent they are small, :math:`g \sim N(0, 0.05^2)`,
    :math:`d \sim N(0, 0.03^2)` and :math:`z/F_0 \sim N(0, 0.03^2)`; where present
    :math:`g, d \sim N(\ln(2/0.7), 0.4^2)` and :math:`z/F_0 \sim N(0, 0.35^2)`. None, and each alone, have the prior
    probability 0.2125, two or more together 0.1, and a friction ratio that changes by itself, by :math:`N(0, 0.3^2)`,
    0.05. The last two densities are these normal ones times the square of the change (moment priors), for hardly any
    change is none.

    The levels of decay length, amplitude and memory length, the errors of the friction model in level and slope, the
    scale of the shifts, the capacitive share of the current and the relaxation distances have normal priors, most in
    their logarithms, and are integrated by importance sampling. The noise of each reading, white and slowly wandering,
    is estimated beside any smooth course, so that it is one for all hypotheses.

    A hypothesis is decided from a probability of 0.9 on, if its change explains a third at least of the difference
    between the decay lengths of the published sets, 0.7 and 2 um, in its logarithm, and no reading contradicts it. None
    is decided where decay length and amplitude change by less than an eighth of it, with a probability of 0.9.
    """
    known = conditions or SwitchConditions()
    channels = run_channels(table, known)
    zero = zero_evidence(table, known, seed=seed)
    found = RunPosterior(table, known, channels=channels, zero_log_ratio=zero.log_ratio, seed=seed)
    probabilities = found.probabilities
    leading = max(probabilities, key=probabilities.__getitem__)
    misfits = _misfits(found, leading)
    length, amplitude = found.draws()
    changes = {
        "long_sliding": length[:, -1] / length[:, 0],
        "detuning": amplitude[:, 0] / amplitude[:, -1],
        "zero_error": zero.factor,
    }
    lacking = _lacking(found, leading, misfits, changes, table)
    verdict, advice = lacking or (decided_sentence(leading, probabilities), "")
    return DecayLengthDecision(
        probabilities=probabilities,
        decided=lacking is None,
        leading=leading,
        verdict=verdict,
        advice=advice,
        growth=_interval(changes["long_sliding"]),
        fall=_interval(changes["detuning"]),
        zero_factor=_interval(changes["zero_error"]),
        length_at_start=_interval(length[:, 0]),
        length_at_end=_interval(length[:, -1]),
        misfits=misfits,
        effective_draws=found.effective_draws,
        zero=zero,
        courses={name: _courses(found, name) for name in HYPOTHESES if name in ("long_sliding", "detuning", "none")},
        channels=channels,
    )


def _lacking(
    found: RunPosterior, leading: str, misfits: Mapping[str, float], changes: Mapping[str, Floats], table: SwitchTable
) -> Undecided | None:
    """Reason for which nothing is decided; None where a hypothesis is."""
    probabilities = found.probabilities
    if leading == "several" and probabilities[leading] >= _LIKELY:
        return several_reason(probabilities[leading], found.best("several").parts)
    if leading == "other" and probabilities[leading] >= _LIKELY:
        return other_reason(probabilities[leading])
    if unexplained := [name for name, probability in misfits.items() if probability < _MISFIT]:
        return misfit_reason(unexplained)
    if probabilities[leading] < DECIDING_PROBABILITY:
        return rivals_reason(probabilities, table.missing)
    if leading in changes and float(np.mean(changes[leading] >= SUFFICIENT_FACTOR)) < DECIDING_PROBABILITY:
        return too_little_reason(leading, float(np.median(changes[leading])), SUFFICIENT_FACTOR)
    if leading == "none":
        steady = ("long_sliding", "detuning")
        highest = {name: float(np.quantile(changes[name], DECIDING_PROBABILITY)) for name in steady}
        largest = max(highest, key=highest.__getitem__)
        if highest[largest] > STEADY_FACTOR:
            return unsteady_reason(largest, highest[largest], STEADY_FACTOR)
    return None


def _misfits(found: RunPosterior, leading: str) -> dict[str, float]:
    """Probability of a sum of squares as large as at the mode of the leading hypothesis, by reading."""
    model, fit = found.fit_of(found.best(leading))
    rest = model.residuals(fit.mode[None])[0]
    ends = np.cumsum([each.values.size for each in model.channels])
    pieces = np.split(rest, ends[:-1])
    return {
        each.name: float(chi2.sf(piece @ piece, piece.size)) for each, piece in zip(model.channels, pieces, strict=True)
    }


def _courses(found: RunPosterior, hypothesis: str) -> dict[str, Floats]:
    """Readings at all switches by the mode of a hypothesis, with their fitted levels, in SI."""
    model, fit = found.fit_of(found.best(hypothesis))
    return model.fitted(fit.mode)


def _interval(values: Floats) -> Interval:
    """Median and 80 % interval of draws."""
    lower, median, upper = (float(each) for each in np.quantile(values, (0.1, 0.5, 0.9)))
    return Interval(median=median, lower=lower, upper=upper)
