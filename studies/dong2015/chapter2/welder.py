"""Sections 2.4 and 2.5: rows of high stress and speed on the welder rig and of its motor, and of pairs of materials.

Voltage, and current and speed without and with vibration, determine resistance and torque constant of a DC motor, gear
included. Both tests ran the same motor, and yield the same constant to a quarter of a per cent, although their
resistances differ by a fifth, as those of brushes do. Each row takes the constant from the other test.

The torque of bearings and brushes remains free: it is assumed to be equal before and after the change of speed.
"""

from collections.abc import Iterator
from math import pi
from operator import mul, sub, truediv
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from dong2015 import formulas
from dong2015.chapter2.tribometer import reductions_of_table_2_3, wear_reductions
from dong2015.plots import report_figure, single_axes
from dong2015.row import Row, default_model_row, formula_row, published_formula_row, range_rows, undetermined_row
from sonolube.facts import metrics
from sonolube.facts.published import (
    ComputedValue,
    PrintedNumber,
    as_exact,
    as_setting,
    propagate_rounding,
    published_number,
    si_value,
    table,
)
from sonolube.figure import COLOURS, ReportFigure
from sonolube.models.contact import SphereOnFlat, hertz_mean_pressure, hertz_peak_pressure, tip_radius_for_pressure
from sonolube.validation.contacts import poisson_contact

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_ROUND_TIP: Final = 1  # first row of either tip in Table 2.8
_FLAT_TIP: Final = 3


def welder_rows() -> Iterator[Row]:
    """Yield the rows of section 2.4."""
    yield from _stresses()
    yield _peak_stress()
    yield from _motion()
    yield from _friction()
    yield from _current_drops()
    yield from _wear()


def welder_friction_reductions(tip: int) -> list[ComputedValue]:
    """Reductions of the lower and of the upper forces of a tip, row 1 or 2 of Table 2.9. []"""
    limits = zip(*(number.limits() for number in printed_forces(tip)), strict=True)
    return [propagate_rounding(formulas.friction_reduction, *pair) for pair in limits]


def printed_forces(tip: int) -> tuple[PrintedNumber, PrintedNumber]:
    """Friction without and with vibration with a tip, row 1 or 2 of Table 2.9."""
    off, on = (published_number(f"table-2.9-{state}_friction_force-{tip}") for state in ("intrinsic", "reduced"))
    return off, on


def _stresses() -> Iterator[Row]:
    """Yield the nominal stresses from load and contact areas before and after the test."""
    (round_worn, round_new), (flat_worn, flat_new) = _stress_range(_ROUND_TIP), _stress_range(_FLAT_TIP)
    for published, worn, new in (
        ("table-2.8-nominal_pressure-1", round_worn, round_new),
        ("table-2.8-nominal_pressure-3", flat_worn, flat_new),
        ("2.4.2-round-stress", round_worn, round_new),
    ):
        note = "Load over contact area; the worn area is the larger, and its stress the lower."
        yield from range_rows(published, worn, new, note)
    yield published_formula_row("2.4.2-flat-stress-before", flat_new, "Load over the area before the test.")
    yield published_formula_row("2.4.2-flat-stress-after", flat_worn, "Load over the area after the test.")
    yield published_formula_row("2.4.6-stress", round_new, "Load over the smallest area.")


def _stress_range(row: int) -> tuple[ComputedValue, ComputedValue]:
    """Nominal stress on the worn and on the new area of a row of Table 2.8. [Pa]"""
    load = as_setting(f"table-2.8-normal_load-{row}")
    new, worn = published_number(f"table-2.8-nominal_area-{row}").limits()
    return propagate_rounding(truediv, load, worn), propagate_rounding(truediv, load, new)


def _peak_stress() -> Row:
    """Peak over the mean stress of the round tip by the theory of Hertz."""
    load = si_value("table-2.8-normal_load-1")
    modulus = poisson_contact(bodies="steel_steel").pair.effective_modulus
    radius = tip_radius_for_pressure(
        mean_pressure=si_value("table-2.8-nominal_pressure-1"), normal_load=load, effective_modulus=modulus
    )
    sphere = SphereOnFlat(tip_radius=float(radius), effective_modulus=modulus)
    return default_model_row(
        "2.4.2-round-stress-centre",
        float(hertz_peak_pressure(sphere, normal_load=load) / hertz_mean_pressure(sphere, normal_load=load)),
        "Hertz, peak over mean of any elastic sphere; the print is from an FEA.",
        trivial="the ratio is 1.5 for every sphere, the least that rounds to the print",
    )


