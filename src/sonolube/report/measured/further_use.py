"""Numbers of the results of measurements for other uses: a table of numbers, rows of own runs, entries of a rig.

Results are those of `measurement_object`, in JSON.
"""

import math
from collections.abc import Iterator, Mapping
from typing import Any, Final

from sonolube.vocabulary import quantities

_LEVELS: Final = ("steady_friction_force", "friction_force", "mean_force")
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


def _value(result: Mapping[str, Any], name: str) -> tuple[float | None, float | None]:
    """Value and standard uncertainty of a quantity of a result."""
    values = result.get("values")
    entry = values.get(name) if isinstance(values, Mapping) else None
    if not isinstance(entry, Mapping):
        return None, None
    return _finite(entry.get("value")), _finite(entry.get("uncertainty"))


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
        force, reduction = step.get("friction_force"), step.get("friction_reduction")
        if force is None or reduction is None or reduction >= 1:
            continue
        row: dict[str, float | str] = {"run": f"{title} step {number}"} | {**conditions}
        row["friction_force"], row["intrinsic_friction_force"] = force, force / (1 - reduction)
        for name in ("voltage_peak_to_peak", "sliding_speed"):
            if (own := step.get(name)) is not None:
                row[name] = own
        if (error := step.get("friction_reduction_uncertainty")) is not None:
            row["friction_reduction_uncertainty"] = error
        yield row
    force, error = next((found for name in _LEVELS if (found := _value(result, name))[0] is not None), (None, None))
    if not steps and force is not None:
        row = {"run": title} | {**conditions, "friction_force": force}
        yield row if error is None else row | {"friction_force_uncertainty": error}


def result_rig_entries(result: Mapping[str, Any], conditions: Mapping[str, float]) -> dict[str, str]:
    """Entries of a rig by a result and its conditions, as texts with units."""
    found = dict(conditions)
    for name in _KEYS:
        value, _ = _value(result, name)
        if value is not None and value > 0:
            found[name] = value
    entries = {_KEYS[name]: f"{value:.4g} {quantities()[name].unit}" for name, value in found.items() if name in _KEYS}
    coefficient, error = _coefficient(result, conditions)
    if coefficient is not None:
        entries[_COEFFICIENT] = f"{coefficient:.4g}"
        if error:
            entries[f"uncertainty.{_COEFFICIENT}"] = f"normal {error:.2g}"
    return entries


def _coefficient(result: Mapping[str, Any], conditions: Mapping[str, float]) -> tuple[float | None, float | None]:
    """Coefficient of dry friction with its uncertainty: as measured, or by the force without vibration and the load."""
    value, error = _value(result, "mean_coefficient")
    if value is not None:
        return value, error
    load = conditions.get("normal_load")
    if not load:
        return None, None
    steps = _steps(result)
    if steps:
        without = next((step for step in steps if step.get("voltage_peak_to_peak") == 0), {})
        force, error = without.get("friction_force"), without.get("friction_force_uncertainty")
    else:
        vibrates = any(conditions.get(name) for name in ("voltage_peak_to_peak", "vibration_amplitude"))
        levels = [] if vibrates else [_value(result, name) for name in _LEVELS]
        force, error = next((each for each in levels if each[0] is not None), (None, None))
    if force is None:
        return None, None
    return force / load, None if error is None else error / load
