"""Runs on the devices of a rig or a virtual one: the devices, who answers the prompts, and the record."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from sonolube.errors import InvalidInput
from sonolube.facts.protocol import Protocol, flattened, protocol_text
from sonolube.input_files import input_text
from sonolube.laboratory import RunControl, require_possible, run_protocol
from sonolube.laboratory.devices import Devices
from sonolube.laboratory.drivers import missing_parts, read_device_map
from sonolube.laboratory.records import RunRecorder, new_run, read_run
from sonolube.laboratory.runner import Operator
from sonolube.laboratory.virtual_tribometer import VirtualTribometer
from sonolube.rig import Rig
from sonolube.tasks.lab.run_answer import RunAnswer
from sonolube.tasks.parameters import DoorParameter
from sonolube.tasks.progress import Advance, TaskCancelled, stage
from sonolube.tasks.task import refuse_unused, shown

OperatorDoor = Annotated[Operator | None, DoorParameter()]
ControlDoor = Annotated[RunControl | None, DoorParameter()]

_VIRTUAL = "virtual"


@dataclass(frozen=True, kw_only=True)
class RunPlan:
    """A run to be made, and what its record says of it.

    Parameters
    ----------
    protocol : Protocol
    name : str
        Of the protocol.
    rig : Rig or None
    device_file : Path or None
        None for the virtual tribometer.
    seed : int
    tags : sequence of str
    """

    protocol: Protocol
    name: str
    rig: Rig | None
    device_file: Path | None = None
    seed: int = 0
    tags: Sequence[str] = ()


def device_file(device_map: str | Path) -> Path | None:
    """Device map of the running task; None for the virtual tribometer.

    Raises
    ------
    InvalidInput
        If arguments of the virtual tribometer are given beside a device map.
    """
    if str(device_map) == _VIRTUAL:
        return None
    because = f"with {shown('device_map')} MAP.toml, whose tests take their time"
    refuse_unused("seed", "real_time", because=because)
    return Path(device_map)


def instruments(device_map: str | Path) -> Devices:
    """Devices of a map, whose packages and drivers are installed.

    Raises
    ------
    InvalidInput
        Naming what is missing.
    """
    found = read_device_map(Path(device_map))
    missing = missing_parts(found)
    if missing:
        raise InvalidInput(f"{device_map}: {'; '.join(missing)}")
    return found.devices()


def run_and_record(
    plan: RunPlan,
    devices: Devices,
    *,
    out: Path,
    virtual: VirtualTribometer | None = None,
    operator: Operator | None = None,
    control: RunControl | None = None,
) -> RunAnswer:
    """Run a plan on devices with its record below a folder, and say how it went.

    Parameters
    ----------
    plan : RunPlan
    devices : Devices
    out : Path
        Folder of all runs.
    virtual : VirtualTribometer, optional
        Whose truth is kept too.
    operator : callable, optional
        Answers the prompts of a protocol on devices that are not simulated.
    control : RunControl, optional
        Requests of others.

    Returns
    -------
    RunAnswer

    Raises
    ------
    InvalidInput
        If the devices cannot do what the protocol says, nobody can answer its prompts, or another run is at work.
    """
    require_possible(plan.protocol, devices)
    answers = _answering(plan.protocol, devices, operator)
    control = control or RunControl()
    recorder = begin_record(plan, devices, out=out)
    with run_stage("running", control) as advance:
        result = run_protocol(plan.protocol, devices, recorder, operator=answers, control=control, advance=advance)
        if virtual is not None:
            recorder.store_truth(virtual.truth())
    return RunAnswer(result=result, run=read_run(recorder.folder), simulated=devices.simulated, rig=plan.rig)


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


def begin_record(
    plan: RunPlan, devices: Devices, *, out: Path, facts: Mapping[str, str | float] | None = None
) -> RunRecorder:
    """Begin the record of a plan below a folder, with its files and what is known of it.

    Parameters
    ----------
    plan : RunPlan
    devices : Devices
    out : Path
        Folder of all runs.
    facts : mapping of str to str or float, optional
        What is known besides.

    Returns
    -------
    RunRecorder

    Raises
    ------
    InvalidInput
        If another run is at work at the rig.
    """
    return new_run(
        out,
        title=plan.protocol.title,
        protocol=protocol_text(plan.protocol),
        files=_files(plan),
        facts=_facts(plan, devices) | dict(facts or {}),
    )


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


def _files(plan: RunPlan) -> dict[str, str]:
    """Texts of the files that the run was given, by the name under which they are kept."""
    given = {"rig.toml": None if plan.rig is None else plan.rig.file, "devices.toml": plan.device_file}
    return {name: input_text(path) for name, path in given.items() if path is not None}


def _facts(plan: RunPlan, devices: Devices) -> dict[str, str | float | int | bool]:
    """What is known of the run, for its record and the catalogue."""
    rig = plan.rig
    facts: dict[str, str | float | int | bool] = {
        "protocol": plan.name,
        "simulated": devices.simulated,
        **{f"device_{name.replace(' ', '_')}": text for name, text in devices.description.items()},
    }
    if plan.tags:
        facts["tags"] = ", ".join(plan.tags)
    if devices.simulated:
        facts["seed"] = plan.seed
    if rig is not None:
        facts |= {"normal_load": rig.normal_load, "rig_title": rig.title, "nominal_area": rig.contact.nominal_area}
        facts |= {name: value for name in ("pin_material", "disc_material") if (value := getattr(rig, name))}
        if rig.changes:
            facts["changed_entries"] = "; ".join(rig.changes)
    if plan.device_file is not None:
        facts["rig"] = plan.device_file.stem  # one run at a time on the devices of a map, whatever rig file is given
    return facts
