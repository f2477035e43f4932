"""Description of the tasks: every task and argument is there, its form is that of OpenAPI, its units are known."""

import json
import re
from collections.abc import Iterator
from inspect import signature
from typing import Any

import pytest
from pytest import approx

from sonolube.tasks.openapi import task_path, tasks_description
from sonolube.tasks.parameters import DoorParameter, Parameter, RigParameter
from sonolube.tasks.table import TASKS, Task, task_named
from sonolube.tasks.task import marks_of
from sonolube.text.units import to_si
from sonolube.vocabulary import quantity

KINDS = {"null", "boolean", "object", "array", "number", "string", "integer"}  # of JSON schema, draft 2020-12
KEYWORDS = {  # of JSON schema that are used, each with the form of its value
    "$ref": str,
    "description": str,
    "type": (str, list),
    "enum": list,
    "anyOf": list,
    "items": dict,
    "properties": dict,
    "required": list,
    "additionalProperties": (bool, dict),
    "contentEncoding": str,
    "minimum": (int, float),
    "maximum": (int, float),
    "default": object,
    "x-unit": str,
    "x-quantity": str,
    "x-customary-unit": str,
}
OPERATION = {"operationId", "tags", "summary", "description", "requestBody", "responses", "x-example"}


@pytest.fixture(scope="module")
def document() -> dict[str, Any]:
    """The description as another program reads it."""
    content: dict[str, Any] = json.loads(json.dumps(tasks_description(), allow_nan=False))
    return content


def operations(document: dict[str, Any]) -> dict[str, dict[str, Any]]:
    return {path: entry["post"] for path, entry in document["paths"].items()}


def body(operation: dict[str, Any]) -> dict[str, Any]:
    schema: dict[str, Any] = operation["requestBody"]["content"]["application/json"]["schema"]
    return schema


def faults(schema: dict[str, Any], document: dict[str, Any], place: str) -> Iterator[str]:
    """Places at which a schema is none, or leads nowhere."""
    for keyword, value in schema.items():
        if keyword not in KEYWORDS or not isinstance(value, KEYWORDS[keyword]):  # type: ignore[arg-type]
            yield f"{place}.{keyword}"
    kinds = schema.get("type", [])
    if not {kinds} <= KINDS if isinstance(kinds, str) else not set(kinds) <= KINDS:
        yield f"{place}.type"
    if (
        "$ref" in schema
        and schema["$ref"].removeprefix("#/components/schemas/") not in document["components"]["schemas"]
    ):
        yield f"{place}.$ref"
    if not set(schema.get("required", ())) <= set(schema.get("properties", {})):
        yield f"{place}.required"
    for name, inner in schema.get("properties", {}).items():
        yield from faults(inner, document, f"{place}.{name}")
    for keyword in ("items", "additionalProperties"):
        if isinstance(schema.get(keyword), dict):
            yield from faults(schema[keyword], document, f"{place}.{keyword}")
    for number, inner in enumerate(schema.get("anyOf", ())):
        yield from faults(inner, document, f"{place}.anyOf[{number}]")


def test_every_task_has_its_path_and_nothing_else_has_one(document: dict[str, Any]) -> None:
    assert list(document["paths"]) == [task_path(task) for task in TASKS]
    assert "/tasks/measure/friction" in document["paths"]
    assert all(set(entry) == {"post"} for entry in document["paths"].values())


def test_the_document_has_the_form_of_openapi(document: dict[str, Any]) -> None:
    assert set(document) == {"openapi", "info", "tags", "paths", "components"}
    assert document["openapi"].startswith("3.1.")
    assert {"title", "version"} <= set(document["info"])
    names = [operation["operationId"] for operation in operations(document).values()]
    assert len(set(names)) == len(names)
    assert all(re.fullmatch(r"[a-z]\w*", name) for name in names)
    tags = {tag["name"] for tag in document["tags"]}
    for operation in operations(document).values():
        assert set(operation) <= OPERATION
        assert {"summary", "requestBody", "responses", "x-example"} <= set(operation)
        assert set(operation["tags"]) <= tags
        assert all(re.fullmatch(r"[1-5]\d\d", code) for code in operation["responses"])
        assert all(response["description"] for response in operation["responses"].values())


