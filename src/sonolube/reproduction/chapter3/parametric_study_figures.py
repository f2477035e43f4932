"""Sections 3.3.4 and 3.3.5, the parametric study: figures of the identified tribometer as D figures 3.13 to 3.18."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from sonolube.charts import Rule, draw_chart
from sonolube.facts.published import si_value
from sonolube.figure import COLOURS, ReportFigure
from sonolube.models.contact import decay_length
from sonolube.reproduction.chapter3 import tribometer_response
from sonolube.reproduction.chapter3.parametric_study_rows import LOST_CONTACT
from sonolube.reproduction.plots import axes_row, line_style
from sonolube.reproduction.tribometer_rigs import IDENTIFIED_NOTE, tribometer_rig
from sonolube.rig.study_figures import command_chart, frequency_chart, power_chart, speed_chart, waveform_chart

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def parametric_study_figures() -> Iterator[ReportFigure]:
    """Figures of sections 3.3.4 and 3.3.5."""
    yield ReportFigure(
        name="figure-3-13-start-up",
        title="Start-up of the tribometer",
        caption="Tip and reaction mass from rest at 28 V and 22 kHz; bands are the extremes of each period. The "
        f"stack settles in a millisecond, the arm in some thirty. {IDENTIFIED_NOTE}.",
        draw=_start_up,
    )
    yield ReportFigure(
        name="figure-3-15-voltage",
        title="Drive voltage",
        caption="The mean rises with the vibration until the mean force is the load again, so that the contact "
        "parts above rather than presses below. Asperity stick-slip, 22 kHz, 20.3 mm/s. Text of D 3.3.5: "
        "hopping above 3.8 µm, and friction falls significantly up to 20 V.",
        draw=_voltage,
    )
    yield ReportFigure(
        name="figure-3-16-speed",
        title="Sliding speed",
        caption="Faster sliding leaves less reduction at every voltage. Against the velocity ratio the curves do "
        "not coincide, as those of a kinematic friction model would: contact memory is a second length.",
        draw=lambda: draw_chart(speed_chart(tribometer_response.response_over_speed())),
    )
    yield ReportFigure(
        name="figure-3-17-frequency",
        title="Drive frequency",
        caption="Around the resonance friction falls in a “v”; over the amplifier's power the tips of the “v”s "
        "form the envelope that the text describes. Asperity stick-slip, 20.3 mm/s.",
        draw=lambda: draw_chart(frequency_chart(tribometer_response.response_over_frequency())),
    )
    yield ReportFigure(
        name="figure-3-17-least-power",
        title="Voltage and power for one reduction",
        caption="Voltage and powers at the friction of the tests' 28 V at 22 kHz. The amplifier's power has its "
        "minimum at resonance; the dissipated power does not, for it is proportional to the square of the "
        "frequency at a given amplitude. Lines end with the last frequencies at which 200 V suffice.",
        draw=lambda: draw_chart(power_chart(tribometer_response.least_power_over_frequency())),
    )
    yield ReportFigure(
        name="figure-3-18-waveform",
        title="Waveform",
        caption="0 to 200 V at 22 kHz. The tip moves as a sine under all four waveforms, with the amplitude of "
        "their fundamentals: 4/π (square), 1, 8/π² (triangle) and 2/π (sawtooth).",
        draw=lambda: draw_chart(waveform_chart(tribometer_response.response_over_waveform())),
    )


def _start_up() -> "Figure":
    """Draw the envelopes of tip and reaction mass during the start-up, and their last four periods."""
    trajectory = tribometer_response.start_up_from_rest().trajectory
    figure, (whole, last) = axes_row(2, (7.2, 3.5))
    displacements = {"tip": trajectory.contact.displacement, "reaction mass": trajectory.states.coordinates[:, 1]}
    end = 4 * tribometer_response.STEPS_PER_PERIOD + 1
    for index, (name, x) in enumerate(displacements.items()):
        band = tribometer_response.envelope(displacement=x)
        ms, low, high = 1e3 * band.time, 1e6 * band.low, 1e6 * band.high
        whole.fill_between(ms, low, high, color=COLOURS[index], alpha=0.6, linewidth=0.3, label=name)
        microseconds = 1e6 * (trajectory.time[-end:] - trajectory.time[-end])
        last.plot(microseconds, 1e6 * x[-end:], **line_style(index), label=name)
    settling = 1e3 * si_value("3.3.4-settling-time")
    whole.axvline(settling, ymax=0.8, color="0.3", linestyle=":", label="steady state in D 3.3.4")
    for axes, xlabel in ((whole, "Time [ms]"), (last, "Time in the last four periods [µs]")):
        axes.set(xlabel=xlabel, ylabel="Displacement [µm]", ylim=(-3.4, 6.4))
        axes.legend(loc="upper right")
    return figure


def _voltage() -> "Figure":
    """Draw the response over voltage with the statements of D 3.3.5."""
    lost = float(decay_length(tribometer_rig().contact)) * np.log(1 / LOST_CONTACT)
    hopping = 1e6 * si_value("3.3.5-hopping-displacement")
    chart = command_chart(tribometer_response.response_over_voltage())
    chart = chart.with_parts(
        0,
        Rule(along="y", value=hopping, label="hopping, D 3.3.5", dash=1),
        Rule(along="y", value=1e6 * lost, label="force at 1 % of the load", dash=3),
    )
    return draw_chart(chart.with_parts(2, Rule(value=si_value("3.3.5-voltage-knee"), label="20 V, D 3.3.5")))
