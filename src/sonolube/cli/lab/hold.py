"""Command `lab hold`: friction held at a reference on devices or a virtual tribometer, the speed changing meanwhile."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from math import ceil, degrees
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from sonolube.cli.console.answer import Answer, aligned, deliver, si
from sonolube.cli.console.options import (
    Amplitude,
    Changes,
    Json,
    RigPath,
    TypedNumber,
    friction_force,
    loaded_rig,
    refuse_unused,
    si_option,
)
from sonolube.cli.console.progress import progress
from sonolube.cli.lab.run import RUNS
from sonolube.cli.lab.running import RunPlan, begin_record, instruments
from sonolube.compilation import few_points
from sonolube.design.control import Amplifier, ControlDesign, ControlSettings, assumed_mode, design_control
from sonolube.errors import InvalidInput
from sonolube.facts.protocol import Limits, exact_text
from sonolube.laboratory.closed_loop import (
    FrictionHold,
    HeldFriction,
    HoldMetrics,
    SpeedStep,
    held_friction_dataset,
    held_friction_figure,
    hold_friction,
    hold_metrics,
    hold_protocol,
    require_holdable,
)
from sonolube.laboratory.records import Run, read_run
from sonolube.laboratory.virtual_tribometer import virtual_tribometer
from sonolube.report import Drawing
from sonolube.rig import Rig
from sonolube.units import format_si, to_si

if TYPE_CHECKING:
    import xarray as xr

_SAMPLE_RATE = 2000.0  # Hz, at least
_HEADROOM = 1.1  # of the limit of the measured voltage, for noise, over the voltage that may be commanded
_SATURATED = 0.5  # share of the time


@few_points()
def hold(
    context: typer.Context,
    rig: RigPath,
    friction: Annotated[
        str | None,
        typer.Option(
            metavar="FRICTION",
            help="Reference, a coefficient or a force, such as 0.2 or 0.6N; half way to the least by default.",
        ),
    ] = None,
    step_to: Annotated[
        float | None, si_option("m/s", "Sliding speed after the step; twice the rig's by default.")
    ] = None,
    step_at: Annotated[
        float | None, si_option("s", "Time under control until the step; half of --duration by default.")
    ] = None,
    delay: Annotated[float, si_option("s", "Delay of the friction measurement.")] = TypedNumber("1ms", "s"),
    rate: Annotated[float, si_option("Hz", "Sampling rate of the controller.")] = TypedNumber("20Hz", "Hz"),
    closed_loop: Annotated[
        float | None, si_option("s", "Time constant of the closed loop; the delay by default.")
    ] = None,
    voltage_limit: Annotated[
        float | None, si_option("V", "Largest swing, peak to peak; the rig's own by default.")
    ] = None,
    temperature_limit: Annotated[
        str | None, typer.Option(metavar="TEMPERATURE", help="Temperature that ends the test, such as 60degC.")
    ] = None,
    friction_limit: Annotated[float | None, si_option("N", "Friction force that ends the test.")] = None,
    quality: Annotated[float, typer.Option(help="Quality factor, where the rig has no structure.", min=0.6)] = 50.0,
    coupling: Annotated[float, typer.Option(help="Effective coupling, where it has none.", min=0.001, max=0.999)] = 0.2,
    run_in: Annotated[
        float, si_option("s", "Sliding without vibration before the controller takes over.")
    ] = TypedNumber("1s", "s"),
    run_time: Annotated[float, si_option("s", "Time under control.", "--duration")] = TypedNumber("10s", "s"),
    device: Annotated[str, typer.Option(metavar="virtual|MAP.toml", help="What to run on.")] = "virtual",
    seed: Annotated[int, typer.Option(help="Of a virtual tribometer.", min=0)] = 0,
    real_time: Annotated[bool, typer.Option("--real-time", help="Let a virtual test take its time.")] = False,
    tag: Annotated[list[str] | None, typer.Option(metavar="TAG", help="For the catalogue; may come again.")] = None,
    amplitude: Amplitude = None,
    changes: Changes = None,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder of all runs; each has a new one in it.")] = RUNS,
    json: Json = False,
) -> None:
    """Hold friction at a reference by the controller of `control` while the speed steps, and record it.

    Motor and drive are off at the end, whatever happens.

    Example: sonolube lab hold examples/rigs/tribometer.toml --friction 0.7N --step-to 30mm/s
    """
    known = loaded_rig(rig, changes=changes, amplitude=amplitude)
    if known.drive is None:
        raise InvalidInput(f"{rig}: has no drive, by which friction is held; add the table drive")
    if rate <= 0 or run_time <= 0:
        raise InvalidInput(f"--rate {rate} and --duration {run_time} must be positive")
    if known.structure is not None:
        refuse_unused(context, "quality", "coupling", because="for a rig whose file has the table structure")
    on_hardware = device != "virtual"
    if on_hardware:
        refuse_unused(context, "seed", "real_time", because="with --device MAP.toml, whose tests take their time")
    swing, target = known.drive.voltage_peak_to_peak or 0.0, None
    if friction is not None:
        target = friction_force(friction, normal_load=known.normal_load, option="--friction")
    settings = ControlSettings(
        friction_force=target,
        amplifier=Amplifier(voltage_maximum=swing if voltage_limit is None else voltage_limit),
        dead_time=delay,
        sample_interval=1 / rate,
        closed_loop_time=closed_loop,
        duration=run_time,
    )
    with progress("designing the controller"):
        is_assumed = known.structure is None
        mode = assumed_mode(known, quality_factor=quality, coupling_factor=coupling) if is_assumed else None
        design = design_control(known, settings, mode=mode)
    ratio = known.drive.voltage_offset / swing if swing else 0.0
    wanted = FrictionHold(
        controller=design.controller,
        friction_force=design.friction_force,
        frequency=known.drive.frequency,
        speeds=_speeds(known, step_to=step_to, step_at=run_time / 2 if step_at is None else step_at),
        duration=run_time,
        limits=_limits(
            _HEADROOM * (abs(ratio) + 0.5) * design.controller.voltage_maximum,
            lasts=run_in + run_time,
            temperature=temperature_limit,
            force=friction_limit,
        ),
        run_in=run_in,
        offset_ratio=ratio,
        sample_rate=rate * ceil(_SAMPLE_RATE / rate),
    )
    virtual = None if on_hardware else virtual_tribometer(known, seed=seed, real_time=real_time)
    devices = instruments(Path(device)) if virtual is None else virtual.devices
    require_holdable(wanted, devices)
    plan = RunPlan(
        protocol=hold_protocol(wanted, devices.acquisition.channels),
        name="hold",
        rig=known,
        rig_file=rig,
        device_file=Path(device) if on_hardware else None,
        seed=seed,
        real_time=real_time,
        tags=tag or (),
    )
    facts: dict[str, str | float] = {"reference_friction_force": wanted.friction_force}
    if changes:
        facts["changed_entries"] = "; ".join(changes)
    recorder = begin_record(plan, devices, out=out, facts=facts)
    with progress("holding") as advance:
        held = hold_friction(wanted, devices, recorder=recorder, advance=advance)
    if virtual is not None:
        recorder.store_truth(virtual.truth())
    answer = HoldAnswer(
        rig=known,
        design=design,
        held=held,
        run=read_run(recorder.folder),
        simulated=devices.simulated,
        assumed=_assumed(quality, coupling) if is_assumed else {},
    )
    deliver(answer, folder=recorder.folder / "hold", as_json=json)
    if held.outcome != "completed":
        raise typer.Exit(1)


@dataclass(frozen=True, kw_only=True)
class HoldAnswer(Answer):
    """How friction was held at each speed, beside the margins of the controller."""

    rig: Rig
    design: ControlDesign
    held: HeldFriction
    run: Run
    simulated: bool
    assumed: Mapping[str, str]

    def lines(self) -> list[str]:
        """Reference, margins told by the design, what was held at each speed, and the record."""
        held, design = self.held, self.design
        rows = [
            ("outcome", held.outcome + (f": {held.reason}" if held.reason else "")),
            ("motor and drive", "off" if held.is_safe else "NOT confirmed off: cut the power"),
            ("reference", self._reference()),
            ("controller", f"interval {format_si(design.controller.process.sample_interval, 's')}, {_gains(design)}"),
            ("margins told", _margins(design)),
            *((f"at {format_si(phase.sliding_speed, 'm/s')}", _phase_text(phase)) for phase in self._phases()),
            ("record", str(self.run.folder)),
        ]
        return [f"{self.rig.title}, friction held" + (" (virtual)" if self.simulated else ""), *aligned(rows)]

    def object(self) -> dict[str, Any]:
        """Reference, controller, margins, what was held at each speed, and the record."""
        held, design = self.held, self.design
        margins = {
            name: getattr(design.margins, name)
            for name in ("gain_margin", "phase_margin", "delay_margin", "sensitivity_peak")
        }
        gains = {name: getattr(design.controller.gains, name) for name in ("proportional_gain", "integral_time")}
        intrinsic = held.intrinsic_friction_force
        return {
            "rig": self.rig.title,
            "outcome": held.outcome,
            "reason": held.reason,
            "safe": held.is_safe,
            "simulated": self.simulated,
            "folder": str(self.run.folder),
            "tags": self.run.facts.get("tags", ""),
            "recordings": [str(path) for path in self.run.recordings],
            **si({"friction_force": held.hold.friction_force, **margins, **gains}),
            **si({"intrinsic_friction_force": intrinsic if intrinsic == intrinsic else None}),
            "phases": [_phase_object(phase) for phase in self._phases()],
        }

    def caveats(self) -> Sequence[str]:
        """What speaks against the record, speeds at which the reference was out of reach, and a simulation."""
        told = list(self.run.caveats)
        for phase in self._phases():
            if phase.saturated_fraction > _SATURATED:
                share, speed = f"{100 * phase.saturated_fraction:.0f} %", format_si(phase.sliding_speed, "m/s")
                told.append(f"at {speed} the voltage was at its limit or 0 for {share} of the time: no reach is left")
        if self.simulated:
            told.append("friction is drawn from the prediction of the rig: no measurement")
        return told

    def assumptions(self) -> Mapping[str, str]:
        """Assumptions of the rig file and of the resonance."""
        return {**self.rig.assumptions, **self.assumed}

    def figures(self) -> Mapping[str, Drawing]:
        """Friction with its reference, voltage and speed over time."""
        held, simulated = self.held, self.simulated
        if not held.time.size:
            return {}
        caption = f"Friction held at {format_si(held.hold.friction_force, 'N')} by the drive voltage."
        return {"held-friction": Drawing(draw=lambda: held_friction_figure(held, simulated=simulated), caption=caption)}

    def files(self) -> "Mapping[str, xr.Dataset]":
        """Intervals of the controller as netCDF."""
        if not self.held.time.size:
            return {}
        return {"held-friction.nc": held_friction_dataset(self.held, title=f"Friction held on {self.rig.title}")}

    def _phases(self) -> tuple[HoldMetrics, ...]:
        """Figures of merit at each speed that was reached under control."""
        return hold_metrics(self.held) if self.held.time.size else ()

    def _reference(self) -> str:
        """Reference, and the friction without vibration that was measured before."""
        text, intrinsic = format_si(self.held.hold.friction_force, "N"), self.held.intrinsic_friction_force
        return text if intrinsic != intrinsic else f"{text}; {format_si(intrinsic, 'N')} without vibration, before"


def _speeds(rig: Rig, *, step_to: float | None, step_at: float) -> tuple[SpeedStep, ...]:
    """Sliding speed of the rig, then that after the step."""
    after = 2 * rig.sliding_speed if step_to is None else step_to
    if not step_at > 0:
        raise InvalidInput(f"--step-at {step_at} must be positive")
    return (
        SpeedStep(time=0.0, sliding_speed=rig.sliding_speed),
        SpeedStep(time=float(step_at), sliding_speed=float(after)),
    )


def _limits(voltage: float, *, lasts: float, temperature: str | None, force: float | None) -> Limits:
    """Limits that end the test."""
    content = {"voltage_maximum": exact_text(voltage, unit="V"), "duration_maximum": exact_text(lasts, unit="s")}
    if temperature is not None:
        content["temperature_maximum"] = exact_text(to_si(temperature, unit="K", name="--temperature-limit"), unit="K")
    if force is not None:
        content["friction_force_maximum"] = exact_text(force, unit="N")
    return Limits.model_validate(content)


def _assumed(quality: float, coupling: float) -> Mapping[str, str]:
    """Resonance that is assumed where the rig has no structure."""
    text = f"at the drive's frequency, quality factor {quality:g}, coupling {coupling:g}; not measured"
    return {"resonance": text}


def _gains(design: ControlDesign) -> str:
    """Gains of the controller."""
    gains = design.controller.gains
    return f"K_c {gains.proportional_gain:.3g}, tau_I {format_si(gains.integral_time, 's')} (SIMC)"


def _margins(design: ControlDesign) -> str:
    """Stability margins of the design."""
    margins = design.margins
    return (
        f"gain {margins.gain_margin:.2f}, phase {degrees(margins.phase_margin):.1f} deg,"
        f" delay {format_si(margins.delay_margin, 's')}, Ms {margins.sensitivity_peak:.2f}"
    )


def _phase_text(phase: HoldMetrics) -> str:
    """How friction was held at one speed."""
    settled = "not settled" if phase.settling_time is None else f"settled after {format_si(phase.settling_time, 's')}"
    return (
        f"{format_si(phase.friction_force, 'N')}, error {format_si(phase.tracking_error, 'N')} rms, {settled},"
        f" {phase.voltage_peak_to_peak:.3g} V peak to peak"
    )


def _phase_object(phase: HoldMetrics) -> dict[str, Any]:
    """Figures of merit at one speed."""
    content = asdict(phase)
    share, scatter = content.pop("saturated_fraction"), content.pop("scatter")
    times = {name: content.pop(name) for name in ("start_time", "settling_time")}
    return si(content) | si(times, unit="s") | si({"scatter": scatter}, unit="N") | {"saturated_fraction": share}
