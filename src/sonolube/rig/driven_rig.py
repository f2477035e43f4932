"""Driven rig: a rig whose stack, structure and drive voltage are known, so that its motion can be computed."""

from dataclasses import dataclass, fields
from typing import final

from sonolube.errors import InvalidInput
from sonolube.models.actuator import PiezoStack
from sonolube.models.actuator.drive import Drive
from sonolube.models.dynamics import Structure
from sonolube.rig.record import Rig


@final
@dataclass(frozen=True, kw_only=True, slots=True, repr=False)
class DrivenRig(Rig):
    """A rig with everything that a computed motion needs.

    Parameters
    ----------
    stack : PiezoStack
        Piezoelectric stack.
    structure : Structure
        Masses, springs and dampers, or modes, with the stack in them.
    drive : Drive
        Drive of the stack, with its voltage.

    Raises
    ------
    InvalidInput
        If one of them, or the voltage of the drive, is missing.

    Notes
    -----
    `read_rig` returns one for a file with the tables `stack` and `structure`; `driven_rig` turns a `Rig` into one.
    """

    stack: PiezoStack
    structure: Structure
    drive: Drive

    def __post_init__(self) -> None:
        Rig.__post_init__(self)
        if self.stack is None or self.structure is None:
            raise InvalidInput(
                f"{self.title}: the tables stack and structure are missing, of which its motion is computed;"
                " `sonolube example tribometer` writes a rig that has both; or sweep over"
                " vibration.vibration_amplitude, which needs none"
            )
        require_drive(self)

    @property
    def voltage_peak_to_peak(self) -> float:
        """Difference of the highest and the lowest drive voltage. [V]"""
        assert self.drive.voltage_peak_to_peak is not None  # checked at construction
        return self.drive.voltage_peak_to_peak


def require_drive(rig: Rig) -> Drive:
    """Drive of a rig whose drive voltage is known."""
    if rig.drive is None or rig.drive.voltage_peak_to_peak is None:
        raise InvalidInput(
            f"{rig.title}: drive.voltage_peak_to_peak is missing; give the voltage under which its amplitude holds, or"
            " sweep over vibration.vibration_amplitude"
        )
    return rig.drive


def driven_rig(rig: Rig) -> DrivenRig:
    """Rig as one whose motion can be computed; the rig itself where it is one already."""
    if isinstance(rig, DrivenRig):
        return rig
    return DrivenRig(**{field.name: getattr(rig, field.name) for field in fields(rig) if field.init})
