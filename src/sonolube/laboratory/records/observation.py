"""Observation of a run by its folder alone, also while it is recorded: state, step, time, set points, last samples."""

import time
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Final

import numpy as np

from sonolube.errors import InvalidInput, SonolubeError
from sonolube.facts.protocol import SetPoint, flattened, read_protocol
from sonolube.laboratory.block import Block
from sonolube.laboratory.records.documents import ReadDocuments, main_parts, part_clocks, part_name, read_documents
from sonolube.laboratory.records.raw_blocks import RawPart, latest_samples
from sonolube.laboratory.records.run import RUNNING, UNFINISHED, Note, note_of, run_folders, run_summary
from sonolube.laboratory.records.run_folder import DOCUMENTS, PROTOCOL, RUN, RunFacts, raw_path, read_run_facts
from sonolube.storage.files import is_locked

MEAN_DURATION: Final = 1.0
"""Time of the samples whose mean is shown. [s]"""

_YOUNG: Final = 10.0  # s, within which a run writes its first document
_SET_POINTS: Final = {"motor": ("rotation_speed", "sliding_speed"), "drive": ("voltage_peak_to_peak", "frequency")}


@dataclass(frozen=True, kw_only=True, slots=True)
class Observation:
    """A run at one moment.

    Parameters
    ----------
    folder : Path
    known : RunFacts
        From its begin.
    outcome : str
        running; unfinished where its program has died; else how it ended.
    reason : str
        Why it ended or pauses.
    state : str
        Of the run as last noted, such as running or paused.
    step, step_kind : str
        Place and kind of the step of the protocol; empty while there is none.
    protocol_time : float
        Into the protocol, in s.
    duration : float or None
        Of the protocol; None where its text tells none. [s]
    set_points : mapping of str to float
        Of motor and drive while they are on, by quantity in SI.
    means : mapping of str to (float or None, str)
        Mean of each channel over the last second that was recorded with its unit, while the run records; None where
        it is no number.
    trips : tuple of str
        Limits that were exceeded.
    gaps : int
        Gaps that were noted.
    silence : float
        Time since anything was written, in s.
    """

    folder: Path
    known: RunFacts
    outcome: str
    reason: str
    state: str
    step: str
    step_kind: str
    protocol_time: float
    duration: float | None
    set_points: Mapping[str, float]
    means: Mapping[str, tuple[float | None, str]]
    trips: tuple[str, ...]
    gaps: int
    silence: float

    @property
    def is_running(self) -> bool:
        """Whether its program is at work."""
        return self.outcome == RUNNING

    @property
    def time_left(self) -> float | None:
        """Of the protocol, prompts and pauses excepted; None where it is not known. [s]"""
        return None if self.duration is None else max(self.duration - self.protocol_time, 0.0)


@dataclass(slots=True)
class _Progress:
    """State of a run by its notes up to now; time and sample are those of the last note with a time."""

    state: str = "preparing"
    reason: str = ""
    step: str = ""
    time: float = 0.0
    sample: int | None = None
    noted: float = 0.0  # s since 1970
    set_points: dict[str, float] = field(default_factory=dict)
    trips: list[str] = field(default_factory=list)
    gaps: int = 0

    def take(self, note: Note) -> None:
        """Update the state by a further note."""
        facts = note.facts
        at = _number(facts, "protocol_time")
        if at is not None:
            self.time, self.sample, self.noted = at, note.sample, note.time
        if "state" in facts:
            self.state, self.reason = str(facts["state"]), str(facts.get("reason") or self.reason)
            if self.state == "running":
                self.reason = ""
            else:
                self.set_points.clear()
        if note.kind == "trip":
            self.trips.append(str(facts.get("reason", "")))
        self.gaps += note.kind == "gap"
        self.step = str(facts.get("step", self.step))
        for name in _SET_POINTS.get(note.kind, ()):
            value = _number(facts, name)
            if value:
                self.set_points[name] = value
            else:
                self.set_points.pop(name, None)


