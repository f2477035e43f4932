"""What an identification found: parameters, how well they are known, and which facts speak against which."""

from collections.abc import Mapping
from dataclasses import dataclass

from sonolube.identification.fact import Fact

_FREE = 1.0  # tolerances by which facts may change while parameters move by a factor of e


@dataclass(frozen=True, kw_only=True, slots=True)
class Estimate:
    """One parameter as identified.

    Parameters
    ----------
    value : float
        The value chosen.
    lower, upper : float
        Least and greatest value with which, the others adapted, every fact that was kept still holds.
    lower_is_bound, upper_is_bound : bool
        Whether that end is only the bound of the search, so that the facts do not limit the parameter there.
    """

    value: float
    lower: float
    upper: float
    lower_is_bound: bool
    upper_is_bound: bool


@dataclass(frozen=True, kw_only=True, slots=True)
class Direction:
    """A way in which parameters move together: each in proportion to its own exponent of a common factor.

    Parameters
    ----------
    exponents : mapping of str to float
        Exponent of each parameter; their squares add up to 1.
    sensitivity : float
        Tolerances by which the facts change, in all, for a factor of e.
    """

    exponents: Mapping[str, float]
    sensitivity: float

    @property
    def is_free(self) -> bool:
        """Whether the facts leave the parameters free to move this way by a factor of e."""
        return self.sensitivity < _FREE


@dataclass(frozen=True, kw_only=True, slots=True)
class Reading:
    """One way to believe as many facts as hold together.

    Parameters
    ----------
    kept : frozenset of str
        Facts that hold together.
    parameters : mapping of str to float
        Parameters closest to them.
    misses : mapping of str to float
        By how many tolerances each fact is missed, kept or not.
    """

    kept: frozenset[str]
    parameters: Mapping[str, float]
    misses: Mapping[str, float]


@dataclass(frozen=True, kw_only=True, slots=True)
class Identification:
    """What facts say of parameters.

    Parameters
    ----------
    facts : tuple of Fact
        All facts.
    observed : mapping of str to float
        What the identified system shows in place of each fact, in the fact's unit.
    estimates : mapping of str to Estimate
        The parameters, under the first reading.
    directions : tuple of Direction
        How parameters can move together about the estimate, the most free first.
    readings : tuple of Reading
        Every largest set of facts that hold together, the most trusted first.
    conflicts : tuple of frozenset of str
        Every smallest set of facts that do not hold together.
    """

    facts: tuple[Fact, ...]
    observed: Mapping[str, float]
    estimates: Mapping[str, Estimate]
    directions: tuple[Direction, ...]
    readings: tuple[Reading, ...]
    conflicts: tuple[frozenset[str], ...]

    @property
    def kept(self) -> frozenset[str]:
        """Facts that hold with the identified parameters."""
        return self.readings[0].kept

    @property
    def free_directions(self) -> tuple[Direction, ...]:
        """Ways in which the facts leave the parameters free."""
        return tuple(direction for direction in self.directions if direction.is_free)

    def rest_holds_without(self, name: str) -> bool:
        """Return whether all other facts hold together once the fact of this name is left out."""
        return all(name in conflict for conflict in self.conflicts)
