"""Stiffness of the cube of Dong (2015): a rough contact as one block of the real area, as high as the separation.

Dong's "cube" replaces all asperities by a single elastic block between the mean planes. Its top is the real contact
area A_r and its height the separation d, so that it is neither a cube nor of fixed size: under vibration both follow
the gap. Its bending stiffness is the tangential stiffness of the contact (D 3.9), and half its volume the wear particle
(`sonolube.models.wear`).
"""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.models.contact.rough import RoughContact, real_contact_area


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
