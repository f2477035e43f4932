"""The short protocols of friction on the virtual tribometer: are levels within their uncertainty of what was given?"""

from collections import Counter
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
_STEPS = {"map_test": 6, "temperature_test": 6, "lubrication_comparison": 108}
_LOWEST, _HIGHEST = 0.8, 1.2  # of the standard deviation of z
_FALSE_ALARMS = 1e-3
_FARTHEST = 4.0  # of |z| in few tests


@cache
def _rig() -> Rig:
    return read_rig(_RIG)


def _trial(seed: int) -> Record:
    return {name: _scores(name, seed) for name in _STEPS}


def _scores(protocol: str, seed: int) -> dict[str, list[float]]:
    """Deviation over uncertainty of all levels and reductions, and the number of steps with stick-slip."""
    record, truth = recorded_protocol(_rig(), protocol, seed=seed)
    forces, times = TrueForces(truth), Counter[tuple[float, float | None]]()
    levels: list[float] = []
    reductions: list[float] = []
    sticking = 0
    for recording in record.datasets(with_speed=protocol == "lubrication_comparison"):
        steps = analyse_voltage_steps(recording)
        known = [_next(forces, times, step) for step in steps]
        for step, force in zip(steps, known, strict=True):
            levels.append((step.friction_force - force) / step.friction_force_uncertainty)
            sticking += step.stick_slip.detected
            if step.friction_reduction is not None and step.friction_reduction_uncertainty:
                error = step.friction_reduction - (1 - force / known[0])
                reductions.append(error / step.friction_reduction_uncertainty)
    return {"force": levels, "reduction": reductions, "sticking": [float(sticking)]}


def _next(forces: TrueForces, times: Counter[tuple[float, float | None]], step: Any) -> float:
    """True force at a step, for the next time that its voltage and speed were set."""
    speed = None if step.sliding_speed is None else round(step.sliding_speed, 6)
    setting = round(step.voltage_peak_to_peak, 3), speed
    times[setting] += 1
    return forces.at(step, time=times[setting] - 1)


def _pooled(records: Sequence[Mapping[str, Any]], protocol: str, name: str) -> np.ndarray:
    """Numbers of all records of a protocol."""
    return np.concatenate([np.asarray(record[protocol][name], dtype=float) for record in records])


def _measures(records: Sequence[Record]) -> list[Measure]:
    measures = _missed(records)
    for protocol in _STEPS:
        for name, label in (("force", "friction"), ("reduction", "its reduction")):
            z = _pooled(records, protocol, name)
            if z.size:
                spread = float(np.sqrt(np.mean(z**2)))
                measures.append(
                    Measure(
                        label=f"root mean square of deviation over stated uncertainty, {label} of {protocol}",
                        value=f"{spread:.2f} of {z.size}",
                        bar=f"{_LOWEST} to {_HIGHEST}",
                        holds=_LOWEST <= spread <= _HIGHEST,
                    )
                )
    return measures


def _missed(records: Sequence[Record]) -> list[Measure]:
    """Levels that were not found as they were set, and stick-slip where there is none."""
    found = []
    for protocol, count in _STEPS.items():
        wrong = sum(len(record[protocol]["force"]) != count for record in records)  # type: ignore[index]
        found.append(
            Measure(label=f"{protocol} without its {count} levels", value=f"{wrong}", bar="0", holds=not wrong)
        )
    sticking = int(sum(_pooled(records, protocol, "sticking").sum() for protocol in _STEPS))
    share = sticking / (len(records) * sum(_STEPS.values()))
    label = "levels at which stick-slip is found, where there is none"
    return [*found, Measure(label=label, value=f"{share:.3%}", bar="below 0.1 %", holds=share < _FALSE_ALARMS)]


def _sample_measures(records: Sequence[Record]) -> list[Measure]:
    """Bars for few tests: each level is near its truth."""
    farthest = max(float(np.abs(_pooled(records, protocol, "force")).max()) for protocol in _STEPS)
    label = "largest deviation over stated uncertainty"
    bar = f"below {_FARTHEST:g}"
    return [*_missed(records), Measure(label=label, value=f"{farthest:.2f}", bar=bar, holds=farthest < _FARTHEST)]


STUDY = Study(
    title="Short protocols on the virtual tribometer",
    question="Map test, temperature test and comparison of lubrication, with rest, break-away and nine speeds in one"
    " recording, through the analysis of steps: is each level within its uncertainty of what was given?",
    sources=("laboratory/virtual_tribometer/*.py", "measurement/friction/*.py"),
    trials=50,
    sample=1,
    trial=_trial,
    measures=_measures,
    sample_measures=_sample_measures,
)
