"""What the command `control` says and writes."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sonolube.cli.control_figures import belt_figure, course_figure, design_figure
from sonolube.cli.design_page import notes_of
from sonolube.cli.output import closing_lines
from sonolube.design.control import (
    ControlDesign,
    ControlSettings,
    StickSlipMotion,
    capture_limit,
    controller_source,
    lookup_table,
    mass_on_belt,
    steady_sliding_damping,
    stick_slip_motion,
    voltage_for_friction,
)
from sonolube.figure import publication_style
from sonolube.files import write_atomically
from sonolube.report import Finding, FindingTable, write_findings
from sonolube.rig import Rig, dataset, write_netcdf
from sonolube.units import format_si
from sonolube.vocabulary import quantity

_HOLDER_MASS, _HOLDER_STIFFNESS, _DAMPING_RATIO = 0.05, 2e4, 0.01  # kg, N/m
_STATIC_FACTOR = 1.3  # static friction over that of sliding
_PERIODS = 80
_SAFE_GAIN_MARGIN = 1.7  # the least that textbooks allow

HOLDER = (
    f"a holder of {format_si(_HOLDER_STIFFNESS, 'N/m')} and {1e3 * _HOLDER_MASS:g} g, damping ratio"
    f" {_DAMPING_RATIO:g}; static friction {_STATIC_FACTOR:g} times that of sliding, falling over the sliding speed"
)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Suppression:
    """A slider dragged without and with vibration.

    Parameters
    ----------
    still, vibrating : DraggedMotion
    voltage_peak_to_peak : float
        Swing of the drive of the second. [V]
    damping : pair of float
        Of small motions about steady sliding, without and with, in N s/m.
    """

    still: StickSlipMotion
    vibrating: StickSlipMotion
    voltage_peak_to_peak: float
    damping: tuple[float, float]


def suppressed(rig: Rig, study: ControlDesign) -> Suppression:
    """Return how a rig's slider moves on a holder that lets it stick, without vibration and with that wanted."""
    volts = float(voltage_for_friction(study.plant, friction_force=study.friction_force))
    without, within = (
        mass_on_belt(
            rig,
            holder_mass=_HOLDER_MASS,
            holder_stiffness=_HOLDER_STIFFNESS,
            holder_damping=2 * _DAMPING_RATIO * float(np.sqrt(_HOLDER_MASS * _HOLDER_STIFFNESS)),
            static_friction_force=_STATIC_FACTOR * study.plant.highest_force,
            stribeck_velocity=rig.sliding_speed,
            voltage_peak_to_peak=swing,
        )
        for swing in (0.0, volts)
    )
    return Suppression(
        still=stick_slip_motion(without, duration=_PERIODS * without.period),
        vibrating=stick_slip_motion(within, duration=_PERIODS * within.period),
        voltage_peak_to_peak=volts,
        damping=(steady_sliding_damping(without), steady_sliding_damping(within)),
    )


def control_object(
    rig: Rig,
    settings: ControlSettings,
    study: ControlDesign,
    belt: Suppression | None,
    supposed: Mapping[str, str],
    written: list[Path],
) -> dict[str, Any]:
    """Return the controller and its run as they go into JSON."""
    gains, margins, response, energy = study.controller.gains, study.margins, study.response, study.energy
    named = {
        "friction_force": study.friction_force,
        "voltage_maximum": study.voltage_maximum,
        "time_constant": study.mode.time_constant,
        "dead_time": study.controller.process.dead_time_samples * study.controller.process.sample_interval,
        "sample_interval": study.controller.process.sample_interval,
        "plant_gain": study.plant_gain,
        "proportional_gain": gains.proportional_gain,
        "integral_time": gains.integral_time,
        **{name: getattr(margins, name) for name in ("gain_margin", "phase_margin", "delay_margin")},
        "sensitivity_peak": margins.sensitivity_peak,
        **{name: getattr(response, name) for name in ("rise_time", "settling_time", "overshoot", "tracking_error")},
        **{name: getattr(energy, name) for name in ("amplifier_energy", "electrical_energy", "saved_work")},
    }
    answer: dict[str, Any] = {
        "rig": rig.title,
        "friction_model": rig.friction_model.name,
        "feed_forward": settings.feed_forward,
        "limit": study.limit,
        **{name: {"value": value, "unit": quantity(name).unit} for name, value in named.items()},
    }
    if belt is not None:
        answer["stick_slip"] = {
            name: {
                "stick_slip_amplitude": {"value": motion.stick_slip_amplitude, "unit": "N"},
                "stick_fraction": motion.stick_fraction,
                "damping": {"value": damping, "unit": "N s/m"},
            }
            for name, motion, damping in zip(
                ("without", "with"), (belt.still, belt.vibrating), belt.damping, strict=True
            )
        }
    answer["caveats"] = list(_caveats(study))
    return answer | {"assumptions": _assumed(rig, belt, supposed), "files": [str(path) for path in written]}


