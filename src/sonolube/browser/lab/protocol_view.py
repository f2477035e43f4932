"""Protocols as page Lab shows and edits them: their text, steps as a time line of fields, limits, and the dry run."""

from collections import defaultdict
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import asdict
from itertools import pairwise
from pathlib import PurePath
from typing import Any, Final

from sonolube.browser.answers import answer_object, given_rig
from sonolube.browser.requests import Places
from sonolube.errors import InvalidInput, SeveralFaults
from sonolube.facts.protocol import (
    STEP_KINDS,
    Protocol,
    ProtocolField,
    SetPoint,
    edited_protocol_text,
    flattened,
    protocol_faults,
    protocol_fields,
    protocol_from,
    protocol_path,
    protocol_steps,
)
from sonolube.facts.protocol.step import LANES
from sonolube.tasks.files import NamedBytes
from sonolube.text.toml_text import toml_content

_LONGEST: Final = 200_000  # characters of a protocol
_STARTS: Final = 200  # of one step
_REPEATS, _OTHERS = "repeat", "steps"  # lanes of steps around others, and of those that set nothing


def protocol_view(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Protocol of a request with its steps, limits and dry run."""
    name, text = requested_protocol(payload)
    return _viewed(name, text, payload.get("rig"), places)


def edited_protocol(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Protocol of a request, edited."""
    name, text = requested_protocol(payload)
    changes = payload.get("changes")
    if not isinstance(changes, Mapping):
        raise InvalidInput("changes: give texts by keys, such as steps.2.duration: 20 s", key="changes")
    return _viewed(name, edited_protocol_text(text, changes), payload.get("rig"), places)


def requested_protocol(payload: Mapping[str, Any]) -> tuple[str, str]:
    """Name and text of the protocol of a request."""
    asked = payload.get("protocol") or {"text": payload.get("text")}
    if not isinstance(asked, Mapping):
        raise InvalidInput("protocol: give its name, or a name and its text", key="protocol")
    name, text = asked.get("name") or "protocol", asked.get("text")
    if not isinstance(name, str) or PurePath(name).name != name or name.startswith(".") or len(name) > 80:
        raise InvalidInput(f"protocol: {str(name)[:80]!r} is no name", key="protocol")
    if text is None or text == "":
        return name, protocol_path(name).read_text(encoding="utf-8")
    if not isinstance(text, str) or len(text) > _LONGEST:
        raise InvalidInput(f"protocol: its text must have up to {_LONGEST} characters", key="protocol")
    return name.removesuffix(".toml"), text


def read_text(text: str) -> tuple[Protocol, dict[str, Any]]:
    """Protocol of a text with the content of the file; its faults with the keys of their fields."""
    content = toml_content(text)
    faults = protocol_faults(content)
    if len(faults) > 1:
        raise SeveralFaults([each for _, each in faults], keys=[key for key, _ in faults])
    if faults:
        raise InvalidInput(faults[0][1], key=faults[0][0])
    return protocol_from(content), content


def _viewed(name: str, text: str, rig: Any, places: Places) -> dict[str, Any]:
    """Protocol with its steps, limits and dry run."""
    from sonolube.tasks.lab.protocol_run import DryRunAnswer, run

    protocol, content = read_text(text)
    with ExitStack() as stack:
        known = None if rig is None else given_rig(rig, places, stack)
        dry = run(NamedBytes(f"{name}.toml", text.encode("utf-8", "replace")), rig=known, dry_run=True)
    assert isinstance(dry, DryRunAnswer)
    points = flattened(protocol)
    limits = protocol.limits.model_dump()
    return {
        "name": name,
        "title": protocol.title,
        "source": protocol.source,
        "text": text,
        "steps": _steps(content, points),
        "kinds": list(STEP_KINDS),
        "lanes": [_REPEATS, _OTHERS, *LANES],
        "limits": [
            _field(each) | {"lower": None, "upper": limits.get(each.name)}
            for each in protocol_fields(content, "limits")
        ],
        "metadata": [_field(each) for each in protocol_fields(content, "metadata")],
        "total": points[-1].time,
        "prompts": sum(point.kind == "prompt" for point in points),
        "dry_run": answer_object(dry),
        "refusals": list(dry.found.refusals),
    }


def _steps(content: Mapping[str, Any], points: tuple[SetPoint, ...]) -> list[dict[str, Any]]:
    """Steps with their times by the set points of the protocol."""
    starts, lasts = defaultdict[str, list[float]](list), defaultdict[str, float](float)
    lanes: dict[str, str] = {}
    before = ""
    for point, following in pairwise(points):
        number = point.step
        lanes.setdefault(number, next(iter(point.sets), _OTHERS))
        while number:  # of the step and the repeats around it
            if not (number == before or before.startswith(f"{number}.")) or (
                number == point.step and lasts[number] == 0
            ):
                starts[number].append(point.time)
            lasts[number] += following.time - point.time
            number = number.rpartition(".")[0]
        before = point.step
    return [
        {
            "number": step.number,
            "depth": step.depth,
            "kind": step.kind,
            "label": step.kind.replace("_", " "),
            "lane": lanes.get(step.number, _REPEATS),
            "start": next(iter(starts[step.number]), None),
            "duration": _duration(step.number, points, lasts),
            "starts": starts[step.number][:_STARTS],
            "fields": [_field(each) for each in step.fields],
        }
        for step in protocol_steps(content)
    ]


def _duration(number: str, points: tuple[SetPoint, ...], lasts: Mapping[str, float]) -> float:
    """Time of a step: all repeats of one together; of a recording, how long it goes on. [s]"""
    recordings = [point for point in points if point.step == number and point.begins_recording]
    if not recordings:
        return lasts.get(number, 0.0)
    return sum((point.recorded_until or point.time) - point.time for point in recordings)


def _field(entry: ProtocolField) -> dict[str, Any]:
    """Field as an object."""
    return asdict(entry) | {"label": entry.name.replace("_", " "), "choices": list(entry.choices)}
