"""Uploaded files as a page shows them: what they are, their columns, and recordings as the extremes of their samples.

What is read once of a file is kept beside it in the folder of uploads, and goes with it.
"""

import json
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, replace
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from sonolube.browser.requests import Places
from sonolube.browser.uploads import companion, named_uploads, uploaded
from sonolube.errors import InvalidInput, SonolubeError
from sonolube.measurement.column_statements import FileColumn, mapping_of_statements, stated_file_columns
from sonolube.measurement.export_columns import export_columns
from sonolube.measurement.file_kind import file_kind
from sonolube.measurement.recordings.mapping import RecordingMapping, TextLayout, mapping_toml, read_mapping
from sonolube.measurement.recordings.pyramid import extremes, extremes_of_range
from sonolube.measurement.recordings.reader import read_recording, recognised_mapping, recording_format
from sonolube.measurement.run_table import run_text
from sonolube.storage.files import unfinished_file, write_atomically
from sonolube.tasks.files import NamedBytes, file_path, with_names_only
from sonolube.text.units import to_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    import xarray as xr

_MAX_POINTS: Final = 4000  # of a channel in one view
_WHOLE: Final = 1 << 20  # bytes of a text up to which all its cells are looked at
_HEAD: Final = 1 << 19  # bytes of a longer one that are
_TEXTS: Final = ("delimited text",)


