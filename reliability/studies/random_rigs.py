"""Random legal rigs through friction, wear, predict, heat, sweep, map and the terminal: one status, and its limits."""

import json
import random
import subprocess
import sys
import warnings
from collections.abc import Sequence
from functools import partial
from math import isclose
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import sonolube as sl
from reliability.study import Measure, Record, Study
from sonolube.design import grid_plan, sweep, velocity_amplitude_map
from sonolube.errors import ModelRangeWarning, SonolubeError
from sonolube.rig import Rig, read_rig
from sonolube.tasks.answer import Answer

_MODELS = ("asperity_stick_slip",) * 3 + ("kinematic", "dong_2015_full_period", "dong_2015_half_period")
_FURTHER, _ON_TERMINAL = 25, 250  # every so many trials go through all tasks, and through the terminal
_POINTS = 9  # of a sweep and of a map
_CLOSE = 1e-3  # of a friction ratio: tables and averages of the models
_PIN, _DISC = "stainless_steel_316", "aluminium_2024"


def _rig_text(rng: random.Random) -> str:
    """File of a rig of hard bodies whose entries are drawn evenly in their logarithms."""

    def log(low: float, high: float) -> float:
        return float(low * (high / low) ** rng.random())

    height, radius = log(0.1e-6, 10e-6), log(1e-6, 50e-6)
    decay = f'decay_length = "{log(0.3e-6, 5e-6):.6g} m"\n' if rng.random() < 0.5 else ""
    return f"""title = "random rig"
source = "drawn"
[contact]
normal_load = "{log(0.1, 1e3):.6g} N"
nominal_area = "{log(1e-7, 1e-4):.6g} m2"
{decay}[contact.roughness]
rms_height = "{height:.6g} m"
summit_radius = "{radius:.6g} m"
summit_density = "{log(0.02, 0.1) / (height * radius):.6g} 1/m2"
[contact.pair]
effective_modulus = "{log(30e9, 250e9):.6g} Pa"
poisson_ratio = 0.3
yield_strength = "{log(100e6, 2.5e9):.6g} Pa"
[friction]
friction_coefficient = {log(0.05, 1.2):.6g}
model = "{rng.choice(_MODELS)}"
[sliding]
sliding_speed = "{log(1e-6, 30.0):.6g} m/s"
[drive]
frequency = "{log(1e3, 1e5):.6g} Hz"
[vibration]
vibration_amplitude = "{log(1e-9, 50e-6):.6g} m"
"""


def _asked(task: Any, rig: Rig, **arguments: Any) -> Answer | str:
    """Answer of a task, or its refusal."""
    try:
        answer: Answer = task(rig, **arguments)
    except SonolubeError as refusal:
        return str(refusal)
    return answer


def _number(answer: dict[str, Any], name: str) -> float:
    """Quantity of an object; NaN where it has none."""
    value = answer.get(name)
    found = value.get("value") if isinstance(value, dict) else None
    return float("nan") if found is None else float(found)


def _compared(friction: Answer | str, wear: Answer | str) -> dict[str, object]:
    """Status of friction and wear of one rig beside each other."""
    if isinstance(friction, str) or isinstance(wear, str):
        return {"refused": 1, "apart": int(isinstance(friction, str) != isinstance(wear, str))}
    one, other = friction.json_object(), wear.json_object()
    ratio, worn = _number(one, "friction_ratio"), _number(other, "wear_rate_ratio")
    outside = one["status"] == "outside_model_range"
    return {
        "refused": 0,
        "outside": int(outside),
        "apart": int(one["verdict"] != other["verdict"] or one["verdict_reasons"] != other["verdict_reasons"]),
        "worn_more": int(worn > 1 + 1e-6),
        "worn_outside": int(outside and np.isfinite(worn)),
        "unsaid_wear": int(worn > 1 + 1e-6 and not any("is above 1" in line for line in other["caveats"])),
        "unsaid_friction": int(ratio > 1 + 1e-6 and not any("is above 1" in line for line in one["caveats"])),
        "unsaid_reason": int((not np.isfinite(ratio)) != outside or (outside and not one.get("reason"))),
    }


