"""Text of the rig file of an optimised design."""

import json
from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

from sonolube.design.optimisation.drive_electronics import design_rig
from sonolube.design.optimisation.gradient_search import DesignPoint
from sonolube.design.optimisation.screening import DesignProblem
from sonolube.design.optimisation.space import OWN_ACTUATOR
from sonolube.rig import with_tables
from sonolube.vocabulary import quantities


def design_text(text: str, content: Mapping[str, Any], problem: DesignProblem, point: DesignPoint) -> str:
    """Rig file of a design point: the original file with the tables that the design changes.

    Parameters
    ----------
    text : str
        Text of the original file.
    content : mapping
        Its parsed content, including entries changed on the command line.
    problem : DesignProblem
    point : DesignPoint

    Returns
    -------
    str
    """
    rig = design_rig(problem, point)
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
    changed["stack"] = asdict(replace(rig.stack, coupling_factor=None))  # the stated one was of the unaltered stack
    changed["structure"] = {**problem.space.entries, **point.candidate.entries}
    assumptions = dict(content.get("assumptions", {}))
    assumptions["drive"] = f"optimised for a friction ratio of {problem.friction_ratio:.4g}"
    if "actuator" in content:
        changed["actuator"] = dict(content["actuator"]) | {"capacitance": rig.stack.free_capacitance}
        if "amplitude_per_volt" in content["actuator"]:
            changed["actuator"]["amplitude_per_volt"] = (
                float(point.evaluation.quantities["vibration_amplitude"][0]) / rig.voltage_peak_to_peak
            )
            assumptions["actuator.amplitude_per_volt"] = "computed at this drive"
    if "vibration" in content:
        assumptions = {key: text for key, text in assumptions.items() if not key.startswith("vibration.")}
        changed["vibration"] = {"amplitude_source": "computed"}  # what was measured was another design
    if point.candidate.actuator != OWN_ACTUATOR:
        assumptions["stack"] = (
            f"{problem.space.catalogue[point.candidate.actuator].title}, by its data sheet; quality"
            f" factor {problem.space.mechanical_quality_factor:g} assumed for its ceramic"
        )
    tables = [*changed.items(), ("assumptions", assumptions)]
    # the relative path of the schema holds only where the original file lies
    original = "\n".join(line for line in text.splitlines() if not line.startswith("#:schema"))
    return with_tables(original + "\n", "\n".join(_table(name, entries) for name, entries in tables))


def _table(name: str, entries: Mapping[str, Any]) -> str:
    """TOML text of a table."""
    lines = [f"{_key(key)} = {_value(key, value)}" for key, value in entries.items() if value is not None]
    return "\n".join([f"[{name}]", *lines]) + "\n"


def _key(key: str) -> str:
    """TOML text of a key, quoted where needed."""
    return key if key.replace("_", "").isalnum() else json.dumps(key)


def _value(key: str, value: Any) -> str:
    """TOML text of a value, a quantity with its unit."""
    unit = quantities()[key].unit if key in quantities() else ""
    if isinstance(value, bool | str | list | tuple) or not unit:
        return json.dumps(list(value) if isinstance(value, tuple) else value, ensure_ascii=False)
    return json.dumps(f"{float(value)!r} {unit}")
