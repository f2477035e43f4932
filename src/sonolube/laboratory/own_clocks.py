"""Acquisitions with clocks of their own, watched by threads; virtual ones as the time of their rig goes on.

A thread has its device from the first call to the last, so that one that hangs keeps no other waiting. A run takes
what was read, and looks for what is wrong, with every block of its own clock: a sample beyond a limit, an error, lost
samples or a block that is late by more than two seconds end the run with motor and drive off.
"""

import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from threading import Event as Signal, Lock, Thread
from typing import Any, Final, Protocol, cast

import numpy as np

from sonolube.errors import SonolubeError
from sonolube.laboratory import supervision
from sonolube.laboratory.block import BLOCK_DURATION, Block
from sonolube.laboratory.devices import (
    SILENT,
    Acquisition,
    DeviceError,
    Devices,
    Recorder,
    require_gapless,
    require_rate,
    require_whole,
)
from sonolube.laboratory.interlocks import Interlock, RunLimits, first_trip
from sonolube.laboratory.standing_rig import still_on
from sonolube.laboratory.states import Event, RunControl, RunEnded
from sonolube.laboratory.watching import RunWatcher, told
from sonolube.text.units import format_si

_CONNECTING: Final = 60.0  # s
_ENDING: Final = 10.0  # s, to stop and release a device
_POLL: Final = 0.1  # s
_MAX_WAITING: Final = 10_000  # blocks that nobody has taken


class VirtualAcquisition(Acquisition, Protocol):
    """Acquisition of a virtual rig beside the one that its time goes on with."""

    waiting: int
    """Samples that were taken and not read."""

    def follow(self, take: Callable[[], None]) -> None:
        """Call a function whenever samples were taken."""


class OwnClocks:
    """Acquisitions of a run beside the one whose clock is that of the protocol.

    Parameters
    ----------
    devices : Devices
    limits : RunLimits
        Of all channels; those of these acquisitions hold from the first sample to the last.
    watcher : RunWatcher, optional
        Shown every block.
    """

    def __init__(self, devices: Devices, limits: RunLimits, watcher: RunWatcher | None = None) -> None:
        now = devices.clock
        self._readers: list[_Reader] = []
        for clock, device in devices.further.items():
            own = [lock for lock in limits.locks if lock.channel.name in device.channels]
            own_off = [(what, lock) for what, lock in limits.off if lock.channel.name in device.channels]
            is_virtual = now is not None and hasattr(device, "follow")
            self._readers.append(
                _VirtualReader(clock, cast(VirtualAcquisition, device), own, own_off, watcher, cast(Any, now))
                if is_virtual
                else _Reader(clock, device, own, own_off, watcher)
            )

    def begin(self, end_if_asked: Callable[[], None]) -> None:
        """Connect all and start to sample.

        Parameters
        ----------
        end_if_asked : callable
            Raises where the run is to end meanwhile.

        Raises
        ------
        DeviceError
            If one does not start.
        """
        for reader in self._readers:
            reader.begin()
        latest = time.monotonic() + _CONNECTING
        for reader in self._readers:
            while not reader.has_started.wait(_POLL):
                end_if_asked()
                if time.monotonic() > latest:
                    raise DeviceError(f"{reader.device.name}: did not start within {format_si(_CONNECTING, 's')}")
        self.look()

    def look(self) -> None:
        """Raise where something is wrong with any.

        Raises
        ------
        RunEnded
            If a sample is beyond a limit.
        DeviceError
            If a device has failed, or a block is late.
        """
        for reader in self._readers:
            reader.look()

    def record(self, channels: Sequence[str]) -> None:
        """Record those of these channels that they have from now on."""
        for reader in self._readers:
            reader.record([name for name in channels if name in reader.device.channels])

    def keep(self, recorder: Recorder | None) -> None:
        """Record what was read meanwhile, where there is a record, and look."""
        if recorder is not None:
            for reader in self._readers:
                reader.keep(recorder)
        self.look()

    def end_recording(self, recorder: Recorder) -> None:
        """Record what was read last, and no more."""
        for reader in self._readers:
            reader.keep(recorder)
            reader.end_recording(recorder)

    def mean(self, channel: str) -> float | None:
        """Mean of a channel over the latest block, in SI; None where there is none."""
        found = (reader.mean(channel) for reader in self._readers if channel in reader.device.channels)
        return next(found, None)

    @contextmanager
    def watched(self, control: RunControl) -> Iterator[None]:
        """Watch over the clocks in a `with` block, while an operator works at the rig with motor and drive off.

        Parameters
        ----------
        control : RunControl
            Asked to end the run where something is wrong.

        Raises
        ------
        RunEnded, DeviceError
            As `look`, at the end of the block.
        """
        for reader in self._readers:
            reader.stands(control.stop)
        try:
            yield
        finally:
            for reader in self._readers:
                reader.stands(None)
        self.look()

    def end(self) -> None:
        """Stop and release all.

        Raises
        ------
        DeviceError
            Naming those that do not return.
        """
        for reader in self._readers:
            reader.has_ended.set()
        latest = time.monotonic() + _ENDING
        failures = list(filter(None, (reader.end(latest) for reader in self._readers)))
        if failures:
            raise DeviceError("; ".join(failures))


