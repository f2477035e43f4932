"""Figures of chapter 4: power, the example test, efficiency, superimposed speeds, the skin replica."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.figure import COLOURS, LINES, MARKERS, ReportFigure
from sonolube.metrics import peak_vibration_velocity, superimposed_speed
from sonolube.published import PrintedNumber, table
from sonolube.validation.inputs import friction_drop, said
from sonolube.validation.power_map import (
    actuator_power,
    cube_friction,
    example_points,
    example_test,
    line_efficiency,
    line_end,
    line_friction,
    point_efficiency,
    printed,
    sufficient_power,
    vibration_amplitude,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SIDE_BY_SIDE = 3.0  # mm/s between points of one speed


def application_figures() -> tuple[ReportFigure, ...]:
    """Return the figures of chapter 4."""
    return (
        ReportFigure(
            name="table-4-1-actuator-power",
            chapter=4,
            title="Power of the actuator against voltage",
            caption="All powers of Table 4.1 come out of D 1.9 if the highest voltage is the whole swing, a drive up "
            "from zero; about zero the same swing would take half.",
            draw=_power,
        ),
        ReportFigure(
            name="table-4-2-example-test",
            chapter=4,
            title="Friction and its reduction in the example test",
            caption="Table 4.2: 5 N, 65.5 mm/s, steel on steel. Squares: reductions of the printed mean forces, which "
            "differ from those that D averaged in a way it does not tell. The cube, with the roughness of Table 3.2, "
            "knows neither speed nor in-plane motion: it falls too early and too slowly. D's efficiency line, at the "
            "power of D 1.9, follows the first three voltages and then takes all friction away.",
            draw=_example_test,
        ),
        ReportFigure(
            name="figure-4-13-efficiency",
            chapter=4,
            title="Efficiency coefficient against sliding speed",
            caption="D's line and the points that Table 4.2 gives at 65.5 mm/s, drawn side by side, with the scatter "
            f"of the friction. On the line {sufficient_power(example_test()):.1f} W take all friction away; what is "
            "supplied beyond, at the two highest voltages, only lowers the coefficient. From "
            f"{1e3 * line_end():.0f} mm/s on the line has no meaning and is refused.",
            draw=_efficiency,
        ),
        ReportFigure(
            name="figure-4-32-superimposed-speed",
            chapter=4,
            title="Sliding speed with the vibration superimposed",
            caption="Curves: the resultant of sliding speed and half-wave mean of the vibration velocity, the "
            "amplitude in proportion to the voltage. Points: Table 4.5, with one misprinted cell, 110 for 112 mm/s.",
            draw=_superimposed_speeds,
        ),
        ReportFigure(
            name="section-4-4-skin-replica",
            chapter=4,
            title="Friction coefficient on the skin replica",
            caption="Steel cutter head on a skin replica, 44.3 mm/s and 20 kHz. Filled: coefficients as section 4.4.3 "
            "prints them. Rings: its forces over the loads of Table 4.6. Arrows: reductions of those forces.",
            draw=_skin_replica,
        ),
    )


def _power() -> "Figure":
    figure, axes = _axes()
    swing = np.linspace(0, 28, 141)
    power = actuator_power(voltage_peak_to_peak=swing)
    axes.plot(swing, power, LINES[0], color=COLOURS[0], label="D 1.9, highest voltage = swing")
    axes.plot(swing, power / 2, linestyle=LINES[1], color=COLOURS[1], label="D 1.9, highest voltage = swing/2")
    voltages, powers = (printed("4.1", name).values() for name in ("voltage_peak_to_peak", "actuator_power"))
    axes.plot(_values(voltages), _values(powers), MARKERS[0], color="black", label="Table 4.1", zorder=3)
    axes.set(
        xlabel="Drive voltage, peak to peak [V]", ylabel="Power of the actuator [W]", xlim=(-0.8, 28), ylim=(-0.15, 6.5)
    )
    axes.legend(loc="upper left")
    return figure


def _example_test() -> "Figure":
    from matplotlib import pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(7.8, 3.8))
    off = example_test()["intrinsic_friction_force"]
    swing = np.linspace(0, 28, 1121)  # fine enough for the corner of the line
    cube = cube_friction(voltage_peak_to_peak=swing)
    line = line_friction(example_test(), actuator_power=actuator_power(voltage_peak_to_peak=swing))
    models = (("cube, D 3.15", cube), ("efficiency line, D 4.4 solved for reduced friction", line))
    for index, (label, friction) in enumerate(models):
        for axes, curve in ((left, friction), (right, 100 * (1 - friction / off))):
            axes.plot(swing, curve, linestyle=LINES[index], color=COLOURS[index], label=label)
    frictions, reductions = printed("4.2", "friction_force"), printed("4.2", "friction_reduction")
    voltages = {row: voltage.value for row, voltage in printed("4.2", "voltage_peak_to_peak").items()}
    for axes, numbers, factor in ((left, frictions, 1), (right, reductions, 100)):
        _with_scatter(axes, [voltages[row] for row in numbers], list(numbers.values()), factor, "Table 4.2, as printed")
    from_means = [100 * friction_drop(off, frictions[row].value) for row in reductions]
    right.plot(
        [voltages[row] for row in reductions],
        from_means,
        MARKERS[1],
        ms=9,
        mfc="none",
        color=COLOURS[2],
        label="reduction of the mean forces of Table 4.2",
        zorder=4,
    )
    for axes in (left, right):
        axes.set(xlabel="Drive voltage, peak to peak [V]", xlim=(-0.8, 28))
    left.set(ylabel="Friction force [N]", ylim=(-0.03, 1.0))
    right.set(ylabel="Friction reduction [%]", ylim=(-3, 112))
    figure.legend(*right.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


def _efficiency() -> "Figure":
    figure, axes = _axes()
    end = line_end()
    speeds = np.linspace(0, end * (1 - 1e-9), 101)
    axes.plot(1e3 * speeds, 1e9 * line_efficiency(sliding_speed=speeds), color="black", label="line of D 4.2")
    axes.axvspan(1e3 * end, 260, color="0.88", zorder=0)
    axes.text(245, 0.42, f"above {1e3 * end:.0f} mm/s: refused", rotation=90, ha="center", va="center")
    points = example_points()
    for index, point in enumerate(points):
        low, mean, high = (
            1e9 * point_efficiency(point, friction=friction)
            for friction in (point.friction.high, point.friction.value, point.friction.low)
        )
        place = 1e3 * example_test()["sliding_speed"] + _SIDE_BY_SIDE * (index - (len(points) - 1) / 2)
        axes.errorbar(
            place,
            mean,
            yerr=[[mean - low], [high - mean]],
            fmt=MARKERS[index],
            color=COLOURS[index],
            capsize=2,
            label=f"Table 4.2, {point.voltage_peak_to_peak:g} V, {point.actuator_power:.2f} W",
        )
    axes.set(
        xlabel="Sliding speed [mm/s]",
        ylabel="Efficiency coefficient [mW mm²/(N W)]",
        xlim=(0, 260),
        ylim=(0, 0.85),
    )
    axes.legend(loc="upper right", bbox_to_anchor=(0.885, 1.0))
    return figure


def _superimposed_speeds() -> "Figure":
    figure, axes = _axes(width=6.2)
    columns = table("4.5").columns
    slides, voltages, speeds = (
        columns[name].values for name in ("sliding_speed", "voltage_peak_to_peak", "superimposed_speed")
    )
    swing = np.linspace(0, 26.5, 107)
    peak = peak_vibration_velocity(
        frequency=printed("4.4", "frequency")[0].value,
        vibration_amplitude=vibration_amplitude(voltage_peak_to_peak=swing),
    )
    for index, slide in enumerate(sorted(set(slides), reverse=True)):
        colour, line, marker = COLOURS[index], LINES[index], MARKERS[index]
        curve = superimposed_speed(sliding_speed=slide, vibration_velocity=peak)
        axes.plot(swing, 1e3 * curve, linestyle=line, color=colour)
        chosen = slides == slide
        axes.plot(voltages[chosen], 1e3 * speeds[chosen], marker, color=colour)
        axes.plot([], [], linestyle=line, marker=marker, color=colour, label=f"{1e3 * slide:g} mm/s")
    for correction in table("4.5").corrections:
        at = voltages[correction.row], 1e3 * speeds[correction.row]
        axes.plot(*at, "o", ms=12, mfc="none", color="black", ls="none", label="misprinted cell")
    axes.set(
        xlabel="Drive voltage, peak to peak [V]",
        ylabel="Superimposed speed [mm/s]",
        xlim=(-0.6, 26.8),
        ylim=(0, 260),
    )
    figure.legend(loc="outside right center", title="Sliding speed:\ncurve computed,\npoints Table 4.5")
    return figure


def _skin_replica() -> "Figure":
    figure, axes = _axes()
    loads = list(printed("4.6", "normal_load").values())
    places = _values(loads)
    for index, (state, words) in enumerate((("off", "without vibration"), ("on", "with vibration"))):
        coefficients = _values([said(f"4.4.3-coefficient-{state}-{load.text}N") for load in loads])
        forces = _values([said(f"4.4.3-friction-{state}-{load.text}N") for load in loads])
        colour = COLOURS[index]
        axes.plot(places, coefficients, MARKERS[index], color=colour, label=f"{words}, section 4.4.3")
        axes.plot(places, forces / places, "o", ms=11, mfc="none", color=colour, label=f"{words}, force over load")
    for load in loads:
        off, on = (said(f"4.4.3-friction-{state}-{load.text}N").value for state in ("off", "on"))
        middle = (off + on) / (2 * load.value)
        arrow = {"arrowstyle": "->", "color": "0.4"}
        ends = (load.value, on / load.value + 0.02), (load.value, off / load.value - 0.02)
        axes.annotate("", *ends, arrowprops=arrow)
        axes.text(load.value + 0.06, middle, f"−{100 * friction_drop(off, on):.0f} %", va="center")
    axes.set(xlabel="Normal load [N]", ylabel="Coefficient of friction", xlim=(1.5, 4.7), ylim=(0, 0.6), xticks=places)
    axes.legend(loc="upper left")
    return figure


def _with_scatter(axes: "Axes", places: list[float], numbers: list[PrintedNumber], factor: float, label: str) -> None:
    scatter = [[factor * (number.value - number.low) for number in numbers]]
    axes.errorbar(
        places,
        [factor * number.value for number in numbers],
        yerr=[*scatter, *scatter],
        fmt=MARKERS[0],
        color="black",
        capsize=3,
        label=label,
        zorder=3,
    )


def _values(numbers: Iterable[PrintedNumber]) -> Floats:
    return np.array([number.value for number in numbers], dtype=np.float64)


def _axes(width: float = 4.8) -> "tuple[Figure, Axes]":
    from matplotlib import pyplot as plt

    return plt.subplots(figsize=(width, 3.6))
