"""Section 4.1: rows and figures of actuator power, example test and efficiency coefficient."""

from collections.abc import Callable, Iterator
from functools import partial
from operator import sub, truediv
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from dong2015 import formulas
from dong2015.chapter4 import power_map
from dong2015.plots import axes_row, draw_printed, line_style, report_figure, single_axes
from dong2015.published_rigs import STEEL_ON_STEEL_NOTE
from dong2015.row import Row, formula_row, published_formula_row, published_model_row, undetermined_row
from sonolube.facts.metrics import power_for_friction
from sonolube.facts.published import (
    ComputedValue,
    PrintedNumber,
    PublishedValue,
    column_numbers,
    propagate_rounding,
    published_number,
    published_value,
    si_value,
    table,
)
from sonolube.figure import COLOURS, LINES, MARKERS, ReportFigure
from sonolube.validation.contacts import STEEL_YIELD_STRENGTHS, efficiency_line

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_UNIT_OF_LINE = 1e-9  # mW mm2/(N W) in m2/N


def power_map_rows() -> Iterator[Row]:
    """Yield the rows of section 4.1 on settings and example test."""
    yield from nominal_pressure_rows("4.1")
    for row, voltage in column_numbers("4.1", "voltage_peak_to_peak").items():
        yield power_row(f"table-4.1-actuator_power-{row}", voltage.value)
    yield from amplitude_rows("4.1")
    yield _highest_amplitude()
    yield from _settings_of_the_text()
    yield from _example_test()
    for point in power_map.example_points():
        yield _reduction_of_mean_forces(point)
        yield _cube_friction(point)
        yield _efficiency(point)
        yield _line_friction(point)
        yield _line_power(point)
    slowest = power_map.example_test() | {"sliding_speed": published_number("table-4.1-sliding_speed-1").low}
    first, *_, last = power_map.example_points()
    yield line_reduction_row("4.1.2-reduction-lowest-voltage", slowest, actuator_power=first.actuator_power)
    yield line_reduction_row("4.1.2-reduction-highest-voltage", slowest, actuator_power=last.actuator_power)
    yield _intrinsic_friction()
    yield undetermined_row(
        "4.1.2-static-friction",
        "how friction grows while the bodies rest; at the start it is 1.35 times the steady one of Table 4.2",
    )


def nominal_pressure_rows(table_id: str) -> Iterator[Row]:
    """Yield the nominal pressures of a table from its loads and its nominal area."""
    area = published_number(f"table-{table_id}-nominal_area-1")
    for row, load in column_numbers(table_id, "normal_load").items():
        yield _pressure_row(f"table-{table_id}-nominal_pressure-{row}", load.value, area)


def amplitude_rows(table_id: str) -> Iterator[Row]:
    """Yield the amplitudes of a table below the highest, in proportion to its voltages."""
    voltages, amplitudes = (
        column_numbers(table_id, column) for column in ("voltage_peak_to_peak", "vibration_amplitude")
    )
    highest, amplitude = voltages[max(voltages)], amplitudes[max(voltages)]
    note = f"{amplitude.value / highest.value * 1e6:.4f} um per volt peak to peak, from {highest.text} V"
    for row, voltage in voltages.items():
        if 0 < voltage.value < highest.value:
            published = f"table-{table_id}-vibration_amplitude-{row}"
            yield formula_row(published, note, lambda a, highest, u: a / highest * u, amplitude, highest, voltage)


def power_row(published: PublishedValue | str, voltage: float) -> Row:
    """Row of a published actuator power at a voltage peak to peak in V."""
    power = float(power_map.actuator_power(voltage_peak_to_peak=voltage))
    note = f"C U_max U_pp f (D 1.9) with U_max = U_pp; U_max = U_pp/2 would give {power / 2:.3g} W"
    return published_formula_row(published, power, note)


