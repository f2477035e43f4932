"""Source of a rig's vibration: measured, computed, waveguide or per volt, resolved in one place for all commands."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from sonolube.errors import InvalidInput, SonolubeError
from sonolube.models.contact import RoughContact, separation
from sonolube.models.dynamics import Status, Structure, static_contact, steady_state
from sonolube.rig.driven_rig import DrivenRig, driven_rig
from sonolube.rig.excitation import voltage_harmonics
from sonolube.rig.linear_response import gap_law_of
from sonolube.rig.record import AMPLITUDE_SOURCES, AmplitudeSource, MeasuredUnder, Rig
from sonolube.units import format_si

AMPLITUDE_ERROR = 0.05
"""Relative error of a stated amplitude: rounding of printed values and a vibrometer's calibration. []"""

_CLOSE = 1e-10  # relative error of the calibrated amplitude
_ROUNDS = 20
_SAME_FREQUENCY = 1e-6  # relative


@dataclass(frozen=True, kw_only=True, slots=True)
class ResolvedVibration:
    """Source of a rig's vibration, with what gives its motion: the structure, or a sine of an amplitude.

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
    driven: DrivenRig | None
    sine_amplitude: float | None
    per_volt: float | None = None

    def amplitude_at(self, voltage_peak_to_peak: float) -> float:
        """Return the amplitude of the sine at a drive voltage, proportional to it where the rig has one. [m]"""
        assert self.sine_amplitude is not None
        return self.sine_amplitude if self.per_volt is None else self.per_volt * voltage_peak_to_peak


def available_sources(rig: Rig) -> tuple[AmplitudeSource, ...]:
    """Return the sources that a rig has for its amplitude, the one taken by default first.

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


def resolved_vibration(rig: Rig) -> ResolvedVibration:
    """Return the source of a rig's vibration: the one that it names, else measured, computed, waveguide, per volt.

    Parameters
    ----------
    rig : Rig

    Returns
    -------
    ResolvedVibration

    Raises
    ------
    InvalidInput
        If the rig has no amplitude, not the one that it names, or no drive gives the measured one.

    Notes
    -----
    A measured amplitude of a rig with a structure fixes the scale of its drive: force and charge per volt are
    multiplied by the factor at which the computed amplitude, under voltage, frequency and load of the measurement, is
    the measured one; a measurement whose drive is stated was under a sine. Shape, mean gap and their change with
    voltage, frequency and load are computed. Without a structure the vibration is a sine, proportional to the voltage.
    """
    sources = available_sources(rig)
    source = rig.amplitude_source or next(iter(sources), None)
    if source is None:
        raise InvalidInput(
            f"{rig.title}: no amplitude; give vibration.vibration_amplitude, the tables stack and structure, or"
            " actuator.amplitude_per_volt"
        )
    if source not in sources:
        raise InvalidInput(f"{rig.title}: no amplitude {source}: {_MISSING[source](rig)}; it has {_listed(sources)}")
    return _RESOLVED[source](rig)


def amplitude_labels(rig: Rig) -> dict[str, str]:
    """Return the source of a rig's amplitude and the same in words, by name; empty where it has none."""
    try:
        used = resolved_vibration(rig)
    except SonolubeError:
        return {}
    return {"amplitude_source": used.source, "amplitude_origin": used.text}


def moved_rig(rig: Rig) -> DrivenRig:
    """Return the rig whose structure gives the vibration, for results that need one.

    Parameters
    ----------
    rig : Rig

    Returns
    -------
    DrivenRig
        For a measured amplitude with its drive scaled to it.

    Raises
    ------
    InvalidInput
        If the rig has no structure, or takes a sine of its amplitude per volt.
    """
    if rig.structure is None:
        return driven_rig(rig)  # which says what is missing
    used = resolved_vibration(rig)
    if used.driven is None:
        raise InvalidInput(
            f"{rig.title}: this needs the motion of the structure, not a sine of the amplitude {used.source}; choose"
            " the amplitude computed or measured"
        )
    return used.driven


def source_caveats(rig: Rig, *, taken: AmplitudeSource, vibration_amplitude: float) -> tuple[str, ...]:
    """Return a line where the amplitudes of two sources of a rig differ by more than their error, at its own drive.

    Parameters
    ----------
    rig : Rig
    taken : {"measured", "computed", "waveguide", "per-volt"}
        Source by which the rig vibrates.
    vibration_amplitude : float
        By that source. [m]

    Returns
    -------
    tuple of str
    """
    found = {source: _amplitude_by(rig, source) for source in available_sources(rig) if source != taken}
    error = {source: AMPLITUDE_ERROR * max(other, vibration_amplitude) for source, other in found.items()}
    others = [
        f"{source} {format_si(found[source], 'm')}"
        for source in AMPLITUDE_SOURCES
        if source in found and abs(found[source] - vibration_amplitude) > error[source]
    ]
    if not others:
        return ()
    return (
        f"the amplitudes differ by more than their error of {100 * AMPLITUDE_ERROR:.0f} %: {taken}"
        f" {format_si(vibration_amplitude, 'm')}, taken here, and {', '.join(others)}",
    )