def control_lines(
    rig: Rig,
    settings: ControlSettings,
    study: ControlDesign,
    belt: Suppression | None,
    supposed: Mapping[str, str],
    written: list[Path],
) -> list[str]:
    """Return the controller and its run as lines."""
    return [
        f"{rig.title}, {format_si(rig.normal_load, 'N')}, {format_si(rig.sliding_speed, 'm/s')}, "
        f"friction model {rig.friction_model.name}",
        *[f"  {name:<20} {value}" for name, value in _facts(settings, study, belt)],
        *closing_lines(written, assumptions=_assumed(rig, belt, supposed), caveats=_caveats(study)),
    ]


def write_control(
    rig: Rig,
    settings: ControlSettings,
    study: ControlDesign,
    belt: Suppression | None,
    supposed: Mapping[str, str],
    *,
    asked: list[tuple[str, str]],
    folder: Path,
    name: str,
) -> list[Path]:
    """Write the report with its figures, the run as netCDF, and the controller as C and as a table."""
    run = study.run
    values = {
        "time": run.time,
        "friction_force": run.friction_force,
        "voltage_peak_to_peak": run.voltage_peak_to_peak,
        "frequency": run.frequency,
        "resonance_frequency": run.resonance_frequency,
        "phase": run.phase,
        "electrical_energy": run.electrical_energy,
    }
    labelled = dataset(values, along="time", title=f"Friction control of {rig.title}")
    with publication_style():
        figures = [
            Finding(
                name=name,
                caption=f"Friction of {rig.title} in closed loop; every point computed.",
                figure=course_figure(study),
            ),
            Finding(
                name=f"{name}-design",
                caption="What the controller looks its voltages up in, and what the loop leaves of disturbances.",
                figure=design_figure(study),
            ),
        ]
        if belt is not None:
            figures.append(
                Finding(
                    name=f"{name}-stick-slip",
                    caption="Force in the holder of the slider as the counterface drags it along.",
                    figure=belt_figure(belt.still, belt.vibrating, volts=belt.voltage_peak_to_peak),
                )
            )
        page = write_findings(
            title=f"Friction control of {rig.title}",
            asked=asked,
            facts=_facts(settings, study, belt),
            tables=[_lookup(study)],
            figures=figures,
            notes=notes_of(_caveats(study), _assumed(rig, belt, supposed)),
            folder=folder,
            name="control",
        )
    source = controller_source(study.controller, study.tracker, title=rig.title)
    return [
        *page,
        write_netcdf(labelled, path=folder / f"{name}.nc"),
        write_atomically(folder / f"{name}.c", source),
        write_atomically(folder / f"{name}.csv", lookup_table(study.controller)),
    ]


def _lookup(study: ControlDesign) -> FindingTable:
    """Return the map from friction to voltage at about a dozen places."""
    plant = study.plant
    places = np.unique(np.linspace(0, plant.friction_force.size - 1, 12).round().astype(int))
    rows = zip(plant.voltage_peak_to_peak[places], plant.friction_force[places], strict=True)
    return FindingTable(
        title=f"Friction by the rig's model, at {places.size} of the map's {plant.friction_force.size} voltages",
        heads=("drive, peak to peak", "friction"),
        rows=tuple((format_si(float(volts), "V"), format_si(float(force), "N")) for volts, force in rows),
    )


def _caveats(study: ControlDesign) -> tuple[str, ...]:
    return (*_thin_margin(study), *_lost_resonance(study))


def _lost_resonance(study: ControlDesign) -> tuple[str, ...]:
    tracker, last = study.tracker, float(study.run.frequency[-1])
    if tracker is None or tracker.lowest_frequency < last < tracker.highest_frequency:
        return ()
    edge = capture_limit(study.mode) - study.mode.frequency
    return (
        f"the drive ends at {format_si(last, 'Hz', digits=4)}, the end of its band, and has lost the resonance: it"
        f" finds back from up to {format_si(edge, 'Hz')} above it; warm slower or keep the drive on",
    )


