"""Validity range of the statistical contact model: caveats of a contact, and the range of exponential heights."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite
from sonolube.errors import InvalidInput
from sonolube.models.contact.greenwood_williamson import TABLE_RANGE, log_normal_force_function
from sonolube.models.contact.height_distribution import MINIMUM_ROUGHNESS_PARAMETER, ExponentialHeights, GaussianHeights
from sonolube.models.contact.rough import RoughContact, contact_count, normal_force, real_contact_area

TYPICAL_ROUGHNESS_PARAMETERS = (0.02, 0.1)
"""Range of the roughness parameter of most engineering surfaces. []"""

MAXIMUM_AREA_FRACTION = 0.1
"""Real over nominal area above which asperities interact. []"""

MINIMUM_CONTACT_COUNT = 30
"""Number of asperities in contact below which the mean of the model is not representative of one contact. []"""


_POINTS = 500  # at which the loads are compared, a twentieth of the heights' standard deviation apart
_SECANTS = 6  # between two of them, to rounding


@lru_cache(maxsize=64)
def exponential_validity_range(contact: RoughContact, *, factor: float = 2.0) -> tuple[float, float] | None:
    """Range of normalized separations in which exponential heights approximate Gaussian ones.

    Parameters
    ----------
    contact : RoughContact
        Its own height distribution is compared where it is exponential, else the default exponential one.
    factor : float
        Largest ratio, either way, between the two loads at one separation, above 1.

    Returns
    -------
    tuple of two float, or None
        Lowest and highest separation over R_q; None where the loads agree within the factor at no separation, or where
        no Gaussian surface has the roughness parameter.

    Raises
    ------
    InvalidInput
        If the factor does not exceed 1.

    Notes
    -----
    The Gaussian summit heights have the standard deviation of `GaussianHeights.from_roughness_parameter`, which falls
    with the roughness parameter. The ratio of Gaussian to exponential load has one maximum over the separation. Where
    that exceeds `factor`, the range is the one at larger separations. A decay length of the contact's own is left out:
    the range is that of its roughness.
    """
    if not factor > 1:
        raise InvalidInput(f"factor must exceed 1, got {factor!r}")
    contact, roughness = replace(contact, decay_length=None), contact.roughness
    if roughness.roughness_parameter <= MINIMUM_ROUGHNESS_PARAMETER:
        return None
    heights = GaussianHeights.from_roughness_parameter(roughness_parameter=roughness.roughness_parameter)
    gaussian = replace(contact, heights=heights)
    is_exponential = isinstance(contact.heights, ExponentialHeights)
    exponential = contact if is_exponential else replace(contact, heights=ExponentialHeights())
    log_force = log_normal_force_function(gaussian)

    def log_ratio(h: Floats) -> Floats:
        load = normal_force(exponential, separation=h * roughness.rms_height)
        return log_force(h) - np.log(load)

    # within the table, and short of where the loads underflow
    h = heights.standard_deviation * np.linspace(TABLE_RANGE[0] + 0.01, 20, _POINTS)
    ratios, tolerance = log_ratio(h), float(np.log(factor))
    peak = int(ratios.argmax())
    if ratios[peak] <= -tolerance:
        return None

    def separation_at(level: float, part: slice, end: float) -> float:
        beyond = np.flatnonzero(np.diff(ratios[part] < level))
        return _crossing(log_ratio, level, *h[part][beyond[0] : beyond[0] + 2]) if beyond.size else end

    falling, rising, (first, last) = slice(peak, None), slice(peak + 1), h[[0, -1]].tolist()
    highest = separation_at(-tolerance, falling, last)
    if ratios[peak] > tolerance:
        return separation_at(tolerance, falling, last), highest
    return separation_at(-tolerance, rising, first), highest


def _crossing(function: Callable[[Floats], Floats], level: float, low: float, high: float) -> float:
    """Where a nearly straight function has a level, by secants from two places on either side of it."""
    x = np.array([low, high])
    y = function(x) - level
    for _ in range(_SECANTS):
        if y[1] == y[0]:
            break
        x = np.array([x[1], x[1] - y[1] * (x[1] - x[0]) / (y[1] - y[0])])
        y = np.array([y[1], float(function(x[1:])[0]) - level])
    return float(x[1])


def contact_caveats(contact: RoughContact, *, separation: ArrayLike) -> tuple[str, ...]:
    """Caveats against the statistical model for a contact at these separations, each with a remedy.

    Parameters
    ----------
    contact : RoughContact
    separation : array_like, any shape
        Separation of the mean planes. [m]

    Returns
    -------
    tuple of str
        One line for each caveat; empty where none applies.

    Raises
    ------
    InvalidInput
        If a separation is not finite.
    OutsideRange
        If a separation lies outside the range of the height distribution.
    """
    d = require_finite(separation=separation)
    lowest, highest = float(d.min()), float(d.max())
    return tuple(_caveats(contact, lowest, highest))


def _caveats(contact: RoughContact, lowest: float, highest: float) -> Iterator[str]:
    """Caveats of a contact between its lowest and its highest separation."""
    beta, (low, high) = contact.roughness.roughness_parameter, TYPICAL_ROUGHNESS_PARAMETERS
    if not low <= beta <= high:
        yield (
            f"roughness parameter {beta:.3g} lies outside the typical range {low:g} to {high:g}: "
            "measure rms height, summit radius and summit density on the same surface"
        )
    if not lowest > 0:
        yield (
            f"separation {1e6 * lowest:.3g} um is not positive: the mean planes touch, and asperities interact; "
            "reduce the load or the vibration amplitude"
        )
    if caveat := _exponential_caveat(contact, lowest, highest):
        yield caveat
    fraction = float(real_contact_area(contact, separation=lowest)) / contact.nominal_area
    if not fraction <= MAXIMUM_AREA_FRACTION:
        yield (
            f"real area is {_percent(fraction)} % of the nominal {1e6 * contact.nominal_area:.6g} mm2: above "
            f"{100 * MAXIMUM_AREA_FRACTION:g} % asperities interact; reduce the load or increase the nominal area"
        )
    count = float(contact_count(contact, separation=highest))
    if count < 1:
        yield (
            f"less than one asperity, {count:.2g} in the mean, is in contact on the nominal "
            f"{1e6 * contact.nominal_area:.6g} mm2: the statistical contact model does not hold; increase the load or "
            "the nominal area"
        )
    elif not count >= MINIMUM_CONTACT_COUNT:
        yield (
            f"only {count:.2g} asperities are in contact on the nominal {1e6 * contact.nominal_area:.6g} mm2: below "
            f"{MINIMUM_CONTACT_COUNT} the mean is not representative of one contact; increase the load or the nominal"
            " area"
        )


def _percent(fraction: float) -> str:
    """Percentage with three digits and without an exponent."""
    return f"{float(f'{100 * fraction:.3g}'):.15g}"


def _exponential_caveat(contact: RoughContact, lowest: float, highest: float) -> str:
    """Caveat against exponential heights outside their range, or an empty text."""
    if not isinstance(contact.heights, ExponentialHeights) or contact.decay_length is not None:
        return ""  # a decay length that is known itself is no fit to the tail of Gaussian heights
    valid = exponential_validity_range(contact)
    if valid is None:
        return (
            f"the load of exponential heights is at no separation within a factor of 2 of that of Gaussian ones for "
            f"roughness parameter {contact.roughness.roughness_parameter:.3g}: use gaussian heights"
        )
    lowest, highest = lowest / contact.roughness.rms_height, highest / contact.roughness.rms_height
    if valid[0] <= lowest and highest <= valid[1]:
        return ""
    reached = f"{lowest:.2f}" if lowest == highest else f"{lowest:.2f} to {highest:.2f}"
    return (
        f"separation over rms height is {reached}; the load of exponential heights is within a factor of 2 of that of "
        f"Gaussian ones only from {valid[0]:.2f} to {valid[1]:.2f}: use gaussian heights"
    )
