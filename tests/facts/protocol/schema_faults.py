"""The keywords of JSON schema (draft 2020-12) that the schema of protocols uses, applied to a document."""

from collections.abc import Iterator
from typing import Any

_TYPES: dict[str, Any] = {
    "object": dict,
    "array": list,
    "string": str,
    "integer": int,
    "number": (int, float),
    "boolean": bool,
    "null": type(None),
}


def schema_faults(schema: dict[str, Any], content: Any, root: dict[str, Any], place: str = "") -> Iterator[str]:
    """Places of a document that its schema does not allow."""
    if "$ref" in schema:
        yield from schema_faults(root["$defs"][schema["$ref"].rsplit("/", 1)[1]], content, root, place)
    if "type" in schema and not isinstance(content, _TYPES[schema["type"]]):
        yield f"{place}: no {schema['type']}"
        return
    if schema.get("const", content) != content or content not in schema.get("enum", [content]):
        yield f"{place}: {content!r}"
    for keyword, most in (("anyOf", 10**6), ("oneOf", 1)):
        choices = schema.get(keyword)
        if choices and not 1 <= sum(not list(schema_faults(choice, content, root)) for choice in choices) <= most:
            yield f"{place}: {keyword}"
    yield from _faults_inside(schema, content, root, place)


def _faults_inside(schema: dict[str, Any], content: Any, root: dict[str, Any], place: str) -> Iterator[str]:
    """Faults of the entries of a table or list, and of sizes."""
    if isinstance(content, dict):
        yield from _faults_of_table(schema, content, root, place)
    if isinstance(content, list):
        yield from _out_of_bounds(schema, len(content), "minItems", "maxItems", place)
        for number, item in enumerate(content):
            yield from schema_faults(schema.get("items", {}), item, root, f"{place}[{number}]")
    if isinstance(content, str):
        yield from _out_of_bounds(schema, len(content), "minLength", "maxLength", place)
    if isinstance(content, int):
        yield from _out_of_bounds(schema, content, "minimum", "maximum", place)


def _out_of_bounds(schema: dict[str, Any], number: int, least: str, most: str, place: str) -> Iterator[str]:
    """Number beyond its bounds."""
    if not schema.get(least, number) <= number <= schema.get(most, number):
        yield f"{place}: {number}"


def _faults_of_table(
    schema: dict[str, Any], content: dict[str, Any], root: dict[str, Any], place: str
) -> Iterator[str]:
    """Keys that are missing, unknown or faulty."""
    known = schema.get("properties", {})
    for key in schema.get("required", ()):
        if key not in content:
            yield f"{place}.{key}: missing"
    for key, value in content.items():
        if key in known:
            yield from schema_faults(known[key], value, root, f"{place}.{key}")
        elif schema.get("additionalProperties") is False:
            yield f"{place}.{key}: unknown"
