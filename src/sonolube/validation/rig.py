"""Operating point of a rig as an input of the compared models."""

from math import inf, isfinite

from sonolube.errors import InvalidInput
from sonolube.rig import Rig
from sonolube.validation.vibrated_rig import VibratedRig


def vibrated_rig(rig: Rig) -> VibratedRig:
    """Return what a rig's file says of its contact and vibration, taken for a sine.

    Raises
    ------
    InvalidInput
        If the rig does not vibrate or does not slide.
    """
    for name, value in (("vibration_amplitude", rig.vibration_amplitude), ("sliding_speed", rig.sliding_speed)):
        if value == 0:
            raise InvalidInput(f"{rig.title}: {name} is 0; models of friction under vibration need it positive")
    model = rig.friction_model
    fraction, stiffness = getattr(model, "in_plane_fraction", 0.0), getattr(model, "holder_stiffness", inf)
    return VibratedRig(
        label=rig.title,
        contact=rig.contact,
        normal_load=rig.normal_load,
        friction_coefficient=rig.friction_coefficient,
        sliding_speed=rig.sliding_speed,
        vibration_amplitude=rig.vibration_amplitude,
        frequency=None if rig.drive is None else rig.drive.frequency,
        in_plane_amplitude=fraction * rig.vibration_amplitude if fraction else None,
        holder_stiffness=stiffness if isfinite(stiffness) else None,
    )
