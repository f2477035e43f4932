"""Tangential stiffness of a rough contact after Mindlin: a constant fraction of its normal stiffness."""

from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.models.contact.rough import RoughContact, normal_stiffness


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
