"""Messages between the program of a run and its switch-off process: an object of JSON a line, both ways, and beats."""

import json
import os
import time
from collections.abc import Callable, Mapping
from threading import Event, Lock, Thread
from typing import Any, Final

BEAT: Final = 0.25
"""Time between two beats. [s]"""

SILENT: Final = 5.0
"""Time without a beat after which the other side counts as gone. [s]"""

OUTPUTS: Final = ("guard", "drive", "motor")
"""Devices that the switch-off process has, in the order in which they are switched off."""

SETTINGS: Final = ("connect", "drive", "turn", "enable", "renew", "read_back")
"""Calls that may lead to an output that is on; all others lead to one that is off."""

Message = Mapping[str, Any]


class Link:
    """Both directions between two processes.

    Parameters
    ----------
    incoming, outgoing : int
        Handles of files.
    """

    def __init__(self, incoming: int, outgoing: int) -> None:
        self.incoming, self.outgoing = incoming, outgoing
        self._lock, self._closed, self.has_ended = Lock(), Event(), Event()
        self._heard = time.monotonic()

    @property
    def silence(self) -> float:
        """Time since anything was heard. [s]"""
        return time.monotonic() - self._heard

    def send(self, **message: Any) -> None:
        """Send a message; one that nobody hears is dropped, for its sender hears no answer."""
        line = json.dumps(message).encode() + b"\n"
        with self._lock:
            if self._closed.is_set():
                return
            try:
                while line:
                    line = line[os.write(self.outgoing, line) :]
            except OSError:
                self._closed.set()

    def listen(self, take: Callable[[Message], object], ended: Callable[[], object]) -> None:
        """Take the messages that come, but for beats, by a thread of its own, until the other side ends."""
        Thread(target=self._listen, args=(take, ended), daemon=True, name="sonolube switch-off").start()

    def beat(self) -> None:
        """Beat by a thread of its own until the other side ends, or this one closes."""
        Thread(target=self._beat, daemon=True, name="sonolube beat").start()

    def close(self) -> None:
        """Send nothing more, not even a beat: the handle may be another file's after this."""
        with self._lock:
            self._closed.set()

    def _listen(self, take: Callable[[Message], object], ended: Callable[[], object]) -> None:
        rest = b""
        while True:
            try:
                heard = os.read(self.incoming, 1 << 16)
            except OSError:
                heard = b""
            if not heard:
                break
            self._heard = time.monotonic()
            *lines, rest = (rest + heard).split(b"\n")
            for message in map(_content, lines):
                if message:
                    take(message)
        self.has_ended.set()
        ended()

    def _beat(self) -> None:
        while not self._closed.wait(BEAT):
            self.send()


def _content(line: bytes) -> Message:
    """Message of a line; none of one whose first part went to a program that is no more."""
    try:
        found = json.loads(line)
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}
