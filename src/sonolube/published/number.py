"""Numbers as printed: the digits, and the range they leave open."""

import re
from dataclasses import dataclass
from functools import cache

from sonolube.errors import InvalidInput
from sonolube.units import convert
from sonolube.vocabulary import unit_of

_DIGITS = r"(?:\d+(?:\.\d*)?|\.\d+)(?:e[-+]?\d+)?"
_PRINTED = re.compile(rf"(?P<first>[-+]?{_DIGITS})(?:±(?P<scatter>{_DIGITS})|-(?P<last>{_DIGITS}))?")


@dataclass(frozen=True, kw_only=True, slots=True)
class PrintedNumber:
    """A number as printed, and what the print says about it; in SI.

    Parameters
    ----------
    text : str
        The digits, such as "2.237", "1.024±0.063" or "10.73-13.02".
    value : float
        The number; of a range, its middle.
    low, high : float
        The ends of the printed range or scatter; where neither is printed, half the last digit to either side.
    half_digit : float
        Half the last printed digit; of a range, that of its finer end.
    """

    text: str
    value: float
    low: float
    high: float
    half_digit: float


def parse_printed(text: str, unit: str = "", scale: float = 1.0, *, quantity: str = "") -> PrintedNumber:
    """Read a number as printed.

    Parameters
    ----------
    text : str
        One number, "mean±scatter" or "low-high"; powers of ten as in "3.17e8".
    unit : str
        The unit it is printed in, such as "mm/s" or "%".
    scale : float
        Power of ten that a heading puts before the unit.
    quantity : str
        What it is a number of, by its name in the vocabulary; empty for a pure number.

    Returns
    -------
    PrintedNumber

    Raises
    ------
    InvalidInput
        If the text is no such number, a range falls, or the unit is not one of the quantity.
    """
    match = _PRINTED.fullmatch(text)
    if match is None:
        raise InvalidInput(f"{text!r} is not a printed number; wanted one such as '2.237', '1.33±0.1' or '25-48'")
    first = float(match["first"])
    half_digit = _half_digit(match["first"])
    if match["last"]:
        low, high = first, float(match["last"])
        half_digit = min(half_digit, _half_digit(match["last"]))
    else:
        spread = float(match["scatter"]) if match["scatter"] else half_digit
        low, high = first - spread, first + spread
    if low > high:
        raise InvalidInput(f"{text!r} runs from the larger number to the smaller")
    factor, origin = _to_si(unit, unit_of(quantity))
    step = factor * scale
    return PrintedNumber(
        text=text,
        value=origin + step * ((low + high) / 2 if match["last"] else first),
        low=origin + step * low,
        high=origin + step * high,
        half_digit=step * half_digit,
    )


def _half_digit(digits: str) -> float:
    mantissa, _, exponent = digits.partition("e")
    decimals = len(mantissa.partition(".")[2])
    return float(f"5e{int(exponent or 0) - decimals - 1}")


@cache
def _to_si(unit: str, si_unit: str) -> tuple[float, float]:
    """Return factor and origin of a unit, such as (1, 273.15) for degC in K."""
    if unit == si_unit:
        return 1.0, 0.0
    origin = convert(0.0, from_unit=unit, to_unit=si_unit)
    return convert(1.0, from_unit=unit, to_unit=si_unit) - origin, origin
