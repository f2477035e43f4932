"""Requests of pages answered in a worker: a task with its arguments as JSON gives its answer as JSON."""

import base64
import binascii
import os
import tomllib
from collections.abc import Mapping
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any, Final

from sonolube.browser.requests import Places
from sonolube.charts import chart_object, chart_tables
from sonolube.errors import InvalidInput, SeveralFaults, UnknownName
from sonolube.example_files import example_files
from sonolube.tasks.answer import Answer, Block, Rows, Table, Verbatim
from sonolube.tasks.files import NamedBytes, file_path, private_files
from sonolube.tasks.parameters import (
    DeviceParameter,
    DoorParameter,
    File,
    KeyValues,
    Mark,
    OwnFolder,
    Parameter,
    RigParameter,
)
from sonolube.tasks.table import TASKS, Task
from sonolube.tasks.task import marks_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from sonolube.rig import Rig

_MODES: Final = "structure.file"  # the entry of a rig that names another file
_PART: Final = "PART"  # an argument that is the name of a part, or a STEP file


def offered_tasks() -> tuple[Task, ...]:
    """Tasks that a page may call: those that open no device and write no folder of this computer."""
    return tuple(task for task in TASKS if _is_offered(task))


def offered_task(name: str) -> Task:
    """Task of a name, of those that a page may call; no other is imported."""
    found = next((task for task in TASKS if task.name == name), None)
    if found is None or not _is_offered(found):
        raise UnknownName.among([task.name for task in offered_tasks()], kind="task", name=name)
    return found


def answered(task: Task, arguments: Mapping[str, Any], places: Places, *, has_tables: bool = True) -> dict[str, Any]:
    """Answer of a task as an object for JSON.

    The answer's JSON, blocks of text, charts, caveats, assumptions and reasons of refused inputs.
    """
    with given_arguments(task, arguments, places) as given:
        return answer_object(called(task, given), has_tables=has_tables)


def called(task: Task, given: Mapping[str, Any]) -> Answer:
    """Answer of a task; refusals of rigs from texts have no folder."""
    by_place = [name for name in positional(task) if name in given]
    named = {name: value for name, value in given.items() if name not in by_place}
    return task.function(*(given[name] for name in by_place), **named)


def answer_object(answer: Answer, *, has_tables: bool = True) -> dict[str, Any]:
    """Answer as an object for JSON, with its text and charts beside the numbers, and the tables of the charts."""
    drawings = answer.figures()
    return {
        "answer": answer.json_object(),
        "blocks": [_block_object(block) for block in answer.blocks()],
        "leading_caveats": list(answer.leading_caveats()),
        "caveats": list(answer.caveats()),
        "assumptions": dict(answer.assumptions()),
        "refusals": dict(answer.refusals()),
        "charts": [
            {
                "name": name,
                "caption": drawing.caption,
                **({} if drawing.chart is None else _charted(drawing.chart(), has_tables)),
            }
            for name, drawing in drawings.items()
        ],
    }


def refusal_object(failure: Exception) -> dict[str, Any]:
    """Refusal as an object for JSON: each fault with the key that it is of, where it has one."""
    if isinstance(failure, SeveralFaults):
        keys = [*failure.keys, *[""] * len(failure.faults)]
        faults = [{"key": key, "text": text} for key, text in zip(keys, failure.faults, strict=False)]
        return {"text": failure.heading, "faults": faults}
    return {"text": str(failure), "faults": [{"key": getattr(failure, "key", ""), "text": str(failure)}]}


@contextmanager
def given_arguments(task: Task, arguments: Mapping[str, Any], places: Places) -> "Iterator[dict[str, Any]]":
    """Arguments of a task from those of a request, with files that last as long as the `with` block."""
    marks = _given_marks(task)
    unknown = next((name for name in arguments if name not in marks), None)
    if unknown is not None:
        raise InvalidInput(f"{unknown}: {task.name} has no such argument; it has {', '.join(marks)}", key=unknown)
    missing = next((name for name in _required(task) if name not in arguments and name in marks), None)
    if missing is not None:
        raise InvalidInput(f"{missing}: {task.name} needs it", key=missing)
    with ExitStack() as stack:
        yield {name: _given(name, value, marks[name], places, stack) for name, value in arguments.items()}


