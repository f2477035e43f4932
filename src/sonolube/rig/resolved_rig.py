"""Rig with its drive voltage, source of amplitude, gap law and rest state, each resolved once for a whole command."""

from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, OutsideRange, SonolubeError
from sonolube.facts.materials import TABOR_FACTOR
from sonolube.models.contact import ExponentialHeights, RoughContact
from sonolube.models.contact.rough import decay_length, normal_force, normal_stiffness, separation, separation_range
from sonolube.models.dynamics import ExponentialGap, GapLaw, StartUpRamp, TabulatedGap, contact_receptance
from sonolube.models.friction.models import FrictionModel
from sonolube.models.friction.models.soft_layer import SoftLayerModel
from sonolube.rig import amplitude_source
from sonolube.rig.driven_rig import DrivenRig, DriveVoltage, actuator_capacitance, driven_rig
from sonolube.rig.record import AMPLITUDE_SOURCES, AmplitudeSource, Rig
from sonolube.rig.vibration_direction import VibrationDirection
from sonolube.text.units import format_si

PRESSED_LAYER = "the load presses the mean planes of this roughness together: friction is that of the soft layer alone"
"""Caveat of a soft layer whose roughness the load closes."""

_POINTS = 2101  # of the table of a contact's force: 50 for each standard deviation of summit heights


@dataclass(frozen=True, kw_only=True, eq=False)
class ResolvedRig:
    """Rig whose operating condition is resolved once; each part is evaluated when it is first needed.

    Parameters
    ----------
    rig : Rig
        As it was given.

    Notes
    -----
    `resolved_rig` makes one. Functions that users call take a `Rig` and make it at their entry, or take one that their
    caller has made; functions below them take a `ResolvedRig`.
    """

    rig: Rig
    motions: list[Any] = field(default_factory=list, init=False, repr=False)
    """Steady vibration of the structure once it was solved, which is that under every friction model."""

    @cached_property
    def voltage(self) -> DriveVoltage:
        """Voltage of the drive, for rigs that have one."""
        assert self.rig.drive is not None
        return DriveVoltage(drive=self.rig.drive)

    @cached_property
    def direction(self) -> VibrationDirection:
        """Direction of the vibration with its second component, that of the friction model's parameters included."""
        fraction = getattr(self.rig.friction_model, "in_plane_fraction", 0.0)
        if not fraction:
            return self.rig.direction
        phase = getattr(self.rig.friction_model, "in_plane_phase", 0.0)
        return replace(self.rig.direction, second_direction="along", second_fraction=fraction, second_phase=phase)

    @cached_property
    def sources(self) -> tuple[AmplitudeSource, ...]:
        """Sources that the rig has for its amplitude, the one taken by default first."""
        return amplitude_source.available_sources(self.rig)

    @cached_property
    def vibration(self) -> amplitude_source.ResolvedVibration:
        """Vibration by the source that the rig names, else by the first that it has.

        Raises
        ------
        InvalidInput
            If the rig has no amplitude, not the one that it names, or no drive gives the measured one.
        """
        return resolved_vibration(self)

    def amplitude_by(self, source: AmplitudeSource) -> float:
        """Amplitude at the rig's own drive by one of its sources; NaN where none was found. [m]"""
        found = _vibration_by(source, self)
        if found.sine_amplitude is not None:
            return found.sine_amplitude
        assert found.driven is not None
        return amplitude_source.computed_amplitude(found.driven, voltage=self.voltage, gap_law=self.gap_law)

    @property
    def moved(self) -> DrivenRig:
        """Rig whose structure gives the vibration, for a measured amplitude with its drive scaled to it.

        Raises
        ------
        InvalidInput
            If the rig has no structure, or takes a sine of its amplitude per volt.
        """
        if self.rig.structure is None:
            return driven_rig(self.rig)  # which says what is missing
        if self.rig.direction.is_in_plane:
            raise InvalidInput(
                f"{self.rig.title}: this needs the motion of the structure along the normal, but the vibration is"
                f" {self.rig.direction.text}; use friction or simulate, or leave vibration.direction out"
            )
        if self.vibration.driven is None:
            raise InvalidInput(
                f"{self.rig.title}: this needs the motion of the structure, not a sine of the amplitude"
                f" {self.vibration.source}; choose the amplitude computed or measured"
            )
        return self.vibration.driven

    @cached_property
    def gap_law(self) -> GapLaw:
        """Gap law of the contact: exponential for exponential heights, tabulated otherwise.

        Notes
        -----
        Between the points of the table the force keeps within 1e-9 of that of the contact.
        """
        return gap_law_of(self.rig.contact)

    @cached_property
    def separation(self) -> float:
        """Separation of the surfaces at rest. [m]

        Raises
        ------
        OutsideRange
            If the surfaces would be pressed through each other, so that no separation is left.
        """
        return rest_separation(self.rig)

    @cached_property
    def decay_length(self) -> float:
        """Decay length of the contact force at rest. [m]"""
        return float(decay_length(self.rig.contact, separation=self.separation))

    def charging_power(self, **drive: Floats) -> Floats | None:
        """Charge of the capacitance, D 1.9, at settings of the drive; None where it or the voltage is unknown. [W]"""
        rig, capacitance = self.rig, actuator_capacitance(self.rig)
        if rig.drive is None or rig.drive.voltage_peak_to_peak is None or capacitance is None:
            return None
        return self.voltage.charging_power(capacitance=capacitance, **drive)

    def require_separation(self) -> "ResolvedRig":
        """Rig itself, whose load is refused where it leaves no separation between the surfaces."""
        _ = self.separation
        return self

    def with_friction_model(self, friction_model: FrictionModel) -> "ResolvedRig":
        """Rig with another friction model, on which nothing else that is resolved depends."""
        other = copy(self)
        object.__setattr__(other, "rig", replace(self.rig, friction_model=friction_model))
        return other


