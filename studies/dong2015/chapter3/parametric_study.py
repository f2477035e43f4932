"""Sections 3.3.4 to 3.3.6, the parametric study: rows and figures of the identified tribometer."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from dong2015.chapter3 import tribometer_response
from dong2015.plots import axes_row, line_style, report_figure
from dong2015.published_rigs import IDENTIFIED_NOTE, tribometer_rig
from dong2015.row import Row, default_model_row, published_formula_row, published_model_row
from sonolube.charts import Rule, draw_chart
from sonolube.checks import Floats
from sonolube.facts.published import PrintedNumber, published_value, si_value
from sonolube.figure import COLOURS, ReportFigure
from sonolube.models.contact import cube_tangential_stiffness, decay_length, normal_force, separation
from sonolube.rig import STUDY_CHARTS, operating_points
from sonolube.validation.contacts import wear_contact

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LOST_CONTACT: Final = 0.01
"""Contact force over the load below which an exponentially decaying contact counts as lost. []"""
_DECIMALS: Final = 4  # of a friction ratio, the accuracy of the means of the friction models
_SETTLED: Final = 0.02  # of the amplitude
_ONE_OF_THE_FACTS: Final = f"{IDENTIFIED_NOTE}, of which this is one."
_IDENTIFIED: Final = "masses, springs and dampers, with other published facts"
_AS_PRINTED: Final = "dong_2015_full_period"  # D 3.46 to 3.48 as printed


def parametric_study_rows() -> Iterator[Row]:
    """Yield the rows of sections 3.3.4 to 3.3.6."""
    yield _loss_of_contact()
    yield from _start_up()
    yield from _friction_errors()
    yield from _voltage()
    yield from _speed()
    yield from _frequency()
    yield _power()
    yield from _waveforms()


def _loss_of_contact() -> Row:
    """Row of the displacement of "hopping" of section 3.3.5, at which k_t "becomes virtually zero"."""
    contact, load = wear_contact(), si_value("table-3.2-normal_load-1")
    printed = published_value("3.3.5-hopping-displacement")
    at_rest, reach = separation(contact, normal_load=load), printed.number.value
    apart, rest, nearest = (
        float(cube_tangential_stiffness(contact, separation=at_rest + x)) for x in (reach, 0.0, -reach)
    )
    force = float(normal_force(contact, separation=at_rest + reach) / load)
    lost = float(decay_length(contact)) * math.log(1 / LOST_CONTACT)
    note = (
        f"Tangential stiffness at a displacement of {printed.number.text} um over its peak in such a period, which is "
        f"virtually zero if below {LOST_CONTACT:.0%}; over its value at rest {apart / rest:.3f}. The surfaces do not "
        f"part: {force:.0%} of the normal force remain, 1 % at {lost * 1e6:.1f} um, for an exponential height law has "
        "no end"
    )
    zero = PrintedNumber(
        text=f"{LOST_CONTACT:g}", value=LOST_CONTACT, low=0.0, high=LOST_CONTACT, rounding_half_width=0.0
    )
    virtually_zero = replace(printed, quantity="", unit="", number=zero)
    return published_formula_row(virtually_zero, apart / nearest, note)


def _start_up() -> Iterator[Row]:
    """Yield settling time, residual frequency and amplitude of the start-up."""
    started = tribometer_response.start_up_from_rest()
    upper = tribometer_response.envelope(displacement=started.trajectory.contact.displacement)
    unsettled = np.abs(upper.high - upper.high[-1]) > _SETTLED * started.vibration_amplitude
    note = (
        "From rest, until the upper envelope of the tip stays within 2 % of the amplitude. The stack itself settles in "
        f"{started.settling_time * 1e3:.1f} ms; the rest is the arm, whose damping no published fact determines."
    )
    yield default_model_row("3.3.4-settling-time", float(upper.time[np.flatnonzero(unsettled)[-1]]), note)
    note = f"Slow oscillation of the start-up, damped; in this model it decays, in D it persists. {_ONE_OF_THE_FACTS}"
    yield default_model_row("3.3.4-residual-frequency", started.beat_frequency, note, fitted=_IDENTIFIED)
    note = f"At the tests' 28.02 V and 22 kHz. {_ONE_OF_THE_FACTS}"
    yield default_model_row(
        "3.3.4-amplitude", float(operating_points(tribometer_rig()).vibration_amplitude), note, fitted=_IDENTIFIED
    )


def _friction_errors() -> Iterator[Row]:
    """Yield the largest error of friction over Table 2.3."""
    as_printed, stick_slip = (_errors(friction_model) for friction_model in (_AS_PRINTED, "asperity_stick_slip"))
    note = (
        "Largest error of friction over Table 2.3, with D 3.46 to 3.48 on the computed motion: "
        f"{_percents(as_printed)} at the three speeds. Asperity stick-slip, whose memory length was fitted to this "
        f"table among others, errs by {_percents(stick_slip)}. A shift of the mean gap changes the stiffness at all "
        f"three speeds by one factor, so that no mean gap brings the largest error below {_least_error(as_printed)}."
    )
    for published in ("3.3.4-error", "3.3.6-error"):
        yield published_model_row(published, float(np.abs(as_printed).max()), note)


def _least_error(errors: Floats) -> str:
    r"""Least largest error that one common factor of the computed values leaves, as text in per cent.

    With q = 1 + error, the factor 2/(max q + min q) leaves (max q - min q)/(max q + min q) at both ends.
    """
    q = 1 + errors
    return f"{100 * (q.max() - q.min()) / (q.max() + q.min()):.0f} %"


def _errors(friction_model: str) -> Floats:
    """Relative errors of friction over Table 2.3 by a friction model. []"""
    speeds, off, on = (
        np.array([si_value(f"table-2.3-{column}-{row}") for row in (first, first + 2, first + 4)])
        for column, first in (("sliding_speed", 2), ("friction_force", 1), ("friction_force", 2))
    )
    points = operating_points(tribometer_rig(friction_model=friction_model), sliding_speed=speeds)
    return np.asarray(points.raw_friction_ratio * off / on - 1)


def _voltage() -> Iterator[Row]:
    """Yield knee, order and saturation of friction over the voltage."""
    volts, ratios = _voltages_and_ratios("asperity_stick_slip")
    knees = {model: _knee(*_voltages_and_ratios(model)) for model in ("kinematic", _AS_PRINTED)}
    note = (
        "Voltage at which the curve of figure 3.15 (e) is farthest below its chord from 0 to 200 V, by asperity "
        f"stick-slip. The friction model governs it: kinematic {knees['kinematic']:.0f} V; as printed friction is "
        f"least near {knees[_AS_PRINTED]:.0f} V and grows beyond."
    )
    yield default_model_row("3.3.5-voltage-knee", _knee(volts, ratios), note)
    note = (
        "Largest of all steps of 2 V from 0 to 200 V. As printed, D 3.46 to 3.48 would raise friction beyond "
        f"{knees[_AS_PRINTED]:.0f} V, to {_voltages_and_ratios(_AS_PRINTED)[1][-1]:.2f} at 200 V."
    )
    yield default_model_row("3.3.5-voltage-order", _largest_step(ratios), note)
    knee = int(np.searchsorted(volts, si_value("3.3.5-voltage-knee")))
    fall = np.array([ratios[0] - ratios[knee], ratios[knee] - ratios[-1]])
    slopes = fall / np.array([volts[knee], volts[-1] - volts[knee]])
    note = f"Friction ratio {ratios[knee]:.3f} at 20 V, {ratios[-1]:.3f} at 200 V, by asperity stick-slip."
    yield default_model_row("3.3.5-voltage-saturation", float(slopes[1] / slopes[0]), note)


def _voltages_and_ratios(friction_model: str) -> tuple[Floats, Floats]:
    """Voltages in V and friction ratios by a friction model."""
    response = tribometer_response.response_over_voltage(friction_model)
    return response["voltage_peak_to_peak"].values, np.round(response["raw_friction_ratio"].values, _DECIMALS)


def _knee(volts: Floats, ratios: Floats) -> float:
    """Voltage at which a falling curve is farthest below its chord. [V]"""
    chord = ratios[0] + (ratios[-1] - ratios[0]) * volts / volts[-1]
    return float(volts[np.argmax(chord - ratios)])


def _speed() -> Iterator[Row]:
    """Yield the orders of friction over speed and voltage."""
    ratios = np.round(tribometer_response.response_over_speed()["raw_friction_ratio"].values, _DECIMALS)
    note = f"Largest of all steps, 1 mm/s to 1 m/s at {_curves()}, by asperity stick-slip; 1 without any reduction."
    yield default_model_row("3.3.5-speed-order", _largest_step(ratios[:, ::-1].T), note)
    yield default_model_row("3.3.5-speed-voltage-order", _largest_step(ratios), note)


def _frequency() -> Iterator[Row]:
    """Yield friction at resonance over that elsewhere, and its order over the voltage."""
    response, peak = tribometer_response.response_over_frequency(), tribometer_response.resonance()
    f, ratios = response["frequency"].values, np.round(response["raw_friction_ratio"].values, _DECIMALS)
    at_peak, elsewhere = ratios[:, peak.nearest(f)], ratios[:, peak.outside(f)].min(axis=1)
    note = (
        f"At {peak.natural_frequency / 1e3:.2f} kHz over the least outside its half-power bandwidth, 1 to 100 kHz; "
        f"largest of {_curves()}, by asperity stick-slip."
    )
    yield default_model_row("3.3.5-resonance-friction", float((at_peak / elsewhere).max()), note)
    yield default_model_row(
        "3.3.5-resonance-voltage-order",
        _largest_step(ratios.min(axis=1)),
        "Minima of the curves: " + ", ".join(f"{ratio:.3f}" for ratio in ratios.min(axis=1)) + f" at {_curves()}.",
    )


def _power() -> Row:
    """Amplifier's power at resonance over the least elsewhere, for one reduction of friction."""
    study, peak = tribometer_response.least_power_over_frequency(), tribometer_response.resonance()
    f, amplifier, dissipated = (study[name].values for name in ("frequency", "charging_power", "dissipated_power"))
    at_peak, possible = peak.nearest(f), ~np.isnan(amplifier)
    least = int(np.nanargmin(dissipated))
    ratio = float(study["friction_ratio"].values[at_peak])
    return default_model_row(
        "3.3.5-resonance-power",
        float(amplifier[at_peak] / amplifier[peak.outside(f) & possible].min()),
        f"Power by D 1.9 for a friction ratio of {ratio:.3f} at resonance, {amplifier[at_peak]:.2g} W, over the "
        f"least outside the half-power bandwidth; {f[possible].min() / 1e3:.1f} to {f[possible].max() / 1e3:.1f} kHz "
        f"do it with 200 V or less. The dissipated power, {dissipated[at_peak]:.0f} W, falls with frequency instead, "
        f"to {dissipated[least]:.0f} W at {f[least] / 1e3:.1f} kHz.",
    )


