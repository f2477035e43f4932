"""Reading of KEY=VALUES options, such as drive.frequency=20kHz:24kHz:50: keys of a rig file with their values."""

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from sonolube.errors import InvalidInput
from sonolube.units import to_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Values = NDArray[np.float64] | NDArray[np.str_]


_COUNT = re.compile(r"\d{1,18}")


def values_by_key(entries: Sequence[str] | None) -> "dict[str, Values]":
    """Values of each key of entries `KEY=first:last:count`, `KEY=first:last:count:log` or `KEY=one,two,...`.

    Parameters
    ----------
    entries : sequence of str or None
        As given by `--over`; None for none.

    Returns
    -------
    dict of str to ndarray
        Numbers in SI, or text for keys that are no quantity.

    Raises
    ------
    InvalidInput
        If an entry cannot be read.
    """
    return {key: _values(key, text) for key, text in _texts_by_key(entries).items()}


def ends_by_key(entries: Sequence[str] | None) -> dict[str, tuple[float, float]]:
    """Lowest and highest value of each key of entries `KEY=first:last`, in SI.

    Parameters
    ----------
    entries : sequence of str or None
        As given by `--over`; None for none.

    Returns
    -------
    dict of str to (float, float)

    Raises
    ------
    InvalidInput
        If an entry cannot be read.
    """
    ends = {}
    for key, text in _texts_by_key(entries).items():
        parts = text.split(":")
        if len(parts) != 2:
            raise InvalidInput(f"--over {key}={text}: points are drawn between two ends, such as {key}=first:last")
        ends[key] = (_number(key, parts[0]), _number(key, parts[1]))
    return ends


def _texts_by_key(entries: Sequence[str] | None) -> dict[str, str]:
    """Text behind the equals sign of each entry, by key."""
    texts: dict[str, str] = {}
    for entry in entries or ():
        key, equals, text = (part.strip() for part in entry.partition("="))
        if not (key and equals and text):
            raise InvalidInput(f"--over {entry!r} must look like drive.frequency=20kHz:24kHz:50")
        if key in texts:
            raise InvalidInput(f"--over {key} was given twice")
        texts[key] = text
    return texts


def _values(key: str, text: str) -> "Values":
    """Values of a range or of a list."""
    import numpy as np

    if ":" not in text:
        items = [item.strip() for item in text.split(",")]
        if key.rpartition(".")[2] not in quantities():
            return np.array(items, dtype=np.str_)
        return np.array([_number(key, item) for item in items])
    first, last, *rest = text.split(":")
    if not 1 <= len(rest) <= 2 or not _COUNT.fullmatch(rest[0].strip()) or rest[1:] not in ([], ["log"]):
        raise InvalidInput(f"--over {key}={text} must look like {key}=first:last:count, with :log for even ratios")
    low, high, count = _number(key, first), _number(key, last), int(rest[0])
    if count < 2 or low >= high or (rest[1:] and low <= 0):
        demand = ", the first above 0" if rest[1:] else ""
        raise InvalidInput(f"--over {key}={text}: needs at least 2 values that rise{demand}")
    return np.geomspace(low, high, count) if rest[1:] else np.linspace(low, high, count)


def _number(key: str, text: str) -> float:
    """Number of a quantity in SI."""
    name = key.rpartition(".")[2]
    if name not in quantities():
        raise InvalidInput(f"--over {key}: no quantity, and so without a range; list its values, such as {key}=one,two")
    return to_si(text.strip(), unit=quantities()[name].unit, name=f"--over {key}")
