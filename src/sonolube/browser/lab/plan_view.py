"""Devices of the laboratory, and whether a run can be started: what a page asks before anything is connected."""

from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Final

from sonolube.browser.answers import given_rig
from sonolube.browser.lab.protocol_view import read_text, requested_protocol
from sonolube.browser.requests import Places
from sonolube.errors import InvalidInput, SeveralFaults
from sonolube.facts.protocol import Protocol, flattened, protocol_by_name_or_file, protocol_names

_MOST: Final = 50  # tags and facts
_SEED: Final = 2**32


def devices(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Devices with their channels, and protocols of the dissertation."""
    del payload
    named = [{"name": name, "title": protocol_by_name_or_file(name).title} for name in protocol_names()]
    return {"devices": _devices(places), "protocols": named}


def _devices(places: Places) -> dict[str, Any]:
    """Kind, title and channels of the devices."""
    from sonolube.laboratory.block import quantity_of
    from sonolube.laboratory.drivers import read_device_map
    from sonolube.laboratory.virtual_tribometer.simulation import CHANNELS
    from sonolube.vocabulary import unit_of

    if places.device_map:
        found = read_device_map(Path(places.device_map))
        kind, title = "map", found.entries.title
        channels = [(name, channel.unit) for name, channel in found.devices().channels.items()]
    else:
        kind, title = "virtual", "virtual tribometer"
        channels = [(name, unit_of(quantity_of(name))) for name in CHANNELS]
    named = [{"name": name, "label": name.replace("_", " "), "unit": unit} for name, unit in channels]
    return {"kind": kind, "title": title, "channels": named}


def plan(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Request of a run that can be started, with what it is of.

    Raises
    ------
    InvalidInput
        If the protocol has faults, is impossible by a dry run or for the devices, or anything else is amiss.
    """
    name, text = requested_protocol(payload)
    protocol, _ = read_text(text)
    seed, anyway = payload.get("seed", 0), payload.get("anyway", False)
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < _SEED:
        raise InvalidInput(f"seed: {str(seed)[:40]!r} must be a whole number from 0", key="seed")
    if not isinstance(anyway, bool):
        raise InvalidInput("anyway: say true or false", key="anyway")
    source = payload.get("rig")
    title = _possible(protocol, source, places, anyway=anyway)
    points = flattened(protocol)
    about = {
        "protocol": name,
        "title": protocol.title,
        "rig": title,
        "seed": None if places.device_map else seed,
        "is_virtual": not places.device_map,
        "steps": len(protocol.steps),
        "total": points[-1].time,
        "voltage_maximum": protocol.limits.voltage_maximum,
    }
    return {
        "about": about,
        "protocol": {"name": name, "text": text},
        "rig": source,
        "seed": seed,
        "anyway": anyway,
        "tags": _texts(payload.get("tags") or [], "tags"),
        "facts": _facts(payload.get("facts") or {}),
    }


def _possible(protocol: Protocol, source: Any, places: Places, *, anyway: bool) -> str:
    """Title of the rig on which a protocol can be run.

    Raises
    ------
    InvalidInput
        If it cannot.
    """
    from sonolube.laboratory.drivers import read_device_map, unfulfilled
    from sonolube.laboratory.dry_run import dry_run

    if source is None and not places.device_map:
        raise InvalidInput("rig: a virtual tribometer needs a rig, whose friction it takes", key="rig")
    with ExitStack() as stack:
        rig = None if source is None else given_rig(source, places, stack)
        found = (
            [] if anyway else [f"{each}; start it anyway, or change it" for each in dry_run(protocol, rig=rig).refusals]
        )
    title = "" if rig is None else rig.title
    if places.device_map:
        devices = read_device_map(Path(places.device_map))
        found += unfulfilled(devices, protocol)
        title = devices.entries.title
    if found:
        raise InvalidInput(found[0], key="protocol") if len(found) == 1 else SeveralFaults(found)
    return title


def _texts(given: Any, name: str) -> list[str]:
    """Short texts of a request."""
    if not isinstance(given, list) or len(given) > _MOST or not all(isinstance(each, str) for each in given):
        raise InvalidInput(f"{name}: give up to {_MOST} texts", key=name)
    return [each.strip()[:80] for each in given if each.strip()]


def _facts(given: Any) -> dict[str, str | float]:
    """Facts of a request.

    Raises
    ------
    InvalidInput
        If a name is none.
    """
    from sonolube.tasks.lab.run_folders import facts_of

    if not isinstance(given, Mapping) or len(given) > _MOST:
        raise InvalidInput(f"facts: give up to {_MOST} texts by name, such as operator: Ann", key="facts")
    if not all(isinstance(value, str | int | float) and not isinstance(value, bool) for value in given.values()):
        raise InvalidInput("facts: give texts or numbers by name, such as operator: Ann", key="facts")
    return facts_of(given)
