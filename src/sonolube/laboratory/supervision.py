"""Supervision of devices by a clock of its own: motor and drive are switched off where a run is late.

Calls to devices are made by a thread of theirs, so that a run ends although a call does not return. A second thread
looks at the clock: where no block was read in time, or a call lasts too long, it switches the outputs off by calls that
wait for no other, and the run then ends with that reason. What hangs stays behind in its thread.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from functools import partial
from math import inf
from queue import SimpleQueue
from threading import Condition, Event, Thread
from typing import Any, Final

from sonolube.errors import SonolubeError
from sonolube.laboratory.block import Block
from sonolube.laboratory.devices import (
    Acquisition,
    DeviceError,
    Devices,
    DriveSetting,
    DriveSource,
    Motor,
    fault_of,
    require_rate,
    require_whole,
)
from sonolube.text.units import format_si

LATE: Final = 2.0
"""Time by which a block may be late before motor and drive are switched off. [s]"""

CLOCK_ERROR: Final = 2e-4
"""Difference of the clocks of device and computer that counts as no delay, over the time since the start. []"""

_LOOK: Final = 0.1  # s, between two looks at the clock
_SWITCHING: Final = 10.0  # s, for a device that switches off, stops or closes
_SWITCHING_APART: Final = 30.0  # s, where a process of its own does that, which may have to begin anew
_RETURNING: Final = 10.0  # s, for a setting that was late, before the outputs count as not under control
_CONNECTING: Final = 60.0  # s
_PACE: Final = 0.05  # s, time of a block before the first one was read


class Late(DeviceError):
    """A block or a call that has not come in time; motor and drive were switched off."""


@dataclass(slots=True)
class _Call:
    """A call to a device, and its answers: a value and None, or an error."""

    what: str
    function: Callable[[], Any]
    may_switch_on: bool = False
    answers: "SimpleQueue[tuple[Any, BaseException | None]]" = field(default_factory=SimpleQueue)
    has_returned: Event = field(default_factory=Event)

    def make(self) -> None:
        """Make the call and keep its answer."""
        answer: tuple[Any, BaseException | None]
        try:
            answer = self.function(), None
        except BaseException as failure:  # whatever a driver raises belongs to who has asked
            answer = None, failure
        self.has_returned.set()
        self.answers.put(answer)

    def answer(self) -> Any:
        """Answer of the call; raises what it has raised, as a DeviceError where it is of no kind of sonolube's."""
        value, failure = self.answers.get()
        if isinstance(failure, SonolubeError):
            raise failure
        if failure is not None:
            raise DeviceError(fault_of(self.what, failure))
        return value


