"""Flash temperature: what a sliding patch of heat adds to the bulk, at any Peclet number."""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.thermal.solid import ThermalSolid
from sonolube.thermal.source import HeatSource


class FlashRise(NamedTuple):
    """Rise of the surface under a heat source over the bulk.

    Parameters
    ----------
    peak_temperature_rise : ndarray
        Highest under the source. [K]
    mean_temperature_rise : ndarray
        Mean under the source. [K]
    """

    peak_temperature_rise: Floats
    mean_temperature_rise: Floats


class ContactRise(NamedTuple):
    """How two bodies share the heat of their contact.

    Parameters
    ----------
    heat_partition : ndarray
        Share that flows into the body at which the source stands still. []
    peak_temperature_rise : ndarray
        Highest rise of the contact over the bulk of both. [K]
    mean_temperature_rise : ndarray
        Mean rise of the contact. [K]
    """

    heat_partition: Floats
    peak_temperature_rise: Floats
    mean_temperature_rise: Floats


def peclet_number(solid: ThermalSolid, source: HeatSource, *, sliding_speed: ArrayLike) -> Floats:
    """Return the Peclet number V b/(2 kappa) of a source on a solid. []

    Parameters
    ----------
    solid : ThermalSolid
    source : HeatSource
    sliding_speed : array_like, any shape
        Speed of the source over the solid, zero at rest. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If a speed is negative or not finite.
    """
    v = require_non_negative(sliding_speed=sliding_speed)
    return v * source.half_length / (2 * solid.thermal_diffusivity)


def low_peclet_rise(solid: ThermalSolid, source: HeatSource, *, heat_flux: ArrayLike) -> FlashRise:
    """Return the steady rise under a source at rest.

    Parameters
    ----------
    solid : ThermalSolid
    source : HeatSource
    heat_flux : array_like, any shape
        Heat that enters, mean over the source. [W/m2]

    Returns
    -------
    FlashRise

    Raises
    ------
    InvalidInput
        If a flux is negative or not finite.

    References
    ----------
    .. [1] J. C. Jaeger, J. Proc. R. Soc. N.S.W. 76, 203 (1942).
    """
    scale = _scale(solid, source, heat_flux)
    return FlashRise(scale * source.peak_low_peclet, scale * source.mean_low_peclet)


def high_peclet_rise(
    solid: ThermalSolid, source: HeatSource, *, heat_flux: ArrayLike, sliding_speed: ArrayLike
) -> FlashRise:
    """Return the rise under a source so fast that heat flows only downwards.

    Parameters
    ----------
    solid : ThermalSolid
    source : HeatSource
    heat_flux : array_like
        Heat that enters, mean over the source. [W/m2]
    sliding_speed : array_like, broadcast against `heat_flux`
        Speed of the source over the solid. [m/s]

    Returns
    -------
    FlashRise

    Raises
    ------
    InvalidInput
        If a flux is negative, a speed not positive, or a value not finite.

    Notes
    -----
    For Peclet numbers above ten or so. Each point is heated for as long as the source takes to pass it.

    References
    ----------
    .. [1] J. C. Jaeger, J. Proc. R. Soc. N.S.W. 76, 203 (1942).
    """
    require_positive(sliding_speed=sliding_speed)
    pe = peclet_number(solid, source, sliding_speed=sliding_speed)
    peak = _scale(solid, source, heat_flux) * source.peak_high_peclet / np.sqrt(pe)
    return FlashRise(peak, source.mean_to_peak_high_peclet * peak)


