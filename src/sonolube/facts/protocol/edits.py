"""Texts of protocols as fields, one a key of a step, and edited by them: entries, steps inserted, removed and moved."""

import re
from collections.abc import Iterator, Mapping, MutableSequence
from dataclasses import dataclass, field
from functools import cache
from types import MappingProxyType
from typing import Any, Final

from pydantic import BaseModel

from sonolube.errors import InvalidInput, entry_named
from sonolube.facts.protocol.record import STEP_CLASSES, Limits, Metadata

_TABLES: Final[Mapping[str, type[BaseModel]]] = MappingProxyType({"limits": Limits, "metadata": Metadata})
_NUMBER: Final = re.compile(r"\d{1,5}(?:\.\d{1,5}){0,8}")


@dataclass(frozen=True, kw_only=True, slots=True)
class ProtocolField:
    """Entry of a protocol, as it is written.

    Parameters
    ----------
    key : str
        Such as steps.4.2.duration, limits.voltage_maximum or title; steps count from 1.
    text : str
        Empty where the file has no such entry; those of a list between commas.
    kind : str
        quantity, text, list, number, flag or choice.
    unit : str
        SI unit of a quantity; empty for others.
    choices : tuple of str
        Of a choice.
    is_required : bool
    """

    key: str
    text: str
    kind: str
    unit: str = ""
    choices: tuple[str, ...] = ()
    is_required: bool = False

    @property
    def name(self) -> str:
        """Last part of the key."""
        return self.key.rpartition(".")[2]


@dataclass(frozen=True, kw_only=True, slots=True)
class ProtocolStep:
    """Step of a protocol, as it is written.

    Parameters
    ----------
    number : str
        Such as "4", or "4.2" for the second step of a repeat.
    kind : str
    fields : tuple of ProtocolField
    """

    number: str
    kind: str
    fields: tuple[ProtocolField, ...] = field(default=())

    @property
    def depth(self) -> int:
        """Number of repeats around it."""
        return self.number.count(".")


def protocol_fields(content: Mapping[str, Any], table: str) -> tuple[ProtocolField, ...]:
    """Entries of a table of a protocol, with those that it may have.

    Parameters
    ----------
    content : mapping
        Of the file.
    table : str
        limits or metadata.

    Returns
    -------
    tuple of ProtocolField
    """
    entries = content.get(table)
    return tuple(_fields(_TABLES[table], entries if isinstance(entries, Mapping) else {}, table))


def protocol_steps(content: Mapping[str, Any]) -> tuple[ProtocolStep, ...]:
    """Steps of a protocol as they are written, those of a repeat after it.

    Parameters
    ----------
    content : mapping
        Of the file, which can be read as a protocol.

    Returns
    -------
    tuple of ProtocolStep
    """
    return tuple(_steps(content, ""))


def edited_protocol_text(text: str, changes: Mapping[str, Any]) -> str:
    """Text of a protocol with entries replaced, or a step inserted, removed or moved; comments are kept.

    Parameters
    ----------
    text : str
        TOML.
    changes : mapping
        Texts by the keys of fields, of which empty ones take an entry out; or one of insert: {before, kind},
        remove: number, move: {step, before}. Numbers are those of steps.

    Returns
    -------
    str
        Which may be no protocol: read it.

    Raises
    ------
    InvalidInput
        If there is no such step or key.
    """
    import tomlkit
    from tomlkit.exceptions import TOMLKitError

    try:
        document = tomlkit.parse(text)
    except (TOMLKitError, ValueError, RecursionError) as failure:
        raise InvalidInput(f"not valid TOML: {' '.join(str(failure).split())[:200]}") from None
    for key, value in changes.items():
        if key in _MOVES and not isinstance(value, str | Mapping):
            raise InvalidInput(f"{key}: give the number of a step", key=key)
        if key in _MOVES:
            _MOVES[key](document, value)
        elif isinstance(value, str):
            _set(document, key, value)
        else:
            raise InvalidInput(f"{key[:80]!r}: give a text, such as 20 s", key=key)
    return tomlkit.dumps(document)


@cache
def _schema(model: type[BaseModel]) -> dict[str, Any]:
    """JSON schema of a table; that of a repeat, which may hold others, refers to itself."""
    schema = model.model_json_schema()
    found: dict[str, Any] = schema if "properties" in schema else schema["$defs"][model.__name__]
    return found


def _fields(model: type[BaseModel], entries: Mapping[str, Any], place: str) -> Iterator[ProtocolField]:
    """Entries that a table has or may have."""
    schema = _schema(model)
    for name in model.model_fields:
        if name in ("kind", "steps", "over"):
            continue
        given = schema["properties"][name]
        form = next((each for each in given.get("anyOf", ()) if each.get("type") != "null"), given)
        inner = form.get("items", form)
        yield ProtocolField(
            key=f"{place}.{name}",
            text=_text(entries.get(name, "")),
            kind=_kind(form),
            unit=inner.get("x-si-unit", ""),
            choices=tuple(map(str, form.get("enum", ()))),
            is_required=name in schema.get("required", ()),
        )
    over = entries.get("over")
    if isinstance(over, Mapping):
        for name, values in over.items():
            yield ProtocolField(key=f"{place}.over.{name}", text=_text(values), kind="list", is_required=True)


def _kind(form: Mapping[str, Any]) -> str:
    """Kind of a field by its schema."""
    if "enum" in form:
        return "choice"
    if "x-si-unit" in form:
        return "quantity"
    return {"array": "list", "integer": "number", "boolean": "flag"}.get(form.get("type", ""), "text")