class Supervisor:
    """Clock over the devices of one run.

    Parameters
    ----------
    devices : Devices
        The time of virtual ones is that of their own clock.
    """

    def __init__(self, devices: Devices) -> None:
        self._hardware, self._guard = devices, devices.guard
        self._switching = _SWITCHING if devices.switch_off is None else _SWITCHING_APART
        self.devices = replace(
            devices,
            acquisition=_SupervisedAcquisition(devices.acquisition, self),
            drive=_SupervisedDrive(devices.drive, self),
            motor=_SupervisedMotor(devices.motor, self),
            guard=None,
        )
        self._changed = Condition()
        self._calls: SimpleQueue[_Call | None] = SimpleQueue()
        self._waiting: _Call | None = None
        self._at_work: _Call | None = None
        self._overdue: _Call | None = None
        self._deadline, self._expected = inf, ""
        self._on: set[object] = set()
        self._has_ended = False
        self._not_off: list[str] = []
        self.pace = _PACE
        self.reason = ""

    @contextmanager
    def at_work(self) -> Iterator[None]:
        """Watch the clock inside a `with` block."""
        for work in (self._make_calls, self._watch):
            Thread(target=work, daemon=True, name="sonolube devices").start()
        try:
            yield
        finally:
            with self._changed:
                self._has_ended = True
                self._changed.notify_all()
            self._calls.put(None)

    def now(self) -> float:
        """Time of the clock. [s]"""
        return time.monotonic() if self._hardware.clock is None else self._hardware.clock()

    def call(
        self, what: str, function: Callable[[], Any], *, limit: float, otherwise: str = "", may_switch_on: bool = False
    ) -> Any:
        """Answer of a call to a device."""
        call = _Call(what, function, may_switch_on)
        missed = otherwise or f"{what} did not return within {format_si(limit, 's', digits=3)}"
        with self._changed:
            if self.reason:
                raise Late(self.reason)
            self._waiting = call
            latest = self._expect(limit, missed)
        self._calls.put(call)
        try:
            value = call.answer()
        finally:
            with self._changed:
                self._waiting = None
                rest = self.pace + LATE
                self._expect(
                    rest if self._on else inf, f"the program read no block for {format_si(rest, 's', digits=3)}"
                )
        if self.now() > latest:
            self._end_late(missed)
            raise Late(self.reason)
        return value

    def release(self, what: str, function: Callable[[], Any]) -> None:
        """Call what switches off or releases, in a thread of its own where the run was late."""
        if not self.reason:
            self.call(what, function, limit=self._switching)
            return
        (failure,) = all_within(self._switching, [(what, function)])
        if failure:
            raise DeviceError(failure)

    def turns_on(self, output: object) -> None:
        """Record that a device is on, and enable the outputs by the guard."""
        if self._guard is not None and not self._on:
            enable = f"{self._guard.name}: enable"
            self.call(enable, self._guard.enable, limit=self.pace + LATE, may_switch_on=True)
        self._on.add(output)

    def is_off(self, output: object) -> None:
        """Record that a device is off; where all are, no block is expected and the guard disables the outputs."""
        was_on = bool(self._on)
        self._on.discard(output)
        if self._on or self.reason:
            return
        with self._changed:
            self._expect(inf, "")
        if self._guard is not None and was_on:
            self.release(f"{self._guard.name}: disable", self._guard.disable)

    def renew(self) -> None:
        """Renew the watchdog of the guard, and look whether what has the outputs is alive."""
        if self._hardware.switch_off is not None:
            self._hardware.switch_off.watch()
        if self._guard is not None and self._on:
            self.call(f"{self._guard.name}: renew", self._guard.renew, limit=self.pace + LATE)

    def connect_guard(self) -> None:
        """Connect the guard, with the outputs disabled."""
        if self._guard is not None:
            self.call(f"{self._guard.name}: connect", self._guard.connect, limit=_CONNECTING)

    def close_guard(self) -> None:
        """Disable the outputs and release the guard."""
        if self._guard is not None:
            self.release(f"{self._guard.name}: close", self._guard.close)

    @property
    def has_halted(self) -> bool:
        """Whether the outputs were switched off because the run was late, and have confirmed it."""
        return bool(self.reason) and not self._not_off

    def halt(self) -> list[str]:
        """Switch the outputs off by calls that wait for no other; returns what failed, and never raises."""
        outputs = (self._hardware.drive, self._hardware.motor)
        first = [] if self._guard is None else [(f"{self._guard.name}: disable", self._guard.disable)]
        calls = [(f"{each.name}: off", getattr(each, "halt", each.off)) for each in outputs]
        return list(filter(None, all_within(self._switching, [*first, *calls])))

    def settle(self) -> list[str]:
        """After a call that was late: wait for it, switch off anew, and return what failed or may still switch on."""
        if self._overdue is None:
            return []
        if self._overdue.has_returned.wait(_RETURNING):
            self._not_off = self.halt()
            return self._not_off
        if self._guard is not None and not self._overdue.what.startswith(self._guard.name) and not self._not_off:
            return []  # hardware holds the outputs off, whatever is set
        return [f"{self._overdue.what} has not returned, and may switch on when it does"]

    def _expect(self, within: float, otherwise: str) -> float:
        """Expect a sign of life within a time, and return when that ends; the lock is held."""
        self._deadline, self._expected = self.now() + within, otherwise
        return self._deadline

    def _make_calls(self) -> None:
        """Thread of the devices: make calls in the order in which they were asked for."""
        while (call := self._calls.get()) is not None:
            if self.reason:
                call.answers.put((None, Late(self.reason)))
                continue
            self._at_work = call
            call.make()

    def _watch(self) -> None:
        """Thread of the clock: wait until a sign of life is overdue."""
        with self._changed:
            while not self._has_ended:
                if self.now() > self._deadline:
                    break
                self._changed.wait(_LOOK)
            else:
                return
        self._end_late(self._expected)

    def _end_late(self, missed: str) -> None:
        """Switch off because a sign of life has not come, and wake who waits for an answer."""
        with self._changed:
            if self.reason or self._has_ended:
                return
            self.reason = f"{missed}; the supervisor has told motor and drive to switch off"
            call = self._at_work
            if call is not None and call.may_switch_on and not call.has_returned.is_set():
                self._overdue = call
        self._not_off = self.halt()
        with self._changed:
            if self._waiting is not None:
                self._waiting.answers.put((None, Late(self.reason)))


class _Supervised:
    """A device whose calls are supervised."""

    def __init__(self, device: Any, supervisor: Supervisor) -> None:
        self._device, self._supervisor = device, supervisor
        self.name: str = device.name

    def connect(self) -> None:
        """Connect the device."""
        self._supervisor.call(f"{self.name}: connect", self._device.connect, limit=_CONNECTING)

    def close(self) -> None:
        """Release the device."""
        self._supervisor.release(f"{self.name}: close", self._device.close)


