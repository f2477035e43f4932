"""Plan of a run: its protocol, rig and devices, and what its record says of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from sonolube.facts.protocol import Protocol, protocol_text
from sonolube.laboratory.devices import Devices
from sonolube.laboratory.interlocks import DriveSampling, drive_sampling, interlocks_for, recorded_channels
from sonolube.laboratory.records import UNRESOLVED, RunRecorder, new_run
from sonolube.laboratory.set_points import groove_diameter
from sonolube.laboratory.supervision import LATE
from sonolube.rig import Rig
from sonolube.storage.user_files import input_text

_STATED: Final = ("specimen", "operator", "humidity", "calibrated", "block", "run")  # of the metadata of a protocol


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
    drive : DriveSampling or None
        How often the drive is sampled, where the protocol does not tell it.
    facts : mapping of str to str or float
        What is known besides, such as operator, humidity or the date of a calibration; before those of the protocol.
    """

    protocol: Protocol
    name: str
    rig: Rig | None
    device_file: Path | None = None
    seed: int = 0
    tags: Sequence[str] = ()
    drive: DriveSampling | None = None
    facts: Mapping[str, str | float] = field(default_factory=dict)

    def unresolved(self, devices: Devices) -> str:
        """Quantities of the drive that record and limits do not show, in one line; empty where they show all."""
        drive = self.drive or drive_sampling(self.protocol)
        if drive is None:
            return ""
        locks = interlocks_for(self.protocol.limits, devices.channels, drive)
        names = [*recorded_channels(self.protocol), *(lock.channel.name for lock in locks)]
        return drive.caveat_of(names, devices.channels)


def begin_record(
    plan: RunPlan, devices: Devices, *, out: Path, facts: Mapping[str, str | float] | None = None
) -> RunRecorder:
    """Begin the record of a plan below a folder, with its files and what is known of it."""
    return new_run(
        out,
        title=plan.protocol.title,
        protocol=protocol_text(plan.protocol),
        files=_files(plan),
        facts=_facts(plan, devices) | dict(facts or {}),
    )


def _files(plan: RunPlan) -> dict[str, str]:
    """Texts of the files that the run was given, by the name under which they are kept."""
    given = {"rig.toml": None if plan.rig is None else plan.rig.file, "devices.toml": plan.device_file}
    return {name: input_text(path) for name, path in given.items() if path is not None}


def _facts(plan: RunPlan, devices: Devices) -> dict[str, str | float | int | bool]:
    """Facts of the run, for its record and the catalogue."""
    rig, metadata = plan.rig, plan.protocol.metadata
    facts: dict[str, str | float | int | bool] = {
        "protocol": plan.name,
        "simulated": devices.simulated,
        **{f"device_{name.replace(' ', '_')}": text for name, text in devices.description.items()},
    }
    facts["late_maximum"] = LATE
    if unresolved := plan.unresolved(devices):
        facts[UNRESOLVED] = unresolved
    facts["groove_diameter"] = groove_diameter(plan.protocol, devices)
    facts |= {name: text for name in _STATED if (text := getattr(metadata, name))} | dict(plan.facts)
    if metadata.normal_load is not None:
        facts["normal_load"] = metadata.normal_load
    if plan.tags:
        facts["tags"] = ", ".join(plan.tags)
    if devices.simulated:
        facts["seed"] = plan.seed
    if rig is not None:
        facts |= {
            "normal_load": facts.get("normal_load", rig.normal_load),
            "rig_title": rig.title,
            "nominal_area": rig.contact.nominal_area,
        }
        facts |= {name: value for name in ("pin_material", "disc_material") if (value := getattr(rig, name))}
        if rig.changes:
            facts["changed_entries"] = "; ".join(rig.changes)
    if plan.device_file is not None:
        facts["rig"] = plan.device_file.stem
    return facts
