"""Virtual map tests through the analysis of friction at voltage steps: is what is returned what was recorded?"""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from reliability.recorded_protocol import TrueForces, recorded_protocol
from reliability.study import Measure, Record, Study
from sonolube.measurement.friction_analysis import analyse_voltage_steps
from sonolube.rig import Rig, read_rig

_RIG = Path(__file__).parents[2] / "examples" / "rigs" / "power_map.toml"
_LOWEST, _HIGHEST = 0.8, 1.2  # of the root mean square of deviation over uncertainty


@cache
def _rig() -> Rig:
    return read_rig(_RIG)


def _trial(seed: int) -> Record:
    record, truth = recorded_protocol(_rig(), "map_test", seed=seed)
    (recording,) = record.datasets(with_speed=False)
    steps = analyse_voltage_steps(recording)
    forces = TrueForces(truth)
    force = [forces.at(step) for step in steps]
    return {
        "steps": len(steps),
        "force": [
            (step.friction_force - known) / step.friction_force_uncertainty
            for step, known in zip(steps, force, strict=True)
        ],
        "reduction": [
            (step.friction_reduction - (1 - known / force[0])) / (step.friction_reduction_uncertainty or np.nan)
            for step, known in zip(steps, force, strict=True)
            if step.friction_reduction is not None
        ],
    }


def _measures(records: Sequence[Record]) -> list[Measure]:
    def spread(name: str) -> float:
        return float(np.sqrt(np.mean(np.concatenate([_numbers(record, name) for record in records]) ** 2)))

    bar = f"{_LOWEST} to {_HIGHEST}"
    found = {"friction at a step": spread("force"), "its reduction": spread("reduction")}
    missed = sum(int(str(record["steps"])) != 6 for record in records)
    return [
        Measure(label="tests whose six steps were not found", value=str(missed), bar="0", holds=not missed),
        *(
            Measure(
                label=f"root mean square of deviation over stated uncertainty, {name}",
                value=f"{value:.2f}",
                bar=bar,
                holds=_LOWEST <= value <= _HIGHEST,
            )
            for name, value in found.items()
        ),
    ]


def _sample_measures(records: Sequence[Record]) -> list[Measure]:
    """Bars for few tests, whose root mean square scatters."""
    missed, *others = _measures(records)
    wide = [0.5 < float(each.value) < 1.7 for each in others]
    return [
        missed,
        *(Measure(label=e.label, value=e.value, bar="0.5 to 1.7", holds=h) for e, h in zip(others, wide, strict=True)),
    ]


def _numbers(record: Mapping[str, Any], name: str) -> np.ndarray:
    """Numbers of a record."""
    return np.asarray(record[name], dtype=float)


STUDY = Study(
    title="Virtual tests through the analysis",
    question="The map test of the dissertation on the virtual tribometer, with wobble, run-in, ringing, noise, drift"
    " and hysteresis, through the analysis of voltage steps: is friction within its uncertainty of what was given?",
    sources=("laboratory/virtual_tribometer/*.py", "measurement/friction/*.py"),
    trials=100,
    sample=6,
    trial=_trial,
    measures=_measures,
    sample_measures=_sample_measures,
)
"""Virtual map tests."""
