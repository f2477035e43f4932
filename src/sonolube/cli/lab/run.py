"""Command `lab run`: a protocol on the devices of a rig or on a virtual tribometer, recorded; or gone through dry."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from sonolube.cli.console.answer import Answer, deliver, si
from sonolube.cli.console.options import Json, refuse_unused
from sonolube.cli.lab.running import RunPlan, exit_as, instruments, run_and_record, virtual_rig
from sonolube.facts.protocol import Protocol, protocol_by_name_or_file
from sonolube.laboratory.dry_run import DryRun, dry_run, dry_run_lines
from sonolube.rig import Rig, read_rig

RUNS = Path("runs")
"""Folder of all runs, where none is given."""


def run(
    context: typer.Context,
    protocol: Annotated[str, typer.Argument(metavar="PROTOCOL", help="Such as map_test, or a TOML file.")],
    rig: Annotated[
        Path | None, typer.Option(metavar="RIG.toml", help="The rig; a virtual tribometer takes its friction.")
    ] = None,
    device: Annotated[str, typer.Option(metavar="virtual|MAP.toml", help="What to run on.")] = "virtual",
    seed: Annotated[int, typer.Option(help="Of a virtual tribometer.", min=0)] = 0,
    real_time: Annotated[bool, typer.Option("--real-time", help="Let a virtual test take its time.")] = False,
    dry: Annotated[bool, typer.Option("--dry-run", help="Tell what will happen, and touch nothing.")] = False,
    yes: Annotated[bool, typer.Option("--yes", help="Take the prompts to the operator as done.")] = False,
    tag: Annotated[list[str] | None, typer.Option(metavar="TAG", help="For the catalogue; may come again.")] = None,
    out: Annotated[Path, typer.Option(metavar="DIR", help="Folder of all runs; each has a new one in it.")] = RUNS,
    json: Json = False,
) -> None:
    """Run a protocol and record it; motor and drive are off at the end, whatever happens.

    Example: sonolube lab run map_test --rig examples/rigs/power_map.toml
    """
    read = protocol_by_name_or_file(protocol)
    known = None if rig is None else read_rig(rig)
    if dry:
        refuse_unused(context, "seed", "real_time", "yes", "tag", "out", because="with --dry-run, which runs nothing")
        deliver(DryAnswer(protocol=read, rig=known, found=dry_run(read, rig=known)), as_json=json)
        return
    on_hardware = device != "virtual"
    if on_hardware:
        refuse_unused(context, "seed", "real_time", because="with --device MAP.toml, whose tests take their time")
    plan = RunPlan(
        protocol=read,
        name=Path(protocol).stem,
        rig=known,
        rig_file=rig,
        device_file=Path(device) if on_hardware else None,
        seed=seed,
        real_time=real_time,
        confirmed=yes,
        tags=tag or (),
    )
    virtual = None if on_hardware else virtual_rig(plan)
    devices = instruments(Path(device)) if virtual is None else virtual.devices
    answer = run_and_record(plan, devices, out=out, virtual=virtual)
    deliver(answer, as_json=json)
    exit_as(answer)


@dataclass(frozen=True, kw_only=True)
class DryAnswer(Answer):
    """What a protocol will do."""

    protocol: Protocol
    rig: Rig | None
    found: DryRun

    def lines(self) -> list[str]:
        """A line a set point, then time, data, drive and temperatures; what is impossible last."""
        refused = [f"  impossible: {each}" for each in self.found.refusals]
        return [self.protocol.title, *dry_run_lines(self.found), *refused]

    def object(self) -> dict[str, Any]:
        """Times, data and refusals."""
        return {
            "title": self.protocol.title,
            "possible": not self.found.refusals,
            "refusals": list(self.found.refusals),
            **si({"duration": self.found.duration}, unit="s"),
            "lines": dry_run_lines(self.found),
        }

    def caveats(self) -> Sequence[str]:
        """What may not hold."""
        return self.found.caveats

    def assumptions(self) -> Mapping[str, str]:
        """What drive and heat assume."""
        return self.found.assumptions
