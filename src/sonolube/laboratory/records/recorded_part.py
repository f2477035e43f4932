"""Part of a recording without a pause: its raw blocks with the drive voltage as it was set, in long pieces."""

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from sonolube.laboratory.block import Block
from sonolube.laboratory.records.documents import ReadDocuments, part_name
from sonolube.laboratory.records.raw_blocks import RawPart, read_raw_blocks, scan_raw
from sonolube.laboratory.records.run_folder import raw_path

Floats = NDArray[np.float64]

_ROWS: Final = 1 << 17
_VOLTAGE: Final = "voltage_peak_to_peak"


@dataclass(frozen=True, kw_only=True)
class RecordedPart:
    """Part of a recording.

    Parameters
    ----------
    path : Path
        Of the raw blocks.
    raw : RawPart
        What they hold.
    voltages : tuple of (int, float)
        Sample from which a drive voltage was set, and its peak-to-peak value; none where the drive was not used, or its
        voltage is a channel, in V.
    """

    path: Path
    raw: RawPart
    voltages: tuple[tuple[int, float], ...]

    @property
    def variables(self) -> Mapping[str, str]:
        """Quantity of each variable by its name: that of the quantity, that of the channel where several share it."""
        quantities = [channel.quantity for channel in self.raw.channels]
        names = {
            channel.quantity if quantities.count(channel.quantity) == 1 else channel.name: channel.quantity
            for channel in self.raw.channels
        }
        return names | ({_VOLTAGE: _VOLTAGE} if self.voltages else {})

    @property
    def caveats(self) -> list[str]:
        """What speaks against the recording."""
        found, rate = [], self.raw.sample_rate
        if self.raw.gaps:
            first = self.raw.gaps[0]
            at = (first.sample - self.raw.first_sample) / rate
            gaps = f"{len(self.raw.gaps)} gaps" if len(self.raw.gaps) > 1 else "a gap"
            found.append(f"{self.raw.missing} samples are missing in {gaps}, the first at {at:.6g} s")
        if self.raw.damaged:
            found.append(f"the raw blocks are damaged at {self.raw.damaged} places, whose samples are left out")
        if self.voltages:
            found.append("voltage_peak_to_peak is the voltage that was set, not measured")
        return found

    def pieces(self) -> Iterator[tuple[Floats, list[Floats]]]:
        """Yield the time since the first sample, in s, and the columns in the order of `variables`, many rows each."""
        blocks: list[Block] = []
        rows = 0
        for block in read_raw_blocks(self.path):
            blocks.append(block)
            rows += block.samples
            if rows >= _ROWS:
                yield self._piece(blocks)
                blocks, rows = [], 0
        if blocks:
            yield self._piece(blocks)

    def _piece(self, blocks: list[Block]) -> tuple[Floats, list[Floats]]:
        """Time and columns of consecutive blocks."""
        numbers = np.concatenate([np.arange(block.first_sample, block.next_sample) for block in blocks])
        values = np.concatenate([block.values for block in blocks])
        columns = [np.ascontiguousarray(values[:, column]) for column in range(values.shape[1])]
        if self.voltages:
            samples, levels = zip(*self.voltages, strict=True)
            columns.append(np.array(levels)[np.searchsorted(samples, numbers, side="right") - 1])
        return (numbers - self.raw.first_sample) / self.raw.sample_rate, columns


def recorded_part(folder: Path, part: int, documents: ReadDocuments, *, raw: RawPart | None = None) -> RecordedPart:
    """Part of the recording of a run.

    Parameters
    ----------
    folder : Path
    part : int
        From 1.
    documents : ReadDocuments
        Of the run.
    raw : RawPart, optional
        Where the raw blocks were looked through already.

    Returns
    -------
    RecordedPart

    Raises
    ------
    InvalidInput
        If the raw blocks cannot be read.
    """
    path = raw_path(folder, part)
    found = scan_raw(path) if raw is None else raw
    is_measured = any(channel.quantity == _VOLTAGE for channel in found.channels)
    levels = () if is_measured else _set_voltages(documents, part, found.first_sample)
    return RecordedPart(path=path, raw=found, voltages=levels)


def _set_voltages(documents: ReadDocuments, part: int, first_sample: int) -> tuple[tuple[int, float], ...]:
    """Voltages that were set from a sample on, those before the part at its first sample."""
    level, is_used = 0.0, False
    found: list[tuple[int, float]] = []
    uid = ""
    for name, document in documents.documents:
        if name == "descriptor" and document.get("name") == part_name(part):
            uid, found = str(document["uid"]), [(first_sample, level)]
        elif name == "stream_datum" and uid and document.get("descriptor") == uid:
            break  # the part has ended
        elif name == "event" and (volts := _voltage_of(document)) is not None:
            level, sample = volts, document["data"].get("sample")
            is_used |= document["data"]["kind"] == "drive"
            if found and isinstance(sample, int):
                _set_from(found, max(sample, first_sample), level)
    return tuple(found) if is_used else ()


def _set_from(found: list[tuple[int, float]], sample: int, level: float) -> None:
    """Set a level from a sample on; of several at one sample the last holds."""
    if found and found[-1][0] >= sample:
        found[-1] = (found[-1][0], level)
    else:
        found.append((sample, level))


def _voltage_of(event: Mapping[str, Any]) -> float | None:
    """Voltage from an event on; None where it does not change it."""
    kind = event["data"]["kind"]
    if kind == "pause":
        return 0.0
    if kind != "drive":
        return None
    try:
        return float(json.loads(event["data"]["facts"])["voltage_peak_to_peak"])
    except (ValueError, TypeError, KeyError, RecursionError):
        return None
