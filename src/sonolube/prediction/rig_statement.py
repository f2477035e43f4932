"""Prediction of a rig in words: its outcome, what to measure, what limits it, and its caveats."""

from collections.abc import Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

from sonolube.checks import Floats
from sonolube.prediction.applicability import NORMAL_VIBRATION, Applicability, extrapolation_caveats
from sonolube.prediction.bodies import pair_of, softer_hardness, wear_statement, worn_body
from sonolube.prediction.evidence import published_rigs
from sonolube.prediction.evidence_posterior import EvidencePosterior
from sonolube.prediction.hierarchy import PROBABILITIES, central_interval, sorted_quantiles
from sonolube.prediction.inputs import OwnRuns, RigInputs
from sonolube.prediction.predictive import Laboratory, RigPrediction, RunCheck
from sonolube.prediction.verdict import point_verdict
from sonolube.prediction.within_plane import NO_WEAR, RIGID_MODEL, plane_rigs, tested_words
from sonolube.rig import Rig
from sonolube.rig.contact_temperature import heat_sentence
from sonolube.rig.datasets import LabelledArray, LabelledArrays
from sonolube.rig.friction_and_wear import direction_caveats
from sonolube.rig.power import POWERS, power_text
from sonolube.rig.resolved_rig import resolved_rig

if TYPE_CHECKING:
    import xarray as xr

WEAR_OF_LUBRICATED: Final = (
    "What vibration does to wear is not known of a lubricated contact: all published wear tests with vibration are of"
    " dry ones; measure it."
)
"""Sentence in place of wear under a lubricant."""

_NONE: Final = 0.5  # percent of friction, below which a change is none


def interval(prediction: "xr.Dataset | LabelledArrays", name: str, probability: float = 0.8) -> tuple[float, float]:
    """Central predictive interval of a quantity.

    Parameters
    ----------
    prediction : xarray.Dataset or LabelledArrays
        By `predict`.
    name : str
        A variable over `draw`.
    probability : float
        Within the interval.

    Returns
    -------
    low, high : float
        In the unit of the quantity.
    """
    values = prediction[name]
    if isinstance(values, LabelledArray) and probability in PROBABILITIES:
        return _intervals(values)[probability]
    low, high = central_interval(values.to_numpy(), probability)
    return float(low), float(high)


@lru_cache(maxsize=16)
def _intervals(values: LabelledArray) -> dict[float, tuple[float, float]]:
    """Intervals of the draws of a quantity by their probability, which sentences, rows and JSON ask for in turn."""
    ends = [end for probability in PROBABILITIES for end in ((1 - probability) / 2, (1 + probability) / 2)]
    found = sorted_quantiles(np.sort(values.to_numpy()), ends).tolist()
    return {probability: (found[2 * at], found[2 * at + 1]) for at, probability in enumerate(PROBABILITIES)}


def statement(prediction: "xr.Dataset | LabelledArrays") -> tuple[str, ...]:
    """Prediction in sentences: what contradicts it, the outcome, wear, what to measure, and what limits it.

    Parameters
    ----------
    prediction : xarray.Dataset or LabelledArrays

    Returns
    -------
    tuple of str
    """
    sentences = (
        prediction.attrs["contradiction"],
        _directed_outcome(prediction),
        prediction.attrs["wear"],
        _advice(prediction),
        _limits(prediction),
    )
    return tuple(sentence for sentence in sentences if sentence)


