"""Protocols as TOML text: read with every fault and its place, written; JSON schema; those of the dissertation."""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

from pydantic import ValidationError

from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.protocol.record import STEP_KINDS, Protocol
from sonolube.facts.protocol.time_line import flattened
from sonolube.text.toml_text import read_toml, require_plain_content
from sonolube.text.units import format_si

_MAX_FAULTS: Final = 10  # that one refusal names
_LONGEST_FAULT: Final = 300  # characters
_STEP: Final = re.compile(r"step ([\d.]+):")


def read_protocol(path: str | Path) -> Protocol:
    """Read a protocol from a TOML file.

    Parameters
    ----------
    path : str or Path

    Returns
    -------
    Protocol

    Raises
    ------
    InvalidInput
        In one line with the file, and every fault with its step and key.
    """
    path = Path(path)
    try:
        return protocol_from(read_toml(path, kind="a protocol"))
    except InvalidInput as refusal:
        raise InvalidInput(f"{path}: {refusal}") from None


def protocol_from(content: Mapping[str, Any]) -> Protocol:
    """Protocol of the content of its file.

    Parameters
    ----------
    content : mapping
        As TOML gives it: quantities as text with units.

    Returns
    -------
    Protocol

    Raises
    ------
    InvalidInput
        In one line with every fault, its step and key; also where set points lie beyond the limits.
    """
    require_plain_content(content)
    try:
        protocol = Protocol.model_validate(content)
    except ValidationError as refusal:
        raise InvalidInput(_faults(refusal)) from None
    _require_within_limits(protocol)
    return protocol


def protocol_faults(content: Mapping[str, Any]) -> tuple[tuple[str, str], ...]:
    """Faults of the content of a file of a protocol, each with the key of its entry.

    Parameters
    ----------
    content : mapping
        As TOML gives it.

    Returns
    -------
    tuple of (str, str)
        Such as ("steps.4.2.duration", "step 4.2: duration: missing"); empty where the content is a protocol.
    """
    try:
        require_plain_content(content)
        _require_within_limits(Protocol.model_validate(content))
    except ValidationError as refusal:
        complaints = refusal.errors(include_url=False, include_context=False, include_input=False)
        return tuple(
            (_key(each["loc"]), f"{_place(each['loc'])}{_reason(each['type'], each['msg'])}"[:_LONGEST_FAULT])
            for each in complaints[:_MAX_FAULTS]
        )
    except InvalidInput as refusal:
        step = _STEP.match(str(refusal))
        return ((f"steps.{step[1]}" if step else "", str(refusal)),)
    return ()


def protocol_schema() -> dict[str, Any]:
    """JSON schema (draft 2020-12) that every protocol follows.

    Returns
    -------
    dict
    """
    content = {key: value for key, value in Protocol.model_json_schema().items() if key != "title"}
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "sonolube protocol"} | content


def protocol_text(protocol: Protocol) -> str:
    """TOML text of a protocol, which reads back as the same record.

    Parameters
    ----------
    protocol : Protocol

    Returns
    -------
    str
    """
    content = protocol.model_dump(mode="json", exclude_none=True)
    steps = content.pop("steps")
    lines = [*_entries(content)]
    for name in ("limits", "metadata"):
        entries = {key: value for key, value in content[name].items() if value != ""}
        lines += ["", f"[{name}]", *_entries(entries)]
    return "\n".join([*lines, *_step_lines(steps, "steps")]) + "\n"


def _step_lines(steps: Sequence[Mapping[str, Any]], name: str) -> Iterator[str]:
    """Lines of steps as an array of tables, the steps of a repeat below it."""
    for step in steps:
        written = {key: value for key, value in step.items() if value != "" or key == "lubricant"}
        yield from ("", f"[[{name}]]", *_entries(written))
        yield from _step_lines(step.get("steps", ()), f"{name}.steps")


def _entries(table: Mapping[str, Any]) -> Iterator[str]:
    """Lines of the keys of a table that are no tables."""
    for key, value in table.items():
        if key != "steps" and not isinstance(value, dict):
            yield f"{key} = {json.dumps(value, ensure_ascii=False)}"


def _faults(refusal: ValidationError) -> str:
    """All faults in one line, each with its place."""
    complaints = refusal.errors(include_url=False, include_context=False, include_input=False)
    places = [each["loc"] for each in complaints]
    told = [
        f"{_place(each['loc'])}{_reason(each['type'], each['msg'])}"[:_LONGEST_FAULT]
        for each in complaints
        if not (each["type"] == "too_short" and any(_is_below(place, each["loc"]) for place in places))
    ]
    more = [f"and {len(told) - _MAX_FAULTS} more"] if len(told) > _MAX_FAULTS else []
    return "; ".join([*told[:_MAX_FAULTS], *more])