def line_reduction_row(published: str, test: dict[str, float], *, actuator_power: float) -> Row:
    """Row of a friction reduction on the efficiency line."""
    off, on = test["intrinsic_friction_force"], float(power_map.line_friction(test, actuator_power=actuator_power))
    note = (
        f"efficiency line at {actuator_power:.3g} W, {test['normal_load']:g} N and {test['sliding_speed'] * 1e3:g} "
        f"mm/s, from {off:.3g} N; the line ends at {power_map.line_end() * 1e3:.0f} mm/s, where it crosses zero"
    )
    return published_model_row(published, formulas.friction_reduction(off, on), note)


def _pressure_row(published: PublishedValue | str, load: float, area: PrintedNumber) -> Row:
    """Row of a published nominal pressure of a load in N on a printed area."""
    note = f"{load:g} N over {area.text} mm2, the load taken as exact"
    return formula_row(published, note, partial(truediv, load), area)


def _highest_amplitude() -> Row:
    """Highest amplitude of Table 4.1 from that of the wear tests, in proportion to the voltage."""
    voltages, amplitude = column_numbers("4.1", "voltage_peak_to_peak"), published_number("2.3.1-amplitude")
    in_wear_tests = 2 * si_value("A.3.1.3-voltage-amplitude") * si_value("A.3.1.5-gain")
    last = max(voltages)
    return published_formula_row(
        f"table-4.1-vibration_amplitude-{last}",
        propagate_rounding(lambda a: a / in_wear_tests * voltages[last].value, amplitude),
        f"in proportion to {amplitude.text} um at {in_wear_tests:.3g} V peak to peak, section 2.3.1 and appendix A 3.1",
    )


def _settings_of_the_text() -> Iterator[Row]:
    """Yield diameters, stresses and powers of section 4.1.1."""
    for nth in (1, 2):
        inches = published_number(f"4.1.3-groove-diameter-{nth}")
        yield published_formula_row(f"4.1.1-diameter-{nth}", inches.value, f"{inches.text} in of section 4.1.3")
    area, load = published_number("4.1.1-nominal-area"), published_number("4.1.1-normal-load")
    for limit, newtons in zip(published_value("4.1.1-stress").limits(), (load.low, load.high), strict=True):
        yield _pressure_row(limit, newtons, area)
    yield _pressure_row("4.1.2-efficiency-stress", load.high, area)
    first, *_, last = power_map.example_points()
    for limit, point in zip(published_value("4.1.1-power").limits(), (first, last), strict=True):
        yield power_row(limit, point.voltage_peak_to_peak)


def _example_test() -> Iterator[Row]:
    """Yield speed, duration and friction drop of the example test."""

    def speed(turn: float, diameter: float = si_value("4.1.2-diameter")) -> float:
        return formulas.sliding_speed(1 / turn, diameter)

    rounded = speed(si_value("4.1.2-turn-duration"), si_value("4.1.1-diameter-1"))
    note = f"pi times 1.1 in over the time of a turn; with the rounded 28 mm {rounded * 1e3:.1f} mm/s"
    yield formula_row("4.1.2-sliding-speed", note, speed, "4.1.2-turn-duration")

    levels, level = si_value("4.1.1-voltage-count"), si_value("4.1.2-level-duration")
    duration = si_value("4.1.2-vibration-start") + levels * level
    note = f"start of the vibration, then {levels:g} levels of {level:g} s"
    yield published_formula_row("4.1.2-duration", duration, note)

    off, on, *_ = column_numbers("4.2", "friction_force").values()
    yield formula_row("4.1.2-friction-drop", f"{off.value:g} N less {on.value:g} N", sub, off, on)


def _reduction_of_mean_forces(point: power_map.ExamplePoint) -> Row:
    """Friction reduction of the mean forces of Table 4.2 at a voltage."""
    forces = column_numbers("4.2", "friction_force")
    off, on = forces[1], forces[point.row]
    note = f"D 2.1 from the mean forces, {off.value:g} N and {on.value:g} N"
    return formula_row(f"table-4.2-friction_reduction-{point.row}", note, formulas.friction_reduction, off, on)


