"""Drives and loads of many operating points, what sets the vibration, and the vibration of each.

Voltage sets it, or else amplitude; vibrations are those of a structure, in one batch, or sines.
"""

from collections.abc import Callable, Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.charts import Axis
from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput, OutsideRange, SonolubeError
from sonolube.models.actuator.drive import Drive
from sonolube.models.actuator.stack import require_allowed_voltage
from sonolube.models.contact import ContactMotion, separation
from sonolube.models.dynamics import Status, SteadyStates, steady_state
from sonolube.models.friction.models.range_check import OUTSIDE_MODEL_RANGE
from sonolube.rig.driven_rig import NO_DISSIPATED_POWER, require_drive
from sonolube.rig.friction_and_wear import ANY_FREQUENCY, prescribed_sine
from sonolube.rig.power import electrical_load
from sonolube.rig.record import Rig
from sonolube.rig.resolved_rig import ResolvedRig, resolved_rig
from sonolube.rig.vibration import contact_loss_fraction, gap_motion
from sonolube.text.units import format_si

CONDITIONS = ("voltage_peak_to_peak", "voltage_offset", "frequency", "normal_load")
"""Settings of a point apart from its sliding speed, in the order of the rows that hold them."""

SETTINGS = (*CONDITIONS, "sliding_speed")
"""All settings of a point."""


@dataclass(frozen=True, kw_only=True, slots=True)
class CommandedQuantity:
    """Quantity that sets the vibration of a rig.

    Parameters
    ----------
    name : {"voltage_peak_to_peak", "vibration_amplitude"}
        Its name in the vocabulary.
    key : str
        Its key in the file of a rig.
    word : str
        Its name in a sentence.
    unit : str
        SI unit.
    qualifier : str
        Extent that is meant: "peak to peak" or "zero to peak".
    axis : Axis
        Of figures.
    axis_scale : float
        Factor from SI to the unit of that axis.
    """

    name: Literal["voltage_peak_to_peak", "vibration_amplitude"]
    key: str
    word: Literal["voltage", "amplitude"]
    unit: str
    qualifier: str
    axis: Axis
    axis_scale: float

    def text(self, value: float, *, digits: int = 3) -> str:
        """Value with its unit, such as "28 V peak to peak"."""
        return f"{format_si(value, self.unit, digits=digits)} {self.qualifier}"


VOLTAGE: Final = CommandedQuantity(
    name="voltage_peak_to_peak",
    key="drive.voltage_peak_to_peak",
    word="voltage",
    unit="V",
    qualifier="peak to peak",
    axis=Axis(label="Voltage, peak to peak", unit="V"),
    axis_scale=1.0,
)
"""Drive voltage, peak to peak; its offset goes with it in proportion."""

AMPLITUDE: Final = CommandedQuantity(
    name="vibration_amplitude",
    key="vibration.vibration_amplitude",
    word="amplitude",
    unit="m",
    qualifier="zero to peak",
    axis=Axis(label="Vibration amplitude", unit="µm"),
    axis_scale=1e6,
)
"""Amplitude of a sine normal to the contact, zero to peak."""


def commanded_quantity(rig: Rig | ResolvedRig) -> CommandedQuantity:
    """Quantity that sets the vibration of a rig: its drive voltage, or its amplitude where it has no voltage.

    Parameters
    ----------
    rig : Rig or ResolvedRig

    Returns
    -------
    CommandedQuantity

    Raises
    ------
    InvalidInput
        If the rig has no amplitude.
    """
    resolved = resolved_rig(rig)
    drive = resolved.rig.drive
    if drive is not None and drive.voltage_peak_to_peak is not None:
        return VOLTAGE
    _ = resolved.vibration  # which refuses a rig without an amplitude
    return AMPLITUDE


def quantity_of_axis(names: Collection[Hashable]) -> CommandedQuantity:
    """Commanded quantity among the axes of a result.

    Parameters
    ----------
    names : collection of str

    Returns
    -------
    CommandedQuantity
    """
    return AMPLITUDE if AMPLITUDE.name in names else VOLTAGE


