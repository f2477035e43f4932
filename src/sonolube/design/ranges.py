"""Ranges and lists of values of a key of a rig file, such as 20kHz:24kHz:50."""

import re
from typing import TYPE_CHECKING

from sonolube.errors import InvalidInput
from sonolube.text.units import to_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Values = NDArray[np.float64] | NDArray[np.str_]

_COUNT = re.compile(r"\d{1,18}")


def values_of(key: str, text: str, *, option: str = "over") -> "Values":
    """Values of a key of a rig file: first:last:count, first:last:count:log or one,two,; numbers in SI, or text."""
    import numpy as np

    if ":" not in text:
        items = [item.strip() for item in text.split(",")]
        if key.rpartition(".")[2] not in quantities():
            return np.array(items, dtype=np.str_)
        return np.array([_number(key, item, option) for item in items])
    first, last, *rest = text.split(":")
    if not 1 <= len(rest) <= 2 or not _COUNT.fullmatch(rest[0].strip()) or rest[1:] not in ([], ["log"]):
        raise InvalidInput(f"{option} {key}={text} must look like {key}=first:last:count, with :log for even ratios")
    low, high, count = _number(key, first, option), _number(key, last, option), int(rest[0])
    if count < 2 or low >= high or (rest[1:] and low <= 0):
        demand = ", the first above 0" if rest[1:] else ""
        raise InvalidInput(f"{option} {key}={text}: needs at least 2 values that rise{demand}")
    return np.geomspace(low, high, count) if rest[1:] else np.linspace(low, high, count)


def ends_of(key: str, text: str, *, option: str = "over") -> tuple[float, float]:
    """Lowest and highest value of a key of a rig file: first:last; in SI."""
    parts = text.split(":")
    if len(parts) != 2:
        raise InvalidInput(f"{option} {key}={text}: points are drawn between two ends, such as {key}=first:last")
    return _number(key, parts[0], option), _number(key, parts[1], option)


def _number(key: str, text: str, option: str) -> float:
    """Number of a quantity in SI."""
    name = key.rpartition(".")[2]
    if name not in quantities():
        raise InvalidInput(
            f"{option} {key}: no quantity, and so without a range; list its values, such as {key}=one,two"
        )
    return to_si(text.strip(), unit=quantities()[name].unit, name=f"{option} {key}")
