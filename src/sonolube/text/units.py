"""Conversion of text with a unit, such as "8 um", to SI numbers and back, for files, commands and pages.

Units that users write most have their factors in `common_units.toml` beside this module, so that reading a rig need not
wait for a registry of units.
"""

import math
import re
import tomllib
from collections.abc import Sequence
from decimal import Decimal
from functools import cache, lru_cache
from importlib.resources import files
from typing import Any

from sonolube.errors import InvalidInput
from sonolube.text.unit_grammar import canonical_unit
from sonolube.vocabulary import quantities

_TABLE: dict[str, Any] = tomllib.loads(files("sonolube.text").joinpath("common_units.toml").read_text(encoding="utf-8"))
COMMON_FACTORS: dict[str, dict[str, float]] = {
    unit: entry["factors"] for unit, entry in _TABLE.items() if "factors" in entry
}
"""SI value of one of a unit, by the SI unit and the unit as written; those of pint, to the last bit."""

CELSIUS_ORIGIN = 273.15
"""Temperature of 0 degC. [K]"""


_ANGLES = ("radian", "degree", "revolution", "turn", "cycle")
_MINIMUM_MM3 = 1e-14  # m3; smaller volumes are written in um3
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_ROUNDING = 1e-9  # of the scale of a value, below which only errors of floating-point numbers remain
_LONGEST_QUOTE = 80  # characters of a text that an error quotes

_KINDS: dict[str, str] = {unit: entry["kind"] for unit, entry in _TABLE.items() if "kind" in entry}


def to_si(text: str, *, unit: str, name: str) -> float:
    """Value of a text with a unit, in SI.

    Rates in 1/s are in turns per second: 60 rpm and 360 deg/s are 1/s.

    Examples
    --------
    >>> from sonolube.text.units import to_si
    >>> to_si("8 um", unit="m", name="vibration_amplitude"), to_si("60 rpm", unit="1/s", name="rotation_speed")
    (8e-06, 1.0)
    """
    parts = _number_and_unit(text)
    shown = _shortened(text)
    if parts is None:
        raise InvalidInput(f"{name} {shown!r} is not a number with a unit; expected {unit_description(unit)}")
    number, written_unit = parts
    if not written_unit and unit:
        raise InvalidInput(f"{name} {shown} has no unit; expected {unit_description(unit)}")
    value = _converted(number, written_unit, unit, name=name, text=shown)
    if not math.isfinite(value):
        raise InvalidInput(f"{name} {shown} is not finite")
    return value


def temperature_difference_to_si(text: str, *, name: str) -> float:
    """Temperature difference of a text with a unit, in K."""
    value = to_si(text, unit="K", name=name)
    parts = _number_and_unit(text)
    if parts is not None and _converted(0.0, parts[1], "K", name=name, text=text) != 0:
        raise InvalidInput(f"{name} {text} is a temperature; expected a temperature difference, such as 40K")
    return value


def convert(value: float, *, from_unit: str, to_unit: str) -> float:
    """Value in another unit of the same kind, such as mm/s for m/s.

    Examples
    --------
    >>> from sonolube.text.units import convert
    >>> round(convert(0.0203, from_unit="m/s", to_unit="mm/s"), 6)
    20.3
    """
    return _converted(value, from_unit, to_unit, name="value", text=f"{value} {from_unit}")


def require_si_unit(unit: str, *, name: str) -> str:
    """Unit that is one of SI without a prefix, such as m/s2; empty for pure numbers."""
    import pint

    try:
        base = _registry().Quantity(1.0, _unit(unit)).to_base_units() if unit else None
        is_si = base is None or math.isclose(float(base.magnitude), 1.0, rel_tol=1e-12)
    except (pint.PintError, InvalidInput, ValueError, TypeError, ArithmeticError, AssertionError):
        raise InvalidInput(f"{name} {_shortened(unit)!r} is no unit") from None
    if not is_si or "degree_Celsius" in str(_unit(unit) if unit else ""):
        raise InvalidInput(f"{name} {unit!r} is no unit of SI; expected such as m/s for mm/s")
    return unit


def unit_description(unit: str) -> str:
    """Kind of quantity of an SI unit with an example, such as "a force, such as 40N"."""
    return _KINDS.get(unit, f"a value in {unit}")


def format_si(value: float, unit: str, *, digits: int = 3, scale: float = 0.0) -> str:
    """SI value as text with a prefixed unit, such as "2.5 um" for 2.5e-6 m; angles in degrees.

    Examples
    --------
    >>> from sonolube.text.units import format_si
    >>> format_si(2.5e-6, "m"), format_si(22e3, "Hz"), format_si(0.95e-12, "m2")
    ('2.5 um', '22 kHz', '0.95 um2')
    """
    if abs(value) < _ROUNDING * abs(scale):
        value = 0.0
    if unit == "kg" and 0 < abs(value) < 1:
        return format_si(1e3 * value, "g", digits=digits)
    if unit == "rad":
        return f"{math.degrees(value):.{digits}g} deg"
    if not unit or value == 0 or not math.isfinite(value):
        return f"{value:.{digits}g} {unit}".rstrip()
    power = {"m2": 2, "m3": 3}.get(unit, 1)
    if unit == "kg" or (not unit.isalpha() and unit not in ("m2", "m3", "m/s", "m/V", "N/m")):
        return f"{value:.{digits}g} {unit}"
    # prefixes of areas and volumes differ by 1e6 and 1e9: 0.95 um2 rather than 953000 nm2
    margin = 0 if power == 1 else power
    step = math.floor((math.log10(abs(value)) + margin) / (3 * power) + 1e-12)
    step = max(-5, min(4, step))
    if unit == "m3" and step == -2 and abs(value) >= _MINIMUM_MM3:
        step = -1  # wear volumes are given in mm3
    prefix = {-5: "f", -4: "p", -3: "n", -2: "u", -1: "m", 0: "", 1: "k", 2: "M", 3: "G", 4: "T"}[step]
    if unit in ("m", "m2", "m3", "m/s", "s", "K") and step > 0:
        prefix, step = "", 0
    scaled = float(f"{value / 10.0 ** (3 * power * step):.{digits}g}")
    number = f"{Decimal(repr(scaled)):f}" if 1e-5 <= abs(scaled) < 1e-4 else f"{scaled:.15g}"
    return f"{number} {prefix}{unit}"


