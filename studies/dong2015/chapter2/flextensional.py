"""Section 2.2, the flextensional actuator between two plates: rows and figures of pull, power, velocity and speed.

Of its vibration only the quasi-static stroke is printed, so that the gain at resonance is free. One gain must agree
with both statements on friction: the reduction at 3.5 mm/s, and the speed at which the reduction vanishes.
"""

from collections.abc import Iterator
from dataclasses import replace
from math import pi
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from dong2015.plots import axes_row, curve_style, draw_printed, line_style, report_figure
from dong2015.row import Row, RowKind, default_model_row, published_formula_row, undetermined_row
from sonolube.checks import Floats
from sonolube.facts.metrics import peak_vibration_velocity
from sonolube.facts.published import published_number, si_value
from sonolube.figure import LINES, MARKERS, ReportFigure
from sonolube.models.actuator import linear_amplifier_power
from sonolube.models.contact import decay_length, separation
from sonolube.models.friction import EMPIRICAL_MEMORY_LENGTH, sine_stick_slip_ratio
from sonolube.validation.published_tests import FLEXTENSIONAL_GAINS, FrictionTest, friction_tests

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_EQUAL_SPEEDS: Final = (
    "Equal speeds of sliding and vibration; of the vibration only the stroke far from resonance is printed, not the "
    "gain at resonance."
)


def flextensional_rows() -> Iterator[Row]:
    """Yield the rows of section 2.2."""
    yield _pulling_force()
    yield from _powers()
    yield from _velocities()
    yield from _saturation()
    yield from _vanishing_reduction()


def gain_of_slow_test() -> float:
    """Gain at resonance at which asperity stick-slip has the friction measured at 3.5 mm/s. []"""
    test = slow_test()
    return float(brentq(lambda gain: _ratio(test, gain) - test.friction_ratio, 1e-3, FLEXTENSIONAL_GAINS[1]))


def slow_test() -> FrictionTest:
    """Test H-1, 2.6 N and 3.5 mm/s."""
    return friction_tests("H")[0]


def stick_slip_ratio(test: FrictionTest, *, gain: ArrayLike = 1.0, sliding_speed: ArrayLike | None = None) -> Floats:
    """Friction ratio of a test by asperity stick-slip at a gain of its amplitude, at its own or at other speeds. []"""
    return sine_stick_slip_ratio(
        decay_length=_decay_length(test),
        vibration_amplitude=np.asarray(gain, dtype=np.float64) * test.vibration_amplitude,
        frequency=test.frequency,
        sliding_speed=test.sliding_speed if sliding_speed is None else sliding_speed,
    )


def _ratio(test: FrictionTest, gain: float = 1.0) -> float:
    """Friction ratio of a test by asperity stick-slip at a gain of the stroke. []"""
    return float(stick_slip_ratio(test, gain=gain))


def _decay_length(test: FrictionTest) -> float:
    """Decay length of the contact of a test. [m]"""
    return float(decay_length(test.contact, separation=separation(test.contact, normal_load=test.normal_load)))


def _pulling_force() -> Row:
    """Pulling force over the friction of one plate from the balance of forces."""
    test = slow_test()
    friction = test.friction_coefficient * test.normal_load
    note = (
        "Balance of forces: either plate presses with the same load and rubs with the same coefficient; the actuator's "
        "own weight is left out."
    )
    return published_formula_row("2.2.2-pulling-force-factor", (friction + friction) / friction, note)


def _powers() -> Iterator[Row]:
    """Yield the powers of the three levels by D 1.9."""
    for level in (1, 2, 3):
        power = linear_amplifier_power(
            capacitance=si_value("2.2.2-capacitance"),
            voltage_maximum=si_value(f"2.2.3-voltage-maximum-{level}"),
            voltage_peak_to_peak=si_value("2.2.5-voltage-peak-to-peak"),
            frequency=si_value("2.2.2-resonance"),
        )
        note = "D 1.9: capacitance times both voltages times frequency."
        yield published_formula_row(f"2.2.5-power-{level}", float(power), note)


def _velocities() -> Iterator[Row]:
    """Yield the peak vibration velocity, and the speed of no reduction that equals it."""
    test = slow_test()
    of_amplitude, of_stroke = (
        float(peak_vibration_velocity(frequency=test.frequency, vibration_amplitude=amplitude))
        for amplitude in (test.vibration_amplitude, 2 * test.vibration_amplitude)
    )
    most = of_amplitude * FLEXTENSIONAL_GAINS[1]
    note = (
        f"2 pi f a, a half the stroke at this voltage, without the gain at resonance, which is not printed; the whole"
        f" stroke gives {1e3 * of_stroke:.0f} mm/s. Possible: gains up to {FLEXTENSIONAL_GAINS[1]:g}."
    )
    yield published_formula_row("2.2.5-vibration-velocity", of_amplitude, note, possible=(of_amplitude, most))
    note = f"{_EQUAL_SPEEDS} Possible: gains up to {FLEXTENSIONAL_GAINS[1]:g}."
    yield published_formula_row(
        "2.2.5-speed-of-no-reduction",
        of_amplitude,
        note,
        possible=(of_amplitude, FLEXTENSIONAL_GAINS[1] * of_amplitude),
    )


def _saturation() -> Iterator[Row]:
    """Yield the reduction at the three levels, which differ in their highest voltage alone."""
    yield undetermined_row(
        "2.2.4-reduction", "the friction forces, which are only plotted, and the roughness.", kind=RowKind.DEFAULT_MODEL
    )
    test, gain = slow_test(), gain_of_slow_test()
    note = (
        f"Asperity stick-slip at {1e3 * test.sliding_speed:g} mm/s, without gain at resonance. All three levels have 4 "
        f"V peak to peak and so one stroke: saturation is the only difference. A gain of {gain:.2g} would give the "
        "measured reduction."
    )
    at_largest = 1 - _ratio(test, FLEXTENSIONAL_GAINS[1])
    yield default_model_row("2.2.6-reduction", 1 - _ratio(test), note, possible=(1 - _ratio(test), at_largest))


def _vanishing_reduction() -> Iterator[Row]:
    """Yield the speed from which asperity stick-slip has no reduction, absolute and over the vibration velocity."""
    test, gain = slow_test(), gain_of_slow_test()
    fast = replace(test, sliding_speed=si_value("2.2.5-speed-of-no-reduction"))
    reduction = 1 - _ratio(fast, gain)
    velocity_ratio = EMPIRICAL_MEMORY_LENGTH / _decay_length(test)  # the friction ratio is 1 from omega a D_c/l on
    velocity = 2 * pi * test.frequency * test.vibration_amplitude
    yield default_model_row(
        "2.2.5-speed-of-no-reduction",
        gain * velocity_ratio * velocity,
        f"Asperity stick-slip, speed from which it has no reduction, with the gain at resonance of {gain:.2g} of its "
        f"reduction at {1e3 * test.sliding_speed:g} mm/s, with which it still has {100 * reduction:.0f} % at "
        f"{1e3 * fast.sliding_speed:g} mm/s; without gain {1e3 * velocity_ratio * velocity:.0f} mm/s.",
        suffix="asperity-stick-slip",
    )
    note = "Asperity stick-slip: memory length over decay length, at any amplitude and frequency."
    yield default_model_row("2.2.5-littmann-ratio", velocity_ratio, note, suffix="asperity-stick-slip")


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
    yield report_figure("figure-2-13-voltage", _over_voltage, assumed=assumed, gain=gain)
    yield report_figure("figure-2-14-speed", _over_speed, assumed=assumed, gain=gain)


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