def prediction_attributes(
    rig: Rig,
    inputs: RigInputs,
    own: OwnRuns | None,
    found: RigPrediction,
    limits: Applicability,
    laboratory: Laboratory | None,
    evidence: EvidencePosterior | None = None,
) -> dict[str, object]:
    """Title, caveats, assumptions and numbers without a distribution of a prediction."""
    point = inputs.point
    said_above = not rig.direction.is_normal and rig.friction_model.name == RIGID_MODEL
    own_caveats = [each for each in point.caveats if not said_above or each not in direction_caveats(resolved_rig(rig))]
    caveats = [*limits.caveats, *own_caveats, *extrapolation_caveats(rig, inputs)]
    caveats += () if laboratory is None else laboratory.caveats
    caveats += () if evidence is None else evidence.caveats(rig.direction)
    if own is not None:
        caveats += [*outlier_caveats(found.check, own), *own.caveats]
        if own.wear_rate_ratio.size and not rig.direction.is_normal:
            caveats.append("the wear that the runs state is left out: no prediction of wear is of this direction")
    contradiction = "" if own is None else contradiction_sentence(found.check, own)
    verdict = point_verdict(rig, friction=point, lubricant=limits.any_ratio, contradiction=contradiction)
    attributes: dict[str, object] = {
        "result": "prediction",
        "title": rig.title,
        "caveats": "\n".join(caveats),
        "assumptions": "\n".join(f"{key}: {reason}" for key, reason in rig.assumptions.items()),
        "contradiction": contradiction,
        "verdict": str(verdict.verdict),
        "verdict_reasons": "\n".join(verdict.reasons),
        "unknown": int(limits.any_ratio and own is None),
        "friction_law": found.draws.posterior.closure.name,
        "vibration_amplitude": inputs.amplitude.value,
        "sliding_speed": inputs.sliding_speed,
        "runs": (runs := 0 if own is None else own.tested.friction_ratio.size),
        "basis": basis_words(_published_tests(rig, evidence), runs),
        "disagreeing_runs": "" if found.check is None else " ".join(str(place + 1) for place in found.check.outliers),
    }
    if evidence is not None:
        attributes["evidence"] = evidence.name
        attributes["evidence_fingerprint"] = evidence.fingerprint
        attributes["evidence_sources"] = "\n".join(source.citation for source in evidence.sources)
    if not rig.direction.is_normal:
        attributes["tested"] = tested_words(rig.direction)
    if point.power is not None:
        attributes |= {name: value for name in POWERS if (value := getattr(point.power, name)) is not None}
        attributes["power_is_at_least"] = int(point.power.is_at_least)
    if np.isfinite(point.friction_ratio):
        attributes["friction_ratio_by_the_rigs_model"] = point.friction_ratio
        attributes["friction_model"] = point.friction_model
    return attributes


def _published_tests(rig: Rig, evidence: EvidencePosterior | None) -> int:
    """Number of published tests behind a prediction of a rig, those of an own posterior included."""
    own = () if evidence is None else evidence.own
    shipped = published_rigs() if rig.direction.is_normal else plane_rigs()
    return sum(each.friction_ratio.size for each in shipped) + sum(source.points for source in own)


def _directed_outcome(prediction: "xr.Dataset | LabelledArrays") -> str:
    """Sentence on change of friction and direction; how far another direction than the normal was tested is first."""
    tested = prediction.attrs.get("tested")
    outcome = _outcome(prediction)
    return f"{outcome} {NORMAL_VIBRATION}" if tested is None else f"{tested}: {outcome[0].lower()}{outcome[1:]}"


def _outcome(prediction: "xr.Dataset | LabelledArrays") -> str:
    """Sentences on the change of friction: the median, and the 80 % interval with the tests behind it."""
    if prediction.attrs["unknown"]:
        return "Friction falls by anything from 0 to 100 %: a dry prediction does not hold."
    if is_unchanged(prediction):
        return "Friction does not change."
    low, high = (100 * each for each in interval(prediction, "friction_reduction"))
    middle = 100 * float(np.median(prediction["friction_reduction"].to_numpy()))
    change = "hardly changes" if abs(middle) < _NONE else f"{_falls(middle)} by about {abs(middle):.0f} %"
    basis = prediction.attrs.get("basis", "")
    return f"Friction {change}. Likely between {change_range(low, high)} (8 chances in 10){basis}."


def is_unchanged(prediction: "xr.Dataset | LabelledArrays") -> bool:
    """Whether friction changes by less than half a percent throughout the 80 % interval."""
    return max(100 * abs(each) for each in interval(prediction, "friction_reduction")) < _NONE


def _falls(reduction: float) -> str:
    """Verb of a reduction."""
    return "falls" if reduction > 0 else "rises"


def change_range(low: float, high: float, *, joined: str = "and") -> str:
    """Ends of a reduction in percent, with their directions where these differ or are a rise."""
    if high <= 0:
        return f"{max(-high, 0):.0f} {joined} {-low:.0f} % more"
    if low < -_NONE:
        return f"{-low:.0f} % more {joined} {high:.0f} % less"
    return f"{max(low, 0):.0f} {joined} {high:.0f} %"


