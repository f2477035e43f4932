"""Raw blocks of a recording: a file to which blocks are appended as they come, with counters and checksums.

The header is the mark ``SNLBLK1`` with a line feed, the length of a text (4 bytes), that text (JSON: sample rate,
channels with quantity, unit, range and sensor, time of the begin, and the clock where it is not that of the run), and
its CRC-32 (4 bytes). Each record is the mark ``BLK`` behind the byte b5, sequence number and first sample (8 bytes
each), number of samples (4 bytes), CRC-32 of the samples and CRC-32 of all before it (4 bytes each), then the samples,
channel beside channel, as 64-bit floats. All numbers are little-endian.
"""

import json
import struct
import zlib
from collections import deque
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from math import ceil
from os import SEEK_END
from pathlib import Path
from typing import Any, BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from sonolube.errors import InvalidInput
from sonolube.laboratory.block import Block, Channel, Sensor
from sonolube.laboratory.records.run_folder import CLOCK_NAME
from sonolube.measurement.measured_files import refuse_unreadable
from sonolube.vocabulary import quantities


@dataclass(frozen=True, kw_only=True, slots=True)
class PartClock:
    """Clock of a part of the recording that is not the clock of the run.

    Parameters
    ----------
    name : str
        Of the acquisition, as the device map calls it.
    part : int
        Of the recording beside which this one was taken, from 1.
    offset : float
        Time of the first sample on the time axis of that part, in s.
    uncertainty : float
        Greatest error of the offset, which the times of two blocks tell, in s.
    first_sample : int
        By the counter of its hardware.
    """

    name: str
    part: int
    offset: float
    uncertainty: float
    first_sample: int = 0


def part_clock(content: Mapping[str, Any]) -> PartClock:
    """Clock of a part by what its file tells."""
    if not CLOCK_NAME.fullmatch(str(content["name"])):
        raise ValueError
    return PartClock(
        name=str(content["name"]),
        part=int(content["part"]),
        offset=float(content["offset"]),
        uncertainty=float(content["uncertainty"]),
        first_sample=int(content["first_sample"]),
    )


_MAGIC: Final = b"SNLBLK1\n"
_MARK: Final = b"\xb5BLK"
_LENGTH: Final = struct.Struct("<I")
_RECORD: Final = struct.Struct("<4sQQII")
_RECORD_BYTES: Final = _RECORD.size + _LENGTH.size
_LARGEST_HEADER: Final = 1 << 20
_SEARCHED: Final = 1 << 20  # bytes at a time, for the next record after a damaged one
_LARGEST_SAMPLE: Final = 1 << 53  # beyond it times in float64 repeat
_MAX_GAPS: Final = 1000
_MAX_READ: Final = 1 << 26  # bytes at the end of a file that grows


@dataclass(frozen=True, kw_only=True, slots=True)
class Gap:
    """Samples that are missing in a part of the recording.

    Parameters
    ----------
    sample : int
        The first that is missing, by the counter of the hardware.
    missing : int
    """

    sample: int
    missing: int


@dataclass(frozen=True, kw_only=True, slots=True)
class RawPart:
    """Contents of a file of raw blocks.

    Parameters
    ----------
    channels : tuple of Channel
    sample_rate : float
        [Hz]
    begun : float
        In s since 1970.
    header_bytes : int
        Length of the header; 0 where the file is not written yet.
    samples : int
        Whole samples of each channel in the file.
    first_sample : int
        By the counter of the hardware.
    gaps : tuple of Gap
        The first thousand.
    missing : int
        Samples that are missing in all gaps.
    damaged : int
        Places with bytes that are no record, the end of the file excepted.
    whole_bytes : int
        Length up to the end of the last whole record; what follows is the rest of a block that was not finished.
    blocks : int
        Whole records.
    clock : PartClock or None
        Where it is not that of the run.
    """

    channels: tuple[Channel, ...]
    sample_rate: float
    begun: float
    header_bytes: int = 0
    samples: int = 0
    first_sample: int = 0
    gaps: tuple[Gap, ...] = ()
    missing: int = 0
    damaged: int = 0
    whole_bytes: int = 0
    blocks: int = 0
    clock: PartClock | None = None

    @property
    def duration(self) -> float:
        """Time from the first sample to the end of the last one, gaps included. [s]"""
        return (self.samples + self.missing) / self.sample_rate

    @property
    def clock_name(self) -> str:
        """Name of its clock; empty for that of the run."""
        return "" if self.clock is None else self.clock.name


