"""Causes of the decay length of a contact: probabilities, changes and caveats as text, and the object for JSON."""

from typing import Any

from sonolube.identification import DecayLengthDecision, Interval, SwitchConditions, SwitchTable
from sonolube.identification.decay_length.posterior import HYPOTHESES
from sonolube.report.results.record_object import picked
from sonolube.text.units import format_si

_FEW_DRAWS = 30.0  # effective, below which probabilities are coarse


def run_line(table: SwitchTable, known: SwitchConditions) -> str:
    """Run with its number of switches, distance and conditions."""
    values = (known.normal_load, "N"), (known.vibration_amplitude, "m"), (known.frequency, "Hz")
    settings = [format_si(value, unit) for value, unit in (*values, (known.sliding_speed, "m/s"))]
    distance = format_si(float(table.sliding_distance[-1]), "m")
    return f"{table.title}: {table.sliding_distance.size} switches over {distance}; {', '.join(settings)}"


def rows(found: DecayLengthDecision) -> list[tuple[str, str]]:
    """Probabilities of the hypotheses, the likeliest first, and the changes that were found."""
    by_probability = sorted(found.probabilities.items(), key=lambda item: -item[1])
    return [
        *((HYPOTHESES[name].partition(":")[0], f"{100 * value:.1f} %") for name, value in by_probability),
        ("decay length grows", f"by a factor of {_factor(found.growth)}"),
        ("amplitude falls", f"by a factor of {_factor(found.fall)}"),
        ("zero, if not subtracted", f"makes the decay length wrong by a factor of {_factor(found.zero_factor)}"),
        ("decay length", f"{_length(found.length_at_start)} at first, {_length(found.length_at_end)} at last"),
    ]


def decision_object(found: DecayLengthDecision, table: SwitchTable) -> dict[str, Any]:
    """Verdict, advice, probabilities, changes with their 80 % intervals, and misfits."""
    return {
        **picked(found, "verdict", "decided", "leading", "advice"),
        "probabilities": dict(found.probabilities),
        **{name: _interval(getattr(found, name), "") for name in ("growth", "fall", "zero_factor")},
        "decay_length_at_start": _interval(found.length_at_start, "m"),
        "decay_length_at_end": _interval(found.length_at_end, "m"),
        "misfits": dict(found.misfits),
        "effective_draws": found.effective_draws,
        "switches": int(table.sliding_distance.size),
    }


def decision_caveats(table: SwitchTable, conditions: SwitchConditions, found: DecayLengthDecision) -> list[str]:
    """Data that a run lacks, and assumptions of the analysis."""
    caveats = [*table.caveats]
    caveats += [f"{name} is read at fewer than eight switches and does not enter" for name in table.missing]
    if {"small_drive_shift", "large_drive_shift"} - set(table.missing) and conditions.natural_frequency is None:
        caveats.append("the free frequency is not stated: shifts count as small against the frequency of the mode")
    if found.effective_draws < _FEW_DRAWS:
        caveats.append("few effective draws: probabilities are coarse; try another seed")
    return [
        *caveats,
        "a zero that is off only under load is not seen with the pin lifted",
        "decay lengths rest on asperity stick-slip",
    ]


def _interval(found: Interval, unit: str) -> dict[str, Any]:
    """Median and ends of an interval with their unit."""
    return {"value": found.median, "lower": found.lower, "upper": found.upper, "unit": unit}


def _factor(found: Interval) -> str:
    """Factor with its 80 % interval."""
    return f"{found.median:.2f} (80 %: {found.lower:.2f} to {found.upper:.2f})"


def _length(found: Interval) -> str:
    """Length with its 80 % interval."""
    return f"{1e6 * found.median:.2f} um (80 %: {1e6 * found.lower:.2f} to {1e6 * found.upper:.2f})"
