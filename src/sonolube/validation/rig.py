"""A rig's operating point as the compared models see it."""

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
    fraction = rig.in_plane_fraction
    return VibratedRig(
        label=rig.title,
        contact=rig.contact,
        normal_load=rig.normal_load,
        friction_coefficient=rig.friction_coefficient,
        sliding_speed=rig.sliding_speed,
        vibration_amplitude=rig.vibration_amplitude,
        frequency=None if rig.drive is None else rig.drive.frequency,
        in_plane_amplitude=None if fraction is None else fraction * rig.vibration_amplitude,
        holder_stiffness=rig.holder_stiffness,
    )
