"""Operating point of a rig as the conditions of model variants, its vibration approximated by a sine."""

from dataclasses import dataclass
from math import inf, isfinite, pi

from sonolube.errors import InvalidInput
from sonolube.models.contact import RoughContact
from sonolube.rig import Rig, steady_vibration

_FIELDS_OF_RIG = ("contact", "normal_load", "friction_coefficient", "sliding_speed")


@dataclass(frozen=True, kw_only=True, slots=True)
class VibratedRig:
    """Conditions of a rig at its operating point; unknown ones are None.

    Parameters
    ----------
    label : str
        Name in tables.
    contact : RoughContact
    normal_load : float
        Force pressing the bodies together. [N]
    friction_coefficient : float
        Coefficient of friction without vibration. []
    sliding_speed : float
        Sliding speed during vibration. [m/s]
    vibration_amplitude : float
        Amplitude along the surface normal. [m]
    frequency : float or None
        Frequency of the vibration. [Hz]
    in_plane_amplitude : float or None
        Amplitude along the sliding direction. [m]
    holder_stiffness : float or None
        Stiffness of the holder along the sliding direction. [N/m]
    holder_mass : float or None
        Mass that moves with the holder. [kg]
    """

    label: str
    contact: RoughContact
    normal_load: float
    friction_coefficient: float
    sliding_speed: float
    vibration_amplitude: float
    frequency: float | None = None
    in_plane_amplitude: float | None = None
    holder_stiffness: float | None = None
    holder_mass: float | None = None

    @property
    def set_name(self) -> str:
        """Letter of no set, to which no rig-specific parameter applies."""
        return "-"

    @property
    def vibration_velocity(self) -> float | None:
        """Peak velocity of the vibration along the sliding. [m/s]"""
        if self.in_plane_amplitude is None or self.frequency is None:
            return None
        return 2 * pi * self.frequency * self.in_plane_amplitude

    @property
    def vibration_direction(self) -> float | None:
        """Angle between in-plane vibration and sliding. [rad]"""
        return None if self.in_plane_amplitude is None else 0.0


def vibrated_rig(rig: Rig) -> VibratedRig:
    """Conditions of a rig at its operating point."""
    amplitude = steady_vibration(rig).vibration_amplitude
    for name, value in (("vibration_amplitude", amplitude), ("sliding_speed", rig.sliding_speed)):
        if value == 0:
            raise InvalidInput(f"{rig.title}: {name} is 0; models of friction under vibration need it positive")
    model = rig.friction_model
    fraction, stiffness = getattr(model, "in_plane_fraction", 0.0), getattr(model, "holder_stiffness", inf)
    return VibratedRig(
        label=rig.title,
        **{name: getattr(rig, name) for name in _FIELDS_OF_RIG},
        vibration_amplitude=amplitude,
        frequency=None if rig.drive is None else rig.drive.frequency,
        in_plane_amplitude=fraction * amplitude if fraction else None,
        holder_stiffness=stiffness if isfinite(stiffness) else None,
    )