def _motion() -> Iterator[Row]:
    """Yield sliding speeds and distances from rotation, revolutions and groove diameter."""
    settings = [(f"table-2.8-rotation_speed-{row}", f"table-2.8-groove_diameter-{row}") for row in (1, 2, 3, 4)]
    speeds = [propagate_rounding(formulas.sliding_speed, *pair) for pair in settings]
    for row, speed in enumerate(speeds, start=1):
        yield published_formula_row(f"table-2.8-sliding_speed-{row}", speed, "Pi times rotation times groove diameter.")
    yield published_formula_row("2.4.6-sliding-speed", max(speeds), "The largest speed of Table 2.8.")
    for published, row in (
        ("table-2.8-sliding_distance-1", _ROUND_TIP),
        ("table-2.8-sliding_distance-3", _FLAT_TIP),
        ("table-2.10-sliding_distance-2", _ROUND_TIP),
        ("table-2.10-sliding_distance-3", _FLAT_TIP),
    ):
        factors = as_setting(f"table-2.8-revolutions-{row}"), f"table-2.8-groove_diameter-{row}"
        yield formula_row(published, "Pi times turns times groove diameter.", formulas.sliding_distance, *factors)


def _friction() -> Iterator[Row]:
    """Yield friction reductions from the forces of Table 2.9, and the mean forces of the text."""
    for tip in (1, 2):
        reductions = welder_friction_reductions(tip)
        note = "D 2.1, lower force with lower and upper with upper."
        yield from range_rows(f"table-2.9-friction_reduction-{tip}", min(reductions), max(reductions), note)
    yield published_formula_row(
        "2.4.6-friction-reduction",
        max(welder_friction_reductions(1) + welder_friction_reductions(2)),
        "D 2.1 from the forces of Table 2.9, the largest.",
    )
    for name, tip in (("round", 1), ("flat", 2)):
        middle = si_value(f"table-2.9-intrinsic_friction_force-{tip}")
        yield published_formula_row(f"2.4.4-friction-{name}", middle, "Middle of the range in Table 2.9.")


def _current_drops() -> Iterator[Row]:
    """Yield the drop of the motor current with either tip."""
    for name, tip in (("round", 1), ("flat", 2)):
        currents = (as_exact(f"table-2.9-{state}_motor_current-{tip}") for state in ("intrinsic", "reduced"))
        drop = propagate_rounding(sub, *currents)
        yield published_formula_row("2.4.4-current-drop", drop, "Difference of the currents of Table 2.9.", suffix=name)


def _wear() -> Iterator[Row]:
    """Yield wear volumes per turn and wear rates of Table 2.10, and the wear of the flat over that of the round tip."""
    for row, tip in ((2, _ROUND_TIP), (3, _FLAT_TIP)):
        volume, turns = f"table-2.10-wear_volume-{row}", as_setting(f"table-2.8-revolutions-{tip}")
        yield formula_row(f"table-2.10-wear_volume_per_turn-{row}", "Volume over turns.", truediv, volume, turns)
        yield published_formula_row(f"table-2.10-wear_rate-{row}", _wear_rate(row), "Volume over distance.")
    yield undetermined_row("2.4.5-wear-reduction", "the worn volumes of the two tests with the round tip.")
    round_tip, flat_tip = _wear_rate(2), _wear_rate(3)
    of_printed_rates = si_value("table-2.10-wear_rate-3") / si_value("table-2.10-wear_rate-2")
    yield published_formula_row(
        "2.4.5-flat-wear-share",
        ComputedValue(
            value=flat_tip.value / round_tip.value,
            low=flat_tip.low / round_tip.high,
            high=flat_tip.high / round_tip.low,
        ),
        f"Volumes over distances of Table 2.10; the printed rates give {100 * of_printed_rates:.1f} %.",
    )


def _wear_rate(row: int) -> ComputedValue:
    """Wear rate of Table 2.10 within the rounding of both its volume and its volume per turn. [m2]"""
    distance, turns = f"table-2.10-sliding_distance-{row}", si_value("table-2.8-revolutions-1")
    total = propagate_rounding(formulas.wear_rate, f"table-2.10-wear_volume-{row}", distance)
    by_turn = propagate_rounding(
        lambda volume, length: formulas.wear_rate(turns * volume, length),
        f"table-2.10-wear_volume_per_turn-{row}",
        distance,
    )
    return ComputedValue(value=total.value, low=max(total.low, by_turn.low), high=min(total.high, by_turn.high))


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


_TESTS: Final = (("2.11", 1), ("2.12", 1), ("2.12", 2), ("2.12", 3), ("2.13", 1))  # table and row


def material_pair_rows() -> Iterator[Row]:
    """Yield the rows of section 2.5."""
    yield from _settings()
    yield from _pair_friction()
    yield from _summary()


def material_pair_figures() -> Iterator[ReportFigure]:
    """Figures of section 2.5."""
    yield report_figure("table-2-14-pairs", _pairs)