def raw_header(part: RawPart) -> bytes:
    """Header of a file of raw blocks."""
    names = [channel.name for channel in part.channels]
    if not names or len(set(names)) < len(names):
        raise InvalidInput(f"channels of a recording must be one or more, each once, got {', '.join(names) or 'none'}")
    if not 0 < part.sample_rate < np.inf:
        raise InvalidInput(f"sample_rate must be positive, got {part.sample_rate:g} Hz")
    listed = [
        {name: getattr(channel, name) for name in ("name", "quantity", "unit")}
        | {name: _finite_or_none(getattr(channel, name)) for name in ("lowest", "highest")}
        | ({} if channel.sensor == Sensor() else {"sensor": asdict(channel.sensor)})
        for channel in part.channels
    ]
    content = {"payload": "<f8", "sample_rate": float(part.sample_rate), "begun": part.begun, "channels": listed}
    if part.clock is not None:
        content["clock"] = asdict(part.clock)
    text = json.dumps(content, allow_nan=False).encode()
    return _MAGIC + _LENGTH.pack(len(text)) + text + _LENGTH.pack(zlib.crc32(text))


def raw_record(block: Block, *, sequence: int) -> bytes:
    """Record of a block."""
    payload = np.ascontiguousarray(block.values, dtype="<f8").tobytes()
    head = _RECORD.pack(_MARK, sequence, block.first_sample, block.samples, zlib.crc32(payload))
    return b"".join((head, _LENGTH.pack(zlib.crc32(head)), payload))


def scan_raw(path: Path) -> RawPart:
    """Look through a file of raw blocks, every checksum and counter included.

    Parameters
    ----------
    path : Path

    Returns
    -------
    RawPart

    Raises
    ------
    InvalidInput
        If the file cannot be read, or its header is damaged.
    """
    ((part, _),) = deque(_walk(path), maxlen=1)
    return part


def read_raw_blocks(path: Path) -> Iterator[Block]:
    """Yield the whole blocks of a file, one at a time; what is damaged is left out, and so a gap.

    Parameters
    ----------
    path : Path

    Yields
    ------
    Block

    Raises
    ------
    InvalidInput
        As `scan_raw`.
    """
    for part, block in _walk(path):
        if block is not None:
            yield replace(block, sample_rate=part.sample_rate)


def latest_samples(path: Path, *, duration: float) -> tuple[RawPart, Block | None]:
    """Read the last samples of a file that may still grow; a block that is being written is left out.

    Parameters
    ----------
    path : Path
    duration : float
        Of the samples, where there are that many without a gap. [s]

    Returns
    -------
    RawPart
        Channels and rate of the file; nothing is counted.
    Block or None
        None where there is no whole record.

    Raises
    ------
    InvalidInput
        If the file cannot be read, or its header is damaged or not written yet.
    """
    with refuse_unreadable(path), path.open("rb") as stream:
        part = _header(stream, path)
        size = stream.seek(0, SEEK_END)
        wanted = max(ceil(duration * part.sample_rate), 1)
        reach = min(2 * wanted * (8 * len(part.channels) + _RECORD_BYTES) + _SEARCHED, _MAX_READ)
        start = replace(part, whole_bytes=max(part.header_bytes, size - reach))
        blocks: list[Block] = []
        for _, block in _records(stream, size, start):
            if blocks and block.first_sample != blocks[-1].next_sample:
                blocks.clear()
            blocks.append(block)
    if not blocks:
        return part, None
    values = np.concatenate([block.values for block in blocks])[-wanted:]
    first = blocks[-1].next_sample - values.shape[0]
    return part, Block(first_sample=first, sample_rate=part.sample_rate, values=values)


def _walk(path: Path) -> Iterator[tuple[RawPart, Block | None]]:
    """Yield what a file holds up to each of its blocks, after the header without one."""
    with refuse_unreadable(path), path.open("rb") as stream:
        size = path.stat().st_size
        part = _header(stream, path)
        yield part, None
        yield from _records(stream, size, part)


