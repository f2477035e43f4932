"""Facts: what is known of a system from outside, how closely, and how much it is to be trusted."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, UnknownName

Observe = Callable[[Mapping[str, Floats]], Mapping[str, Floats]]
Relation = Literal["=", ">=", "<="]


@dataclass(frozen=True, kw_only=True, slots=True)
class Fact:
    """One number that a model of the system should give.

    Parameters
    ----------
    name : str
        Name of the observable it is a number of.
    value : float
        The number, in SI, positive.
    tolerance : float
        How far from it a model may lie and still agree; in the unit of the number.
    rank : int
        How much it is to be trusted: 1 for the best, larger for less.
    unit : str
        Its SI unit; empty for a pure number.
    relation : str
        "=" where the number is the value, ">=" or "<=" where it is a limit that may be passed by no more than the
        tolerance.
    meaning : str
        What it states, in a few words.
    source : str
        Where it stands.

    Raises
    ------
    InvalidInput
        If number or tolerance is not positive and finite, the rank below 1 or the relation none of the three.
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


def misses(facts: Sequence[Fact], observed: Mapping[str, Floats]) -> Floats:
    """Return by how many tolerances observed numbers miss each fact, 0 where a limit is kept.

    Parameters
    ----------
    facts : sequence of Fact
    observed : mapping of str to ndarray, shape (n,)
        What n systems show, by the name of the fact.

    Returns
    -------
    ndarray, shape (n, number of facts)

    Raises
    ------
    UnknownName
        If a fact names nothing observed.
    """
    columns = []
    for fact in facts:
        if fact.name not in observed:
            raise UnknownName.among(observed, kind="observable", name=fact.name)
        miss = (observed[fact.name] - fact.value) / fact.tolerance
        if fact.relation != "=":
            miss = np.minimum(miss, 0.0) if fact.relation == ">=" else np.maximum(miss, 0.0)
        columns.append(miss)
    return np.stack(columns, axis=-1)
