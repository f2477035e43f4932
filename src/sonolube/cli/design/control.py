"""Command `control`: closed-loop control of the friction force of a rig, with its C source and lookup table."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import degrees, inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from sonolube.cli.console.answer import Answer, aligned, deliver, si
from sonolube.cli.console.options import (
    OUT,
    Amplitude,
    Changes,
    Json,
    Out,
    RigPath,
    TypedNumber,
    friction_force,
    loaded_rig,
    refuse_unused,
    si_option,
)
from sonolube.cli.console.outputs import OutputFolder
from sonolube.cli.console.progress import progress
from sonolube.cli.console.rig_text import amplitude_object, amplitude_rows, operating_point, rig_settings
from sonolube.compilation import few_points
from sonolube.design.control import (
    Amplifier,
    ControlDesign,
    ControlSettings,
    Disturbance,
    StickSlipMotion,
    ThermalDrift,
    assumed_mode,
    capture_limit,
    controller_source,
    design_control,
    figures,
    lookup_table,
    stick_slip as holder,
)
from sonolube.design.control.run_results import control_dataset, final_state, lost_resonance
from sonolube.design.control.stick_slip import StickSlipSuppression, stick_slip_suppression
from sonolube.errors import InvalidInput
from sonolube.facts.metrics import EfficiencyLine
from sonolube.report import Drawing, Page, PageTable
from sonolube.rig import Rig, operating_caveats
from sonolube.units import format_si
from sonolube.validation.efficiency import efficiency_line

if TYPE_CHECKING:
    import xarray as xr


_LEAST_GAIN_MARGIN = 1.7  # lower limit of textbooks
_TABLE_ROWS = 12  # of the lookup table on the page


class FeedForward(StrEnum):
    """Map from friction to voltage that the controller uses."""

    MODEL = "model"
    EFFICIENCY = "efficiency"
    NONE = "none"


@few_points()
def control(
    context: typer.Context,
    rig: RigPath,
    friction: Annotated[
        str | None,
        typer.Option(
            metavar="FRICTION",
            help="Target, a coefficient or a force, such as 0.2 or 0.6N; half way to the least by default.",
        ),
    ] = None,
    feed_forward: Annotated[FeedForward, typer.Option(help="Map from friction to voltage.")] = FeedForward.MODEL,
    efficiency: Annotated[
        float | None,
        si_option("m2/N", "Efficiency at the rig's speed, in m2/N, instead of the published.", metavar="COEFFICIENT"),
    ] = None,
    delay: Annotated[float, si_option("s", "Delay of the friction measurement.")] = TypedNumber("1ms", "s"),
    rate: Annotated[float, si_option("Hz", "Sampling rate of the controller.")] = TypedNumber("5kHz", "Hz"),
    noise: Annotated[float, si_option("N", "Standard deviation of the sensor.")] = TypedNumber("0N", "N"),
    factor: Annotated[float, typer.Option(help="Real friction over that of the model.", min=0.01, max=100)] = 1.0,
    closed_loop: Annotated[
        float | None, si_option("s", "Time constant of the closed loop; the delay by default.")
    ] = None,
    voltage_limit: Annotated[
        float | None, si_option("V", "Largest swing, peak to peak; the rig's own by default.")
    ] = None,
    current_limit: Annotated[float | None, si_option("A", "Largest current.", metavar="CURRENT")] = None,
    slew_limit: Annotated[float | None, si_option("V/s", "Fastest change of voltage.", metavar="V/s")] = None,
    warming: Annotated[float, si_option("K", "Final temperature rise, such as 40K.")] = TypedNumber("0K", "K"),
    warming_constant: Annotated[
        float | None, si_option("s", "Time constant of the warming; a quarter of the run by default.", "--warming-time")
    ] = None,
    track: Annotated[bool, typer.Option(help="Follow the resonance by the phase of the impedance.")] = True,
    quality: Annotated[float, typer.Option(help="Quality factor, where the rig has no structure.", min=0.6)] = 50.0,
    coupling: Annotated[float, typer.Option(help="Effective coupling, where it has none.", min=0.001, max=0.999)] = 0.2,
    stick_slip: Annotated[
        bool, typer.Option("--stick-slip", help="Also compute stick-slip of the slider on an elastic holder.")
    ] = False,
    run_time: Annotated[float, si_option("s", "Duration of the run.", "--duration")] = TypedNumber("0.2s", "s"),
    amplitude: Amplitude = None,
    changes: Changes = None,
    out: Annotated[Out, OutputFolder("control.html {rig}-control.* {rig}-control-*.*")] = OUT,
    json: Json = False,
) -> None:
    """Friction control: a tuned controller, its run in closed loop, its C source and its lookup table.

    Example: sonolube control examples/rigs/tribometer.toml --friction 0.5N --factor 1.15 --warming 40K
    """
    known = loaded_rig(rig, changes=changes, amplitude=amplitude)
    if rate <= 0 or run_time <= 0:
        raise InvalidInput(f"--rate {rate} and --duration {run_time} must be positive")
    if delay > run_time:
        raise InvalidInput(f"--delay {delay} must not exceed --duration {run_time}")
    if feed_forward is not FeedForward.EFFICIENCY:
        refuse_unused(context, "efficiency", because=f"for --feed-forward {feed_forward}; it is for efficiency")
    if known.structure is not None:
        refuse_unused(context, "quality", "coupling", because="for a rig whose file has the table structure")
    if warming == 0:
        refuse_unused(context, "warming_constant", because="without --warming")
    swing = known.drive.voltage_peak_to_peak if known.drive is not None else None
    target = None
    if friction is not None:
        target = friction_force(friction, normal_load=known.normal_load, option="--friction")
    settings = ControlSettings(
        friction_force=target,
        amplifier=Amplifier(
            voltage_maximum=_value_or(swing or 0.0, voltage_limit),
            current_maximum=_value_or(inf, current_limit),
            slew_rate_maximum=_value_or(inf, slew_limit),
        ),
        dead_time=delay,
        sample_interval=1 / rate,
        closed_loop_time=closed_loop,
        feed_forward=feed_forward.value,
        tracking=track,
        duration=run_time,
        disturbance=Disturbance(friction_factor=factor, friction_force_deviation=noise),
        drift=ThermalDrift(final_temperature_rise=warming, warming_time=_value_or(run_time / 4, warming_constant)),
    )
    assumed, mode = {}, None
    with progress("controlling"):
        if known.structure is None:
            text = f"at the drive's frequency, quality factor {quality:g}, coupling {coupling:g}; not measured"
            assumed["resonance"] = text
            mode = assumed_mode(known, quality_factor=quality, coupling_factor=coupling)
        line = _efficiency_line(efficiency) if feed_forward is FeedForward.EFFICIENCY else None
        study = design_control(known, settings, mode=mode, line=line)
        suppression = stick_slip_suppression(known, study) if stick_slip else None
    answer = ControlAnswer(
        rig=known, rig_file=rig, settings=settings, study=study, suppression=suppression, assumed=assumed
    )
    deliver(answer, folder=out, as_json=json, context=context)


@dataclass(frozen=True, kw_only=True)
class ControlAnswer(Answer):
    """A tuned controller with its margins, step response and energy, and stick-slip where it was computed."""

    rig: Rig
    rig_file: Path
    settings: ControlSettings
    study: ControlDesign
    suppression: StickSlipSuppression | None
    assumed: Mapping[str, str]

    def lines(self) -> list[str]:
        """Operating point, controller, margins, step response and energy."""
        return [operating_point(self.rig), *aligned([*amplitude_rows(self.rig), *self._facts()])]

    def object(self) -> dict[str, Any]:
        """Controller, margins, step response, energy and stick-slip."""
        study, process = self.study, self.study.controller.process
        values = {
            "friction_force": study.friction_force,
            "voltage_maximum": study.voltage_maximum,
            "time_constant": study.mode.time_constant,
            "dead_time": process.dead_time_samples * process.sample_interval,
            "sample_interval": process.sample_interval,
            "plant_gain": study.plant_gain,
            **_fields(study.controller.gains, "proportional_gain", "integral_time"),
            **_fields(study.margins, "gain_margin", "phase_margin", "delay_margin", "sensitivity_peak"),
            **_fields(study.response, "rise_time", "settling_time", "overshoot", "tracking_error"),
            **_fields(study.energy, "amplifier_energy", "electrical_energy", "saved_work"),
        }
        content = {
            "rig": self.rig.title,
            "friction_model": self.rig.friction_model.name,
            **amplitude_object(self.rig),
            "feed_forward": self.settings.feed_forward,
            "limit": study.limit,
            **si(values),
        }
        if self.suppression is None:
            return content
        return content | {
            "stick_slip": {
                name: {
                    **si({"stick_slip_amplitude": motion.stick_slip_amplitude}),
                    "stick_fraction": motion.stick_fraction,
                    **si({"damping": damping}, unit="N s/m"),
                }
                for name, motion, damping in _motions(self.suppression)
            }
        }

    def caveats(self) -> Sequence[str]:
        """Those of the rig at its own operating point, a thin gain margin, and a resonance that tracking has lost."""
        study, caveats = self.study, list(operating_caveats(self.rig))
        if study.margins.gain_margin < _LEAST_GAIN_MARGIN:
            verdict = "is unstable" if study.margins.gain_margin < 1 else "is near instability"
            cause = f"real friction changes {study.plant_gain:.3g} times as the controller expects"
            caveats.append(f"the loop {verdict} at the target, where {cause}: ask for a slower --closed-loop")
        if lost_resonance(study):
            last = format_si(float(study.run.frequency[-1]), "Hz", digits=4)
            edge = format_si(capture_limit(study.mode) - study.mode.frequency, "Hz")
            caveats.append(
                f"the drive ends at {last}, the end of its band, and has lost the resonance: it returns to it from up"
                f" to {edge} above it; warm slower or keep the drive on"
            )
        return caveats

    def assumptions(self) -> Mapping[str, str]:
        """Assumptions of the rig file, of the resonance and of the holder."""
        assumptions = {**self.rig.assumptions, **self.assumed}
        if self.suppression is not None:
            assumptions["stick-slip"] = (
                f"a holder of {format_si(holder.HOLDER_STIFFNESS, 'N/m')} and {1e3 * holder.HOLDER_MASS:g} g, damping"
                f" ratio {holder.HOLDER_DAMPING_RATIO:g}; static friction {holder.STATIC_FRICTION_FACTOR:g} times that"
                " of sliding, falling over the sliding speed"
            )
        return assumptions

    def figures(self) -> Mapping[str, Drawing]:
        """Run in closed loop, design of the loop, and stick-slip where it was computed."""
        study, suppression = self.study, self.suppression
        drawings = {
            self._name: Drawing(
                draw=lambda: figures.closed_loop_figure(study),
                caption=f"Friction of {self.rig.title} in closed loop; every point computed.",
            ),
            f"{self._name}-design": Drawing(
                draw=lambda: figures.control_design_figure(study),
                caption="Map from voltage to friction of the controller, and magnitude of the sensitivity function.",
            ),
        }
        if suppression is not None:
            drawings[f"{self._name}-stick-slip"] = Drawing(
                draw=lambda: figures.stick_slip_figure(suppression),
                caption="Force in the holder of the slider as the counterface drags it along.",
            )
        return drawings

    def files(self) -> "Mapping[str, str | xr.Dataset]":
        """Run as netCDF, controller as C source, and its lookup table."""
        controller, title = self.study.controller, self.rig.title
        return {
            f"{self._name}.nc": control_dataset(self.study, title=f"Friction control of {title}"),
            f"{self._name}.c": controller_source(controller, self.study.tracker, title=title),
            f"{self._name}.csv": lookup_table(controller),
        }

    def page(self) -> Page:
        """Page `control.html`."""
        return Page(
            name="control",
            title=f"Friction control of {self.rig.title}",
            settings=rig_settings(self.rig, self.rig_file),
            facts=self._facts(),
            tables=[_lookup_table(self.study)],
        )

    @property
    def _name(self) -> str:
        """Name of the files, without ending."""
        return f"{self.rig_file.stem}-control"

    def _facts(self) -> list[tuple[str, str]]:
        """Target, drive, process, controller, margins, step response, energy, resonance and stick-slip."""
        study, process, gains = self.study, self.study.controller.process, self.study.controller.gains
        margins, response, energy = study.margins, study.response, study.energy
        late = process.dead_time_samples * process.sample_interval
        amplifier = ""
        if energy.amplifier_energy is not None:
            amplifier = f"{format_si(energy.amplifier_energy, 'J')} for the capacitance alone (D 1.9), "
        facts = {
            "target friction": f"{format_si(study.friction_force, 'N')} of {study.plant.highest_force:.3g} N; "
            f"least within reach {study.plant.lowest_force:.3g} N",
            "drive": f"up to {study.voltage_maximum:.4g} V peak to peak, by the amplifier's {study.limit}",
            "process": f"vibration {format_si(study.mode.time_constant, 's')}, delay {format_si(late, 's')}, "
            f"interval {format_si(process.sample_interval, 's')}",
            "controller": f"K_c {gains.proportional_gain:.3g}, tau_I {format_si(gains.integral_time, 's')} (SIMC), "
            f"feed-forward {self.settings.feed_forward}",
            "margins": f"gain {margins.gain_margin:.2f} where real friction changes {study.plant_gain:.2f} times as "
            f"expected, phase {degrees(margins.phase_margin):.1f} deg, delay {format_si(margins.delay_margin, 's')}, "
            f"Ms {margins.sensitivity_peak:.2f}",
            "step": f"rise {_time(response.rise_time)}, within 5 % after {_time(response.settling_time)}, "
            f"overshoot {100 * response.overshoot:.2g} %",
            "tracking error": f"{format_si(response.tracking_error, 'N')} rms once settled",
            "energy": f"amplifier {amplifier}heat of the motion {format_si(energy.electrical_energy, 'J')}, "
            f"work of friction saved {format_si(energy.saved_work, 'J')}",
        }
        if study.fixed_frequency_run is not None:
            facts["resonance"] = _resonance_text(study)
        for name, motion, damping in _motions(self.suppression) if self.suppression else ():
            facts[f"stick-slip {name}"] = (
                f"{format_si(motion.stick_slip_amplitude, 'N')}, sticks {100 * motion.stick_fraction:.0f} % of the"
                f" time, damping of sliding {damping:.3g} N s/m"
            )
        return list(facts.items())


def _value_or(default: float, value: float | None) -> float:
    """Value of an option, or its default where it was not given."""
    return default if value is None else value


def _efficiency_line(coefficient: float | None) -> EfficiencyLine:
    """Efficiency coefficient given, at every speed, or the line of D 4.2."""
    if coefficient is None:
        return efficiency_line()
    return EfficiencyLine(slope=0.0, intercept=coefficient)


def _fields(record: Any, *names: str) -> dict[str, float | None]:
    """Fields of a record by name."""
    return {name: getattr(record, name) for name in names}


def _motions(suppression: StickSlipSuppression) -> list[tuple[str, StickSlipMotion, float]]:
    """Motion and damping without and with vibration."""
    without, within = suppression.damping
    return [("without", suppression.still, without), ("with", suppression.vibrating, within)]


def _lookup_table(study: ControlDesign) -> PageTable:
    """Map from voltage to friction at about a dozen voltages."""
    plant = study.plant
    places = np.unique(np.linspace(0, plant.friction_force.size - 1, _TABLE_ROWS).round().astype(int))
    rows = zip(plant.voltage_peak_to_peak[places], plant.friction_force[places], strict=True)
    return PageTable(
        title=f"Friction by the rig's model, at {places.size} of the map's {plant.friction_force.size} voltages",
        heads=("drive, peak to peak", "friction"),
        rows=tuple((format_si(float(volts), "V"), format_si(float(force), "N")) for volts, force in rows),
    )


def _resonance_text(study: ControlDesign) -> str:
    """Shift of the resonance, and final voltage and error with and without tracking."""
    assert study.fixed_frequency_run is not None
    shift = float(study.run.resonance_frequency[-1] - study.run.resonance_frequency[0])
    tracked, fixed = (
        f"{end.voltage_peak_to_peak:.3g} V and {format_si(end.tracking_error, 'N')} rms"
        for end in (final_state(study.run), final_state(study.fixed_frequency_run))
    )
    return f"moves by {format_si(shift, 'Hz')}; tracked {tracked}, at a fixed frequency {fixed}"


def _time(seconds: float | None) -> str:
    """Time, or "never" where it was not reached."""
    return "never" if seconds is None else format_si(seconds, "s")
