"""Live state of a run: the range and mean of each channel in slices of at most 40 ms, limits, prompts and events.

The thread of the run only appends its blocks to a queue of bounded length; another reduces them.
"""

from collections import deque
from collections.abc import Mapping, Sequence
from itertools import islice
from math import ceil
from pathlib import Path
from threading import Event as Signal, Lock, Thread
from typing import Any, Final

import numpy as np

from sonolube.facts.protocol import Prompt, SetPoint
from sonolube.laboratory import Block, Channel, Interlock, RunControl
from sonolube.text.units import format_si

SLICE_DURATION: Final = 0.04
"""Longest time of one slice. [s]"""

_KEPT: Final = 2400  # slices, the last minute
_AT_ONCE: Final = 300  # slices of one frame, which keeps the thread of the run waiting while it is written
_WAITING: Final = 64  # blocks that were not yet reduced
_MAX_SLICES: Final = 64  # of one block
_POLL: Final = 0.02  # s
_LAST: Final = 50  # looks at the blocks that wait at the end
_ASKED: Final = 0.1  # s, between two looks at requests to end while an operator is asked
_TRIPS: Final = 20

Slice = tuple[int, float, dict[str, tuple[float, float, float]]]
"""Number, time in s, and lowest, highest and mean value of each channel."""