def _waveforms() -> Iterator[Row]:
    """Yield the order of friction over the waveforms."""
    ratios = _waveform_ratios("asperity_stick_slip")
    note = (
        f"0 to 200 V at 22 kHz and 20.3 mm/s, by asperity stick-slip: {_listed(ratios)}. The resonance transmits the "
        f"fundamental alone. As printed, D 3.46 to 3.48 reverse the order: {_listed(_waveform_ratios(_AS_PRINTED))}."
    )
    for waveform, next_waveform in (("square", "sine"), ("sine", "triangle"), ("triangle", "sawtooth")):
        yield default_model_row(f"3.3.5-waveform-{waveform}", ratios[waveform] / ratios[next_waveform], note)
    yield default_model_row("3.3.6-waveform-ratio", max(ratios.values()), note)


def _waveform_ratios(friction_model: str) -> dict[str, float]:
    """Friction ratio of each waveform by a friction model. []"""
    response = tribometer_response.response_over_waveform(friction_model)
    names = [str(name) for name in response["waveform"].values]
    return dict(zip(names, response["raw_friction_ratio"].values.tolist(), strict=True))


def _listed(ratios: dict[str, float]) -> str:
    """Friction ratios by waveform as text, in increasing order."""
    return ", ".join(f"{name} {ratio:.3g}" for name, ratio in sorted(ratios.items(), key=lambda item: item[1]))


