"""Pin, vibration and their entries of a rig file."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import pi
from typing import Final

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput
from sonolube.models.actuator import CatalogueActuator
from sonolube.models.contact import SphereOnFlat, hertz_contact_radius
from sonolube.rig.record import STATED
from sonolube.text.units import format_si

_STATED_AMPLITUDE: Final = 0.15
_DATA_SHEET_STROKE: Final = 0.3
_LARGEST_AMPLITUDE: Final = 1e-3


def toml_text(value: float, unit: str) -> str:
    """Quantity as a TOML value."""
    return json.dumps(format_si(value, unit, digits=4))


@dataclass(frozen=True, kw_only=True, slots=True)
class FlatPin:
    """Pin with a flat end.

    Parameters
    ----------
    diameter : float
        Of the flat, in m.
    """

    diameter: float

    def __post_init__(self) -> None:
        require_positive(diameter=self.diameter)

    @property
    def text(self) -> str:
        """The shape in words."""
        return f"flat of {format_si(self.diameter, 'm')} in diameter"

    def nominal_area(self, *, effective_modulus: float, normal_load: float) -> float:
        """Area of the flat. [m2]"""
        return pi * self.diameter**2 / 4


@dataclass(frozen=True, kw_only=True, slots=True)
class RoundPin:
    """Ball, or pin with a crowned end.

    Parameters
    ----------
    tip_radius : float
        Radius of the ball or crown. [m]
    """

    tip_radius: float

    def __post_init__(self) -> None:
        require_positive(tip_radius=self.tip_radius)

    @property
    def text(self) -> str:
        """The shape in words."""
        radius, diameter = format_si(self.tip_radius, "m"), format_si(2 * self.tip_radius, "m")
        return f"ball of {diameter} in diameter, tip radius {radius}: Hertzian circle before wear, which enlarges it"

    def nominal_area(self, *, effective_modulus: float, normal_load: float) -> float:
        """Area of the Hertzian circle. [m2]"""
        sphere = SphereOnFlat(tip_radius=self.tip_radius, effective_modulus=effective_modulus)
        return pi * float(hertz_contact_radius(sphere, normal_load=normal_load)) ** 2


PinShape = FlatPin | RoundPin
"""Shape of the end of a pin."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Entries:
    """Part of a rig file.

    Parameters
    ----------
    tables : mapping of str to mapping
        Values of keys as TOML, by table.
    assumptions, uncertainty : mapping of str to str
        By dotted key.
    """

    tables: Mapping[str, Mapping[str, str]]
    assumptions: Mapping[str, str] = field(default_factory=dict)
    uncertainty: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True, slots=True)
class StatedAmplitude:
    """Vibration of a stated amplitude.

    Parameters
    ----------
    vibration_amplitude : float
        Zero to peak. [m]
    """

    vibration_amplitude: float

    def __post_init__(self) -> None:
        if float(require_positive(vibration_amplitude=self.vibration_amplitude)) > _LARGEST_AMPLITUDE:
            given = format_si(self.vibration_amplitude, "m")
            raise InvalidInput(f"vibration_amplitude {given} is beyond any ultrasonic vibration: expected up to 1 mm")

    def entries(self, frequency: float) -> Entries:
        """Tables drive and vibration."""
        key = "vibration.vibration_amplitude"
        return Entries(
            tables={
                "drive": {"frequency": toml_text(frequency, "Hz")},
                "vibration": {"vibration_amplitude": toml_text(self.vibration_amplitude, "m")},
            },
            assumptions={key: f"{STATED}, taken as not measured under this load: 15 %"},
            uncertainty={key: f"lognormal {100 * _STATED_AMPLITUDE:g} %"},
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class DrivenActuator:
    """Actuator of the catalogue at a voltage, below its resonance.

    Parameters
    ----------
    actuator : CatalogueActuator
    voltage_peak_to_peak : float
        Difference of the highest and the lowest voltage. [V]
    """

    actuator: CatalogueActuator
    voltage_peak_to_peak: float

    def __post_init__(self) -> None:
        voltage = float(require_positive(voltage_peak_to_peak=self.voltage_peak_to_peak))
        low, high = self.actuator.lowest_voltage, self.actuator.highest_voltage
        if low is not None and high is not None and voltage > high - low:
            span = format_si(high - low, "V")
            raise InvalidInput(f"voltage_peak_to_peak {voltage:g} V exceeds {span}, the range of {self.actuator.name}")

    def entries(self, frequency: float) -> Entries:
        """Tables drive and actuator."""
        shown = self.actuator
        if frequency >= shown.resonance_frequency:
            resonance = format_si(shown.resonance_frequency, "Hz")
            raise InvalidInput(
                f"frequency must lie below {resonance}, the resonance of {shown.name}; else give its amplitude"
            )
        key = "actuator.amplitude_per_volt"
        per_volt = shown.stroke / shown.stroke_voltage / 2  # stroke is from end to end
        return Entries(
            tables={
                "drive": {
                    "voltage_peak_to_peak": toml_text(self.voltage_peak_to_peak, "V"),
                    "frequency": toml_text(frequency, "Hz"),
                },
                "actuator": {
                    "capacitance": toml_text(shown.free_capacitance, "F"),
                    "amplitude_per_volt": toml_text(per_volt, "m/V"),
                },
            },
            assumptions={key: f"half the free stroke per volt of {shown.title}; load and resonance are left out: 30 %"},
            uncertainty={key: f"lognormal {100 * _DATA_SHEET_STROKE:g} %"},
        )


Vibration = StatedAmplitude | DrivenActuator
"""Source of the vibration of the contact."""
