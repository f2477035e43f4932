"""Ways to predict the published tests with nothing that a user would not have: all that were tried, with scores."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from reliability.study import Measure, Record, Study
from sonolube.prediction.calibration import (
    SAME_TRIBOMETER,
    Calibration,
    blind_calibration,
    mean_ratio_calibration,
    population_calibration,
)
from sonolube.prediction.evidence import CLOSURES, TestedRig, published_rigs
from sonolube.prediction.hierarchy import Prior
from sonolube.prediction.posterior import Population

_TESTS = sum(rig.friction_ratio.size for rig in published_rigs())
_DECAY = 3.0  # of the heights per R_q, by which a roughness gives a decay length
_UNWORN = {"A": 0.58e-6, "B": 2.12e-6, "C": 0.56e-6, "G": 0.857e-6}  # m, R_q as printed before the tests
_WORN = {"B": 2.12e-6, "C": 2.26e-6, "G": 1.49e-6}  # m, after them; of the two tips of G the geometric mean


@dataclass(frozen=True, kw_only=True)
class Way:
    """One way to predict: its name, and its predictions of all tests, each set left out in turn."""

    name: str
    calibration: Callable[[], Calibration]


def _population(
    name: str, *, closure: int = 0, prior: Prior | None = None, rough: dict[str, float] | None = None
) -> Way:
    """Way of the hierarchical model with another friction model, prior or reference length."""

    def found() -> Calibration:
        rigs = tuple(_with_length(rig, rough) for rig in published_rigs())
        return population_calibration(name, Population.of(CLOSURES[closure], rigs, prior=prior or Prior()), rigs)

    return Way(name=name, calibration=found)


def _with_length(rig: TestedRig, rough: dict[str, float] | None) -> TestedRig:
    """Rig whose decay length is about R_q/3 where a roughness is printed."""
    if rough is None or rig.name not in rough:
        return rig
    length = np.full(rig.friction_ratio.size, rough[rig.name] / _DECAY)
    return replace(rig, at=replace(rig.at, conditions=replace(rig.at.conditions, decay_length=length)))


def _mixed() -> Calibration:
    """Half of the draws by each friction model."""
    halves = [_population("", closure=place).calibration().predictions for place in (0, 1)]
    predictions = tuple(
        replace(one, draws=np.concatenate([one.draws[::2], other.draws[::2]]))
        for one, other in zip(*halves, strict=True)
    )
    return Calibration(name="both friction models, half each", predictions=predictions)


WAYS = (
    Way(name="stick-slip, decay length unknown (shipped)", calibration=blind_calibration),
    Way(name="mean ratio of the other tests with its scatter", calibration=mean_ratio_calibration),
    _population("spring with loss of contact, decay length unknown", closure=1),
    Way(name="both friction models, half each", calibration=_mixed),
    _population("stick-slip, memory lengths nearly alike", prior=Prior(parameter_spread=(0.02, 0.1))),
    _population("stick-slip, decay lengths more alike", prior=Prior(length_spread=(0.4, 0.3))),
    _population("stick-slip, decay lengths less alike", prior=Prior(length_spread=(1.0, 0.3))),
    _population("stick-slip, smaller discrepancy", prior=Prior(discrepancy=(0.04, 0.3))),
    _population("stick-slip, larger discrepancy", prior=Prior(discrepancy=(0.15, 0.3))),
    _population("stick-slip, decay length about R_q/3 unworn where printed", rough=_UNWORN),
    _population("stick-slip, decay length about R_q/3 worn where printed (B, C, G)", rough=_WORN),
    _population(
        "stick-slip, decay length about R_q/3 worn on C and G alone",
        rough={name: height for name, height in _WORN.items() if name != "B"},
    ),
)


def _trial(seed: int) -> Record:
    way = WAYS[seed]
    found = way.calibration()
    gain = found.gain_over(mean_ratio_calibration())
    return {
        "name": way.name,
        "covered": [found.covered(probability) for probability in (0.5, 0.8, 0.95)],
        "crps": found.crps,
        "width": found.median_width,
        "gain": list(gain),
    }


def _measures(records: Sequence[Record]) -> list[Measure]:
    measures = [
        Measure(label=f"{record['name']}: within 50, 80, 95 %; CRPS; width; gain over the mean", value=_text(record))
        for record in records
    ]
    together = blind_calibration(SAME_TRIBOMETER)
    gain = together.gain_over(mean_ratio_calibration(SAME_TRIBOMETER))
    measures.append(
        Measure(
            label="shipped, sets A, C, D, E and F of one tribometer left out together",
            value=_text(
                {
                    "covered": [together.covered(p) for p in (0.5, 0.8, 0.95)],
                    "crps": together.crps,
                    "width": together.median_width,
                    "gain": list(gain),
                }
            ),
        )
    )
    return measures


def _text(record: Record) -> str:
    """Scores of a way in one line."""
    covered, gain = record["covered"], record["gain"]
    assert isinstance(covered, list)
    assert isinstance(gain, list)
    return (
        f"{'/'.join(map(str, covered))} of {_TESTS}; {float(str(record['crps'])):.3f};"
        f" {float(str(record['width'])):.2f}; {gain[0]:.3f} ({gain[1]:.3f} to {gain[2]:.3f})"
    )


STUDY = Study(
    title="Blind predictions of the published tests",
    question="Each published set is predicted from the others, with no roughness or one as printed: every way that was"
    " tried, with its score. The shipped one was chosen after these scores were known.",
    sources=tuple(f"prediction/{name}.py" for name in ("calibration", "evidence", "hierarchy", "posterior")),
    trials=len(WAYS),
    sample=2,
    trial=_trial,
    measures=_measures,
)
"""Blind predictions."""
