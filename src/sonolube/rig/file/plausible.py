"""Plausible magnitudes of the quantities of a rig, by SI unit, to refuse slips of the pen."""

from collections.abc import Mapping
from types import MappingProxyType

from sonolube.errors import InvalidInput
from sonolube.text.units import format_si, to_si

LIMITS: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "": (1e-9, 1e2),
        "m": (1e-12, 1e3),
        "m2": (1e-18, 1e4),
        "1/m2": (1.0, 1e20),
        "kg": (1e-12, 1e6),
        "N": (1e-12, 1e9),
        "Pa": (1.0, 1e13),
        "m/s": (1e-12, 1e4),
        "Hz": (1e-3, 1e9),
        "s": (1e-12, 1e8),
        "rad": (1e-12, 1e3),
        "V": (1e-9, 1e6),
        "F": (1e-15, 1.0),
        "m/V": (1e-18, 1e-2),
        "N/m": (1e-6, 1e15),
        "N s/m": (1e-9, 1e12),
        "W": (1e-12, 1e6),
        "W/K": (1e-9, 1e6),
        "J/K": (1e-9, 1e9),
    }
)
"""Least and largest magnitude of what is not zero, by SI unit."""

DECAY_LENGTHS = (1e-10, 1e-3)
"""Shortest and longest decay length of a contact force. [m]"""

_ANY_UNIT = (1e-30, 1e30)


def plausible_si(text: str, *, unit: str, name: str) -> float:
    """Number in SI that a command's option stands for, where a rig can have it."""
    return require_plausible(to_si(text, unit=unit, name=name), unit=unit, text=f"{name} {text}")


def require_plausible(value: float, *, unit: str, text: str) -> float:
    """Value in SI, or refuse it where its magnitude lies beyond any rig."""
    least, largest = LIMITS.get(unit, _ANY_UNIT)
    if value and (abs(value) < least or abs(value) > largest):  # what is no number is for others as well
        bounds = " to ".join(format_si(bound, unit) for bound in (least, largest))
        raise InvalidInput(f"{text} lies beyond any rig: expected {bounds}")
    return float(value)