def _thin_margin(study: ControlDesign) -> tuple[str, ...]:
    if study.margins.gain_margin >= _SAFE_GAIN_MARGIN:
        return ()
    verdict = "is unstable" if study.margins.gain_margin < 1 else "is near instability"
    cause = f"real friction changes {study.plant_gain:.3g} times as the controller expects"
    return (f"the loop {verdict} at the friction wanted, where {cause}: ask for a slower --closed-loop",)


def _assumed(rig: Rig, belt: Suppression | None, supposed: Mapping[str, str]) -> dict[str, str]:
    return {**rig.assumptions, **supposed, **({} if belt is None else {"stick-slip": HOLDER})}


def _facts(settings: ControlSettings, study: ControlDesign, belt: Suppression | None) -> list[tuple[str, str]]:
    process, gains, margins = study.controller.process, study.controller.gains, study.margins
    response, energy = study.response, study.energy
    late = process.dead_time_samples * process.sample_interval
    amplifier = "" if energy.amplifier_energy is None else f"{format_si(energy.amplifier_energy, 'J')} (D 1.9), "
    facts = [
        (
            "friction wanted",
            f"{format_si(study.friction_force, 'N')} of {study.plant.highest_force:.3g} N; "
            f"least within reach {study.plant.lowest_force:.3g} N",
        ),
        ("drive", f"up to {study.voltage_maximum:.4g} V peak to peak, by the amplifier's {study.limit}"),
        (
            "process",
            f"vibration {format_si(study.mode.time_constant, 's')}, delay {format_si(late, 's')}, "
            f"interval {format_si(process.sample_interval, 's')}",
        ),
        (
            "controller",
            f"K_c {gains.proportional_gain:.3g}, tau_I {format_si(gains.integral_time, 's')} (SIMC), "
            f"feed-forward {settings.feed_forward}",
        ),
        (
            "margins",
            f"gain {margins.gain_margin:.2f} where real friction changes {study.plant_gain:.2f} times as expected, "
            f"phase {np.degrees(margins.phase_margin):.1f} deg, "
            f"delay {format_si(margins.delay_margin, 's')}, "
            f"Ms {margins.sensitivity_peak:.2f}",
        ),
        (
            "step",
            f"rise {_time(response.rise_time)}, within 5 % after {_time(response.settling_time)}, "
            f"overshoot {100 * response.overshoot:.2g} %",
        ),
        ("tracking error", f"{format_si(response.tracking_error, 'N')} rms once settled"),
        (
            "energy",
            f"amplifier {amplifier}motion {format_si(energy.electrical_energy, 'J')}, "
            f"work of friction saved {format_si(energy.saved_work, 'J')}",
        ),
    ]
    if study.fixed_frequency_run is not None:
        facts.append(("resonance", _tracked(study)))
    if belt is not None:
        facts += [
            (
                f"stick-slip {name}",
                f"{format_si(motion.stick_slip_amplitude, 'N')}, sticks "
                f"{100 * motion.stick_fraction:.0f} % of the time, damping of sliding {damping:.3g} N s/m",
            )
            for name, motion, damping in zip(
                ("without", "with"), (belt.still, belt.vibrating), belt.damping, strict=True
            )
        ]
    return facts


def _tracked(study: ControlDesign) -> str:
    assert study.fixed_frequency_run is not None
    last = slice(-max(study.run.time.size // 5, 1), None)
    with_it, without = (
        float(np.sqrt(np.mean((run.friction_force[last] - run.setpoint[last]) ** 2)))
        for run in (study.run, study.fixed_frequency_run)
    )
    fell = study.run.resonance_frequency[-1] - study.run.resonance_frequency[0]
    volts = study.run.voltage_peak_to_peak[last].mean(), study.fixed_frequency_run.voltage_peak_to_peak[last].mean()
    return (
        f"moves by {format_si(float(fell), 'Hz')}; tracked {volts[0]:.3g} V and {format_si(with_it, 'N')} rms, "
        f"at a fixed frequency {volts[1]:.3g} V and {format_si(without, 'N')} rms"
    )


def _time(seconds: float | None) -> str:
    return "never" if seconds is None else format_si(seconds, "s")
