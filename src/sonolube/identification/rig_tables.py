"""Identified parameters as tables of a rig file, with what speaks for and against them beside."""

from sonolube.actuator.stack import PiezoStack
from sonolube.identification.fact import Fact
from sonolube.identification.record import Estimate, Identification
from sonolube.vocabulary import unit_of

_STACK = ("free_capacitance", "free_stroke_per_volt", "stack_stiffness", "stack_mass", "stack_damping")


def rig_tables(identification: Identification, stack: PiezoStack) -> str:
    """Return the tables `stack` and `structure` of a rig file.

    Parameters
    ----------
    identification : Identification
        Of the masses, springs and dampers about the stack.
    stack : PiezoStack
        The stack itself.

    Returns
    -------
    str
        TOML; comments tell how each fact fares, which facts do not hold together and what stays free.
    """
    lines = [
        "[stack]",
        *(_entry(name, getattr(stack, name)) for name in _STACK),
        "",
        *_comments(identification),
        "[structure]",
        *(f"{_entry(name, known.value)}  # {_range(name, known)}" for name, known in identification.estimates.items()),
    ]
    return "\n".join(lines) + "\n"


def _entry(name: str, value: float) -> str:
    return f'{name} = "{_quantity(value, unit_of(name))}"'


def _quantity(value: float, unit: str) -> str:
    return f"{value:.5g} {unit}".rstrip()


def _range(name: str, known: Estimate) -> str:
    lower, upper = (_quantity(end, unit_of(name)) for end in (known.lower, known.upper))
    if known.lower_is_bound and known.upper_is_bound:
        return f"not limited by any fact from {lower} to {upper}"
    at_least, at_most = " (end of the search)" * known.lower_is_bound, " (end of the search)" * known.upper_is_bound
    return f"{lower}{at_least} to {upper}{at_most}"


def _comments(identification: Identification) -> list[str]:
    named = [fact.name for fact in identification.facts]
    conflicts = [", ".join(name for name in named if name in conflict) for conflict in identification.conflicts]
    free = [
        " ".join(f"{name}^{exponent:+.2f}" for name, exponent in direction.exponents.items() if abs(exponent) > 0.1)
        for direction in identification.free_directions
    ]
    return [
        "# Identified from these facts, by trust. Within a parameter's range all that are kept still hold.",
        *(f"# - {_verdict(fact, identification)}" for fact in identification.facts),
        *(f"# Not to be had together: {conflict}." for conflict in conflicts),
        *(f"# Left free to a factor of e and more: {direction}." for direction in free),
    ]


def _verdict(fact: Fact, identification: Identification) -> str:
    missed = round(identification.readings[0].misses[fact.name], 2) + 0.0  # no minus zero
    limit = "" if fact.relation == "=" else f"{fact.relation} "
    verdict = "kept" if fact.name in identification.kept else "given up"
    return (
        f"{fact.name}: {_quantity(identification.observed[fact.name], fact.unit)} for {limit}"
        f"{_quantity(fact.value, fact.unit)} +- {_quantity(fact.tolerance, fact.unit)}, {verdict} at {missed:+.2f}"
        f" tolerances; rank {fact.rank}, {fact.source}"
    )
