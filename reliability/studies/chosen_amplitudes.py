"""Amplitudes that are chosen for a reduction with 9 chances in 10, on synthetic rigs: how often it is reached."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from reliability.studies.own_runs import SOURCES
from reliability.study import Measure, Record, Study
from reliability.synthetic_rigs import stepped_stick_slip_ratio, true_ratios
from sonolube.checks import Floats
from sonolube.prediction.chances import ReductionChances
from sonolube.prediction.evidence import REFERENCE_DECAY_LENGTH, TestedRig
from sonolube.prediction.hierarchy import binomial_interval
from sonolube.prediction.inputs import RigInputs, rig_inputs
from sonolube.prediction.posterior import learned
from sonolube.prediction.predictive import rig_prediction
from sonolube.rig import Rig, read_rig

_REDUCTION, _CONFIDENCE = 0.4, 0.9
_DRAWS = 2000
_AMPLITUDES = np.geomspace(0.1e-6, 30e-6, 81)  # m, of the truth
_RUN = 48  # place of the run that is made
_NOISE = 0.05
_RIG = Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml"


def _trial(seed: int) -> Record:
    rng = np.random.default_rng([seed, 31])
    inputs = _inputs(rng)
    truth = _truth(rng, inputs)
    record: dict[str, object] = {}
    for name, own in (("without", None), ("after", _run(rng, inputs, truth))):
        found = rig_prediction(learned().friction, inputs.at(), count=_DRAWS, own=own)
        chances = ReductionChances(inputs=inputs, prediction=found)
        chosen = chances.least_amplitude(
            _REDUCTION, confidence=_CONFIDENCE, highest=float(_AMPLITUDES[-1]), frequency=inputs.frequency
        )
        record[f"chosen_{name}"] = chosen
        if chosen is not None:
            ratio = float(np.interp(np.log(chosen), np.log(_AMPLITUDES), truth))
            record[f"reached_{name}"] = bool(1 - ratio >= _REDUCTION)
    return record


def _measures(records: Sequence[Record]) -> list[Measure]:
    measures = []
    for name, label in (("without", "without runs"), ("after", "after one run of each rig")):
        known = [bool(record[f"reached_{name}"]) for record in records if record[f"chosen_{name}"] is not None]
        if not known:
            continue
        share, (low, high) = float(np.mean(known)), binomial_interval(sum(known), len(known))
        measures.append(
            Measure(
                label=f"rigs on which the amplitude chosen {label} gives the reduction (95 % binomial interval)",
                value=f"{100 * share:.1f} % of {len(known)} ({100 * low:.1f} to {100 * high:.1f})",
                bar="84 to 95 %",
                holds=0.84 <= share <= 0.95 or len(records) < 200,
            )
        )
    both = [r for r in records if r["chosen_without"] is not None and r["chosen_after"] is not None]
    moved = [abs(np.log(float(str(r["chosen_after"])) / float(str(r["chosen_without"])))) > 0.05 for r in both]
    measures.append(
        Measure(
            label="rigs whose chosen amplitude moves by more than 5 % with one run",
            value=f"{100 * float(np.mean(moved)) if moved else 0:.0f} % of {len(moved)}",
            bar="at least 80 %",
            holds=not moved or float(np.mean(moved)) >= 0.8,
        )
    )
    return measures


def _inputs(rng: np.random.Generator) -> RigInputs:
    """Inputs of a rig at a speed and a frequency."""
    speed, frequency = np.exp(rng.uniform(np.log(0.02), np.log(0.1))), rng.uniform(18e3, 22e3)
    return rig_inputs(_rig(f"sliding.sliding_speed={speed:.6g}m/s", f"drive.frequency={frequency:.6g}Hz"))


def _rig(*changes: str) -> Rig:
    """Shipped rig with changes."""
    return read_rig(_RIG, changes=list(changes))


def _truth(rng: np.random.Generator, inputs: RigInputs) -> Floats:
    """True friction ratios over the amplitudes, of a rig drawn from what was learned."""
    draws = learned().friction.hyperparameters
    mu, kappa, tau, tau_l, sigma, length = draws[rng.integers(len(draws))]
    memory = np.exp(mu + np.exp(tau) * rng.standard_normal())
    decay = REFERENCE_DECAY_LENGTH * np.exp(kappa + np.exp(tau_l) * rng.standard_normal())
    true_a = _AMPLITUDES * np.exp(inputs.amplitude.spread * rng.standard_normal())
    slow = inputs.sliding_speed * decay / (2 * np.pi * inputs.frequency * true_a * memory)
    mean = stepped_stick_slip_ratio(true_a / decay, slow)
    effect = np.minimum(true_a / (0.2 * decay), 1.0) / (1 + slow**2)
    logs = np.log(np.stack([_AMPLITUDES, np.full(_AMPLITUDES.size, inputs.sliding_speed)]))
    return true_ratios(rng, mean, effect, logs, sigma=sigma, length=length)


def _run(rng: np.random.Generator, inputs: RigInputs, truth: Floats) -> TestedRig:
    """One measured run of the rig."""
    measured = truth[_RUN] + _NOISE * rng.standard_normal()
    return TestedRig(
        name="run",
        at=inputs.at(vibration_amplitude=_AMPLITUDES[_RUN]),
        friction_ratio=np.array([measured]),
        uncertainty=np.array([_NOISE]),
    )


STUDY = Study(
    title="Amplitudes chosen for a chance",
    question="On rigs drawn from what was learned, the least amplitude is chosen at which friction falls by 40 % with"
    " 9 chances in 10, without own runs and after one: on how many does it fall so far? The truth is stepped through"
    " a period by code outside the package.",
    sources=(*SOURCES, "prediction/chances.py"),
    trials=200,
    sample=1,
    trial=_trial,
    measures=_measures,
)
"""Chances in decisions."""
