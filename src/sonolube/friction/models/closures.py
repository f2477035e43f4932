"""Closures: what a known motion of the gap makes of friction, one assumption each, chosen by name."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numba
import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.contact.cube import tangential_stiffness
from sonolube.contact.half_period_mean import separating_mean
from sonolube.contact.motion import GapMotion, converged_mean, load_balanced_motion, open_separation
from sonolube.contact.rough import RoughContact, separation
from sonolube.friction.models.asperity_stick_slip import stick_slip
from sonolube.friction.models.bristle_with_holder import coupled


def as_published(contact: RoughContact, motion: GapMotion, *, sliding_speed: ArrayLike) -> Floats:
    """Return friction with vibration over friction without: the cube's stiffness times the direction of the motion. []

    Parameters
    ----------
    contact : RoughContact
    motion : GapMotion
    sliding_speed : array_like, any shape
        Mean speed of the sliding. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If a speed is not positive.
    OutsideRange
        If the motion closes the gap or leaves the height law's range.

    Notes
    -----
    The mean over a period of k_t(t)/k_t0 cos(theta): the deformation stays that of rest, and of the friction counts
    the share along the sliding, cos(theta) = v_r/sqrt(v_r^2 + v_1^2), v_1 the velocity along the normal. The stiffness
    of the cube goes with the square of the area, so that about an unmoved mean vibration raises friction.

    References
    ----------
    .. [1] D 3.46 to 3.48, with the resultant where 3.46 prints v_1, which passes through zero twice a period.
    """
    d = open_separation(contact, motion)
    at_rest = tangential_stiffness(contact, separation=d)
    return _directed_mean(
        lambda x: tangential_stiffness(contact, separation=d + x) / at_rest,
        motion,
        sliding_speed,
        amplitude_fraction=1.0,
    )


def separating_half_period(contact: RoughContact, motion: GapMotion, *, sliding_speed: ArrayLike) -> Floats:
    """Return friction with vibration over friction without: the cube's stiffness while the gap stands wider. []

    Parameters
    ----------
    contact : RoughContact
    motion : GapMotion
    sliding_speed : array_like, any shape
        Mean speed of the sliding, which does not matter in this model. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If a speed is not positive.
    OutsideRange
        If the motion leaves the height law's range.

    Notes
    -----
    Through the rest of the period the surfaces are taken to stick. `separating_half_period_ratio` gives the same for a
    sine about an unmoved mean.

    References
    ----------
    .. [1] D 3.15 with u = 0.
    """
    v_r = require_positive(sliding_speed=sliding_speed)
    d = separation(contact, normal_load=motion.normal_load)
    at_rest = tangential_stiffness(contact, separation=d)
    ratio = converged_mean(
        lambda sampled: separating_mean(
            lambda x: tangential_stiffness(contact, separation=d + x) / at_rest, displacement=sampled.displacement
        ),
        motion,
    )
    return np.broadcast_to(ratio, v_r.shape).copy()


def load_balanced(contact: RoughContact, motion: GapMotion, *, sliding_speed: ArrayLike) -> Floats:
    """Return friction with vibration over friction without: as published, about the gap that balances the load. []

    Parameters
    ----------
    contact : RoughContact
    motion : GapMotion
        Its own mean does not matter.
    sliding_speed : array_like, any shape
        Mean speed of the sliding. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If a speed is not positive.
    OutsideRange
        If the motion closes the gap or leaves the height law's range.

    Notes
    -----
    The mean of the cube's stiffness, which goes with the square of the area, still lies above that at rest.
    """
    return as_published(contact, load_balanced_motion(contact, motion), sliding_speed=sliding_speed)


def kinematic(
    contact: RoughContact, motion: GapMotion, *, sliding_speed: ArrayLike, amplitude_fraction: ArrayLike = 1.0
) -> Floats:
    """Return friction with vibration over friction without: the direction of the motion alone. []

    Parameters
    ----------
    contact : RoughContact
        Does not matter in this model.
    motion : GapMotion
    sliding_speed : array_like, any shape
        Mean speed of the sliding. [m/s]
    amplitude_fraction : float
        Share of the motion that acts; of any other value than 1 only a fit can tell. []

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If a speed or the share is not positive.

    Notes
    -----
    The mean over a period of cos(theta) as in `as_published`: a constant friction along the resultant velocity.

    References
    ----------
    .. [1] D 3.46, with the resultant where v_1 is printed.
    """
    share = float(require_positive(amplitude_fraction=amplitude_fraction))
    return _directed_mean(np.ones_like, motion, sliding_speed, amplitude_fraction=share)


FRICTION_MODELS: Mapping[str, Callable[..., Floats]] = MappingProxyType(
    {
        "as_published": as_published,
        "separating_half_period": separating_half_period,
        "load_balanced": load_balanced,
        "kinematic": kinematic,
        "stick_slip": stick_slip,
        "coupled": coupled,
    }
)
"""The closures by name; each takes a contact, a motion and a `sliding_speed`, and what else its docstring names."""


def _directed_mean(
    weight: Callable[[Floats], Floats], motion: GapMotion, sliding_speed: ArrayLike, *, amplitude_fraction: float
) -> Floats:
    v_r = require_positive(sliding_speed=sliding_speed)
    return converged_mean(
        lambda sampled: _weighted_cosine(
            weight(sampled.displacement), amplitude_fraction * sampled.velocity, v_r.ravel()
        ),
        motion,
    ).reshape(v_r.shape)


@numba.njit(cache=True)
def _weighted_cosine(weights: Floats, velocity: Floats, speeds: Floats) -> Floats:
    """Return the mean of weight times v_r/sqrt(v_r^2 + v^2), both linear between samples: exact however small v_r."""
    n = weights.size
    means = np.empty(speeds.size)
    for i in range(speeds.size):
        total = 0.0
        q = velocity[n - 1] / speeds[i]
        angle, length = np.arcsinh(q), np.sqrt(1 + q * q)
        for k in range(n):
            p, angle_before, length_before = q, angle, length
            q = velocity[k] / speeds[i]
            angle, length = np.arcsinh(q), np.sqrt(1 + q * q)
            w, rise, slope = weights[k - 1], weights[k] - weights[k - 1], q - p
            if abs(slope) > 1e-3:
                cosine = (angle - angle_before) / slope
                total += w * cosine + rise * ((length - length_before) / slope - p * cosine) / slope
            else:
                total += (w + rise / 2) / np.sqrt(1 + (p + q) ** 2 / 4)
        means[i] = total / n
    return means