class _SupervisedAcquisition(_Supervised):
    """Analogue inputs whose blocks must come in time."""

    def __init__(self, device: Acquisition, supervisor: Supervisor) -> None:
        super().__init__(device, supervisor)
        self.channels = device.channels
        self._rate, self._count, self._began, self._samples = 0.0, 0, 0.0, 0

    def connect(self) -> None:
        """Connect the inputs, then the guard, before any output."""
        super().connect()
        self._supervisor.connect_guard()

    def start(self, channels: Sequence[str], *, sample_rate: float) -> float:
        """Start to sample."""
        start = partial(self._device.start, channels, sample_rate=sample_rate)
        given = float(self._supervisor.call(f"{self.name}: start", start, limit=_SWITCHING))
        self._rate, self._count = require_rate(given, sample_rate, device=self.name), len(channels)
        self._began, self._samples = self._supervisor.now(), 0
        return self._rate

    def read(self, samples: int) -> Block:
        """Next samples, late by two seconds at most since the start."""
        lasts = samples / self._rate if self._rate else 0.0
        self._samples += samples
        self._supervisor.pace = lasts
        now = self._supervisor.now()
        due = self._began + self._samples / self._rate - now if self._rate else 0.0
        allowed = LATE + CLOCK_ERROR * (now - self._began)
        block: Block = self._supervisor.call(
            f"{self.name}: read",
            partial(self._device.read, samples),
            limit=min(due, lasts) + allowed,
            otherwise=f"{self.name}: a block is late by more than {format_si(LATE, 's')}",
        )
        require_whole(block, samples=samples, channels=self._count, sample_rate=self._rate, device=self.name)
        self._supervisor.renew()
        return block

    def stop(self) -> None:
        """Stop to sample."""
        self._supervisor.release(f"{self.name}: stop", self._device.stop)

    def close(self) -> None:
        """Release the inputs, and the guard after all outputs."""
        with suppress(DeviceError):
            self._supervisor.close_guard()
        super().close()


class _SupervisedOutput(_Supervised):
    """Output that is set in time, and off."""

    def off(self) -> None:
        """Switch the output off, unless the supervisor has done that."""
        if not self._supervisor.has_halted:
            self._supervisor.release(f"{self.name}: off", self._device.off)
        self._supervisor.is_off(self)

    def _set(self, what: str, function: Callable[[], None]) -> None:
        """Set the output."""
        self._supervisor.turns_on(self)
        latest = self._supervisor.pace + LATE
        self._supervisor.call(f"{self.name}: {what}", function, limit=latest, may_switch_on=True)


class _SupervisedDrive(_SupervisedOutput):
    """Source of the drive voltage."""

    def __init__(self, device: DriveSource, supervisor: Supervisor) -> None:
        super().__init__(device, supervisor)
        self.voltage_maximum = device.voltage_maximum

    def drive(self, setting: DriveSetting) -> None:
        """Set the output."""
        self._set("drive", partial(self._device.drive, setting))

    def read_back(self) -> str:
        """Answers of the source on its output; empty where it tells nothing."""
        ask = getattr(self._device, "read_back", None)
        if ask is None:
            return ""
        return str(self._supervisor.call(f"{self.name}: read back", ask, limit=self._supervisor.pace + LATE))


class _SupervisedMotor(_SupervisedOutput):
    """Motor of the disc."""

    def __init__(self, device: Motor, supervisor: Supervisor) -> None:
        super().__init__(device, supervisor)
        self.rotation_speed_maximum = device.rotation_speed_maximum

    def turn(self, rotation_speed: float) -> None:
        """Set the speed of the disc."""
        self._set("turn", partial(self._device.turn, rotation_speed))
        if rotation_speed == 0:
            self._supervisor.is_off(self)


def all_within(limit: float, calls: Sequence[tuple[str, Callable[[], Any]]]) -> list[str]:
    """Make calls at the same time, each in a thread of its own, and say of each why it failed; empty where it did not.

    `calls`: what each is, such as "motor: off", and the function; `limit`: time in which it has to return. [s]
    """
    made = [_Call(what, function) for what, function in calls]
    threads = [Thread(target=call.make, daemon=True, name="sonolube off") for call in made]
    for thread in threads:
        thread.start()
    latest = time.monotonic() + limit
    failures = []
    for thread, call in zip(threads, made, strict=True):
        thread.join(max(latest - time.monotonic(), 0.0))
        if thread.is_alive():
            failures.append(f"{call.what} did not return within {format_si(limit, 's')}")
            continue
        failure = call.answers.get()[1]
        failures.append("" if failure is None else fault_of(call.what, failure))
    return failures