def _settings() -> Iterator[Row]:
    """Yield distance, revolutions and speed of each test from the other settings, and the pressure of Table 2.13."""

    def turns(speed: float, time: float, diameter: float) -> float:
        return speed * time / (np.pi * diameter)

    def speed(turns: float, time: float, diameter: float) -> float:
        return formulas.sliding_speed(turns / time, diameter)

    for table_id, row in _TESTS:
        v, n, d = (f"table-{table_id}-{column}-{row}" for column in ("sliding_speed", "revolutions", "groove_diameter"))
        time = as_setting(f"table-{table_id}-running_time-{row}")
        yield formula_row(f"table-{table_id}-sliding_distance-{row}", "Speed times running time.", mul, v, time)
        yield formula_row(n, "Distance over the length of the groove.", turns, v, time, d)
        yield formula_row(v, "Turns over time, times the groove's length.", speed, n, time, d)
    yield undetermined_row("table-2.13-nominal_pressure-1", "the radius of the pins' tips, or the first contact area.")


def _pair_friction() -> Iterator[Row]:
    """Yield the friction reductions of the text from forces."""
    for section, pair in (("2.5.2", "titanium"), ("2.5.4", "ceramic")):
        reduction, forces = f"{section}-friction-reduction", (f"{section}-friction-{pair}-{x}" for x in ("off", "on"))
        yield formula_row(reduction, "D 2.1 from the mean forces.", formulas.friction_reduction, *forces)

    def reduced(force: float, reduction: float) -> float:
        return force * (1 - reduction)

    note, inputs = "Force without vibration, less the stated reduction.", ("friction-m50-off", "friction-reduction")
    yield formula_row("2.5.5-friction-m50-on", note, reduced, *(f"2.5.5-{name}" for name in inputs))
    yield undetermined_row("2.5.5-friction-reduction", "the force with vibration: that without is printed twice.")
    for amplitude in ("2.5um", "1um"):
        note = "the forces, and of the titanium surfaces the summit radius and density."
        yield undetermined_row(f"2.5.3-friction-reduction-{amplitude}", note)
    for name in ("tip-diameter-off", "tip-diameter-on", "roughness-off", "roughness-on"):
        missing = "the worn volumes of pin and disc, and how much of the titanium is carried from one to the other."
        yield undetermined_row(f"2.5.2-{name}", missing)


def _summary() -> Iterator[Row]:
    """Yield Table 2.14 from the detailed results, and its largest reductions."""
    titanium, ceramic = (
        propagate_rounding(formulas.friction_reduction, f"{pair}-off", f"{pair}-on")
        for pair in ("2.5.2-friction-titanium", "2.5.4-friction-ceramic")
    )
    welder_reductions = welder_friction_reductions(1) + welder_friction_reductions(2)
    titanium_on_titanium = (propagate_rounding(float, f"2.5.3-friction-reduction-{size}") for size in ("2.5um", "1um"))
    for row, (reduction, note) in enumerate(
        (
            (max(reductions_of_table_2_3("friction_force")), "The largest that the forces of Table 2.3 give."),
            (max(welder_reductions), "The largest that the forces of Table 2.9 give."),
            (titanium, "Forces of section 2.5.2."),
            (max(titanium_on_titanium), "The larger of section 2.5.3."),
            (ceramic, "Forces of section 2.5.4."),
            (propagate_rounding(float, "2.5.5-friction-reduction"), "Section 2.5.5."),
        ),
        start=1,
    ):
        yield published_formula_row(f"table-2.14-friction_reduction-{row}", reduction, note)
    note = "The largest that the rates of Table 2.5 give."
    yield published_formula_row("table-2.14-wear_reduction-1", max(wear_reductions("2.5")), note)
    yield formula_row("table-2.14-wear_reduction-2", "Section 2.4.5.", float, "2.4.5-wear-reduction")
    for row in (5, 6):
        yield undetermined_row(f"table-2.14-wear_reduction-{row}", "the worn volumes, shown only as profiles.")
    for measure in ("friction", "wear"):
        cells = (propagate_rounding(float, f"table-2.14-{measure}_reduction-{row}") for row in (1, 2, 5, 6))
        yield published_formula_row(f"2.5.7-{measure}-reduction", max(cells), "The largest of Table 2.14.")


def _pairs() -> "Figure":
    """Draw the reductions of Table 2.14 as bars."""
    figure, axes = single_axes((5.4, 3.8))
    columns = table("2.14").columns
    places = np.arange(len(columns["pin"].printed))[::-1]
    for name, offset, hatch, colour in (("friction", 0.2, "", COLOURS[0]), ("wear", -0.2, "////", COLOURS[1])):
        values = 100 * columns[f"{name}_reduction"].values
        style: dict[str, Any] = {"facecolor": "white" if hatch else colour, "edgecolor": colour, "hatch": hatch}
        bars = axes.barh(places + offset, np.nan_to_num(values), height=0.38, label=f"{name}, Table 2.14", **style)
        axes.bar_label(bars, [f"{value:.0f}" if value > 0 else "no reduction" for value in values], padding=3, size=8)
    pairs = zip(columns["pin"].printed, columns["disc"].printed, strict=True)
    axes.set(xlabel="Reduction [%]", xlim=(0, 100))
    axes.set_yticks(places, labels=[f"{pin}\non {disc}" for pin, disc in pairs])
    axes.grid(False, axis="y")
    figure.legend(loc="outside lower center", ncols=2)
    return figure
