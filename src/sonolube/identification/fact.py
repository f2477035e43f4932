"""Facts about a system, ranked and with tolerances, and the residuals of a model against them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, UnknownName
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