def _records(stream: BinaryIO, size: int, part: RawPart) -> Iterator[tuple[RawPart, Block]]:
    """Yield the whole records behind the header."""
    place, sequence, expected, broken = part.whole_bytes, -1, None, False
    while place < size:
        found = _record(stream, place, size, len(part.channels))
        if found is None or found[0] <= sequence or (expected is not None and found[1].first_sample < expected):
            broken = True
            place = _next_mark(stream, place + 1, size)
            continue
        sequence, block = found
        missing = 0 if expected is None else block.first_sample - expected
        gaps = part.gaps
        if expected is not None and missing and len(gaps) < _MAX_GAPS:
            gaps = (*gaps, Gap(sample=expected, missing=missing))
        place += _RECORD_BYTES + block.values.nbytes
        part = replace(
            part,
            samples=part.samples + block.samples,
            first_sample=block.first_sample if expected is None else part.first_sample,
            gaps=gaps,
            missing=part.missing + missing,
            damaged=part.damaged + broken,
            whole_bytes=place,
            blocks=part.blocks + 1,
        )
        expected, broken = block.next_sample, False
        yield part, block


def _record(stream: BinaryIO, place: int, size: int, channels: int) -> tuple[int, Block] | None:
    """Sequence number and block of the record at a place; None where there is no whole one."""
    stream.seek(place)
    head = stream.read(_RECORD_BYTES)
    if len(head) < _RECORD_BYTES:
        return None
    mark, sequence, first, samples, checksum = _RECORD.unpack_from(head)
    if mark != _MARK or zlib.crc32(head[: _RECORD.size]) != _LENGTH.unpack_from(head, _RECORD.size)[0]:
        return None
    length = 8 * samples * channels
    if samples == 0 or first > _LARGEST_SAMPLE or length > size - place - _RECORD_BYTES:
        return None
    payload = stream.read(length)
    if len(payload) < length or zlib.crc32(payload) != checksum:
        return None
    values: NDArray[np.float64] = np.frombuffer(payload, dtype="<f8").reshape(samples, channels)
    return sequence, Block(first_sample=first, sample_rate=1.0, values=values)


def _next_mark(stream: BinaryIO, place: int, size: int) -> int:
    """Place of the next mark of a record, or the end of the file."""
    while place < size:
        stream.seek(place)
        piece = stream.read(_SEARCHED)
        at = piece.find(_MARK)
        if at >= 0:
            return place + at
        if len(piece) < len(_MARK):
            return size
        place += len(piece) - len(_MARK) + 1
    return size


def _header(stream: BinaryIO, path: Path) -> RawPart:
    """Read the header."""
    try:
        if stream.read(len(_MAGIC)) != _MAGIC:
            raise ValueError
        (length,) = _LENGTH.unpack(stream.read(_LENGTH.size))
        if length > _LARGEST_HEADER:
            raise ValueError
        text = stream.read(length)
        (checksum,) = _LENGTH.unpack(stream.read(_LENGTH.size))
        if zlib.crc32(text) != checksum:
            raise ValueError
        content = json.loads(text)
        channels = tuple(
            Channel(
                name=str(each["name"]),
                quantity=str(each["quantity"]),
                lowest=-np.inf if each["lowest"] is None else float(each["lowest"]),
                highest=np.inf if each["highest"] is None else float(each["highest"]),
                free_unit="" if each["quantity"] in quantities() else str(each.get("unit") or ""),
                sensor=_sensor(each.get("sensor", {})),
            )
            for each in content["channels"]
        )
        rate, begun = float(content["sample_rate"]), float(content["begun"])
        clock = part_clock(content["clock"]) if "clock" in content else None
        if content["payload"] != "<f8" or not channels or not 0 < rate < np.inf:
            raise ValueError
    except (ValueError, TypeError, KeyError, LookupError, struct.error, RecursionError):
        raise InvalidInput(f"{path}: is no file of raw blocks, or its header is damaged") from None
    end = stream.tell()
    return RawPart(channels=channels, sample_rate=rate, begun=begun, header_bytes=end, whole_bytes=end, clock=clock)


def _sensor(content: Mapping[str, Any]) -> Sensor:
    """Sensor of a channel by what its file tells."""
    texts = {name: str(content.get(name, "")) for name in ("identifier", "calibration", "calibrated")}
    uncertainty = content.get("uncertainty")
    return Sensor(**texts, uncertainty=None if uncertainty is None else float(uncertainty))


def _finite_or_none(value: float) -> float | None:
    """Value as JSON holds it; None where it is infinite."""
    return float(value) if np.isfinite(value) else None
