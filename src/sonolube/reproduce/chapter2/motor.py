"""Chapter 2, the motor of the welder rig: what its current and its jump in speed say of friction, section 2.4.

Voltage, and current and speed without and with vibration, tell resistance and torque constant of a motor, gear
included. Both tests ran the same motor, and give the same constant to a quarter of a per cent, though their
resistances differ by a fifth, as brushes do. Each row takes the constant from the other test.

What stays free is the torque that bearings and brushes take: it is taken to be the same before and after the jump.
"""

from collections.abc import Iterator
from itertools import chain
from math import pi
from typing import Final

from sonolube.metrics import (
    DCMotor,
    friction_from_current,
    motor_current_under_friction,
    motor_from_two_operating_points,
    motor_speed,
)
from sonolube.published import PrintedNumber
from sonolube.published.values import cell, stated
from sonolube.reproduce.row import Row, compare
from sonolube.validation.inputs import exact, in_table, named, said

_TIPS: Final = ("round", "flat")


def rows() -> Iterator[Row]:
    """Yield the rows of the motor."""
    return chain.from_iterable(_of_tip(tip) for tip in range(len(_TIPS)))


def welder_motor(tip: int) -> DCMotor:
    """Return the motor as one test shows it: 0 with the round tip, 1 with the flat one."""
    return motor_from_two_operating_points(
        motor_voltage=said("2.4.2-motor-voltage").value,
        motor_current=[current.value for current in _currents(tip)],
        rotation_speed=[in_table("2.8", "rotation_speed", 2 * tip + on).value for on in (0, 1)],
    )


def drop_by_current(tip: int) -> float:
    """Return the drop of friction that the drop of the current means. [N]"""
    before, after = _currents(tip)
    return float(
        friction_from_current(
            torque_constant=welder_motor(1 - tip).torque_constant,
            motor_current=before.value,
            idle_current=after.value,
            groove_diameter=_groove(tip),
        )
    )


def _of_tip(tip: int) -> Iterator[Row]:
    name, other = _TIPS[tip], _TIPS[1 - tip]
    before, _ = _currents(tip)
    still, vibrating = (
        in_table("2.9", f"{state}_friction_force", tip).value for state in ("intrinsic", "reduced")
    )  # middles of the ranges
    constant = welder_motor(1 - tip).torque_constant
    speed = in_table("2.8", "rotation_speed", 2 * tip).value
    voltage = said("2.4.2-motor-voltage").value
    loaded = DCMotor(
        motor_voltage=voltage,
        torque_constant=constant,
        resistance=(voltage - constant * 2 * pi * speed) / before.value,
    )
    current = float(
        motor_current_under_friction(
            loaded, friction_force=vibrating - still, idle_current=before.value, groove_diameter=_groove(tip)
        )
    )
    note = f"DC motor at {voltage:g} V, {constant:.3f} N m/A at the disc from the test with the {other} tip; "
    fall = f"friction falls by {still - vibrating:.2f} N (middles of Table 2.9)."
    yield compare(
        named(stated("2.4.2-rotation-on"), f"{name}-motor"),
        float(motor_speed(loaded, motor_current=current)),
        note + fall,
    )
    yield compare(named(stated("2.4.4-current-drop"), f"{name}-motor"), before.value - current, note + fall)
    drop = drop_by_current(tip)
    yield compare(
        named(cell("2.9", "friction_reduction", tip), "motor"),
        drop / still,
        f"{note}the drop of the current takes {drop:.2f} N of {still:.2f} N.",
    )


def _currents(tip: int) -> tuple[PrintedNumber, PrintedNumber]:
    before, after = (exact(in_table("2.9", f"{state}_motor_current", tip)) for state in ("intrinsic", "reduced"))
    return before, after


def _groove(tip: int) -> float:
    return in_table("2.8", "groove_diameter", 2 * tip).value
