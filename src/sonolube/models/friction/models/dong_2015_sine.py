"""Friction ratio of the cube model of Dong (2015) under a sine about the separation at rest, and its deformation."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import OutsideRange, warn_of_range
from sonolube.models.contact.cube import cube_tangential_stiffness
from sonolube.models.contact.rough import RoughContact, separation
from sonolube.models.contact.separating_half_period import (
    separating_half_period_mean,
    separating_half_period_quadrature,
)


def dong_2015_half_period_ratio(
    contact: RoughContact, *, normal_load: ArrayLike, vibration_amplitude: ArrayLike
) -> Floats:
    r"""Friction ratio under sinusoidal normal vibration by the cube over the separating half period. []

    Parameters
    ----------
    contact : RoughContact
    normal_load : array_like
        Force pressing the bodies together. [N]
    vibration_amplitude : array_like, broadcast against `normal_load`
        Amplitude of the vibration along the surface normal. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        1 without vibration, less with it.

    Raises
    ------
    InvalidInput
        If a load is not positive, or an amplitude negative.
    OutsideRange
        If no separation in the range of the height distribution carries a load, or no asperity is in contact.

    Notes
    -----
    .. math::

        \frac{F_1}{F_0} = \frac1\pi \int_0^\pi \frac{k_t(d + a \sin\theta)}{k_t(d)}\, \mathrm{d}\theta \tag{D 3.15}

    The average of the tangential stiffness over the half period in which the displacement is positive, over that at
    rest; the tangential deformation is constant and cancels. In the other half period the surfaces are assumed to
    stick. Speed and frequency have no effect in this model, and the load little.

    See Also
    --------
    Dong2015HalfPeriod : The same for any motion of the gap.

    References
    ----------
    .. [1] D 3.15 with u = 0.
    """
    d = separation(contact, normal_load=normal_load)
    at_rest = cube_tangential_stiffness(contact, separation=d)
    if np.any(at_rest == 0.0):
        raise OutsideRange(f"normal_load of {np.min(normal_load):.3g} N is too small: no asperity is in contact")
    mean = separating_half_period_mean(
        lambda gap: cube_tangential_stiffness(contact, separation=gap),
        separation=d,
        vibration_amplitude=vibration_amplitude,
    )
    return mean / at_rest


def dong_2015_deformation_ratio(
    contact: RoughContact,
    *,
    normal_load: ArrayLike,
    normal_amplitude: ArrayLike,
    in_plane_amplitude: ArrayLike,
    deformation: ArrayLike,
    phase: ArrayLike = np.pi / 2,
) -> Floats:
    r"""Friction ratio by the cube with the in-plane motion added to the deformation, as D prints it. []

    Parameters
    ----------
    contact : RoughContact
    normal_load : array_like
        Force pressing the bodies together. [N]
    normal_amplitude : array_like
        Amplitude of the vibration along the surface normal. [m]
    in_plane_amplitude : array_like
        Amplitude of the vibration along the sliding direction. [m]
    deformation : array_like
        Tangential deformation of the contact in steady sliding, by D 3.11 the friction force over the stiffness. [m]
    phase : array_like
        Lag of the normal motion behind the in-plane one; pi/2 as D prints it. [rad]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a load or deformation is not positive, an amplitude negative, or a value not finite.
    OutsideRange
        If no separation in the range of the height distribution carries a load.

    Warns
    -----
    ModelRangeWarning
        If an in-plane amplitude exceeds the deformation, beyond which the contact slides.

    Notes
    -----
    .. math:: \frac{F_1}{F_0} = \frac2T \int_{T/2} \frac{k_t(d + v)}{k_t(d)}\, \frac{\delta + u}{\delta}\, \mathrm{d}t

    With the printed phase the contributions of the in-plane motion u in the two quarters of the half period cancel.
    In-plane vibration that enters the relative velocity has an effect: `dahl_under_vibration`.

    References
    ----------
    .. [1] D 3.12 and 3.15.
    """
    delta = require_positive(deformation=deformation)
    u_peak = require_non_negative(in_plane_amplitude=in_plane_amplitude)
    lag = require_finite(phase=phase)
    if np.any(u_peak > delta):
        warn_of_range(
            f"in_plane_amplitude of up to {np.max(u_peak):.3g} m is added to a deformation of {np.min(delta):.3g} m,"
            " beyond which the contact slides; use dahl_under_vibration"
        )
    d, v_peak = np.broadcast_arrays(
        require_positive(separation=separation(contact, normal_load=normal_load)),
        require_non_negative(normal_amplitude=normal_amplitude),
    )
    sines, weights = separating_half_period_quadrature()
    d, v_peak, strain = (array[..., np.newaxis] for array in (d, v_peak, u_peak * np.cos(lag) / delta))
    at_rest = cube_tangential_stiffness(contact, separation=d)
    k_ratio = cube_tangential_stiffness(contact, separation=d + v_peak * sines) / at_rest
    # of u/delta = (u_peak/delta) sin(theta + phase) the part with cos(theta) is odd about the peak and averages out
    return k_ratio * (1 + strain * sines) @ weights  # D 3.15
