"""Surface temperature around moving heat sources by integration: Jaeger's band and rectangle."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import quad_vec
from scipy.special import erf, k0e, k1e

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.models.thermal.solid import ThermalSolid
from sonolube.models.thermal.source import RectangularSource

_TOLERANCE = 1e-9  # absolute and relative, of the quadrature


def moving_band_rise(
    solid: ThermalSolid,
    *,
    heat_flux: ArrayLike,
    half_length: ArrayLike,
    sliding_speed: ArrayLike,
    distance_ahead: ArrayLike,
) -> Floats:
    r"""Steady surface temperature rise around a uniform moving band source, by Jaeger's integral. [K]

    Parameters
    ----------
    solid : ThermalSolid
    heat_flux : array_like
        Heat flux into the solid, uniform over the band, which is infinitely long across the sliding. [W/m2]
    half_length : array_like, broadcast against `heat_flux`
        Half the length of the band along the sliding, b. [m]
    sliding_speed : array_like, broadcast against them
        Speed of the band over the solid, V; the rise of a stationary band is unbounded. [m/s]
    distance_ahead : array_like, broadcast against them
        Distance ahead of the centre of the band, negative behind it, x. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a flux is negative, a length or speed not positive, or a value not finite.

    See Also
    --------
    moving_rectangle_rise : a source of finite width, stationary or moving, also in time.

    Notes
    -----
    .. math::

        \Delta T(x) = \frac{2 q \kappa}{\pi k V} \int_{V(x - b)/2\kappa}^{V(x + b)/2\kappa} e^{-u} K_0(|u|)\,du .

    The integrand has the antiderivative :math:`u e^{-u} [K_0(|u|) - \operatorname{sgn}(u) K_1(|u|)]`, so that no
    quadrature is needed: accurate to 1e-11 of the maximum.

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
    integral = _antiderivative(per_length * (x + b)) - _antiderivative(per_length * (x - b))
    return q / (np.pi * solid.thermal_conductivity * per_length) * integral


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
    r"""Surface temperature rise around a uniform rectangular source, at rest or moving, by quadrature. [K]

    Parameters
    ----------
    solid : ThermalSolid
    source : RectangularSource
    heat_flux : float
        Heat flux into the solid, uniform over the rectangle. [W/m2]
    sliding_speed : float
        Speed of the source over the solid, zero for a stationary source, V. [m/s]
    distance_ahead : array_like
        Distance ahead of the centre of the source, negative behind it, x. [m]
    transverse_distance : array_like, broadcast against `distance_ahead`
        Distance from the centre of the source across the sliding, y. [m]
    duration : float, optional
        Time since the flux was applied; without it the steady state. [s]

    Returns
    -------
    ndarray, shape of the broadcast distances

    Raises
    ------
    InvalidInput
        If the flux, the speed or the duration is negative, or a value not finite.

    See Also
    --------
    moving_band_rise : the limit of a source of infinite width, in closed form.

    Notes
    -----
    Superposition of instantaneous sources of age t. With :math:`s = \sqrt{\kappa t}/b`, lengths in units of the half
    length b, the half width l and :math:`\xi = x + (V b/\kappa) s^2`,

    .. math::

        \Delta T = \frac{q b}{2\sqrt{\pi} k} \int_0^{s_{max}}
        \left[ \operatorname{erf} \frac{\xi + 1}{2 s} - \operatorname{erf} \frac{\xi - 1}{2 s} \right]
        \left[ \operatorname{erf} \frac{y + l}{2 s} - \operatorname{erf} \frac{y - l}{2 s} \right] ds ,

    adaptive quadrature to 1e-9 of the peak.

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
    oldest = np.inf
    if duration is not None:
        oldest = float(np.sqrt(solid.thermal_diffusivity * require_non_negative(duration=duration))) / b
    along, across, width = x / b, y / b, source.half_width / b
    speed = v * b / solid.thermal_diffusivity

    def integrand(s: float) -> Floats:
        """Contribution of heat of one age; s is its diffusion length over the source's half length."""
        passed = speed * s**2
        longitudinal = erf((along + passed + 1) / (2 * s)) - erf((along + passed - 1) / (2 * s))
        return np.asarray(longitudinal * (erf((across + width) / (2 * s)) - erf((across - width) / (2 * s))))

    integral, _ = quad_vec(integrand, 0.0, oldest, epsabs=_TOLERANCE, epsrel=_TOLERANCE, limit=2000)
    return np.asarray(q * b / (2 * np.sqrt(np.pi) * solid.thermal_conductivity) * integral)


def _antiderivative(u: Floats) -> Floats:
    """Antiderivative u exp(-u) (K0(abs u) - sgn(u) K1(abs u)) of exp(-u) K0(abs u), -1 at zero."""
    s = np.maximum(np.abs(u), np.finfo(np.float64).tiny)
    k0, k1 = k0e(s), k1e(s)  # times exp(s)
    return np.asarray(np.where(u < 0, -s * (k0 + k1), s * np.exp(-2 * s) * (k0 - k1)))
