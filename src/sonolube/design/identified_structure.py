"""Posterior draws of the tribometer's structure from the published facts, for the propagation of uncertainty."""

from collections.abc import Callable
from dataclasses import astuple, dataclass

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.identification import Posterior, SingularDirection, posterior
from sonolube.rig import Rig
from sonolube.validation.tribometer import (
    tribometer_identification,
    tribometer_model,
    tribometer_problem,
    tribometer_stack,
)

_STACK_FIELDS = 5  # leading fields of a stack that must agree with the tribometer's
_STACK_TOLERANCE = 0.01  # relative


@dataclass(frozen=True, kw_only=True, slots=True)
class IdentifiedStructure:
    """Draws of the parameters of a structure, and the directions in which the facts leave them free.

    Parameters
    ----------
    posterior : Posterior
    unidentifiable_directions : tuple of SingularDirection
    """

    posterior: Posterior
    unidentifiable_directions: tuple[SingularDirection, ...]

    def draws_by_key(self) -> dict[str, Floats]:
        """Draws by the keys of a rig file."""
        return {f"structure.{name}": values for name, values in self.posterior.draws.items()}


def identified_structure(
    rig: Rig, *, seed: int, advance: Callable[[int, int], None] | None = None
) -> IdentifiedStructure:
    """Posterior of the tribometer's masses, springs and dampers, given the published facts that are consistent."""
    stack, expected = rig.stack, astuple(tribometer_stack())[:_STACK_FIELDS]
    if stack is None or not all(
        own == other or (own and other and abs(own / other - 1) < _STACK_TOLERANCE)
        for own, other in zip(astuple(stack)[:_STACK_FIELDS], expected, strict=True)
    ):
        raise InvalidInput(
            f"{rig.file or rig.title}: an identified structure needs the tribometer's stack, which the facts are of"
        )
    identification, bounds = tribometer_identification(seed=seed), tribometer_problem().bounds
    consistent = [fact for fact in identification.facts if fact.name in identification.satisfied]
    drawn = posterior(tribometer_model(), facts=consistent, bounds=bounds, seed=seed, advance=advance)
    return IdentifiedStructure(posterior=drawn, unidentifiable_directions=identification.unidentifiable_directions)