def format_quantity(value: float, name: str, *, digits: int = 3) -> str:
    """SI value of a quantity as text with the unit usual for it, such as "0.0257 mm3/m" for a wear rate.

    Examples
    --------
    >>> from sonolube.text.units import format_quantity
    >>> format_quantity(2.57e-11, "wear_rate")
    '0.0257 mm3/m'
    """
    known = quantities().get(name)
    if known is None or not known.text_unit:
        return format_si(value, known.unit if known else "", digits=digits)
    return f"{value / COMMON_FACTORS[known.unit][known.text_unit]:.{digits}g} {known.text_unit}"


def format_like(values: Sequence[float], unit: str, *, digits: int = 3) -> list[str]:
    """SI values as text with one prefixed unit for all, that of the largest, as in a column of a table.

    A value below a thousandth of the largest has a prefix of its own.

    Examples
    --------
    >>> from sonolube.text.units import format_like
    >>> format_like([0.5e-6, 2.5e-6], "m")
    ['0.5 um', '2.5 um']
    """
    largest = max((abs(value) for value in values if math.isfinite(value)), default=0.0)
    if not largest or not unit:
        return [format_si(value, unit, digits=digits) for value in values]
    number, prefixed = format_si(largest, unit, digits=15).split(" ", 1)
    scale = float(number) / largest
    return [
        f"{Decimal(repr(float(f'{value * scale:.{digits}g}'))):f} {prefixed}".replace(".0 ", " ")
        if largest / 1000 <= abs(value) <= largest
        else format_si(value, unit, digits=digits)
        for value in values
    ]


def _number_and_unit(text: str) -> tuple[float, str] | None:
    """Number that a text begins with and what follows; None for a text of another form."""
    text = text.strip()
    match = _NUMBER.match(text)
    return None if match is None else (float(match[0]), text[match.end() :].strip())


def _shortened(text: str) -> str:
    """Text as an error quotes it."""
    return text if len(text) <= _LONGEST_QUOTE else f"{text[: _LONGEST_QUOTE // 2]}...{text[-_LONGEST_QUOTE // 2 :]}"


def _converted(number: float, written_unit: str, unit: str, *, name: str, text: str) -> float:
    """Number in another unit; the errors quote the name and the text of the value."""
    factor = COMMON_FACTORS.get(unit, {}).get(written_unit)
    if factor is not None:
        return number * factor
    if (written_unit, unit) == ("degC", "K"):
        return number + CELSIUS_ORIGIN
    import numpy as np
    import pint

    registry = _registry()
    try:
        written = _unit(written_unit)
    except Exception:  # pint raises errors of many kinds
        shown = _shortened(written_unit)
        raise InvalidInput(f"{name} {text}: unknown unit {shown!r}; expected {unit_description(unit)}") from None
    target = _unit(unit)
    try:
        with np.errstate(over="raise"):  # of logarithmic units
            value = float(registry.Quantity(number, written).to(target).magnitude)
    except pint.DimensionalityError:
        kind = _kind_of_dimension(written)
        raise InvalidInput(f"{name} {text} is {kind}; expected {unit_description(unit)}") from None
    except (ArithmeticError, AssertionError, pint.PintError, TypeError, ValueError):  # offset scales, overflow
        raise InvalidInput(f"{name} {text} has no value in {unit or 'pure numbers'}") from None
    if target.dimensionality != {"[time]": -1}:
        return value
    return value * (2 * math.pi) ** (_has_angle(target) - _has_angle(written))


def _has_angle(unit: Any) -> bool:
    """Whether a unit contains an angle, which pint treats as a pure number in radians."""
    return any(angle in name for name in map(str, unit._units) for angle in _ANGLES)


def _kind_of_dimension(written: Any) -> str:
    """Kind of quantity of a unit, such as "a length"."""
    if written.dimensionless:
        return "an angle" if _has_angle(written) else "a pure number"
    for unit, kind in _KINDS.items():
        if written.dimensionality == _unit(unit).dimensionality:
            return kind.split(",")[0]
    return f"in {written:~}"


@cache
def _registry() -> Any:
    """Registry of pint, made once."""
    import pint

    registry: Any = pint.UnitRegistry(cache_folder=None)
    registry.define("vickers_hardness = 9.80665e6 pascal = HV")  # kilogram-force per mm2, ISO 6507-1
    return registry


@lru_cache(1024)
def _unit(written: str) -> Any:
    """Unit of pint for a unit as users write it."""
    return _registry().Unit(canonical_unit(written))
