"""Identified parameters as the tables `stack` and `structure` of a rig file, with the verdict on each fact."""

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict

from sonolube.identification.fact import Fact, parameter_unit
from sonolube.identification.result import Identification, ParameterEstimate
from sonolube.models.actuator import PiezoStack

_SHOWN_EXPONENT = 0.1  # least exponent of a direction that is written


StructureLines = Callable[[Callable[[str], tuple[str, str]]], list[str]]
"""Lines of a table `structure`, from a function that gives value and comment of an entry, both as TOML, by its name."""


def rig_tables(
    identification: Identification,
    stack: PiezoStack,
    *,
    structure: Mapping[str, float] | None = None,
    structure_lines: StructureLines | None = None,
) -> str:
    """Tables `stack` and `structure` of a rig file from an identification.

    Parameters
    ----------
    identification : Identification
        Of entries of the two tables.
    stack : PiezoStack
        Entries of the table `stack` that were not identified.
    structure : mapping of str to float, optional
        Entries of the table `structure` in SI, in the order in which to write them; identified ones are replaced.
        Without it the table holds the identified entries alone.
    structure_lines : callable, optional
        Writes the table `structure`; one line an entry of that name by default.

    Returns
    -------
    str
        TOML. Comments state the verdict on each fact, the minimal conflicts, the unidentifiable directions, and the
        feasible interval of each identified parameter.
    """
    estimates = identification.estimates
    known = {name: float(value) for name, value in asdict(stack).items() if value is not None}
    entries = structure if structure is not None else [name for name in estimates if name not in known]
    fixed = {**known, **(structure or {})}

    def entry(name: str) -> tuple[str, str]:
        """Value of an entry, and a comment with the feasible interval where it was identified."""
        unit = parameter_unit(name)
        if name in estimates:
            return f'"{_quantity(estimates[name].value, unit)}"', f"  # {_interval(name, estimates[name])}"
        digits = 5 if math.isclose(float(f"{fixed[name]:.5g}"), fixed[name], rel_tol=1e-12) else 12
        return f'"{_quantity(fixed[name], unit, digits=digits)}"', ""

    def line(name: str) -> str:
        return f"{name} = {''.join(entry(name))}"

    lines = structure_lines(entry) if structure_lines else [line(name) for name in entries]
    return "\n".join(["[stack]", *map(line, known), "", *_comments(identification), "[structure]", *lines]) + "\n"


def _quantity(value: float, unit: str, *, digits: int = 5) -> str:
    """Value in SI with its unit, as a rig file takes it."""
    return f"{value:.{digits}g} {unit}".rstrip()


def _interval(name: str, estimate: ParameterEstimate) -> str:
    """Feasible interval as text, with the ends that are only bounds of the search marked."""
    lower, upper = (_quantity(end, parameter_unit(name)) for end in (estimate.lower, estimate.upper))
    if estimate.lower_is_bound and estimate.upper_is_bound:
        return f"not limited by any fact from {lower} to {upper}"
    at_lower, at_upper = " (bound)" * estimate.lower_is_bound, " (bound)" * estimate.upper_is_bound
    return f"{lower}{at_lower} to {upper}{at_upper}"


def _comments(identification: Identification) -> list[str]:
    """Comment lines on the facts, their conflicts and the directions in which they determine nothing."""
    names = [fact.name for fact in identification.facts]
    conflicts = [", ".join(name for name in names if name in conflict) for conflict in identification.conflicts]
    shown = [
        {name: exponent for name, exponent in direction.exponents.items() if abs(exponent) > _SHOWN_EXPONENT}
        for direction in identification.unidentifiable_directions
    ]
    directions = [" ".join(f"{name}^{exponent:+.2f}" for name, exponent in each.items()) for each in shown]
    return [
        "# Identified from the facts below. All satisfied ones still hold at either end of a parameter's interval.",
        *(f"# - {_verdict(fact, identification)}" for fact in identification.facts),
        *(f"# Mutually inconsistent: {conflict}." for conflict in conflicts),
        *(f"# Not determined within a factor of e: {direction}." for direction in directions),
    ]


def _verdict(fact: Fact, identification: Identification) -> str:
    """Model value, stated value, residual and source of one fact."""
    residual = round(identification.consistent_fits[0].residuals[fact.name], 2) + 0.0  # no minus zero
    limit = "" if fact.relation == "=" else f"{fact.relation} "
    verdict = "satisfied" if fact.name in identification.satisfied else "rejected"
    return (
        f"{fact.name}: {_quantity(identification.observed[fact.name], fact.unit)} for {limit}"
        f"{_quantity(fact.value, fact.unit)} +- {_quantity(fact.tolerance, fact.unit)}, {verdict} at {residual:+.2f}"
        f" tolerances; rank {fact.rank}, {fact.source}"
    )