def _is_below(place: Sequence[str | int], other: Sequence[str | int]) -> bool:
    """Whether a place lies within another: a list without its faulty items is no shorter for that."""
    return len(place) > len(other) and tuple(place[: len(other)]) == tuple(other)


def _place(parts: Sequence[str | int]) -> str:
    """Step and key of a fault, such as "step 4.2: duration: "."""
    numbers: list[str] = []
    keys: list[str] = []
    inside = False  # of a list of steps
    for part in parts:
        if isinstance(part, int) and inside:
            numbers.append(str(part + 1))
            inside = False
        elif part == "steps" and not keys:
            inside = True
        elif isinstance(part, int):
            keys[-1] += f"[{part + 1}]"
        elif not (numbers and not keys and part in STEP_KINDS):
            keys.append(part)
    whole = ["steps"] if inside else []
    step = [f"step {'.'.join(numbers)}"] if numbers else []
    return "".join(f"{each}: " for each in (*step, *keys, *whole))


def _key(parts: Sequence[str | int]) -> str:
    """Key of the entry of a fault, such as "steps.4.2.duration"; of a list, that of the whole."""
    numbers = [str(part + 1) for before, part in pairwise(("", *parts)) if isinstance(part, int) and before == "steps"]
    named = [part for part in parts if isinstance(part, str) and part != "steps" and part not in STEP_KINDS]
    return ".".join(["steps", *numbers, *named] if numbers else named)


def _reason(kind: str, message: str) -> str:
    """Reason of a fault in plain words."""
    known = {
        "extra_forbidden": "unknown key",
        "missing": "missing",
        "too_short": "needs at least one entry",
        "union_tag_invalid": f"kind must be one of {', '.join(STEP_KINDS)}",
        "union_tag_not_found": f"kind is missing; one of {', '.join(STEP_KINDS)}",
    }
    return known.get(kind, message.removeprefix("Value error, ").strip())


def _require_within_limits(protocol: Protocol) -> None:
    """Raise where a set point lies beyond the limits of the protocol."""
    points, limits = flattened(protocol), protocol.limits
    for point in points:
        if point.voltage_maximum > limits.voltage_maximum * (1 + 1e-9):
            reached, allowed = format_si(point.voltage_maximum, "V"), format_si(limits.voltage_maximum, "V")
            raise InvalidInput(f"step {point.step}: the drive reaches {reached}; limits.voltage_maximum is {allowed}")
    total = points[-1].time
    if total > limits.duration_maximum * (1 + 1e-9):
        lasts, allowed = format_si(total, "s"), format_si(limits.duration_maximum, "s")
        raise InvalidInput(f"steps: the test lasts {lasts}; limits.duration_maximum is {allowed}")


_FOLDER: Final = Path(__file__).parent / "dissertation"


def protocol_names() -> tuple[str, ...]:
    """Names of the protocols that come with the package, such as map_test, in alphabetical order.

    Examples
    --------
    >>> from sonolube.facts.protocol import duration, protocol_by_name_or_file, protocol_names
    >>> "map_test" in protocol_names(), duration(protocol_by_name_or_file("map_test"))
    (True, 32.5)
    """
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.toml")))


def protocol_path(name: str) -> Path:
    """File of a protocol that comes with the package, to be copied and changed.

    Parameters
    ----------
    name : str
        One of `protocol_names`.

    Returns
    -------
    Path

    Raises
    ------
    UnknownName
        If there is no such protocol.
    """
    if name not in protocol_names():
        raise UnknownName.among(protocol_names(), kind="protocol", name=name)
    return _FOLDER / f"{name}.toml"


def protocol_by_name_or_file(text: str) -> Protocol:
    """Protocol by its name, or by the path of its file.

    Parameters
    ----------
    text : str
        One of `protocol_names`, or the path of a TOML file.

    Returns
    -------
    Protocol

    Raises
    ------
    UnknownName
        If it is neither; the closest name is suggested.
    InvalidInput
        If the file has faults.
    """
    if text not in protocol_names() and (text.lower().endswith(".toml") or Path(text).exists()):
        return read_protocol(text)
    return read_protocol(protocol_path(text))
