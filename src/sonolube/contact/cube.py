"""The cube: the dissertation's picture of a rough contact as one block, as high as the surfaces stand apart."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.contact.rough import RoughContact, normal_stiffness, real_contact_area


def tangential_stiffness(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    """Return the tangential stiffness of the cube, a beam with fixed ends in bending, E* A_r^2/d^3. [N/m]

    Parameters
    ----------
    contact : RoughContact
    separation : array_like, any shape
        Separation of the mean planes, the cube's height. [m]

    Returns
    -------
    ndarray, shape of `separation`

    Raises
    ------
    InvalidInput
        If a separation is not positive and finite.
    OutsideRange
        If a separation lies outside the height law's range.

    Notes
    -----
    The cube is far wider than tall, so that it would shear long before it bends: at 3 N on the dissertation's wear
    surfaces (its Table 3.2) bending gives 4e8 N/m, shear (G A_r/d) about 9e6. `mindlin_stiffness` stands beside it.

    References
    ----------
    .. [1] D 3.9
    """
    d = require_positive(separation=separation)
    return contact.pair.effective_modulus * np.square(real_contact_area(contact, separation=d)) / d**3  # D 3.9


def axial_stiffness(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    """Return the stiffness of the cube along the surface normal, E* A_r/d. [N/m]

    Parameters
    ----------
    contact : RoughContact
    separation : array_like, any shape
        Separation of the mean planes, the cube's height. [m]

    Returns
    -------
    ndarray, shape of `separation`

    Raises
    ------
    InvalidInput
        If a separation is not positive and finite.
    OutsideRange
        If a separation lies outside the height law's range.

    References
    ----------
    .. [1] D 3.43, which prints E* d/A_r, no stiffness.
    """
    d = require_positive(separation=separation)
    return contact.pair.effective_modulus * real_contact_area(contact, separation=d) / d


def mindlin_stiffness(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    """Return the tangential stiffness of sticking asperities after Mindlin, a fixed share of the normal one. [N/m]

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
        If a separation lies outside the height law's range.

    Notes
    -----
    Exact for elastic asperities that stick. Of the yielded ones the loading stiffness is taken.

    References
    ----------
    .. [1] R. D. Mindlin, J. Appl. Mech. 16, 259 (1949).
    """
    d = require_positive(separation=separation)
    return contact.pair.mindlin_ratio * normal_stiffness(contact, separation=d)