def _predicted(rig: Rig, friction: Answer | str) -> dict[str, object]:
    """Prediction and heat of a rig: one verdict with friction, ratios within their limits, heat by the force."""
    found = _asked(partial(sl.predict, pin=_PIN, disc=_DISC, draws=400), rig)
    heat = _asked(partial(sl.thermal, pin=_PIN, disc=_DISC), rig)
    counts: dict[str, int] = {"predicted": int(not isinstance(found, str)), "predicted_apart": 0, "beyond_limits": 0}
    if isinstance(found, str) or isinstance(friction, str):
        return {**counts, "predicted_apart": int(isinstance(friction, str) and not isinstance(found, str))}
    content, verdict = found.object(), friction.object()["verdict"]
    counts["predicted_apart"] += int(content["verdict"] != verdict)
    if not isinstance(heat, str):
        counts["predicted_apart"] += int(heat.object()["verdict"] != verdict)
        face, spot = (_number(heat.object(), name) for name in ("mean_temperature_rise", "spot_temperature_rise"))
        counts["beyond_limits"] += int(spot < (1 - _CLOSE) * face)  # the spot lies within the face
    lows = [min(content[name]["interval_95"]) for name in ("friction_ratio", "friction_force") if name in content]
    counts["beyond_limits"] += int(min(lows) < 0)
    return {**counts}


def _swept(rig: Rig, rng: random.Random) -> dict[str, object]:
    """Sweep and map about a rig: order and threads change no point, each is that of `friction`, and is monotonic."""
    a, v = rig.vibration_amplitude or 1e-6, rig.sliding_speed
    amplitudes, speeds = a * np.geomspace(0.2, 1, 3), v * np.geomspace(0.3, 3, 3)
    keys = {"vibration.vibration_amplitude": amplitudes, "sliding.sliding_speed": speeds}
    try:
        whole = sweep(grid_plan(rig, over=keys))
        parts = sweep(
            grid_plan(rig, over={key: values[::-1] for key, values in keys.items()}), chunk_points=2, workers=2
        )
        mapped = velocity_amplitude_map(
            rig, sliding_speed=speeds, vibration_amplitude=amplitudes, normal_load=[rig.normal_load]
        )
    except SonolubeError:
        return {"swept": 0}
    ratio = whole["friction_ratio"].values
    turned = parts["friction_ratio"].values[::-1, ::-1]
    reduction = mapped["friction_reduction"].squeeze("normal_load", drop=True)
    on_map = 1 - reduction.transpose("vibration_amplitude", "sliding_speed").values
    one = rng.randrange(3), rng.randrange(3)
    alone = rig.replace("vibration.vibration_amplitude", f"{float(amplitudes[one[0]])!r} m")
    alone = alone.replace("sliding.sliding_speed", f"{float(speeds[one[1]])!r} m/s")
    answer = _asked(partial(sl.friction, interval=False), alone)
    single = float("nan") if isinstance(answer, str) else _number(answer.object(), "friction_ratio")
    monotonic = rig.friction_model.name == "asperity_stick_slip"
    falls, rises = np.diff(ratio, axis=0), np.diff(ratio, axis=1)
    return {
        "swept": 1,
        "order": int(not np.allclose(ratio, turned, atol=1e-9, equal_nan=True)),
        "map_apart": int(not np.allclose(ratio, on_map, atol=_CLOSE, equal_nan=True)),
        "point_apart": int(not np.allclose(ratio[one], single, atol=_CLOSE, equal_nan=True)),
        "not_monotonic": int(monotonic and bool(np.any(falls > _CLOSE) or np.any(rises < -_CLOSE))),
    }


