"""Runs of protocols from the command line: plan, operator, record and answer of `lab run` and `lab virtual`."""

import select
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from shlex import quote
from typing import Any

import typer

from sonolube.cli.console.answer import Answer, aligned, si
from sonolube.cli.console.progress import progress
from sonolube.cli.console.questions import is_terminal
from sonolube.errors import InvalidInput
from sonolube.facts.protocol import Prompt, Protocol, flattened, protocol_text
from sonolube.input_files import input_text
from sonolube.laboratory import RunControl, RunResult, State, require_possible, run_protocol
from sonolube.laboratory.devices import Devices
from sonolube.laboratory.drivers import missing_parts, read_device_map
from sonolube.laboratory.records import Run, RunRecorder, new_run, read_run
from sonolube.laboratory.virtual_tribometer import GROOVE_DIAMETER, VirtualTribometer, virtual_tribometer
from sonolube.printable_text import printable
from sonolube.rig import Rig
from sonolube.units import format_si

_MOST_SAMPLES = 10_000_000  # of a recording whose mean is told
_POLL = 0.1  # s, between two looks at requests to end while an operator is asked


@dataclass(frozen=True, kw_only=True)
class RunPlan:
    """A run to be made.

    Parameters
    ----------
    protocol : Protocol
    name : str
        Of the protocol.
    rig : Rig or None
    rig_file : Path or None
    device_file : Path or None
        None for the virtual tribometer.
    seed : int
    real_time : bool
    confirmed : bool
        Whether prompts are taken as confirmed.
    tags : sequence of str
    """

    protocol: Protocol
    name: str
    rig: Rig | None
    rig_file: Path | None
    device_file: Path | None = None
    seed: int = 0
    real_time: bool = False
    confirmed: bool = False
    tags: Sequence[str] = ()


def virtual_rig(plan: RunPlan) -> VirtualTribometer:
    """Virtual tribometer of a plan's rig.

    Raises
    ------
    InvalidInput
        If the plan names no rig.
    """
    if plan.rig is None:
        raise InvalidInput("--device virtual needs --rig RIG.toml, whose friction it takes")
    diameter = plan.protocol.metadata.groove_diameter or GROOVE_DIAMETER
    return virtual_tribometer(plan.rig, seed=plan.seed, real_time=plan.real_time, groove_diameter=diameter)


def instruments(path: Path) -> Devices:
    """Devices of a map, whose packages and drivers are installed.

    Raises
    ------
    InvalidInput
        Naming what is missing.
    """
    device_map = read_device_map(path)
    missing = missing_parts(device_map)
    if missing:
        raise InvalidInput(f"{path}: {'; '.join(missing)}")
    return device_map.devices()


def run_and_record(plan: RunPlan, devices: Devices, *, out: Path, virtual: VirtualTribometer | None) -> "RunAnswer":
    """Run a plan on devices with its record below a folder, and tell how it went.

    Parameters
    ----------
    plan : RunPlan
    devices : Devices
    out : Path
        Folder of all runs.
    virtual : VirtualTribometer or None
        Whose truth is kept too.

    Returns
    -------
    RunAnswer

    Raises
    ------
    InvalidInput
        If the devices cannot do what the protocol says, nobody can answer its prompts, or another run is at work.
    """
    require_possible(plan.protocol, devices)
    confirmed = plan.confirmed or devices.simulated
    if not confirmed and _has_prompts(plan.protocol) and not is_terminal():
        raise InvalidInput("the protocol asks an operator; run it on a terminal, or take its prompts as done by --yes")
    recorder = begin_record(plan, devices, out=out)
    control = RunControl()
    with progress("running") as advance:
        result = run_protocol(
            plan.protocol,
            devices,
            recorder,
            operator=(lambda prompt: True) if confirmed else Operator(control),
            control=control,
            advance=advance,
        )
    if virtual is not None:
        recorder.store_truth(virtual.truth())
    return RunAnswer(result=result, run=read_run(recorder.folder), simulated=devices.simulated, rig_=plan.rig)


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


