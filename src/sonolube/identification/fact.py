"""Facts about a system with ranks and tolerances, the result of an identification, and its tables for a rig file."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Literal

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.actuator import PiezoStack
from sonolube.vocabulary import unit_of

ForwardModel = Callable[[Mapping[str, Floats]], Mapping[str, Floats]]
"""Observables of n systems, by name, from arrays of shape (n,) of their parameters, by name."""

Bounds = Mapping[str, tuple[float, float]]
"""Lower and upper bound of each free parameter, by name, in SI."""

Relation = Literal["=", ">=", "<="]


def parameter_unit(name: str) -> str:
    """SI unit of a free parameter: of the last word of its name in the vocabulary, kg for an entry of `masses`."""
    table, _, key = name.rpartition(".")
    return "kg" if table == "masses" else unit_of(key)


@dataclass(frozen=True, kw_only=True, slots=True)
class Fact:
    """Observed value of one observable, or a limit on it, with its tolerance.

    Parameters
    ----------
    name : str
        Name of the fact, which is the name of the observable in the results of the forward model.
    value : float
        Observed value in the SI unit of the observable, positive.
    tolerance : float
        Largest absolute deviation of a model's value that still agrees with the fact, in the same unit.
    rank : int
        Reliability: 1 for the most reliable facts, larger for less reliable ones.
    unit : str
        SI unit of the observable; empty for a pure number.
    relation : str
        "=" for a value; ">=" or "<=" for a limit, which may be violated by no more than the tolerance.
    meaning : str
        Statement of the fact in a few words.
    source : str
        Reference of the statement.

    Raises
    ------
    InvalidInput
        If value or tolerance is not positive and finite, the rank is below 1 or the relation is none of the three.
    """

    name: str
    value: float
    tolerance: float
    rank: int
    unit: str = ""
    relation: Relation = "="
    meaning: str = ""
    source: str = ""

    def __post_init__(self) -> None:
        try:
            require_positive(value=self.value, tolerance=self.tolerance)
        except InvalidInput as refusal:
            raise InvalidInput(f"fact {self.name}: {refusal}") from None
        if self.rank < 1:
            raise InvalidInput(f"fact {self.name}: rank must be 1 or more, got {self.rank}")
        if self.relation not in ("=", ">=", "<="):
            raise InvalidInput(f"fact {self.name}: relation must be =, >= or <=, got {self.relation!r}")


def normalized_residuals(facts: Sequence[Fact], observed: Mapping[str, Floats]) -> Floats:
    r"""Residuals of observables against facts in units of the tolerances.

    Parameters
    ----------
    facts : sequence of Fact
    observed : mapping of str to ndarray, shape (n,)
        Observables of n systems, by the name of the fact.

    Returns
    -------
    ndarray, shape (n, number of facts)
        Between -1 and 1 where a fact is satisfied; 0 where a limit is not violated.

    Raises
    ------
    UnknownName
        If a fact names no observable of `observed`.

    Notes
    -----
    For the observable :math:`y_i` of a fact with value :math:`v_i` and tolerance :math:`\tau_i`

    .. math:: r_i = \frac{y_i - v_i}{\tau_i},

    replaced by :math:`\min(r_i, 0)` for a lower limit and by :math:`\max(r_i, 0)` for an upper one.
    """
    columns = []
    for fact in facts:
        if fact.name not in observed:
            raise UnknownName.among(observed, kind="observable", name=fact.name)
        residual = (observed[fact.name] - fact.value) / fact.tolerance
        if fact.relation != "=":
            residual = np.minimum(residual, 0.0) if fact.relation == ">=" else np.maximum(residual, 0.0)
        columns.append(residual)
    return np.stack(columns, axis=-1)


_IDENTIFIABLE = 1.0  # least change of the residuals, in tolerances, for a change of the parameters by a factor of e


@dataclass(frozen=True, kw_only=True, slots=True)
class ParameterEstimate:
    """Estimate of one parameter with its feasible interval.

    Parameters
    ----------
    value : float
        Least-squares estimate.
    lower, upper : float
        Ends of the feasible interval: every satisfied fact still holds there, the other parameters being adapted.
    lower_is_bound, upper_is_bound : bool
        Whether that end is a bound of the search, so that the facts do not limit the parameter there.
    """

    value: float
    lower: float
    upper: float
    lower_is_bound: bool
    upper_is_bound: bool


@dataclass(frozen=True, kw_only=True, slots=True)
class SingularDirection:
    """Right singular vector of the residuals' Jacobian with respect to the logarithms of the parameters.

    Along it each parameter changes as a power of one common factor.

    Parameters
    ----------
    exponents : mapping of str to float
        Component of each parameter, which is its exponent of the common factor; a unit vector.
    sensitivity : float
        Singular value: norm of the change of the normalised residuals for a common factor of e.
    """

    exponents: Mapping[str, float]
    sensitivity: float

    @property
    def is_unidentifiable(self) -> bool:
        """Whether a common factor of e changes the residuals by less than one tolerance."""
        return self.sensitivity < _IDENTIFIABLE


@dataclass(frozen=True, kw_only=True, slots=True)
class ConsistentFit:
    """Least-squares fit to one maximal consistent subset of the facts.

    Parameters
    ----------
    satisfied : frozenset of str
        Names of the facts in the subset, all of which the fit satisfies.
    parameters : mapping of str to float
        Least-squares estimate of each parameter.
    residuals : mapping of str to float
        Normalised residual of every fact, inside the subset and outside.
    """

    satisfied: frozenset[str]
    parameters: Mapping[str, float]
    residuals: Mapping[str, float]


@dataclass(frozen=True, kw_only=True, slots=True)
class Identification:
    """Parameters identified from facts by bounded-error estimation.

    Parameters
    ----------
    facts : tuple of Fact
        All facts.
    observed : mapping of str to float
        Value of each fact's observable at the estimate, in the fact's unit.
    estimates : mapping of str to ParameterEstimate
        The parameters, from the first of `consistent_fits`.
    directions : tuple of SingularDirection
        Singular directions of the Jacobian at the estimate, the least identifiable first.
    consistent_fits : tuple of ConsistentFit
        One for each maximal consistent subset of the facts, that with the most reliable facts first.
    conflicts : tuple of frozenset of str
        Minimal conflicts among the facts.
    """

    facts: tuple[Fact, ...]
    observed: Mapping[str, float]
    estimates: Mapping[str, ParameterEstimate]
    directions: tuple[SingularDirection, ...]
    consistent_fits: tuple[ConsistentFit, ...]
    conflicts: tuple[frozenset[str], ...]

    @property
    def satisfied(self) -> frozenset[str]:
        """Names of the facts that the estimate satisfies."""
        return self.consistent_fits[0].satisfied

    @property
    def unidentifiable_directions(self) -> tuple[SingularDirection, ...]:
        """Directions in which the facts do not determine the parameters within a factor of e."""
        return tuple(direction for direction in self.directions if direction.is_unidentifiable)


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
