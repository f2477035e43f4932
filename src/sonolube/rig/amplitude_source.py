"""Vibration of a rig by each source of its amplitude: measured, computed, waveguide or per volt."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.models.contact import RoughContact, separation
from sonolube.models.dynamics import GapLaw, Status, Structure, drive_receptance, static_contact, steady_state
from sonolube.rig.driven_rig import DrivenRig, DriveVoltage, driven_rig
from sonolube.rig.record import AMPLITUDE_SOURCES, AmplitudeSource, MeasuredUnder, Rig
from sonolube.text.units import format_si

AMPLITUDE_ERROR = 0.05
"""Relative error of a stated amplitude: rounding of printed values and a vibrometer's calibration. []"""

_CLOSE = 1e-10  # relative error of the calibrated amplitude
_ROUNDS = 20
_SAME_FREQUENCY = 1e-6  # relative


@dataclass(frozen=True, kw_only=True, slots=True)
class ResolvedVibration:
    """Source of a rig's vibration, with the origin of its motion: the structure, or a sine of an amplitude.

    Parameters
    ----------
    source : {"measured", "computed", "waveguide", "per-volt"}
        Where the amplitude comes from.
    text : str
        The same in words, with the numbers behind it.
    driven : DrivenRig or None
        Rig whose structure gives the motion; for a measured amplitude with its drive scaled to that amplitude.
    sine_amplitude : float or None
        Amplitude of the sine at the rig's own drive, where no structure gives the motion, in m.
    per_volt : float or None
        That amplitude over the voltage peak to peak, where it changes with the voltage, in m/V.
    """

    source: AmplitudeSource
    text: str
    driven: DrivenRig | None = None
    sine_amplitude: float | None = None
    per_volt: float | None = None

    def amplitude_at(self, voltage_peak_to_peak: float) -> float:
        """Amplitude of the sine at a drive voltage, proportional to it where the rig has one. [m]"""
        assert self.sine_amplitude is not None
        return self.sine_amplitude if self.per_volt is None else self.per_volt * voltage_peak_to_peak


def available_sources(rig: Rig) -> tuple[AmplitudeSource, ...]:
    """Sources that a rig has for its amplitude, the one taken by default first.

    Parameters
    ----------
    rig : Rig

    Returns
    -------
    tuple of str
    """
    present = {
        "measured": rig.vibration_amplitude is not None and (rig.structure is not None or _measured_here(rig)),
        "computed": rig.structure is not None,
        "waveguide": rig.waveguide_amplitude is not None,
        "per-volt": rig.amplitude_per_volt is not None
        and rig.drive is not None
        and rig.drive.voltage_peak_to_peak is not None,
    }
    return tuple(source for source in AMPLITUDE_SOURCES if present[source])


def stated_per_volt(rig: Rig) -> tuple[float, str] | None:
    """Amplitude over voltage of a rig whose own drive voltage is not stated, in m/V, and where it is from.

    By its calibration, or the voltage under which its amplitude was measured; None where it has neither.
    """
    if rig.amplitude_per_volt is not None:
        return rig.amplitude_per_volt, f"the calibration of {format_si(rig.amplitude_per_volt, 'm/V')}"
    under = rig.measured_under
    if rig.vibration_amplitude is None or under is None or not under.voltage_peak_to_peak:
        return None
    volts, amplitude = format_si(under.voltage_peak_to_peak, "V"), format_si(rig.vibration_amplitude, "m")
    return rig.vibration_amplitude / under.voltage_peak_to_peak, f"the measured {amplitude} at {volts}"


def chosen_source(rig: Rig, sources: tuple[AmplitudeSource, ...]) -> AmplitudeSource:
    """Source of a rig's amplitude among those that it has: the one that it names, else the first."""
    source = rig.amplitude_source or next(iter(sources), None)
    if source is None:
        raise InvalidInput(
            f"{rig.title}: no amplitude; give vibration.vibration_amplitude, the tables stack and structure, or"
            " actuator.amplitude_per_volt"
        )
    if source not in sources:
        raise InvalidInput(f"{rig.title}: no amplitude {source}: {_MISSING[source](rig)}; it has {_listed(sources)}")
    return source


def scaled_vibration(rig: DrivenRig, *, voltage: DriveVoltage, gap_law: GapLaw) -> ResolvedVibration:
    """Vibration of a rig with a structure by its measured amplitude, which fixes the scale of its drive.

    Force and charge per volt are multiplied by the factor at which the computed amplitude, under voltage, frequency and
    load of the measurement, is the measured one; a measurement whose drive is stated was under a sine. Shape, mean gap
    and their change with voltage, frequency and load are computed.
    """
    driven = _calibrated(rig, voltage, gap_law)
    text = f"{_measurement_text(rig)}; it scales the drive of the computed motion by {driven.calibration:.4g}"
    return ResolvedVibration(source="measured", text=text, driven=driven)


