"""Part of a recording without a pause: its raw blocks with the set points, in long pieces."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from sonolube.laboratory.block import Block
from sonolube.laboratory.records.documents import ReadDocuments
from sonolube.laboratory.records.part_clock import PartClock
from sonolube.laboratory.records.raw_blocks import RawPart, read_raw_blocks, scan_raw
from sonolube.laboratory.records.run_folder import Facts, raw_path
from sonolube.laboratory.records.set_point_steps import SetPointSteps, set_point_steps
from sonolube.text.units import format_si
from sonolube.vocabulary import quantities

Floats = NDArray[np.float64]

_ROWS: Final = 1 << 17
_VOLTAGE: Final = "voltage_peak_to_peak"
_SET_VOLTAGE: Final = "voltage_peak_to_peak_set"


@dataclass(frozen=True, kw_only=True)
class RecordedPart:
    """Part of a recording.

    Parameters
    ----------
    path : Path
        Of the raw blocks.
    raw : RawPart
        What they hold.
    steps : SetPointSteps
        Set points.
    """

    path: Path
    raw: RawPart
    steps: SetPointSteps

    @property
    def samples(self) -> int:
        """Samples of each channel."""
        return self.raw.samples

    @property
    def missing(self) -> int:
        """Samples that are missing in gaps."""
        return self.raw.missing

    @property
    def sample_rate(self) -> float:
        """Of each channel. [Hz]"""
        return self.raw.sample_rate

    @property
    def begun(self) -> float:
        """Begin in s since 1970."""
        return self.raw.begun

    @property
    def clock(self) -> PartClock | None:
        """Clock, where it is not that of the run."""
        return self.raw.clock

    @property
    def clock_name(self) -> str:
        """Its name; empty for the clock of the run."""
        return "" if self.raw.clock is None else self.raw.clock.name

    @property
    def units(self) -> Mapping[str, str]:
        """SI unit of each variable of a free quantity, by its name."""
        free = {channel.name: channel.free_unit for channel in self.raw.channels}
        return {name: free.get(name, "") for name, of in self.variables.items() if of not in quantities()}

    @property
    def set_points(self) -> tuple[str, ...]:
        """Names of the variables that hold set points."""
        return tuple(name for name in self.variables if name in self.steps.names)

    @property
    def lubricants(self) -> tuple[str, ...]:
        """Names of the lubricants 1, 2, ..."""
        return self.steps.lubricants

    @property
    def variables(self) -> Mapping[str, str]:
        """Quantity of each variable by its name: that of the quantity; that of the channel where several share it.

        A channel whose name is its own keeps it. Set points follow what was measured. The voltage that was set is
        `voltage_peak_to_peak` too where none was measured.
        """
        measured = [channel.quantity for channel in self.raw.channels]
        names = {
            channel.quantity
            if channel.is_standard and measured.count(channel.quantity) == 1
            else channel.name: channel.quantity
            for channel in self.raw.channels
        }
        set_points = {name: name for name in self.steps.names if name not in names}
        return names | ({_VOLTAGE: _VOLTAGE} if self._tells_voltage else {}) | set_points

    @property
    def _tells_voltage(self) -> bool:
        """Whether the voltage that was set stands for one that was not measured."""
        return self.steps.drives and all(channel.quantity != _VOLTAGE for channel in self.raw.channels)

    @property
    def caveats(self) -> list[str]:
        """Caveats of the recording."""
        found, rate = [], self.raw.sample_rate
        if self.raw.gaps:
            first = self.raw.gaps[0]
            at = (first.sample - self.raw.first_sample) / rate
            gaps = f"{len(self.raw.gaps)} gaps" if len(self.raw.gaps) > 1 else "a gap"
            found.append(f"{self.raw.missing} samples are missing in {gaps}, the first at {at:.6g} s")
        if self.raw.damaged:
            found.append(f"the raw blocks are damaged at {self.raw.damaged} places, whose samples are left out")
        if self._tells_voltage:
            found.append("voltage_peak_to_peak is the voltage that was set, not measured")
        if self.raw.clock is not None:
            found.append(clock_caveat(self.raw.clock))
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
        beside = list(self.variables)[len(columns) :]
        columns += [self.steps.at(_SET_VOLTAGE if name == _VOLTAGE else name, numbers) for name in beside]
        return (numbers - self.raw.first_sample) / self.raw.sample_rate, columns


def clock_caveat(clock: PartClock) -> str:
    """Offset of the times of a part with a clock of its own, and its uncertainty, in one line."""
    offset, within = f"{clock.offset:.4g}", format_si(clock.uncertainty, "s", digits=2)
    return (
        f"clock {clock.name}: time 0 is {offset} s after that of part {clock.part} of the recording, within {within};"
        " the clocks drift apart, and set points are placed by the clock of the computer"
    )


def recorded_part(
    folder: Path, part: int, documents: ReadDocuments, *, facts: Facts, raw: RawPart | None = None
) -> RecordedPart:
    """Part of the recording of a run."""
    path = raw_path(folder, part)
    found = scan_raw(path) if raw is None else raw
    own = None if found.clock is None else (found.begun, found.sample_rate)
    steps = set_point_steps(documents, part, first_sample=found.first_sample, facts=facts, own_clock=own)
    return RecordedPart(path=path, raw=found, steps=steps)
