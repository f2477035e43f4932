"""Every friction model at random operating points of every example rig: nothing beyond its range passes as a result."""

import random
import warnings
from collections.abc import Sequence
from dataclasses import fields, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from reliability.study import Measure, Record, Study
from sonolube.errors import ModelRangeWarning
from sonolube.models.friction import FRICTION_MODELS
from sonolube.models.friction.models.range_check import OUTSIDE_MODEL_RANGE
from sonolube.rig import STATUSES, Rig, friction_point, operating_points, point_batch, read_rig

_RIGS = Path(__file__).parents[2] / "examples" / "rigs"
_HARD_MODELS = [name for name, model in FRICTION_MODELS.items() if not model.for_soft_bodies]
_POINTS = 12  # of a computed vibration in a trial
_CLOSE = 3e-4  # of the friction ratio, the error of tabulated ratios and of averages


@cache
def _rigs() -> tuple[Rig, ...]:
    return tuple(read_rig(path) for path in sorted(_RIGS.glob("*.toml")))


def _own_amplitude(rig: Rig) -> float:
    """Amplitude that the file states for its own drive, in m."""
    if rig.waveguide_amplitude is not None:
        return rig.waveguide_amplitude
    volts = rig.drive.voltage_peak_to_peak if rig.drive is not None else None
    return rig.vibration_amplitude or (rig.amplitude_per_volt or 0.0) * (volts or 0.0)


def _changed(rig: Rig, rng: random.Random) -> Rig:
    """Rig with another load, speed, amplitude, roughness and friction model, each by up to a factor of three to ten."""
    roughness = rng.choice((0.3, 1.0, 1.0, 2.0))
    contact = replace(
        rig.contact, roughness=replace(rig.contact.roughness, rms_height=rig.contact.roughness.rms_height * roughness)
    )
    return replace(
        rig,
        contact=contact,
        normal_load=rig.normal_load * 10 ** rng.uniform(-0.5, 0.3),
        sliding_speed=rig.sliding_speed * 10 ** rng.uniform(-1, 1),
        vibration_amplitude=_own_amplitude(rig) * 10 ** rng.uniform(-1, 0.7),
        amplitude_source="computed" if rig.structure is not None else "measured",
        friction_model=FRICTION_MODELS[rng.choice(_HARD_MODELS)](),
    )


def _beyond(rig: Rig, ratio: float) -> bool:
    """Whether a ratio is friction beyond mu F_N, or against the sign that the model can have."""
    elastic = rig.friction_model.name.startswith("dong_2015")
    return bool(ratio > 1 + _CLOSE or ratio < (-_CLOSE if elastic else -1 - _CLOSE))


def _stated(rig: Rig) -> dict[str, int]:
    """Counts for a sine of the amplitude of a rig, without its structure."""
    known = {each.name: getattr(rig, each.name) for each in fields(rig) if each.init}
    sine: dict[str, Any] = known | {"stack": None, "structure": None, "amplitude_source": "measured"}
    point = friction_point(Rig(**sine))
    outside = point.status == OUTSIDE_MODEL_RANGE
    return {
        "points": 1,
        "outside": int(outside),
        "raw_beyond": int(_beyond(rig, point.raw_friction_ratio)),
        "passed": int(not outside and (np.isnan(point.friction_ratio) or _beyond(rig, point.friction_ratio))),
        "unsaid": int(outside and not (point.reason or "").startswith(OUTSIDE_MODEL_RANGE)),
        "numbers": int(outside and not np.isnan(point.friction_force)),
        "apart": 0,
    }


def _computed(rig: Rig, rng: random.Random) -> dict[str, int]:
    """Counts for computed vibrations of a rig, one by one in a grid and as a batch."""
    assert rig.drive is not None
    volts = np.array([10 ** rng.uniform(-1, 0.6) for _ in range(_POINTS)]) * (rig.drive.voltage_peak_to_peak or 1.0)
    speeds = rig.sliding_speed * np.array([10 ** rng.uniform(-1, 1) for _ in range(_POINTS)])
    settings: Any = {
        "voltage_peak_to_peak": volts,
        "voltage_offset": rig.drive.offset_ratio * volts,
        "sliding_speed": speeds,
    }
    grid, batch = operating_points(rig, **settings), point_batch(rig, **settings)
    statuses = np.array([STATUSES[code] for code in batch.status])
    reasons = np.array([batch.reasons[code] for code in batch.reason])
    outside = statuses == OUTSIDE_MODEL_RANGE
    ratio = batch.numbers["friction_ratio"]
    same = np.isclose(grid.friction_ratio, ratio, atol=_CLOSE, equal_nan=True)
    same &= np.isclose(grid.raw_friction_ratio, batch.numbers["raw_friction_ratio"], atol=_CLOSE, equal_nan=True)
    vibrating = ~np.isin(statuses, ("refused", "not_converged"))
    said = np.char.str_len(reasons) > 30
    return {
        "points": _POINTS,
        "outside": int(outside.sum()),
        "raw_beyond": sum(_beyond(rig, value) for value in batch.numbers["raw_friction_ratio"]),
        "passed": int(sum(_beyond(rig, value) for value in ratio) + np.isnan(ratio[vibrating & ~outside]).sum()),
        "unsaid": int((~said & ~np.isin(statuses, ("periodic",))).sum()),
        "numbers": int((~np.isnan(batch.numbers["friction_force"][outside])).sum()),
        "apart": int((~same | (grid.status != statuses)).sum()),
    }


def _trial(seed: int) -> Record:
    rng = random.Random(seed)
    rig = _changed(_rigs()[seed % len(_rigs())], rng)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelRangeWarning)  # roughness out of the usual range is no subject here
        counts = _stated(rig)
        if rig.structure is not None and rig.drive is not None:
            counts = {name: count + counts[name] for name, count in _computed(rig, rng).items()}
    return {"model": rig.friction_model.name, **counts}


def _measures(records: Sequence[Record]) -> list[Measure]:
    def total(name: str) -> int:
        return sum(int(str(record[name])) for record in records)

    bars = (
        ("passed", "ratios beyond the range of the model with another status"),
        ("unsaid", "points outside without a reason"),
        ("numbers", "points outside with a friction force"),
        ("apart", "points whose batch and grid disagree"),
    )
    points = total("points")
    return [
        *(
            Measure(label=label, value=f"{total(name)} of {points}", bar="0", holds=total(name) == 0)
            for name, label in bars
        ),
        Measure(label="formulae beyond the range of the model", value=f"{total('raw_beyond')} of {points}"),
        Measure(label="points outside_model_range, closed gaps among them", value=f"{total('outside')} of {points}"),
    ]


STUDY = Study(
    title="Range of validity of friction models",
    question="Every friction model at random loads, amplitudes, speeds and roughnesses of every example rig: a failure"
    " is a friction beyond what the model can mean that passes as a result.",
    sources=("models/friction/models/*.py", "rig/friction_and_wear.py", "rig/operating_point*.py"),
    trials=2000,
    sample=22,
    trial=_trial,
    measures=_measures,
)
