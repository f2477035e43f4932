"""Friction of the cube model: a contact stiffness that falls while vibration holds the surfaces apart."""

import warnings

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.contact.cube import tangential_stiffness
from sonolube.contact.half_period_mean import separating_half_period_mean, separating_half_period_rule
from sonolube.contact.rough import RoughContact, separation
from sonolube.errors import ModelRangeWarning, OutsideRange


def dong_2015_half_period_ratio(
    contact: RoughContact, *, normal_load: ArrayLike, vibration_amplitude: ArrayLike
) -> Floats:
    """Return friction with normal vibration over friction without. []

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
        From 1 at no vibration downward.

    Raises
    ------
    InvalidInput
        If a load is not positive, or an amplitude negative.
    OutsideRange
        If no separation of the height law's range carries a load, or no asperity.

    Notes
    -----
    The tangential stiffness averaged over the half period in which the displacement is positive, over that at rest; the
    deformation of the contact stays and cancels. Through the other half the surfaces are taken to stick. Neither speed
    nor frequency matters in this model, and the load hardly.

    References
    ----------
    .. [1] D 3.15 with u = 0.
    """
    d = separation(contact, normal_load=normal_load)
    at_rest = tangential_stiffness(contact, separation=d)
    if np.any(at_rest == 0.0):
        raise OutsideRange(f"normal_load of {np.min(normal_load):.3g} N is too small: no asperity carries it")
    mean = separating_half_period_mean(
        lambda gap: tangential_stiffness(contact, separation=gap),
        separation=d,
        vibration_amplitude=vibration_amplitude,
    )
    return mean / at_rest


def steady_deformation(contact: RoughContact, *, normal_load: ArrayLike, friction_force: ArrayLike) -> Floats:
    """Return the deformation at which the contact carries a friction force. [m]

    Parameters
    ----------
    contact : RoughContact
    normal_load : array_like
        Force pressing the bodies together. [N]
    friction_force : array_like, broadcast against `normal_load`
        Friction force of steady sliding. [N]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        About half a nanometre for D's contacts at 40 N.

    Raises
    ------
    InvalidInput
        If a load is not positive, or a force not finite.

    References
    ----------
    .. [1] D 3.10 at rest, and 3.11.
    """
    d = separation(contact, normal_load=normal_load)
    return require_finite(friction_force=friction_force) / tangential_stiffness(contact, separation=d)  # D 3.11


def dong_2015_deformation_ratio(
    contact: RoughContact,
    *,
    normal_load: ArrayLike,
    normal_amplitude: ArrayLike,
    in_plane_amplitude: ArrayLike,
    deformation: ArrayLike,
    phase: ArrayLike = np.pi / 2,
) -> Floats:
    """Return friction with vibration over friction without, in-plane motion added to the deformation as printed. []

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
        Deformation of the contact in steady sliding, `steady_deformation`. [m]
    phase : array_like
        Lag of the normal motion behind the in-plane one; a quarter turn as D prints it. [rad]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a load or deformation is not positive, an amplitude negative, or a value not finite.
    OutsideRange
        If no separation of the height law's range carries a load.

    Warns
    -----
    ModelRangeWarning
        If an in-plane amplitude exceeds the deformation it is added to: a contact so deformed would slide.

    Notes
    -----
    With the printed phase the in-plane motion is forward in one quarter and backward in the next, and leaves the mean
    as it is. To let in-plane vibration act, take it into the relative velocity: `dahl_under_vibration`.

    References
    ----------
    .. [1] D 3.12 and 3.15.
    """
    delta = require_positive(deformation=deformation)
    u_peak = require_non_negative(in_plane_amplitude=in_plane_amplitude)
    lag = require_finite(phase=phase)
    if np.any(u_peak > delta):
        warnings.warn(
            f"in_plane_amplitude of up to {np.max(u_peak):.3g} m is added to a deformation of {np.min(delta):.3g} m,"
            " more than the contact can carry without sliding; dahl_under_vibration lets it slide",
            ModelRangeWarning,
            stacklevel=2,
        )
    d, v_peak = np.broadcast_arrays(
        require_positive(separation=separation(contact, normal_load=normal_load)),
        require_non_negative(normal_amplitude=normal_amplitude),
    )
    sines, weights = separating_half_period_rule()
    d, v_peak, strain = (array[..., np.newaxis] for array in (d, v_peak, u_peak * np.cos(lag) / delta))
    k_ratio = tangential_stiffness(contact, separation=d + v_peak * sines) / tangential_stiffness(contact, separation=d)
    # of u/delta = (u_peak/delta) sin(theta + phase) the part with cos(theta) is odd about the peak and averages out
    return k_ratio * (1 + strain * sines) @ weights  # D 3.15
