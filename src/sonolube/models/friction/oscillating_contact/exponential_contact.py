"""Springs on exponential heights under an oscillation within the plane of contact.

The load of a spring, and with it the slip length at which it slips, is distributed exponentially with the mean slip
length s, so that a tangential displacement u of the contact at rest meets the share 1 - exp(-u/s) of its friction.
"""

from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.models.friction.uniform_spline import in_chunks, spline_coefficients, spline_values

_ROWS, _COLUMNS = 97, 129
_LOG_STROKE = (float(np.log(1e-3)), float(np.log(1e3)))  # amplitudes over slip lengths of the table
_PHASES = np.polynomial.legendre.leggauss(80)
_HEIGHTS = np.polynomial.legendre.leggauss(64)
_NEGLIGIBLE = 45.0  # slip lengths beyond the amplitude from which on springs have no load
_LAST = 1 - 1e-9  # velocity ratio in place of 1, where the tabulated function is a limit


def exponential_longitudinal_ratio(*, velocity_ratio: ArrayLike, amplitude_ratio: ArrayLike) -> Floats:
    r"""Friction ratio of springs on exponential heights under an oscillation along the sliding direction. []

    Parameters
    ----------
    velocity_ratio : array_like
        Sliding speed over peak velocity of the oscillation, v_r/(omega a). []
    amplitude_ratio : array_like, broadcast against `velocity_ratio`
        Amplitude over mean slip length, a/s. []

    Returns
    -------
    ndarray, shape of the broadcast arguments
        From exp(-a/s) for slow sliding to exactly 1 from v_r = omega a on; interpolated to 2e-4, and to 4e-3 above 100
        slip lengths. Never below that of rigid contacts, :math:`(2/\pi) \arcsin v_r/(\omega a)`, its limit for large
        amplitudes.

    Raises
    ------
    InvalidInput
        If a velocity ratio is not positive, an amplitude ratio negative, or a value not finite.

    Notes
    -----
    Every spring slips forward before the contact turns back at the position x_1. By Masing's rule the friction then is

    .. math:: F/F_0 = 2 e^{-(x_1 - x)/(2 s)} - 1, \qquad
              F/F_0 = 1 + 2 e^{-(x_1 - x_2)/(2 s)} - 2 e^{-(x - x_2)/(2 s)}

    backward to the position x_2, and forward again up to x_1, from where on it is 1.

    See Also
    --------
    longitudinal_oscillation_ratio : Springs of one profile.
    exponential_static_ratio : The limit for slow sliding in any direction of the plane.

    References
    ----------
    .. [1] G. Masing, Proc. 2nd Int. Congr. Appl. Mech., Zurich, 332 (1926), for the rule; the mean is derived here.

    Examples
    --------
    >>> from sonolube.models.friction import exponential_longitudinal_ratio
    >>> exponential_longitudinal_ratio(velocity_ratio=[1e-6, 0.3, 1.0], amplitude_ratio=2.0).round(2).tolist()
    [0.14, 0.49, 1.0]
    """
    zeta = np.minimum(require_positive(velocity_ratio=velocity_ratio), 1.0)
    return in_chunks(_interpolated, zeta, require_non_negative(amplitude_ratio=amplitude_ratio))


