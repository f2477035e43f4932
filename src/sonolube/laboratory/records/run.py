"""Runs read back from their folders: facts, events, outcome and recording."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from sonolube.errors import InvalidInput, UnknownName
from sonolube.laboratory.devices import SILENT
from sonolube.laboratory.records.documents import (
    EXIT_STATUS,
    ReadDocuments,
    RecordedChannel,
    main_parts,
    numbered_parts,
    part_clocks,
    part_name,
    read_documents,
    recorded_channels,
    stream_counts,
)
from sonolube.laboratory.records.run_folder import (
    DOCUMENTS,
    LATEST,
    PROTOCOL,
    UNRESOLVED,
    RunFacts,
    changed_files,
    changed_recordings,
    is_run_folder,
    raw_path,
    read_run_facts,
    recording_path,
)
from sonolube.measurement.measured_files import refuse_unreadable
from sonolube.storage.files import is_locked

if TYPE_CHECKING:
    import xarray as xr

_FASTEST: Final = 1e15  # Hz
RUNNING: Final = "running"
UNFINISHED: Final = "unfinished"
"""Outcome of a run whose program was killed and that was not recovered yet."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Note:
    """Event of a run, with its time.

    Parameters
    ----------
    kind : str
        Such as drive, motor, gap, clock jump or trip.
    time : float
        Since 1970, by the clock of the run. [s]
    sample : int or None
        By the counter of the acquisition.
    facts : mapping of str to object
    """

    kind: str
    time: float
    sample: int | None
    facts: Mapping[str, Any]