def computed_amplitude(rig: DrivenRig, *, voltage: DriveVoltage, gap_law: GapLaw) -> float:
    """Amplitude that the structure of a rig takes up under its own drive and load; NaN where none was found. [m]"""
    own = _Excited(
        rig=rig,
        voltage=voltage,
        gap_law=gap_law,
        voltage_peak_to_peak=rig.voltage_peak_to_peak,
        frequency=rig.drive.frequency,
        normal_load=rig.normal_load,
    )
    return _amplitude(own, 1.0)


def tip_amplitude(rig: DrivenRig, *, voltage: DriveVoltage) -> ResolvedVibration:
    """Vibration within the plane by the structure of a rig: that of its free tip, which friction does not hold back."""
    harmonic = float(np.abs(voltage.harmonics()[0]))
    amplitude = harmonic * float(np.abs(drive_receptance(rig.structure, frequency=np.array([rig.drive.frequency])))[0])
    volts = rig.voltage_peak_to_peak
    return ResolvedVibration(
        source="computed",
        text="computed from stack and structure, the tip free within the plane",
        sine_amplitude=amplitude,
        per_volt=amplitude / volts if volts else None,
    )


def _measurement_text(rig: Rig) -> str:
    """Measured amplitude with its drive, in words."""
    assert rig.vibration_amplitude is not None
    under = _conditions(rig)
    stated = [
        format_si(value, unit, digits=4)
        for value, unit in ((under.voltage_peak_to_peak, "V"), (under.frequency, "Hz"))
        if value is not None
    ]
    origin = "stated" if rig.has_stated_amplitude else "measured"
    return f"{origin}, {format_si(rig.vibration_amplitude, 'm')}" + (f" at {', '.join(stated)}" if stated else "")


def _measured_sine(rig: Rig) -> ResolvedVibration:
    """Sine of the measured amplitude, proportional to the voltage where that of the measurement is known."""
    assert rig.vibration_amplitude is not None
    at, volts = _conditions(rig).voltage_peak_to_peak, None if rig.drive is None else rig.drive.voltage_peak_to_peak
    per_volt = rig.vibration_amplitude / at if at and volts is not None else None
    amplitude = rig.vibration_amplitude if per_volt is None or volts is None else per_volt * volts
    text = _measurement_text(rig)
    return ResolvedVibration(source="measured", text=text, sine_amplitude=amplitude, per_volt=per_volt)


def _computed(rig: Rig) -> ResolvedVibration:
    return ResolvedVibration(source="computed", text="computed from stack and structure", driven=driven_rig(rig))


def _of_waveguide(rig: Rig) -> ResolvedVibration:
    text = "computed from the waveguide"
    return ResolvedVibration(source="waveguide", text=text, sine_amplitude=rig.waveguide_amplitude)


def _per_volt(rig: Rig) -> ResolvedVibration:
    assert rig.amplitude_per_volt is not None
    assert rig.drive is not None
    assert rig.drive.voltage_peak_to_peak is not None
    volts = rig.drive.voltage_peak_to_peak
    text = f"per volt, {format_si(rig.amplitude_per_volt, 'm/V')} times {format_si(volts, 'V')} peak to peak"
    per_volt = rig.amplitude_per_volt
    return ResolvedVibration(source="per-volt", text=text, sine_amplitude=per_volt * volts, per_volt=per_volt)


VIBRATIONS: Mapping[AmplitudeSource, Callable[[Rig], ResolvedVibration]] = MappingProxyType(
    {"measured": _measured_sine, "computed": _computed, "waveguide": _of_waveguide, "per-volt": _per_volt}
)
"""Vibration of a rig by each source, a measured amplitude being that of a sine."""


def _missing_measurement(rig: Rig) -> str:
    if rig.vibration_amplitude is None:
        return "give vibration.vibration_amplitude"
    return f"it was measured at {format_si(_conditions(rig).frequency or 0.0, 'Hz', digits=4)}, not at the drive's own"


_MISSING: dict[AmplitudeSource, Callable[[Rig], str]] = {
    "measured": _missing_measurement,
    "computed": lambda rig: "give the tables stack and structure",
    "waveguide": lambda rig: "give the table waveguide",
    "per-volt": lambda rig: "give actuator.amplitude_per_volt or vibration.calibration, and drive.voltage_peak_to_peak",
}


def _listed(sources: tuple[AmplitudeSource, ...]) -> str:
    return " and ".join(sources) if sources else "none"


def _conditions(rig: Rig) -> MeasuredUnder:
    """Drive and load of the measurement, those that are not stated taken from the rig."""
    stated = rig.measured_under or MeasuredUnder()
    drive = rig.drive
    voltage, frequency = (None, None) if drive is None else (drive.voltage_peak_to_peak, drive.frequency)
    return MeasuredUnder(
        voltage_peak_to_peak=voltage if stated.voltage_peak_to_peak is None else stated.voltage_peak_to_peak,
        frequency=frequency if stated.frequency is None else stated.frequency,
        normal_load=rig.normal_load if stated.normal_load is None else stated.normal_load,
    )


