"""Identified parameters of a rig with their facts: rows, lines, and the object for JSON."""

from dataclasses import asdict
from typing import Any

from sonolube.identification import Identification
from sonolube.models.actuator import PiezoStack
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
