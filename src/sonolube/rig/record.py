"""A rig: two bodies in contact, how they slide, and what vibrates one of them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from sonolube.actuator import PiezoStack
from sonolube.actuator.drive import Drive
from sonolube.checks import require_finite, require_non_negative, require_positive
from sonolube.contact import RoughContact
from sonolube.dynamics import Structure
from sonolube.errors import InvalidInput
from sonolube.rig.distribution import Distribution


@dataclass(frozen=True, kw_only=True, slots=True)
class Rig:
    """Everything the models need to know of one experiment or device.

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
    closure : str
        Name of the closure that turns a computed motion into friction.
    memory_length : float or None
        Sliding distance over which the closure stick_slip forgets, where it is not the empirical one. [m]
    in_plane_fraction : float or None
        Parasitic motion along the sliding direction over that along the normal, for stick_slip and coupled. []
    in_plane_phase : float or None
        Lag of that motion behind the normal one. [rad]
    holder_stiffness : float or None
        Stiffness of the holder along the sliding direction, for coupled; rigid where it is not given. [N/m]
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
    closure: str = "stick_slip"
    memory_length: float | None = None
    in_plane_fraction: float | None = None
    in_plane_phase: float | None = None
    holder_stiffness: float | None = None
    assumptions: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    uncertainty: Mapping[str, Distribution] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        require_positive(normal_load=self.normal_load, friction_coefficient=self.friction_coefficient)
        require_non_negative(sliding_speed=self.sliding_speed, vibration_amplitude=self.vibration_amplitude)
        if self.capacitance is not None:
            require_positive(capacitance=self.capacitance)
        if not self.title.strip():
            raise InvalidInput("title must not be empty")
        _require_taken(self)


_TAKEN_BY = MappingProxyType(
    {
        "memory_length": ("stick_slip",),
        "in_plane_fraction": ("stick_slip", "coupled"),
        "in_plane_phase": ("stick_slip", "coupled"),
        "holder_stiffness": ("coupled",),
    }
)


def _require_taken(rig: Rig) -> None:
    """Refuse what the closure does not take, and values that none could."""
    given = {name: getattr(rig, name) for name in _TAKEN_BY if getattr(rig, name) is not None}
    for name, value in given.items():
        if rig.closure not in _TAKEN_BY[name]:
            raise InvalidInput(
                f"friction.{name}: closure {rig.closure} does not take it; {' and '.join(_TAKEN_BY[name])} do"
                + "es" * (len(_TAKEN_BY[name]) == 1)
            )
        check = {"in_plane_phase": require_finite, "in_plane_fraction": require_non_negative}.get(
            name, require_positive
        )
        check(**{name: value})
    if "in_plane_phase" in given and not given.get("in_plane_fraction"):
        raise InvalidInput("friction.in_plane_phase: needs friction.in_plane_fraction, the size of that motion")