@dataclass(frozen=True, slots=True)
class Operator:
    """Person at the terminal who confirms prompts; requests to end the run are heard meanwhile.

    Parameters
    ----------
    control : RunControl
    """

    control: RunControl

    def __call__(self, prompt: Prompt) -> bool:
        """Show a prompt, and return whether it is confirmed by an empty line or by yes."""
        sys.stderr.write(printable(f"\r\x1b[K{prompt.task}: {prompt.text}\n  done? [Y/n] "))
        sys.stderr.flush()
        while not self.control.stop_reason:
            if select.select([sys.stdin], [], [], _POLL)[0]:
                answer = sys.stdin.readline()
                return bool(answer) and answer.strip().lower() in ("", "y", "yes")
        return False


@dataclass(frozen=True, kw_only=True)
class RunAnswer(Answer):
    """How a run ended, and where its record is."""

    result: RunResult
    run: Run
    simulated: bool
    rig_: Rig | None

    def lines(self) -> list[str]:
        """Outcome, what was recorded, and the next command."""
        summary = self.run.summary
        outcome = summary.outcome + (f": {summary.reason}" if summary.reason else "")
        mean = self._mean_friction()
        rows = [
            ("outcome", outcome),
            ("motor and drive", "off" if self.result.state is State.SAFE else "NOT confirmed off: cut the power"),
            ("recorded", f"{format_si(summary.duration, 's')}, {summary.samples} samples of each channel"),
            ("channels", ", ".join(summary.channels)),
            *(() if mean is None else (("mean friction", format_si(mean, "N", digits=3)),)),
            ("record", str(summary.folder)),
        ]
        names = [quote(str(path)) for path in self.run.recordings]
        after = [f"  next: sonolube measure friction {' '.join(names)}"] if names else []
        return [summary.title + (" (virtual)" if self.simulated else ""), *aligned(rows), *after]

    def object(self) -> dict[str, Any]:
        """Outcome, folder and recordings."""
        summary = self.run.summary
        return {
            "title": summary.title,
            "outcome": summary.outcome,
            "reason": summary.reason,
            "state": self.result.state.value,
            "simulated": self.simulated,
            "folder": str(summary.folder),
            "recordings": [str(path) for path in self.run.recordings],
            "samples": summary.samples,
            **si({"duration": summary.duration}, unit="s"),
            "tags": self.run.facts.get("tags", ""),
            **si({"friction_force": self._mean_friction()}),
        }

    def _mean_friction(self) -> float | None:
        """Mean friction force over a recording of moderate length; None without one."""
        if not self.run.recordings or self.run.summary.samples > _MOST_SAMPLES:
            return None
        recording = self.run.dataset()
        return float(recording["friction_force"].mean()) if "friction_force" in recording else None

    def caveats(self) -> Sequence[str]:
        """What speaks against the record."""
        told = ("friction is drawn from the prediction of the rig: no measurement",) if self.simulated else ()
        return (*self.run.caveats, *told)

    def assumptions(self) -> Mapping[str, str]:
        """Assumptions of the rig file, where the friction is that of the rig."""
        return {} if self.rig_ is None or not self.simulated else self.rig_.assumptions

    @property
    def exit_code(self) -> int:
        """0 for a completed run, 1 for one that ended before."""
        return 0 if self.run.summary.outcome == "completed" else 1


def exit_as(answer: RunAnswer) -> None:
    """End the program with 1 where a run ended before its protocol.

    Raises
    ------
    typer.Exit
    """
    if answer.exit_code:
        raise typer.Exit(answer.exit_code)


def _has_prompts(protocol: Protocol) -> bool:
    """Whether a protocol asks an operator."""
    return any(point.kind == "prompt" for point in flattened(protocol))


def _files(plan: RunPlan) -> dict[str, str]:
    """Texts of the files that the run was given, by the name under which they are kept."""
    given = {"rig.toml": plan.rig_file, "devices.toml": plan.device_file}
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
    if plan.device_file is not None:
        facts["rig"] = plan.device_file.stem  # one run at a time on the devices of a map, whatever rig file is given
    return facts
