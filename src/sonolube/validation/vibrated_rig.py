"""A rig at its operating point as the compared models see it."""

from dataclasses import dataclass
from math import pi

from sonolube.contact import RoughContact


@dataclass(frozen=True, kw_only=True, slots=True)
class VibratedRig:
    """A rig's operating point as the models see it; what is not known of it is None.

    Parameters
    ----------
    label : str
        What it is called in tables.
    contact : RoughContact
    normal_load : float
        Force pressing the bodies together. [N]
    friction_coefficient : float
        Coefficient of friction without vibration. []
    sliding_speed : float
        Sliding speed while the surfaces vibrate. [m/s]
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
        """No set of tests: what only one rig of the tests tells does not matter to it."""
        return "-"

    @property
    def vibration_velocity(self) -> float | None:
        """Peak velocity of the vibration along the sliding. [m/s]"""
        if self.in_plane_amplitude is None or self.frequency is None:
            return None
        return 2 * pi * self.frequency * self.in_plane_amplitude

    @property
    def vibration_direction(self) -> float | None:
        """Angle between vibration within the plane and sliding. [rad]"""
        return None if self.in_plane_amplitude is None else 0.0