class LiveRun:
    """State of a run that is at work, as its watcher and as its operator.

    Parameters
    ----------
    about : mapping of str to object
        What the run is of.
    control : RunControl
    """

    def __init__(self, about: Mapping[str, Any], control: RunControl) -> None:
        self._about, self._control = dict(about), control
        self._waiting: deque[tuple[tuple[str, ...], Block, float | None]] = deque(maxlen=_WAITING)
        self._slices: deque[Slice] = deque(maxlen=_KEPT)
        self._held, self._next = Lock(), 0
        self._locks: list[Interlock] = []
        self._units: dict[str, str] = {}
        self._extremes: dict[str, float] = {}
        self._rests: dict[str, float] = {}
        self._point: SetPoint | None = None
        self._state, self._outcome, self._reason, self._doing, self._outputs = "preparing", "", "", "", ""
        self._time, self._trips = 0.0, list[str]()
        self._prompt: Prompt | None = None
        self._asked = 0  # prompts until now, which number them: two may have the same text
        self._answer: bool | None = None
        self._folder = Path()
        self.has_ended = Signal()
        Thread(target=self._reduce, daemon=True, name="sonolube live").start()

    def records(self, folder: Path) -> None:
        """Take the folder of the record."""
        self._folder = folder

    def begins(self, channels: Mapping[str, Channel], locks: Sequence[Interlock]) -> None:
        """Take channels and limits."""
        self._units = {name: channel.unit for name, channel in channels.items()}
        self._locks = list(locks)

    def reaches(self, point: SetPoint) -> None:
        """Take the set point that is to hold."""
        self._point = point
        self._time = point.time

    def takes(self, names: Sequence[str], block: Block, *, time: float) -> None:
        """Take a block."""
        self._waiting.append((tuple(names), block, time))
        self._time = time + block.samples / block.sample_rate

    def takes_aside(self, names: Sequence[str], block: Block) -> None:
        """Take a block of another clock at the present time; while the rig stands, for the limits alone."""
        time = self._time - block.samples / block.sample_rate if self._state == "running" else None
        self._waiting.append((tuple(names), block, time))

    def notes(self, kind: str, facts: Mapping[str, str | float]) -> None:
        """Take an event."""
        if "state" in facts:
            self._state = str(facts["state"])
            self._reason = str(facts.get("reason", "")) if self._state != "running" else ""
            if self._state != "running":
                self._doing = self._reason
        self._outputs = str(facts.get("outputs", self._outputs))
        if kind == "trip":
            self._trips = [*self._trips, str(facts.get("reason", ""))][-_TRIPS:]

    def progress(self, stage: str, done: int, total: int) -> None:
        """Take the progress of the task."""
        del done, total
        self._doing = stage.removeprefix("running: ")

    def ask(self, prompt: Prompt) -> bool:
        """Wait until a prompt is confirmed or denied on a page, or the run is to end."""
        self._asked += 1
        self._answer, self._prompt = None, prompt
        wait = Signal()
        while self._answer is None and not self._control.stop_reason:
            wait.wait(_ASKED)
        self._prompt = None
        return bool(self._answer)

    def answer(self, number: int, *, is_done: bool) -> str:
        """Answer the present prompt, and return why that is refused; empty where it is not."""
        if self._prompt is None:
            return "nothing is asked now"
        if number != self._asked:
            return "another prompt is shown now; read it, and confirm that"
        self._answer = is_done
        return ""

    def end(self, state: str, outcome: str, reason: str) -> None:
        """Take the end of the run, its last blocks reduced."""
        wait = Signal()
        for _ in range(_LAST):
            if self._waiting:
                wait.wait(_POLL)
        self._state, self._outcome, self._reason = state, outcome, reason
        self._prompt = None
        self.has_ended.set()

    def status(self) -> dict[str, Any]:
        """State of the run as an object for JSON."""
        point, prompt = self._point, self._prompt
        return self._about | {
            "state": self._state,
            "outcome": self._outcome,
            "reason": self._reason,
            "outputs": self._outputs,
            "folder": self._folder.name,
            "step": "" if point is None else point.step,
            "kind": "" if point is None else point.kind,
            "doing": self._doing,
            "time": self._time,
            "prompt": None if prompt is None else {"number": self._asked, "task": prompt.task, "text": prompt.text},
            "trips": list(self._trips),
            "is_paused": self._state == "paused" or self._control.is_paused,
            "is_stopping": bool(self._control.stop_reason) or self._state == "stopping",
            "is_ended": self.has_ended.is_set(),
            "is_lost": False,
        }

    def frame(self, after: int) -> tuple[dict[str, Any], int]:
        """State with the next slices behind a number, and the number of the last of them."""
        with self._held:
            first = self._slices[0][0] if self._slices else self._next
            begin = max(after + 1 - first, 0)
            new = list(islice(self._slices, begin, begin + _AT_ONCE))
            last = new[-1][0] if new else self._next - 1
        channels: dict[str, list[list[float]]] = {}
        for _, time, values in new:
            for name, (low, high, mean) in values.items():
                channels.setdefault(name, []).append([time, low, high, mean])
        more = {
            "channels": channels,
            "units": {name: self._units.get(name, "") for name in channels},
            "limits": self._limits(),
            "dropped": max(first - after - 1, 0) if after >= 0 else 0,
        }
        return self.status() | more, last

    def _limits(self) -> list[dict[str, Any]]:
        """Limits with how near they are: the way from rest to the limit, the temperature's from its first reading."""
        found = []
        for lock in self._locks:
            channel, value = lock.channel, self._extremes.get(lock.channel.name)
            rest = self._rests.get(channel.name, 0.0)
            share = None if value is None or lock.limit == rest else (value - rest) / (lock.limit - rest)
            told = {"label": channel.name.replace("_", " "), "unit": channel.unit, "value": value, "limit": lock.limit}
            found.append(told | {"share": share, "text": format_si(lock.limit, channel.unit)})
        self._add_set_voltage(found)
        return found

    def _add_set_voltage(self, found: list[dict[str, Any]]) -> None:
        """Put the voltage that is set in place of a lower one that was measured, as by samples too far apart."""
        limit = self._about.get("voltage_maximum")
        if not limit or self._point is None or self._state != "running":
            return
        value = self._point.voltage_maximum
        measured = next((each for each in found if each["label"] == "voltage"), None)
        if measured is None:
            measured = {"label": "voltage", "unit": "V", "value": value, "limit": limit, "text": format_si(limit, "V")}
            found.append(measured)
        value = max(value, measured["value"] or 0.0)
        measured.update(value=value, share=value / measured["limit"])

    def _reduce(self) -> None:
        """Reduce the blocks that wait, until the end of the process."""
        wait = Signal()
        while True:
            while self._waiting:
                self._take_slices(*self._waiting.popleft())
            wait.wait(_POLL)

    def _take_slices(self, names: tuple[str, ...], block: Block, time: float | None) -> None:
        """Take the slices of a block, and what of it is the nearest to the limits."""
        found = [] if time is None else slices_of(names, block, time=time)
        values = {name: block.values[:, place] for place, name in enumerate(names)}
        for lock in self._locks:
            samples = values.get(lock.channel.name)
            if samples is not None and samples.size:
                self._extremes[lock.channel.name] = float(np.max(np.abs(samples)))
                if lock.channel.quantity == "temperature":
                    self._rests.setdefault(lock.channel.name, float(samples[0]))
        with self._held:
            for at, ranges in found:
                self._slices.append((self._next, at, ranges))
                self._next += 1


def slices_of(
    names: Sequence[str], block: Block, *, time: float
) -> list[tuple[float, dict[str, tuple[float, float, float]]]]:
    """Slices of a block in equal parts of at most 40 ms: middle, and lowest, highest and mean value of each channel."""
    if not block.samples:
        return []
    lasts = block.samples / block.sample_rate
    count = min(max(ceil(lasts / SLICE_DURATION - 1e-9), 1), block.samples, _MAX_SLICES)
    begins = np.arange(count) * block.samples // count
    sizes = np.diff([*begins, block.samples])
    low, high = (each.reduceat(block.values, begins, axis=0) for each in (np.minimum, np.maximum))
    mean = np.add.reduceat(block.values, begins, axis=0) / sizes[:, np.newaxis]
    middles = time + (begins + sizes / 2) / block.sample_rate
    return [
        (
            float(middles[place]),
            {
                name: (float(low[place, at]), float(high[place, at]), float(mean[place, at]))
                for at, name in enumerate(names)
            },
        )
        for place in range(count)
    ]
