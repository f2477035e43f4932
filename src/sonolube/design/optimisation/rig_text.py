"""A design as a rig file, to be simulated, mapped and controlled as any other."""

import json
from collections.abc import Mapping
from typing import Any

from sonolube.actuator import PiezoStack
from sonolube.design.optimisation.electrical import design_rig
from sonolube.design.optimisation.local_search import Point
from sonolube.design.optimisation.screening import Task
from sonolube.design.optimisation.space import OWN
from sonolube.rig import with_tables
from sonolube.vocabulary import quantities

_STACK = (
    "free_capacitance",
    "free_stroke_per_volt",
    "stack_stiffness",
    "stack_damping",
    "stack_mass",
    "lowest_voltage",
    "highest_voltage",
    "preload",
)


def design_text(text: str, content: Mapping[str, Any], task: Task, point: Point) -> str:
    """Return a rig file with the tables that a design changes.

    Parameters
    ----------
    text : str
        The file that was optimised.
    content : mapping
        Its content, entries changed on the way included.
    task : Task
    point : Point

    Returns
    -------
    str
    """
    rig = design_rig(task, point)
    drive = rig.drive
    changed: dict[str, dict[str, Any]] = {
        name: {key: value for key, value in content[name].items() if not isinstance(value, dict)}
        for name in ("contact", "friction", "sliding")
    }
    changed["drive"] = dict(content["drive"]) | {
        name: getattr(drive, name) for name in ("voltage_peak_to_peak", "voltage_offset", "frequency", "waveform")
    }
    if drive.waveform_samples is None:
        changed["drive"].pop("waveform_samples", None)
    changed["stack"] = _stack(rig.stack)
    changed["structure"] = {**task.space.entries, **point.choice.entries}
    assumed = dict(content.get("assumptions", {}))
    assumed["drive"] = f"chosen for a friction ratio of {task.friction_ratio:.4g}"
    if "actuator" in content:
        changed["actuator"] = dict(content["actuator"]) | {"capacitance": rig.stack.free_capacitance}
        if "amplitude_per_volt" in content["actuator"]:
            changed["actuator"]["amplitude_per_volt"] = rig.vibration_amplitude / rig.voltage_peak_to_peak
            assumed["actuator.amplitude_per_volt"] = "computed at the drive chosen"
    if "vibration" in content:
        changed["vibration"] = {"vibration_amplitude": rig.vibration_amplitude}
    if point.choice.actuator != OWN:
        assumed["stack"] = (
            f"{task.space.catalogue[point.choice.actuator].title}, by its sheet; quality factor"
            f" {task.space.mechanical_quality_factor:g} taken for its ceramic"
        )
    tables = [*changed.items(), ("assumptions", assumed)]
    own = "\n".join(line for line in text.splitlines() if not line.startswith("#:schema"))  # it need not lie there
    return with_tables(own + "\n", "\n".join(_table(name, entries) for name, entries in tables))


def _stack(stack: PiezoStack) -> dict[str, Any]:
    return {name: getattr(stack, name) for name in _STACK if getattr(stack, name) is not None}


def _table(name: str, entries: Mapping[str, Any]) -> str:
    lines = [f"{_key(key)} = {_value(key, value)}" for key, value in entries.items() if value is not None]
    return "\n".join([f"[{name}]", *lines]) + "\n"


def _key(key: str) -> str:
    return key if key.replace("_", "").isalnum() else json.dumps(key)


def _value(key: str, value: Any) -> str:
    unit = quantities()[key].unit if key in quantities() else ""
    if isinstance(value, bool | str | list | tuple) or not unit:
        return json.dumps(list(value) if isinstance(value, tuple) else value, ensure_ascii=False)
    return json.dumps(f"{float(value)!r} {unit}")