def _largest_step(ratios: Floats) -> float:
    """Largest ratio of neighbours along the first axis, the later over the earlier. []"""
    return float((ratios[1:] / ratios[:-1]).max())


def _curves() -> str:
    """Voltages of the curves as text."""
    volts = tribometer_response.response_over_speed()["voltage_peak_to_peak"].values
    return f"{', '.join(f'{u:g}' for u in volts[:-1])} and {volts[-1]:g} V"


def _percents(errors: Floats) -> str:
    """Relative errors as text in per cent."""
    return ", ".join(f"{100 * error:+.0f} %" for error in errors)


def parametric_study_figures() -> Iterator[ReportFigure]:
    """Figures of sections 3.3.4 and 3.3.5."""
    yield report_figure("figure-3-13-start-up", _draw_start_up, identified=IDENTIFIED_NOTE)
    yield report_figure("figure-3-15-voltage", _draw_voltage)
    yield report_figure(
        "figure-3-16-speed", lambda: draw_chart(STUDY_CHARTS["speed"](tribometer_response.response_over_speed()))
    )
    yield report_figure(
        "figure-3-17-frequency",
        lambda: draw_chart(
            STUDY_CHARTS["frequency"](tribometer_response.response_over_frequency(), power="charging_power")
        ),
    )
    yield report_figure(
        "figure-3-17-least-power",
        lambda: draw_chart(
            STUDY_CHARTS["power"](tribometer_response.least_power_over_frequency(), power="charging_power")
        ),
    )
    yield report_figure(
        "figure-3-18-waveform",
        lambda: draw_chart(STUDY_CHARTS["waveform"](tribometer_response.response_over_waveform())),
    )


def _draw_start_up() -> "Figure":
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


def _draw_voltage() -> "Figure":
    """Draw the response over voltage with the statements of D 3.3.5."""
    lost = float(decay_length(tribometer_rig().contact)) * np.log(1 / LOST_CONTACT)
    hopping = 1e6 * si_value("3.3.5-hopping-displacement")
    chart = STUDY_CHARTS["voltage"](tribometer_response.response_over_voltage())
    chart = chart.with_parts(
        0,
        Rule(along="y", value=hopping, label="hopping, D 3.3.5", dash=1),
        Rule(along="y", value=1e6 * lost, label="force at 1 % of the load", dash=3),
    )
    return draw_chart(chart.with_parts(2, Rule(value=si_value("3.3.5-voltage-knee"), label="20 V, D 3.3.5")))
