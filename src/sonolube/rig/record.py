"""Rig: two bodies in sliding contact, and the actuator that vibrates one of them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final, Literal, get_args

from sonolube.actuator import PiezoStack
from sonolube.actuator.drive import Drive
from sonolube.checks import require_non_negative, require_positive
from sonolube.contact import RoughContact
from sonolube.dynamics import Structure
from sonolube.errors import InvalidInput, UnknownName
from sonolube.friction.models import FRICTION_MODELS, FrictionModel
from sonolube.rig.distribution import Distribution

AmplitudeSource = Literal["measured", "computed", "waveguide", "per-volt"]
"""Where the amplitude of a vibration comes from."""

AMPLITUDE_SOURCES: Final[tuple[AmplitudeSource, ...]] = get_args(AmplitudeSource)
"""Sources of an amplitude, the one taken first where a rig has several first."""


@dataclass(frozen=True, kw_only=True, slots=True)
class MeasuredUnder:
    """Drive and load under which an amplitude was measured; None where they are the rig's own.

    Parameters
    ----------
    voltage_peak_to_peak : float or None
        Difference of the highest and the lowest voltage. [V]
    frequency : float or None
        Frequency of the drive. [Hz]
    normal_load : float or None
        Force pressing the bodies together. [N]
    """

    voltage_peak_to_peak: float | None = None
    frequency: float | None = None
    normal_load: float | None = None

    def __post_init__(self) -> None:
        for name in ("voltage_peak_to_peak", "frequency", "normal_load"):
            value = getattr(self, name)
            if value is not None:
                require_positive(**{name: value})


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
    vibration_amplitude : float or None
        Measured vibration normal to the contact, zero to peak. [m]
    measured_under : MeasuredUnder or None
        Drive and load of that measurement, where they are not the rig's own.
    amplitude_per_volt : float or None
        Amplitude per volt peak to peak, where it is known. [m/V]
    waveguide_amplitude : float or None
        Amplitude computed from the waveguide, where the rig has one, in m.
    amplitude_source : {"measured", "computed", "waveguide", "per-volt"} or None
        Source of the amplitude; the first of these that the rig has where None.
    calibration : float or None
        Factor by which the drive of the structure was scaled to the measured amplitude, where it was.
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
    vibration_amplitude: float | None = None
    measured_under: MeasuredUnder | None = None
    amplitude_per_volt: float | None = None
    waveguide_amplitude: float | None = None
    amplitude_source: AmplitudeSource | None = None
    calibration: float | None = None
    drive: Drive | None = None
    capacitance: float | None = None
    stack: PiezoStack | None = None
    structure: Structure | None = None
    friction_model: FrictionModel = field(default_factory=lambda: FRICTION_MODELS["asperity_stick_slip"]())
    assumptions: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    uncertainty: Mapping[str, Distribution] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        require_positive(normal_load=self.normal_load, friction_coefficient=self.friction_coefficient)
        require_non_negative(sliding_speed=self.sliding_speed)
        for name in ("vibration_amplitude", "amplitude_per_volt", "waveguide_amplitude"):
            value = getattr(self, name)
            if value is not None:
                require_non_negative(**{name: value})
        if self.amplitude_source is not None and self.amplitude_source not in AMPLITUDE_SOURCES:
            raise UnknownName.among(list(AMPLITUDE_SOURCES), kind="source of the amplitude", name=self.amplitude_source)
        if self.capacitance is not None:
            require_positive(capacitance=self.capacitance)
        if not self.title.strip():
            raise InvalidInput("title must not be empty")