@dataclass(frozen=True, kw_only=True, slots=True)
class RunSummary:
    """A run in one row.

    Parameters
    ----------
    folder : Path
    title : str
    begun : float
        In s since 1970.
    outcome : str
        completed, stopped, failed, interrupted, running or unfinished.
    reason : str
        Why it ended before its protocol.
    samples : int
        Recorded samples of each channel, of all parts.
    duration : float
        Of the recording, without pauses. [s]
    channels : tuple of str
    gaps : int
        Gaps that were noted.
    """

    folder: Path
    title: str
    begun: float
    outcome: str
    reason: str
    samples: int
    duration: float
    channels: tuple[str, ...]
    gaps: int

    @property
    def begun_text(self) -> str:
        """Time of the begin in UTC, such as 2026-11-23T01:42:10Z."""
        return datetime.fromtimestamp(self.begun, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


@dataclass(frozen=True, kw_only=True)
class Run:
    """A run with its record.

    Parameters
    ----------
    summary : RunSummary
    known : RunFacts
        Facts, versions and hashes from its begin.
    protocol : str
        Text of the protocol; empty for recordings that were taken in.
    notes : tuple of Note
    caveats : tuple of str
        What speaks against the record.
    """

    summary: RunSummary
    known: RunFacts
    protocol: str
    notes: tuple[Note, ...]
    caveats: tuple[str, ...]
    _documents: ReadDocuments = field(repr=False)

    @property
    def folder(self) -> Path:
        """Folder of the run."""
        return self.summary.folder

    @property
    def facts(self) -> Mapping[str, str | float | int | bool]:
        """Facts of the run."""
        return self.known.facts

    @property
    def recordings(self) -> tuple[Path, ...]:
        """Files of the recording, one a part, that exist; without those of other clocks than that of the run."""
        if self.known.referenced:
            return tuple(map(Path, self.known.referenced))
        paths = (recording_path(self.folder, part) for part in main_parts(self._documents))
        return tuple(path for path in paths if path.is_file())

    @property
    def clocks(self) -> dict[str, tuple[Path, ...]]:
        """Files of the parts of other clocks that exist, by the names of the clocks."""
        found: dict[str, tuple[Path, ...]] = {}
        for part, clock in sorted(part_clocks(self._documents).items()):
            path = recording_path(self.folder, part, clock)
            if path.is_file():
                found[clock] = (*found.get(clock, ()), path)
        return found

    @property
    def channels(self) -> dict[str, RecordedChannel]:
        """Channels of all parts by name, as they were begun."""
        return recorded_channels(self._documents)

    @property
    def part_channels(self) -> dict[Path, tuple[str, ...]]:
        """Channels of each part of the recording, as the protocol names them, by its file."""
        named = {str(each.get("name")): each for each in self._documents.of("descriptor")}
        found = {}
        for part in main_parts(self._documents):
            path = recording_path(self.folder, part)
            if path.is_file():
                found[path] = tuple(map(str, named[part_name(part)]["data_keys"]))
        return found

    def dataset(self, part: int | None = None, *, clock: str = "") -> "xr.Dataset":
        """Recording in SI over `time`, its variables named by their quantities.

        Parameters
        ----------
        part : int, optional
            Of a recording with pauses, from 1; all parts on one axis of time by default.
        clock : str
            Of `clocks`; that of the run by default.

        Returns
        -------
        xarray.Dataset
            As `sonolube.measurement.read_recording` reads it.

        Raises
        ------
        InvalidInput
            If the run has no such recording, or its parts have different channels.
        UnknownName
            If the run has no such clock.
        """
        from sonolube.measurement.recordings.channels_and_parts import join_recordings
        from sonolube.measurement.recordings.reader import read_recording

        if clock and clock not in self.clocks:
            raise UnknownName.among(self.clocks, kind="clock", name=clock)
        paths = self.clocks[clock] if clock else self.recordings
        if not paths:
            raise InvalidInput(f"{self.folder}: has no recording; sonolube lab recover writes what a killed run left")
        if part is not None and not 1 <= part <= len(paths):
            raise InvalidInput(f"part must be one of 1 to {len(paths)}, got {part}")
        chosen = paths if part is None else (paths[part - 1],)
        datasets = [read_recording(path) for path in chosen]
        return datasets[0] if len(datasets) == 1 else join_recordings(datasets)


def read_run(folder: Path) -> Run:
    """Read a run.

    Parameters
    ----------
    folder : Path

    Returns
    -------
    Run
        Files that were changed since the run began are among its caveats.

    Raises
    ------
    InvalidInput
        If the folder holds no run, or its facts are damaged.
    """
    known, documents = read_run_facts(folder), read_documents(folder)
    summary = _summary(folder, known, documents)
    protocol = folder / PROTOCOL
    text = protocol.read_text(encoding="utf-8", errors="replace") if protocol.is_file() else ""
    return Run(
        summary=summary,
        known=known,
        protocol=text,
        notes=tuple(note_of(event) for event in documents.of("event")),
        caveats=tuple(_caveats(folder, known, documents, summary)),
        _documents=documents,
    )


def run_folders(parent: Path) -> list[Path]:
    """Folders of runs in a folder, by name, which is by time."""
    with refuse_unreadable(parent):
        return sorted(path for path in parent.iterdir() if is_run_folder(path))


def run_summary(folder: Path) -> RunSummary:
    """Summary of a run, also of one whose facts are damaged.

    Parameters
    ----------
    folder : Path

    Returns
    -------
    RunSummary
    """
    documents = read_documents(folder)
    try:
        known = read_run_facts(folder)
    except InvalidInput as failure:
        known = RunFacts(title=folder.name, begun=0.0, facts={}, versions={}, files={})
        found = _summary(folder, known, documents)
        return replace(found, outcome="failed", reason=str(failure))
    return _summary(folder, known, documents)


def _summary(folder: Path, known: RunFacts, documents: ReadDocuments) -> RunSummary:
    """Summary from what was read."""
    outcome, reason = RUNNING if is_locked(folder) else UNFINISHED, ""
    for stop in documents.of("stop"):
        status = {value: key for key, value in reversed(EXIT_STATUS.items())}
        outcome = str(stop.get("outcome") or status.get(stop["exit_status"], "failed"))
        reason = str(stop.get("reason") or "")
    channels: dict[str, None] = {}
    samples, duration = 0, 0.0
    counts, rates = stream_counts(documents), _sample_rates(documents)
    for descriptor in documents.of("descriptor"):
        if str(descriptor.get("name")).startswith(part_name(0)[:-1]):
            channels |= dict.fromkeys(map(str, descriptor["data_keys"]))
    for name in map(part_name, main_parts(documents)):
        samples += counts.get(name, 0)
        duration += counts.get(name, 0) / rates[name] if name in rates else 0.0
    return RunSummary(
        folder=folder,
        title=known.title,
        begun=known.begun,
        outcome=outcome,
        reason=reason,
        samples=samples,
        duration=duration,
        channels=tuple(channels),
        gaps=sum(event["data"]["kind"] == "gap" for event in documents.of("event")),
    )


def _sample_rates(documents: ReadDocuments) -> dict[str, float]:
    """Sample rate of each part by the name of its stream, in Hz."""
    names = {str(each["uid"]): str(each.get("name")) for each in documents.of("descriptor")}
    streams = {str(each.get("stream_resource")): str(each.get("descriptor")) for each in documents.of("stream_datum")}
    rates = {}
    for resource in documents.of("stream_resource"):
        name, rate = names.get(streams.get(resource["uid"], "")), resource["parameters"].get("sample_rate")
        if name is not None and isinstance(rate, int | float) and 0 < rate < _FASTEST:
            rates[name] = float(rate)
    return rates


def last_verdict(folder: Path) -> str:
    """Verdict on motor and drive with which the record of a run ends; empty without one, or where it does not end."""
    documents = read_documents(folder)
    if not documents.of("stop"):
        return ""
    found = (note_of(event).facts.get("outputs") for event in reversed(documents.of("event")))
    return next((str(outputs) for outputs in found if outputs), "")


def note_of(event: Mapping[str, Any]) -> Note:
    """Note that an event document holds."""
    data, time = event["data"], event.get("time")
    try:
        facts = json.loads(data["facts"])
    except (ValueError, RecursionError):
        facts = {}
    sample = data.get("sample")
    return Note(
        kind=data["kind"],
        time=float(time) if isinstance(time, int | float) and abs(time) < LATEST else 0.0,
        sample=sample if isinstance(sample, int) else None,
        facts=facts if isinstance(facts, dict) else {},
    )


def _caveats(folder: Path, known: RunFacts, documents: ReadDocuments, summary: RunSummary) -> list[str]:
    """Caveats of the record of a run."""
    clocks = part_clocks(documents)
    found = [f"{name} is missing or was changed since the run began" for name in changed_files(folder, known)]
    found += [f"{name} was changed after the run wrote it" for name in changed_recordings(folder, known)]
    if UNRESOLVED in known.facts:
        found.append(str(known.facts[UNRESOLVED]))
    if summary.outcome == UNFINISHED:
        found.append("the program was killed during the run; sonolube lab recover completes its record")
    elif summary.outcome not in ("completed", RUNNING):
        found.append(f"the run was {summary.outcome}" + (f": {summary.reason}" if summary.reason else ""))
    if not documents.is_whole:
        found.append(f"the end of {DOCUMENTS} is damaged")
    if summary.gaps:
        found.append("samples are missing: " + (f"{summary.gaps} gaps" if summary.gaps > 1 else "a gap"))
    if summary.outcome not in (RUNNING, UNFINISHED):
        found += [
            f"part {part} of the recording is in raw blocks only; sonolube lab recover writes it"
            for part in numbered_parts(documents)
            if raw_path(folder, part).is_file()
            and not recording_path(folder, part, clocks.get(part, "")).is_file()
            and summary.samples
        ]
    gone = (part for part in numbered_parts(documents) if not raw_path(folder, part).is_file())
    missing = (recording_path(folder, part, clocks.get(part, "")).name for part in gone)
    found += [f"{name} is missing" for name in missing if name in known.recordings and not (folder / name).is_file()]
    silent = [note_of(event).facts for event in documents.of("event") if event["data"]["kind"] == SILENT]
    found += [f"clock {facts.get('clock')} gave no sample of {facts.get('channels')} in a part" for facts in silent]
    jumps = sum(event["data"]["kind"] == "clock jump" for event in documents.of("event"))
    if jumps:
        found.append(f"the clock of the computer was set {jumps} times during the run; times are by sample counters")
    return found
