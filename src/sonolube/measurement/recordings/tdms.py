"""LabVIEW's binary recordings (TDMS), streamed by segment chunks so that memory holds one chunk and one block."""

import logging
import re
import struct
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from math import inf
from pathlib import Path
from typing import Any, BinaryIO, ClassVar, final

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.measurement.measured_files import ClippedReader, most_unpacked_bytes, require_channels
from sonolube.measurement.recordings.channels_and_parts import ChannelEntry, chosen_channels, require_common_length
from sonolube.measurement.recordings.mapping import RecordingMapping, Selection
from sonolube.measurement.recordings.raw_table import RawColumn, RawTable, one_line, refuse_library_errors

TDMS_FORMAT = "TDMS"
"""Name of the format in results."""

MAX_SEGMENTS = 100_000
"""Segments of a file, whose headers npTDMS reads at about 20,000 a second."""

_SIGNATURE = b"TDSm"
_LEAD_IN = 28  # bytes before the metadata of a segment
_CHUNK_MESSAGE = re.compile(r"[Dd]ata size (\d+) is not a multiple of the chunk size (\d+)")  # of npTDMS
_UNFINISHED = 0xFFFFFFFFFFFFFFFF  # length of a segment that was not closed
_BIG_ENDIAN = 1 << 6


@final
class Tdms:
    """LabVIEW's binary recordings (TDMS), whole or in blocks of rows.

    Notes
    -----
    npTDMS reads the segments; lead-ins are validated against the size of the file before it does, and no read requests
    more bytes than the file holds.

    References
    ----------
    .. [1] NI, TDMS File Format Internal Structure.
    """

    name: ClassVar[str] = TDMS_FORMAT
    suffixes: ClassVar[tuple[str, ...]] = (".tdms",)

    def recognises(self, head: bytes, path: Path) -> bool:
        """Whether the file begins with the tag of a segment."""
        return head.startswith(_SIGNATURE)

    def read(self, path: Path, *, mapping: RecordingMapping | None = None) -> RawTable:
        """Channels of a TDMS file."""
        (table,) = self._tables(path, mapping, None)
        return table

    def read_blocks(self, path: Path, *, mapping: RecordingMapping | None, block_samples: int) -> Iterator[RawTable]:
        """Yield the channels of a TDMS file in blocks of rows; the last may be shorter."""
        return self._tables(path, mapping, block_samples)

    def _tables(self, path: Path, mapping: RecordingMapping | None, block_samples: int | None) -> Iterator[RawTable]:
        """Yield blocks of rows, or one block with all rows where `block_samples` is None."""
        from nptdms import TdmsFile

        with ClippedReader(path) as stream:
            incomplete = _check_lead_ins(stream, path)
            stream.seek(0)
            with refuse_library_errors(path, format_name=self.name, offset=stream.tell), _collected_log() as log:
                file = TdmsFile.open(stream)
            caveats = _checked(log, path, incomplete=incomplete)
            channels = _selected_channels(file, path, mapping)
            first = min(map(_begun, channels.values()))
            columns = {label: _empty_column(label, channel, first) for label, channel in channels.items()}
            if not incomplete:
                require_common_length(
                    [ChannelEntry(label, channel.group_name, len(channel)) for label, channel in channels.items()], path
                )
            blocks = _blocks(file, channels, block_samples)
            rows = 0
            while True:
                with refuse_library_errors(path, format_name=self.name, offset=stream.tell), _collected_log() as log:
                    values = next(blocks, None)
                if values is None:
                    return
                caveats += _checked(log, path, incomplete=incomplete)
                filled = tuple(replace(column, values=values[label]) for label, column in columns.items())
                yield RawTable(
                    columns=filled,
                    format_name=self.name,
                    begun=_start_time(channels),
                    first_row=rows,
                    incomplete=incomplete,
                    caveats=caveats,
                )
                rows += filled[0].values.size


@contextmanager
def _collected_log() -> Iterator[list[str]]:
    """Context in which what npTDMS logs is collected instead of printed."""
    from nptdms.log import log_manager

    messages: list[str] = []

    def collect(record: logging.LogRecord) -> bool:
        messages.append(one_line(record.getMessage()))
        return False

    handler = log_manager.console_handler
    handler.addFilter(collect)
    try:
        yield messages
    finally:
        handler.removeFilter(collect)


def _checked(messages: list[str], path: Path, *, incomplete: bool) -> tuple[str, ...]:
    """Caveats by the log of npTDMS; refuses messages that make values wrong.

    That is data in another amount than the index announces, but for an incomplete last segment, and unknown scaling.
    """
    caveats = []
    for message in dict.fromkeys(messages):
        sizes = _CHUNK_MESSAGE.search(message)
        if sizes is not None and (not incomplete or int(sizes[2]) > most_unpacked_bytes(path)):
            raise InvalidInput(
                f"{path}: a segment with {sizes[1]} bytes of data announces chunks of {sizes[2]} bytes; it is damaged"
            )
        if "scale type" in message:
            raise InvalidInput(f"{path}: its samples cannot be scaled ({message[:200]})")
        if sizes is None and not incomplete:
            caveats.append(f"npTDMS: {message[:200]}")
    return tuple(caveats)


