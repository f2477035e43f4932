"""What a rig's closure makes of a motion, with what its file says of memory, holder and in-plane motion."""

from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.contact import GapMotion, harmonic_motion, load_balanced_motion
from sonolube.errors import InvalidInput, UnknownName
from sonolube.friction import FRICTION_MODELS, Holder, coupled, stick_slip
from sonolube.friction.models.asperity_stick_slip import EMPIRICAL_MEMORY_LENGTH
from sonolube.rig.record import Rig
from sonolube.wear.cube import WEAR_MODELS

_ABOUT_REST = ("as_published", "separating_half_period")
_WEAR_BY_DEFAULT = "separating_half_period"  # the mean by which D computed its wear tables


def friction_ratio(rig: Rig, motion: GapMotion) -> float:
    """Return friction with vibration over friction without, by the rig's closure at its sliding speed. []

    Raises
    ------
    InvalidInput
        If the closure does not hold for the motion.
    UnknownName
        If there is no such closure.
    """
    return float(friction_ratios(rig, motion, sliding_speed=rig.sliding_speed))


def friction_ratios(rig: Rig, motion: GapMotion, *, sliding_speed: ArrayLike) -> Floats:
    """Return friction with vibration over friction without, by the rig's closure. []

    Parameters
    ----------
    rig : Rig
    motion : GapMotion
        The vibration of its contact.
    sliding_speed : array_like, any shape
        Macroscopic relative speed. [m/s]

    Returns
    -------
    ndarray, shape of `sliding_speed`

    Raises
    ------
    InvalidInput
        If a speed is not positive, or the closure does not hold for the motion.
    UnknownName
        If there is no such closure.
    """
    if rig.closure not in FRICTION_MODELS:
        raise UnknownName.among(FRICTION_MODELS, kind="closure", name=rig.closure)
    closure = FRICTION_MODELS[rig.closure]
    in_plane = {"in_plane_fraction": rig.in_plane_fraction or 0.0, "phase": rig.in_plane_phase or 0.0}
    if closure is stick_slip:
        closure = partial(closure, memory_length=rig.memory_length or EMPIRICAL_MEMORY_LENGTH, **in_plane)
    elif closure is coupled:
        holder = Holder() if rig.holder_stiffness is None else Holder(holder_stiffness=rig.holder_stiffness)
        closure = partial(closure, friction_coefficient=rig.friction_coefficient, holder=holder, **in_plane)
    return np.asarray(closure(rig.contact, motion, sliding_speed=sliding_speed))


def sine_under_load(rig: Rig) -> GapMotion:
    """Return the rig's vibration as a sine, about the gap that its closure is meant for.

    Notes
    -----
    Closures as published take the gap at rest for the mean; for the others the mean rises until it carries the load.
    """
    if rig.drive is None:
        raise InvalidInput(f"{rig.title}: drive.frequency is missing; closure {rig.closure} needs it")
    motion = harmonic_motion(
        rig.contact,
        normal_load=rig.normal_load,
        vibration_amplitude=rig.vibration_amplitude,
        frequency=rig.drive.frequency,
    )
    return motion if rig.closure in _ABOUT_REST else load_balanced_motion(rig.contact, motion)


def wear_closure(rig: Rig) -> str:
    """Return the name of the closure for wear: that of friction, or where wear has none of it that of D's tables."""
    return rig.closure if rig.closure in WEAR_MODELS else _WEAR_BY_DEFAULT


def wear_rate_ratio(rig: Rig, motion: GapMotion) -> float:
    """Return wear with vibration over wear without, by the closure that matches friction's. []

    Notes
    -----
    Wear closures average the worn area over the gap and know no memory, holder or in-plane motion.
    """
    return float(WEAR_MODELS[wear_closure(rig)](rig.contact, motion))
