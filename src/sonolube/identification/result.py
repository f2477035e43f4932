"""Results of an identification: parameter estimates, their feasible intervals, and the consistency of the facts."""

from collections.abc import Mapping
from dataclasses import dataclass

from sonolube.identification.fact import Fact

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
