"""Recovery of runs whose program was killed: the damaged end is kept aside, recording and documents completed."""

import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from sonolube.errors import InvalidInput
from sonolube.laboratory.records.documents import DocumentLog, read_documents
from sonolube.laboratory.records.raw_blocks import RawPart, scan_raw
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
from sonolube.operating_system import remove_file
from sonolube.storage.files import clear_unfinished, is_locked, locked_folder, unfinished_file
from sonolube.storage.growing_files import AppendedFile

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


def recover_run(folder: Path) -> Recovery:
    """Complete the record of a run whose program was killed, or whose recording could not be written.

    Parameters
    ----------
    folder : Path

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
            _close_documents(folder, known, parts)
            done.append("marked as interrupted")
        clear_unfinished(folder)
        _write_missing(folder, known, parts, done)
        remove_file(folder / RESERVE)
    return Recovery(summary=run_summary(folder), done=tuple(done))


def _known(folder: Path, done: list[str]) -> RunFacts:
    """Facts of a run, by its other files where run.json is missing or damaged."""
    try:
        return read_run_facts(folder)
    except InvalidInput:
        starts = read_documents(folder).of("start")
        if (folder / RUN).exists() and not starts:
            raise
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


def _close_documents(folder: Path, known: RunFacts, parts: dict[int, RawPart]) -> None:
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
        log.stop("interrupted", reason="the program ended before the run", time=last)
    finally:
        with suppress(InvalidInput):
            log.close()


def _write_missing(folder: Path, known: RunFacts, parts: dict[int, RawPart], done: list[str]) -> None:
    """Write the parts of the recording that were not written."""
    documents, paths = read_documents(folder), list[Path]()
    for number, raw in parts.items():
        path = recording_path(folder, number, raw.clock_name)
        paths.append(path)
        if raw.samples and not path.is_file():
            part = recorded_part(folder, number, documents, facts=known.facts, raw=raw)
            write_netcdf_recording(part, known, path)
            done.append(f"{path.name} written")
    keep_digests(folder, known, paths)


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
