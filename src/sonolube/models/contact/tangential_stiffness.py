"""Tangential stiffness of a rough contact by the name of its model: Mindlin's by default, Dong's cube beside it.

Dong's "cube" replaces all asperities by a single elastic block between the mean planes. Its top is the real contact
area A_r and its height the separation d, so that it is neither a cube nor of fixed size: under vibration both follow
the gap. Its bending stiffness is the tangential stiffness of the contact (D 3.9), and half its volume the wear particle
(`sonolube.models.wear`).
"""

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.models.contact.rough import RoughContact, normal_stiffness, real_contact_area
from sonolube.variants import VariantTable


def cube_tangential_stiffness(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    r"""Tangential stiffness of the cube as a beam with fixed ends in bending. [N/m]

    Parameters
    ----------
    contact : RoughContact
    separation : array_like, any shape
        Separation of the mean planes, the height of the cube. [m]

    Returns
    -------
    ndarray, shape of `separation`

    Raises
    ------
    InvalidInput
        If a separation is not positive and finite.
    OutsideRange
        If a separation lies outside the range of the height distribution.

    Notes
    -----
    .. math:: k_t = \frac{E^* A_r^2}{d^3} \tag{D 3.9}

    The stiffness 12 E* I/d^3 of a beam with fixed ends, of a square section with the second moment of area A_r^2/12.
    The block is far wider than tall, so that its shear compliance exceeds its bending compliance: at 3 N on the
    surfaces of D Table 3.2 bending gives 4e8 N/m, shear (G A_r/d) about 9e6.

    See Also
    --------
    mindlin_tangential_stiffness : Tangential stiffness of sticking asperities.

    References
    ----------
    .. [1] D 3.9
    """
    d = require_positive(separation=separation)
    return contact.pair.effective_modulus * np.square(real_contact_area(contact, separation=d)) / d**3  # D 3.9


def mindlin_tangential_stiffness(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    r"""Tangential stiffness of sticking asperities after Mindlin. [N/m]

    Parameters
    ----------
    contact : RoughContact
    separation : array_like, any shape
        Separation of the mean planes. [m]

    Returns
    -------
    ndarray, shape of `separation`

    Raises
    ------
    InvalidInput
        If a separation is not positive and finite.
    OutsideRange
        If a separation lies outside the range of the height distribution.

    Notes
    -----
    .. math:: k_t = \frac{4 G^*}{E^*}\, k_n

    with the ratio `ContactPair.mindlin_ratio`. Exact for elastic asperities that stick; for yielded ones k_n is the
    loading stiffness.

    See Also
    --------
    cube_tangential_stiffness : Bending stiffness of the cube of Dong (2015).

    References
    ----------
    .. [1] R. D. Mindlin, J. Appl. Mech. 16, 259 (1949).

    Examples
    --------
    >>> from sonolube.models.contact import mindlin_tangential_stiffness, normal_stiffness
    >>> from sonolube.rig import read_rig
    >>> contact = read_rig("examples/rigs/tribometer.toml").contact
    >>> tangential = mindlin_tangential_stiffness(contact, separation=15e-6)
    >>> round(float(tangential / normal_stiffness(contact, separation=15e-6)), 3)  # (2 - 2 nu)/(2 - nu), nu = 0.33
    0.802
    """
    d = require_positive(separation=separation)
    return contact.pair.mindlin_ratio * normal_stiffness(contact, separation=d)


class TangentialStiffness(Protocol):
    """Tangential stiffness of a rough contact at a separation of the mean planes, by one model."""

    def __call__(self, contact: RoughContact, *, separation: ArrayLike) -> Floats:
        """Tangential stiffness, shape of `separation`. [N/m]"""


TANGENTIAL_STIFFNESSES: VariantTable[TangentialStiffness] = VariantTable(
    "model of the tangential stiffness",
    {
        "mindlin": "sonolube.models.contact.tangential_stiffness:mindlin_tangential_stiffness",
        "dong_2015": "sonolube.models.contact.tangential_stiffness:cube_tangential_stiffness",
    },
)
"""Models of the tangential stiffness by name; a new model takes its file and one line here."""

DEFAULT_TANGENTIAL_STIFFNESS = "mindlin"
"""Model of asperities that stick; the bending of the cube, D 3.9, leaves out the shear of a block wider than tall."""