def file_view(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """What an uploaded file is, its columns, and of a recording its length and channels.

    A request has `file`, and optionally `mapping` (text of a mapping), `columns` (statements by label), `rows`
    (required cells by label) and `sample_rate`, of which a new mapping is made.
    """
    name, path = uploaded(payload.get("file"), places)
    mapping, is_new = str(payload.get("mapping") or ""), "columns" in payload
    place = companion(path, f"{_key(mapping)}.json")
    if place.is_file() and not is_new:
        kept: dict[str, Any] = json.loads(place.read_text(encoding="utf-8"))
        return kept
    with named_uploads():
        given = file_path(NamedBytes(name, path.read_bytes()))
        found = _mapping(mapping)
        if is_new:
            return {"mapping": mapping_toml(_stated(payload, found or _layout(given)))}
        view = _described(given, found)
        if view["kind"] == "recording":
            view |= _read(given, found, path, mapping)
    text = json.dumps(view)
    write_atomically(place, text)
    found_view: dict[str, Any] = json.loads(text)
    return found_view


def _described(path: Path, mapping: RecordingMapping | None) -> dict[str, Any]:
    """Kind of a file, and its columns where it is text."""
    kind = file_kind(path)
    columns: list[FileColumn] = []
    if kind in ("recording", "runs"):
        known = mapping or recognised_mapping(path)
        with suppress(SonolubeError):  # the reader of recordings says what is wrong
            columns = _columns(path, known)
    return {
        "kind": kind,
        "bytes": path.stat().st_size,
        "columns": [asdict(column) for column in columns],
        "quantities": [[each.name, each.unit, each.meaning] for each in quantities().values()] if columns else [],
        "rows": dict(mapping.rows) if mapping else {},
        "reason": "",
    }


def _columns(path: Path, mapping: RecordingMapping | None) -> list[FileColumn]:
    """Columns of a file: of a text by its first part, else of what its reader finds."""
    has_own_layout = mapping is not None and mapping.text != TextLayout()
    if recording_format(path).name not in _TEXTS or (file_kind(path) == "recording" and not has_own_layout):
        return list(export_columns(path, mapping=mapping).columns)
    table, _ = run_text(_head(path), mapping)
    units = [*table.units, *[""] * (len(table.labels) - len(table.units))]
    cells = [[row[place] for _, row in table.rows if place < len(row)] for place in range(len(table.labels))]
    return stated_file_columns(table.labels, units, cells, mapping)


def _head(path: Path) -> Path:
    """The file, or its first part as a file where it is long."""
    if path.stat().st_size <= _WHOLE:
        return path
    with path.open("rb") as stream:
        content = stream.read(_HEAD)
    return file_path(NamedBytes(path.name, content[: content.rfind(b"\n") + 1] or content))


def _layout(path: Path) -> RecordingMapping | None:
    """Mapping of the instrument that wrote a file, else one with the lines above its headings."""
    known = recognised_mapping(path)
    if known is not None or file_kind(path) == "recording":
        return known
    table, _ = run_text(_head(path))
    empty = RecordingMapping(channels={})
    return replace(empty, text=replace(empty.text, lines_to_skip=table.line - 1))


def _stated(payload: Mapping[str, Any], mapping: RecordingMapping | None) -> RecordingMapping:
    """Mapping by the statements of a request."""
    columns, rows, rate = payload.get("columns"), payload.get("rows") or {}, payload.get("sample_rate")
    for name, each in (("columns", columns), ("rows", rows)):
        if not isinstance(each, Mapping) or not all(isinstance(text, str) for text in each.values()):
            raise InvalidInput(f"{name}: give texts by label", key=name)
    hertz = to_si(str(rate), unit="Hz", name="sample_rate") if rate else None
    assert isinstance(columns, Mapping)
    return mapping_of_statements(columns, mapping=mapping, rows=rows, sample_rate=hertz)


def _mapping(text: str) -> RecordingMapping | None:
    """Mapping of a text; None for an empty one."""
    return read_mapping(file_path(NamedBytes("mapping.toml", text.encode()))) if text else None


def _key(mapping: str) -> str:
    """Part of the names of files that are kept of an upload, one for each mapping."""
    return sha256(mapping.encode()).hexdigest()[:12]


def _read(given: Path, mapping: RecordingMapping | None, upload: Path, text: str) -> dict[str, Any]:
    """Summary of a recording, whose samples and their extremes are kept; the reason where it cannot be read."""
    try:
        recording = read_recording(given, mapping=mapping)
    except SonolubeError as failure:
        return {"reason": with_names_only(str(failure))}
    axis = str(next(iter(recording.sizes)))
    names = [str(name) for name in recording.data_vars if recording[name].dtype.kind == "f"]
    samples = np.stack([recording[name].to_numpy() for name in (axis, *names)])
    _keep(samples, companion(upload, f"{_key(text)}.samples.npy"))
    _keep(np.stack([extremes(each) for each in samples[1:]]), companion(upload, f"{_key(text)}.extremes.npy"))
    return _summary(recording, axis, names, samples)


def _summary(recording: "xr.Dataset", axis: str, names: list[str], samples: np.ndarray) -> dict[str, Any]:
    """Axis, length, channels and caveats of a recording."""
    about = recording.attrs
    return {
        "axis": {"name": axis, **_words(recording, axis)},
        "channels": [{"name": name, **_words(recording, name)} for name in names],
        "begin": float(samples[0, 0]),
        "end": float(samples[0, -1]),
        "samples": int(samples.shape[1]),
        "sample_rate": about.get("sample_rate"),
        "format": str(about.get("file_format", "")),
        "instrument": str(about.get("mapping", "")),
        "caveats": str(about.get("caveats", "")).splitlines(),
    }


def _words(recording: "xr.Dataset", name: str) -> dict[str, str]:
    """Label and unit of a variable."""
    unit = str(recording[name].attrs.get("units", ""))
    return {"label": str(recording[name].attrs.get("long_name", name)), "unit": "" if unit == "1" else unit}


def _keep(values: np.ndarray, path: Path) -> None:
    """Write an array as a whole file."""
    with unfinished_file(path) as file:
        np.lib.format.write_array(file, np.ascontiguousarray(values), allow_pickle=False)
        file.complete()


def recording_view(payload: Mapping[str, Any], places: Places) -> dict[str, Any]:
    """Part of a recording as at most 4,000 points a channel, smallest and largest value one after the other.

    A request has `file`, `mapping`, `from` and `to` along the axis, in SI, and `points` a channel.
    """
    _, upload = uploaded(payload.get("file"), places)
    key = _key(str(payload.get("mapping") or ""))
    try:
        samples = np.load(companion(upload, f"{key}.samples.npy"), mmap_mode="r", allow_pickle=False)
        blocks = np.load(companion(upload, f"{key}.extremes.npy"), mmap_mode="r", allow_pickle=False)
    except OSError:
        raise InvalidInput("file: it has not been read yet, or was dropped; choose it again", key="file") from None
    axis = samples[0]
    begin, end = (_number(payload, name, usual) for name, usual in (("from", axis[0]), ("to", axis[-1])))
    points = int(min(max(_number(payload, "points", _MAX_POINTS), 8), _MAX_POINTS))
    first = max(int(np.searchsorted(axis, begin)) - 1, 0)  # with a neighbour, so that the line goes on
    last = min(int(np.searchsorted(axis, end, side="right")) + 1, axis.size)
    if last - first <= points:
        places_shown = np.arange(first, last)
        values = samples[1:, first:last]
    else:
        places_shown, values = _reduced(samples[1:], blocks, first, last, points // 2)
    return {
        "x": axis[places_shown].tolist(),
        "channels": [[None if each != each else each for each in row] for row in values.tolist()],
        "samples": last - first,
        "is_reduced": last - first > points,
    }


def _reduced(
    samples: np.ndarray, blocks: np.ndarray, first: int, last: int, bins: int
) -> tuple[np.ndarray, np.ndarray]:
    """Places and values of the extremes of each channel."""
    rows = []
    for values, own in zip(samples, blocks, strict=True):
        edges, ends = extremes_of_range(values, own, first=first, last=last, bins=bins)
        rows.append(ends.T.ravel())
    shown = np.stack([edges[:-1], edges[1:] - 1], axis=1).ravel()
    return shown, np.stack(rows)


def _number(payload: Mapping[str, Any], name: str, usual: float) -> float:
    """Number of a request; the usual one where it has none."""
    value = payload.get(name)
    if value is None:
        return float(usual)
    if isinstance(value, bool) or not isinstance(value, int | float) or value != value:
        raise InvalidInput(f"{name}: must be a number, got {value!r}"[:120], key=name)
    return float(value)
