"""Part of a recording without a pause: its raw blocks with the set points, in long pieces."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
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
Pieces = Iterator[tuple[Floats, list[Floats]]]
"""Time since the first sample, in s, and the columns in the order of the variables, many rows each."""

ROWS: Final = 1 << 17
"""Rows of a piece of a recording."""

_VOLTAGE: Final = "voltage_peak_to_peak"
_SET_VOLTAGE: Final = "voltage_peak_to_peak_set"


@dataclass(frozen=True, kw_only=True)
class PartOfRecording:
    """Part of a recording, of its raw blocks or of the netCDF file into which they were converted.

    Parameters
    ----------
    path : Path
        Of the raw blocks, or of the netCDF file.
    samples, missing : int
        Of each channel.
    sample_rate : float
        [Hz]
    begun : float
        In s since 1970.
    variables : mapping of str to str
        Quantity of each variable by its name.
    units : mapping of str to str
        SI unit of each variable of a free quantity, by its name.
    clock : PartClock or None
        Where it is not that of the run.
    set_points : tuple of str
        Names of the variables that hold set points.
    lubricants : tuple of str
        Names of the lubricants 1, 2, ...
    caveats : list of str
    pieces : callable
        Yields time and columns, piece by piece.
    damaged : int
        Places of the raw blocks that are no record.
    """

    path: Path
    samples: int
    missing: int
    sample_rate: float
    begun: float
    variables: Mapping[str, str]
    units: Mapping[str, str]
    clock: PartClock | None
    set_points: tuple[str, ...]
    lubricants: tuple[str, ...]
    caveats: list[str]
    pieces: Callable[[], Pieces]
    damaged: int = 0

    @property
    def clock_name(self) -> str:
        """Name of the clock; empty for the clock of the run."""
        return "" if self.clock is None else self.clock.name


def recorded_part(
    folder: Path, part: int, documents: ReadDocuments, *, facts: Facts, raw: RawPart | None = None
) -> PartOfRecording:
    """Part of the recording of a run, by its raw blocks."""
    path = raw_path(folder, part)
    found = scan_raw(path) if raw is None else raw
    own = None if found.clock is None else (found.begun, found.sample_rate)
    steps = set_point_steps(documents, part, first_sample=found.first_sample, facts=facts, own_clock=own)
    variables = _variables(found, steps)
    free = {channel.name: channel.free_unit for channel in found.channels}
    return PartOfRecording(
        path=path,
        samples=found.samples,
        missing=found.missing,
        sample_rate=found.sample_rate,
        begun=found.begun,
        variables=variables,
        units={name: free.get(name, "") for name, of in variables.items() if of not in quantities()},
        clock=found.clock,
        set_points=tuple(name for name in variables if name in steps.names),
        lubricants=steps.lubricants,
        caveats=_caveats(found, steps),
        pieces=partial(_pieces, path, found, steps, list(variables)[len(found.channels) :]),
        damaged=found.damaged,
    )


def _variables(raw: RawPart, steps: SetPointSteps) -> dict[str, str]:
    """Quantity of each variable by its name: that of the quantity; that of the channel where several share it.

    A channel whose name is its own keeps it. Set points follow what was measured. The voltage that was set is
    `voltage_peak_to_peak` too where none was measured.
    """
    measured = [channel.quantity for channel in raw.channels]
    names = {
        channel.quantity
        if channel.is_standard and measured.count(channel.quantity) == 1
        else channel.name: channel.quantity
        for channel in raw.channels
    }
    set_points = {name: name for name in steps.names if name not in names}
    return names | ({_VOLTAGE: _VOLTAGE} if _tells_voltage(raw, steps) else {}) | set_points


def _tells_voltage(raw: RawPart, steps: SetPointSteps) -> bool:
    """Whether the voltage that was set stands for one that was not measured."""
    return steps.drives and all(channel.quantity != _VOLTAGE for channel in raw.channels)


def _caveats(raw: RawPart, steps: SetPointSteps) -> list[str]:
    """Caveats of the recording."""
    found = []
    if raw.gaps:
        at = (raw.gaps[0].sample - raw.first_sample) / raw.sample_rate
        gaps = f"{len(raw.gaps)} gaps" if len(raw.gaps) > 1 else "a gap"
        found.append(f"{raw.missing} samples are missing in {gaps}, the first at {at:.6g} s")
    if raw.damaged:
        found.append(f"the raw blocks are damaged at {raw.damaged} places, whose samples are left out")
    if _tells_voltage(raw, steps):
        found.append("voltage_peak_to_peak is the voltage that was set, not measured")
    if raw.clock is not None:
        found.append(_clock_caveat(raw.clock))
    return found


def _clock_caveat(clock: PartClock) -> str:
    """Offset of the times of a part with a clock of its own, and its uncertainty, in one line."""
    offset, within = f"{clock.offset:.4g}", format_si(clock.uncertainty, "s", digits=2)
    return (
        f"clock {clock.name}: time 0 is {offset} s after that of part {clock.part} of the recording, within {within};"
        " the clocks drift apart, and set points are placed by the clock of the computer"
    )


def _pieces(path: Path, raw: RawPart, steps: SetPointSteps, beside: list[str]) -> Pieces:
    """Pieces of raw blocks: time, channels, and the set points beside them."""
    blocks: list[Block] = []
    rows = 0
    for block in read_raw_blocks(path):
        blocks.append(block)
        rows += block.samples
        if rows >= ROWS:
            yield _piece(blocks, raw, steps, beside)
            blocks, rows = [], 0
    if blocks:
        yield _piece(blocks, raw, steps, beside)


def _piece(blocks: list[Block], raw: RawPart, steps: SetPointSteps, beside: list[str]) -> tuple[Floats, list[Floats]]:
    """Time and columns of consecutive blocks."""
    numbers = np.concatenate([np.arange(block.first_sample, block.next_sample) for block in blocks])
    values = np.concatenate([block.values for block in blocks])
    columns = [np.ascontiguousarray(values[:, column]) for column in range(values.shape[1])]
    columns += [steps.at(_SET_VOLTAGE if name == _VOLTAGE else name, numbers) for name in beside]
    return (numbers - raw.first_sample) / raw.sample_rate, columns