def _measured_here(rig: Rig) -> bool:
    """Whether the rig is driven at the frequency of the measurement, and vibrates under its voltage."""
    under = _conditions(rig)
    own = None if rig.drive is None else rig.drive.frequency
    return own is None or under.frequency is None or abs(own - under.frequency) <= _SAME_FREQUENCY * own


def _calibrated(rig: DrivenRig, voltage: DriveVoltage, gap_law: GapLaw) -> DrivenRig:
    """Rig with force and charge per volt at which the computed amplitude is the measured one."""
    if rig.calibration is not None:
        return rig
    assert rig.vibration_amplitude is not None
    stated, wanted = rig.measured_under or MeasuredUnder(), rig.vibration_amplitude
    under = _conditions(rig)
    volts, f, load = (value or 0.0 for value in (under.voltage_peak_to_peak, under.frequency, under.normal_load))
    if not wanted or not volts:
        raise InvalidInput(
            f"{rig.title}: a measured amplitude of {format_si(wanted, 'm')} at {format_si(volts, 'V')} fixes no drive;"
            " choose the amplitude computed"
        )
    stated_drive = stated.voltage_peak_to_peak is not None or stated.frequency is not None
    if stated_drive and rig.drive.waveform != "sine":
        voltage = DriveVoltage(drive=replace(rig.drive, waveform="sine", waveform_samples=None))
    excited = _Excited(
        rig=rig, voltage=voltage, gap_law=gap_law, voltage_peak_to_peak=volts, frequency=f, normal_load=load
    )
    scale = _drive_scale(excited, wanted)
    if scale is None:
        raise InvalidInput(
            f"{rig.title}: no scale of its drive gives the measured amplitude of {format_si(wanted, 'm')}; choose the"
            " amplitude computed"
        )
    structure = replace(rig.structure, drive_vector=scale * rig.structure.drive_vector)
    try:
        stack = replace(rig.stack, free_stroke_per_volt=scale * rig.stack.free_stroke_per_volt, coupling_factor=None)
    except InvalidInput:
        raise InvalidInput(
            f"{rig.title}: the measured amplitude of {format_si(wanted, 'm')} is {scale:.3g} times that computed, more"
            " than the stack can give; check stack and structure, or choose the amplitude computed"
        ) from None
    return replace(rig, structure=structure, stack=stack, calibration=scale, amplitude_source="measured")


@dataclass(frozen=True, kw_only=True)
class _Excited:
    """A rig under a voltage, frequency and load; it counts by what gives its motion.

    The offset of the voltage is left out where no constant voltage moves the contact.
    """

    rig: DrivenRig = field(compare=False)
    voltage: DriveVoltage = field(compare=False)
    gap_law: GapLaw = field(compare=False)
    voltage_peak_to_peak: float
    frequency: float
    normal_load: float
    voltage_offset: float = field(init=False)
    by: tuple[Structure, RoughContact, str, tuple[float, ...] | None] = field(init=False)

    def __post_init__(self) -> None:
        rig, drive = self.rig, self.voltage.drive
        ratio = drive.offset_ratio if static_contact(rig.structure).displacement_per_volt else 0.0
        object.__setattr__(self, "voltage_offset", ratio * self.voltage_peak_to_peak)
        object.__setattr__(self, "by", (rig.structure, rig.contact, drive.waveform, drive.waveform_samples))


@lru_cache(maxsize=64)
def _drive_scale(excited: _Excited, amplitude: float) -> float | None:
    """Factor on the drive at which the computed amplitude is the measured one, by secants; None for none."""
    scale, last = 1.0, (0.0, -amplitude)
    for _ in range(_ROUNDS):
        error = _amplitude(excited, scale) - amplitude
        if not abs(error) > _CLOSE * amplitude:
            break
        step = (scale - last[0]) / (error - last[1]) * error
        last, scale = (scale, error), scale - step
    found = np.isfinite(error) and abs(error) <= 1e3 * _CLOSE * amplitude and scale > 0
    return scale if found else None


@lru_cache(maxsize=256)
def _amplitude(excited: _Excited, scale: float) -> float:
    """Computed amplitude under a drive and load, the drive scaled; NaN where none was found. [m]"""
    rig, volts, load = excited.rig, excited.voltage_peak_to_peak, excited.normal_load
    states = steady_state(
        rig.structure,
        excited.gap_law,
        normal_load=load,
        frequency=excited.frequency,
        voltage_harmonics=scale * excited.voltage.harmonics(voltage_peak_to_peak=volts),
        voltage_offset=excited.voltage_offset,
        separation=separation(rig.contact, normal_load=load),
        relative_tolerance=1e-8,
        stability=False,
    )
    return float("nan") if states.status == Status.NOT_CONVERGED else float(states.vibration_amplitude)
