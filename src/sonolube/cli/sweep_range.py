"""From words such as drive.frequency=20kHz:24kHz:50 to a key and its values."""

import numpy as np
from numpy.typing import NDArray

from sonolube.errors import InvalidInput
from sonolube.units import to_si
from sonolube.vocabulary import quantities


def values_of(over: list[str]) -> dict[str, NDArray[np.float64] | NDArray[np.str_]]:
    """Return the values of each key.

    Raises
    ------
    InvalidInput
        If the words cannot be read.
    """
    return {key: _values(key, text) for key, text in _keys(over).items()}


def ends_of(over: list[str]) -> dict[str, tuple[float, float]]:
    """Return the lowest and the highest value of each key.

    Raises
    ------
    InvalidInput
        If the words cannot be read.
    """
    ends = {}
    for key, text in _keys(over).items():
        parts = text.split(":")
        if len(parts) != 2:
            raise InvalidInput(f"--over {key}={text}: points are drawn between two ends, such as {key}=first:last")
        ends[key] = (_number(key, parts[0]), _number(key, parts[1]))
    return ends


def _keys(over: list[str]) -> dict[str, str]:
    found: dict[str, str] = {}
    for words in over:
        key, equals, text = (part.strip() for part in words.partition("="))
        if not (key and equals and text):
            raise InvalidInput(f"--over {words!r} must look like drive.frequency=20kHz:24kHz:50")
        if key in found:
            raise InvalidInput(f"--over {key} was given twice")
        found[key] = text
    return found


def _values(key: str, text: str) -> NDArray[np.float64] | NDArray[np.str_]:
    if ":" not in text:
        words = [word.strip() for word in text.split(",")]
        if key.rpartition(".")[2] not in quantities():
            return np.array(words, dtype=np.str_)
        return np.array([_number(key, word) for word in words])
    first, last, *rest = text.split(":")
    if not 1 <= len(rest) <= 2 or not rest[0].strip().isdecimal() or rest[1:] not in ([], ["log"]):
        raise InvalidInput(f"--over {key}={text} must look like {key}=first:last:count, with :log for even ratios")
    low, high, count = _number(key, first), _number(key, last), int(rest[0])
    if count < 2 or low >= high or (rest[1:] and low <= 0):
        demand = ", the first above 0" if rest[1:] else ""
        raise InvalidInput(f"--over {key}={text}: needs at least 2 values that rise{demand}")
    return np.geomspace(low, high, count) if rest[1:] else np.linspace(low, high, count)


def _number(key: str, text: str) -> float:
    name = key.rpartition(".")[2]
    if name not in quantities():
        raise InvalidInput(f"--over {key}: no quantity, and so without a range; list its values, such as {key}=one,two")
    return to_si(text.strip(), unit=quantities()[name].unit, name=f"--over {key}")
