"""Parts of a recording that are being written, with their clock, and their recovery after a killed program."""

import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from sonolube.errors import InvalidInput
from sonolube.laboratory.block import Block
from sonolube.laboratory.records.documents import DocumentLog, ReadDocuments, read_documents
from sonolube.laboratory.records.raw_blocks import RawPart, raw_header, raw_record, scan_raw
from sonolube.laboratory.records.recorded_part import recorded_part
from sonolube.laboratory.records.recording_files import write_netcdf_recording
from sonolube.laboratory.records.run import RunSummary, run_summary
from sonolube.laboratory.records.run_folder import (
    DOCUMENTS,
    PURPOSE,
    RESERVE,
    RUN,
    RunFacts,
    keep_digests,
    raw_parts,
    raw_path,
    read_run_facts,
    rebuilt_run_facts,
    recording_path,
    write_run_facts,
)
from sonolube.laboratory.verdict import Verdict
from sonolube.operating_system import remove_file
from sonolube.storage.files import clear_unfinished, is_locked, locked_folder, unfinished_file
from sonolube.storage.growing_files import AppendedFile

_MIN_JUMP: Final = 0.5  # s; larger than what a time service corrects at once without stepping the clock
_AT_ONCE: Final = 0.05  # s, between two clocks that are read together


class RunClock:
    """Time of day that goes on evenly although the clock of the computer is set meanwhile."""

    def __init__(self) -> None:
        self.begun, self._steady = _both_clocks()
        self._ahead = 0.0  # of the clock of the computer before this one

    def now(self) -> float:
        """Time since 1970 by this clock. [s]"""
        return self.begun + time.monotonic() - self._steady

    def jump(self) -> float:
        """Jump of the computer's clock since the last call, positive where it was set forward; else 0. [s]"""
        day, steady = _both_clocks()
        ahead = day - (self.begun + steady - self._steady)
        jump = ahead - self._ahead
        if abs(jump) < _MIN_JUMP:
            return 0.0
        self._ahead = ahead
        return jump


def _both_clocks() -> tuple[float, float]:
    """Time of day and steady time, read together: once more where the process was held up between. [s]"""
    while True:
        before, day, after = time.monotonic(), time.time(), time.monotonic()
        if after - before < _AT_ONCE:
            return day, after


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


_COPIED: Final = 1 << 20  # bytes at a time
_PATIENCE: Final = 1.0  # s
_POLL: Final = 0.02  # s


@dataclass(frozen=True, kw_only=True, slots=True)
class Recovery:
    """Changes made by the recovery of a run.

    Parameters
    ----------
    summary : RunSummary
        Of the run now.
    done : tuple of str
        What was mended; nothing where the record was whole.
    """

    summary: RunSummary
    done: tuple[str, ...]


def recover_run(folder: Path, *, outputs: Verdict | None = None) -> Recovery:
    """Complete the record of a run whose program was killed, or whose recording could not be written.

    Parameters
    ----------
    folder : Path
    outputs : Verdict, optional
        On motor and drive, by what has switched them off in place of the program.

    Returns
    -------
    Recovery
        The rest of a block or document that was being written is cut off and kept in a file beside. A second recovery
        changes nothing.

    Raises
    ------
    InvalidInput
        If the run is still at work, the folder holds no run, or cannot be written.
    """
    done: list[str] = []
    known = _known(folder, done)
    if known.referenced:
        return Recovery(summary=run_summary(folder), done=())
    _wait_for_the_end(folder)
    with locked_folder(folder, purpose=PURPOSE):
        if done:
            write_run_facts(folder, known)
        documents = read_documents(folder)
        if not documents.is_whole:
            done.append(_set_aside(folder / DOCUMENTS, documents.whole_bytes))
        parts = _mended_parts(folder, done)
        if not documents.of("stop"):
            _close_documents(folder, known, parts, outputs)
            done.append("marked as interrupted")
        clear_unfinished(folder)
        done += [f"{name} written" for name in write_missing(folder, known, parts.items())]
        remove_file(folder / RESERVE)
    return Recovery(summary=run_summary(folder), done=tuple(done))


def _known(folder: Path, done: list[str]) -> RunFacts:
    """Facts of a run, by its other files where run.json is missing or damaged."""
    try:
        return read_run_facts(folder)
    except InvalidInput:
        starts = read_documents(folder).of("start")
        known = rebuilt_run_facts(folder, starts[0] if starts else None)
    done.append(
        f"{RUN} written from " + ("the first document" if starts else "the protocol and the name of the folder")
    )
    return known


def _wait_for_the_end(folder: Path) -> None:
    """Wait a moment where the lock is held: what a killed process has just started may hold it until it begins."""
    latest = time.monotonic() + _PATIENCE
    while is_locked(folder) and time.monotonic() < latest:
        time.sleep(_POLL)


def _mended_parts(folder: Path, done: list[str]) -> dict[int, RawPart]:
    """Parts with a readable header, the rest of a block after the last whole one set aside."""
    parts = {}
    for number in raw_parts(folder):
        path = raw_path(folder, number)
        try:
            part = scan_raw(path)
        except InvalidInput as failure:
            if path.stat().st_size:
                done.append(f"part {number} left as it is: {failure}")
            continue
        parts[number] = part
        if path.stat().st_size > part.whole_bytes:
            done.append(_set_aside(path, part.whole_bytes))
    return parts


def _close_documents(folder: Path, known: RunFacts, parts: dict[int, RawPart], outputs: Verdict | None) -> None:
    """Write the documents with which an interrupted run ends."""
    earlier = read_documents(folder)
    log = DocumentLog(folder, earlier=earlier if (folder / DOCUMENTS).exists() else None)
    try:
        if not earlier.of("start"):
            log.start(known)
        described = {str(each.get("name")) for each in earlier.of("descriptor")}
        for number, part in parts.items():
            if f"recording-{number}" not in described:
                log.part(number, part)
            log.end_part(read_documents(folder), number, part)
        last = max((part.begun + part.duration for part in parts.values()), default=known.begun)
        if outputs is not None:
            last = max(last, time.time())
            log.note("off" if outputs.is_off else "not off", time=last, sample=None, facts={"outputs": outputs.text})
        log.stop("interrupted", reason="the program ended before the run", time=last)
    finally:
        with suppress(InvalidInput):
            log.close()


def write_missing(folder: Path, known: RunFacts, parts: Iterable[tuple[int, RawPart]]) -> list[str]:
    """Write the parts of a recording that were not written, keep the digests of all, and return the names of files."""
    documents, paths, written = read_documents(folder), list[Path](), list[str]()
    for number, raw in parts:
        path = recording_path(folder, number, raw.clock_name)
        paths.append(path)
        if raw.samples and not path.is_file():
            part = recorded_part(folder, number, documents, facts=known.facts, raw=raw)
            write_netcdf_recording(part, known, path)
            written.append(path.name)
    keep_digests(folder, known, paths)
    return written


def _set_aside(path: Path, length: int) -> str:
    """Cut a file to a length, the rest kept in a file beside it, and return what was done."""
    aside = path.with_name(f"{path.name}.from-{length}.damaged")
    with path.open("rb") as stream, unfinished_file(aside) as file:
        stream.seek(length)
        while piece := stream.read(_COPIED):
            file.write(piece)
        file.complete()
    size = path.stat().st_size - length
    AppendedFile(path, keep=length).close()
    return f"{size} bytes of an unfinished entry cut off {path.name}, kept in {aside.name}"
