"""Numbers of the results of measurements for other uses: a table of numbers, rows of own runs, entries of a rig.

Results are those of `measurement_object`, in JSON. The standard error of a level within one test is left out of rows
and entries: friction of another test differs by more, and a prediction would take it for all of the uncertainty.
"""

import math
from collections.abc import Iterator, Mapping
from typing import Any, Final

from sonolube.text.units import format_quantity

_LEVELS: Final = {
    "friction_force": ("steady_friction_force", "friction_force", "mean_force"),
    "friction_coefficient": ("steady_friction_coefficient", "friction_coefficient", "mean_coefficient"),
}
_KEYS: Final = {
    "voltage_peak_to_peak": "drive.voltage_peak_to_peak",
    "vibration_amplitude": "vibration.vibration_amplitude",
    "frequency": "drive.frequency",
    "sliding_speed": "sliding.sliding_speed",
    "normal_load": "contact.normal_load",
    "amplitude_per_volt": "actuator.amplitude_per_volt",
}
"""Entries of a rig by the quantities that give them."""

_COEFFICIENT: Final = "friction.friction_coefficient"


def result_numbers(result: Mapping[str, Any]) -> Iterator[list[Any]]:
    """Part, quantity, value, standard uncertainty and unit of each number of a result."""
    values, tables = result.get("values"), result.get("tables")
    for name, entry in values.items() if isinstance(values, Mapping) else []:
        if isinstance(entry, Mapping):
            yield ["", name, entry.get("value"), entry.get("uncertainty"), entry.get("unit")]
    for table, entry in tables.items() if isinstance(tables, Mapping) else []:
        units, rows = (entry.get("units"), entry.get("rows")) if isinstance(entry, Mapping) else (None, None)
        for number, row in enumerate(rows if isinstance(rows, list) else [], start=1):
            for name, value in row.items() if isinstance(row, Mapping) else []:
                if value is not None:
                    unit = units.get(name) if isinstance(units, Mapping) else None
                    yield [f"{table} {number}", name, value, None, unit]


def _value(result: Mapping[str, Any], name: str) -> float | None:
    """Value of a quantity of a result."""
    values = result.get("values")
    entry = values.get(name) if isinstance(values, Mapping) else None
    return _finite(entry.get("value")) if isinstance(entry, Mapping) else None


def _level(result: Mapping[str, Any], kind: str) -> float | None:
    """Level of the friction of a whole recording, of its force or of its coefficient."""
    return next((found for name in _LEVELS[kind] if (found := _value(result, name)) is not None), None)


def _finite(value: Any) -> float | None:
    """Number; None for what is none."""
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    return float(value) if is_number and math.isfinite(value) else None


def _steps(result: Mapping[str, Any]) -> list[dict[str, float | None]]:
    """Steps of the voltage of a result."""
    tables = result.get("tables")
    steps = tables.get("steps") if isinstance(tables, Mapping) else None
    rows = steps.get("rows") if isinstance(steps, Mapping) else None
    found = [row for row in rows if isinstance(row, Mapping)] if isinstance(rows, list) else []
    return [{str(name): _finite(value) for name, value in row.items()} for row in found]


def result_run_rows(result: Mapping[str, Any], conditions: Mapping[str, float]) -> Iterator[dict[str, float | str]]:
    """Runs of a result: one a step with vibration, or the level of all of it."""
    title = str(result.get("title", ""))[:120]
    steps = _steps(result)
    for number, step in enumerate(steps, start=1):
        kind = next((each for each in _LEVELS if step.get(each) is not None), "friction_force")
        friction, reduction = step.get(kind), step.get("friction_reduction")
        if friction is None or reduction is None or reduction >= 1:
            continue
        row: dict[str, float | str] = {"run": f"{title} step {number}"} | {**conditions}
        row[kind], row[f"intrinsic_{kind}"] = friction, friction / (1 - reduction)
        for name in ("voltage_peak_to_peak", "sliding_speed"):
            if (own := step.get(name)) is not None:
                row[name] = own
        yield row
    levels = {kind: level for kind in _LEVELS if (level := _level(result, kind)) is not None}
    if not steps and levels:
        kind = next(iter(levels))
        yield {"run": title} | {**conditions, kind: levels[kind]}


def result_rig_entries(result: Mapping[str, Any], conditions: Mapping[str, float]) -> dict[str, str]:
    """Entries of a rig by a result and its conditions, as texts with units."""
    found = dict(conditions)
    for name in _KEYS:
        value = _value(result, name)
        if value is not None and value > 0:
            found[name] = value
    entries = {_KEYS[name]: format_quantity(value, name, digits=4) for name, value in found.items() if name in _KEYS}
    coefficient = _coefficient(result, conditions)
    return entries if coefficient is None else entries | {_COEFFICIENT: f"{coefficient:.4g}"}


def _coefficient(result: Mapping[str, Any], conditions: Mapping[str, float]) -> float | None:
    """Coefficient of dry friction: as measured, or by the force without vibration and the load."""
    load, steps = conditions.get("normal_load"), _steps(result)
    still: Mapping[str, float | None] = next((step for step in steps if step.get("voltage_peak_to_peak") == 0), {})
    vibrates = any(conditions.get(name) for name in ("voltage_peak_to_peak", "vibration_amplitude"))
    for kind, newton in (("friction_coefficient", 1.0), ("friction_force", load)):
        level = still.get(kind) if steps else None if vibrates else _level(result, kind)
        if level is not None and newton:
            return level / newton
    return None
