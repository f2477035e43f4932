"""Checks of a protocol: the value of a quantity, its source, and whether it lies within its bounds."""

from dataclasses import dataclass
from math import pi
from typing import Final

from sonolube.facts.protocol import Check, Protocol, flattened, step_at
from sonolube.text.units import format_si
from sonolube.vocabulary import unit_of

SPEED_CHANNEL: Final = "rotation_speed"
"""Channel that measures the speed of the disc."""

SETTLING: Final = 5.0
"""Time that a measured speed has to come within its bounds. [s]"""

SPEEDS: Final = ("rotation_speed", "sliding_speed")
"""Quantities that follow from the speed of the disc."""

_AS_SET: Final = f"as it is set: no channel {SPEED_CHANNEL} measures it"


@dataclass(frozen=True, kw_only=True, slots=True)
class CheckedValue:
    """Value of a checked quantity.

    Parameters
    ----------
    check : Check
    value : float or None
        In SI; None where nothing tells it.
    is_set : bool
        Whether it is the set point, which nothing measures.
    """

    check: Check
    value: float | None
    is_set: bool = False

    @property
    def holds(self) -> bool:
        """Whether it lies within the bounds."""
        low, high = self.check.bounds
        return self.value is not None and low <= self.value <= high

    @property
    def facts(self) -> dict[str, str | float]:
        """Facts that a record keeps of a check that holds."""
        assert self.value is not None
        return {"quantity": self.check.quantity, "value": self.value, **({"basis": _AS_SET} if self.is_set else {})}

    @property
    def reason(self) -> str:
        """Why it does not hold."""
        check = self.check
        bounds = f"{check.lowest or 'any'} to {check.highest or 'any'}"
        if self.value is None:
            return f"check of {check.quantity}: no channel measures it; wanted {bounds}"
        basis = f" ({_AS_SET})" if self.is_set else ""
        return f"check of {check.quantity}: {format_si(self.value, unit_of(check.quantity))}{basis}, wanted {bounds}"


def speed_of(check: Check, *, rotation_speed: float, groove_diameter: float, is_set: bool) -> CheckedValue:
    """Speed that is checked, by that of the disc."""
    slides = check.quantity == "sliding_speed"
    value = rotation_speed * pi * groove_diameter if slides else rotation_speed
    return CheckedValue(check=check, value=value, is_set=is_set)


def speed_checks(protocol: Protocol) -> tuple[str, ...]:
    """Steps that check a speed; each place once."""
    checks = {point.step: step_at(protocol, point.step) for point in flattened(protocol) if point.kind == "check"}
    return tuple(place for place, step in checks.items() if isinstance(step, Check) and step.quantity in SPEEDS)
