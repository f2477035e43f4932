"""Values of a factor of a plan, typed as a range or a list with one unit, such as 20:200 mm/s or 3,5,7 N."""

import re
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.text.units import to_si

MAX_VALUES: Final = 200
"""Number of values of one factor."""

_NUMBER: Final = re.compile(r"[-+.\deE]+")
_DIGITS: Final = 3  # of values between the ends of a range, so that they can be set


def factor_values(text: str, *, unit: str, option: str, count: int) -> Floats:
    """Values of a factor in SI, rising."""
    return _range(text, unit, option, count) if ":" in text else _listed(text, unit, option)


def _range(text: str, unit: str, option: str, count: int) -> Floats:
    """Values in equal ratios between two ends."""
    parts = [part.strip() for part in text.split(":")]
    number = _split_unit(parts[-1])[0]
    if len(parts) == 3:
        if not number.isdigit():
            raise InvalidInput(f"{option} {text}: the third part is a number of values, such as 20:200:7mm/s")
        if not 2 <= int(number[:9]) <= MAX_VALUES:
            raise InvalidInput(f"{option} {text}: a range has 2 to {MAX_VALUES} values")
        count = int(number)
    elif len(parts) != 2:
        raise InvalidInput(f"{option} {text}: must look like first:last, first:last:count or one,two,...")
    common = _split_unit(parts[-1])[1]
    low, high = (_number(part, common, unit, option) for part in parts[:2])
    if not 0 < low < high:
        raise InvalidInput(f"{option} {text}: the first value must be above 0 and below the last")
    return np.array([float(f"{each:.{_DIGITS}g}") for each in np.geomspace(low, high, count)])


def _listed(text: str, unit: str, option: str) -> Floats:
    """Values of a list."""
    parts = [part.strip() for part in text.split(",")]
    if len(parts) > MAX_VALUES:
        raise InvalidInput(f"{option}: {len(parts)} values; at most {MAX_VALUES}")
    common = _split_unit(parts[-1])[1]
    values = np.unique([_number(part, common, unit, option) for part in parts])
    if not np.all(values > 0):
        raise InvalidInput(f"{option} {text}: values must be above 0")
    return np.asarray(values)


def _split_unit(text: str) -> tuple[str, str]:
    """Number and unit of a text."""
    found = _NUMBER.match(text)
    return (found[0], text[found.end() :].strip()) if found else ("", text)


def _number(text: str, common: str, unit: str, option: str) -> float:
    """Number in SI, with the common unit where it has none."""
    number, own = _split_unit(text)
    return to_si(f"{number} {own or common}".strip(), unit=unit, name=option)
