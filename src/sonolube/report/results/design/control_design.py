"""Friction control of a rig: controller, margins, step response, energy and stick-slip as facts, JSON and a table."""

from math import degrees, isnan
from typing import Any

import numpy as np

from sonolube.design.control import (
    ControlDesign,
    ControlEnergy,
    ControlSettings,
    DisturbanceRejection,
    PosteriorLoop,
    StickSlipMotion,
    capture_limit,
    stick_slip as holder,
)
from sonolube.design.control.control_design import final_state, lost_resonance
from sonolube.design.control.predicted_loop import MARGINS, predicted_margins
from sonolube.design.control.stick_slip import StickSlipSuppression
from sonolube.prediction.chances import odds_text
from sonolube.report.page import PageTable
from sonolube.report.results.record_object import amplitude_object, picked
from sonolube.rig import AMPLITUDE, Rig, operating_caveats
from sonolube.text.units import format_si
from sonolube.vocabulary import quantity, si

_MIN_GAIN_MARGIN = 1.7  # lower limit of textbooks
_NO_VOLTAGE = (
    "the rig has no voltage: resonance, its tracking and warming, and electrical energy are those of the generator that"
    " holds the amplitude, and are not computed"
)
_SURE = 0.8  # chance of the target, below which it is said
_TABLE_ROWS = 12  # of the lookup table on the page

_ENERGIES = ("amplifier_energy", "electrical_energy")  # of a voltage alone

_SUMMARY = (
    *("gain_margin", "phase_margin", "delay_margin", "sensitivity_peak"),
    *("rise_time", "settling_time", "overshoot", "peak_deviation", "recovery_time"),
)

_MAXIMA = {"voltage": "voltage_maximum", "amplitude": "amplitude_maximum"}


def control_object(
    rig: Rig,
    settings: ControlSettings,
    study: ControlDesign,
    rejection: DisturbanceRejection,
    suppression: StickSlipSuppression | None,
) -> dict[str, Any]:
    """Controller, margins, step response, energy and stick-slip, for JSON."""
    process = study.controller.process
    values = {
        "friction_force": study.friction_force,
        _MAXIMA[study.plant.quantity.word]: study.level_maximum,
        "time_constant": study.mode.time_constant,
        "dead_time": process.dead_time_samples * process.sample_interval,
        "sample_interval": process.sample_interval,
        "plant_gain": study.plant_gain,
        **picked(study.controller.gains, "proportional_gain", "integral_time"),
        **picked(study.margins, "gain_margin", "phase_margin", "delay_margin", "sensitivity_peak"),
        **picked(study.response, "rise_time", "settling_time", "overshoot", "tracking_error"),
        **picked(rejection, "peak_deviation", "recovery_time"),
        **picked(study.energy, *_ENERGIES, "saved_work"),
    }
    if study.run.electrical_energy is None:
        values = {name: value for name, value in values.items() if name not in _ENERGIES}
    content = {
        "rig": rig.title,
        "friction_model": rig.friction_model.name,
        **amplitude_object(rig),
        "feed_forward": settings.feed_forward,
        "limit": study.limit,
        **si(values),
        "summary": [
            {
                "key": name,
                "label": quantity(name).meaning,
                "text": "never" if values[name] is None else _text(name, values[name]),
            }
            for name in _SUMMARY
        ],
    }
    if suppression is None:
        return content
    return content | {
        "stick_slip": {
            name: {
                **si({"stick_slip_amplitude": motion.stick_slip_amplitude}),
                "stick_fraction": motion.stick_fraction,
                **si({"damping": damping}, unit="N s/m"),
            }
            for name, motion, damping in _motions(suppression)
        }
    }


