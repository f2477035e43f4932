"""Figures of friction recordings: traces, voltage steps, loops and comparisons."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.figure import COLOURS, MARKERS, subplots
from sonolube.measurement.friction.motor_current import MotorFrictionTrace
from sonolube.measurement.friction.running_in import SteadyStateOnset
from sonolube.measurement.friction.voltage_steps import VoltageStep
from sonolube.measurement.friction.windows import WindowStatistics
from sonolube.report.measured.sheet import captioned
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_BINS = 1500  # of a trace, more than a page resolves
_WIDE = (7.0, 3.2)
_LABELS = {"friction_force": "friction force (N)", "friction_coefficient": "coefficient of friction"}


def trace(
    t: Floats | None, signal: Floats | None, *, windows: WindowStatistics, steady: SteadyStateOnset | None
) -> "Figure":
    """Samples over time with the means and fluctuations of windows and the begin of the steady state."""
    figure, axes = subplots(figsize=_WIDE)
    if t is not None and signal is not None:
        middle, low, high = _envelope(t, signal)
        axes.fill_between(middle, low, high, color="0.8", linewidth=0.4, label="samples, lowest to highest")
    mean, rms = windows.mean, windows.fluctuation
    axes.fill_between(
        windows.time, mean - rms, mean + rms, color=COLOURS[5], alpha=0.6, linewidth=0, label="RMS fluctuation"
    )
    axes.plot(windows.time, mean, color=COLOURS[0], label=f"mean of {windows.window_duration:g} s")
    if steady is not None and steady.steady:
        start = windows.time[0] + steady.start_time
        axes.axvline(start, color=COLOURS[1], linestyle="--", label=f"steady after {steady.sliding_distance:.3g} m")
    axes.set(xlabel="time (s)", ylabel=_LABELS.get(windows.channel, windows.channel))
    figure.legend(loc="outside upper center", ncols=4)
    return figure


@captioned("Trace by cycle", "One value a cycle, as the instrument gives it.")
def by_cycle(cycles: Floats, signal: Floats, name: str) -> "Figure":
    """Signal with one value a cycle over the number of the cycle."""
    figure, axes = subplots(figsize=_WIDE)
    axes.plot(cycles, signal, marker=".", linewidth=0.8, markersize=3)
    axes.set(xlabel="cycle", ylabel=_LABELS.get(name, name))
    return figure


@captioned(
    "Friction over voltage",
    "Mean and its standard error at each step, and the reduction of the friction without voltage.",
)
def voltage_steps(steps: Sequence[VoltageStep]) -> "Figure":
    """Friction and its reduction over the voltage."""
    figure, (left, right) = subplots(1, 2, figsize=_WIDE)
    left.errorbar(
        [step.voltage_peak_to_peak for step in steps],
        [step.friction_force for step in steps],
        yerr=[step.friction_force_uncertainty for step in steps],
        marker=MARKERS[0],
        linestyle="none",
        capsize=2,
    )
    driven = [step for step in steps if step.friction_reduction is not None]
    right.errorbar(
        [step.voltage_peak_to_peak for step in driven],
        [100 * (step.friction_reduction or 0.0) for step in driven],
        yerr=[100 * (step.friction_reduction_uncertainty or 0.0) for step in driven],
        marker=MARKERS[1],
        color=COLOURS[1],
        linestyle="none",
        capsize=2,
    )
    left.set(xlabel="voltage, peak to peak (V)", ylabel="friction force (N)")
    right.set(xlabel="voltage, peak to peak (V)", ylabel="friction reduction (%)")
    for axes in (left, right):
        axes.set(xlim=(0, None), ylim=(min(0.0, axes.get_ylim()[0]), 1.06 * axes.get_ylim()[1]))
    return figure


@captioned(
    "Stick-slip at the steps of the voltage",
    "Samples in grey with the bursts of stick-slip shaded; mean fall of the force in a slip with its 95 % interval.",
)
def stick_slip(t: Floats, force: Floats, steps: Sequence[VoltageStep]) -> "Figure":
    """Friction over time with the bursts of stick-slip, and the fall in a slip over the voltage."""
    figure, (left, right) = subplots(1, 2, figsize=_WIDE, width_ratios=(2, 1))
    middle, low, high = _envelope(t, force)
    left.fill_between(middle, low, high, color="0.7", linewidth=0.4)
    found = [step for step in steps if step.stick_slip.detected]
    for burst in (burst for step in found for burst in step.stick_slip.bursts):
        left.axvspan(burst.start_time, burst.end_time, color=COLOURS[1], alpha=0.35, linewidth=0)
    falls = np.array([1e3 * step.stick_slip.stick_slip_amplitude for step in found])
    ends = np.array([step.stick_slip.stick_slip_amplitude_interval for step in found]).T * 1e3
    right.errorbar(
        [step.voltage_peak_to_peak for step in found],
        falls,
        yerr=np.abs(ends - falls),
        marker=MARKERS[1],
        color=COLOURS[1],
        linestyle="none",
        capsize=2,
    )
    left.set(xlabel="time (s)", ylabel="friction force (N)")
    right.set(xlabel="voltage, peak to peak (V)", ylabel="fall in a slip (mN)")
    right.set_xlim(0, 1.05 * max(step.voltage_peak_to_peak for step in steps))
    right.set_ylim(0, 1.15 * float(ends.max()))
    return figure


@captioned(
    "Friction over velocity", "Every cycle of the recording; the work is the area of the loop over displacement."
)
def loops(velocity: Floats, force: Floats) -> "Figure":
    """Friction over velocity."""
    figure, axes = subplots(figsize=(4.2, 3.4))
    stride = max(1, velocity.size // 20_000)
    axes.plot(velocity[::stride], force[::stride], linewidth=0.8)
    axes.axhline(0, color="0.5", linewidth=0.6)
    axes.axvline(0, color="0.5", linewidth=0.6)
    axes.set(xlabel="velocity (m/s)", ylabel="friction force (N)")
    return figure


@captioned("Friction by the motor current", "Mean in each window with its standard uncertainty.")
def motor_trace(motor: MotorFrictionTrace) -> "Figure":
    """Friction by the motor current over time with its uncertainty."""
    figure, axes = subplots(figsize=_WIDE)
    axes.errorbar(
        motor.time, motor.friction_force, yerr=motor.friction_force_uncertainty, marker=MARKERS[0], elinewidth=0.8
    )
    axes.set(xlabel="time (s)", ylabel="friction force (N)")
    return figure


@captioned("Tests with and without vibration", "Each test, and the mean of its kind.")
def comparison(without: Sequence[float], with_vibration: Sequence[float], level: str) -> "Figure":
    """Friction of single tests without and with vibration, and the mean of each kind."""
    figure, axes = subplots(figsize=(3.8, 3.2))
    for place, (tests, name) in enumerate([(without, "without"), (with_vibration, "with")]):
        spread = 0.04 * (np.arange(len(tests)) - (len(tests) - 1) / 2)
        axes.plot(place + spread, tests, MARKERS[place], color=COLOURS[place], label=f"{name}: {len(tests)} tests")
        axes.hlines(float(np.mean(tests)), place - 0.25, place + 0.25, color=COLOURS[place])
    label = _LABELS.get(level) or (quantities()[level].meaning if level in quantities() else "steady friction (N)")
    axes.set(xticks=[0, 1], xticklabels=["without", "with vibration"], ylabel=label, xlim=(-0.5, 1.5))
    axes.set_ylim(0, 1.06 * axes.get_ylim()[1])
    return figure


def _envelope(time: Floats, signal: Floats) -> tuple[Floats, Floats, Floats]:
    """Middle, lowest and highest sample of bins of equal numbers, finer than a page resolves."""
    size = max(1, -(-time.size // _BINS))
    starts = np.arange(0, time.size, size)
    low = np.fmin.reduceat(signal, starts)
    high = np.fmax.reduceat(signal, starts)
    middle = (time[starts] + time[np.minimum(starts + size, time.size) - 1]) / 2
    return middle, low, high
