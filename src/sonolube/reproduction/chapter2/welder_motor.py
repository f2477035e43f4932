"""Section 2.4, the motor of the welder rig: rows of the changes of speed, current and friction by its characteristic.

Voltage, and current and speed without and with vibration, determine resistance and torque constant of a DC motor, gear
included. Both tests ran the same motor, and yield the same constant to a quarter of a per cent, although their
resistances differ by a fifth, as those of brushes do. Each row takes the constant from the other test.

The torque of bearings and brushes remains free: it is assumed to be equal before and after the change of speed.
"""

from collections.abc import Iterator
from math import pi
from typing import Final

from sonolube.facts import metrics
from sonolube.facts.published import si_value
from sonolube.reproduction.chapter2.welder import printed_forces
from sonolube.reproduction.row import Row, default_model_row

_TIPS: Final = {1: "round", 2: "flat"}
"""Tips by their rows in Table 2.9."""


def welder_motor_rows() -> Iterator[Row]:
    """Yield the rows of the motor."""
    for tip in _TIPS:
        yield from _rows_of_tip(tip)


def welder_motor(tip: int) -> metrics.DCMotor:
    """Motor identified from the test with a tip: 1 round, 2 flat."""
    return metrics.motor_from_two_operating_points(
        motor_voltage=si_value("2.4.2-motor-voltage"),
        motor_current=list(_currents(tip)),
        rotation_speed=[si_value(f"table-2.8-rotation_speed-{row}") for row in (2 * tip - 1, 2 * tip)],
    )


def friction_drop_from_current(tip: int) -> float:
    """Drop of friction that corresponds to the drop of the current with a tip. [N]"""
    off, on = _currents(tip)
    return float(
        metrics.friction_from_current(
            torque_constant=welder_motor(3 - tip).torque_constant,
            motor_current=off,
            idle_current=on,
            groove_diameter=_groove_diameter(tip),
        )
    )


def _rows_of_tip(tip: int) -> Iterator[Row]:
    """Yield rotation speed and current drop from the drop of friction, and friction reduction from that of current."""
    name, other = _TIPS[tip], 3 - tip
    current, _ = _currents(tip)
    off, on = (number.value for number in printed_forces(tip))
    voltage, constant = si_value("2.4.2-motor-voltage"), welder_motor(other).torque_constant
    speed = si_value(f"table-2.8-rotation_speed-{2 * tip - 1}")
    motor = metrics.DCMotor(
        motor_voltage=voltage, torque_constant=constant, resistance=(voltage - constant * 2 * pi * speed) / current
    )
    reduced_current = float(
        metrics.motor_current_under_friction(
            motor, friction_force=on - off, idle_current=current, groove_diameter=_groove_diameter(tip)
        )
    )
    note = f"DC motor at {voltage:g} V, {constant:.3f} N m/A at the disc from the test with the {_TIPS[other]} tip; "
    fall = f"friction falls by {off - on:.2f} N (middles of Table 2.9)."
    reduced_speed = float(metrics.motor_speed(motor, motor_current=reduced_current))
    yield default_model_row("2.4.2-rotation-on", reduced_speed, note + fall, suffix=f"{name}-motor")
    yield default_model_row("2.4.4-current-drop", current - reduced_current, note + fall, suffix=f"{name}-motor")
    drop = friction_drop_from_current(tip)
    note = f"{note}the drop of the current corresponds to {drop:.2f} N of {off:.2f} N."
    yield default_model_row(f"table-2.9-friction_reduction-{tip}", drop / off, note, suffix="motor")


def _currents(tip: int) -> tuple[float, float]:
    """Motor current without and with vibration. [A]"""
    off, on = (si_value(f"table-2.9-{state}_motor_current-{tip}") for state in ("intrinsic", "reduced"))
    return off, on


def _groove_diameter(tip: int) -> float:
    """Groove diameter of the test with a tip. [m]"""
    return si_value(f"table-2.8-groove_diameter-{2 * tip - 1}")
