"""Set points and checks of a protocol: speeds and drive settings held to limits of devices, and checked quantities."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain, pairwise
from math import pi
from typing import Final

from sonolube.errors import InvalidInput, SeveralFaults
from sonolube.facts.protocol import Check, Protocol, SetPoint, flattened, step_at
from sonolube.laboratory.devices import Devices, DriveSetting
from sonolube.laboratory.interlocks import drive_sampling, interlocks_for
from sonolube.text.units import format_si
from sonolube.vocabulary import unit_of

SPEED_CHANNEL: Final = "rotation_speed"
"""Channel that measures the speed of the disc."""

SETTLING: Final = 5.0
"""Time that a measured speed has to come within its bounds. [s]"""

SPEEDS: Final = ("rotation_speed", "sliding_speed")
"""Quantities that follow from the speed of the disc."""

_AS_SET: Final = f"as it is set: no channel {SPEED_CHANNEL} measures it"


@dataclass(frozen=True, kw_only=True, slots=True)
class CheckedValue:
    """Value of a checked quantity.

    Parameters
    ----------
    check : Check
    value : float or None
        In SI; None where nothing tells it.
    is_set : bool
        Whether it is the set point, which nothing measures.
    """

    check: Check
    value: float | None
    is_set: bool = False

    @property
    def holds(self) -> bool:
        """Whether it lies within the bounds."""
        low, high = self.check.bounds
        return self.value is not None and low <= self.value <= high

    @property
    def facts(self) -> dict[str, str | float]:
        """Facts that a record keeps of a check that holds."""
        assert self.value is not None
        return {"quantity": self.check.quantity, "value": self.value, **({"basis": _AS_SET} if self.is_set else {})}

    @property
    def reason(self) -> str:
        """Why it does not hold."""
        check = self.check
        bounds = f"{check.lowest or 'any'} to {check.highest or 'any'}"
        if self.value is None:
            return f"check of {check.quantity}: no channel measures it; wanted {bounds}"
        basis = f" ({_AS_SET})" if self.is_set else ""
        return f"check of {check.quantity}: {format_si(self.value, unit_of(check.quantity))}{basis}, wanted {bounds}"


def speed_of(check: Check, *, rotation_speed: float, groove_diameter: float, is_set: bool) -> CheckedValue:
    """Speed that is checked, by that of the disc."""
    slides = check.quantity == "sliding_speed"
    value = rotation_speed * pi * groove_diameter if slides else rotation_speed
    return CheckedValue(check=check, value=value, is_set=is_set)


def speed_checks(protocol: Protocol) -> tuple[str, ...]:
    """Steps that check a speed; each place once."""
    checks = {point.step: step_at(protocol, point.step) for point in flattened(protocol) if point.kind == "check"}
    return tuple(place for place, step in checks.items() if isinstance(step, Check) and step.quantity in SPEEDS)


_ROUNDING: Final = 1 + 1e-9


def require_possible(protocol: Protocol, devices: Devices) -> None:
    """Raise where devices cannot do what a protocol says, before anything is connected.

    Parameters
    ----------
    protocol : Protocol
    devices : Devices

    Raises
    ------
    InvalidInput
        With all that `impossibilities` finds.
    """
    faults = impossibilities(protocol, devices)
    if faults:
        raise InvalidInput(faults[0]) if len(faults) == 1 else SeveralFaults(faults)


def impossibilities(protocol: Protocol, devices: Devices) -> tuple[str, ...]:
    """Everything that a protocol asks for and devices cannot give.

    Parameters
    ----------
    protocol : Protocol
    devices : Devices

    Returns
    -------
    tuple of str
        Limits that no channel can watch; then of each step the highest voltage and speed beyond the devices, and the
        channels that are missing.
    """
    unwatched: tuple[str, ...] = ()
    try:
        interlocks_for(protocol.limits, devices.channels, drive_sampling(protocol))
    except InvalidInput as refusal:
        unwatched = refusal.faults if isinstance(refusal, SeveralFaults) else (str(refusal),)
    diameter, points = groove_diameter(protocol, devices), flattened(protocol)
    found = (_faults(point, before, devices, diameter) for before, point in pairwise((None, *points)) if point)
    return (*dict.fromkeys(unwatched), *highest_of_steps(chain.from_iterable(found)))


def highest_of_steps(found: Iterable[tuple[str, str, float, str]]) -> tuple[str, ...]:
    """Texts of faults by step, kind and value, of each step and kind the one with the highest value."""
    highest: dict[tuple[str, str], tuple[float, str]] = {}
    for step, kind, value, text in found:
        known = highest.get((step, kind))
        if known is None or value > known[0]:
            highest[step, kind] = (value, text)
    return tuple(text for _, text in highest.values())


def groove_diameter(protocol: Protocol, devices: Devices) -> float:
    """Diameter of the circle under the pin, of the protocol or else of the rig. [m]"""
    return protocol.metadata.groove_diameter or devices.groove_diameter


def rotation_speed(point: SetPoint, diameter: float) -> float:
    """Speed of the disc that a set point asks for. [1/s]"""
    if point.rotation_speed is not None:
        return point.rotation_speed
    return (point.sliding_speed or 0.0) / (pi * diameter)


def drive_setting(point: SetPoint) -> DriveSetting | None:
    """Output of the drive source that a set point asks for; none for off."""
    if point.frequency is None or point.voltage_peak_to_peak == 0:
        return None
    return DriveSetting(
        voltage_peak_to_peak=point.voltage_peak_to_peak,
        voltage_offset=point.voltage_offset,
        frequency=point.frequency,
        waveform=point.waveform,
    )


def _faults(
    point: SetPoint, before: SetPoint | None, devices: Devices, diameter: float
) -> Iterator[tuple[str, str, float, str]]:
    """Step, kind, value and text of what a set point changes to and devices cannot give."""
    place, drive, motor = f"step {point.step}", devices.drive, devices.motor
    volts = point.voltage_maximum
    if volts > drive.voltage_maximum * _ROUNDING and (before is None or volts != before.voltage_maximum):
        reached, most = format_si(volts, "V"), format_si(drive.voltage_maximum, "V")
        yield point.step, "voltage", volts, f"{place}: the drive reaches {reached}; {drive.name} gives at most {most}"
    turns, fastest = rotation_speed(point, diameter), motor.rotation_speed_maximum
    if turns > fastest * _ROUNDING and (before is None or turns != rotation_speed(before, diameter)):
        wanted, most = format_si(turns, "1/s"), format_si(fastest, "1/s")
        yield point.step, "speed", turns, f"{place}: needs {wanted}; {motor.name} turns at most at {most}"
    channels, acquisition = devices.channels, devices.acquisition
    missing = [name for name in point.channels if name not in channels]
    if missing and point.kind == "acquire":
        names = f"channel {missing[0]}" if len(missing) == 1 else f"channels {', '.join(missing)}"
        text = f"{place}: {acquisition.name} has no {names}; it has {', '.join(channels)}"
        yield point.step, "channels", 0.0, text
    elif point.kind == "acquire" and all(name not in acquisition.channels for name in point.channels):
        yield point.step, "channels", 0.0, f"{place}: records no channel of {acquisition.name}; add one"
