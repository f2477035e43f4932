"""Mean friction ratio by the LuGre law: bristles of constant stiffness with the Stribeck effect."""

from dataclasses import dataclass
from typing import ClassVar, final

from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.contact.contact_motion import ContactMotion
from sonolube.models.contact.rough import RoughContact, separation
from sonolube.models.contact.tangential_stiffness import mindlin_tangential_stiffness
from sonolube.models.friction.laws.lugre import LuGreFriction, lugre_under_vibration
from sonolube.models.friction.models.model import FrictionModel, parameter


@final
@dataclass(frozen=True, kw_only=True, slots=True)
class LuGre(FrictionModel):
    r"""Bristles with Mindlin's tangential stiffness at rest, whose limit falls with speed and follows the normal force.

    Parameters
    ----------
    static_friction_ratio : float
        Friction of very slow over that of fast sliding, at least 1. []
    stribeck_velocity : float
        Velocity of the transition between both. [m/s]

    Notes
    -----
    The law of `lugre_under_vibration` with the coefficient of friction for that of fast sliding. The defaults are those
    of the authors' own example. Under vibration along the normal alone the Stribeck curve cancels, and only bristles
    that yield within the stroke lose friction; within the plane fast vibration also leads to the lower branch.

    See Also
    --------
    Dahl : Stiffness that follows the gap, without the Stribeck effect.

    References
    ----------
    .. [1] C. Canudas de Wit, H. Olsson, K. J. Astrom and P. Lischinsky, IEEE Trans. Autom. Control 40, 419 (1995),
       Table I. doi:10.1109/9.376053
    """

    name: ClassVar[str] = "lugre"
    citation: ClassVar[str] = "C. Canudas de Wit, H. Olsson, K. J. Astrom and P. Lischinsky 1995"

    directions: ClassVar[frozenset[str]] = frozenset({"normal", "along", "across"})

    static_friction_ratio: float = parameter(1.5, lowest=1.0)
    stribeck_velocity: float = parameter(1e-3, positive=True)

    def _ratios(self, contact: RoughContact, motion: ContactMotion, v_r: Floats, mu: ArrayLike | None) -> Floats:
        """Ratio at positive speeds, shape (n,)."""
        if mu is None:
            raise InvalidInput(f"{self.name} requires a friction_coefficient, which limits the force of the bristles")
        coulomb = float(require_positive(friction_coefficient=mu)) * motion.normal_load
        at_rest = separation(contact, normal_load=motion.normal_load)
        law = LuGreFriction(
            coulomb_friction_force=coulomb,
            static_friction_force=self.static_friction_ratio * coulomb,
            stribeck_velocity=self.stribeck_velocity,
            bristle_stiffness=float(mindlin_tangential_stiffness(contact, separation=at_rest)),
            bristle_damping=0.0,
            viscous_coefficient=0.0,
        )
        return lugre_under_vibration(law, motion, sliding_speed=v_r)