def _cube_friction(point: power_map.ExamplePoint) -> Row:
    """Friction of the cube at a voltage."""
    off = power_map.example_test()["intrinsic_friction_force"]
    volts = point.voltage_peak_to_peak
    friction = float(power_map.cube_friction(voltage_peak_to_peak=volts))
    weakest, strongest = (
        float(power_map.cube_friction(voltage_peak_to_peak=volts, yield_strength=strength))
        for strength in STEEL_YIELD_STRENGTHS
    )
    note = (
        f"cube, D 3.15: ratio {friction / off:.3f} of {off:g} N; R_q = 2.12 um of the plates (D 4.1.3);"
        f" {STEEL_ON_STEEL_NOTE}; neither sliding speed nor in-plane motion of the tip enters"
    )
    return published_model_row(
        f"table-4.2-friction_force-{point.row}", friction, note, suffix="by-the-cube", possible=(weakest, strongest)
    )


def _efficiency(point: power_map.ExamplePoint) -> Row:
    """Intercept of the efficiency line from the efficiency coefficient at a voltage."""
    line, speed = efficiency_line(), power_map.example_test()["sliding_speed"]
    to_zero_speed = -line.slope * speed
    coefficient = power_map.point_efficiency(point, friction=point.friction.value)
    on_line = float(power_map.line_efficiency(sliding_speed=speed))
    note = (
        f"D 4.1 at {point.voltage_peak_to_peak:g} V gives {coefficient / _UNIT_OF_LINE:.3f}, the line"
        f" {on_line / _UNIT_OF_LINE:.3f} mW mm2/(N W); carried to zero speed by the printed slope"
    )
    intercept = _over_scatter(
        lambda friction: power_map.point_efficiency(point, friction=friction) + to_zero_speed, point.friction
    )
    note, suffix = note + _surplus_power_note(point), f"at-{point.voltage_peak_to_peak:g}V"
    return published_model_row("4.1.2-efficiency-intercept", intercept, note, suffix=suffix)


def _line_friction(point: power_map.ExamplePoint) -> Row:
    """Friction on the efficiency line at a voltage."""
    test = power_map.example_test()
    as_printed = test["intrinsic_friction_force"] * (1 + point.actuator_power / power_map.sufficient_power(test))
    note = (
        f"D 4.4 solved for the reduced friction, at {point.actuator_power:.3g} W; "
        f"as printed it would rise to {as_printed:.3g} N{_surplus_power_note(point)}"
    )
    friction = float(power_map.line_friction(test, actuator_power=point.actuator_power))
    on_line = 2 * test["intrinsic_friction_force"] - as_printed
    return published_model_row(
        f"table-4.2-friction_force-{point.row}",
        friction,
        note,
        suffix="by-the-line",
        trivial="" if on_line >= 0 else f"the line is at {on_line:.2f} N there, and no friction is less than none",
    )


def _line_power(point: power_map.ExamplePoint) -> Row:
    """Power on the efficiency line for the friction at a voltage."""

    def power(friction: float) -> float:
        return float(power_for_friction(efficiency_line(), reduced_friction_force=friction, **power_map.example_test()))

    voltages = column_numbers("4.1", "voltage_peak_to_peak")
    row = next(row for row, voltage in voltages.items() if voltage.value == point.voltage_peak_to_peak)
    note = f"D 4.3 for the {point.friction.text} N of Table 4.2{_surplus_power_note(point)}"
    power_over_scatter = _over_scatter(power, point.friction)
    return published_model_row(f"table-4.1-actuator_power-{row}", power_over_scatter, note, suffix="by-the-line")


def _surplus_power_note(point: power_map.ExamplePoint) -> str:
    """Note on power beyond the sufficient one; empty below it."""
    sufficient = power_map.sufficient_power(power_map.example_test())
    if point.actuator_power <= sufficient:
        return ""
    return (
        f"; of {point.actuator_power:.3g} W the line needs {sufficient:.3g} W to take all friction away, "
        "the rest saves nothing"
    )