def flash_rise(solid: ThermalSolid, source: HeatSource, *, heat_flux: ArrayLike, sliding_speed: ArrayLike) -> FlashRise:
    """Return the steady rise under a sliding source at any speed.

    Parameters
    ----------
    solid : ThermalSolid
    source : HeatSource
    heat_flux : array_like
        Heat that enters, mean over the source. [W/m2]
    sliding_speed : array_like, broadcast against `heat_flux`
        Speed of the source over the solid, zero at rest. [m/s]

    Returns
    -------
    FlashRise

    Raises
    ------
    InvalidInput
        If a flux or speed is negative or not finite.

    Notes
    -----
    Interpolates between both limits as c/sqrt(Pe_0 + Pe), in which the limits leave nothing to fit; with it the known
    constants of Tian and Kennedy come out, whose text was not at hand: 2, 1.273 for the peak and 1.22, 0.6575 for the
    mean of the circle, 2, 1.011 for the peak of the square, 2.32, 1.234 for that of a round `HertzianSource`, which is
    18 % hotter than even flux. Against integrals over circle and square the peak is within 2.5 %, the mean within 4 %;
    of Hertz within 1.5 and 5 %.

    References
    ----------
    .. [1] X. Tian, F. E. Kennedy, J. Tribol. 116, 167 (1994). doi:10.1115/1.2927035
    .. [2] Y. S. Muzychka, M. M. Yovanovich, J. Tribol. 123, 624 (2001). doi:10.1115/1.1370516
    """
    scale = _scale(solid, source, heat_flux)
    pe = peclet_number(solid, source, sliding_speed=sliding_speed)
    peak = scale / np.sqrt(source.peak_low_peclet**-2 + pe / source.peak_high_peclet**2)
    mean = scale / np.sqrt(
        source.mean_low_peclet**-2 + pe / (source.mean_to_peak_high_peclet * source.peak_high_peclet) ** 2
    )
    return FlashRise(peak, mean)


def contact_rise(
    still: ThermalSolid,
    moving: ThermalSolid,
    source: HeatSource,
    *,
    heat_rate: ArrayLike,
    sliding_speed: ArrayLike,
) -> ContactRise:
    """Return how heat parts between two bodies so that their mean temperatures in the contact agree.

    Parameters
    ----------
    still : ThermalSolid
        The body that carries the contact with it, such as a pin.
    moving : ThermalSolid
        The body that the contact passes over, such as a disc.
    source : HeatSource
        The contact.
    heat_rate : array_like
        Heat of the contact. [W]
    sliding_speed : array_like, broadcast against `heat_rate`
        Speed of the sliding, zero at rest. [m/s]

    Returns
    -------
    ContactRise

    Raises
    ------
    InvalidInput
        If a heat or speed is negative or not finite.

    Notes
    -----
    After Jaeger; `blok_partition` matches the peaks instead. Both bodies are half-spaces of one bulk temperature. The
    peak is the higher of both bodies', which only agree in the mean.

    References
    ----------
    .. [1] H. Blok, Proc. Gen. Disc. Lubrication, Inst. Mech. Eng. 2, 222 (1937).
    .. [2] J. C. Jaeger, J. Proc. R. Soc. N.S.W. 76, 203 (1942).
    """
    q = require_non_negative(heat_rate=heat_rate) / source.area
    below = low_peclet_rise(still, source, heat_flux=1.0)
    above = flash_rise(moving, source, heat_flux=1.0, sliding_speed=sliding_speed)
    share = _into_the_first(below.mean_temperature_rise, above.mean_temperature_rise)
    peak = np.maximum(share * below.peak_temperature_rise, (1 - share) * above.peak_temperature_rise)
    return ContactRise(share + 0 * q, q * peak, q * share * below.mean_temperature_rise)


def blok_partition(
    still: ThermalSolid, moving: ThermalSolid, source: HeatSource, *, sliding_speed: ArrayLike
) -> Floats:
    """Return the share of heat into the still body that makes the highest temperatures of both agree. []

    Parameters
    ----------
    still : ThermalSolid
        The body that carries the contact with it, such as a pin.
    moving : ThermalSolid
        The body that the contact passes over, such as a disc.
    source : HeatSource
        The contact.
    sliding_speed : array_like, any shape
        Speed of the sliding, zero at rest. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If a speed is negative or not finite.

    References
    ----------
    .. [1] H. Blok, Proc. Gen. Disc. Lubrication, Inst. Mech. Eng. 2, 222 (1937).
    """
    below = low_peclet_rise(still, source, heat_flux=1.0).peak_temperature_rise
    above = flash_rise(moving, source, heat_flux=1.0, sliding_speed=sliding_speed).peak_temperature_rise
    return _into_the_first(below, above)


def _into_the_first(first: Floats, second: Floats) -> Floats:
    return second / (first + second)


def _scale(solid: ThermalSolid, source: HeatSource, heat_flux: ArrayLike) -> Floats:
    return require_non_negative(heat_flux=heat_flux) * source.half_length / solid.thermal_conductivity
