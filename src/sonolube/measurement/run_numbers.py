"""Numbers in cells of tables of runs: thousands, parts, uncertainties and units beside them, and their digits."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import sqrt
from pathlib import Path
from typing import Final

from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import parse_number

OF_A_DIGIT: Final = 0.5 / sqrt(3)
"""Standard uncertainty of a rounded number over its last digit: half a digit to either side, uniform."""

_PLAIN: Final = re.compile(r"[-+]?\d*[.,]?\d*(?:[eE][-+]?\d+)?")
_BETWEEN: Final = "'’\u202f\u00a0\u2009 "  # thousands, as in Switzerland and by the SI
_GROUPS: Final = re.compile(rf"([-+]?\d{{1,3}}(?:[{_BETWEEN}]\d{{3}})+)(?![\d{_BETWEEN}])((?:[.,]\d+)?)")
_NUMBER: Final = rf"[-+]?(?:\d[\d.,{_BETWEEN}]*|[.,]\d+)(?:[eE][-+]?\d+)?"
_WITH_MORE: Final = re.compile(
    rf"\(?\s*(?P<number>{_NUMBER})(?:\s*(?:±|\+\s?/?\s?-)\s*(?P<error>{_NUMBER})|\((?P<last>\d{{1,3}})\))?\s*\)?\s*"
    r"(?P<unit>[%‰°µμA-Za-z][^;]{0,19})?"
)
_LONGEST_EXPONENT: Final = 4  # characters, of a number that any run has
_THOUSANDS: Final = re.compile(r"[-+]?[1-9]\d{0,2}[.,]\d{3}")
_TWO_MARKS: Final = re.compile(r"[-+]?\d{1,3}([.,])\d{3}(?:\1\d{3})+")
_MARKED: Final = re.compile(r"[-+]?\d*[.,]\d*(?:[eE][-+]?\d+)?")


@dataclass(frozen=True, slots=True)
class CellNumber:
    """Number in a cell.

    Parameters
    ----------
    value : float
    digit : float
        Worth of the last digit that is written.
    uncertainty : float
        Stated behind it; NaN where none is.
    unit : str
        Stated behind it; empty where none is.
    """

    value: float
    digit: float
    uncertainty: float = float("nan")
    unit: str = ""


@lru_cache(maxsize=4096)  # cells of a setting are often the same
def cell_number(cell: str, *, sign: str) -> CellNumber | None:
    """Number of a cell with the decimal sign of its table; None where it holds none."""
    plain = _plain_number(cell, sign)
    if plain is not None:
        return CellNumber(plain, _digit(cell, sign))
    found = _WITH_MORE.fullmatch(cell.replace("\u2212", "-").strip())
    if found is None:
        return None
    number, error, last = found["number"].strip(), found["error"], found["last"]
    value, deviation = _plain_number(number, sign), float("nan")
    if value is None:
        return None
    if error is not None:
        stated = _plain_number(error.strip(), sign)
        if stated is None:
            return None
        deviation = stated
    elif last is not None:
        deviation = int(last) * _digit(number, sign)
    return CellNumber(value, _digit(number, sign), deviation, (found["unit"] or "").strip())


def _plain_number(text: str, sign: str) -> float | None:
    """Number without anything behind it, its thousands separated or not."""
    value = parse_number(text, decimal_sign=sign)
    if value is not None:
        return value
    joined = _without_thousands(text, sign)
    return None if joined is None else parse_number(joined, decimal_sign=sign)


def _without_thousands(text: str, sign: str) -> str | None:
    """Number without what separates its thousands, which is not its decimal sign; None where nothing does."""
    other = {".": ",", ",": "."}[sign]
    if re.fullmatch(rf"[-+]?\d{{1,3}}(?:\{other}\d{{3}})+(?:\{sign}\d+)?", text):
        return text.replace(other, "")
    if found := _GROUPS.fullmatch(text):
        return re.sub(rf"[{_BETWEEN}]", "", found[1]) + found[2]
    return None


def _digit(text: str, sign: str) -> float:
    """Worth of the last digit of a number; zero for what is none, such as nan."""
    joined = _without_thousands(text, sign) or text.strip()
    mantissa, _, exponent = joined.lower().partition("e")
    if not _PLAIN.fullmatch(joined) or len(exponent) > _LONGEST_EXPONENT:
        return 0.0
    return float(f"1e{int(exponent or 0) - len(mantissa.partition(sign)[2])}")


def decimal_sign_of(cells: Sequence[str], path: Path) -> str:
    """Decimal sign of the numbers of a table; refuse a mark that may as well separate thousands.

    A mark before other than three digits, or behind a zero, is a decimal sign.
    """
    numbers = [found["number"].strip() for cell in cells if (found := _WITH_MORE.fullmatch(cell.strip()))]
    marked = [number for number in numbers if "," in number or "." in number]
    sure = [number for number in marked if _MARKED.fullmatch(number) and not _THOUSANDS.fullmatch(number)]
    if sure:
        commas = sum("," in number for number in sure)
        return "," if 2 * commas > len(sure) else "."
    both = next((number for number in marked if "," in number and "." in number), None)
    if both is not None:
        return max(",.", key=both.rfind)
    if twice := next((found[1] for number in marked if (found := _TWO_MARKS.fullmatch(number))), None):
        return {".": ",", ",": "."}[twice]
    if first := next(filter(_THOUSANDS.fullmatch, marked), None):
        small, large = float(first.replace(",", ".")), re.sub(r"\D", "", first)
        raise InvalidInput(
            f"{path}: {first!r} may be {small:g} or {large}: each number with a mark has three digits behind it;"
            " state the decimal sign: sonolube mapping FILE --decimal-sign ',' (or '.'), or write one of them with"
            " other digits"
        )
    return "."