def _intrinsic_friction() -> Row:
    """Friction without vibration of section 4.1.3 from Table 4.2."""
    test = power_map.example_test()
    off, load = test["intrinsic_friction_force"], test["normal_load"]
    note = f"friction of Table 4.2 at {load:g} N; over that load a coefficient of {off / load:.3f}"
    return published_formula_row("4.1.3-friction-uncoated", off, note)


def _over_scatter(function: Callable[[float], float], measured: PrintedNumber) -> ComputedValue:
    """Monotonic function of a measured mean with the interval of its scatter."""
    limits = function(measured.low), function(measured.high)
    return ComputedValue(value=function(measured.value), low=min(limits), high=max(limits))


_VOLTAGE: Final = "Drive voltage, peak to peak [V]"
_OFFSET: Final = 3.0  # mm/s between points of one speed


def power_figures() -> Iterator[ReportFigure]:
    """Figures of section 4.1 on power and efficiency."""
    sufficient = power_map.sufficient_power(power_map.example_test())
    yield report_figure("table-4-1-actuator-power", _power)
    yield report_figure("table-4-2-example-test", _draw_example_test)
    yield report_figure("figure-4-3-example-in-time", _example_in_time)
    yield report_figure(
        "figure-4-13-efficiency", _draw_efficiency, sufficient=sufficient, speed=1e3 * power_map.line_end()
    )


def _power() -> "Figure":
    """Draw the actuator power of Table 4.1 with D 1.9."""
    figure, axes = single_axes()
    swing = np.linspace(0, 28, 141)
    power = power_map.actuator_power(voltage_peak_to_peak=swing)
    axes.plot(swing, power, **line_style(0), label="D 1.9, highest voltage = swing")
    axes.plot(swing, power / 2, **line_style(1), label="D 1.9, highest voltage = swing/2")
    columns = table("4.1").columns
    voltages, powers = (columns[name].values for name in ("voltage_peak_to_peak", "actuator_power"))
    axes.plot(voltages, powers, MARKERS[0], color="black", label="Table 4.1", zorder=3)
    axes.set(xlabel=_VOLTAGE, ylabel="Power of the actuator [W]", xlim=(-0.8, 28), ylim=(-0.15, 6.5))
    axes.legend(loc="upper left")
    return figure


