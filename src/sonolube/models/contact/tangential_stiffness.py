"""Tangential stiffness of a rough contact by the name of its model: Mindlin's by default, Dong's cube beside it."""

from typing import Protocol

from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.models.contact.rough import RoughContact
from sonolube.variants import VariantTable


class TangentialStiffness(Protocol):
    """Tangential stiffness of a rough contact at a separation of the mean planes, by one model."""

    def __call__(self, contact: RoughContact, *, separation: ArrayLike) -> Floats:
        """Tangential stiffness, shape of `separation`. [N/m]"""


TANGENTIAL_STIFFNESSES: VariantTable[TangentialStiffness] = VariantTable(
    "model of the tangential stiffness",
    {
        "mindlin": "sonolube.models.contact.mindlin:mindlin_tangential_stiffness",
        "dong_2015": "sonolube.models.contact.cube:cube_tangential_stiffness",
    },
)
"""Models of the tangential stiffness by name; a new model takes its file and one line here."""

DEFAULT_TANGENTIAL_STIFFNESS = "mindlin"
"""Model of asperities that stick; the bending of the cube, D 3.9, leaves out the shear of a block wider than tall."""
