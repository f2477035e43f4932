"""Section 4.1: figures of actuator power, example test and efficiency coefficient."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from sonolube.facts.published import column_numbers, table
from sonolube.figure import COLOURS, MARKERS, ReportFigure
from sonolube.reproduction import formulas
from sonolube.reproduction.chapter4 import power_map
from sonolube.reproduction.plots import axes_row, draw_printed, line_style, single_axes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_VOLTAGE: Final = "Drive voltage, peak to peak [V]"
_OFFSET: Final = 3.0  # mm/s between points of one speed


def power_figures() -> Iterator[ReportFigure]:
    """Figures of section 4.1 on power and efficiency."""
    sufficient = power_map.sufficient_power(power_map.example_test())
    yield ReportFigure(
        name="table-4-1-actuator-power",
        title="Power of the actuator against voltage",
        caption="All powers of Table 4.1 follow from D 1.9 with the whole swing as the highest voltage, a drive up "
        "from zero; about zero the same swing would take half.",
        draw=_power,
    )
    yield ReportFigure(
        name="table-4-2-example-test",
        title="Friction and its reduction in the example test",
        caption="Table 4.2: 5 N, 65.5 mm/s, steel on steel. Squares: reductions of the printed mean forces, which "
        "differ from those of D, whose averaging is not stated. The cube, with the roughness of the "
        "plates, has neither speed nor in-plane motion: it falls too early. D's efficiency line, at the "
        "power of D 1.9, follows the first three voltages and then takes all friction away.",
        draw=_example_test,
    )
    yield ReportFigure(
        name="figure-4-13-efficiency",
        title="Efficiency coefficient against sliding speed",
        caption="D's line and the points of Table 4.2 at 65.5 mm/s, drawn side by side, with the scatter "
        f"of the friction. On the line {sufficient:.1f} W take all friction away; what is "
        "supplied beyond, at the two highest voltages, only lowers the coefficient. From "
        f"{1e3 * power_map.line_end():.0f} mm/s on the line has no meaning and is refused.",
        draw=_efficiency,
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


def _example_test() -> "Figure":
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


def _efficiency() -> "Figure":
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
