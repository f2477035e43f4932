"""Sentences of a decision about the decay length: the hypothesis that holds, or why none is decided."""

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

from sonolube.identification.decay_length.posterior import HYPOTHESES

_READINGS: Final = {
    "friction_ratio": "the friction ratio",
    "stack_current": "the stack current",
    "small_drive_shift": "the shift at small drive",
    "large_drive_shift": "the shift at large drive",
}
_APART: Final = {
    frozenset(("long_sliding", "none")): "slide farther on a fresh track, with the small-drive shift at each switch",
    frozenset(("detuning", "none")): "slide farther, and read the current, and the shift at large drive, more finely",
    frozenset(("zero_error", "none")): "lift the pin longer at each switch, and calibrate the cell before and after",
    frozenset(("long_sliding", "detuning")): "read the stack current and the shift at small drive at each switch: the"
    " current tells the amplitude, the shift the contact stiffness",
}  # fmt: skip
_ALONE: Final = "so that one quantity changes at a time: tare at each switch, and track the resonance"
_CHANGES: Final = {
    "long_sliding": "the decay length grows by a factor of",
    "detuning": "the amplitude falls by a factor of",
    "zero_error": "the zero biases the decay length by a factor of",
}


class Undecided(NamedTuple):
    """Sentence that says why nothing is decided, and what to measure next."""

    verdict: str
    advice: str


def decided_sentence(leading: str, probabilities: Mapping[str, float]) -> str:
    """Sentence of the hypothesis that is decided, with its probability and that of the next."""
    name, _, meaning = HYPOTHESES[leading].partition(":")
    others = sorted((p, other) for other, p in probabilities.items() if other != leading)
    following = HYPOTHESES[others[-1][1]].partition(":")[0]
    return (
        f"{name} ({_percent(probabilities[leading])}): {meaning.strip()}; next {following} ({_percent(others[-1][0])})"
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
    named = " and ".join(HYPOTHESES[name].partition(":")[0] for name in parts)
    return Undecided(
        verdict=f"not decided: more than one quantity changes ({_percent(probability)}): {named}",
        advice=f"repeat {_ALONE}",
    )


def rivals_reason(probabilities: Mapping[str, float], missing: Sequence[str]) -> Undecided:
    """Reason where no hypothesis is probable enough."""
    first, second = sorted(probabilities, key=lambda name: -probabilities[name])[:2]
    both = " or ".join(
        f"{HYPOTHESES[name].partition(':')[0]} ({_percent(probabilities[name])})" for name in (first, second)
    )
    advice = _APART.get(frozenset((first, second)), f"repeat {_ALONE}")
    if missing:
        advice += f"; this run lacks {', '.join(_READINGS[name].removeprefix('the ') for name in missing)}"
    return Undecided(verdict=f"not decided: {both}", advice=advice)


def unsteady_reason(name: str, factor: float, steady: float) -> Undecided:
    """Reason where nothing changes enough to explain the sets, but something may change."""
    return Undecided(
        verdict=f"not decided: no change explains the difference between the published sets, but {_CHANGES[name]} up to"
        f" {factor:.2f} (steady is {steady:.2f})",
        advice="read more switches, over a longer distance",
    )


def too_little_reason(leading: str, factor: float, sufficient: float) -> Undecided:
    """Reason where the change that leads is too small for the difference between the published sets."""
    return Undecided(
        verdict=f"not decided: {_CHANGES[leading]} {factor:.2f}, too little for the 2.9 between the published sets"
        f" (a third of it in the logarithm is {sufficient:.2f})",
        advice="slide farther on a fresh track, or repeat under the conditions of a set with the other decay length",
    )


def _percent(probability: float) -> str:
    """Probability in per cent, never rounded to certainty."""
    if probability > 0.995:
        return "over 99 %"
    return "below 1 %" if probability < 0.005 else f"{100 * probability:.0f} %"
