"""Parts of a recording that are being written, and the clock of their run, which does not jump."""

import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Final

from sonolube.errors import InvalidInput
from sonolube.laboratory.block import Block
from sonolube.laboratory.records.documents import DocumentLog, ReadDocuments
from sonolube.laboratory.records.raw_blocks import RawPart, raw_header, raw_record
from sonolube.laboratory.records.run_folder import raw_path
from sonolube.storage.growing_files import AppendedFile

_MIN_JUMP: Final = 0.5  # s; larger than what a time service corrects at once without stepping the clock


class RunClock:
    """Time of day that goes on evenly although the clock of the computer is set meanwhile."""

    def __init__(self) -> None:
        self.begun = time.time()
        self._steady = time.monotonic()
        self._ahead = 0.0  # of the clock of the computer before this one

    def now(self) -> float:
        """Time since 1970 by this clock. [s]"""
        return self.begun + time.monotonic() - self._steady

    def jump(self) -> float:
        """Jump of the computer's clock since the last call, positive where it was set forward; else 0. [s]"""
        ahead = time.time() - self.now()
        jump = ahead - self._ahead
        if abs(jump) < _MIN_JUMP:
            return 0.0
        self._ahead = ahead
        return jump


NoteGap = Callable[[int, Mapping[str, str | float]], None]
"""Takes the first missing sample, and what is known of the gap."""


class OpenPart:
    """Samples of some channels that follow one another.

    Parameters
    ----------
    folder : Path
        Of the run.
    number : int
        From 1.
    part : RawPart
        Without samples.
    log : DocumentLog

    Raises
    ------
    InvalidInput
        If the channels are no channels, or the disk is full.
    """

    def __init__(self, folder: Path, number: int, part: RawPart, log: DocumentLog) -> None:
        self.number, self.part, self._log = number, part, log
        self._next = None if part.clock is None else part.clock.first_sample
        header = raw_header(part)
        self._file: AppendedFile | None = AppendedFile(raw_path(folder, number))
        try:
            self._file.append(header)
            log.part(number, part)
        except InvalidInput:
            with suppress(InvalidInput):
                self.close()
            raise

    def require_fitting(self, block: Block) -> None:
        """Raise where a block has another shape, or the sample counter goes back."""
        channels = len(self.part.channels)
        if block.values.ndim != 2 or block.values.shape[1] != channels or not block.samples:
            raise InvalidInput(f"block has the shape {block.values.shape}, but {channels} channels are recorded")
        if block.first_sample < (self._next or 0):
            raise InvalidInput(f"block begins at sample {block.first_sample}, but {self._next} was expected")

    def append(self, block: Block, note_gap: NoteGap) -> None:
        """Keep a block that fits; it is in the hands of the operating system when this returns."""
        assert self._file is not None
        if self._next is not None and block.first_sample > self._next:
            note_gap(self._next, {"missing": block.first_sample - self._next})
        self._file.append(raw_record(block, sequence=self.part.blocks))
        self.part = replace(self.part, blocks=self.part.blocks + 1, samples=self.part.samples + block.samples)
        self._next = block.next_sample

    def close(self) -> None:
        """Close the file; harmless where that was done before."""
        file, self._file = self._file, None
        if file is not None:
            file.close()

    def describe(self, earlier: ReadDocuments) -> None:
        """Write how many samples it has, unless `earlier` tells that."""
        self._log.end_part(earlier, self.number, self.part)