def own_level(rig: Rig | ResolvedRig) -> float:
    """Voltage of a rig, or its amplitude where it has no voltage, in V or m.

    Parameters
    ----------
    rig : Rig or ResolvedRig

    Returns
    -------
    float

    Raises
    ------
    InvalidInput
        If the rig has no amplitude.
    """
    resolved = resolved_rig(rig)
    if commanded_quantity(resolved) is VOLTAGE:
        return resolved.voltage.drive.voltage_peak_to_peak or 0.0
    return resolved.vibration.sine_amplitude or 0.0


def level_settings(rig: Rig | ResolvedRig, level: ArrayLike) -> dict[str, Any]:
    """Settings of operating points for values of the commanded quantity, by name.

    Parameters
    ----------
    rig : Rig or ResolvedRig
    level : array_like, any shape
        Voltages, whose offset is in the rig's own ratio to them, or amplitudes, in V or m.

    Returns
    -------
    dict of str to ndarray
        Arguments of `operating_points` and `point_batch`.

    Raises
    ------
    InvalidInput
        If a value is negative or not finite, or the rig has no amplitude.
    """
    resolved = resolved_rig(rig)
    quantity = commanded_quantity(resolved)
    values = require_non_negative(**{quantity.name: level})
    if quantity is AMPLITUDE:
        return {quantity.name: values}
    return {quantity.name: values, "voltage_offset": _offset(resolved.voltage.drive, values)}


def require_commanded(rig: Rig | ResolvedRig, quantity: CommandedQuantity) -> None:
    """Raise if a quantity does not set the vibration of a rig.

    Parameters
    ----------
    rig : Rig or ResolvedRig
    quantity : CommandedQuantity

    Raises
    ------
    InvalidInput
        If the other one does, or the rig has no amplitude.
    """
    resolved = resolved_rig(rig)
    own = commanded_quantity(resolved)
    if quantity is VOLTAGE:
        require_drive(resolved.rig)
    elif own is not quantity:
        raise InvalidInput(f"{resolved.rig.title}: its voltage sets its amplitude; vary {own.key} instead")


def _offset(drive: Drive, volts: Floats) -> Floats:
    """Offset in a drive's ratio to each voltage; its own where it has none, being at 0 V."""
    return volts * drive.offset_ratio if drive.voltage_peak_to_peak else 0 * volts + drive.voltage_offset


def conditions_of(
    rig: Rig, given: Sequence[ArrayLike | None], *, vibration_amplitude: ArrayLike | None = None
) -> tuple[Floats, Floats]:
    """Settings of points as rows by `CONDITIONS` and sliding speeds, checked and broadcast."""
    voltage, offset, f, load, speed = given
    drive = rig.drive or Drive(frequency=ANY_FREQUENCY)
    if drive.voltage_peak_to_peak is None and not (voltage is None and offset is None):
        raise InvalidInput(f"{rig.title}: drive.voltage_peak_to_peak is missing; give it to vary the voltage")
    if vibration_amplitude is None:
        level = require_non_negative(
            voltage_peak_to_peak=(drive.voltage_peak_to_peak or 0.0) if voltage is None else voltage
        )
    elif drive.voltage_peak_to_peak is None:
        level = require_non_negative(vibration_amplitude=vibration_amplitude)
    else:
        raise InvalidInput(f"{rig.title}: its voltage sets its amplitude; vary drive.voltage_peak_to_peak instead")
    settings = (
        level,
        require_finite(voltage_offset=drive.voltage_offset if offset is None else offset),
        require_positive(frequency=drive.frequency if f is None else f),
        require_positive(normal_load=rig.normal_load if load is None else load),
        require_non_negative(sliding_speed=rig.sliding_speed if speed is None else speed),
    )
    try:
        every = np.broadcast_arrays(*settings)
    except ValueError:
        shapes = ", ".join(str(array.shape) for array in settings)
        raise InvalidInput(
            f"voltage or amplitude, offset, frequency, load and speed must have matching shapes, got {shapes}"
        ) from None
    return np.stack(every[:-1]), every[-1].copy()