class RunObserver:
    """Observer of one run, which reads what was added since it looked last and writes nothing.

    Parameters
    ----------
    folder : Path

    Raises
    ------
    InvalidInput
        If the folder holds no run, or its facts are damaged.

    Notes
    -----
    Blocks and documents that are being written are not whole and are left out until the next look. A lock is tried only
    where the run has written a document, thus has its lock: else it could be kept from taking it.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._known = read_run_facts(folder)
        self._documents: ReadDocuments | None = None
        self._events = 0
        self._progress = _Progress(noted=self._known.begun)
        self._points = _set_points(folder)
        self._times = [point.time for point in self._points]

    def look(self) -> Observation:
        """Run as it is now."""
        folder, now = self._folder, time.time()
        begins = not (folder / DOCUMENTS).is_file() and now - self._known.begun < _YOUNG
        is_alive = begins or is_locked(folder)  # before the documents, the last of which precedes the end of the lock
        self._documents = documents = read_documents(folder, earlier=self._documents)
        self._take_notes(documents)
        outcome, reason = (RUNNING if is_alive else UNFINISHED), self._progress.reason
        if documents.of("stop"):
            ended = run_summary(folder)
            outcome, reason = ended.outcome, ended.reason
        parts = main_parts(documents)
        latest = self._latest(parts[-1], documents) if parts and outcome == RUNNING else None
        told = self._progress
        at = self._time(latest and latest[1], now, is_running=outcome == RUNNING and told.state == "running")
        point = self._point(at)
        is_within = point is not None and outcome == RUNNING and told.state in ("running", "paused")
        return Observation(
            folder=folder,
            known=self._known,
            outcome=outcome,
            reason=reason,
            state=told.state,
            step=point.step if point is not None and is_within else told.step,
            step_kind=point.kind if point is not None and is_within else "",
            protocol_time=at,
            duration=self._times[-1] if self._times else None,
            set_points=self._present_set_points(point),
            means={} if latest is None else _means(*latest) | self._means_beside(documents),
            trips=tuple(told.trips),
            gaps=told.gaps,
            silence=max(now - _last_written(folder, documents), 0.0),
        )

    def _take_notes(self, documents: ReadDocuments) -> None:
        """Update the state by the notes that were added."""
        events = documents.of("event")
        for event in events[self._events :]:
            self._progress.take(note_of(event))
        self._events = len(events)

    def _latest(self, part: int, documents: ReadDocuments) -> tuple[RawPart, Block] | None:
        """Last samples of a part; None where it has ended, or nothing of it is whole."""
        described = {str(each.get("name")): str(each.get("uid")) for each in documents.of("descriptor")}
        uid = described[part_name(part)]
        if any(datum.get("descriptor") == uid for datum in documents.of("stream_datum")):
            return None
        try:
            found, block = latest_samples(raw_path(self._folder, part), duration=MEAN_DURATION)
        except InvalidInput:
            return None  # its header is being written
        return None if block is None else (found, block)

    def _means_beside(self, documents: ReadDocuments) -> dict[str, tuple[float | None, str]]:
        """Means of the channels of other clocks."""
        last = {clock: part for part, clock in sorted(part_clocks(documents).items())}
        found: dict[str, tuple[float | None, str]] = {}
        for number in last.values():
            latest = self._latest(number, documents)
            found |= {} if latest is None else _means(*latest)
        return found

    def _time(self, latest: Block | None, now: float, *, is_running: bool) -> float:
        """Time into the protocol: by the sample counter, else by the clock on the wall up to the next set point."""
        told = self._progress
        if latest is not None:
            return told.time + max(latest.next_sample - (told.sample or 0), 0) / latest.sample_rate
        if not is_running:
            return told.time
        following = (point.time for point in self._points if point.time > told.time and point.sets)
        return min(told.time + max(now - told.noted, 0.0), next(following, told.time))

    def _point(self, at: float) -> SetPoint | None:
        """Set point of the protocol that holds at a time; None after the last."""
        place = bisect_right(self._times, at + 1e-9) - 1
        return self._points[place] if 0 <= place < len(self._points) - 1 else None

    def _present_set_points(self, point: SetPoint | None) -> dict[str, float]:
        """Set points of motor and drive, with the sliding speed where the protocol states one."""
        found = dict(self._progress.set_points)
        if "rotation_speed" in found and point is not None and point.sliding_speed:
            found["sliding_speed"] = point.sliding_speed
        return found


def run_to_watch(folder: Path) -> Path:
    """Run of a folder that is being recorded: the folder itself, else the newest at work in it, else the newest.

    Parameters
    ----------
    folder : Path
        Of a run, or of runs.

    Returns
    -------
    Path

    Raises
    ------
    InvalidInput
        If there is none.
    """
    if (folder / RUN).is_file():
        return folder
    found = run_folders(folder)[::-1]
    if not found:
        raise InvalidInput(f"{folder}: holds no run; name a run, or a folder of runs")
    return next((each for each in found if (each / DOCUMENTS).is_file() and is_locked(each)), found[0])


def _set_points(folder: Path) -> Sequence[SetPoint]:
    """Set points of the protocol of a run; none where it has no protocol that can be read."""
    try:
        points = flattened(read_protocol(folder / PROTOCOL))
    except (SonolubeError, OSError):
        return ()
    return points if all(early.time <= late.time for early, late in pairwise(points)) else ()


def _means(part: RawPart, latest: Block) -> dict[str, tuple[float | None, str]]:
    """Mean of each channel with its unit."""
    means = [float(mean) for mean in latest.values.mean(axis=0)]
    return {
        channel.name: (mean if np.isfinite(mean) else None, channel.unit)
        for channel, mean in zip(part.channels, means, strict=True)
    }


def _last_written(folder: Path, documents: ReadDocuments) -> float:
    """Time at which a block or a document was written last, in s since 1970."""
    paths = (folder / RUN, folder / DOCUMENTS, *(raw_path(folder, part) for part in main_parts(documents)[-1:]))
    return max((path.stat().st_mtime for path in paths if path.is_file()), default=0.0)


def _number(facts: Mapping[str, object], name: str) -> float | None:
    """Finite number among facts; None where it is none."""
    value = facts.get(name)
    return float(value) if isinstance(value, int | float) and np.isfinite(value) else None