def _draw_example_test() -> "Figure":
    """Draw friction and friction reduction of Table 4.2 with the cube and the efficiency line."""
    figure, (left, right) = axes_row(2, (7.8, 3.8))
    off = power_map.example_test()["intrinsic_friction_force"]
    swing = np.linspace(0, 28, 1121)  # resolves the corner of the line
    cube = power_map.cube_friction(voltage_peak_to_peak=swing)
    line = power_map.line_friction(
        power_map.example_test(), actuator_power=power_map.actuator_power(voltage_peak_to_peak=swing)
    )
    models = (("cube, D 3.15", cube), ("efficiency line, D 4.4 solved for reduced friction", line))
    for index, (label, friction) in enumerate(models):
        for axes, curve in ((left, friction), (right, 100 * (1 - friction / off))):
            axes.plot(swing, curve, **line_style(index), label=label)
    frictions, reductions = (column_numbers("4.2", f"friction_{name}") for name in ("force", "reduction"))
    voltages = {row: voltage.value for row, voltage in column_numbers("4.2", "voltage_peak_to_peak").items()}
    for axes, numbers, factor in ((left, frictions, 1), (right, reductions, 100)):
        style = {"fmt": MARKERS[0], "color": "black", "zorder": 3, "label": "Table 4.2, as printed"}
        draw_printed(axes, [voltages[row] for row in numbers], numbers.values(), factor, **style)
    of_means = [100 * formulas.friction_reduction(off, frictions[row].value) for row in reductions]
    rings: dict[str, Any] = {
        "marker": MARKERS[1],
        "ls": "none",
        "ms": 9,
        "mfc": "none",
        "color": COLOURS[2],
        "zorder": 4,
    }
    label = "reduction of the mean forces of Table 4.2"
    right.plot([voltages[row] for row in reductions], of_means, **rings, label=label)
    for axes in (left, right):
        axes.set(xlabel=_VOLTAGE, xlim=(-0.8, 28))
    left.set(ylabel="Friction force [N]", ylim=(-0.03, 1.0))
    right.set(ylabel="Friction reduction [%]", ylim=(-3, 112))
    figure.legend(*right.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


def _example_in_time() -> "Figure":
    """Draw the friction of the example test over its time: the print of each level, the cube and the line."""
    figure, axes = single_axes((6.4, 3.4))
    points, test = power_map.example_points(), power_map.example_test()
    begin, step = si_value("4.1.2-vibration-start"), si_value("4.1.2-level-duration")
    edges = [si_value("4.1.2-motor-start"), *(begin + step * level for level in range(len(points) + 1))]
    printed = list(column_numbers("4.2", "friction_force").values())
    low, high = ([getattr(number, end) for number in printed] for end in ("low", "high"))
    axes.stairs(high, edges, baseline=low, fill=True, color="0.8", label="Table 4.2, mean and scatter")
    off, volts = test["intrinsic_friction_force"], [point.voltage_peak_to_peak for point in points]
    cube = power_map.cube_friction(voltage_peak_to_peak=volts)
    line = power_map.line_friction(test, actuator_power=power_map.actuator_power(voltage_peak_to_peak=volts))
    for index, (label, levels) in enumerate((("cube, D 3.15", cube), ("efficiency line, D 4.4", line))):
        axes.stairs([off, *levels], edges, baseline=None, color=COLOURS[index], linestyle=LINES[index], label=label)
    axes.plot(edges[0], si_value("4.1.2-static-friction"), MARKERS[0], color="black", label="static friction, D 4.1.2")
    for place, text in zip(edges[1:], volts, strict=False):
        axes.annotate(
            f"{text:g} V", (place + step / 2, 0.98), xycoords=("data", "axes fraction"), ha="center", va="top"
        )
    axes.set(xlabel="Time [s]", ylabel="Friction force [N]", xlim=(0, edges[-1]), ylim=(-0.02, 1.4))
    axes.legend(loc="lower left")
    return figure


def _draw_efficiency() -> "Figure":
    """Draw the efficiency line with the efficiency coefficients of Table 4.2."""
    figure, axes = single_axes()
    end = power_map.line_end()
    speeds = np.linspace(0, end * (1 - 1e-9), 101)
    axes.plot(1e3 * speeds, 1e9 * power_map.line_efficiency(sliding_speed=speeds), color="black", label="line of D 4.2")
    axes.axvspan(1e3 * end, 260, color="0.88", zorder=0)
    axes.text(245, 0.42, f"above {1e3 * end:.0f} mm/s: refused", rotation=90, ha="center", va="center")
    points = power_map.example_points()
    for index, point in enumerate(points):
        low, mean, high = (
            1e9 * power_map.point_efficiency(point, friction=friction)
            for friction in (point.friction.high, point.friction.value, point.friction.low)
        )
        speed = 1e3 * power_map.example_test()["sliding_speed"] + _OFFSET * (index - (len(points) - 1) / 2)
        errors = [[mean - low], [high - mean]]
        label = f"Table 4.2, {point.voltage_peak_to_peak:g} V, {point.actuator_power:.2f} W"
        axes.errorbar(speed, mean, yerr=errors, fmt=MARKERS[index], color=COLOURS[index], capsize=2, label=label)
    ylabel = "Efficiency coefficient [mW mm²/(N W)]"
    axes.set(xlabel="Sliding speed [mm/s]", ylabel=ylabel, xlim=(0, 260), ylim=(0, 0.85))
    axes.legend(loc="upper right", bbox_to_anchor=(0.885, 1.0))
    return figure
