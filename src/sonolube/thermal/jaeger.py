"""Sources of heat that move over a half-space, integrated: what the flash-temperature formulas approximate."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import quad_vec
from scipy.special import erf

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.thermal.jaeger_integral import moving_band_integrals
from sonolube.thermal.solid import ThermalSolid
from sonolube.thermal.source import RectangularSource

_PRECISION = 1e-9


def moving_band_rise(
    solid: ThermalSolid,
    *,
    heat_flux: ArrayLike,
    half_length: ArrayLike,
    sliding_speed: ArrayLike,
    distance_ahead: ArrayLike,
) -> Floats:
    """Return the steady rise of the surface at and about a band of heat, endless across the sliding. [K]

    Parameters
    ----------
    solid : ThermalSolid
    heat_flux : array_like
        Heat that enters, even over the band. [W/m2]
    half_length : array_like, broadcast against `heat_flux`
        Half the length of the band along the sliding. [m]
    sliding_speed : array_like, broadcast against them
        Speed of the band over the solid; at rest the rise has no bound. [m/s]
    distance_ahead : array_like, broadcast against them
        Distance ahead of the middle of the band, negative behind it. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a flux is negative, a length or speed not positive, or a value not finite.

    Notes
    -----
    Jaeger's integrand exp(-u) K0(abs u) has the antiderivative u exp(-u) [K0(abs u) - sgn(u) K1(abs u)], and so needs
    no quadrature: good to 1e-11 of the highest.

    References
    ----------
    .. [1] J. C. Jaeger, J. Proc. R. Soc. N.S.W. 76, 203 (1942).
    .. [2] NIST Digital Library of Mathematical Functions, 10.43.9.
    """
    q = require_non_negative(heat_flux=heat_flux)
    b = require_positive(half_length=half_length)
    v = require_positive(sliding_speed=sliding_speed)
    x = require_finite(distance_ahead=distance_ahead)
    per_length = v / (2 * solid.thermal_diffusivity)
    behind, ahead = np.broadcast_arrays(per_length * (x - b), per_length * (x + b))
    source = moving_band_integrals(behind.ravel(), ahead.ravel()).reshape(behind.shape)
    return q / (np.pi * solid.thermal_conductivity * per_length) * source


def moving_rectangle_rise(
    solid: ThermalSolid,
    source: RectangularSource,
    *,
    heat_flux: float,
    sliding_speed: float,
    distance_ahead: ArrayLike = 0.0,
    transverse_distance: ArrayLike = 0.0,
    duration: float | None = None,
) -> Floats:
    """Return the rise of the surface at and about a rectangle of heat, at rest or moving. [K]

    Parameters
    ----------
    solid : ThermalSolid
    source : RectangularSource
    heat_flux : float
        Heat that enters, even over the rectangle. [W/m2]
    sliding_speed : float
        Speed of the source over the solid, zero at rest. [m/s]
    distance_ahead : array_like
        Distance ahead of the middle of the source, negative behind it. [m]
    transverse_distance : array_like, broadcast against `distance_ahead`
        Distance from the middle of the source across the sliding. [m]
    duration : float, optional
        Time since the heat set in; steady where it is absent. [s]

    Returns
    -------
    ndarray, shape of the broadcast distances

    Raises
    ------
    InvalidInput
        If the flux, the speed or the duration is negative, or a value not finite.

    Notes
    -----
    Integrates over the ages of the heat, to 1e-9 of the peak.

    References
    ----------
    .. [1] H. S. Carslaw, J. C. Jaeger, Conduction of Heat in Solids, 2nd ed., Oxford (1959), section 10.7.
    """
    q = float(require_non_negative(heat_flux=heat_flux))
    v = float(require_non_negative(sliding_speed=sliding_speed))
    x, y = np.broadcast_arrays(
        require_finite(distance_ahead=distance_ahead), require_finite(transverse_distance=transverse_distance)
    )
    b = source.half_length
    reach = np.inf if duration is None else float(np.sqrt(solid.thermal_diffusivity * _duration(duration))) / b
    along, aside, width = x / b, y / b, source.half_width / b
    drift = v * b / solid.thermal_diffusivity

    def of_age(s: float) -> Floats:
        """Return what heat of one age adds; s is the length it has spread, in units of half the source's."""
        passed = drift * s**2
        spread = erf((along + passed + 1) / (2 * s)) - erf((along + passed - 1) / (2 * s))
        return np.asarray(spread * (erf((aside + width) / (2 * s)) - erf((aside - width) / (2 * s))))

    integral, _ = quad_vec(of_age, 0.0, reach, epsabs=_PRECISION, epsrel=_PRECISION, limit=2000)
    return np.asarray(q * b / (2 * np.sqrt(np.pi) * solid.thermal_conductivity) * integral)


def _duration(duration: float) -> float:
    return float(require_non_negative(duration=duration))
