"""Vibrations of many operating points, one for each drive and load: of a structure, in one batch, or sines."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import OutsideRange, SonolubeError
from sonolube.models.actuator.stack import require_allowed_voltage
from sonolube.models.contact import ContactMotion, separation
from sonolube.models.dynamics import Status, SteadyStates, steady_state
from sonolube.models.dynamics.backend import Backend
from sonolube.models.friction.models.range_check import OUTSIDE_MODEL_RANGE
from sonolube.rig.excitation import NO_DISSIPATED_POWER
from sonolube.rig.friction_and_wear import prescribed_sine
from sonolube.rig.operating_conditions import OperatingConditions
from sonolube.rig.resolved_rig import ResolvedRig
from sonolube.rig.vibration import contact_loss_fraction, gap_motion
from sonolube.text.units import format_si

REFUSED = "refused"
"""Status of an operating point that a limit of the stack or the contact rules out."""

_SAME_FREQUENCY = 1e-6  # relative


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PointVibration:
    """Vibration of the points that share one drive and load; without a motion where there is none."""

    status: str
    reason: str
    motion: ContactMotion | None = None
    numbers: tuple[float, ...] = (np.nan,) * 6  # five of the vibration, and whether the gap closes


VibrationAt = Callable[[int], PointVibration]
"""Vibration of a drive and load by its number."""


def steady_states_of(
    resolved: ResolvedRig,
    settings: OperatingConditions,
    rest: Floats,
    backend: Backend = "cpu",
    relative_tolerance: float = 1e-6,
) -> SteadyStates:
    """Steady vibrations of a rig under drives and loads, given the separations at rest."""
    return steady_state(
        resolved.moved.structure,
        resolved.gap_law,
        normal_load=settings.normal_load,
        frequency=settings.frequency,
        voltage_harmonics=resolved.voltage.harmonics(voltage_peak_to_peak=settings.voltage_peak_to_peak),
        voltage_offset=settings.voltage_offset,
        separation=rest,
        relative_tolerance=relative_tolerance,
        backend=backend,
    )


def computed_vibrations(resolved: ResolvedRig, distinct: Floats, backend: Backend) -> VibrationAt:
    """Function that gives the vibration of each drive and load, all solved at once."""
    settings = OperatingConditions.of_columns(distinct)
    rest = separation(resolved.rig.contact, normal_load=settings.normal_load)
    refusals = _refusals(resolved, settings, rest)
    possible = np.array([not text for text in refusals], dtype=bool)
    states = None
    if possible.any():
        states = steady_states_of(
            resolved, OperatingConditions.of_columns(distinct[:, possible]), rest[possible], backend
        )
    place = np.cumsum(possible) - 1

    def vibration_at(setting: int) -> PointVibration:
        if states is None or not possible[setting]:
            return PointVibration(status=REFUSED, reason=refusals[setting])
        return _of_state(states, int(place[setting]))

    return vibration_at


def _of_state(states: SteadyStates, point: int) -> PointVibration:
    known, reason = Status(int(states.status[point])), states.reason(point)
    if known is Status.NOT_CONVERGED:
        return PointVibration(status=known.name.lower(), reason=reason)
    motion = gap_motion(states, point)
    numbers = (
        states.vibration_amplitude[point],
        np.abs(motion.velocity).max(),
        states.mean_displacement[point],
        states.contact_loss_fraction[point],
        states.dissipated_power[point],
        states.gap_closed[point],
    )
    return PointVibration(status=known.name.lower(), reason=reason, motion=motion, numbers=numbers)


def stated_vibrations(resolved: ResolvedRig, distinct: Floats, *, commanded: bool) -> VibrationAt:
    """Function that gives a sine under each drive and load, of the stated or the commanded amplitude."""
    rig, used = resolved.rig, resolved.vibration

    def vibration_at(setting: int) -> PointVibration:
        level, _, f, load = distinct[:, setting].tolist()
        if not commanded and rig.drive is not None and abs(f - rig.drive.frequency) > _SAME_FREQUENCY * f:
            own = format_si(rig.drive.frequency, "Hz", digits=4)
            return PointVibration(
                status=REFUSED, reason=f"the amplitude {used.source} holds at {own} only: choose the amplitude computed"
            )
        amplitude = level if commanded else used.amplitude_at(level)
        try:
            rest = float(separation(rig.contact, normal_load=load))
            motion = prescribed_sine(rig, vibration_amplitude=amplitude, frequency=f, normal_load=load)
        except OutsideRange as refusal:
            return PointVibration(status=OUTSIDE_MODEL_RANGE, reason=f"{OUTSIDE_MODEL_RANGE}: {refusal}")
        if rest <= 0:
            return PointVibration(status=REFUSED, reason=_no_separation(load))
        numbers = (
            amplitude,
            2 * np.pi * f * amplitude,
            float(motion.displacement.mean()),
            contact_loss_fraction(motion),
            np.nan,
            float(motion.displacement.min() <= -rest),
        )
        return PointVibration(
            status="periodic", reason=f"periodic: a sine; {NO_DISSIPATED_POWER}", motion=motion, numbers=numbers
        )

    return vibration_at


def _no_separation(load: float) -> str:
    return f"normal_load {load:g} N leaves no separation between the surfaces: lower the load"


def _refusals(resolved: ResolvedRig, settings: OperatingConditions, rest: Floats) -> list[str]:
    """Reason against each drive and load that the stack or the contact rules out, else empty text."""
    refusals = []
    stack = resolved.moved.stack
    extremes = resolved.voltage.range(
        voltage_peak_to_peak=settings.voltage_peak_to_peak, voltage_offset=settings.voltage_offset
    )
    for voltages, load, gap in zip(np.transpose(extremes), settings.normal_load, rest, strict=True):
        refusal = ""
        try:
            require_allowed_voltage(stack, stack_voltage=voltages)
        except SonolubeError as beyond:
            refusal = str(beyond)
        if gap <= 0:
            refusal = _no_separation(load)
        refusals.append(refusal)
    return refusals