def resolved_rig(rig: Rig | ResolvedRig) -> ResolvedRig:
    """Rig with the parts of its operating condition, to be made once and passed on.

    The one given where it is one already. Nothing is evaluated, so that no rig is refused.
    """
    return rig if isinstance(rig, ResolvedRig) else ResolvedRig(rig=rig)


def drive_and_load(resolved: ResolvedRig) -> dict[str, Any]:
    """Arguments, by name, with which a structure in contact is marched in time under a rig's drive and load."""
    drive = resolved.voltage.drive
    return {
        "normal_load": resolved.rig.normal_load,
        "frequency": drive.frequency,
        "voltage_peak_to_peak": drive.voltage_peak_to_peak,
        "voltage_offset": drive.voltage_offset,
        "waveform": resolved.voltage.waveform,
        "ramp": StartUpRamp(duration=drive.ramp_duration, shape=drive.ramp_shape),
    }


def resolved_vibration(resolved: ResolvedRig) -> amplitude_source.ResolvedVibration:
    """Vibration of a rig by the source that it names, else measured, computed, waveguide, per volt."""
    found = _vibration_by(amplitude_source.chosen_source(resolved.rig, resolved.sources), resolved)
    direction = resolved.rig.direction
    return found if direction.is_normal else replace(found, text=f"{found.text}; {direction.text}")


def rest_separation(rig: Rig) -> float:
    """Separation of a rig's surfaces at rest; a load that leaves none is refused, but on a soft layer. [m]"""
    gap = float(separation(rig.contact, normal_load=rig.normal_load))
    if gap <= 0 and not isinstance(rig.friction_model, SoftLayerModel):
        raise OutsideRange(
            f"contact.normal_load {rig.normal_load:g} N leaves no separation between the surfaces (d = {gap:.3g} m)"
            f"{_crushing(rig)}: lower the load or enlarge contact.nominal_area"
        )
    return gap