def facts(
    settings: ControlSettings,
    study: ControlDesign,
    rejection: DisturbanceRejection,
    suppression: StickSlipSuppression | None,
) -> list[tuple[str, str]]:
    """Target, drive, process, controller, margins, responses, energy, resonance and stick-slip."""
    process, gains = study.controller.process, study.controller.gains
    margins, response = study.margins, study.response
    late = process.dead_time_samples * process.sample_interval
    found = {
        "target friction": f"{format_si(study.friction_force, 'N')} of {study.plant.highest_force:.3g} N; "
        f"least within reach {study.plant.lowest_force:.3g} N",
        "drive": _drive_text(study),
        "process": f"vibration {format_si(study.mode.time_constant, 's')}, delay {format_si(late, 's')}, "
        f"interval {format_si(process.sample_interval, 's')}",
        "controller": f"K_c {gains.proportional_gain:.3g}, tau_I {format_si(gains.integral_time, 's')} (SIMC), "
        f"feed-forward {settings.feed_forward}",
        "margins": f"gain {margins.gain_margin:.2f} where real friction changes {study.plant_gain:.2f} times as "
        f"expected, phase {degrees(margins.phase_margin):.1f} deg, delay {format_si(margins.delay_margin, 's')}, "
        f"Ms {margins.sensitivity_peak:.2f}",
        "step": f"rise {_time(response.rise_time)}, within 5 % after {_time(response.settling_time)}, "
        f"overshoot {100 * response.overshoot:.2g} %",
        "disturbance": _rejection_text(rejection),
        "tracking error": f"{format_si(response.tracking_error, 'N', scale=study.friction_force)} rms once settled",
        "energy": _energy_text(study.energy),
    }
    if study.fixed_frequency_run is not None:
        found["resonance"] = _resonance_text(study)
    for name, motion, damping in _motions(suppression) if suppression else ():
        swing = format_si(motion.stick_slip_amplitude, "N", scale=study.friction_force)
        sticks = f"sticks {100 * motion.stick_fraction:.0f} % of the time"
        found[f"stick-slip {name}"] = f"{swing}, {sticks}, damping of sliding {damping:.3g} N s/m"
    return list(found.items())


def caveats(rig: Rig, study: ControlDesign) -> list[str]:
    """Those of the rig at its own operating point, a thin gain margin, and a resonance that tracking has lost."""
    found = list(operating_caveats(rig))
    if study.plant.quantity is AMPLITUDE:
        found.append(_NO_VOLTAGE)
    if study.margins.gain_margin < _MIN_GAIN_MARGIN:
        verdict = "is unstable" if study.margins.gain_margin < 1 else "is near instability"
        cause = f"real friction changes {study.plant_gain:.3g} times as the controller expects"
        found.append(f"the loop {verdict} at the target, where {cause}: ask for a slower closed loop")
    if lost_resonance(study):
        last = format_si(float(study.run.frequency[-1]), "Hz", digits=4)
        edge = format_si(capture_limit(study.mode) - study.mode.frequency, "Hz")
        found.append(
            f"the drive ends at {last}, the end of its band, and has lost the resonance: it returns to it from up"
            f" to {edge} above it; warm slower or keep the drive on"
        )
    return found


def posterior_facts(study: ControlDesign, found: PosteriorLoop | str, *, tuned_for: str) -> list[tuple[str, str]]:
    """Friction within reach, chance of the target, margins at the gains of the 80 % interval, and the cautious tuning.

    `found`: By `posterior_loop`, or why there is no prediction.
    """
    if isinstance(found, str):
        return [("not predicted", found)]
    reach = f"{_reach_text(study, found)}; the target is within reach with {odds_text(found.target_chance)}"
    rows = [("predicted reach", reach)]
    if found.gain is None or found.cautious is None:
        return rows
    gains = [f"{each:.2g}" for each in found.gain]
    rows.append(("predicted gain", f"{gains[1]}, {gains[0]} to {gains[2]} (80 %), where the target is within reach"))
    quick, _, worst = found.margins
    phases = f"phase {degrees(worst.phase_margin):.1f} to {degrees(quick.phase_margin):.1f} deg"
    stable = f"gain {worst.gain_margin:.2f} to {quick.gain_margin:.2f}, {phases}"
    unstable = (
        f"unstable at the highest gain, to gain {quick.gain_margin:.2f}, phase {degrees(quick.phase_margin):.1f} deg"
    )
    rows.append(("margins, 80 %", stable if worst.gain_margin > 1 else unstable))
    cautious = found.cautious
    kept = f"gain {cautious.margins.gain_margin:.2f}, phase {degrees(cautious.margins.phase_margin):.1f} deg"
    slower = format_si(cautious.closed_loop_time, "s")
    lost = f"{100 * cautious.given_up:.0f} % of the bandwidth of feedback is given up"
    usual = format_si(cautious.usual_time, "s")
    taken = "is tuned for" if tuned_for == "worst" else "would be held"
    text = f"{kept} at the highest gain {taken} by a closed loop of {slower} in place of {usual}: {lost}"
    return [*rows, ("worst of 80 %", text)]


