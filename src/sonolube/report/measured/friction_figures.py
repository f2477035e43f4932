"""Charts of friction recordings: traces, voltage steps, loops and comparisons."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from sonolube.charts import Axis, Band, Chart, Line, Panel, Part, Points, Rule, Zone, envelope, one_panel
from sonolube.checks import Floats
from sonolube.measurement.friction.motor_current import MotorFrictionTrace
from sonolube.measurement.friction.running_in import SteadyStateOnset
from sonolube.measurement.friction.voltage_steps import VoltageStep
from sonolube.measurement.friction.windows import WindowStatistics
from sonolube.report.measured.sheet import captioned
from sonolube.vocabulary import quantities

_WIDE = (7.0, 3.2)
_MOST: Final = 20_000  # values of a loop
_FORCE: Final = Axis("Friction force", "N")
_TIME: Final = Axis("Time", "s")
_AXES: Final = {"friction_force": _FORCE, "friction_coefficient": Axis("Coefficient of friction")}


def trace_chart(
    t: Floats | None, signal: Floats | None, *, windows: WindowStatistics, steady: SteadyStateOnset | None
) -> Chart:
    """Samples over time with the means and fluctuations of windows and the begin of the steady state."""
    parts: list[Part] = []
    if t is not None and signal is not None:
        time, samples = envelope(t, signal)
        parts.append(Line(x=time, y=samples, label="samples, lowest to highest", colour="0.8", weight=0.5))
    mean, rms = windows.mean, windows.fluctuation
    parts += [
        Band(x=windows.time, low=mean - rms, high=mean + rms, label="RMS fluctuation", colour=5, opacity=0.6),
        Line(x=windows.time, y=mean, label=f"mean of {windows.window_duration:g} s"),
    ]
    if steady is not None and steady.steady:
        start = windows.time[0] + steady.start_time
        label = f"steady after {steady.sliding_distance:.3g} m"
        parts.append(Rule(value=start, label=label, colour=1, dash=1))
    return one_panel(_TIME, _axis(windows.channel), parts, size=_WIDE, legend="top", legend_columns=4)


@captioned("Trace by cycle", "One value a cycle, as the instrument gives it.")
def by_cycle_figure(cycles: Floats, signal: Floats, name: str) -> Chart:
    """Signal with one value a cycle over the number of the cycle."""
    parts = (Line(x=cycles, y=signal, weight=0.6), Points(x=cycles, y=signal, is_faint=True))
    return one_panel(Axis("Cycle"), _axis(name), parts, size=_WIDE)


@captioned(
    "Friction over voltage",
    "Mean and its standard error at each step, and the reduction of the friction without voltage.",
)
def voltage_steps_figure(steps: Sequence[VoltageStep]) -> Chart:
    """Friction and its reduction over the voltage."""
    driven = [step for step in steps if step.friction_reduction is not None]
    force = Points(
        x=_voltages(steps),
        y=np.array([step.friction_force for step in steps]),
        y_error=np.array([step.friction_force_uncertainty for step in steps]),
        sources=tuple(map(_source, steps)),
    )
    reduction = Points(
        x=_voltages(driven),
        y=np.array([100 * (step.friction_reduction or 0.0) for step in driven]),
        y_error=np.array([100 * (step.friction_reduction_uncertainty or 0.0) for step in driven]),
        sources=tuple(map(_source, driven)),
        colour=1,
        marker=1,
    )
    axes = (("Friction force", "N", force), ("Friction reduction", "%", reduction))
    panels = [
        Panel(
            x=Axis("Voltage, peak to peak", "V", lowest=0.0),
            y=Axis(label, unit, lowest=None if (points.y < 0).any() else 0.0),
            parts=(points,),
        )
        for label, unit, points in axes
    ]
    return Chart(panels=tuple(panels), size=_WIDE, columns=2)


@captioned(
    "Stick-slip at the steps of the voltage",
    "Samples in grey with the bursts of stick-slip shaded; mean fall of the force in a slip with its 95 % interval.",
)
def stick_slip_figure(t: Floats, force: Floats, steps: Sequence[VoltageStep]) -> Chart:
    """Friction over time with the bursts of stick-slip, and the fall in a slip over the voltage."""
    found = [step for step in steps if step.stick_slip.detected]
    bursts = [burst for step in found for burst in step.stick_slip.bursts]
    first, last = (np.array([getattr(burst, end) for burst in bursts]) for end in ("start_time", "end_time"))
    time, samples = envelope(t, force)
    left = (Zone(first=first, last=last, colour=1, opacity=0.35), Line(x=time, y=samples, colour="0.6", weight=0.5))
    falls = np.array([1e3 * step.stick_slip.stick_slip_amplitude for step in found])
    ends = np.array([step.stick_slip.stick_slip_amplitude_interval for step in found]).T * 1e3
    points = Points(
        x=_voltages(found),
        y=falls,
        y_error=np.abs(ends - falls),
        sources=tuple(map(_source, found)),
        colour=1,
        marker=1,
    )
    voltage = Axis("Voltage, peak to peak", "V", lowest=0.0, highest=1.05 * float(_voltages(steps).max()))
    fall = Axis("Fall in a slip", "mN", lowest=0.0, highest=1.15 * float(ends.max()))
    panels = (Panel(x=_TIME, y=_FORCE, parts=left), Panel(x=voltage, y=fall, parts=(points,)))
    return Chart(panels=panels, size=_WIDE, columns=2, widths=(2, 1))


@captioned(
    "Friction over velocity", "Every cycle of the recording; the work is the area of the loop over displacement."
)
def loops_figure(velocity: Floats, force: Floats) -> Chart:
    """Friction over velocity."""
    stride = max(1, velocity.size // _MOST)
    zero = (Rule(value=0.0, along="y", colour="0.5", dash=0), Rule(value=0.0, colour="0.5", dash=0))
    parts = (Line(x=velocity[::stride], y=force[::stride], weight=0.6), *zero)
    return one_panel(Axis("Velocity", "m/s"), _FORCE, parts, size=(4.2, 3.4))


@captioned("Friction by the motor current", "Mean in each window with its standard uncertainty.")
def motor_trace_figure(motor: MotorFrictionTrace) -> Chart:
    """Friction by the motor current over time with its uncertainty."""
    force = motor.friction_force
    points = Points(x=motor.time, y=force, y_error=motor.friction_force_uncertainty)
    return one_panel(_TIME, _FORCE, (Line(x=motor.time, y=force), points), size=_WIDE)


@captioned("Tests with and without vibration", "Each test, and the mean of its kind.")
def comparison_figure(
    without: Sequence[tuple[str, float]], with_vibration: Sequence[tuple[str, float]], level: str
) -> Chart:
    """Friction of single tests, by name, without and with vibration, and the mean of each kind."""
    parts: list[Part] = []
    for place, (tests, name) in enumerate([(without, "without"), (with_vibration, "with")]):
        values = np.array([value for _, value in tests])
        spread = np.array([0.04 * (index - (values.size - 1) / 2) for index in range(values.size)])
        parts += [
            Points(
                x=place + spread,
                y=values,
                label=f"{name}: {values.size} tests",
                colour=place,
                marker=place,
                sources=tuple(source for source, _ in tests),
            ),
            Line(x=place + np.array([-0.25, 0.25]), y=np.full(2, values.mean()), colour=place),
        ]
    kind = Axis(lowest=-0.5, highest=1.5, words=("without", "with vibration"))
    highest = max(value for _, value in (*without, *with_vibration))
    known = level in _AXES or level in quantities()
    axis = _axis(level) if known else Axis("Steady friction", "N")
    y = Axis(axis.label, axis.unit, lowest=0.0, highest=1.12 * highest)
    return one_panel(kind, y, parts, size=(3.8, 3.2))


def _axis(name: str) -> Axis:
    """Axis of a channel."""
    if name in _AXES:
        return _AXES[name]
    known = quantities().get(name)
    return Axis(name) if known is None else Axis(known.meaning, known.unit)


def _voltages(steps: Sequence[VoltageStep]) -> Floats:
    """Voltage of each step. [V]"""
    return np.array([step.voltage_peak_to_peak for step in steps])


def _source(step: VoltageStep) -> str:
    """Part of the recording that a step is."""
    return f"{step.start_time:.4g} to {step.end_time:.4g} s"
