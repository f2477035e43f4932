"""Surface temperature around a rectangular heat source, at rest or moving, by integration after Jaeger."""

import numpy as np
from numpy.typing import ArrayLike
from scipy.integrate import quad_vec
from scipy.special import erf

from sonolube.checks import Floats, require_finite, require_non_negative
from sonolube.models.thermal.source import RectangularSource, ThermalSolid

_TOLERANCE = 1e-9  # absolute and relative, of the quadrature


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