def points_by_vibration(points: NDArray[np.intp], vibration: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Indices of the points of each vibration, in the order of the vibrations."""
    if not points.size:
        return []
    order = points[np.argsort(vibration[points], kind="stable")]
    return np.split(order, np.flatnonzero(np.diff(vibration[order])) + 1)


REFUSED = "refused"
"""Status of an operating point that a limit of the stack or the contact rules out."""

_SAME_FREQUENCY = 1e-6  # relative


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PointVibration:
    """Vibration of the points that share one drive and load; without a motion where there is none."""

    status: str
    reason: str
    motion: ContactMotion | None = None
    numbers: tuple[float, ...] = (np.nan,) * 8  # seven of the vibration, and whether the gap closes


VibrationAt = Callable[[int], PointVibration]
"""Vibration of a drive and load by its number."""


def steady_states_of(
    resolved: ResolvedRig, columns: Sequence[Floats] | Floats, rest: Floats, relative_tolerance: float = 1e-6
) -> SteadyStates:
    """Steady vibrations of a rig under drives and loads, rows by `CONDITIONS`, given the separations at rest."""
    volts, offset, f, load = columns
    return steady_state(
        resolved.moved.structure,
        resolved.gap_law,
        normal_load=load,
        frequency=f,
        voltage_harmonics=resolved.voltage.harmonics(voltage_peak_to_peak=volts),
        voltage_offset=offset,
        separation=rest,
        relative_tolerance=relative_tolerance,
    )


def computed_vibrations(resolved: ResolvedRig, distinct: Floats) -> VibrationAt:
    """Function that gives the vibration of each drive and load, all solved at once."""
    rest = separation(resolved.rig.contact, normal_load=distinct[-1])
    refusals = _refusals(resolved, distinct, rest)
    possible = np.array([not text for text in refusals], dtype=bool)
    states = None
    if possible.any():
        states = steady_states_of(resolved, distinct[:, possible], rest[possible])
    load = {} if states is None else electrical_load(states)
    place = np.cumsum(possible) - 1

    def vibration_at(setting: int) -> PointVibration:
        if states is None or not possible[setting]:
            return PointVibration(status=REFUSED, reason=refusals[setting])
        return _of_state(states, load, int(place[setting]))

    return vibration_at


def _of_state(states: SteadyStates, load: Mapping[str, Floats], point: int) -> PointVibration:
    """Vibration of a point of a batch, with the electrical load of the batch."""
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
        *(float(values[point]) for values in load.values()),
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
            instead = "keep drive.frequency" if used.source == "computed" else "choose the amplitude computed"
            return PointVibration(status=REFUSED, reason=f"the amplitude {used.source} holds at {own} only: {instead}")
        amplitude = level if commanded else used.amplitude_at(level)
        try:
            rest = float(separation(rig.contact, normal_load=load))
            motion = prescribed_sine(rig, vibration_amplitude=amplitude, frequency=f, normal_load=load)
        except OutsideRange as refusal:
            return PointVibration(status=OUTSIDE_MODEL_RANGE, reason=f"{OUTSIDE_MODEL_RANGE}: {refusal}")
        except InvalidInput as refusal:
            return PointVibration(status=REFUSED, reason=str(refusal))
        if rest <= 0:
            return PointVibration(status=REFUSED, reason=_no_separation(load))
        numbers = (
            amplitude,
            2 * np.pi * f * amplitude,
            float(motion.displacement.mean()),
            contact_loss_fraction(motion),
            *(np.nan,) * 3,  # powers and current
            float(motion.displacement.min() <= -rest),
        )
        return PointVibration(
            status="periodic", reason=f"periodic: a sine; {NO_DISSIPATED_POWER}", motion=motion, numbers=numbers
        )

    return vibration_at


def _no_separation(load: float) -> str:
    return f"normal_load {load:g} N leaves no separation between the surfaces: lower the load"


def _refusals(resolved: ResolvedRig, distinct: Floats, rest: Floats) -> list[str]:
    """Reason against each drive and load that the stack or the contact rules out, else empty text."""
    refusals = []
    stack, (volts, offset, _, loads) = resolved.moved.stack, distinct
    extremes = resolved.voltage.range(voltage_peak_to_peak=volts, voltage_offset=offset)
    for voltages, load, gap in zip(np.transpose(extremes), loads, rest, strict=True):
        refusal = ""
        try:
            require_allowed_voltage(stack, stack_voltage=voltages)
        except SonolubeError as beyond:
            refusal = str(beyond)
        if gap <= 0:
            refusal = _no_separation(load)
        refusals.append(refusal)
    return refusals
