"""What speaks against a contact: the ranges its model was made for, and where this one stands."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from sonolube.checks import Floats, require_finite
from sonolube.contact.asperity_sums import TABLE_RANGE
from sonolube.contact.height_distribution import LEAST_ROUGHNESS_PARAMETER, ExponentialHeights, GaussianHeights
from sonolube.contact.rough import RoughContact, contact_count, normal_force, real_contact_area
from sonolube.errors import InvalidInput

USUAL_ROUGHNESS_PARAMETERS = (0.02, 0.1)
MOST_REAL_AREA = 0.1
FEWEST_SUMMITS = 30


def exponential_window(contact: RoughContact, *, factor: float = 2.0) -> tuple[float, float] | None:
    """Return between which normalized separations the exponential height law stands in for the Gaussian one.

    Parameters
    ----------
    contact : RoughContact
        Its height law is taken where it is exponential, else the default exponential one.
    factor : float
        Greatest ratio, either way, allowed between the two loads, above 1.

    Returns
    -------
    tuple of two float, or None
        Lowest and highest separation over Rq; None where the loads are nowhere that close, or where the roughness
        parameter belongs to no Gaussian surface.

    Raises
    ------
    InvalidInput
        If the factor does not exceed 1.

    Notes
    -----
    The summits of the Gaussian surface scatter less than the surface itself, the less the smaller its roughness
    parameter. The ratio of Gaussian to exponential load has one maximum. Where that exceeds `factor`, the window is
    the one at larger separations.
    """
    if not factor > 1:
        raise InvalidInput(f"factor must exceed 1, got {factor!r}")
    roughness = contact.roughness
    if roughness.roughness_parameter <= LEAST_ROUGHNESS_PARAMETER:
        return None
    heights = GaussianHeights.from_roughness_parameter(roughness_parameter=roughness.roughness_parameter)
    gaussian = replace(contact, heights=heights)
    is_exponential = isinstance(contact.heights, ExponentialHeights)
    exponential = contact if is_exponential else replace(contact, heights=ExponentialHeights())

    def log_ratio(h: ArrayLike) -> Floats:
        d = np.multiply(h, roughness.rms_height)
        loads = (normal_force(each, separation=d) for each in (gaussian, exponential))
        return np.subtract(*(np.log(load) for load in loads))

    # within the table, and short of where the loads underflow
    h = heights.spread * np.linspace(TABLE_RANGE[0] + 0.01, 20, 1000)
    ratios, allowed = log_ratio(h), np.log(factor)
    top = int(ratios.argmax())
    if ratios[top] <= -allowed:
        return None

    def crossing(level: float, low: int, high: int) -> float:
        return float(brentq(lambda x: float(log_ratio(x)) - level, h[low], h[high]))

    highest = crossing(-allowed, top, -1)
    lowest = crossing(allowed, top, -1) if ratios[top] > allowed else crossing(-allowed, 0, top)
    return lowest, highest


def contact_caveats(contact: RoughContact, *, separation: ArrayLike) -> tuple[str, ...]:
    """Return what speaks against the contact at these separations, one line each, with advice.

    Parameters
    ----------
    contact : RoughContact
    separation : array_like, any shape
        Separation of the mean planes. [m]

    Returns
    -------
    tuple of str
        Empty where nothing is known to speak against it.

    Raises
    ------
    InvalidInput
        If a separation is not finite.
    OutsideRange
        If a separation lies outside the height law's range.
    """
    d = require_finite(separation=separation)
    lowest, highest = float(d.min()), float(d.max())
    caveats = (
        _roughness_caveat(contact),
        _separation_caveat(lowest),
        _exponential_caveat(contact, lowest, highest),
        _area_caveat(contact, lowest),
        _count_caveat(contact, highest),
    )
    return tuple(caveat for caveat in caveats if caveat)


def _roughness_caveat(contact: RoughContact) -> str:
    beta = contact.roughness.roughness_parameter
    low, high = USUAL_ROUGHNESS_PARAMETERS
    if low <= beta <= high:
        return ""
    return (
        f"roughness parameter {beta:.3g} lies outside the usual {low:g} to {high:g}: "
        "measure rms height, summit radius and summit density on one and the same surface"
    )


def _separation_caveat(lowest: float) -> str:
    if lowest > 0:
        return ""
    return (
        f"separation {1e6 * lowest:.3g} um is not positive: the mean planes have met, and asperities no longer "
        "stand alone; lower the load or the vibration amplitude"
    )


def _exponential_caveat(contact: RoughContact, lowest: float, highest: float) -> str:
    if not isinstance(contact.heights, ExponentialHeights):
        return ""
    window = exponential_window(contact)
    if window is None:
        return (
            f"exponential heights are nowhere within a factor of 2 of Gaussian ones at roughness parameter "
            f"{contact.roughness.roughness_parameter:.3g}: take gaussian heights"
        )
    lowest, highest = lowest / contact.roughness.rms_height, highest / contact.roughness.rms_height
    if window[0] <= lowest and highest <= window[1]:
        return ""
    reached = f"{lowest:.2f}" if lowest == highest else f"{lowest:.2f} to {highest:.2f}"
    return (
        f"separation over rms height is {reached}; the load of exponential heights is within a factor of 2 of that of "
        f"Gaussian ones only from {window[0]:.2f} to {window[1]:.2f}: take gaussian heights"
    )


def _area_caveat(contact: RoughContact, lowest: float) -> str:
    share = float(real_contact_area(contact, separation=lowest)) / contact.nominal_area
    if share <= MOST_REAL_AREA:
        return ""
    return (
        f"real area is {100 * share:.3g} % of the nominal {1e6 * contact.nominal_area:.3g} mm2: above "
        f"{100 * MOST_REAL_AREA:g} % asperities feel each other; lower the load or enlarge the nominal area"
    )


def _count_caveat(contact: RoughContact, highest: float) -> str:
    count = float(contact_count(contact, separation=highest))
    if count >= FEWEST_SUMMITS:
        return ""
    return (
        f"only {count:.2g} asperities touch on the nominal {1e6 * contact.nominal_area:.3g} mm2: "
        f"below {FEWEST_SUMMITS} the mean says little about one contact; raise the load or the nominal area"
    )