def posterior_summary(study: ControlDesign, found: PosteriorLoop | str) -> list[dict[str, str]]:
    """Key, label and text of the predicted reach, chance of the target and worst gain margin; empty without them."""
    if isinstance(found, str):
        return []
    rows = [
        {
            "key": "predicted_least_friction",
            "label": "Least friction within reach, predicted",
            "text": _reach_text(study, found),
        },
        {"key": "target_chance", "label": "Target within reach", "text": odds_text(found.target_chance)},
    ]
    if found.margins:
        text = f"{found.margins[-1].gain_margin:.3g}"
        rows.append({"key": "worst_gain_margin", "label": "Gain margin at the worst of 80 %", "text": text})
    return rows


def _reach_text(study: ControlDesign, found: PosteriorLoop) -> str:
    """Median and 80 % interval of the least friction force within reach."""
    low, median, high = (_force(study, each) for each in found.reach)
    return f"{median}, {low} to {high} (80 %)"


def posterior_object(found: PosteriorLoop | str, *, tuned_for: str) -> dict[str, Any]:
    """The same for JSON."""
    if isinstance(found, str):
        return {"prediction": {"runs": 0, "reason": found}}
    low, median, high = found.reach
    content: dict[str, Any] = {
        "prediction": {"runs": found.runs, "reason": None},
        "predicted_least_friction": {"median": median, "interval_80": [low, high], "unit": "N"},
        "target_chance": found.target_chance,
        "tuned_for": tuned_for,
    }
    if found.gain is None or found.cautious is None:
        return content
    low, median, high = map(float, found.gain)
    cautious = found.cautious
    return content | {
        "predicted_gain": {"median": median, "interval_80": [low, high]},
        "predicted_margins": {
            name: {"median": _known(at[1]), "interval_80": _ends(at), "unit": quantity(name).unit}
            for name, at in predicted_margins(found).items()
        },
        "worst_of_80": {
            **si({"closed_loop_time": cautious.closed_loop_time}),
            **si(picked(cautious.gains, "proportional_gain", "integral_time")),
            **si(picked(cautious.margins, *MARGINS)),
            "bandwidth_given_up": cautious.given_up,
        },
    }


def _ends(at: tuple[float, float, float]) -> list[float | None]:
    """Lower and upper end of a margin; None for the peak of an unstable loop, which comes last."""
    known = sorted(each for each in (at[0], at[2]) if not isnan(each))
    return [*known, *[None] * (2 - len(known))]


def _known(value: float) -> float | None:
    """Value of a margin; None where there is none."""
    return None if isnan(value) else value


def posterior_caveats(found: PosteriorLoop | str, *, feed_forward: str, tuned_for: str) -> list[str]:
    """Caveats of the prediction, a target that may be out of reach, and a loop near instability within the 80 %."""
    if isinstance(found, str):
        return []
    caveats = list(found.caveats)
    if found.target_chance < _SURE:
        caveats.append(f"the target is within reach with {odds_text(found.target_chance)} alone, by `sonolube predict`")
    if found.gain is None or found.margins[-1].gain_margin >= _MIN_GAIN_MARGIN:
        return caveats
    verdict = "unstable" if found.margins[-1].gain_margin < 1 else "near instability"
    table = "" if feed_forward == "prediction" else ", and a feed-forward by the prediction lowers it"
    tuning = "" if tuned_for == "worst" else "; a tuning for the worst holds its margins"
    caveats.append(
        f"real friction may change {found.gain[-1]:.2g} times as the controller expects (upper end of 80 %), where the"
        f" loop is {verdict}{tuning}{table}"
    )
    return caveats


def holder_text() -> str:
    """Holder of the slider that stick-slip is computed with."""
    return (
        f"a holder of {format_si(holder.HOLDER_STIFFNESS, 'N/m')} and {1e3 * holder.HOLDER_MASS:g} g, damping"
        f" ratio {holder.HOLDER_DAMPING_RATIO:g}; static friction {holder.STATIC_FRICTION_FACTOR:g} times that"
        " of sliding, falling over the sliding speed"
    )