class _Reader:
    """One acquisition with its thread; what both threads use is held by the lock."""

    def __init__(
        self,
        clock: str,
        device: Acquisition,
        locks: Sequence[Interlock],
        off: Sequence[tuple[str, Interlock]],
        watcher: RunWatcher | None,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self.clock, self.device, self._watcher, self._now = clock, device, watcher, now
        self._locks, self._off = locks, off
        self._names = list(device.channels)
        self.has_started, self.has_ended = Signal(), Signal()
        self._thread = Thread(target=self._work, daemon=True, name=f"sonolube clock {clock}")
        self._held = Lock()
        self._failure: SonolubeError | None = None
        self._rate = self._due = 0.0
        self._latest: Block | None = None
        self._waiting: deque[tuple[Block, float]] = deque(maxlen=_MAX_WAITING)
        self._alarm: Callable[[str], None] | None = None
        self._stands_since = 0.0
        self._recorded: list[str] = []
        self._is_begun = False  # in the record

    def begin(self) -> None:
        """Start the thread."""
        self._thread.start()

    def look(self) -> None:
        """Raise the failure of the thread, or one for a late block."""
        with self._held:
            failure, is_late = self._failure, self._rate > 0 and self._now() > self._due
        if failure is not None:
            raise failure
        if is_late:
            raise DeviceError(f"{self.device.name}: a block is late by more than {format_si(supervision.LATE, 's')}")

    def stands(self, alarm: Callable[[str], None] | None) -> None:
        """Set the function that takes alarms while motor and drive are off; None when they may be on again."""
        with self._held:
            self._alarm, self._stands_since = alarm, self._now()
            failure = self._failure
        if alarm is not None and failure is not None:
            alarm(str(failure))

    def record(self, channels: list[str]) -> None:
        """Record channels from now on."""
        with self._held:
            self._waiting.clear()
            self._recorded = channels

    def keep(self, recorder: Recorder) -> None:
        """Record the blocks that were read meanwhile."""
        columns = [self._names.index(name) for name in self._recorded]
        while columns and (taken := self._next_waiting()) is not None:
            block, arrived = taken
            if not self._is_begun:
                recorder.begin_beside(
                    self.clock,
                    [self.device.channels[name] for name in self._recorded],
                    sample_rate=block.sample_rate,
                    first=block.first_sample,
                    **self._beginning(block, arrived),
                )
                self._is_begun = True
            values = block.values[:, columns]
            kept = Block(first_sample=block.first_sample, sample_rate=block.sample_rate, values=values)
            recorder.append(kept, clock=self.clock)

    def _beginning(self, block: Block, arrived: float) -> dict[str, float]:
        """Time since the first sample of a block that came at a time, and its uncertainty, in s."""
        lasts = block.samples / block.sample_rate
        since = self._now() - arrived + lasts - 1 / block.sample_rate
        return {"ago": since, "uncertainty": lasts + BLOCK_DURATION}

    def end_recording(self, recorder: Recorder) -> None:
        """Record no more; that nothing was recorded is noted."""
        if self._recorded and not self._is_begun:
            recorder.note(SILENT, clock=self.clock, channels=", ".join(self._recorded))
        self.record([])
        if self._is_begun:
            self._is_begun = False
            recorder.end(clock=self.clock)

    def mean(self, channel: str) -> float | None:
        """Mean of a channel over the latest block."""
        with self._held:
            latest = self._latest
        return None if latest is None else float(np.mean(latest.values[:, self._names.index(channel)]))

    def end(self, latest: float) -> str:
        """Wait for the thread until a time, and return what does not return."""
        if self._thread.ident is None:
            return ""
        self._thread.join(max(latest - time.monotonic(), 0.0))
        return f"{self.device.name}: did not return" if self._thread.is_alive() else ""

    def _next_waiting(self) -> tuple[Block, float] | None:
        """Oldest block that was not taken, and when it came."""
        with self._held:
            return self._waiting.popleft() if self._waiting else None

    def _work(self) -> None:
        """Thread: connect, read until the end, and release, whatever happens."""
        try:
            self.device.connect()
            self._read()
        except SonolubeError as failure:
            self._fails(failure)
        except BaseException as failure:  # whatever a driver raises ends the run
            self._fails(DeviceError(f"{self.device.name}: {type(failure).__name__}: {failure}"))
        finally:
            self.has_started.set()
            for release in (self.device.stop, self.device.close):
                with suppress(Exception):  # as above; the other must be called
                    release()

    def _fails(self, failure: SonolubeError) -> None:
        """Keep a failure, and raise the alarm."""
        with self._held:
            self._failure, alarm = failure, self._alarm
        if alarm is not None:
            alarm(str(failure))

    def _read(self) -> None:
        """Read block after block."""
        wanted = next(iter(self.device.channels.values())).sample_rate
        assert wanted is not None
        began = time.monotonic()
        rate = require_rate(float(self.device.start(self._names, sample_rate=wanted)), wanted, device=self.device.name)
        count, taken = max(1, round(BLOCK_DURATION * rate)), 0
        while not self.has_ended.is_set():
            allowed = supervision.LATE + supervision.CLOCK_ERROR * (time.monotonic() - began)
            with self._held:
                self._rate, self._due = rate, began + (taken + count) / rate + allowed
            self.has_started.set()
            block = self.device.read(count)
            require_whole(block, samples=count, channels=len(self._names), sample_rate=rate, device=self.device.name)
            require_gapless(block, taken, device=self.device.name)
            taken = block.next_sample
            self._take(block)
        with self._held:
            self._rate = 0.0  # no block is due any more

    def _take(self, block: Block) -> None:
        """Hold a block to the limits, and keep it for the run."""
        told(self._watcher, lambda watcher: watcher.takes_aside(self._names, block))
        if trip := first_trip(block, self._names, self._locks):
            raise RunEnded(Event.TRIP, trip)
        with self._held:
            self._latest = block
            if self._recorded:
                self._waiting.append((block, self._now()))
            stood = self._now() - self._stands_since if self._alarm is not None else 0.0
        if on := still_on(block, self._names, self._off, stood):
            raise RunEnded(Event.TRIP, on)


class _VirtualReader(_Reader):
    """One virtual acquisition, read as the time of its rig goes on: the same blocks in every run, and none is late."""

    device: VirtualAcquisition

    def __init__(
        self,
        clock: str,
        device: VirtualAcquisition,
        locks: Sequence[Interlock],
        off: Sequence[tuple[str, Interlock]],
        watcher: RunWatcher | None,
        now: Callable[[], float],
    ) -> None:
        super().__init__(clock, device, locks, off, watcher, now)
        self._count, self._taken, self._epoch, self._recorded_from = 1, 0, 0.0, 0.0

    def begin(self) -> None:
        """Connect, and start to sample."""
        wanted = next(iter(self.device.channels.values())).sample_rate
        assert wanted is not None
        try:
            self.device.connect()
            rate = float(self.device.start(self._names, sample_rate=wanted))
            self._count = max(1, round(BLOCK_DURATION * require_rate(rate, wanted, device=self.device.name)))
            self._epoch, self._taken = self._now(), 0
            self.device.follow(self._catch_up)
        except SonolubeError as failure:
            self._fails(failure)
        self.has_started.set()

    def record(self, channels: list[str]) -> None:
        """Record channels from now on."""
        super().record(channels)
        self._recorded_from = self._now()

    def end(self, latest: float) -> str:
        """Stop and release the device."""
        for release in (self.device.stop, self.device.close):
            with suppress(Exception):  # as those of a thread
                release()
        return ""

    def _beginning(self, block: Block, arrived: float) -> dict[str, float]:
        """Time of the first sample of a block after that of the run, exact on the one clock of the rig."""
        offset = self._epoch + block.start - self._recorded_from
        return {"ago": self._now() - self._epoch - block.start, "uncertainty": 1 / block.sample_rate, "offset": offset}

    def _catch_up(self) -> None:
        """Read the blocks that are whole."""
        try:
            while self._failure is None and self.device.waiting >= self._count:
                block = self.device.read(self._count)
                require_gapless(block, self._taken, device=self.device.name)
                self._taken = block.next_sample
                self._take(block)
        except SonolubeError as failure:
            self._fails(failure)
