"""Statistical contact of rough surfaces: what a load does to the separation, the real area and the stiffness."""

import math
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_positive
from sonolube.contact.asperity import AsperityLaw, ChangEtsionBogy, critical_interference
from sonolube.contact.asperity_sums import AsperitySums, asperity_sums
from sonolube.contact.height_distribution import ExponentialHeights, HeightDistribution
from sonolube.contact.pair import ContactPair
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.surfaces import Roughness


@dataclass(frozen=True, kw_only=True, slots=True)
class RoughContact:
    """Two rough surfaces in contact.

    Parameters
    ----------
    roughness : Roughness
        Combined roughness of both surfaces.
    pair : ContactPair
    nominal_area : float
        Area over which the bodies face each other. [m2]
    heights : HeightDistribution
    asperity : AsperityLaw
        That of Chang, Etsion and Bogy where absent.

    Raises
    ------
    InvalidInput
        If the area is not positive and finite.

    Notes
    -----
    Asperities are spheres of one radius that do not feel each other: real area far below the nominal one. Separations
    run from the mean of the summit heights. `contact_caveats` says what speaks against a contact.

    References
    ----------
    .. [1] J. A. Greenwood and J. B. P. Williamson, Proc. R. Soc. A 295, 300 (1966). doi:10.1098/rspa.1966.0242
    .. [2] A. A. Polycarpou and I. Etsion, J. Tribol. 121, 234 (1999). doi:10.1115/1.2833926
    """

    roughness: Roughness
    pair: ContactPair
    nominal_area: float
    heights: HeightDistribution = field(default_factory=ExponentialHeights)
    asperity: AsperityLaw = field(default_factory=ChangEtsionBogy)

    def __post_init__(self) -> None:
        require_positive(nominal_area=self.nominal_area)


def separation(contact: RoughContact, *, normal_load: ArrayLike) -> Floats:
    """Return the separation at which the asperities carry a load. [m]

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
        If no separation of the height law's range carries a load.

    Notes
    -----
    Not positive where the load is so high that the mean planes meet: see `contact_caveats`.

    References
    ----------
    .. [1] D 3.3
    """
    load = require_positive(normal_load=normal_load)
    sums = _sums(contact)
    least, most = sums.force.value(np.array([sums.highest, sums.lowest])).tolist()
    _require_range(contact, least, most, "normal_load", "N", load)
    return sums.force.inverse(load) * contact.roughness.rms_height


def separation_range(contact: RoughContact) -> tuple[float, float]:
    """Return the least and the greatest separation for which the height law is evaluated. [m]

    Parameters
    ----------
    contact : RoughContact

    Returns
    -------
    tuple of float
        The greatest is infinite for exponential heights.
    """
    sums, Rq = _sums(contact), contact.roughness.rms_height
    return sums.lowest * Rq, sums.highest * Rq


def normal_force(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    """Return the normal force of all asperities. [N]

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
        If a separation lies outside the height law's range.

    References
    ----------
    .. [1] D 3.3 to 3.5
    """
    sums, h = _sums_and_separation(contact, separation)
    return sums.force.value(h)


def real_contact_area(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    """Return the real contact area. [m2]

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
        If a separation lies outside the height law's range.

    References
    ----------
    .. [1] D 3.6
    """
    sums, h = _sums_and_separation(contact, separation)
    return sums.area.value(h)


def elastic_area(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    """Return the real contact area of the asperities that have not begun to yield. [m2]

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
        If a separation lies outside the height law's range.

    References
    ----------
    .. [1] D 3.7, with exp(-lambda w_c/Rq) where exp(+lambda w_c/Rq) is printed.
    """
    sums, h = _sums_and_separation(contact, separation)
    return sums.area.value(h) * sums.elastic_area_fraction.value(h)


def plastic_area(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    """Return the real contact area of the asperities that have begun to yield. [m2]

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
        If a separation lies outside the height law's range.

    References
    ----------
    .. [1] D 3.8
    """
    sums, h = _sums_and_separation(contact, separation)
    return sums.area.value(h) * np.maximum(1 - sums.elastic_area_fraction.value(h), 0.0)


def elastic_load_fraction(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    """Return the share of the normal force on asperities that have not begun to yield. []

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
        If a separation lies outside the height law's range.

    References
    ----------
    .. [1] D 3.4 over 3.3
    """
    sums, h = _sums_and_separation(contact, separation)
    return np.minimum(sums.elastic_load_fraction.value(h), 1.0)


def contact_count(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    """Return the expected number of asperities in contact. []

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
        If a separation lies outside the height law's range.
    """
    sums, h = _sums_and_separation(contact, separation)
    return sums.count.value(h)


def normal_stiffness(contact: RoughContact, *, separation: ArrayLike) -> Floats:
    """Return the normal stiffness, -dF/dd. [N/m]

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
        If a separation lies outside the height law's range.

    Notes
    -----
    The slope of the loading curve. Yielded asperities unload more stiffly than they were loaded.
    """
    sums, h = _sums_and_separation(contact, separation)
    return sums.force.value(h) * sums.force.decay(h) / contact.roughness.rms_height


def decay_length(contact: RoughContact, *, separation: ArrayLike | None = None) -> Floats:
    """Return the length over which the normal force falls by a factor of e: force over stiffness. [m]

    Parameters
    ----------
    contact : RoughContact
    separation : array_like, any shape, optional
        Separation of the mean planes; needed by every height law but the exponential one, whose decay length is
        Rq/lambda everywhere. [m]

    Returns
    -------
    ndarray, shape of `separation`

    Raises
    ------
    InvalidInput
        If a separation is not finite, or is missing where it is needed.
    OutsideRange
        If a separation lies outside the height law's range.
    """
    if separation is None:
        if not isinstance(contact.heights, ExponentialHeights):
            raise InvalidInput(f"decay_length of {contact.heights.name} heights varies: separation must be given")
        separation = 0.0
    sums, h = _sums_and_separation(contact, separation)
    return contact.roughness.rms_height / sums.force.decay(h)


def plasticity_index(contact: RoughContact) -> float:
    """Return the plasticity index sqrt(Rq/w_c): elastic contact well below 1, plastic contact well above. []

    Parameters
    ----------
    contact : RoughContact

    Returns
    -------
    float
        Zero for asperities that never yield.

    References
    ----------
    .. [1] W. R. Chang, I. Etsion and D. B. Bogy, J. Tribol. 109, 257 (1987). doi:10.1115/1.3261348
    """
    roughness = contact.roughness
    w_c = critical_interference(contact.asperity, contact.pair, summit_radius=roughness.summit_radius)
    return math.sqrt(roughness.rms_height / w_c)


@lru_cache(maxsize=512)
def _sums(contact: RoughContact) -> AsperitySums:
    return asperity_sums(
        roughness=contact.roughness,
        pair=contact.pair,
        nominal_area=contact.nominal_area,
        heights=contact.heights,
        asperity=contact.asperity,
    )


def _sums_and_separation(contact: RoughContact, separation: ArrayLike) -> tuple[AsperitySums, Floats]:
    d = require_finite(separation=separation)
    _require_range(contact, *separation_range(contact), "separation", "m", d)
    return _sums(contact), d / contact.roughness.rms_height


def _require_range(contact: RoughContact, low: float, high: float, name: str, unit: str, values: Floats) -> None:
    inside = (values >= low) & (values <= high)
    if not inside.all():
        raise OutsideRange(
            f"{name} must lie between {low:.4g} and {high:.4g} {unit} for {contact.heights.name} heights on this "
            f"contact, got {values[~inside].flat[0]:.6g} {unit}"
        )
