"""Friction and wear ratios of a rig under a motion of its gap, by the rig's own models."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.contact import GapMotion, load_balanced_motion, sinusoidal_motion
from sonolube.errors import InvalidInput, OutsideRange, SonolubeError
from sonolube.friction.models import MeanGap
from sonolube.friction.models.range_check import OUTSIDE_MODEL_RANGE, CheckedRatio, model_friction
from sonolube.rig.record import Rig
from sonolube.wear import DEFAULT_WEAR_MODEL, WEAR_MODELS

_ANY_FREQUENCY = 1.0  # Hz; of models that are not rate-dependent


def friction_ratios(rig: Rig, motion: GapMotion, *, sliding_speed: ArrayLike) -> CheckedRatio:
    """Return friction with vibration over friction without, by the rig's friction model at some sliding speeds. []

    Parameters
    ----------
    rig : Rig
    motion : GapMotion
        Motion of the gap of its contact.
    sliding_speed : array_like, any shape
        Macroscopic relative speed. [m/s]

    Returns
    -------
    CheckedRatio
        Of the shape of `sliding_speed`, NaN with a reason where a ratio is outside the range of the model.

    Raises
    ------
    InvalidInput
        If a speed is not positive.
    """
    return model_friction(
        rig.friction_model,
        rig.contact,
        motion,
        sliding_speed=sliding_speed,
        friction_coefficient=rig.friction_coefficient,
    )


def friction_at_speeds(rig: Rig, moving: GapMotion, speeds: Floats) -> CheckedRatio:
    """Return the friction ratio at each of some sliding speeds, and the reason where there is none.

    Parameters
    ----------
    rig : Rig
    moving : GapMotion
        Motion of the gap of its contact.
    speeds : ndarray, shape (n,)
        Macroscopic relative speeds, in m/s.

    Returns
    -------
    CheckedRatio
        NaN also at speeds that the model refuses, such as zero.
    """
    try:
        return friction_ratios(rig, moving, sliding_speed=speeds)
    except SonolubeError as refusal:
        if speeds.size == 1:
            none = np.full(1, np.nan)
            return CheckedRatio(friction_ratio=none, raw_friction_ratio=none, reason=np.array([str(refusal)]))
    every = [friction_at_speeds(rig, moving, speed) for speed in speeds[:, np.newaxis]]
    return CheckedRatio(
        friction_ratio=np.concatenate([one.friction_ratio for one in every]),
        raw_friction_ratio=np.concatenate([one.raw_friction_ratio for one in every]),
        reason=np.concatenate([one.reason for one in every]),
    )


def stated_friction_ratios(rig: Rig, *, sliding_speed: ArrayLike) -> CheckedRatio:
    """Return the friction ratios of a rig under its stated vibration, taken for a sine, at some sliding speeds. []

    Parameters
    ----------
    rig : Rig
    sliding_speed : array_like, any shape
        Macroscopic relative speed. [m/s]

    Returns
    -------
    CheckedRatio
        Of the shape of `sliding_speed`.

    Raises
    ------
    InvalidInput
        If a speed is not positive, or the model depends on the rate of the motion and the rig has no frequency.
    """
    try:
        motion = prescribed_sine(rig)
    except OutsideRange as refusal:
        none = np.full(np.shape(sliding_speed), np.nan)
        reason = np.full(none.shape, f"{OUTSIDE_MODEL_RANGE}: {refusal}")
        return CheckedRatio(friction_ratio=none, raw_friction_ratio=none, reason=reason)
    return friction_ratios(rig, motion, sliding_speed=sliding_speed)


def prescribed_sine(rig: Rig) -> GapMotion:
    """Return the rig's stated vibration as a sine of the gap, about the mean that its friction model is meant for.

    Parameters
    ----------
    rig : Rig

    Returns
    -------
    GapMotion

    Raises
    ------
    InvalidInput
        If the model depends on the rate of the motion and the rig has no frequency.
    OutsideRange
        If the amplitude leaves the range of the height law.
    """
    model = rig.friction_model
    if rig.drive is None and model.rate_dependent:
        raise InvalidInput(f"{rig.title}: drive.frequency is missing; friction model {model.name} needs it")
    motion = sinusoidal_motion(
        rig.contact,
        normal_load=rig.normal_load,
        vibration_amplitude=rig.vibration_amplitude,
        frequency=_ANY_FREQUENCY if rig.drive is None else rig.drive.frequency,
    )
    return motion if model.mean_gap is MeanGap.AT_REST else load_balanced_motion(rig.contact, motion)


def wear_model_of(rig: Rig) -> str:
    """Return the name of the wear model: that of the friction model's name where there is one, else the default."""
    name = rig.friction_model.name
    return name if name in WEAR_MODELS else DEFAULT_WEAR_MODEL


def wear_rate_ratio(rig: Rig, motion: GapMotion) -> float:
    """Return wear with vibration over wear without, by the wear model that goes with the rig's friction model. []

    Parameters
    ----------
    rig : Rig
    motion : GapMotion
        Motion of the gap of its contact.

    Returns
    -------
    float

    Notes
    -----
    Wear models average the worn area over the gap; memory, holder and in-plane motion do not enter.
    """
    return float(WEAR_MODELS[wear_model_of(rig)](rig.contact, motion))
