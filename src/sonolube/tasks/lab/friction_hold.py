"""Task `lab hold`: friction held at a reference on devices or a virtual tribometer, the speed changing meanwhile."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Unpack

from sonolube.design.control import Amplifier, ControlDesign, ControlSettings, design_control
from sonolube.errors import InvalidInput
from sonolube.laboratory import RunControl, closed_loop, closed_loop as holds, exit_code
from sonolube.laboratory.interlocks import run_limits
from sonolube.laboratory.records import Run, read_run
from sonolube.laboratory.run_plan import RunRequest, begin_record, require_free
from sonolube.laboratory.switch_off import ready_devices
from sonolube.laboratory.virtual_tribometer import virtual_tribometer
from sonolube.models.actuator.drive import Drive
from sonolube.report import Drawing
from sonolube.report.results import held_friction as results
from sonolube.report.results.ended_run import SIMULATED
from sonolube.rig import Rig
from sonolube.tasks.answer import Answer, Block, Dataset, answer
from sonolube.tasks.design import control as loop
from sonolube.tasks.lab.protocol_run import ControlDoor, device_file, run_stage
from sonolube.tasks.lab.run_folders import RUNS, AllRuns, Device, NoSelfTest, RealTime, Seed, Tags, place_of_records
from sonolube.tasks.own_evidence import Evidence, evidence_of
from sonolube.tasks.parameters import Number, Parameter, Quantity, RigFile, WatchedRig, rig_of
from sonolube.tasks.progress import stage
from sonolube.tasks.task import in_si, refuse_unused, shown, task
from sonolube.text.units import format_si, to_si


@answer
class HoldAnswer(Answer):
    """Friction held at each speed, beside the margins of the controller.

    Parameters
    ----------
    rig : Rig
    design : ControlDesign
    held : HeldFriction
    run : Run
        Read back from its folder.
    simulated : bool
    assumed : mapping of str to str
        Beside the assumptions of the rig file.
    folder : Path
        For figure and dataset, in that of the run.
    learned_from : tuple of str
        Own published tests that the friction of the virtual rig was learned from too.
    """

    rig: Rig
    design: ControlDesign
    held: closed_loop.HeldFriction
    run: Run
    simulated: bool
    assumed: Mapping[str, str]
    folder: Path
    learned_from: tuple[str, ...] = ()

    def blocks(self) -> Sequence[Block]:
        """Reference, margins by the design, friction held at each speed, and the record."""
        return results.held_blocks(self.rig, self.held, self.design, self.run, simulated=self.simulated)

    def object(self) -> dict[str, Any]:
        """Reference, controller, margins, what was held at each speed, and the record."""
        return results.held_object(self.rig, self.held, self.design, self.run, simulated=self.simulated)

    def caveats(self) -> Sequence[str]:
        """Caveats of the record, speeds at which the reference was out of reach, and a mark of simulated runs."""
        told = (*self.run.caveats, *results.saturation_lines(self.held))
        return (*told, SIMULATED, *self.learned_from) if self.simulated else told

    def assumptions(self) -> Mapping[str, str]:
        """Assumptions of the rig file and of the resonance."""
        return {**self.rig.assumptions, **self.assumed}

    def figures(self) -> Mapping[str, Drawing]:
        """Friction with its reference, voltage and speed over time."""
        held, simulated = self.held, self.simulated
        if not held.time.size:
            return {}
        caption = f"Friction held at {format_si(held.hold.friction_force, 'N')} by the drive voltage."
        return {
            "held-friction": Drawing(
                chart=lambda: closed_loop.held_friction_chart(held, simulated=simulated), caption=caption
            )
        }

    def files(self) -> Mapping[str, Dataset]:
        """Intervals of the controller as netCDF."""
        if not self.held.time.size:
            return {}
        return {
            "held-friction.nc": closed_loop.held_friction_dataset(self.held, title=f"Friction held on {self.rig.title}")
        }

    @property
    def is_failure(self) -> bool:
        """Whether the loop ended before its time."""
        return self.held.outcome != "completed"

    @property
    def exit_code(self) -> int:
        """Exit code, one of its own where motor or drive may be on."""
        return exit_code(self.held.verdict, is_failure=self.is_failure)


@task
def hold(
    rig: RigFile,
    *,
    friction: Annotated[
        str | float | None,
        Parameter(
            "Reference, a coefficient or a force, such as 0.2 or 0.6N; half way to the least by default.", "FRICTION"
        ),
    ] = None,
    step_to: Annotated[
        Number | None, Quantity("Sliding speed after the step; twice the rig's by default.", "m/s")
    ] = None,
    step_at: Annotated[
        Number | None, Quantity("Time under control until the step; half of --duration by default.", "s")
    ] = None,
    delay: loop.Delay = "1ms",
    rate: loop.Rate = "20Hz",
    closed_loop: loop.ClosedLoop = None,
    voltage_limit: loop.VoltageLimit = None,
    temperature_limit: Annotated[
        str | None, Parameter("Temperature that ends the test, such as 60degC.", "TEMPERATURE")
    ] = None,
    friction_limit: Annotated[Number | None, Quantity("Friction force that ends the test.", "N")] = None,
    quality: loop.Quality = 50.0,
    coupling: loop.Coupling = 0.2,
    run_in: Annotated[Number, Quantity("Sliding without vibration before the controller takes over.", "s")] = "1s",
    duration: Annotated[Number, Quantity("Time under control.", "s")] = "10s",
    device_map: Device = "virtual",
    evidence: Evidence = None,
    seed: Seed = 0,
    real_time: RealTime = False,
    no_self_test: NoSelfTest = False,
    tag: Tags = (),
    out: AllRuns = RUNS,
    control: ControlDoor = None,
    **watch: Unpack[WatchedRig],
) -> HoldAnswer:
    """Hold friction at a reference by the controller of `control` while the speed steps, and record it.

    Motor and drive are off at the end, whatever happens.

    Example: sonolube lab hold examples/rigs/tribometer.toml --friction 0.7N --step-to 30mm/s
    """
    known, drive = _driven(rig_of(rig))
    sampling_rate, run_time = loop.sampling_and_duration(rate=rate, duration=duration)
    if known.structure is not None:
        refuse_unused("quality", "coupling", because="for a rig whose file has the table structure")
    file = device_file(device_map)
    if file is None:
        refuse_unused("no_self_test", because=f"with {shown('device_map')} virtual, which is not tested so")
    swing, voltage = drive.voltage_peak_to_peak or 0.0, in_si("voltage_limit", voltage_limit)
    target = None if friction is None else loop.friction_force("friction", friction, normal_load=known.normal_load)
    settings = ControlSettings(
        friction_force=target,
        amplifier=Amplifier(voltage_maximum=swing if voltage is None else voltage),
        dead_time=in_si("delay", delay),
        sample_interval=1 / sampling_rate,
        closed_loop_time=in_si("closed_loop", closed_loop),
        duration=run_time,
    )
    mode, assumed = None, dict[str, str]()
    with stage("designing the controller"):
        if known.structure is None:
            mode, assumed = loop.assumed_resonance(known, quality=quality, coupling=coupling)
        design = design_control(known, settings, mode=mode)
    wanted = holds.planned_hold(
        drive,
        design,
        speeds=_speeds(known, step_to=in_si("step_to", step_to), step_at=step_at, run_time=run_time),
        settings=settings,
        run_in=in_si("run_in", run_in),
        temperature=None if temperature_limit is None else _temperature(temperature_limit),
        force=in_si("friction_limit", friction_limit),
    )
    learned = evidence_of(evidence, known) if file is None else None
    virtual = virtual_tribometer(known, seed=seed, real_time=real_time, evidence=learned) if file is None else None
    devices = ready_devices(Path(device_map)) if virtual is None else virtual.devices
    holds.require_holdable(wanted, devices)
    wanted_run = RunRequest(
        protocol=holds.hold_protocol(wanted, devices.acquisition.channels),
        name="hold",
        rig=known,
        device_file=file,
        seed=seed,
        tags=tag,
        evidence=learned,
    )
    require_free(devices.resources)
    facts: dict[str, str | float] = {"reference_friction_force": wanted.friction_force}
    if no_self_test:
        facts["self_test"] = "left out"
    held_to = run_limits(wanted.limits, devices, wanted.drive_sampling)
    recorder = begin_record(wanted_run, devices, held_to, out=place_of_records(out, known), facts=facts)
    requests = control or RunControl()
    with run_stage("holding", requests) as advance:
        held = holds.hold_friction(
            wanted, devices, recorder=recorder, control=requests, advance=advance, self_test=not no_self_test
        )
        if virtual is not None:
            recorder.store_truth(virtual.truth())
    return HoldAnswer(
        rig=known,
        design=design,
        held=held,
        run=read_run(recorder.folder),
        simulated=devices.simulated,
        assumed=assumed,
        folder=recorder.folder / "hold",
        learned_from=wanted_run.evidence_caveats,
    )


def _driven(rig: Rig) -> tuple[Rig, Drive]:
    """Rig with its drive, which it must have."""
    if rig.drive is None:
        raise InvalidInput(f"{rig.file or rig.title}: has no drive, by which friction is held; add the table drive")
    return rig, rig.drive


def _speeds(rig: Rig, *, step_to: float | None, step_at: Number | None, run_time: float) -> tuple[holds.SpeedStep, ...]:
    """Sliding speed of the rig, then that after the step."""
    after = 2 * rig.sliding_speed if step_to is None else step_to
    time = run_time / 2 if step_at is None else in_si("step_at", step_at)
    if not time > 0:
        raise InvalidInput(f"{shown('step_at')} {step_at} must be positive")
    return holds.SpeedStep(time=0.0, sliding_speed=rig.sliding_speed), holds.SpeedStep(time=time, sliding_speed=after)


def _temperature(text: str) -> float:
    """Temperature of a limit. [K]"""
    return to_si(text, unit="K", name=shown("temperature_limit"))
