"""Printed numbers: digits with their rounding interval, stated scatter or stated range, converted to SI."""

import re
import tomllib
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from typing import Any

from sonolube.errors import InvalidInput
from sonolube.text.units import convert
from sonolube.vocabulary import unit_of


@cache
def published_content(*path: str) -> dict[str, Any]:
    """Content of a TOML file of this package."""
    return tomllib.loads(files("sonolube.facts.published").joinpath(*path).read_text(encoding="utf-8"))


_DIGITS = r"(?:\d+(?:\.\d*)?|\.\d+)(?:e[-+]?\d+)?"
_PRINTED = re.compile(rf"(?P<first>[-+]?{_DIGITS})(?:±(?P<scatter>{_DIGITS})|-(?P<last>{_DIGITS}))?")


@dataclass(frozen=True, kw_only=True, slots=True)
class PrintedNumber:
    """Number as printed, with the interval that the print leaves open; in SI.

    Parameters
    ----------
    text : str
        Printed digits, such as "2.237", "1.024±0.063" or "10.73-13.02".
    value : float
        Value; of a range, its midpoint.
    low, high : float
        Limits of the stated range or scatter; where neither is stated, of the rounding interval.
    rounding_half_width : float
        Half-width of the rounding interval, half a unit of the last printed digit; of a range, that of the limit with
        more digits.
    """

    text: str
    value: float
    low: float
    high: float
    rounding_half_width: float

    def limits(self) -> "tuple[PrintedNumber, PrintedNumber]":
        """Lower and the upper limit of a printed range as numbers with their rounding intervals."""
        h = self.rounding_half_width
        low, high = (replace(self, value=limit, low=limit - h, high=limit + h) for limit in (self.low, self.high))
        return low, high


def parse_printed(text: str, unit: str = "", scale: float = 1.0, *, quantity: str = "") -> PrintedNumber:
    """Printed number with its interval, in SI.

    Parameters
    ----------
    text : str
        One number, "mean±scatter" or "low-high"; powers of ten as in "3.17e8".
    unit : str
        Printed unit, such as "mm/s" or "%".
    scale : float
        Power of ten that a table heading puts before the unit.
    quantity : str
        Quantity by its name in the vocabulary; empty for a pure number.

    Returns
    -------
    PrintedNumber

    Raises
    ------
    InvalidInput
        If the text has another form, the limits of a range are in falling order, or the unit is not one of the
        quantity.

    Examples
    --------
    >>> from sonolube.facts.published import parse_printed
    >>> speed = parse_printed("20.3", "mm/s", quantity="sliding_speed")
    >>> round(speed.low, 6), round(speed.high, 6)
    (0.02025, 0.02035)
    """
    match = _PRINTED.fullmatch(text)
    if match is None:
        raise InvalidInput(f"{text!r} is not a printed number; write one such as '2.237', '1.33±0.1' or '25-48'")
    first = float(match["first"])
    half_width = _rounding_half_width(match["first"])
    if match["last"]:
        low, high = first, float(match["last"])
        half_width = min(half_width, _rounding_half_width(match["last"]))
    else:
        scatter = float(match["scatter"]) if match["scatter"] else half_width
        low, high = first - scatter, first + scatter
    if low > high:
        raise InvalidInput(f"{text!r} is a range in falling order; write the smaller limit first")
    factor, origin = _conversion(unit, unit_of(quantity))
    step = factor * scale
    return PrintedNumber(
        text=text,
        value=origin + step * ((low + high) / 2 if match["last"] else first),
        low=origin + step * low,
        high=origin + step * high,
        rounding_half_width=step * half_width,
    )


def _rounding_half_width(digits: str) -> float:
    """Half a unit of the last digit of a number in decimal or exponential notation."""
    mantissa, _, exponent = digits.partition("e")
    decimals = len(mantissa.partition(".")[2])
    return float(f"5e{int(exponent or 0) - decimals - 1}")


@cache
def _conversion(unit: str, si_unit: str) -> tuple[float, float]:
    """Factor and origin of a unit in its SI unit, such as (1, 273.15) for degC in K."""
    if unit == si_unit:
        return 1.0, 0.0
    origin = convert(0.0, from_unit=unit, to_unit=si_unit)
    return convert(1.0, from_unit=unit, to_unit=si_unit) - origin, origin