def test_every_schema_of_the_document_is_one(document: dict[str, Any]) -> None:
    found = [
        fault for name, schema in document["components"]["schemas"].items() for fault in faults(schema, document, name)
    ]
    for path, operation in operations(document).items():
        contents = [operation["requestBody"], *operation["responses"].values()]
        schemas = [media["schema"] for each in contents for media in each["content"].values()]
        found += [fault for schema in schemas for fault in faults(schema, document, path)]
    assert found == []


@pytest.mark.parametrize("task", TASKS, ids=lambda task: task.name)
def test_every_argument_that_a_user_gives_is_described_with_its_meaning_and_default(
    task: Task, document: dict[str, Any]
) -> None:
    schema = body(operations(document)[task_path(task)])
    arguments = signature(task.function).parameters
    marks = {name: mark for name, mark in marks_of(task.function).items() if not isinstance(mark, DoorParameter)}
    assert set(schema["properties"]) == set(marks)
    for name, entry in schema["properties"].items():
        mark, default = marks[name], arguments[name].default
        if isinstance(mark, RigParameter):
            assert (name in schema.get("required", ())) == (not mark.is_optional)
            continue
        assert entry["description"].startswith(mark.help)
        assert (name in schema.get("required", ())) == (default is arguments[name].empty)
        assert entry.get("default") == (list(default) if default == () else entry.get("default") and default)
        assert (entry.get("minimum"), entry.get("maximum")) == (mark.lowest, mark.highest) or "items" in entry


@pytest.mark.parametrize("task", TASKS, ids=lambda task: task.name)
def test_units_of_arguments_are_those_of_the_vocabulary(task: Task, document: dict[str, Any]) -> None:
    properties = body(operations(document)[task_path(task)])["properties"]
    for name, mark in marks_of(task.function).items():
        if isinstance(mark, Parameter):
            assert properties[name].get("x-unit") == mark.unit, name
        if isinstance(mark, Parameter) and mark.quantity:
            assert quantity(mark.quantity).unit == mark.unit, name
            assert properties[name]["x-quantity"] == mark.quantity


def test_arguments_of_each_kind_have_its_form(document: dict[str, Any]) -> None:
    friction = body(operations(document)["/tasks/measure/friction"])
    assert friction["required"] == ["files"]
    assert friction["properties"]["files"]["items"]["anyOf"][0] == {"$ref": "#/components/schemas/File"}
    assert friction["properties"]["sliding_speed"] == {
        "description": "For the distance to the steady state. A number in m/s, or text: a speed, such as 20.3mm/s.",
        "x-unit": "m/s",
        "x-quantity": "sliding_speed",
        "x-customary-unit": "m/s",
        "type": ["number", "string", "null"],
        "default": None,
    }
    assert friction["properties"]["join"]["type"] == "boolean"
    schema = body(operations(document)["/tasks/schema"])["properties"]["kind"]
    assert (schema["enum"], schema["default"]) == (["rig", "protocol", "devices", "evidence", "tasks"], "rig")
    sweep = body(operations(document)["/tasks/sweep"])["properties"]
    assert sweep["over"]["type"] == ["object", "null"]
    assert sweep["workers"] == {
        "description": "Threads, or processes of a local cluster.",
        "type": "integer",
        "minimum": 1,
        "default": 2,
    }
    assert None in sweep["of"]["enum"]


def test_answers_have_caveats_and_assumptions_but_those_of_look_ups(document: dict[str, Any]) -> None:
    schemas = document["components"]["schemas"]
    assert set(schemas["RigRecord"]["properties"]) == {"caveats", "assumptions"}
    assert "properties" not in schemas["Listing"]
    response = operations(document)["/tasks/sweep"]["responses"]["200"]["content"]["application/json"]["schema"]
    assert len(response["anyOf"]) == 2


def test_examples_of_python_are_left_out(document: dict[str, Any]) -> None:
    assert ">>>" in (task_named("friction").function.__doc__ or "")
    assert ">>>" not in json.dumps(document)


@pytest.mark.parametrize(
    ("argument", "si"),
    [("amplitude", 2e-6), ("frequency", 2e3), ("track_diameter", 2e-3), ("stiffness", 2e6), ("load", 2)],
)
def test_a_bare_number_of_a_new_rig_has_a_customary_unit(document: dict[str, Any], argument: str, si: float) -> None:
    about = body(operations(document)["/tasks/new"])["properties"][argument]
    assert to_si(f"2 {about['x-customary-unit']}", unit=about["x-unit"], name=argument) == approx(si)