@cache
def _given_marks(task: Task) -> "Mapping[str, Mark]":
    """Marks of the arguments that a request may give."""
    return {name: mark for name, mark in marks_of(task.function).items() if not isinstance(mark, DoorParameter)}


def given_rig(source: Any, places: Places, stack: ExitStack) -> "Rig":
    """Rig of a request: an example or the text of a file, with entries replaced."""
    from sonolube.rig import read_rig

    path, changes = requested_file(source, places, stack)
    with names_only(path):
        return read_rig(path, changes=changes)


def requested_file(source: Any, places: Places, stack: ExitStack) -> tuple[Path, list[str]]:
    """Path of the file of a rig of a request, and the entries to replace in it."""
    if not isinstance(source, Mapping):
        raise InvalidInput("rig: give an object with its name or text, and changes", key="rig")
    changes = source.get("changes") or {}
    if not isinstance(changes, Mapping) or not all(isinstance(value, str) for value in changes.values()):
        raise InvalidInput("rig.changes: give texts by dotted key, such as drive.frequency: 22 kHz", key="rig")
    path = rig_path(source, places, stack)
    _refuse_other_files(source, changes)
    return path, [f"{key}={value}" for key, value in changes.items()]


def _refuse_other_files(source: Mapping[str, Any], changes: Mapping[str, str]) -> None:
    """Raise if a rig names a file beside it, which would be one of this computer."""
    is_named = any(key.strip() == _MODES for key in changes)
    if source.get("text"):
        with suppress(tomllib.TOMLDecodeError, RecursionError):  # of which the reader of rigs says what is wrong
            structure = tomllib.loads(str(source["text"])).get("structure")
            is_named = is_named or (isinstance(structure, Mapping) and "file" in structure)
    if is_named:
        raise InvalidInput(
            f"{_MODES}: a page reads no file of this computer; give the modes as lists in the rig file", key=_MODES
        )


@contextmanager
def names_only(path: Path) -> "Iterator[None]":
    """Say the name of a file in place of its path in refusals within, and no folder beside it."""

    def named(text: str) -> str:
        return text.replace(f"{path.parent}{os.sep}", "")

    try:
        yield
    except SeveralFaults as failure:
        faults = [named(each) for each in failure.faults]
        raise SeveralFaults(faults, rest=failure.rest, where=path.name, keys=failure.keys) from None
    except InvalidInput as failure:
        raise InvalidInput(named(str(failure)), key=failure.key) from None


def rig_path(source: Mapping[str, Any], places: Places, stack: ExitStack) -> Path:
    """Path of the file of a rig: of the one that the workbench was opened with, of an example, or of a text."""
    text, name = source.get("text"), source.get("name")
    if isinstance(text, str) and text:
        stack.enter_context(private_files())
        return file_path(
            NamedBytes(f"{_plain_name(name) if isinstance(name, str) else 'rig'}.toml", text.encode("utf-8", "replace"))
        )
    if not isinstance(name, str):
        raise InvalidInput("rig: give the name of an example, or the text of a file", key="rig")
    if name in places.rigs:
        return Path(places.rigs[name])
    examples = example_files()
    if name not in examples or not examples[name].is_rig:
        raise InvalidInput(f"there is no rig {name[:60]!r} here; choose one of the list, or open its file", key="rig")
    return examples[name].source


def _given(name: str, value: Any, mark: Any, places: Places, stack: ExitStack) -> Any:
    """One argument of a task."""
    if isinstance(mark, RigParameter):
        return None if value is None else given_rig(value, places, stack)
    assert isinstance(mark, Parameter)
    if isinstance(mark, File):
        if mark.kind == _PART and isinstance(value, str) and value.isidentifier():
            return value  # a part by its name, which no file has that would be read as one
        several = isinstance(value, list)
        files = [_file(name, each, places) for each in (value if several else [value])]
        return files if several else files[0]
    for text in _texts(value):
        if os.sep in text and Path(text).exists():
            raise InvalidInput(f"{name}: {PurePath(text).name!r} is a file of this computer; upload it", key=name)
        if isinstance(mark, KeyValues) and ".toml" in mark.kind:
            raise InvalidInput(f"{name}: is not offered in the browser; use the terminal or Python", key=name)
    return value


