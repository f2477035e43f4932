"""Friction along the horn's face, and the regions of Table 2.1 from it.

The face drives a block where the friction of a block that slides towards the motion's node, at the speed of D's tests,
has reversed: that is the motor region. Between lies the transition region, in which friction resists both ways. The
contact is one of springs along the normal and in the plane, with Mindlin's ratio, as stiff as the rough contact is at
its load; nothing is fitted.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.contact import decay_length
from sonolube.friction import SpringContact, combined_oscillation_ratio
from sonolube.reproduce.chapter2.poisson_horn import (
    ASSUMED_SOLIDS,
    ELASTIC_LOSS,
    FaceMotion,
    Horn,
    assumed_shape,
    face_motion,
    node_position,
)
from sonolube.validation.contacts import Bodies, poisson_contact
from sonolube.validation.inputs import said

_TEST: Final = {"aluminium": 1, "steel": 2}  # that gives each horn's friction coefficient, 3.1.4
_PLACES: Final = 61  # on either side of the node
_STEPS: Final = 256
FACE_END: Final = 1.5 * 0.0254
"""Distance from the centre to which the face is flat, which is where Table 2.1 ends. [m]"""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class FaceFriction:
    """Friction of a block that slides on the vibrating face towards the node of its motion.

    Parameters
    ----------
    position : ndarray, shape (k,)
        Places along the face, from the centre. [m]
    ratio : ndarray, shape (k,)
        Friction over that on the face at rest; negative where the face drives the block.
    node : float
        Where the motion along the face vanishes, in m.
    """

    position: Floats
    ratio: Floats
    node: float

    def at(self, place: float) -> float:
        """Return the ratio at a place in m."""
        return float(np.interp(place, self.position, self.ratio))


def driven_face(horn: Horn, *, frequency: float, elastic_loss: float = ELASTIC_LOSS) -> FaceMotion:
    """Return the motion of a horn's face under the welder's full amplitude, with the assumptions that give its mode.

    Parameters
    ----------
    horn : str
        Material of the horn.
    frequency : float
        Frequency of the drive. [Hz]
    elastic_loss : float
        Loss tangent of the stiffness. []

    Returns
    -------
    FaceMotion
    """
    return face_motion(
        assumed_shape(),
        ASSUMED_SOLIDS[horn],
        frequency=frequency,
        axial_amplitude=said("2.1.2-welder-amplitude").value,
        elastic_loss=elastic_loss,
    )


def spring_contact(horn: Horn, *, bodies: Bodies = "aluminium_steel") -> tuple[SpringContact, float]:
    """Return the contact under a horn, and the approach at which its springs carry the load. [m]"""
    rough = poisson_contact(bodies=bodies)
    springs = SpringContact(
        friction_coefficient=said(f"3.1.4-coefficient-{_TEST[horn]}").value, mindlin_ratio=rough.pair.mindlin_ratio
    )
    return springs, float(decay_length(rough))


def friction_on_face(horn: Horn, *, frequency: float) -> FaceFriction:
    """Return the friction along a driven horn's face.

    Parameters
    ----------
    horn : str
        Material of the horn.
    frequency : float
        Frequency of the drive. [Hz]

    Returns
    -------
    FaceFriction
    """
    contact, approach = spring_contact(horn)
    return friction_along(driven_face(horn, frequency=frequency), contact, approach=approach)


def friction_along(motion: FaceMotion, contact: SpringContact, *, approach: float) -> FaceFriction:
    """Return the friction of a block that slides along the face at the speed of D 2.1.2.

    Parameters
    ----------
    motion : FaceMotion
    contact : SpringContact
    approach : float
        Approach at which the springs carry the load. [m]

    Returns
    -------
    FaceFriction
    """
    node = node_position(position=motion.position, axial=motion.axial.real)
    sides = [np.linspace(-FACE_END, node, _PLACES), np.linspace(node, FACE_END, _PLACES)[1:]]
    places = np.concatenate(sides)
    axial, normal = motion.at(places)
    towards = np.repeat([1, -1], [len(side) for side in sides])
    ratio = combined_oscillation_ratio(
        contact,
        approach=approach,
        frequency=motion.frequency,
        sliding_speed=said("2.1.2-sliding-speed").value,
        normal_amplitude=np.abs(normal),
        in_plane_amplitude=np.abs(axial),
        in_plane_phase=np.angle(normal / (towards * axial)),  # on the face the block moves by minus what the face does
        steps=_STEPS,
    )
    return FaceFriction(position=places, ratio=ratio, node=node)


def transition_region(friction: FaceFriction) -> tuple[float, float]:
    """Return the ends of the region about the node in which friction resists both ways. [m]"""
    middle = int(np.argmin(np.abs(friction.position - friction.node)))
    outwards = slice(middle, None, -1), slice(middle, None)
    left, right = (_first_reversal(friction.position[side], friction.ratio[side]) for side in outwards)
    return left, right


def _first_reversal(places: Floats, ratio: Floats) -> float:
    after = int(np.argmax(ratio < 0))
    assert after, "the face drives nowhere"
    before = after - 1
    share = ratio[before] / (ratio[before] - ratio[after])
    return float(places[before] + share * (places[after] - places[before]))
