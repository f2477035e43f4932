"""Pin, vibration, decay length and surfaces of a new rig, and their entries of a rig file.

The decay length is of published tests, as stated, or from a measured normal stiffness; surfaces are of a stated finish
or a scan.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import degrees, exp, hypot, log, pi
from pathlib import Path
from typing import Final

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput
from sonolube.measurement.surface_files.reader import read_height_map
from sonolube.models import surfaces
from sonolube.models.actuator import CatalogueActuator
from sonolube.models.contact import SphereOnFlat, hertz_contact_radius
from sonolube.rig.file.contact_section import height_of_finish
from sonolube.rig.friction_and_wear import CENTRAL_SHARE, PUBLISHED_DECAY_LENGTH
from sonolube.rig.record import STATED
from sonolube.rig.vibration_direction import VibrationDirection
from sonolube.rig.voltage_calibration import VoltageCalibration
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


@dataclass(frozen=True, kw_only=True, slots=True)
class CalibratedDrive:
    """Vibration of a drive of which one voltage and its amplitude are known.

    Parameters
    ----------
    calibration : VoltageCalibration
    vibration_amplitude : float or None
        Zero to peak, to which the voltage follows; None for that of the calibration. [m]
    """

    calibration: VoltageCalibration
    vibration_amplitude: float | None = None

    def entries(self, frequency: float) -> Entries:
        """Tables drive and vibration."""
        amplitude = self.vibration_amplitude or self.calibration.vibration_amplitude
        StatedAmplitude(vibration_amplitude=amplitude)  # refuses what no vibration is
        volts = amplitude / self.calibration.amplitude_per_volt
        drive = {"voltage_peak_to_peak": toml_text(volts, "V"), "frequency": toml_text(frequency, "Hz")}
        return Entries(
            tables={"drive": drive, "vibration": {"calibration": json.dumps(self.calibration.text)}},
            assumptions={"vibration.calibration": f"{STATED}; the amplitude is taken as proportional to the voltage"},
        )


Vibration = StatedAmplitude | DrivenActuator | CalibratedDrive
"""Source of the vibration of the contact."""


def direction_entries(direction: VibrationDirection) -> Entries:
    """Entries of a new rig file for the direction of its vibration, with the friction model of one within the plane."""
    if direction.is_normal:
        return Entries(tables={})
    if direction.vibration_direction is not None:
        table = {"vibration_direction": json.dumps(f"{degrees(direction.vibration_direction):.6g} deg")}
    else:
        table = {"direction": json.dumps(direction.direction)}
    if direction.torsion_radius is not None:
        table["torsion_radius"] = toml_text(direction.torsion_radius, "m")
    return Entries(tables={"vibration": table, "friction": {"model": json.dumps("coulomb")}})


_STATED_FACTOR: Final = 1.3


def compliance_entries(*, decay_length: float | None, normal_stiffness: float | None) -> Entries:
    """Entries of a new rig file for the decay length of its contact.

    Of the table contact; the median of worn contacts in published tests where both are None.
    """
    if decay_length is not None and normal_stiffness is not None:
        raise InvalidInput("give either decay_length or normal_stiffness, got both")
    if normal_stiffness is not None:
        require_positive(normal_stiffness=normal_stiffness)
        return _entries(
            {"normal_stiffness": toml_text(normal_stiffness, "N/m")},
            "as stated, taken as measured under this load: a factor of 1.3",
            _STATED_FACTOR,
        )
    if decay_length is not None:
        require_positive(decay_length=decay_length)
        return _entries({"decay_length": toml_text(decay_length, "m")}, "as stated: a factor of 1.3", _STATED_FACTOR)
    published = PUBLISHED_DECAY_LENGTH
    low, high = (f"{1e6 * end:.2g} um" for end in published.central_range())
    return _entries(
        {"decay_length": toml_text(published.median, "m"), "decay_length_origin": json.dumps("published_tests")},
        f"median of worn contacts in published friction tests; {100 * CENTRAL_SHARE:.0f} % have {low} to {high};"
        " roughness before wear does not tell it: see the decay length of worn contacts in the theory of contact",
        published.factor,
    )


def _entries(table: dict[str, str], reason: str, factor: float) -> Entries:
    """Entries of the table contact, its first key assumed and lognormal."""
    key = f"contact.{next(iter(table))}"
    return Entries(
        tables={"contact": table}, assumptions={key: reason}, uncertainty={key: f"lognormal factor {factor:.4g}"}
    )


_SCAN_DEVIATION: Final = 0.1
_SCANNED_SUMMITS_DEVIATION: Final = 0.4


@dataclass(frozen=True, kw_only=True, slots=True)
class KnownSurface:
    """Roughness of one surface, or of two in contact, with how well it is known.

    Parameters
    ----------
    roughness : Roughness
        Height, summit radius and summit density: medians.
    height_deviation, radius_deviation, density_deviation : float
        Standard deviations of the logarithms of height, radius and density of the summits.
    height_reason, summit_reason : str
        Where they come from.
    """

    roughness: surfaces.Roughness
    height_deviation: float
    radius_deviation: float
    density_deviation: float
    height_reason: str
    summit_reason: str

    def entries(self, place: str) -> Entries:
        """Table of the roughness."""
        rows = (
            ("rms_height", "m", self.height_deviation, self.height_reason),
            ("summit_radius", "m", self.radius_deviation, self.summit_reason),
            ("summit_density", "1/m2", self.density_deviation, self.summit_reason),
        )
        return Entries(
            tables={place: {name: toml_text(getattr(self.roughness, name), unit) for name, unit, _, _ in rows}},
            assumptions={f"{place}.{name}": reason for name, _, _, reason in rows},
            uncertainty={f"{place}.{name}": lognormal_text(deviation) for name, _, deviation, _ in rows},
        )


def finished_surface(finish: str) -> KnownSurface:
    """Surface by its process, its ISO grade or both, or by Ra, Rz or Rq."""
    height = height_of_finish(finish)
    summits = surfaces.typical_summits(rms_height=height.rms_height)
    return KnownSurface(
        roughness=surfaces.Roughness(
            rms_height=height.rms_height, summit_radius=summits.summit_radius, summit_density=summits.summit_density
        ),
        height_deviation=log(height.factor),
        radius_deviation=log(summits.radius_factor) / 2,
        density_deviation=log(summits.density_factor) / 2,
        height_reason=height.reason,
        summit_reason=f"typical of the height; {summits.reason}",
    )


def scanned_surface(path: str | Path) -> KnownSurface:
    """Surface by a scan: rms height of the levelled map, and its summits.

    The height is taken as known within 10 %, the spread between places; the summits, which depend on the distance of
    the pixels, within a factor of 1.5.
    """
    levelled = surfaces.remove_form(read_height_map(Path(path)), degree=1)
    summits = surfaces.contact_roughness(levelled)
    name = Path(path).name
    return KnownSurface(
        roughness=replace(summits, rms_height=surfaces.height_parameters(levelled).rms_height),
        height_deviation=_SCAN_DEVIATION,
        radius_deviation=_SCANNED_SUMMITS_DEVIATION,
        density_deviation=_SCANNED_SUMMITS_DEVIATION,
        height_reason=f"Sq of {name}, levelled; 10 % between places assumed",
        summit_reason=f"summits of {name}; they depend on the distance of its pixels",
    )


def surfaces_in_contact(pin: KnownSurface, disc: KnownSurface) -> KnownSurface:
    r"""Combined roughness of two surfaces.

    Heights add as variances, summits as by `combined_roughness`:

    .. math:: R_q = \sqrt{R_{q,1}^2 + R_{q,2}^2}

    Each surface is taken as uncertain on its own in its height; the summits of both share the relation they come from.
    """
    heights = [each.roughness.rms_height for each in (pin, disc)]
    height = hypot(*heights)
    shares = [(each / height) ** 2 for each in heights]
    return KnownSurface(
        roughness=replace(surfaces.combined_roughness(pin.roughness, disc.roughness), rms_height=height),
        height_deviation=hypot(shares[0] * pin.height_deviation, shares[1] * disc.height_deviation),
        radius_deviation=max(pin.radius_deviation, disc.radius_deviation),
        density_deviation=max(pin.density_deviation, disc.density_deviation),
        height_reason=_of_both(pin.height_reason, disc.height_reason),
        summit_reason=_of_both(pin.summit_reason, disc.summit_reason),
    )


def lognormal_text(deviation: float) -> str:
    """Lognormal distribution as a rig file writes it, by the standard deviation of the logarithm."""
    return f"lognormal factor {exp(deviation):.4g}"


def _of_both(pin: str, disc: str) -> str:
    return f"both: {pin}" if pin == disc else f"pin: {pin}; disc: {disc}"
