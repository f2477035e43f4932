"""Numbers with the digits that their interval leaves a meaning."""

import math
from decimal import ROUND_CEILING, ROUND_FLOOR, ROUND_HALF_EVEN, Decimal

_FEWEST = 2  # significant digits of the value and of its ends
_MOST = 10  # significant digits of the value
_WITHOUT = 4  # significant digits where an interval has no width
_LEADING = 1.5  # half width in steps of the last digit, at least
_TINY = 1e-4  # of the value: an end that is zero to any digit of the value
_EXACT = 13  # significant digits that the conversion of a unit keeps


def interval_texts(value: float, lower: float, upper: float) -> tuple[str, str, str]:
    """Value and both ends of its interval as text, to one digit of the narrower half of the interval.

    All three have the same decimals, the value at least two significant digits. Ends are rounded outwards, so that what
    the interval holds stays within it; one that is not finite stands as it is, and one of another size than the value
    has digits of its own.

    Examples
    --------
    >>> from sonolube.text.intervals import interval_texts
    >>> interval_texts(19999.982, 19999.966, 19999.998), interval_texts(0.42, 0.3123, 0.5321)
    (('19999.98', '19999.96', '20000.00'), ('0.42', '0.31', '0.54'))
    """
    halves = [half for half in (value - lower, upper - value) if 0 < half < math.inf]
    if not halves or not math.isfinite(value):
        return f"{value:.{_WITHOUT}g}", f"{lower:.{_WITHOUT}g}", f"{upper:.{_WITHOUT}g}"
    decimals = -math.floor(math.log10(min(halves) / _LEADING))
    if value:
        decimals = min(max(decimals, _decimals(value, _FEWEST)), _decimals(value, _MOST))
    return (
        _fixed(value, decimals, ROUND_HALF_EVEN),
        _end(lower, decimals, value, ROUND_FLOOR),
        _end(upper, decimals, value, ROUND_CEILING),
    )


def _decimals(number: float, digits: int) -> int:
    """Decimals that give a number so many significant digits."""
    return digits - 1 - math.floor(math.log10(abs(number)))


def _end(end: float, decimals: int, value: float, rounding: str) -> str:
    """End of an interval, to the decimals of its value where both are of one size."""
    if not math.isfinite(end) or not end or not value:
        return f"{end:.{_WITHOUT}g}" if not math.isfinite(end) or not end else _fixed(end, decimals, rounding)
    if abs(end) < _TINY * abs(value):
        return f"{end:.{_FEWEST}g}"
    own = _decimals(end, _FEWEST)
    return _fixed(end, min(decimals, own) if abs(end) > 10 * abs(value) else max(decimals, own), rounding)


def _fixed(number: float, decimals: int, rounding: str) -> str:
    """Number with fixed decimals, or rounded to tens, hundreds and so on."""
    written = Decimal(f"{number:.{_EXACT - 1}e}")
    return f"{written.quantize(Decimal(1).scaleb(-decimals), rounding=rounding):f}"