def _on_terminal(path: Path, answers: dict[str, Answer | str]) -> dict[str, object]:
    """Answers of the terminal that differ from those of Python."""
    apart = 0
    for name, answer in answers.items():
        command = [sys.executable, "-m", "sonolube", name, str(path), "--json"]
        ran = subprocess.run(command, capture_output=True, text=True, check=False, cwd=path.parent)
        if isinstance(answer, str):
            apart += int(ran.returncode != 2 or answer.partition(":")[0] not in ran.stderr)
        else:
            same = ran.returncode == 0 and _same(json.loads(ran.stdout) | {"files": 0}, _plain(answer) | {"files": 0})
            apart += int(not same)
    return {"terminal": len(answers), "terminal_apart": apart}


def _same(one: Any, other: Any) -> bool:
    """Whether two answers have the same keys and words, and numbers to 1e-12."""
    if isinstance(one, dict) and isinstance(other, dict):
        return list(one) == list(other) and all(_same(one[key], other[key]) for key in one)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(_same, one, other))
    if isinstance(one, float) and isinstance(other, float | int):
        return isclose(one, other, rel_tol=1e-12, abs_tol=1e-300)
    return bool(one == other)


def _plain(answer: Answer) -> dict[str, Any]:
    """Object of an answer after a pass through JSON."""
    content: dict[str, Any] = json.loads(answer.to_json())
    return content


def _trial(seed: int) -> Record:
    rng = random.Random(seed)
    text = _rig_text(rng)
    with TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore", ModelRangeWarning)
        path = Path(folder) / "random.toml"
        path.write_text(text, encoding="utf-8")
        rig = read_rig(path)
        answers = {"friction": _asked(sl.friction, rig), "wear": _asked(sl.wear, rig)}
        record = _compared(answers["friction"], answers["wear"])
        if seed % _FURTHER == 0:
            record |= _predicted(rig, answers["friction"]) | _swept(rig, rng)
        if seed % _ON_TERMINAL == 0:
            record |= _on_terminal(path, answers)
    return record


def _total(records: Sequence[Record], name: str) -> int:
    return sum(int(str(record.get(name, 0))) for record in records)


def _measures(records: Sequence[Record]) -> list[Measure]:
    bars = (
        ("apart", "rigs that friction and wear refuse or judge differently"),
        ("worn_outside", "wear ratios where friction is outside the range of its model"),
        ("unsaid_wear", "wear ratios above 1 without a word"),
        ("unsaid_friction", "friction ratios above 1 without a word"),
        ("unsaid_reason", "friction without a number and without a reason, or the reverse"),
        ("predicted_apart", "rigs that predict or thermal judges in another way than friction"),
        ("beyond_limits", "negative ratios and forces of a prediction, and real spots cooler than the face"),
        ("order", "sweeps that order or threads change"),
        ("map_apart", "maps that differ from the sweep"),
        ("point_apart", "points of a sweep that differ from friction alone"),
        ("not_monotonic", "stick-slip that rises with amplitude or falls with speed"),
        ("terminal_apart", "answers of the terminal that differ from those of Python"),
    )
    return [
        *(
            Measure(label=label, value=f"{_total(records, name)}", bar="0", holds=_total(records, name) == 0)
            for name, label in bars
        ),
        *(
            Measure(label=label, value=f"{_total(records, name)}")
            for name, label in (
                ("refused", "rigs refused, as their load leaves no separation"),
                ("outside", "rigs outside the range of their friction model"),
                ("worn_more", "wear ratios above 1, all said"),
                ("predicted", "rigs predicted"),
                ("swept", "rigs swept and mapped"),
                ("terminal", "answers of the terminal"),
            )
        ),
    ]


STUDY = Study(
    title="Random rigs",
    question="Legal rigs of hard bodies, drawn evenly in the logarithms of all entries, go through friction and wear;"
    " every 25th through predict, thermal, a sweep and a map of nine points, and every 250th through the terminal. A"
    " failure is a verdict that differs between them, a number outside a model's range, or a point that order, threads"
    " or the terminal change.",
    sources=(
        *("rig/*.py", "prediction/verdict.py", "prediction/applicability.py", "prediction/live_prediction.py"),
        *("design/maps.py", "design/parameter_sweep.py", "tasks/predict/*.py"),
    ),
    trials=5000,
    sample=3,
    trial=_trial,
    measures=_measures,
)
