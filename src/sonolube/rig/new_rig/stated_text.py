"""Readers of what a user states of a new rig: quantities, shape of the pin, vibration and surfaces."""

from collections.abc import Callable
from pathlib import Path

from sonolube.actuator import catalogue_actuator
from sonolube.errors import InvalidInput
from sonolube.rig.file.plausible import plausible_si
from sonolube.rig.new_rig.known_surface import KnownSurface, finished_surface, scanned_surface
from sonolube.rig.new_rig.pin_and_vibration import (
    DrivenActuator,
    FlatPin,
    PinShape,
    RoundPin,
    StatedAmplitude,
    Vibration,
)


def reader(unit: str, *, name: str) -> Callable[[str], float]:
    """Return a reader of a positive quantity.

    Parameters
    ----------
    unit : str
        SI unit that the text is converted to.
    name : str
        How a refusal calls it.

    Returns
    -------
    callable
        From text with a unit to a number in SI.
    """

    def read(text: str) -> float:
        value = plausible_si(text, unit=unit, name=name)
        if not value > 0:
            raise InvalidInput(f"{name} {text} must be positive")
        return value

    return read


def pin_shape(text: str, *, name: str = "--shape") -> PinShape:
    """Shape of the end of a pin, such as "flat 3mm" by its diameter or "ball 5mm" by its radius.

    Raises
    ------
    InvalidInput
        If the text is no such shape.
    """
    kind, _, size = text.strip().partition(" ")
    if kind not in ("flat", "ball") or not size:
        raise InvalidInput(f"{name} {text!r} must be 'flat' with its diameter or 'ball' with its radius")
    length = reader("m", name=name)(size)
    return FlatPin(diameter=length) if kind == "flat" else RoundPin(tip_radius=length)


def vibration_of(text: str, *, name: str = "--amplitude") -> Vibration:
    """Vibration by its amplitude, such as "3um", or by an actuator with its voltage, such as "sa050510 50V".

    Raises
    ------
    InvalidInput
        If the text is neither.
    UnknownName
        If the catalogue has no such actuator.
    """
    if text[:1].isalpha():
        actuator, _, voltage = text.partition(" ")
        volts = reader("V", name="--voltage" if name.startswith("--") else "voltage")(voltage)
        return DrivenActuator(actuator=catalogue_actuator(actuator), voltage_peak_to_peak=volts)
    return StatedAmplitude(vibration_amplitude=reader("m", name=name)(text))


def surface_of(text: str) -> KnownSurface:
    """Surface by its finish, such as "ground N6", or by the file of a scan.

    Raises
    ------
    InvalidInput
        If the file cannot be read.
    UnknownName
        If there is no such finish.
    """
    return scanned_surface(text) if Path(text).suffix else finished_surface(text)
