"""Fields of records as entries of objects for JSON."""

from math import isfinite
from typing import Any


def picked(record: object, *names: str) -> dict[str, Any]:
    """Fields of a record by name, in the order of the names."""
    return {name: getattr(record, name) for name in names}


def finite(value: float) -> float | None:
    """Value as a plain number, or None where JSON has no notation for it."""
    return float(value) if isfinite(value) else None
