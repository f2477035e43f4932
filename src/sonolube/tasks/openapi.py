"""Description of all tasks for other programs, OpenAPI 3.1, from their functions and the marks of their arguments."""

import sys
from collections.abc import Callable, Mapping, Sequence
from inspect import Parameter as Argument, cleandoc, signature
from typing import Any, Final, Literal, get_args, get_origin

from sonolube import __version__
from sonolube.tasks.answer import Answer
from sonolube.tasks.parameters import DoorParameter, File, KeyValues, Parameter, RigParameter, item_of, members_of
from sonolube.tasks.table import TASKS, Task
from sonolube.tasks.task import marks_of
from sonolube.text.units import unit_description
from sonolube.vocabulary import quantity

_JSON: Final = {str: "string", bool: "boolean", int: "integer", float: "number"}
_TEXTS: Final = {"type": "array", "items": {"type": "string"}}
_FILE: Final = {
    "description": "Content of a file; the ending of its name tells the format.",
    "type": "object",
    "properties": {
        "name": {"type": "string", "description": "Name with its ending, without a folder."},
        "content": {"type": "string", "contentEncoding": "base64"},
    },
    "required": ["name", "content"],
    "additionalProperties": False,
}
_REFUSED: Final = {
    "description": "The input was refused, in one line that names the argument, its value and the remedy.",
    "content": {"text/plain": {"schema": {"type": "string"}}},
}


def tasks_description() -> dict[str, Any]:
    """Description of all tasks as an OpenAPI 3.1 document: one path a task, its arguments, and its answer.

    Returns
    -------
    dict
        Units stand beside the arguments as ``x-unit``, names of the vocabulary as ``x-quantity``, units of bare numbers
        that a person types as ``x-customary-unit``, and an example on a terminal beside each task as ``x-example``.
    """
    kinds = {kind.__name__: kind for task in TASKS for kind in answer_kinds(task.function)}
    return {
        "openapi": "3.1.0",
        "info": {
            "title": "Tasks of sonolube",
            "version": __version__,
            "description": "Every task of sonolube with its arguments and its answer. Quantities of answers are in SI.",
        },
        "tags": [{"name": panel} for panel in dict.fromkeys(task.panel for task in TASKS)],
        "paths": {task_path(task): {"post": _operation(task)} for task in TASKS},
        "components": {"schemas": {"File": _FILE} | {name: _answer(kind) for name, kind in sorted(kinds.items())}},
    }


def task_path(task: Task) -> str:
    """Path of a task, such as /tasks/measure/friction."""
    return f"/tasks/{task.name.replace(' ', '/')}"


def answer_kinds(function: Callable[..., Answer]) -> list[type[Answer]]:
    """Classes of the answers that a task returns."""
    kind = signature(function).return_annotation
    if isinstance(kind, str):
        known = vars(sys.modules[function.__module__])
        return [known[name.strip()] for name in kind.split("|")]
    return list(members_of(kind))


def _operation(task: Task) -> dict[str, Any]:
    """Task as an operation: its summary, arguments and answers."""
    function = task.function
    text, _, example = task.summary.partition("Example: ")
    summary, _, more = text.strip().partition("\n\n")
    body = _body(function)
    answers = [{"$ref": f"#/components/schemas/{kind.__name__}"} for kind in answer_kinds(function)]
    operation = {
        "operationId": task.name.replace(" ", "_").replace("-", "_"),
        "tags": [task.panel],
        "summary": " ".join(summary.split()),
        "description": " ".join(more.split()),
        "x-example": example.strip(),
        "requestBody": {"required": "required" in body, "content": {"application/json": {"schema": body}}},
        "responses": {
            "200": {
                "description": "Answer, all quantities in SI.",
                "content": {"application/json": {"schema": answers[0] if len(answers) == 1 else {"anyOf": answers}}},
            },
            "422": _REFUSED,
        },
    }
    return {key: value for key, value in operation.items() if value != ""}