def _file(name: str, value: Any, places: Places) -> Any:
    """File of a request: an upload, or a name with its content."""
    if value is None:
        return None
    if not isinstance(value, Mapping) or not isinstance(value.get("name"), str):
        raise InvalidInput(f"{name}: give an object with the name of an upload, or a name and its content", key=name)
    if "content" in value:
        plain = _plain_name(value["name"])
        try:
            return NamedBytes(plain, base64.b64decode(value["content"], validate=True))
        except (binascii.Error, TypeError, ValueError):
            raise InvalidInput(f"{name}: the content of {value['name']!r} is not base64", key=name) from None
    upload = value.get("upload")
    path = Path(places.uploads, _plain_name(str(upload))) if places.uploads and upload else None
    if path is None or not path.is_file():
        raise InvalidInput(f"{name}: {value['name']!r} is no longer here; drop the file again", key=name)
    return NamedBytes(_plain_name(value["name"]), path.read_bytes())


def _plain_name(name: str) -> str:
    """Name of a file without a folder."""
    plain = PurePath(name.replace("\\", "/")).name
    if not plain or plain.startswith("."):
        raise InvalidInput(f"{name[:80]!r} is no name of a file")
    return plain


def _texts(value: Any) -> "Iterator[str]":
    """Texts within a value of JSON."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping):
        for key, each in value.items():
            yield str(key)
            yield from _texts(each)
    elif isinstance(value, list):
        for each in value:
            yield from _texts(each)


@cache
def positional(task: Task) -> list[str]:
    """Names of the arguments that are given by place."""
    from inspect import Parameter as Argument, signature

    arguments = signature(task.function).parameters.values()
    return [each.name for each in arguments if each.kind is Argument.POSITIONAL_OR_KEYWORD]


@cache
def _required(task: Task) -> list[str]:
    """Names of the arguments without a default."""
    from inspect import signature

    arguments = signature(task.function).parameters.values()
    optional = {name for name, mark in marks_of(task.function).items() if getattr(mark, "is_optional", False)}
    return [each.name for each in arguments if each.default is each.empty and each.name not in optional]


@cache
def _is_offered(task: Task) -> bool:
    """Whether a task opens no device, and writes no folder that is named as an argument."""
    return not any(isinstance(mark, OwnFolder | DeviceParameter) for mark in marks_of(task.function).values())


def _charted(chart: Any, has_tables: bool) -> dict[str, Any]:
    """Chart and, where they are asked for, its tables."""
    return {"chart": chart_object(chart), **({"tables": chart_tables(chart)} if has_tables else {})}


def _block_object(block: Block) -> dict[str, Any]:
    """Block of text as an object."""
    if isinstance(block, Rows):
        return {"kind": "rows", "rows": [list(row) for row in block.rows]}
    if isinstance(block, Table):
        return {"kind": "table", "heads": list(block.heads), "rows": [list(row) for row in block.rows]}
    if isinstance(block, Verbatim):
        return {"kind": "verbatim", "text": block.text}
    return {"kind": "text", "text": block.strip()}


def task_answer(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Answer of a task."""
    task, arguments = offered_task(str(payload.get("task", ""))), payload.get("arguments") or {}
    return answered(task, arguments, places, has_tables=payload.get("tables", True))


def description(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """OpenAPI description of the tasks."""
    from sonolube.tasks.openapi import tasks_description

    del payload, places
    offered = {f"/tasks/{task.name.replace(' ', '/')}" for task in offered_tasks()}
    content = tasks_description()
    paths = {f"/api{path}": each for path, each in content["paths"].items() if path in offered}
    return content | {"paths": paths}
