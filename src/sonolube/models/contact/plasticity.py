"""Onset of plastic flow in a rough contact: elastic and plastic areas, elastic load fraction and plasticity index."""

import math

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.models.contact.rough import RoughContact, integrals_at
from sonolube.models.contact.single_asperity import critical_interference


def elastic_area(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    """Real contact area of the asperities below the critical interference. [m2]

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
        If a separation is not finite.
    OutsideRange
        If a separation lies outside the range of the height distribution.

    References
    ----------
    .. [1] D 3.7, with exp(-lambda w_c/Rq) where exp(+lambda w_c/Rq) is printed.
    """
    integrals, h = integrals_at(contact, separation=separation)
    return integrals.area.value(h) * integrals.elastic_area_fraction.value(h)


def plastic_area(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    """Real contact area of the asperities beyond the critical interference. [m2]

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
        If a separation is not finite.
    OutsideRange
        If a separation lies outside the range of the height distribution.

    References
    ----------
    .. [1] D 3.8
    """
    integrals, h = integrals_at(contact, separation=separation)
    return integrals.area.value(h) * np.maximum(1 - integrals.elastic_area_fraction.value(h), 0.0)


def elastic_load_fraction(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    """Fraction of the normal force on asperities below the critical interference. []

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
        If a separation is not finite.
    OutsideRange
        If a separation lies outside the range of the height distribution.

    References
    ----------
    .. [1] D 3.4 over 3.3
    """
    integrals, h = integrals_at(contact, separation=separation)
    return np.minimum(integrals.elastic_load_fraction.value(h), 1.0)


def plasticity_index(contact: RoughContact) -> float:
    r"""Plasticity index after Chang, Etsion and Bogy. []

    Parameters
    ----------
    contact : RoughContact

    Returns
    -------
    float
        Elastic contact well below 1, plastic contact well above; zero for asperities without yielding.

    Notes
    -----
    .. math:: \psi = \sqrt{R_q / w_c}

    with R_q = lambda l where the contact has a decay length l of its own (`RoughContact.height_scale`).

    References
    ----------
    .. [1] W. R. Chang, I. Etsion and D. B. Bogy, J. Tribol. 109, 257 (1987). doi:10.1115/1.3261348
    """
    w_c = critical_interference(contact.asperity, contact.pair, summit_radius=contact.roughness.summit_radius)
    return math.sqrt(contact.height_scale / w_c)