def exponential_static_ratio(*, vibration_direction: ArrayLike, amplitude_ratio: ArrayLike) -> Floats:
    r"""Friction ratio for slow sliding of springs on exponential heights under a line within the plane. []

    Parameters
    ----------
    vibration_direction : array_like
        Angle theta between oscillation and sliding. [rad]
    amplitude_ratio : array_like, broadcast against it
        Amplitude over mean slip length, a/s. []

    Returns
    -------
    ndarray, shape of the broadcast arguments
        From 1 without oscillation to 0; exp(-a/s) along the sliding, :math:`(a/s) K_1(a/s)` across it.

    Raises
    ------
    InvalidInput
        If an amplitude ratio is negative, or a value not finite.

    Notes
    -----
    A spring of slip length sigma a comes to rest where it slips, in a period, along the sliding alone: with one end of
    the stroke at its limit for :math:`\sigma \cos\theta > 1`, else with both,

    .. math:: \frac{F_1}{F_0} = \left(\frac as\right)^2 \left[ \int_1^{1/\cos\theta}
              \sqrt{\sigma^2 - 1}\,\sin\theta\; e^{-\sigma a/s} d\sigma
              + \int_{1/\cos\theta}^\infty (\sigma - \cos\theta)\, e^{-\sigma a/s} d\sigma \right]

    See Also
    --------
    transverse_static_ratio : Springs of one profile, across the sliding.
    """
    angle, stroke = np.broadcast_arrays(
        np.abs(require_finite(vibration_direction=vibration_direction)),
        require_non_negative(amplitude_ratio=amplitude_ratio),
    )
    x, c, s = np.maximum(stroke, 1e-12)[..., None], np.abs(np.cos(angle))[..., None], np.sin(angle)[..., None]
    both = 1 / np.maximum(c, 1e-12)  # slip length in amplitudes from which on one end alone is at its limit
    width = np.minimum(both - 1, _NEGLIGIBLE / x)
    root = (1 + _HEIGHTS[0]) / 2
    sigma = 1 + width * root**2
    heights = np.sqrt(sigma**2 - 1) * np.abs(s) * np.exp(-sigma * x) * x**2 * width * root * _HEIGHTS[1]
    one_end = np.exp(-np.minimum(x * both, 700.0)) * (x * both + 1 - c * x)
    return np.asarray(np.minimum(heights.sum(axis=-1) + one_end[..., 0], 1.0))


def _interpolated(zeta: Floats, stroke: Floats) -> Floats:
    """Ratios at velocity ratios up to 1."""
    (low, high), rigid = _LOG_STROKE, 2 / np.pi * np.arcsin(zeta)
    inside = np.clip(stroke, np.exp(low), np.exp(high))
    row = (np.log(inside) - low) * ((_ROWS - 1) / (high - low))
    share = np.clip(spline_values(_table(), row, np.sqrt(zeta) * (_COLUMNS - 1)), 0.0, 1.0)
    share = 1 - (1 - share) * np.minimum(stroke / inside, 1.0)  # proportional to small amplitudes
    return np.asarray(np.where(zeta < 1, rigid + (1 - rigid) * share, 1.0))


@cache
def _table() -> Floats:
    """Coefficients of the spline of (R - R_rigid)/(1 - R_rigid) over ln a/s and the root of the velocity ratio."""
    stroke = np.exp(np.linspace(*_LOG_STROKE, _ROWS))[:, None, None]
    zeta = np.minimum(np.linspace(0, 1, _COLUMNS) ** 2, _LAST)[:, None]
    turn = np.arccos(-zeta)  # phase at which the contact turns back; the other is its mirror image
    root = (1 + _PHASES[0]) / 2
    graded, weight = root**2 * (3 - 2 * root), 3 * root * (1 - root) * _PHASES[1]
    back, forward = 2 * (np.pi - turn), 2 * turn
    x_1, x_2 = _position(zeta, turn), _position(zeta, 2 * np.pi - turn)
    fall = x_1 - _position(zeta, turn + back * graded)
    rise = _position(zeta, 2 * np.pi - turn + forward * graded) - x_2
    loop = np.exp(-stroke * (x_1 - x_2) / 2)
    backward = np.sum((2 * np.exp(-stroke * fall / 2) - 2) * weight, axis=-1) * back[:, 0]
    again = np.sum(np.minimum(2 * loop - 2 * np.exp(-stroke * rise / 2), 0.0) * weight, axis=-1) * forward[:, 0]
    ratio = 1 + (backward + again) / (2 * np.pi)
    rigid = 2 / np.pi * np.arcsin(zeta[:, 0])
    return spline_coefficients((ratio - rigid) / (1 - rigid))


def _position(zeta: Floats, phase: Floats) -> Floats:
    """Position of the contact in amplitudes."""
    return np.asarray(zeta * phase + np.sin(phase))
