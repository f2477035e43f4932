"""Text with a unit, such as "8 um", to a number in SI and back; only for the edges: files, commands and pages."""

import math
import re
from decimal import Decimal
from functools import cache, lru_cache
from typing import Any

from sonolube.errors import InvalidInput

_PLAIN_POWER = re.compile(r"(?<=[A-Za-zµμ])(-?\d+)")
_ANGLES = ("radian", "degree", "revolution", "turn", "cycle")
_LEAST_MM3 = 1e-14  # m3; below, um3 reads better
_NUMBER_AND_UNIT = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*")

_KINDS = {
    "N": "a force, such as 40N",
    "m": "a length, such as 8um",
    "m2": "an area, such as 2.25mm2",
    "m3": "a volume, such as 1.5mm3",
    "1/m2": "a number per area, such as 4.7e10/m2",
    "Pa": "a pressure, such as 410MPa",
    "V": "a voltage, such as 25.9V",
    "Hz": "a frequency, such as 22kHz",
    "m/s": "a speed, such as 20.3mm/s",
    "s": "a time, such as 4h",
    "F": "a capacitance, such as 360nF",
    "N/m": "a stiffness, such as 2e9N/m",
    "m/V": "a length per voltage, such as 0.09um/V",
    "N s/m": "a damping coefficient, such as 30N*s/m",
    "kg": "a mass, such as 70g",
    "W": "a power, such as 5.3W",
    "rad": "an angle, such as 90deg",
    "1/s": "a rate, such as 6.67/min",
    "K": "a temperature, such as 293K",
    "": "a pure number, such as 0.35",
}


def to_si(text: str, *, unit: str, name: str) -> float:
    """Return the number in SI that `text` stands for.

    Parameters
    ----------
    text : str
        A number and its unit, such as "8 um" or "4.7e10/m2".
    unit : str
        The SI unit in which the result is wanted; empty for a pure number.
    name : str
        What to call the value in an error: the key of the file or the option of the command.

    Returns
    -------
    float

    Raises
    ------
    InvalidInput
        If the text is no finite number with a unit, or a unit of another kind.

    Notes
    -----
    A rate in 1/s counts turns: 60 rpm and 360 deg/s are 1/s.
    """
    match = _NUMBER_AND_UNIT.fullmatch(text)
    if match is None:
        raise InvalidInput(f"{name} {text!r} is not a number with a unit; wanted {unit_description(unit)}")
    number, written_unit = float(match[1]), match[2]
    if not written_unit and unit:
        raise InvalidInput(f"{name} {text} has no unit; wanted {unit_description(unit)}")
    value = _converted(number, written_unit, unit, name=name, text=text)
    if not math.isfinite(value):
        raise InvalidInput(f"{name} {text} is not finite")
    return value


def temperature_difference_to_si(text: str, *, name: str) -> float:
    """Return the rise of temperature in K that `text` stands for.

    Parameters
    ----------
    text : str
        A number and its unit, such as "40 K".
    name : str
        What to call the value in an error.

    Returns
    -------
    float

    Raises
    ------
    InvalidInput
        As `to_si`, or if the unit is of a scale with a zero of its own, such as degC.
    """
    value = to_si(text, unit="K", name=name)
    match = _NUMBER_AND_UNIT.fullmatch(text)
    if match is not None and _converted(0.0, match[2], "K", name=name, text=text) != 0:
        raise InvalidInput(f"{name} {text} is a temperature; wanted a rise of it, such as 40K")
    return value


def convert(value: float, *, from_unit: str, to_unit: str) -> float:
    """Return `value` in another unit of the same kind, such as mm/s for m/s.

    Raises
    ------
    InvalidInput
        If the units are unknown or of different kinds.
    """
    return _converted(value, from_unit, to_unit, name="value", text=f"{value} {from_unit}")


def unit_description(unit: str) -> str:
    """Return what a value with this SI unit is, with an example, such as "a force, such as 40N"."""
    return _KINDS.get(unit, f"a value in {unit}")


def format_si(value: float, unit: str, *, digits: int = 3) -> str:
    """Return the value as people write it, such as "2.5 um" for 2.5e-6 m.

    Parameters
    ----------
    value : float
        In SI.
    unit : str
        Its SI unit.
    digits : int
        Significant digits kept.

    Returns
    -------
    str
    """
    if unit == "kg" and 0 < abs(value) < 1:
        return format_si(1e3 * value, "g", digits=digits)
    if not unit or value == 0 or not math.isfinite(value):
        return f"{value:.{digits}g} {unit}".rstrip()
    power = {"m2": 2, "m3": 3}.get(unit, 1)
    if unit == "kg" or (not unit.isalpha() and unit not in ("m2", "m3", "m/s", "m/V", "N/m")):
        return f"{value:.{digits}g} {unit}"
    # areas and volumes step by millions and billions: better 0.95 um2 than 953000 nm2
    leeway = 0 if power == 1 else power
    step = math.floor((math.log10(abs(value)) + leeway) / (3 * power) + 1e-12)
    step = max(-5, min(4, step))
    if unit == "m3" and step == -2 and abs(value) >= _LEAST_MM3:
        step = -1  # wear is told in mm3
    prefix = {-5: "f", -4: "p", -3: "n", -2: "u", -1: "m", 0: "", 1: "k", 2: "M", 3: "G", 4: "T"}[step]
    if unit in ("m", "m2", "m3", "m/s", "s") and step > 0:
        prefix, step = "", 0
    scaled = float(f"{value / 10.0 ** (3 * power * step):.{digits}g}")
    number = f"{Decimal(repr(scaled)):f}" if 1e-5 <= abs(scaled) < 1e-4 else f"{scaled:.15g}"
    return f"{number} {prefix}{unit}"


def _converted(number: float, written_unit: str, unit: str, *, name: str, text: str) -> float:
    import pint

    registry = _registry()
    try:
        written = _unit(written_unit)
    except Exception:  # pint lets its tokenizer's and parser's errors of many kinds through
        raise InvalidInput(f"{name} {text}: unknown unit {written_unit!r}; wanted {unit_description(unit)}") from None
    wanted = _unit(unit)
    try:
        value = float(registry.Quantity(number, written).to(wanted).magnitude)
    except pint.DimensionalityError:
        raise InvalidInput(f"{name} {text} is {_kind_of_dimension(written)}; wanted {unit_description(unit)}") from None
    if wanted.dimensionality != {"[time]": -1}:
        return value
    return value * (2 * math.pi) ** (_has_angle(wanted) - _has_angle(written))


def _has_angle(unit: Any) -> bool:
    """Return whether an angle is in a unit, which pint, to whom it is a pure number, takes for radians."""
    return any(angle in name for name in map(str, unit._units) for angle in _ANGLES)


def _kind_of_dimension(written: Any) -> str:
    if written.dimensionless:
        return "an angle" if _has_angle(written) else "a pure number"
    for unit, kind in _KINDS.items():
        if written.dimensionality == _registry().Unit(_pint_spelling(unit)).dimensionality:
            return kind.split(",")[0]
    return f"in {written:~}"


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry(cache_folder=None)


@lru_cache(1024)
def _unit(written: str) -> Any:
    return _registry().Unit(_pint_spelling(written))


def _pint_spelling(unit: str) -> str:
    spelled = unit.strip()
    if spelled.startswith("/"):
        spelled = "1" + spelled
    return _PLAIN_POWER.sub(r"**\1", spelled) or "dimensionless"
