"""LabVIEW's binary recordings (TDMS), streamed: memory holds one chunk of the file and one block, never the file."""

import struct
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.recordings.mapping import RecordingMapping
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable, one_line, refuse_library_errors

TDMS_FORMAT = "TDMS"
_LEAD_IN = 28
_SHORT = 1 << 16  # bytes that may be asked for in vain
_UNFINISHED = 0xFFFFFFFFFFFFFFFF
_BIG_ENDIAN = 1 << 6


def read_tdms(path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
    """Return the channels of a TDMS file.

    Parameters
    ----------
    path : Path
        Of the file.
    mapping : RecordingMapping or None
        Which channels are wanted; all of them without it.

    Returns
    -------
    Table

    Raises
    ------
    InvalidInput
        Naming the file and the byte, if it is no TDMS file, its headers contradict its size, or it holds no numbers.
    """
    tables = list(tdms_tables(path, mapping=mapping, block_samples=None))
    return tables[0]


def tdms_tables(path: Path, *, mapping: RecordingMapping | None, block_samples: int | None) -> Iterator[RawTable]:
    """Yield the channels of a TDMS file in blocks of rows; the last may be shorter.

    Parameters
    ----------
    path : Path
        Of the file.
    mapping : RecordingMapping or None
        Which channels are wanted; all of them without it.
    block_samples : int or None
        Rows of a block; None for one block with all.

    Yields
    ------
    Table

    Raises
    ------
    InvalidInput
        As `read_tdms`.
    """
    from nptdms import TdmsFile

    with path.open("rb") as stream:
        unfinished = _check_lead_ins(stream, path)
        stream.seek(0)
        with refuse_library_errors(path, format_name=TDMS_FORMAT, offset=stream.tell):
            file = TdmsFile.open(_Bounded(stream))
        channels = _wanted_channels(file, path, mapping)
        columns = {label: _column(label, channel) for label, channel in channels.items()}
        _refuse_unequal(channels, path, unfinished)
        with refuse_library_errors(path, format_name=TDMS_FORMAT, offset=stream.tell):
            rows = 0
            for values in _blocks(file, channels, block_samples):
                filled = tuple(replace(column, values=values[label]) for label, column in columns.items())
                yield RawTable(
                    columns=filled, format=TDMS_FORMAT, begun=_begun(channels), first_row=rows, incomplete=unfinished
                )
                rows += filled[0].values.size


class _Bounded:
    """A file that never promises more bytes than it has, whatever a hostile length asks for."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self._size = stream.seek(0, 2)
        self.seek, self.tell, self.readinto = stream.seek, stream.tell, stream.readinto  # type: ignore[attr-defined]
        stream.seek(0)

    def read(self, size: int = -1) -> bytes:
        if 0 <= size <= _SHORT:
            return self._stream.read(size)
        left = max(self._size - self._stream.tell(), 0)
        return self._stream.read(left if size < 0 else min(size, left))


def _check_lead_ins(stream: BinaryIO, path: Path) -> bool:
    """Follow the segments through the file; return whether the last is unfinished."""
    size, position = stream.seek(0, 2), 0
    while position + _LEAD_IN <= size:
        stream.seek(position)
        lead = stream.read(_LEAD_IN)
        if lead[:4] != b"TDSm":
            raise InvalidInput(f"{path}: byte {position}: a segment must begin with TDSm, got {lead[:4]!r}")
        order = ">" if struct.unpack_from("<I", lead, 4)[0] & _BIG_ENDIAN else "<"
        following, data = struct.unpack_from(order + "QQ", lead, 12)
        if data > size - position - _LEAD_IN:
            raise InvalidInput(
                f"{path}: byte {position}: announces {data} bytes of description, more than the file has"
            )
        if following == _UNFINISHED:
            return True
        if data > following:
            raise InvalidInput(f"{path}: byte {position}: a segment of {following} bytes has {data} of description")
        if following >= 2**62:
            raise InvalidInput(f"{path}: byte {position}: announces a segment of {following} bytes")
        position += _LEAD_IN + following
    if size < _LEAD_IN:
        raise InvalidInput(f"{path}: is too short for a TDMS file ({size} bytes)")
    return position != size


def _wanted_channels(file: Any, path: Path, mapping: RecordingMapping | None) -> dict[str, Any]:
    every = {
        one_line(f"{group.name}/{channel.name}"): channel for group in file.groups() for channel in group.channels()
    }
    short = [channel.name for channel in every.values()]
    labelled = {(one_line(c.name) if short.count(c.name) == 1 else label): c for label, c in every.items()}
    numeric = {label: c for label, c in labelled.items() if _is_numeric(c) and len(c) > 0}
    if mapping is not None and mapping.channels:
        wanted = {source.column for source in mapping.channels.values()}
        wanted |= {mapping.axis.column} if mapping.axis else set()
        numeric = {label: c for label, c in numeric.items() if label in wanted}
    if not numeric:
        raise InvalidInput(f"{path}: holds no channel of numbers" + (" that the mapping names" if mapping else ""))
    return numeric


def _is_numeric(channel: Any) -> bool:
    kind = getattr(channel.dtype, "kind", "O")
    return kind in "fiub"


def _column(label: str, channel: Any) -> RawColumn:
    properties = channel.properties
    unit = properties.get("unit_string") or properties.get("NI_UnitDescription")
    interval, start = properties.get("wf_increment"), properties.get("wf_start_offset", 0.0)
    return RawColumn(
        label=label,
        values=np.empty(0),
        unit=str(unit) if unit else None,
        start=float(start) if isinstance(start, (int, float)) else 0.0,
        interval=float(interval) if isinstance(interval, (int, float)) and interval else None,
    )


def _refuse_unequal(channels: dict[str, Any], path: Path, unfinished: bool) -> None:
    lengths = {label: len(channel) for label, channel in channels.items()}
    if len(set(lengths.values())) > 1 and not unfinished:
        text = ", ".join(f"{label} {size}" for label, size in lengths.items())
        raise InvalidInput(f"{path}: channels have different numbers of samples ({text[:200]}); choose with a mapping")


def _blocks(file: Any, channels: dict[str, Any], block_samples: int | None) -> Iterator[dict[str, Floats]]:
    held: dict[str, list[Floats]] = {label: [] for label in channels}
    rows = dict.fromkeys(channels, 0)
    for chunk in file.data_chunks():
        for label, channel in channels.items():
            part = np.asarray(chunk[channel.group_name][channel.name][:])
            if part.size:
                held[label].append(part.astype(np.float64, copy=False))
                rows[label] += part.size
        while block_samples is not None and min(rows.values()) >= block_samples:
            yield _take(held, block_samples)
            rows = {label: count - block_samples for label, count in rows.items()}
    rest = min(rows.values())
    if rest or block_samples is None:
        yield _take(held, rest)


def _take(held: dict[str, list[Floats]], rows: int) -> dict[str, Floats]:
    taken = {}
    for label, parts in held.items():
        joined = parts[0] if len(parts) == 1 else np.concatenate(parts or [np.empty(0)])
        taken[label] = joined[:rows]
        held[label] = [joined[rows:]] if joined.size > rows else []
    return taken


def _begun(channels: dict[str, Any]) -> str:
    times = [
        channel.properties["wf_start_time"] for channel in channels.values() if "wf_start_time" in channel.properties
    ]
    return str(times[0]) if times else ""