def _body(function: Callable[..., Answer]) -> dict[str, Any]:
    """Arguments of a task as the schema of an object, without those that the way in gives."""
    marks, arguments = marks_of(function), signature(function).parameters
    own = {name: mark for name, mark in marks.items() if not isinstance(mark, DoorParameter)}
    required = [name for name in own if _is_required(arguments[name], own[name])]
    return {
        "type": "object",
        "properties": {name: _property(arguments[name], mark) for name, mark in own.items()},
        **({"required": required} if required else {}),
        "additionalProperties": False,
    }


def _is_required(argument: Argument, mark: Parameter | RigParameter) -> bool:
    """Whether an argument has no default."""
    return argument.default is Argument.empty and not (isinstance(mark, RigParameter) and mark.is_optional)


def _property(argument: Argument, mark: Parameter | RigParameter) -> dict[str, Any]:
    """Argument as a schema: its meaning, type, unit, range, choices and default."""
    if isinstance(mark, RigParameter):
        return {"description": "The rig, as a TOML file.", "$ref": "#/components/schemas/File"}
    default = argument.default
    kind = _or_null(_argument(get_args(argument.annotation)[0], mark), is_optional=default is None)
    about = {"description": mark.help if mark.unit is None else f"{mark.help} {_reading(mark.unit)}"}
    if mark.unit is not None:
        about["x-unit"] = mark.unit
    if mark.quantity:
        about["x-quantity"] = mark.quantity
        if customary := quantity(mark.quantity).customary_unit:
            about["x-customary-unit"] = customary
    if default is Argument.empty:
        return about | kind
    return about | kind | {"default": list(default) if isinstance(default, tuple) else default}


def _reading(unit: str) -> str:
    """Sentence on how a quantity is given."""
    if unit == "K":
        return "A number in K, or text: a temperature difference, such as 40K."
    return f"A {f'number in {unit}' if unit else 'number'}, or text: {unit_description(unit)}."


def _argument(kind: Any, mark: Parameter) -> dict[str, Any]:
    """Type of an argument, without its default."""
    if isinstance(mark, KeyValues):
        return {"type": "object", "additionalProperties": {"type": ["string", "number", "array"]}}
    if (item := item_of(kind)) is not None:
        return {"type": "array", "items": _argument(item, mark)}
    if isinstance(mark, File):
        path = {"type": "string", "description": "Path or name on the computer that computes."}
        return {"anyOf": [{"$ref": "#/components/schemas/File"}, path]}
    limits = {"minimum": mark.lowest, "maximum": mark.highest}
    return _typed(members_of(kind), mark) | {key: value for key, value in limits.items() if value is not None}


def _typed(members: Sequence[Any], mark: Parameter) -> dict[str, Any]:
    """Type of a single value, or its choices."""
    if mark.unit is not None:
        return {"type": ["number", "string"]}
    choices = [value for each in members if get_origin(each) is Literal for value in get_args(each)]
    if choices:
        return {"enum": choices}
    kinds = [_JSON[each] for each in members if each in _JSON]
    return {"type": kinds if len(kinds) > 1 else kinds[0]}


def _or_null(schema: Mapping[str, Any], *, is_optional: bool) -> dict[str, Any]:
    """Schema of a value that may be absent."""
    if not is_optional:
        return dict(schema)
    if "anyOf" in schema:
        return {"anyOf": [*schema["anyOf"], {"type": "null"}]}
    if "enum" in schema:
        return {"enum": [*schema["enum"], None]}
    kinds = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
    return dict(schema) | {"type": [*kinds, "null"]}


def _answer(kind: type[Answer]) -> dict[str, Any]:
    """Class of answers as a schema: an object with caveats and assumptions, of look-ups the facts alone."""
    about = {"description": cleandoc(kind.__doc__ or kind.__name__).partition("\n")[0], "type": "object"}
    if kind.is_lookup:
        return about
    notes = {"caveats": _TEXTS, "assumptions": {"type": "object", "additionalProperties": {"type": "string"}}}
    return about | {"properties": notes, "required": list(notes)}
