"""Plan of a run: its protocol, rig and devices, and what its record says of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from sonolube.facts.protocol import Protocol, protocol_text
from sonolube.input_files import input_text
from sonolube.laboratory.devices import Devices
from sonolube.laboratory.records import RunRecorder, new_run
from sonolube.laboratory.set_points import groove_diameter
from sonolube.rig import Rig

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
    facts : mapping of str to str or float
        What is known besides, such as operator, humidity or the date of a calibration; before those of the protocol.
    """

    protocol: Protocol
    name: str
    rig: Rig | None
    device_file: Path | None = None
    seed: int = 0
    tags: Sequence[str] = ()
    facts: Mapping[str, str | float] = field(default_factory=dict)


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


def _files(plan: RunPlan) -> dict[str, str]:
    """Texts of the files that the run was given, by the name under which they are kept."""
    given = {"rig.toml": None if plan.rig is None else plan.rig.file, "devices.toml": plan.device_file}
    return {name: input_text(path) for name, path in given.items() if path is not None}


def _facts(plan: RunPlan, devices: Devices) -> dict[str, str | float | int | bool]:
    """What is known of the run, for its record and the catalogue."""
    rig, metadata = plan.rig, plan.protocol.metadata
    facts: dict[str, str | float | int | bool] = {
        "protocol": plan.name,
        "simulated": devices.simulated,
        **{f"device_{name.replace(' ', '_')}": text for name, text in devices.description.items()},
    }
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
        facts["rig"] = plan.device_file.stem  # one run at a time on the devices of a map, whatever rig file is given
    return facts
