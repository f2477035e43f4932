"""Tasks `lab run` and `lab virtual`: a protocol on a rig or a virtual one, recorded; or gone through dry."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Final, Literal, Unpack

import sonolube.laboratory.dry_run as dry_runs
from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.protocol import Protocol, protocol_at, protocol_by_name_or_file
from sonolube.laboratory.drivers.readiness import ready_devices
from sonolube.laboratory.records import EXPORT_FORMATS, export_run
from sonolube.laboratory.run_plan import RunPlan
from sonolube.laboratory.virtual_tribometer import GROOVE_DIAMETER, VirtualTribometer, virtual_tribometer
from sonolube.rig import Rig
from sonolube.tasks.files import InputFile, file_path
from sonolube.tasks.lab.run_answer import DryRunAnswer, RunAnswer
from sonolube.tasks.lab.run_folders import RUNS, AllRuns, Device, RealTime, Seed, Tags, facts_of
from sonolube.tasks.lab.run_record import ControlDoor, OperatorDoor, device_file, run_and_record
from sonolube.tasks.parameters import (
    File,
    KeyValues,
    OptionalRigSource,
    Parameter,
    RigFile,
    Watched,
    optional_rig,
    rig_of,
)
from sonolube.tasks.task import refuse_unused, shown, task

_OWN_TEST: Final = "map_test"  # of a virtual rig for which no protocol is named


@task
def run(
    protocol: Annotated[InputFile, Parameter("Such as map_test, or a TOML file.", "PROTOCOL")],
    device_map: Device = "virtual",
    *,
    rig: Annotated[OptionalRigSource, File("The rig; a virtual tribometer takes its friction.", "RIG.toml")] = None,
    seed: Seed = 0,
    real_time: RealTime = False,
    dry_run: Annotated[bool, Parameter("Tell what will happen, and touch nothing.")] = False,
    anyway: Annotated[bool, Parameter("Run although a dry run says that it is impossible.")] = False,
    yes: Annotated[bool, Parameter("Take the prompts to the operator as done.")] = False,
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
    **watch: Unpack[Watched],
) -> RunAnswer | DryRunAnswer:
    """Run a protocol and record it; motor and drive are off at the end, whatever happens.

    Example: sonolube lab run map_test --rig examples/rigs/power_map.toml
    """
    path, known = str(file_path(protocol)), optional_rig(rig)
    read = protocol_by_name_or_file(path)
    if dry_run:
        unused = "seed", "real_time", "anyway", "yes", "tag", "fact", "out"
        refuse_unused(*unused, because=f"with {shown('dry_run')}, which runs nothing")
        return DryRunAnswer(protocol=read, found=dry_runs.dry_run(read, rig=known))
    if not anyway:
        _require_possible_dry(read, known)
    file = device_file(device_map)
    facts = facts_of(fact or {})
    plan = RunPlan(protocol=read, name=Path(path).stem, rig=known, device_file=file, seed=seed, tags=tag, facts=facts)
    simulated = _virtual_rig(plan, real_time=real_time) if file is None else None
    return run_and_record(
        plan,
        ready_devices(Path(device_map)) if simulated is None else simulated.devices,
        out=Path(out),
        virtual=simulated,
        operator=(lambda prompt: True) if yes else operator,
        control=control,
    )


@task
def virtual(
    rig: RigFile,
    *,
    protocol: Annotated[
        InputFile | None,
        Parameter("Such as study_1, or a TOML file; map_test at load and speed of the rig.", "PROTOCOL"),
    ] = None,
    seed: Annotated[int, Parameter("Of all that is drawn: another specimen, other noise.", lowest=0)] = 0,
    file_format: Annotated[
        Literal["netcdf", "tdms", "csv"], Parameter("Of the recording, beside netCDF.", option="--format")
    ] = "netcdf",
    out: AllRuns = RUNS,
    **watch: Unpack[Watched],
) -> RunAnswer:
    """Record a realistic test of a rig that exists in its file only.

    Example: sonolube lab virtual examples/rigs/power_map.toml --protocol map_test
    """
    if file_format not in EXPORT_FORMATS:
        raise UnknownName.among(EXPORT_FORMATS, kind="format", name=file_format)
    known = rig_of(rig)
    path = _OWN_TEST if protocol is None else str(file_path(protocol))
    read = protocol_by_name_or_file(path)
    if protocol is None:
        read = protocol_at(read, normal_load=known.normal_load, sliding_speed=known.sliding_speed)
    plan = RunPlan(protocol=read, name=Path(path).stem, rig=known, seed=seed)
    simulated = _virtual_rig(plan)
    found = run_and_record(plan, simulated.devices, out=Path(out), virtual=simulated)
    if file_format != "netcdf":
        export_run(found.run.folder, file_format=file_format, out=found.run.folder)
    return found


def _require_possible_dry(protocol: Protocol, rig: Rig | None) -> None:
    """Raise where a dry run says that a test is impossible or would be ended by a limit."""
    refusals = dry_runs.dry_run(protocol, rig=rig).refusals
    if refusals:
        more = f" (and {len(refusals) - 1} more by {shown('dry_run')})" if len(refusals) > 1 else ""
        raise InvalidInput(f"impossible by a dry run: {refusals[0]}{more}; {shown('anyway')} runs it all the same")


def _virtual_rig(plan: RunPlan, *, real_time: bool = False) -> VirtualTribometer:
    """Virtual tribometer of a plan's rig.

    Raises
    ------
    InvalidInput
        If the plan names no rig.
    """
    if plan.rig is None:
        raise InvalidInput(f"{shown('device_map')} virtual needs {shown('rig')}, whose friction it takes")
    metadata = plan.protocol.metadata
    rig = plan.rig if metadata.normal_load is None else replace(plan.rig, normal_load=metadata.normal_load)
    diameter = metadata.groove_diameter or GROOVE_DIAMETER
    return virtual_tribometer(rig, seed=plan.seed, real_time=real_time, groove_diameter=diameter)
