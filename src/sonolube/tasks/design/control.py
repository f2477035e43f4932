"""Task `control`: closed-loop control of the friction force of a rig, with its C source and lookup table."""

from collections.abc import Mapping, Sequence
from math import degrees, inf
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np

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
from sonolube.rig.driven_rig import require_drive
from sonolube.tasks.answer import Answer, answer, si
from sonolube.tasks.blocks import Block, Rows
from sonolube.tasks.design.friction_target import friction_force
from sonolube.tasks.parameters import Number, Parameter, RigFile, Stop, Watch, rig_of
from sonolube.tasks.progress import stage
from sonolube.tasks.results.rig_text import amplitude_object, amplitude_rows, operating_point, rig_settings
from sonolube.tasks.task import in_si, refuse_unused, shown, task
from sonolube.units import format_si
from sonolube.validation.efficiency import efficiency_line

if TYPE_CHECKING:
    import xarray as xr


_LEAST_GAIN_MARGIN = 1.7  # lower limit of textbooks
_TABLE_ROWS = 12  # of the lookup table on the page


@task
def control(
    rig: RigFile,
    *,
    friction: Annotated[
        str | float | None,
        Parameter(
            help="Target, a coefficient or a force, such as 0.2 or 0.6N; half way to the least by default.",
            kind="FRICTION",
        ),
    ] = None,
    feed_forward: Annotated[
        Literal["model", "efficiency", "none"], Parameter(help="Map from friction to voltage.")
    ] = "model",
    efficiency: Annotated[
        Number | None,
        Parameter(
            help="Efficiency at the rig's speed, in m2/N, instead of the published.", unit="m2/N", kind="COEFFICIENT"
        ),
    ] = None,
    delay: Annotated[Number, Parameter(help="Delay of the friction measurement.", unit="s")] = "1ms",
    rate: Annotated[Number, Parameter(help="Sampling rate of the controller.", unit="Hz")] = "5kHz",
    noise: Annotated[Number, Parameter(help="Standard deviation of the sensor.", unit="N")] = "0N",
    factor: Annotated[float, Parameter(help="Real friction over that of the model.", lowest=0.01, highest=100)] = 1.0,
    closed_loop: Annotated[
        Number | None, Parameter(help="Time constant of the closed loop; the delay by default.", unit="s")
    ] = None,
    voltage_limit: Annotated[
        Number | None, Parameter(help="Largest swing, peak to peak; the rig's own by default.", unit="V")
    ] = None,
    current_limit: Annotated[Number | None, Parameter(help="Largest current.", unit="A", kind="CURRENT")] = None,
    slew_limit: Annotated[Number | None, Parameter(help="Fastest change of voltage.", unit="V/s", kind="V/s")] = None,
    warming: Annotated[Number, Parameter(help="Final temperature rise, such as 40K.", unit="K")] = "0K",
    warming_time: Annotated[
        Number | None, Parameter(help="Time constant of the warming; a quarter of the run by default.", unit="s")
    ] = None,
    track: Annotated[bool, Parameter(help="Follow the resonance by the phase of the impedance.")] = True,
    quality: Annotated[float, Parameter(help="Quality factor, where the rig has no structure.", lowest=0.6)] = 50.0,
    coupling: Annotated[
        float, Parameter(help="Effective coupling, where it has none.", lowest=0.001, highest=0.999)
    ] = 0.2,
    stick_slip: Annotated[bool, Parameter(help="Also compute stick-slip of the slider on an elastic holder.")] = False,
    duration: Annotated[Number, Parameter(help="Duration of the run.", unit="s")] = "0.2s",
    progress: Watch = None,
    cancelled: Stop = None,
) -> "ControlAnswer":
    """Friction control: a tuned controller, its run in closed loop, its C source and its lookup table.

    Example: sonolube control examples/rigs/tribometer.toml --friction 0.5N --factor 1.15 --warming 40K
    """
    known = rig_of(rig)
    interval, dead_time, run_time = _times(rate, delay, duration)
    final_rise = in_si("warming", warming)
    if feed_forward != "efficiency":
        because = f"for {shown('feed_forward')} {feed_forward}; it is for efficiency"
        refuse_unused("efficiency", because=because)
    if known.structure is not None:
        refuse_unused("quality", "coupling", because="for a rig whose file has the table structure")
    if final_rise == 0:
        refuse_unused("warming_time", because=f"without {shown('warming')}")
    swing = require_drive(known).voltage_peak_to_peak
    settings = ControlSettings(
        friction_force=None
        if friction is None
        else friction_force("friction", friction, normal_load=known.normal_load),
        amplifier=Amplifier(
            voltage_maximum=_value_or(swing or 0.0, in_si("voltage_limit", voltage_limit)),
            current_maximum=_value_or(inf, in_si("current_limit", current_limit)),
            slew_rate_maximum=_value_or(inf, in_si("slew_limit", slew_limit)),
        ),
        dead_time=dead_time,
        sample_interval=interval,
        closed_loop_time=in_si("closed_loop", closed_loop),
        feed_forward=feed_forward,
        tracking=track,
        duration=run_time,
        disturbance=Disturbance(friction_factor=factor, friction_force_deviation=in_si("noise", noise)),
        drift=ThermalDrift(
            final_temperature_rise=final_rise, warming_time=_value_or(run_time / 4, in_si("warming_time", warming_time))
        ),
    )
    assumed, mode = {}, None
    with stage("controlling"):
        if known.structure is None:
            text = f"at the drive's frequency, quality factor {quality:g}, coupling {coupling:g}; not measured"
            assumed["resonance"] = text
            mode = assumed_mode(known, quality_factor=quality, coupling_factor=coupling)
        line = _efficiency_line(in_si("efficiency", efficiency)) if feed_forward == "efficiency" else None
        study = design_control(known, settings, mode=mode, line=line)
        suppression = stick_slip_suppression(known, study) if stick_slip else None
    return ControlAnswer(rig=known, settings=settings, study=study, suppression=suppression, assumed=assumed)


