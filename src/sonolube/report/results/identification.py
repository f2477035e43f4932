"""Identified parameters of a rig, and causes of the decay length of a contact: rows, lines and objects for JSON."""

from dataclasses import asdict
from typing import Any

from sonolube.identification import DecayLengthDecision, Identification, Interval, SwitchConditions, SwitchTable
from sonolube.identification.decay_length.posterior import HYPOTHESES
from sonolube.models.actuator import PiezoStack
from sonolube.report.results.record_object import picked
from sonolube.text.units import format_si
from sonolube.vocabulary import quantities, si, unit_of


def parameter_rows(found: Identification) -> list[list[str]]:
    """Parameters with their ranges."""
    return [
        [name, *(format_si(value, unit_of(name)) for value in (estimate.value, estimate.lower, estimate.upper))]
        for name, estimate in found.estimates.items()
    ]


def fact_lines(found: Identification) -> list[str]:
    """Facts that hold and that do not, conflicts, and what the facts leave open."""
    satisfied = [fact.name for fact in found.facts if fact.name in found.satisfied]
    missed = [fact.name for fact in found.facts if fact.name not in found.satisfied]
    free = (
        [f"{name}^{power:.2g}" for name, power in each.exponents.items()] for each in found.unidentifiable_directions
    )
    return [
        f"  facts that hold: {', '.join(satisfied) or 'none'}",
        *([f"  facts that do not hold: {', '.join(missed)}"] if missed else []),
        *(f"  contradict each other: {', '.join(sorted(conflict))}" for conflict in found.conflicts),
        *(f"  not determined: {' '.join(product)}" for product in free),
    ]


def identification_object(found: Identification, stack: PiezoStack) -> dict[str, Any]:
    """Stack, parameters with their ranges, facts with their misses, conflicts and free directions."""
    return {
        "stack": si({name: value for name, value in asdict(stack).items() if value and name in quantities()}),
        "parameters": {name: si({name: known.value})[name] | asdict(known) for name, known in found.estimates.items()},
        "facts": [
            asdict(fact) | {"observed": found.observed[fact.name], "satisfied": fact.name in found.satisfied}
            for fact in found.facts
        ],
        "conflicts": [sorted(conflict) for conflict in found.conflicts],
        "unidentifiable_directions": [dict(direction.exponents) for direction in found.unidentifiable_directions],
    }


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
        *((HYPOTHESES[name].title, f"{100 * value:.1f} %") for name, value in by_probability),
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
