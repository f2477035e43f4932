"""Readers of what a user states of a new rig: quantities, shape of the pin, vibration and surfaces."""

import re
from collections.abc import Callable
from contextlib import suppress
from math import pi
from pathlib import Path
from typing import Final

from sonolube.errors import InvalidInput
from sonolube.models.actuator import catalogue_actuator
from sonolube.rig.file.contact_section import is_roughness
from sonolube.rig.file.section import plausible_si, require_plausible
from sonolube.rig.new_rig.pin_and_vibration import (
    CalibratedDrive,
    DrivenActuator,
    FlatPin,
    KnownSurface,
    PinShape,
    RoundPin,
    StatedAmplitude,
    Vibration,
    finished_surface,
    scanned_surface,
)
from sonolube.rig.vibration_direction import VibrationDirection
from sonolube.rig.voltage_calibration import voltage_calibration
from sonolube.text.units import format_si, to_si

SHAPE_FORMS: Final = (
    "'flat' with its diameter or 'ball' with its radius: 'flat 3mm', 'ball 5mm', 'ball radius 5mm',"
    " 'ball diameter 10mm'"
)
"""Forms of the end of a pin that are read, for refusals."""

_TURNS: Final = re.compile(r"(?<![a-zA-Z])(?:revs?|U)(?=\s*/)")
_BALLS: Final = ("ball", "sphere", "crown")
_RADII: Final = ("radius", "r")
_SHAPE: Final = re.compile(
    r"(?P<kind>ball|sphere|crown|flat|pin|cylinder)[ :=]+"
    r"(?:(?P<measure>radius|diameter|dia|r|d|ø|⌀)[ .:=]*)?(?P<size>[-+.\d].*)",
    re.IGNORECASE,
)


def reader(unit: str, *, name: str) -> Callable[[str], float]:
    """Reader of a positive quantity.

    From text with a unit to a number in SI.
    """

    def read(text: str) -> float:
        value = plausible_si(text, unit=unit, name=name)
        if not value > 0:
            raise InvalidInput(f"{name} {text} must be positive")
        return value

    return read


def pin_shape(text: str, *, name: str = "--shape") -> PinShape:
    """Shape of the end of a pin, such as "flat 3mm" (its diameter), "ball 5mm" (its radius) or "ball diameter 6mm"."""
    found = _SHAPE.fullmatch(" ".join(text.split()))
    if found is None:
        raise InvalidInput(f"{name} {text!r} must be {SHAPE_FORMS}")
    is_ball = found["kind"].lower() in _BALLS
    is_radius = is_ball if found["measure"] is None else found["measure"].lower() in _RADII
    length = reader("m", name=name)(found["size"])
    if is_ball:
        return RoundPin(tip_radius=length if is_radius else length / 2)
    return FlatPin(diameter=2 * length if is_radius else length)


def speed_of(
    text: str,
    *,
    track_radius: str | None = None,
    track_diameter: str | None = None,
    name: str = "--speed",
    radius_name: str = "--track-radius",
    diameter_name: str = "--track-diameter",
) -> tuple[float, str]:
    r"""Sliding speed as stated, such as "0.2m/s", or by the rotation of the disc, such as "100 rpm", and the track.

    .. math:: v = 2 \pi r n

    With how it follows from the rotation; empty where the speed itself is stated. [m/s]
    """
    turns = rotation_of(text)
    given = {radius_name: track_radius, diameter_name: track_diameter}
    stated = {key: value for key, value in given.items() if value is not None}
    if len(stated) > 1:
        raise InvalidInput(f"give either {' or '.join(stated)}, got both")
    if turns is None:
        speed = reader("m/s", name=name)(text)
        if stated:
            raise InvalidInput(f"{next(iter(stated))} belongs to a speed in rpm; {name} {text} needs none")
        return speed, ""
    if not turns > 0:
        raise InvalidInput(f"{name} {text} must be positive")
    if not stated:
        raise InvalidInput(
            f"{name} {text} is a rotational speed: give {radius_name} or {diameter_name} too, or the sliding speed,"
            " such as 0.2m/s"
        )
    ((key, size),) = stated.items()
    length = reader("m", name=key)(size)
    radius = length if key == radius_name else length / 2
    value = require_plausible(2 * pi * radius * turns, unit="m/s", text=f"{name} {text} at a radius of {size}")
    return value, f"2 pi r n, with {60 * turns:.6g} rpm and a track of {format_si(radius, 'm', digits=4)} in radius"


def rotation_of(text: str) -> float | None:
    """Turns per second of a rotational speed, such as "100 rpm"; None for a text of another kind."""
    with suppress(InvalidInput):
        to_si(text, unit="m/s", name="speed")
        return None
    with suppress(InvalidInput):
        return to_si(_TURNS.sub("turn", text), unit="1/s", name="speed")
    return None


def vibration_of(text: str, *, name: str = "--amplitude") -> Vibration:
    """Vibration by its amplitude, such as "3um", by an actuator with its voltage, such as "sa050510 50V", or by both.

    A pair such as "25V = 2um" is a calibration; behind a semicolon, as in "25V = 2um; 3um", stands another amplitude.
    """
    if "=" in text:
        pair, _, amplitude = text.partition(";")
        calibration = voltage_calibration(pair, name="--calibration" if name.startswith("--") else "calibration")
        own = reader("m", name=name)(amplitude.strip()) if amplitude.strip() else None
        return CalibratedDrive(calibration=calibration, vibration_amplitude=own)
    if text[:1].isalpha():
        actuator, _, voltage = text.partition(" ")
        volts = reader("V", name="--voltage" if name.startswith("--") else "voltage")(voltage)
        return DrivenActuator(actuator=catalogue_actuator(actuator), voltage_peak_to_peak=volts)
    return StatedAmplitude(vibration_amplitude=reader("m", name=name)(text))


def direction_of(
    text: str | None, *, torsion_radius: str | None = None, name: str = "--direction", radius_name: str = "radius"
) -> VibrationDirection:
    """Direction of a vibration by its word, such as "along", or by its angle to the sliding, such as "30deg"."""
    radius = None if torsion_radius is None else reader("m", name=radius_name)(torsion_radius)
    word = (text or "normal").strip()
    if word[:1].isalpha():
        if word == "torsional" and radius is None:
            raise InvalidInput(
                f"{name} torsional needs {radius_name}, the radius of the ring at which the amplitude holds"
            )
        return VibrationDirection(direction=word, torsion_radius=radius)
    angle = to_si(word, unit="rad", name=name)
    return VibrationDirection(direction="oblique", vibration_direction=angle, torsion_radius=radius)


def surface_of(text: str) -> KnownSurface:
    """Surface by its finish, such as "ground N6" or "Ra 0.4", or by the file of a scan."""
    return scanned_surface(text) if Path(text).suffix and not is_roughness(text) else finished_surface(text)