def _measured(rig: Rig) -> ResolvedVibration:
    assert rig.vibration_amplitude is not None
    under = _conditions(rig)
    stated = [
        format_si(value, unit, digits=4)
        for value, unit in ((under.voltage_peak_to_peak, "V"), (under.frequency, "Hz"))
        if value is not None
    ]
    origin = "stated" if rig.has_stated_amplitude else "measured"
    text = f"{origin}, {format_si(rig.vibration_amplitude, 'm')}" + (f" at {', '.join(stated)}" if stated else "")
    if rig.structure is None:
        at, volts = under.voltage_peak_to_peak, None if rig.drive is None else rig.drive.voltage_peak_to_peak
        per_volt = rig.vibration_amplitude / at if at and volts is not None else None
        amplitude = rig.vibration_amplitude if per_volt is None or volts is None else per_volt * volts
        return ResolvedVibration(source="measured", text=text, driven=None, sine_amplitude=amplitude, per_volt=per_volt)
    driven = _calibrated(driven_rig(rig))
    text += f"; it scales the drive of the computed motion by {driven.calibration:.4g}"
    return ResolvedVibration(source="measured", text=text, driven=driven, sine_amplitude=None)


def _computed(rig: Rig) -> ResolvedVibration:
    text = "computed from stack and structure"
    return ResolvedVibration(source="computed", text=text, driven=driven_rig(rig), sine_amplitude=None)


def _of_waveguide(rig: Rig) -> ResolvedVibration:
    text = "computed from the waveguide"
    return ResolvedVibration(source="waveguide", text=text, driven=None, sine_amplitude=rig.waveguide_amplitude)


def _per_volt(rig: Rig) -> ResolvedVibration:
    assert rig.amplitude_per_volt is not None
    assert rig.drive is not None
    assert rig.drive.voltage_peak_to_peak is not None
    volts = rig.drive.voltage_peak_to_peak
    text = f"per volt, {format_si(rig.amplitude_per_volt, 'm/V')} times {format_si(volts, 'V')} peak to peak"
    per_volt = rig.amplitude_per_volt
    return ResolvedVibration(
        source="per-volt", text=text, driven=None, sine_amplitude=per_volt * volts, per_volt=per_volt
    )


_RESOLVED: dict[AmplitudeSource, Callable[[Rig], ResolvedVibration]] = {
    "measured": _measured,
    "computed": _computed,
    "waveguide": _of_waveguide,
    "per-volt": _per_volt,
}


def _missing_measurement(rig: Rig) -> str:
    if rig.vibration_amplitude is None:
        return "give vibration.vibration_amplitude"
    return f"it was measured at {format_si(_conditions(rig).frequency or 0.0, 'Hz', digits=4)}, not at the drive's own"


_MISSING: dict[AmplitudeSource, Callable[[Rig], str]] = {
    "measured": _missing_measurement,
    "computed": lambda rig: "give the tables stack and structure",
    "waveguide": lambda rig: "give the table waveguide",
    "per-volt": lambda rig: "give actuator.amplitude_per_volt and drive.voltage_peak_to_peak",
}


def _listed(sources: tuple[AmplitudeSource, ...]) -> str:
    return " and ".join(sources) if sources else "none"


def _conditions(rig: Rig) -> MeasuredUnder:
    """Return drive and load of the measurement, those that are not stated taken from the rig."""
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


def _amplitude_by(rig: Rig, source: AmplitudeSource) -> float:
    """Return the amplitude at the rig's own drive by a source; NaN where none was found. [m]"""
    found = resolved_vibration(replace(rig, amplitude_source=source, calibration=None))
    if found.sine_amplitude is not None:
        return found.sine_amplitude
    assert found.driven is not None
    return _amplitude(_Excited.by_own_drive(found.driven), 1.0)


def _calibrated(rig: DrivenRig) -> DrivenRig:
    """Return the rig with force and charge per volt at which the computed amplitude is the measured one."""
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
    sine = replace(rig, drive=replace(rig.drive, waveform="sine", waveform_samples=None))
    by = rig if stated.voltage_peak_to_peak is None and stated.frequency is None else sine
    scale = _drive_scale(_Excited(rig=by, voltage_peak_to_peak=volts, frequency=f, normal_load=load), wanted)
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
    voltage_peak_to_peak: float
    frequency: float
    normal_load: float
    voltage_offset: float = field(init=False)
    by: tuple[Structure, RoughContact, str, tuple[float, ...] | None] = field(init=False)

    def __post_init__(self) -> None:
        rig, drive = self.rig, self.rig.drive
        ratio = drive.offset_ratio if static_contact(rig.structure).displacement_per_volt else 0.0
        object.__setattr__(self, "voltage_offset", ratio * self.voltage_peak_to_peak)
        object.__setattr__(self, "by", (rig.structure, rig.contact, drive.waveform, drive.waveform_samples))

    @classmethod
    def by_own_drive(cls, rig: DrivenRig) -> "_Excited":
        """Return a rig under its own drive and load."""
        return cls(
            rig=rig,
            voltage_peak_to_peak=rig.voltage_peak_to_peak,
            frequency=rig.drive.frequency,
            normal_load=rig.normal_load,
        )


@lru_cache(maxsize=64)
def _drive_scale(excited: _Excited, amplitude: float) -> float | None:
    """Return the factor on the drive at which the computed amplitude is the measured one, by secants; None for none."""
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
    """Return the computed amplitude under a drive and load, the drive scaled; NaN where none was found. [m]"""
    rig, volts, load = excited.rig, excited.voltage_peak_to_peak, excited.normal_load
    states = steady_state(
        rig.structure,
        gap_law_of(rig),
        normal_load=load,
        frequency=excited.frequency,
        voltage_harmonics=scale * voltage_harmonics(rig.drive, voltage_peak_to_peak=volts),
        voltage_offset=excited.voltage_offset,
        separation=separation(rig.contact, normal_load=load),
        relative_tolerance=1e-8,
        stability=False,
    )
    return float("nan") if states.status == Status.NOT_CONVERGED else float(states.vibration_amplitude)