def basis_words(tests: int, own: int) -> str:
    """Published and own tests behind a prediction, as the end of a sentence."""
    runs = "none of yours" if own == 0 else f"{own} run{'s' if own > 1 else ''} of yours"
    return f", from {tests} published tests on other rigs and {runs}"


def _advice(prediction: "xr.Dataset | LabelledArrays") -> str:
    """Sentence on the measurement that would narrow the interval most."""
    labels, left = (prediction[name].to_numpy() for name in ("measure_label", "measure_share_left"))
    if not labels.size:
        return "Own runs, fitted by `sonolube fit`, tell what vibration does here."
    one, other = 100 * left[0], 100 * left[1]
    run = f"One run at this point would leave {one:.0f} % of the width here, {other:.0f} % at twice the speed"
    if left.size < 3:
        return f"{run}."
    best = 2 + int(np.argmin(left[2:]))
    return f"{run}; {labels[best]} would leave {100 * left[best]:.0f} %."


def _limits(prediction: "xr.Dataset | LabelledArrays") -> str:
    """Sentence on heat and power."""
    parts = [prediction.attrs["heat"]]
    power = prediction.attrs.get("power_to_supply")
    unknown = "power is not known: capacitance or voltage is missing"
    supplied = "" if power is None else power_text(power, is_at_least=bool(prediction.attrs["power_is_at_least"]))
    parts.append(f"the amplifier has to supply {supplied}" if supplied else unknown)
    return "; ".join(parts) + "."


def heat_words(
    rig: Rig, pin: str | None, disc: str | None, drawn: Mapping[str, Floats], heating: tuple[float | str, float | str]
) -> str:
    """Whether heat limits a rig, by the upper ends of the 80 % intervals of its rises; or why that is not known."""
    face, spot = heating
    if isinstance(face, str):
        return f"Heat is not computed: {face}"
    highest = central_interval(drawn["mean_temperature_rise"], 0.8)[1]
    return heat_sentence(
        rig,
        mean_temperature_rise=float(highest),
        spot_temperature_rise=None if isinstance(spot, str) else float(highest) * spot / face,
        hardness=softer_hardness(rig, pin, disc),
        of="at most (80 %) ",
    )


def contradiction_sentence(check: RunCheck | None, own: OwnRuns) -> str:
    """Sentence on runs that contradict the prediction before them; empty where they do not."""
    if check is None or not check.contradicted:
        return ""
    ratio = own.tested.friction_ratio
    outside = np.maximum(check.lows - ratio, ratio - check.highs)
    worst = int(np.argmax(outside))
    return (
        f"Your runs contradict every model (probability {check.probability:.1g}): ratio {ratio[worst]:.2f} where"
        f" {check.lows[worst]:.2f} to {check.highs[worst]:.2f} (95 %) was predicted; what follows rests on the runs"
        " alone and holds near their conditions. Check amplitude, load and zero of the force, or expect another"
        " mechanism."
    )


def outlier_caveats(check: RunCheck | None, own: OwnRuns) -> list[str]:
    """Sentence on each run that disagrees with the others."""
    if check is None:
        return []
    return [
        f"run {place + 1} disagrees with the others: ratio {own.tested.friction_ratio[place]:.2f} where they give"
        f" {check.left_out[place]:.2f} (probability {check.outlier_probability[place]:.1g}); it counts less: repeat it"
        for place in check.outliers
    ]


def wear_sentence(rig: Rig, *, ratios: Floats | None, contradicted: bool, is_lubricated: bool = False) -> str:
    """Change of the wear rate in words, with the body that wears; why it is unknown where there are no ratios."""
    if ratios is None and is_lubricated and rig.direction.is_normal:
        return WEAR_OF_LUBRICATED
    if ratios is None:
        return NO_WEAR
    if contradicted:
        return (
            "What vibration does to wear is not known where the runs contradict the prediction of friction: measure it."
        )
    return wear_statement(ratios, pair=pair_of(rig), worn_body=worn_body(rig))
