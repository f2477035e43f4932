"""Runs on the devices of a rig or a virtual one: the devices, who answers the prompts, and the record."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

from sonolube.errors import InvalidInput
from sonolube.facts.protocol import Protocol, flattened
from sonolube.laboratory import RunControl, require_possible, run_protocol
from sonolube.laboratory.devices import Devices
from sonolube.laboratory.records import read_run
from sonolube.laboratory.reservation import require_free
from sonolube.laboratory.run_plan import RunPlan, begin_record
from sonolube.laboratory.runner import Operator
from sonolube.laboratory.virtual_tribometer import VirtualTribometer
from sonolube.tasks.lab.run_answer import RunAnswer
from sonolube.tasks.parameters import DoorParameter
from sonolube.tasks.progress import Advance, TaskCancelled, stage
from sonolube.tasks.task import refuse_unused, shown

OperatorDoor = Annotated[Operator | None, DoorParameter()]
ControlDoor = Annotated[RunControl | None, DoorParameter()]

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
    because = f"with {shown('device_map')} MAP.toml, whose tests take their time"
    refuse_unused("seed", "real_time", because=because)
    return Path(device_map)


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
        If the devices cannot do what the protocol says, nobody can answer its prompts, or another run has one of them.
    """
    require_possible(plan.protocol, devices)
    answers = _answering(plan.protocol, devices, operator)
    control = control or RunControl()
    require_free(devices.resources)
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
