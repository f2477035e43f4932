"""Critical interference, normal force and contact area of one asperity: Hertz's sphere times the ratios of a law."""

import math

from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.models.contact.asperity import AsperityLaw
from sonolube.models.contact.pair import ContactPair


def critical_interference(law: AsperityLaw, pair: ContactPair, *, summit_radius: float) -> float:
    r"""Critical interference, at which an asperity begins to yield. [m]

    Parameters
    ----------
    law : AsperityLaw
    pair : ContactPair
    summit_radius : float
        Radius of the asperity's summit. [m]

    Returns
    -------
    float
        Infinite for a law without yielding.

    Raises
    ------
    InvalidInput
        If the radius is not positive.

    Notes
    -----
    .. math:: w_c = \left( \frac{\pi p_Y}{2 E^*} \right)^2 R_s \tag{D 3.1}

    with the pressure p_Y of `AsperityLaw.yield_pressure`.

    References
    ----------
    .. [1] D 3.1, which has p_Y = C_nu (1 - nu^2) Y_0.
    """
    require_positive(summit_radius=summit_radius)
    strain = math.pi * law.yield_pressure(pair) / (2 * pair.effective_modulus)
    return strain * strain * summit_radius


def asperity_force(law: AsperityLaw, pair: ContactPair, *, summit_radius: float, interference: ArrayLike) -> Floats:
    r"""Normal force on one asperity at an interference. [N]

    Parameters
    ----------
    law : AsperityLaw
    pair : ContactPair
    summit_radius : float
        Radius of the asperity's summit. [m]
    interference : array_like, any shape
        Overlap of the undeformed summit with the other surface. [m]

    Returns
    -------
    ndarray, shape of `interference`

    Raises
    ------
    InvalidInput
        If the radius is not positive, or an interference is negative or not finite.

    Notes
    -----
    .. math:: f = \tfrac43 E^* \sqrt{R_s}\, w^{3/2}\, r_f(w/w_c)

    See Also
    --------
    asperity_area : Contact area of the same asperity.
    """
    w = require_non_negative(interference=interference)
    ratio = w / critical_interference(law, pair, summit_radius=summit_radius)
    hertz = 4 / 3 * pair.effective_modulus * math.sqrt(summit_radius) * w**1.5
    return hertz * law.force_ratio(pair, ratio)


def asperity_area(law: AsperityLaw, pair: ContactPair, *, summit_radius: float, interference: ArrayLike) -> Floats:
    r"""Contact area of one asperity at an interference. [m2]

    Parameters
    ----------
    law : AsperityLaw
    pair : ContactPair
    summit_radius : float
        Radius of the asperity's summit. [m]
    interference : array_like, any shape
        Overlap of the undeformed summit with the other surface. [m]

    Returns
    -------
    ndarray, shape of `interference`

    Raises
    ------
    InvalidInput
        If the radius is not positive, or an interference is negative or not finite.

    Notes
    -----
    .. math:: a = \pi R_s w\, r_a(w/w_c)

    See Also
    --------
    asperity_force : Normal force on the same asperity.
    """
    w = require_non_negative(interference=interference)
    ratio = w / critical_interference(law, pair, summit_radius=summit_radius)
    return math.pi * summit_radius * w * law.area_ratio(pair, ratio)
