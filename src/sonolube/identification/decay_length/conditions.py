"""Conditions of a run that tells what sets the decay length, and the two lengths between which it decides."""

from dataclasses import asdict, dataclass
from typing import Final

from sonolube.checks import require_positive

SHORT_DECAY_LENGTH: Final = 0.7e-6
"""Decay length that the published sets B, G and H ask for. [m]"""

LONG_DECAY_LENGTH: Final = 2.0e-6
"""Decay length that the published sets A and C to F ask for. [m]"""


@dataclass(frozen=True, kw_only=True, slots=True)
class SwitchConditions:
    """Settings of the run, constant throughout.

    Parameters
    ----------
    normal_load : float
        Force pressing the bodies together. [N]
    vibration_amplitude : float
        Amplitude along the surface normal at the beginning. [m]
    frequency : float
        Frequency of the vibration. [Hz]
    sliding_speed : float
        Sliding speed. [m/s]
    large_drive_amplitude : float, optional
        Amplitude of the slow mode at the contact at large drive; that of the vibration where absent. [m]
    natural_frequency : float, optional
        Of the slow mode with the pin free; without it shifts are taken as small against it. [Hz]
    modal_mass : float, optional
        Of the slow mode at the contact; with the natural frequency it makes shifts contact stiffnesses. [kg]

    Raises
    ------
    InvalidInput
        If a value is not positive.
    """

    normal_load: float = 5.0
    vibration_amplitude: float = 2.3e-6
    frequency: float = 22e3
    sliding_speed: float = 65e-3
    large_drive_amplitude: float | None = None
    natural_frequency: float | None = None
    modal_mass: float | None = None

    def __post_init__(self) -> None:
        for name, value in asdict(self).items():
            if value is not None:
                require_positive(**{name: value})
