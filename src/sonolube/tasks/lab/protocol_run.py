"""Tasks `lab run` and `lab virtual`: a protocol on a rig or a virtual one, recorded; or gone through dry.

With the devices, who answers the prompts, the record, and the answers.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Final, Literal, Unpack

import sonolube.laboratory.dry_run as dry_runs
from sonolube.errors import InvalidInput
from sonolube.facts.protocol import Protocol, flattened, protocol_at, protocol_by_name_or_file
from sonolube.laboratory import RunControl, RunState, RunWatcher, exit_code, run_protocol
from sonolube.laboratory.devices import Devices
from sonolube.laboratory.drivers import read_device_map, unfulfilled
from sonolube.laboratory.dry_run import DryRun, dry_run_chart
from sonolube.laboratory.interlocks import drive_sampling, recorded_channels
from sonolube.laboratory.records import Run, export_run, read_run
from sonolube.laboratory.rehearsal import Rehearsal, rehearsal
from sonolube.laboratory.run_plan import (
    RunRequest,
    begin_record,
    drive_setting,
    groove_diameter,
    planned_run,
    require_free,
)
from sonolube.laboratory.runner import Operator
from sonolube.laboratory.set_and_measured import monitor_of, self_test_setting
from sonolube.laboratory.switch_off import ready_devices
from sonolube.laboratory.virtual_tribometer import (
    GROOVE_DIAMETER,
    Disturbances,
    ExpectedTime,
    VirtualTribometer,
    virtual_tribometer,
)
from sonolube.laboratory.watching import told
from sonolube.report import Drawing
from sonolube.report.results import ended_run as results
from sonolube.rig import Rig
from sonolube.tasks.answer import Answer, Block, Dataset, answer
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.lab.run_folders import RUNS, AllRuns, Device, NoSelfTest, Seed, Tags, facts_of, place_of_records
from sonolube.tasks.own_evidence import Evidence, evidence_of
from sonolube.tasks.parameters import (
    DoorParameter,
    File,
    KeyValues,
    OptionalRigSource,
    Parameter,
    RigFile,
    Watched,
    WatchedRig,
    optional_rig,
    rig_of,
)
from sonolube.tasks.progress import Advance, TaskCancelled, stage
from sonolube.tasks.task import refuse_unused, shown, task


@answer
class RunAnswer(Answer):
    """Outcome of a run, and the place of its record.

    Parameters
    ----------
    result : RunState
    run : Run
        Read back from its folder.
    simulated : bool
    rig : Rig or None
    rehearsed : Rehearsal or None
        Devices of a device map on the virtual rig.
    learned_from : tuple of str
        Own published tests that the friction of the virtual rig was learned from too.
    """

    result: RunState
    run: Run
    simulated: bool
    rig: Rig | None = None
    rehearsed: Rehearsal | None = None
    learned_from: tuple[str, ...] = ()

    def blocks(self) -> Sequence[Block]:
        """Outcome, what was recorded, what each channel of a map reads, and the next command."""
        reads = () if self.rehearsed is None else results.rehearsed_blocks(self.rehearsed)
        head, rows, *after = results.run_blocks(self.result, self.run, simulated=self.simulated)
        return [head, rows, *reads, *after]

    def object(self) -> dict[str, Any]:
        """Outcome, folder and recordings, and what each channel of a map reads."""
        reads = {} if self.rehearsed is None else results.rehearsed_object(self.rehearsed)
        return results.run_object(self.result, self.run, simulated=self.simulated) | reads

    def caveats(self) -> Sequence[str]:
        """Caveats of the record, faults, and channels that are not simulated."""
        found = results.run_caveats(self.run, self.rig) if self.simulated else self.run.caveats
        reads = () if self.rehearsed is None else self.rehearsed.caveats
        return (*reads, *found, *self.learned_from)

    def assumptions(self) -> Mapping[str, str]:
        """Assumptions of the rig file, where the friction is that of the rig."""
        return {} if self.rig is None or not self.simulated else self.rig.assumptions

    def dataset(self) -> Dataset:
        """Recording, where there is one."""
        return self.run.dataset().assign_attrs(self.notes()) if self.run.recordings else super().dataset()

    @property
    def is_failure(self) -> bool:
        """Whether the run ended before its protocol."""
        return self.run.summary.outcome != "completed"

    @property
    def exit_code(self) -> int:
        """Exit code, one of its own where motor or drive may be on."""
        return exit_code(self.result.verdict, is_failure=self.is_failure)


@answer
class DryRunAnswer(Answer):
    """Planned course of a protocol.

    Parameters
    ----------
    protocol : Protocol
    found : DryRun
    expected : ExpectedTime or None
        On a virtual rig.
    rehearsed : Rehearsal or None
        Devices of a device map on the virtual rig.
    learned_from : tuple of str
        Own published tests that the friction of the virtual rig was learned from too.
    """

    protocol: Protocol
    found: DryRun
    expected: ExpectedTime | None = None
    rehearsed: Rehearsal | None = None
    learned_from: tuple[str, ...] = ()

    def blocks(self) -> Sequence[Block]:
        """A row a set point, then time, data, drive and temperatures; what is impossible last."""
        reads = () if self.rehearsed is None else results.rehearsed_blocks(self.rehearsed)
        return [*results.dry_run_blocks(self.protocol, self.found, expected=self.expected), *reads]

    def object(self) -> dict[str, Any]:
        """Times, data and refusals."""
        reads = {} if self.rehearsed is None else results.rehearsed_object(self.rehearsed)
        return results.dry_run_object(self.protocol, self.found, expected=self.expected) | reads

    def figures(self) -> Mapping[str, Drawing]:
        """Speed, drive and temperatures over time."""
        return {"dry-run": Drawing(chart=lambda: dry_run_chart(self.found), forms=())}

    def caveats(self) -> Sequence[str]:
        """Faults, channels that are not simulated, and caveats of the plan."""
        reads = () if self.rehearsed is None else self.rehearsed.caveats
        return (*reads, *self.found.caveats, *self.learned_from)

    def assumptions(self) -> Mapping[str, str]:
        """Assumptions about drive and heat."""
        return self.found.assumptions


OperatorDoor = Annotated[Operator | None, DoorParameter()]
ControlDoor = Annotated[RunControl | None, DoorParameter()]
WatcherDoor = Annotated[RunWatcher | None, DoorParameter()]

_VIRTUAL = "virtual"


def device_file(device_map: str | Path) -> Path | None:
    """Device map of the running task; None for the virtual tribometer.

    Raises
    ------
    InvalidInput
        If arguments of the virtual tribometer are given beside a device map.
    """
    if str(device_map) == _VIRTUAL:
        return None
    refuse_unused("evidence", because=f"with {shown('device_map')} MAP.toml, whose friction is measured")
    because = f"with {shown('device_map')} MAP.toml, whose tests take their time"
    refuse_unused("seed", "real_time", because=because)
    return Path(device_map)


def run_and_record(
    request: RunRequest,
    devices: Devices,
    *,
    out: Path,
    virtual: VirtualTribometer | Rehearsal | None = None,
    operator: Operator | None = None,
    control: RunControl | None = None,
    watcher: RunWatcher | None = None,
    asks: bool = False,
    self_test: bool = True,
) -> RunAnswer:
    """Run a protocol on devices with its record below a folder, and say how it went.

    Parameters
    ----------
    request : RunRequest
    devices : Devices
    out : Path
        Folder of all runs.
    virtual : VirtualTribometer or Rehearsal, optional
        Whose truth is kept too.
    operator : callable, optional
        Answers the prompts of a protocol on devices that are not simulated.
    control : RunControl, optional
        Requests of others.
    watcher : RunWatcher, optional
        Shown set points, blocks and events.
    asks : bool
        Whether the operator, where there is one, answers the prompts of simulated devices too.
    self_test : bool
        Whether voltages that were set are compared with those that are measured, before a run and in it.

    Returns
    -------
    RunAnswer

    Raises
    ------
    InvalidInput
        If the devices cannot do what the protocol says, nobody can answer its prompts, or another run has one of them.
    """
    protocol, limits = request.protocol, planned_run(request.protocol, devices).limits
    answers = operator if asks and operator is not None else _answering(protocol, devices, operator)
    control = control or RunControl()
    require_free(devices.resources)
    recorder = begin_record(request, devices, limits, out=out, facts={} if self_test else {"self_test": "left out"})
    told(watcher, lambda each: each.records(recorder.folder))
    with run_stage(_running(protocol, virtual), control) as advance:
        result = run_protocol(
            protocol,
            devices,
            recorder,
            operator=answers,
            control=control,
            advance=advance,
            watcher=watcher,
            self_test=self_test,
        )
        if virtual is not None:
            recorder.store_truth(virtual.truth())
    return RunAnswer(
        result=result,
        run=read_run(recorder.folder),
        simulated=devices.simulated,
        rig=request.rig,
        rehearsed=virtual if isinstance(virtual, Rehearsal) else None,
        learned_from=request.evidence_caveats,
    )


def _running(protocol: Protocol, virtual: VirtualTribometer | Rehearsal | None) -> str:
    """Title of a run, with the time that a virtual one is expected to take where that is long."""
    if virtual is None:
        return "running"
    with stage("seeing how long it takes"):
        said = virtual.expected_time(protocol).text_before_run
    return f"running, {said}" if said else "running"


@contextmanager
def run_stage(title: str, control: RunControl) -> Iterator[Advance]:
    """Report the progress of a run inside a `with` block; where the task is cancelled, the run is stopped in order."""
    with stage(title) as advance:

        def report(what: str, done: int, total: int) -> None:
            try:
                advance(what, done, total)
            except TaskCancelled:
                control.stop("cancelled")

        yield report


def _answering(protocol: Protocol, devices: Devices, operator: Operator | None) -> Operator:
    """Operator of a run, who is not needed where nothing is asked or nothing is real."""
    if devices.simulated:
        return lambda prompt: True
    if operator is not None:
        return operator
    if any(point.kind == "prompt" for point in flattened(protocol)):
        raise InvalidInput(
            "the protocol asks an operator; run it on a terminal, in Python with the argument operator, or take its"
            f" prompts as done by {shown('yes')}"
        )
    return lambda prompt: False


_OWN_TEST: Final = "map_test"  # of a virtual rig for which no protocol is named


@task
def run(
    protocol: Annotated[InputFile, Parameter("Such as map_test, or a TOML file.", "PROTOCOL")],
    device_map: Device = "virtual",
    *,
    rig: Annotated[OptionalRigSource, File("The rig; a virtual tribometer takes its friction.", "RIG.toml")] = None,
    evidence: Evidence = None,
    seed: Seed = 0,
    real_time: Annotated[bool, Parameter("Let a virtual test take its time, and ask its prompts.")] = False,
    dry_run: Annotated[bool, Parameter("Tell what will happen, and touch nothing.")] = False,
    anyway: Annotated[bool, Parameter("Run although a dry run says that it is impossible.")] = False,
    yes: Annotated[bool, Parameter("Take the prompts to the operator as done.")] = False,
    no_self_test: NoSelfTest = False,
    tag: Tags = (),
    fact: Annotated[
        Mapping[str, str | float] | None,
        KeyValues(
            "For the record, such as operator=Ann; specimen=7; humidity=45 %; calibrated=2026-03-01.", "NAME=VALUE"
        ),
    ] = None,
    out: AllRuns = RUNS,
    operator: OperatorDoor = None,
    control: ControlDoor = None,
    watcher: WatcherDoor = None,
    **watch: Unpack[Watched],
) -> RunAnswer | DryRunAnswer:
    """Run a protocol and record it; motor and drive are off at the end, whatever happens.

    Example: sonolube lab run map_test --rig examples/rigs/power_map.toml
    """
    path, known = str(file_path(protocol)), optional_rig(rig)
    read = protocol_by_name_or_file(path)
    if dry_run:
        unused = "evidence", "seed", "real_time", "anyway", "yes", "no_self_test", "tag", "fact", "out"
        refuse_unused(*unused, because=f"with {shown('dry_run')}, which runs nothing")
        return DryRunAnswer(protocol=read, found=_dry_run(read, known, device_file(device_map)))
    if not anyway:
        _require_possible_dry(read, known)
    file = device_file(device_map)
    if file is None:
        refuse_unused("no_self_test", because=f"with {shown('device_map')} virtual, which is not tested so")
    facts = facts_of(fact or {})
    wanted = RunRequest(
        protocol=read,
        name=Path(path).stem,
        rig=known,
        device_file=file,
        seed=seed,
        tags=tag,
        facts=facts,
        evidence=evidence_of(evidence, known) if file is None else None,
    )
    simulated = _virtual_rig(wanted, real_time=real_time) if file is None else None
    return run_and_record(
        wanted,
        ready_devices(Path(device_map)) if simulated is None else simulated.devices,
        out=place_of_records(out, known),
        virtual=simulated,
        operator=(lambda prompt: True) if yes else operator,
        control=control,
        watcher=watcher,
        asks=real_time,
        self_test=not no_self_test,
    )


@task
def virtual(
    rig: RigFile,
    *,
    protocol: Annotated[
        InputFile | None,
        Parameter("Such as study_1, or a TOML file; map_test at load and speed of the rig.", "PROTOCOL"),
    ] = None,
    device_map: Annotated[
        InputFile | None,
        File("Device map whose channels, clocks and limits the virtual rig has.", "MAP.toml", option="--device"),
    ] = None,
    fault: Annotated[
        Sequence[str],
        Parameter("Of the rig of a map, such as load_50_ohm, or overload_trip@2s; may come again.", "NAME"),
    ] = (),
    evidence: Evidence = None,
    seed: Annotated[int, Parameter("Of all that is drawn: another specimen, other noise.", lowest=0)] = 0,
    file_format: Annotated[
        Literal["netcdf", "tdms", "csv"], Parameter("Of the recording, beside netCDF.", option="--format")
    ] = "netcdf",
    dry_run: Annotated[bool, Parameter("Tell what will happen and how long it takes, and record nothing.")] = False,
    out: AllRuns = RUNS,
    **watch: Unpack[WatchedRig],
) -> RunAnswer | DryRunAnswer:
    """Record a realistic test of a rig that exists in its file only, also with the devices of a map.

    Example: sonolube lab virtual examples/rigs/power_map.toml --protocol map_test
    """
    if device_map is None:
        refuse_unused("fault", because=f"without {shown('device_map')} MAP.toml, whose rig has it")
    known = rig_of(rig)
    path = _OWN_TEST if protocol is None else str(file_path(protocol))
    read = protocol_by_name_or_file(path)
    if protocol is None:
        read = protocol_at(read, normal_load=known.normal_load, sliding_speed=known.sliding_speed)
    file = None if device_map is None else file_path(device_map)
    wanted = RunRequest(
        protocol=read,
        name=Path(path).stem,
        rig=known,
        device_file=file,
        seed=seed,
        evidence=evidence_of(evidence, known),
    )
    if dry_run:
        refuse_unused("file_format", "out", because=f"with {shown('dry_run')}, which records nothing")
    simulated = _virtual_rig(wanted) if file is None else _rehearsal(wanted, file, fault)
    if dry_run:
        return _planned(wanted, simulated, file)
    found = run_and_record(wanted, simulated.devices, out=place_of_records(out, known), virtual=simulated)
    if file_format != "netcdf":
        export_run(found.run.folder, file_format=file_format, out=found.run.folder)
    return found


def _planned(wanted: RunRequest, simulated: VirtualTribometer | Rehearsal, file: Path | None) -> DryRunAnswer:
    """Plan of a virtual run, with what devices of a map cannot do and the time that it is expected to take."""
    found = _dry_run(wanted.protocol, wanted.rig, file)
    return DryRunAnswer(
        protocol=wanted.protocol,
        found=found,
        expected=None if found.refusals else simulated.expected_time(wanted.protocol),
        rehearsed=simulated if isinstance(simulated, Rehearsal) else None,
        learned_from=wanted.evidence_caveats,
    )


def _dry_run(protocol: Protocol, rig: Rig | None, file: Path | None) -> DryRun:
    """Plan of a run, with what devices of a map cannot do, do not read back and do not show of the voltage."""
    if file is None:
        return dry_runs.dry_run(protocol, rig=rig)
    device_map = read_device_map(file)
    devices, metadata = device_map.devices(), protocol.metadata
    on_disc = metadata.model_copy(update={"groove_diameter": groove_diameter(protocol, devices)})
    found = dry_runs.dry_run(protocol.model_copy(update={"metadata": on_disc}), rig=rig)
    caveats, sampling, recorded = list(found.caveats), drive_sampling(protocol), recorded_channels(protocol)
    if sampling is not None and (unresolved := sampling.caveat(recorded)) in caveats:  # of the protocol's rate alone
        caveats.remove(unresolved)
        caveats += filter(None, [sampling.caveat_of(recorded, devices.channels)])
    untold, assumptions = devices.description.get("drive not read back"), dict(found.assumptions)
    setting = self_test_setting(next(filter(None, map(drive_setting, flattened(protocol))), None))
    if setting is not None:
        highest = device_map.entries.acquisition.total_rate_maximum
        shown_by = monitor_of(devices.acquisition.channels, sample_rate=highest, frequency=setting.frequency)
        if not shown_by:
            assumptions["self-test"] = "none: no channel of the map shows the voltage of the drive, nor is it compared"
    return replace(
        found,
        protocol=protocol,
        refusals=(*found.refusals, *unfulfilled(device_map, protocol)),
        caveats=(*caveats, *([f"drive not read back: {untold}"] if untold else [])),
        assumptions=assumptions,
    )


def _require_possible_dry(protocol: Protocol, rig: Rig | None) -> None:
    """Raise where a dry run says that a test is impossible or would be ended by a limit."""
    refusals = dry_runs.dry_run(protocol, rig=rig).refusals
    if refusals:
        more = f" (and {len(refusals) - 1} more by {shown('dry_run')})" if len(refusals) > 1 else ""
        raise InvalidInput(f"impossible by a dry run: {refusals[0]}{more}; {shown('anyway')} runs it all the same")


def _rehearsal(wanted: RunRequest, file: Path, faults: Sequence[str]) -> Rehearsal:
    """Devices of a map on the virtual rig of a run."""
    assert wanted.rig is not None
    rig = _loaded(wanted.rig, wanted)
    return rehearsal(
        read_device_map(file), rig, wanted.protocol, seed=wanted.seed, faults=faults, evidence=wanted.evidence
    )


def _loaded(rig: Rig, wanted: RunRequest) -> Rig:
    """Rig at the load of the protocol, where that states one."""
    load = wanted.protocol.metadata.normal_load
    return rig if load is None else replace(rig, normal_load=load)


def _virtual_rig(wanted: RunRequest, *, real_time: bool = False) -> VirtualTribometer:
    """Virtual tribometer of the rig of a run.

    Raises
    ------
    InvalidInput
        If the run names no rig.
    """
    if wanted.rig is None:
        raise InvalidInput(f"{shown('device_map')} virtual needs {shown('rig')}, whose friction it takes")
    metadata = wanted.protocol.metadata
    rig = _loaded(wanted.rig, wanted)
    diameter = metadata.groove_diameter or GROOVE_DIAMETER
    sizes = Disturbances(contact_share=float(metadata.thermocouple == "contact"))
    return virtual_tribometer(
        rig,
        seed=wanted.seed,
        real_time=real_time,
        disturbances=sizes,
        groove_diameter=diameter,
        evidence=wanted.evidence,
    )