def _check_lead_ins(stream: BinaryIO, path: Path) -> bool:
    """Validate the lead-ins of all segments; return whether the last segment is incomplete."""
    size, position, segments = stream.seek(0, 2), 0, 0
    while position + _LEAD_IN <= size:
        segments += 1
        if segments > MAX_SEGMENTS:
            raise InvalidInput(
                f"{path}: has more than {MAX_SEGMENTS} segments; defragment it (TDMS Defragment in LabVIEW)"
            )
        stream.seek(position)
        lead_in = stream.read(_LEAD_IN)
        if lead_in[:4] != _SIGNATURE:
            raise InvalidInput(f"{path}: byte {position}: a segment must begin with TDSm, got {lead_in[:4]!r}")
        order = ">" if struct.unpack_from("<I", lead_in, 4)[0] & _BIG_ENDIAN else "<"
        segment_length, metadata_length = struct.unpack_from(order + "QQ", lead_in, 12)
        if metadata_length > size - position - _LEAD_IN:
            raise InvalidInput(
                f"{path}: byte {position}: announces {metadata_length} bytes of description, more than the file has"
            )
        if segment_length == _UNFINISHED:
            return True
        if metadata_length > segment_length:
            raise InvalidInput(
                f"{path}: byte {position}: a segment of {segment_length} bytes has {metadata_length} of description"
            )
        if segment_length >= 2**62:
            raise InvalidInput(f"{path}: byte {position}: announces a segment of {segment_length} bytes")
        position += _LEAD_IN + segment_length
    if size < _LEAD_IN:
        raise InvalidInput(f"{path}: is too short for a TDMS file ({size} bytes)")
    return position != size


def _selected_channels(file: Any, path: Path, mapping: RecordingMapping | None) -> dict[str, Any]:
    """Numeric channels with samples that the mapping selects and names, or all, by unique labels."""
    channels = [channel for group in file.groups() for channel in group.channels()]
    require_channels(len(channels), path)
    counts = Counter(one_line(channel.name) for channel in channels)
    entries = {
        ChannelEntry(_label(channel, counts), one_line(channel.group_name), len(channel)): channel
        for channel in channels
        if getattr(channel.dtype, "kind", "O") in "fiub" and len(channel) > 0  # real numbers and booleans
    }
    selection = mapping.selection if mapping is not None else Selection()
    found = list(entries.values())
    numeric = {label: found[index] for index, label in chosen_channels(list(entries), selection, path)}
    if mapping is not None and mapping.channels:
        named = mapping.for_labels(list(numeric))
        requested = {source.column for source in named.channels.values()}
        requested |= {named.axis.column} if named.axis else set()
        numeric = {label: channel for label, channel in numeric.items() if label in requested}
    if not numeric:
        raise InvalidInput(f"{path}: holds no channel of numbers" + (" that the mapping names" if mapping else ""))
    return numeric


def _label(channel: Any, counts: Counter[str]) -> str:
    """Name of a channel, with its group where several channels have the name."""
    name = one_line(channel.name)
    return name if counts[name] == 1 else one_line(f"{channel.group_name}/{name}")


def _empty_column(label: str, channel: Any, first: float) -> RawColumn:
    """Column of a channel without its values: label, unit and waveform time base, after the first start of the file."""
    properties = channel.properties
    unit = properties.get("unit_string") or properties.get("NI_UnitDescription")
    interval, offset = properties.get("wf_increment"), properties.get("wf_start_offset", 0.0)
    begun = _begun(channel)
    return RawColumn(
        label=label,
        values=np.empty(0),
        unit=str(unit) if unit else None,
        start=(float(offset) if isinstance(offset, (int, float)) else 0.0) + (begun - first if begun < inf else 0.0),
        interval=float(interval) if isinstance(interval, (int, float)) and interval else None,
        group=one_line(channel.group_name),
    )


def _begun(channel: Any) -> float:
    """Start of the waveform of a channel, in seconds since 1970; infinite where it states none."""
    stated = channel.properties.get("wf_start_time")
    return float(stated.astype("datetime64[us]").astype(np.int64)) / 1e6 if isinstance(stated, np.datetime64) else inf


def _blocks(file: Any, channels: dict[str, Any], block_samples: int | None) -> Iterator[dict[str, Floats]]:
    """Yield the samples of all channels in blocks of rows, from the chunks of the file."""
    pending: dict[str, list[Floats]] = {label: [] for label in channels}
    rows = dict.fromkeys(channels, 0)
    for chunk in file.data_chunks():
        for label, channel in channels.items():
            part = np.asarray(chunk[channel.group_name][channel.name][:])
            if part.size:
                pending[label].append(part.astype(np.float64, copy=False))
                rows[label] += part.size
        while block_samples is not None and min(rows.values()) >= block_samples:
            yield _take(pending, block_samples)
            rows = {label: count - block_samples for label, count in rows.items()}
    remaining = min(rows.values())
    if remaining or block_samples is None:
        yield _take(pending, remaining)


def _take(pending: dict[str, list[Floats]], rows: int) -> dict[str, Floats]:
    """Remove and return the first rows of all channels."""
    taken = {}
    for label, parts in pending.items():
        joined = parts[0] if len(parts) == 1 else np.concatenate(parts or [np.empty(0)])
        taken[label] = joined[:rows]
        pending[label] = [joined[rows:]] if joined.size > rows else []
    return taken


def _start_time(channels: dict[str, Any]) -> str:
    """Start of the waveform of the first channel that states one; empty where none does."""
    properties = (channel.properties for channel in channels.values())
    return next((str(own["wf_start_time"]) for own in properties if "wf_start_time" in own), "")
