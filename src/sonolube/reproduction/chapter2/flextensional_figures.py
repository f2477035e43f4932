"""Section 2.2, the flextensional actuator between two plates: figures of friction over voltage and over speed."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.facts.published import published_number, si_value
from sonolube.figure import LINES, MARKERS, ReportFigure
from sonolube.models.actuator import linear_amplifier_power
from sonolube.reproduction.chapter2.flextensional import gain_of_slow_test, slow_test, stick_slip_ratio
from sonolube.reproduction.plots import axes_row, curve_style, draw_printed, line_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LEVELS: Final = (1, 2, 3)
_SPEEDS: Final = ("3.5", "5", "10", "30", "50", "70", "100")  # mm/s, in the ids of the statements
_VOLTAGE: Final = "Highest voltage [V]"
_SPEED: Final = "Sliding speed [mm/s]"
_REDUCTION: Final = "Friction reduction [%]"


def flextensional_figures() -> Iterator[ReportFigure]:
    """Figures of section 2.2."""
    gain = gain_of_slow_test()
    assumed = (
        "Asperity stick-slip with R_q of Table 3.2 and a coefficient of friction of "
        f"{slow_test().friction_coefficient:g}, steel on steel in D 3.1.4: neither is printed for this actuator"
    )
    yield ReportFigure(
        name="figure-2-13-voltage",
        title="Flextensional actuator over its highest voltage",
        caption=f"As D figure 2.13 (d) to (f), 5 mm/s. {assumed}. Gain at resonance {gain:.2g}, from the 70 % at 3.5 "
        "mm/s. The pull is twice the friction of one plate; the reductions under the three loads coincide. All levels "
        "have 4 V peak to peak (D 2.2.5) and so one stroke: only the power grows. Dashed: if they swung from zero. "
        "Right: D 1.9, points of D 2.2.5. Friction over time, (a) to (c), is only drawn in D.",
        draw=_over_voltage,
    )
    yield ReportFigure(
        name="figure-2-14-speed",
        title="Flextensional actuator over the sliding speed",
        caption=f"As D figure 2.14, 2.6 N and 4 V peak to peak. {assumed}. Nor is the amplitude at resonance: solid "
        f"with a gain of {gain:.2g}, at which the reduction at 3.5 mm/s is the printed one, dashed with the "
        "quasi-static stroke. Markers on the curves: the seven speeds of D. Friction without vibration rises in D up "
        "to 10 mm/s (dotted), by an amount that is only drawn; here it is constant.",
        draw=_over_speed,
    )


def reduction(*, gain: ArrayLike, sliding_speed: ArrayLike) -> Floats:
    """Friction reduction at a gain of the quasi-static stroke by asperity stick-slip. []"""
    return 1 - stick_slip_ratio(slow_test(), gain=gain, sliding_speed=sliding_speed)


def _over_voltage() -> "Figure":
    """Draw pulling force, reduction and power over the highest voltage."""
    figure, (pull, reduced, power) = axes_row(3, (7.8, 3.1))
    highest = np.array([si_value(f"2.2.3-voltage-maximum-{level}") for level in _LEVELS])
    swing, speed, gain = si_value("2.2.5-voltage-peak-to-peak"), si_value("2.2.3-sliding-speed"), gain_of_slow_test()
    levels = np.concatenate([[0.0], highest])
    ratio = 1 - reduction(gain=np.where(levels > 0, gain, 0.0), sliding_speed=speed)
    factor = si_value("2.2.2-pulling-force-factor") * slow_test().friction_coefficient
    for index, level in enumerate(_LEVELS):
        load = si_value(f"2.2.3-normal-load-{level}")
        pull.plot(levels, factor * load * ratio, **curve_style(index), label=f"{load:g} N")
        reduced.plot(levels, 100 * (1 - ratio), **curve_style(index))
    voltages = np.linspace(0.0, 1.1 * highest[-1], 111)
    from_zero = reduction(gain=gain * voltages / swing, sliding_speed=speed)
    reduced.plot(voltages, 100 * from_zero, LINES[1], color="0.3", label="swing from zero")
    up_to = 100 * si_value("2.2.6-reduction")
    reduced.axhline(up_to, color="black", linestyle=":", linewidth=1, label="up to 70 %, D 2.2.6")
    watts = linear_amplifier_power(
        capacitance=si_value("2.2.2-capacitance"),
        voltage_maximum=voltages,
        voltage_peak_to_peak=swing,
        frequency=si_value("2.2.2-resonance"),
    )
    power.plot(voltages[voltages >= swing], watts[voltages >= swing], **line_style(0), label="D 1.9")
    style: dict[str, Any] = {"fmt": MARKERS[0], "color": "black", "zorder": 3, "label": "D 2.2.5"}
    draw_printed(power, highest, [published_number(f"2.2.5-power-{level}") for level in _LEVELS], **style)
    pull.set(ylabel="Pulling force [N]", ylim=(0, 4.4), yticks=np.arange(5))
    pull.legend(loc="upper right", title="Normal load")
    reduced.set(ylabel=_REDUCTION, ylim=(0, 119), yticks=(0, 50, 100))
    reduced.legend(loc="upper left")
    power.set(ylabel="Power of the amplifier [W]", ylim=(0, 1.25), yticks=(0, 0.5, 1))
    power.legend(loc="upper left")
    for axes in (pull, reduced, power):
        axes.set(xlabel=_VOLTAGE, xlim=(-0.5, 11.2), xticks=levels)
    return figure


def _over_speed() -> "Figure":
    """Draw friction without and with vibration, and its reduction, over speed."""
    figure, (force, reduced) = axes_row(2, (7.2, 3.5))
    measured = np.array([si_value(f"2.2.4-sliding-speed-{speed}") for speed in _SPEEDS])
    fine = np.union1d(measured, np.geomspace(2e-3, 0.2, 61))
    marks = np.searchsorted(fine, measured).tolist()
    dry = slow_test().friction_coefficient * si_value("2.2.4-normal-load")
    force.plot(1e3 * fine, np.full(fine.size, dry), color="0.4", linestyle=LINES[2], label="without vibration")
    gain = gain_of_slow_test()
    for index, (value, label) in enumerate(((gain, f"gain {gain:.2g}"), (1.0, "quasi-static stroke"))):
        curve = reduction(gain=value, sliding_speed=fine)
        style = curve_style(index) | {"markevery": marks, "label": label}
        force.plot(1e3 * fine, dry * (1 - curve), **style)
        reduced.plot(1e3 * fine, 100 * curve, **style)
    points: dict[str, Any] = {"fmt": MARKERS[3], "color": "black", "zorder": 4, "ms": 7}
    slowest = [published_number("2.2.4-reduction")]
    draw_printed(reduced, 1e3 * measured[:1], slowest, 100, **points, label="about 70 %, D 2.2.4")
    none = 1e3 * si_value("2.2.5-speed-of-no-reduction")
    reduced.plot(none, 0, MARKERS[6], color="black", ms=8, zorder=4, clip_on=False, label="about none, D 2.2.5")
    for axes in (force, reduced):
        axes.axvline(1e3 * si_value("2.2.4-plateau-speed"), color="0.4", linestyle=":", linewidth=1)
        axes.set(xlabel=_SPEED, xscale="log", xlim=(2, 200), xticks=(3, 10, 30, 100))
        axes.xaxis.set_major_formatter("{x:g}")
        axes.minorticks_off()
    force.set(ylabel="Friction of one plate [N]", ylim=(0, 0.85), yticks=(0, 0.2, 0.4, 0.6, 0.8))
    reduced.set(ylabel=_REDUCTION, ylim=(0, 105), yticks=(0, 25, 50, 75, 100))
    force.legend(loc="lower right")
    reduced.legend(loc="upper right")
    return figure
