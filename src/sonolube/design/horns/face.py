"""Friction along the face of a Poisson horn, with its transition region, and faces of horns that a study models.

Motor region: the friction of a block that slides towards the node of the motion is reversed, so that the face drives
the block. Transition region: friction resists in both directions.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from sonolube.charts import Axis, Chart, Line, Panel, Rule, Zone
from sonolube.checks import Floats


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


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class HornFace:
    """Face of a horn with a model of the friction on it, and the transition region that was measured there.

    Parameters
    ----------
    end : float
        Distance from the centre to either end of the flat face, in m.
    measured : tuple of float
        Limits of the measured transition region, in m.
    source : str
        Place where they are printed, such as "Table 2.1".
    friction : callable
        Returns the `FaceFriction` by the keywords `frequency`, `axial_amplitude` and `sliding_speed`.
    assumptions : mapping of str to str
        What the model assumes, by its part.
    """

    end: float
    measured: tuple[float, float]
    source: str
    friction: Callable[..., FaceFriction]
    assumptions: Mapping[str, str]


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


def face_friction_chart(horn: str, face: HornFace, friction: FaceFriction) -> Chart:
    """Friction along the face of a horn, with the measured transition region."""
    first, last = (np.array([1e3 * end]) for end in face.measured)
    parts = (
        Zone(first=first, last=last, label=f"transition region, {face.source}", colour="0.8"),
        Line(x=1e3 * friction.position, y=100 * friction.ratio, label="computed"),
        Rule(along="y", value=0.0, colour="0", dash=0),
        Rule(value=1e3 * friction.node, label="node of the axial motion", colour="0"),
    )
    end = 1e3 * face.end
    x = Axis("Position along the face, from its centre", "mm", lowest=-end, highest=end)
    panel = Panel(x=x, y=Axis("Friction over that at rest", "%"), parts=parts)
    title = f"{horn} horn; below zero the face drives the block"
    return Chart(panels=(panel,), size=(5.0, 3.2), title=title, legend="bottom")