def _motions(suppression: StickSlipSuppression) -> list[tuple[str, StickSlipMotion, float]]:
    """Motion and damping without and with vibration."""
    without, within = suppression.damping
    return [("without", suppression.still, without), ("with", suppression.vibrating, within)]


def lookup_table(study: ControlDesign, found: PosteriorLoop | str) -> PageTable:
    """Map from voltage or amplitude to friction at about a dozen points, as predicted too where it is."""
    plant, quantity = study.plant, study.plant.quantity
    places = np.unique(np.linspace(0, plant.friction_force.size - 1, _TABLE_ROWS).round().astype(int))
    columns = [
        [format_si(float(level), quantity.unit) for level in plant.level[places]],
        [format_si(float(force), "N") for force in plant.friction_force[places]],
    ]
    heads = [f"{quantity.word}, {quantity.qualifier}", "friction by the model"]
    if not isinstance(found, str):
        low, median, high = ([_force(study, float(force)) for force in row[places]] for row in found.force)
        columns += [median, [f"{one} to {other}" for one, other in zip(low, high, strict=True)]]
        heads += ["predicted median", "predicted, 80 %"]
    predicted = "" if isinstance(found, str) else " and as predicted,"
    return PageTable(
        title=f"Friction by the rig's model,{predicted} at {places.size} of the map's {plant.level.size}"
        f" {quantity.word}s",
        heads=tuple(heads),
        rows=tuple(zip(*columns, strict=True)),
    )


def _force(study: ControlDesign, force: float) -> str:
    """Friction force to the digits of the target."""
    return format_si(force, "N", scale=study.friction_force)


def _text(name: str, value: float) -> str:
    """Value of a quantity with its unit, an overshoot in percent."""
    return f"{100 * value:.2g} %" if name == "overshoot" else format_si(value, quantity(name).unit)


def _rejection_text(rejection: DisturbanceRejection) -> str:
    """Step of the real friction, largest deviation and recovery."""
    step = f"{100 * abs(rejection.friction_step):.3g} % {'more' if rejection.friction_step > 0 else 'less'} friction"
    back = rejection.recovery_time
    again = "not back" if back is None else f"back within 5 % of that after {format_si(back, 's')}"
    return f"{step}: at most {format_si(rejection.peak_deviation, 'N')} off the target, {again}"


def _resonance_text(study: ControlDesign) -> str:
    """Shift of the resonance, and final voltage and error with and without tracking."""
    assert study.fixed_frequency_run is not None
    shift = float(study.run.resonance_frequency[-1] - study.run.resonance_frequency[0])
    tracked, fixed = (
        f"{format_si(end.level, study.plant.quantity.unit)}"
        f" and {format_si(end.tracking_error, 'N', scale=study.friction_force)} rms"
        for end in (final_state(study.run), final_state(study.fixed_frequency_run))
    )
    moves = format_si(shift, "Hz", scale=study.mode.frequency)
    return f"moves by {moves}; tracked {tracked}, at a fixed frequency {fixed}"


def _drive_text(study: ControlDesign) -> str:
    """Largest voltage or amplitude, and what limits it."""
    quantity = study.plant.quantity
    highest = quantity.text(study.level_maximum, digits=4)
    if quantity is AMPLITUDE:
        return f"amplitude up to {highest}, as the set point of a generator"
    return f"up to {highest}, by the amplifier's {study.limit}"


def _energy_text(energy: ControlEnergy) -> str:
    """Energy of the amplifier and the motion, where there is a voltage, and work of friction saved."""
    saved = f"work of friction saved {format_si(energy.saved_work, 'J')}"
    if energy.electrical_energy is None:
        return saved
    amplifier = ""
    if energy.amplifier_energy is not None:
        amplifier = f"{format_si(energy.amplifier_energy, 'J')} for the capacitance alone (D 1.9), "
    return f"amplifier {amplifier}heat of the motion {format_si(energy.electrical_energy, 'J')}, {saved}"


def _time(seconds: float | None) -> str:
    """Time, or "never" where it was not reached."""
    return "never" if seconds is None else format_si(seconds, "s")
