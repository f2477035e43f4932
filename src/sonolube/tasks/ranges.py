"""Values of keys of a rig file, each as a text such as "20kHz:24kHz:50" or as numbers in SI."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

from sonolube.design.ranges import ends_of, values_of
from sonolube.errors import InvalidInput
from sonolube.tasks.task import shown

if TYPE_CHECKING:
    from sonolube.rig import Rig

Values: TypeAlias = Mapping[str, Any]
"""By dotted key of the rig file: first:last:count, first:last:count:log, one,two,..., or numbers in SI."""


def values_by_key(over: Values) -> dict[str, Any]:
    """Values of each key: numbers in SI, or text for keys that are no quantity.

    Raises
    ------
    InvalidInput
        If a text cannot be read.
    """
    return {
        key: values_of(key, values, option=shown("over")) if isinstance(values, str) else values
        for key, values in over.items()
    }


def ends_by_key(over: Values) -> dict[str, tuple[float, float]]:
    """Lowest and highest value of each key, in SI.

    Raises
    ------
    InvalidInput
        If a text cannot be read, or there are not two numbers.
    """
    return {key: _ends(key, values) for key, values in over.items()}


def refuse_replaced(rig: "Rig", over: Values) -> None:
    """Refuse a key of which the rig has an entry that was replaced when it was read.

    Raises
    ------
    InvalidInput
        For the first such key.
    """
    for key in (change.partition("=")[0].strip() for change in rig.changes):
        if key in over:
            raise InvalidInput(f"--set {key}: takes the values of {shown('over')} {key}; give it once")


def _ends(key: str, values: Any) -> tuple[float, float]:
    """Lowest and highest value of a key, as text or as numbers in SI."""
    if isinstance(values, str):
        return ends_of(key, values, option=shown("over"))
    import numpy as np

    numbers = np.asarray(values, float).ravel()
    if numbers.size != 2:
        raise InvalidInput(f"{shown('over')} {key}: points are drawn between two ends, got {numbers.size} numbers")
    return float(numbers[0]), float(numbers[1])