def _text(value: Any) -> str:
    """Value as text."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return ", ".join(map(str, value)) if isinstance(value, list | tuple) else str(value)


def _steps(content: Mapping[str, Any], prefix: str) -> Iterator[ProtocolStep]:
    """Steps of a list, with those within them."""
    for number, step in enumerate(content.get("steps", ()), 1):
        place, kind = f"{prefix}{number}", str(step.get("kind", ""))
        yield ProtocolStep(number=place, kind=kind, fields=tuple(_fields(STEP_CLASSES[kind], step, f"steps.{place}")))
        yield from _steps(step, f"{place}.")


def _set(document: Any, key: str, text: str) -> None:
    """Set or take out an entry."""
    place, model, name = _place(document, key)
    if not text.strip():
        place.pop(name, None)
        return
    fields = (
        dict.fromkeys(place, "list") if model is None else {each.name: each.kind for each in _fields(model, place, "")}
    )
    if name not in fields:
        raise InvalidInput(f"{key[:80]!r}: no such entry; known: {', '.join(fields)}", key=key)
    place[name] = _value(fields[name], text.strip(), key)


def _value(kind: str, text: str, key: str) -> Any:
    """Value of a field of a kind by its text."""
    match kind:
        case "list":
            return [each for each in (part.strip() for part in text.split(",")) if each]
        case "number":
            if not re.fullmatch(r"\d{1,9}", text):
                raise InvalidInput(f"{key[:80]!r}: {text[:40]!r} is no whole number", key=key)
            return int(text)
        case "flag":
            if text not in ("true", "false"):
                raise InvalidInput(f"{key[:80]!r}: {text[:40]!r} must be true or false", key=key)
            return text == "true"
    return text


def _place(document: Any, key: str) -> tuple[Any, type[BaseModel] | None, str]:
    """Table of an entry, its model, None for the variables of a repeat, and the name of the entry."""
    first, *middle, name = key.split(".") if "." in key else ("", key)
    if not first and name in ("title", "source"):
        return document, _Head, name
    if first in _TABLES and not middle:
        import tomlkit

        if first not in document:
            document[first] = tomlkit.table()
        return document[first], _TABLES[first], name
    if first == "steps" and middle:
        is_of_over = middle[-1] == "over"
        number = ".".join(middle[:-1] if is_of_over else middle)
        steps, at = _step(document, number)
        step = steps[at]
        if is_of_over and isinstance(step.get("over"), Mapping):
            return step["over"], None, name
        return step, entry_named(STEP_CLASSES, str(step.get("kind")), kind="kind of step"), name
    raise InvalidInput(
        f"{key[:80]!r}: no entry of a protocol, such as steps.2.duration or limits.voltage_maximum", key=key
    )


class _Head(BaseModel):
    """Entries at the head of a protocol."""

    title: str
    source: str


def _step(document: Any, number: Any, *, may_follow: bool = False) -> tuple[MutableSequence[Any], int]:
    """List of steps that has a step, and its place there; that behind the last one where a step may follow it."""
    if not isinstance(number, str) or not _NUMBER.fullmatch(number):
        raise InvalidInput(f"{str(number)[:40]!r} is no number of a step, such as 4 or 4.2")
    *outer, last = (int(each) - 1 for each in number.split("."))
    place = document
    for each in outer:
        place = _of_list(place, each, number)[each]
    return _of_list(place, last - may_follow if last else last, number), last


def _of_list(place: Any, at: int, number: str) -> MutableSequence[Any]:
    """List of steps of a table, which has one at a place."""
    steps = place.get("steps") if isinstance(place, Mapping) else None
    if not isinstance(steps, list) or not 0 <= at < len(steps) or not isinstance(steps[at], Mapping):
        raise InvalidInput(f"there is no step {number}")
    return steps


def _insert(document: Any, wanted: Any) -> None:
    """Insert a step of a kind before another."""
    import tomlkit

    kind = str(wanted.get("kind", "")) if isinstance(wanted, Mapping) else ""
    entries = entry_named(STEP_CLASSES, kind, kind="kind of step").example
    steps, at = _step(document, wanted.get("before"), may_follow=True)
    steps.insert(at, _table({"kind": kind, **entries}, tomlkit))


def _table(entries: Mapping[str, Any], tomlkit: Any) -> Any:
    """Table of entries."""
    table = tomlkit.table()
    for name, value in entries.items():
        if name == "steps":
            inner = tomlkit.aot()
            for each in value:
                inner.append(_table(each, tomlkit))
            table.append(name, inner)
        else:
            table.append(name, value)
    table.add(tomlkit.nl())
    return table


def _remove(document: Any, number: Any) -> None:
    """Remove a step."""
    steps, at = _step(document, number)
    if len(steps) == 1:
        raise InvalidInput(f"step {number} is the only one of its list, which needs one")
    del steps[at]


def _move(document: Any, wanted: Any) -> None:
    """Move a step before another of the same list."""
    if not isinstance(wanted, Mapping):
        raise InvalidInput("move: give the step and the one before which it is to stand", key="move")
    steps, at = _step(document, wanted.get("step"))
    others, before = _step(document, wanted.get("before"), may_follow=True)
    if others is not steps:
        raise InvalidInput("move: a step stays in its list", key="move")
    step = steps[at]
    del steps[at]
    steps.insert(before - (before > at), step)


_MOVES: Final = MappingProxyType({"insert": _insert, "remove": _remove, "move": _move})
