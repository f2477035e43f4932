"""Rig: two bodies in sliding contact, and the actuator that vibrates one of them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from sonolube.actuator import PiezoStack
from sonolube.actuator.drive import Drive
from sonolube.checks import require_non_negative, require_positive
from sonolube.contact import RoughContact
from sonolube.dynamics import Structure
from sonolube.errors import InvalidInput
from sonolube.friction.models import FRICTION_MODELS, FrictionModel
from sonolube.rig.distribution import Distribution


@dataclass(frozen=True, kw_only=True, slots=True)
class Rig:
    """One experiment or device: contact, load, sliding, friction and, where known, its drive and structure.

    Parameters
    ----------
    title : str
        What it is.
    source : str
        Where its numbers come from.
    contact : RoughContact
        The two rough surfaces.
    normal_load : float
        Force pressing the bodies together. [N]
    friction_coefficient : float
        Intrinsic coefficient of friction, measured without vibration. []
    sliding_speed : float
        Macroscopic relative speed. [m/s]
    vibration_amplitude : float
        Vibration normal to the contact, zero to peak. [m]
    drive : Drive or None
        Electrical drive of the actuator, where it is known.
    capacitance : float or None
        Capacitance of the actuator, where it is known. [F]
    stack : PiezoStack or None
        Piezoelectric stack, where the structure is known.
    structure : Structure or None
        What the stack drives, where it is known.
    friction_model : FrictionModel
        Model of friction under vibration, with its parameters.
    assumptions : mapping of str to str
        Which entries no source gives, and what was assumed instead and why.
    uncertainty : mapping of str to Distribution
        How uncertain entries are spread, by dotted key of the file.
    """

    title: str
    source: str
    contact: RoughContact
    normal_load: float
    friction_coefficient: float
    sliding_speed: float
    vibration_amplitude: float
    drive: Drive | None = None
    capacitance: float | None = None
    stack: PiezoStack | None = None
    structure: Structure | None = None
    friction_model: FrictionModel = field(default_factory=lambda: FRICTION_MODELS["asperity_stick_slip"]())
    assumptions: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    uncertainty: Mapping[str, Distribution] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        require_positive(normal_load=self.normal_load, friction_coefficient=self.friction_coefficient)
        require_non_negative(sliding_speed=self.sliding_speed, vibration_amplitude=self.vibration_amplitude)
        if self.capacitance is not None:
            require_positive(capacitance=self.capacitance)
        if not self.title.strip():
            raise InvalidInput("title must not be empty")
