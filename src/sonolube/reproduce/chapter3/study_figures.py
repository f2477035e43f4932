"""Figures of the parametric study: the identified tribometer as figures 3.13 to 3.18 show the dissertation's."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.contact import decay_length
from sonolube.figure import COLOURS, LINES, ReportFigure
from sonolube.reproduce.chapter3.study_results import (
    STEPS_PER_PERIOD,
    from_rest,
    over_frequency,
    over_load,
    over_speed,
    over_voltage,
    over_waveform,
    power_over_frequency,
)
from sonolube.rig.study_figures import (
    frequency_figure,
    load_figure,
    power_figure,
    speed_figure,
    voltage_figure,
    waveform_figure,
)
from sonolube.validation.inputs import said
from sonolube.validation.tribometer_rig import IDENTIFIED_NOTE, tribometer_rig

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LOST = 0.01  # share of the load below which a contact counts as lost


def study_figures() -> tuple[ReportFigure, ...]:
    """Return the figures of sections 3.3.4 and 3.3.5."""
    return (
        ReportFigure(
            name="figure-3-13-start-up",
            chapter=3,
            title="Start-up of the tribometer",
            caption="Tip and reaction mass from rest at 28 V and 22 kHz; bands are the extremes of each period. The "
            f"stack stands after a millisecond, the arm after some thirty. {IDENTIFIED_NOTE}.",
            draw=_start_up,
        ),
        ReportFigure(
            name="figure-3-15-voltage",
            chapter=3,
            title="Drive voltage",
            caption="The mean rises with the vibration until the mean force is the load again, so that the contact "
            "parts above rather than presses below. Asperity stick-slip, 22 kHz, 20.3 mm/s. Text of D 3.3.5: "
            "hopping above 3.8 µm, and friction falls significantly up to 20 V.",
            draw=_over_voltage,
        ),
        ReportFigure(
            name="figure-3-16-speed",
            chapter=3,
            title="Sliding speed",
            caption="Faster sliding leaves less reduction at every voltage. Against the velocity ratio the curves do "
            "not fall on one another, as those of a kinematic friction model would: contact memory is a second length.",
            draw=lambda: speed_figure(over_speed()),
        ),
        ReportFigure(
            name="figure-3-17-frequency",
            chapter=3,
            title="Drive frequency",
            caption="Around the resonance friction falls in a “v”; over the amplifier's power the tips of the “v”s "
            "form the envelope that the text describes. Asperity stick-slip, 20.3 mm/s.",
            draw=lambda: frequency_figure(over_frequency()),
        ),
        ReportFigure(
            name="figure-3-17-least-power",
            chapter=3,
            title="Voltage and power for one reduction",
            caption="What brings friction down as far as the tests' 28 V at 22 kHz do. The amplifier's power has its "
            "least at resonance; the power that stays in the rig does not, for it goes with the square of the "
            "frequency at a given amplitude. Lines end with the last frequencies at which 200 V suffice.",
            draw=lambda: power_figure(power_over_frequency()),
        ),
        ReportFigure(
            name="figure-3-18-waveform",
            chapter=3,
            title="Waveform",
            caption="0 to 200 V at 22 kHz. The tip moves as a sine under all four waveforms, by as much as each has of "
            "it: 4/π (square), 1, 8/π² (triangle) and 2/π (sawtooth).",
            draw=lambda: waveform_figure(over_waveform()),
        ),
    )


def load_figures() -> tuple[ReportFigure, ...]:
    """Return the figure of section 4.1.2 on load."""
    return (
        ReportFigure(
            name="figure-4-7-load",
            chapter=4,
            title="Normal load, hung on the arm",
            caption="The reduction does not depend on the load: force and its decay length keep their proportion. The "
            "arm's natural frequency passes 100 Hz near 6.5 N, where the text sees the most reduction, but nothing "
            "in the model shakes the arm. Band: loads at which the text has the peak.",
            draw=_over_load,
        ),
    )


def _start_up() -> "Figure":
    from matplotlib.figure import Figure

    marched = from_rest().trajectory
    figure = Figure(figsize=(7.2, 3.5))
    whole, last = figure.subplots(1, 2)
    heights = {"tip": marched.contact.displacement, "reaction mass": marched.states.coordinates[:, 1]}
    milliseconds = 1e3 * marched.time
    for index, (name, x) in enumerate(heights.items()):
        periods = (x.size - 1) // STEPS_PER_PERIOD
        steps = 1e6 * x[1 : 1 + periods * STEPS_PER_PERIOD].reshape(periods, STEPS_PER_PERIOD)
        ends = milliseconds[STEPS_PER_PERIOD::STEPS_PER_PERIOD][:periods]
        whole.fill_between(
            ends, steps.min(axis=1), steps.max(axis=1), color=COLOURS[index], alpha=0.6, linewidth=0.3, label=name
        )
        end = 4 * STEPS_PER_PERIOD + 1
        microseconds = 1e6 * (marched.time[-end:] - marched.time[-end])
        last.plot(microseconds, 1e6 * x[-end:], linestyle=LINES[index], color=COLOURS[index], label=name)
    stated = 1e3 * said("3.3.4-settling-time").value
    whole.axvline(stated, ymax=0.8, color="0.3", linestyle=":", label="steady state in D 3.3.4")
    whole.set(xlabel="Time [ms]", ylabel="Displacement [µm]", ylim=(-3.4, 6.4))
    whole.legend(loc="upper right")
    last.set(xlabel="Time in the last four periods [µs]", ylabel="Displacement [µm]", ylim=(-3.4, 6.4))
    last.legend(loc="upper right")
    return figure


def _over_voltage() -> "Figure":
    figure = voltage_figure(over_voltage())
    period, _, ratio, _ = figure.axes
    lost = float(decay_length(tribometer_rig().contact)) * np.log(1 / _LOST)
    for index, (height, label) in enumerate(
        ((said("3.3.5-hopping-displacement").value, "hopping, D 3.3.5"), (lost, "force at 1 % of the load"))
    ):
        period.axhline(1e6 * height, color="0.3", linestyle=LINES[1 + 2 * index], linewidth=1, label=label)
    period.legend(loc="upper center")
    knee = said("3.3.5-voltage-knee").value
    ratio.axvline(knee, color="0.3", linestyle=":", label="20 V, D 3.3.5")
    ratio.legend(loc="upper right")
    return figure


def _over_load() -> "Figure":
    figure = load_figure(over_load())
    for axes in figure.axes:
        axes.axvspan(
            said("4.1.2-peak-load-1").value, said("4.1.2-peak-load-2").value, color="0.88", zorder=0, label="D 4.1.2"
        )
    figure.axes[0].legend(loc="lower right")
    return figure
