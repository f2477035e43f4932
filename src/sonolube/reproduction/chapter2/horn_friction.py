"""Friction along the face of the driven Poisson horn, and the motor and transition regions of Table 2.1.

Motor region: the friction of a block that slides towards the node of the motion, at the speed of the tests of D, is
reversed, so that the face drives the block. Transition region: friction resists in both directions. The contact has
normal and tangential springs with the ratio of Mindlin and the stiffness of the rough contact at its load; nothing is
fitted.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.facts.published import si_value
from sonolube.models.contact import decay_length
from sonolube.models.friction import SpringContact, combined_oscillation_ratio
from sonolube.reproduction.chapter2 import poisson_horn
from sonolube.reproduction.cube import Horn
from sonolube.validation.contacts import Bodies, poisson_contact

_COEFFICIENT: Final = {"aluminium": "3.1.4-coefficient-1", "steel": "3.1.4-coefficient-2"}
_POSITIONS: Final = 61  # on either side of the node
_STEPS: Final = 256
FACE_END: Final = 1.5 * poisson_horn.INCH
"""Distance from the centre to the ends of the flat face, the range of Table 2.1. [m]"""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FaceFriction:
    """Friction of a block that slides on the vibrating face towards the node of its motion.

    Parameters
    ----------
    position : ndarray, shape (k,)
        Position along the face, from the centre. [m]
    ratio : ndarray, shape (k,)
        Friction over that on the face at rest; negative where the face drives the block.
    node : float
        Position of the node of the axial motion, in m.
    """

    position: Floats
    ratio: Floats
    node: float

    def at(self, position: float) -> float:
        """Friction ratio at a position in m, by linear interpolation. []"""
        return float(np.interp(position, self.position, self.ratio))


def driven_face(
    horn: Horn,
    *,
    frequency: float,
    axial_amplitude: float | None = None,
    elastic_loss: float = poisson_horn.ELASTIC_LOSS,
) -> poisson_horn.FaceMotion:
    """Motion of the face of a horn by the assumed shape and solid."""
    return poisson_horn.face_motion(
        poisson_horn.assumed_shape(),
        poisson_horn.ASSUMED_SOLIDS[horn],
        frequency=frequency,
        axial_amplitude=si_value("2.1.2-welder-amplitude") if axial_amplitude is None else axial_amplitude,
        elastic_loss=elastic_loss,
    )


def spring_contact(horn: Horn, *, bodies: Bodies = "aluminium_steel") -> tuple[SpringContact, float]:
    """Spring-coupled contact under a horn, and the approach at which its springs carry the load. [m]"""
    rough = poisson_contact(bodies=bodies)
    springs = SpringContact(friction_coefficient=si_value(_COEFFICIENT[horn]), mindlin_ratio=rough.pair.mindlin_ratio)
    return springs, float(decay_length(rough))


def friction_on_face(
    horn: Horn, *, frequency: float, axial_amplitude: float | None = None, sliding_speed: float | None = None
) -> FaceFriction:
    """Friction along the face of a driven horn."""
    contact, approach = spring_contact(horn)
    motion = driven_face(horn, frequency=frequency, axial_amplitude=axial_amplitude)
    return friction_along(motion, contact, approach=approach, sliding_speed=sliding_speed)


def friction_along(
    motion: poisson_horn.FaceMotion, contact: SpringContact, *, approach: float, sliding_speed: float | None = None
) -> FaceFriction:
    """Friction of a block that slides along a moving face towards its node."""
    node = poisson_horn.node_position(position=motion.position, axial=motion.axial.real)
    sides = [np.linspace(-FACE_END, node, _POSITIONS), np.linspace(node, FACE_END, _POSITIONS)[1:]]
    position = np.concatenate(sides)
    axial, normal = motion.at(position)
    towards = np.repeat([1, -1], [len(side) for side in sides])
    ratio = combined_oscillation_ratio(
        contact,
        approach=approach,
        frequency=motion.frequency,
        sliding_speed=si_value("2.1.2-sliding-speed") if sliding_speed is None else sliding_speed,
        normal_amplitude=np.abs(normal),
        in_plane_amplitude=np.abs(axial),
        in_plane_phase=np.angle(normal / (towards * axial)),  # of the block relative to the face
        steps=_STEPS,
    )
    return FaceFriction(position=position, ratio=ratio, node=node)


def transition_region(friction: FaceFriction) -> tuple[float, float]:
    """Limits of the transition region about the node, in which friction resists in both directions. [m]

    A limit is NaN where the face drives the block nowhere on its side.
    """
    middle = int(np.argmin(np.abs(friction.position - friction.node)))
    outwards = slice(middle, None, -1), slice(middle, None)
    left, right = (_first_reversal(friction.position[side], friction.ratio[side]) for side in outwards)
    return left, right


def _first_reversal(position: Floats, ratio: Floats) -> float:
    """First position at which the friction ratio changes sign, by linear interpolation. [m]"""
    after = int(np.argmax(ratio < 0))
    if not after:
        return float("nan")
    before = after - 1
    fraction = ratio[before] / (ratio[before] - ratio[after])
    return float(position[before] + fraction * (position[after] - position[before]))
