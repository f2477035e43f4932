"""Mapping of columns as TOML text, the inverse of `read_mapping`."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import fields
from typing import Any

from sonolube.measurement.recordings.mapping import ChannelSource, RecordingMapping


def mapping_toml(mapping: RecordingMapping) -> str:
    """Mapping as the text of its file, entries of their default value left out."""
    axis: dict[str, Any] = {} if mapping.axis_quantity == "time" else {"quantity": mapping.axis_quantity}
    axis |= {} if mapping.sample_rate is None else {"sample_rate": mapping.sample_rate}
    axis |= {} if mapping.axis is None else _source(mapping.axis)
    tables = {
        "": {name: getattr(mapping, name) for name in ("title", "recognised_by") if getattr(mapping, name)},
        "text": _changed(mapping.text),
        "axis": axis,
        **{f"channels.{name}": _source(source) for name, source in mapping.channels.items()},
        "rows": dict(mapping.rows),
        "selection": _changed(mapping.selection),
    }
    return "\n".join("".join(_lines(name, table)) for name, table in tables.items() if table)


def _lines(name: str, table: Mapping[str, Any]) -> Iterator[str]:
    """Lines of a table."""
    if name:
        yield f"[{name}]\n"
    for key, value in table.items():
        yield f"{key if key.isidentifier() and key.isascii() else _text(key)} = {_text(value)}\n"


def _text(value: Any) -> str:
    """Value in TOML, whose texts and lists are those of JSON but for characters that it wants escaped."""
    text = json.dumps(list(value) if isinstance(value, tuple) else value, ensure_ascii=False)
    return text.replace("\x7f", "\\u007f")


def _source(source: ChannelSource) -> dict[str, Any]:
    """Entries of a channel or an axis."""
    changed = {key: value for key, value in _changed(source).items() if key not in ("column", "other_columns")}
    return {"column": source.labels if source.other_columns else source.column} | changed


def _changed(record: Any) -> dict[str, Any]:
    """Entries of a record that are not at their default."""
    values = ((each, getattr(record, each.name)) for each in fields(record))
    return {each.name: value for each, value in values if value != each.default}