def _times(rate: Number, delay: Number, duration: Number) -> tuple[float, float, float]:
    """Sampling interval, delay and duration of the run, in s."""
    sampling, dead_time, run_time = in_si("rate", rate), in_si("delay", delay), in_si("duration", duration)
    if sampling <= 0 or run_time <= 0:
        raise InvalidInput(f"{shown('rate')} {rate} and {shown('duration')} {duration} must be positive")
    if dead_time > run_time:
        raise InvalidInput(f"{shown('delay')} {delay} must not exceed {shown('duration')} {duration}")
    return 1 / sampling, dead_time, run_time


@answer
class ControlAnswer(Answer):
    """A tuned controller with its margins, step response and energy, and stick-slip where it was computed."""

    rig: Rig
    settings: ControlSettings
    study: ControlDesign
    suppression: StickSlipSuppression | None
    assumed: Mapping[str, str]

    def blocks(self) -> Sequence[Block]:
        """Operating point, controller, margins, step response and energy."""
        return [operating_point(self.rig), Rows([*amplitude_rows(self.rig), *self._facts()])]

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
            caveats.append(f"the loop {verdict} at the target, where {cause}: ask for a slower closed loop")
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
                chart=lambda: figures.closed_loop_chart(study),
                caption=f"Friction of {self.rig.title} in closed loop; every point computed.",
            ),
            f"{self._name}-design": Drawing(
                chart=lambda: figures.control_design_chart(study),
                caption="Map from voltage to friction of the controller, and magnitude of the sensitivity function.",
            ),
        }
        if suppression is not None:
            drawings[f"{self._name}-stick-slip"] = Drawing(
                chart=lambda: figures.stick_slip_chart(suppression),
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
            settings=rig_settings(self.rig),
            facts=self._facts(),
            tables=[_lookup_table(self.study)],
        )

    @property
    def _name(self) -> str:
        """Name of the files, without ending."""
        return f"{self.rig.name}-control"

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
