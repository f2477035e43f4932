"""Quantities and texts of a record of results, those of records within it included."""

from dataclasses import fields, is_dataclass
from math import isnan
from typing import Any

from sonolube.vocabulary import quantities


def result_quantities(record: Any) -> dict[str, float | None]:
    """Fields of a record that are quantities of the vocabulary, in SI.

    Parameters
    ----------
    record : dataclass
        Such as a `Simulation`, with the records of friction and wear within it.

    Returns
    -------
    dict of str to float or None
        None for values outside the range of a model; fields that are not known are left out.
    """
    known = quantities()
    return {
        name: None if isnan(value) else value
        for name, value in _flat(record).items()
        if name in known and isinstance(value, int | float)
    }


def result_texts(record: Any) -> dict[str, str]:
    """Fields of a record that are text, such as the friction model."""
    return {name: value for name, value in _flat(record).items() if isinstance(value, str)}


def _flat(record: Any) -> dict[str, Any]:
    """Fields of a record by name, and those of records within it; of one name the outermost."""
    own = {each.name: getattr(record, each.name) for each in fields(record)}
    values: dict[str, Any] = {}
    for value in own.values():
        values |= _flat(value) if is_dataclass(value) else {}
    return values | {name: value for name, value in own.items() if not is_dataclass(value)}
