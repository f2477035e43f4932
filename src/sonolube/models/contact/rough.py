"""Statistical contact of rough surfaces after Greenwood and Williamson: separation, real area and normal stiffness."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_positive
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact.greenwood_williamson import (
    GreenwoodWilliamsonIntegrals,
    RoughContact as RoughContact,
    greenwood_williamson_integrals,
)
from sonolube.models.contact.height_distribution import ExponentialHeights


def separation(contact: RoughContact, *, normal_load: ArrayLike) -> Floats:
    r"""Separation of the mean planes at which the asperities carry a load. [m]

    Parameters
    ----------
    contact : RoughContact
    normal_load : array_like, any shape
        Force pressing the bodies together. [N]

    Returns
    -------
    ndarray, shape of `normal_load`

    Raises
    ------
    InvalidInput
        If a load is not positive and finite.
    OutsideRange
        If no separation in the range of the height distribution carries a load.

    Notes
    -----
    The inverse of `normal_force`. For exponential heights of decay constant lambda, with the force F_0 at zero
    separation,

    .. math:: d = \frac{R_q}{\lambda} \ln \frac{F_0}{F_n}

    Not positive where the load is so high that the mean planes meet: see `contact_caveats`.

    References
    ----------
    .. [1] D 3.3

    Examples
    --------
    >>> from sonolube.models.contact import separation
    >>> from sonolube.rig import read_rig
    >>> contact = read_rig("examples/rigs/tribometer.toml").contact
    >>> gap = separation(contact, normal_load=[3.0, 6.0])
    >>> round(1e6 * float(gap[0] - gap[1]), 3)  # decay length of 2 um times ln 2
    1.386
    """
    load = require_positive(normal_load=normal_load)
    integrals = greenwood_williamson_integrals(contact)
    lowest, highest = integrals.force.value(np.array([integrals.highest, integrals.lowest])).tolist()
    _require_range(contact, lowest, highest, "normal_load", "N", load)
    return integrals.force.inverse(load) * contact.height_scale


def separation_range(contact: RoughContact) -> tuple[float, float]:
    """Smallest and the largest separation for which the height distribution is evaluated. [m]

    Parameters
    ----------
    contact : RoughContact

    Returns
    -------
    tuple of float
        The largest is infinite for exponential heights.
    """
    integrals, Rq = greenwood_williamson_integrals(contact), contact.height_scale
    return integrals.lowest * Rq, integrals.highest * Rq


def normal_force(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    r"""Normal force on all asperities. [N]

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

    Notes
    -----
    .. math:: F_n = \eta A_n \int_0^\infty f(w)\, \phi\!\left( \frac{d + w}{R_q} \right) \frac{\mathrm{d}w}{R_q}

    See Also
    --------
    sonolube.models.contact.separation : The inverse.

    References
    ----------
    .. [1] D 3.3 to 3.5
    """
    integrals, h = _integrals_at(contact, separation=separation)
    return integrals.force.value(h)


def real_contact_area(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    r"""Real contact area of all asperities. [m2]

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

    Notes
    -----
    .. math:: A_r = \eta A_n \int_0^\infty a(w)\, \phi\!\left( \frac{d + w}{R_q} \right) \frac{\mathrm{d}w}{R_q}

    References
    ----------
    .. [1] D 3.6
    """
    integrals, h = _integrals_at(contact, separation=separation)
    return integrals.area.value(h)


def contact_count(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    """Expected number of asperities in contact. []

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
    """
    integrals, h = _integrals_at(contact, separation=separation)
    return integrals.count.value(h)


def normal_stiffness(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    r"""Normal contact stiffness. [N/m]

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

    Notes
    -----
    .. math:: k_n = -\frac{\mathrm{d} F_n}{\mathrm{d} d}

    The slope of the loading curve. Yielded asperities unload with a higher stiffness than they were loaded with.

    See Also
    --------
    sonolube.models.contact.decay_length : Force over stiffness.
    sonolube.models.contact.mindlin_tangential_stiffness : Tangential stiffness in proportion to this one.

    Examples
    --------
    >>> from sonolube.models.contact import normal_stiffness, separation
    >>> from sonolube.rig import read_rig
    >>> contact = read_rig("examples/rigs/tribometer.toml").contact
    >>> stiffness = normal_stiffness(contact, separation=separation(contact, normal_load=3.0))
    >>> round(1e-6 * float(stiffness), 3)  # 3 N over a decay length of 2 um, in N/um
    1.5
    """
    integrals, h = _integrals_at(contact, separation=separation)
    return integrals.force.value(h) * integrals.force.decay_rate(h) / contact.height_scale


def decay_length(contact: RoughContact, *, separation: ArrayLike | None = None) -> Floats:
    r"""Decay length of the contact force: normal force over normal stiffness. [m]

    Parameters
    ----------
    contact : RoughContact
    separation : array_like, any shape, optional
        Separation of the mean planes; required by every height distribution but the exponential one, whose decay
        length is that of the contact, or R_q/lambda, at any separation. [m]

    Returns
    -------
    ndarray, shape of `separation`

    Raises
    ------
    InvalidInput
        If a separation is not finite, or is missing where it is required.
    OutsideRange
        If a separation lies outside the range of the height distribution.

    Notes
    -----
    .. math:: l = \frac{F_n}{k_n}

    Over this increase of the separation the normal force falls by a factor of e.
    """
    if separation is None:
        if not isinstance(contact.heights, ExponentialHeights):
            raise InvalidInput(f"decay_length of {contact.heights.name} heights varies: give a separation")
        separation = 0.0
    integrals, h = _integrals_at(contact, separation=separation)
    if contact.decay_length is not None:
        return np.full_like(h, contact.decay_length)
    return contact.height_scale / integrals.force.decay_rate(h)


def _integrals_at(contact: RoughContact, *, separation: ArrayLike) -> tuple[GreenwoodWilliamsonIntegrals, Floats]:
    """Integrals over all asperities of a contact, and the separations over the rms height of its heights.

    `h`: Normalized separation.
    """
    d = require_finite(separation=separation)
    _require_range(contact, *separation_range(contact), "separation", "m", d)
    return greenwood_williamson_integrals(contact), d / contact.height_scale


def _require_range(contact: RoughContact, low: float, high: float, name: str, unit: str, values: Floats) -> None:
    """Refuse the first value outside a range."""
    inside = (values >= low) & (values <= high)
    if not inside.all():
        raise OutsideRange(
            f"{name} must lie between {low:.4g} and {high:.4g} {unit} for {contact.heights.name} heights on this "
            f"contact, got {values[~inside].flat[0]:.6g} {unit}"
        )