def _crushing(rig: Rig) -> str:
    """Nominal pressure beside the hardness of the softer body, where that cannot bear it; else empty."""
    pressure, hardness = rig.normal_load / rig.contact.nominal_area, TABOR_FACTOR * rig.contact.pair.yield_strength
    if pressure <= hardness:
        return ""
    return (
        f", and its {format_si(pressure, 'Pa')} over {format_si(rig.contact.nominal_area, 'm2')} are above the hardness"
        f" of the softer body, about {format_si(hardness, 'Pa')}"
    )


def gap_law_of(contact: RoughContact) -> GapLaw:
    """Gap law of a contact: exponential for exponential heights, tabulated otherwise."""
    if isinstance(contact.heights, ExponentialHeights):
        return ExponentialGap(decay_length=float(decay_length(contact)))
    d = np.linspace(*separation_range(contact), _POINTS)
    return TabulatedGap(
        separation=d,
        normal_force=normal_force(contact, separation=d),
        normal_stiffness=normal_stiffness(contact, separation=d),
    )


def amplitude_labels(rig: Rig | ResolvedRig) -> dict[str, str]:
    """Source of a rig's amplitude and the same in words, by name; empty where it has none."""
    try:
        used = resolved_rig(rig).vibration
    except SonolubeError:
        return {}
    return {"amplitude_source": used.source, "amplitude_origin": used.text}


def source_caveats(resolved: ResolvedRig, *, vibration_amplitude: float) -> tuple[str, ...]:
    """Line where the amplitudes of two sources of a rig differ by more than their error, at its own drive."""
    taken = resolved.vibration.source
    found = {source: _amplitude_beside(resolved, source) for source in resolved.sources if source != taken}
    error = {
        source: amplitude_source.AMPLITUDE_ERROR * max(other, vibration_amplitude) for source, other in found.items()
    }
    others = [
        f"{source} {format_si(found[source], 'm')}"
        for source in AMPLITUDE_SOURCES
        if source in found and abs(found[source] - vibration_amplitude) > error[source]
    ]
    if not others:
        return ()
    return (
        f"the amplitudes differ by more than their error of {100 * amplitude_source.AMPLITUDE_ERROR:.0f} %: {taken}"
        f" {format_si(vibration_amplitude, 'm')}, taken here, and {', '.join(others)}",
    )


def _amplitude_beside(resolved: ResolvedRig, source: AmplitudeSource) -> float:
    """Amplitude by a source that is not taken; NaN where the rig has none by it. [m]"""
    try:
        return resolved.amplitude_by(source)
    except SonolubeError:
        return float("nan")


def held_back_caveats(resolved: ResolvedRig, *, vibration_amplitude: float) -> tuple[str, ...]:
    """Line where friction, left out of a computed motion within the plane, could change its amplitude much."""
    rig, used = resolved.rig, resolved.vibration
    if not (rig.direction.is_in_plane and used.source == "computed" and rig.drive and rig.structure):
        return ()
    limit = rig.friction_coefficient * rig.normal_load
    moved = float(np.abs(contact_receptance(rig.structure, frequency=np.array([rig.drive.frequency])))[0])
    change = 4 / np.pi * limit * moved
    if change <= amplitude_source.AMPLITUDE_ERROR * vibration_amplitude:
        return ()
    return (
        f"the friction force, up to {format_si(limit, 'N')}, is left out of the motion of the tip and could change its"
        f" amplitude by up to {format_si(change, 'm')}; measure it and give vibration.vibration_amplitude",
    )


def _vibration_by(source: AmplitudeSource, resolved: ResolvedRig) -> amplitude_source.ResolvedVibration:
    """Vibration of a rig by one of the sources that it has."""
    if source == "computed" and resolved.rig.direction.is_in_plane:
        return amplitude_source.tip_amplitude(driven_rig(resolved.rig), voltage=resolved.voltage)
    if source == "measured" and resolved.rig.direction.is_in_plane:
        return amplitude_source.VIBRATIONS[source](resolved.rig)
    if source == "measured" and resolved.rig.structure is not None:
        driven = driven_rig(resolved.rig)
        return amplitude_source.scaled_vibration(driven, voltage=resolved.voltage, gap_law=resolved.gap_law)
    return amplitude_source.VIBRATIONS[source](resolved.rig)
