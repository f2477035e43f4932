"""The switch-off process as the program of a run sees it: its devices, and whether it is alive."""

import os
import subprocess
import sys
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import RLock
from typing import Any, Final

from sonolube.errors import InvalidInput
from sonolube.laboratory.devices import DeviceError, DeviceLost, Devices, DriveSetting
from sonolube.laboratory.drivers.device_map import DeviceMap, missing_parts, read_device_map
from sonolube.laboratory.switch_off.messages import OUTPUTS, SETTINGS, SILENT, Link, Message
from sonolube.laboratory.verdict import Verdict
from sonolube.operating_system import ON_WINDOWS, process_start

_STARTING: Final = 30.0  # s
_ANSWERING: Final = 90.0  # s, longer than any call may last
_ENDING: Final = 12.0  # s, for the release of all outputs
_DYING: Final = 2.0  # s, of a process that was killed
_LOOK: Final = 0.1  # s

_MODULE: Final = "sonolube.laboratory.switch_off.process"


class SwitchOffProcess:
    """Process that has guard, drive and motor of a run.

    Parameters
    ----------
    files : mapping of str to str
        Texts of the device map and of what it names, the map first.
    """

    def __init__(self, files: Mapping[str, str]) -> None:
        self.folder: Path | None = None
        """Record of the run, which the process closes where the program of the run cannot."""
        self._files = dict(files)
        self._lock = RLock()
        self._process: subprocess.Popen[bytes] | None = None
        self._link: Link | None = None
        self._open: dict[int, SimpleQueue[Message]] = {}
        self._first: SimpleQueue[Message] = SimpleQueue()
        self._number = 0
        self._fault = ""
        self._not_off: dict[str, str] | None = None  # by output what failed when the outputs were taken over

    def begin(self) -> None:
        """Start the process, before any device is connected.

        Raises
        ------
        DeviceLost
            If it does not start.
        """
        self.end()
        self._start()

    def tell(self, verdict: Verdict) -> None:
        """Have the process keep the verdict of a run whose record is not closed yet."""
        if self._link is not None:
            self._link.send(outputs=verdict.outputs.value, basis=verdict.basis)

    def end(self) -> None:
        """End the process, its devices released; harmless where none runs."""
        with self._lock:
            process, link = self._process, self._link
            self._process, self._link, self._fault, self._not_off = None, None, "", None
        if process is not None and link is not None:
            link.send(end=True)
            link.close()
            with suppress(subprocess.TimeoutExpired):
                process.wait(_ENDING)
            _end(process, link)

    def watch(self) -> None:
        """Raise DeviceLost where the process has ended or gives no sign of life."""
        link = self._link
        if link is not None and not self._fault and link.silence > SILENT:
            self._lose(f"the switch-off process has given no sign of life for {SILENT:g} s")
        if self._fault:
            raise DeviceLost(self._fault)

    def call(self, output: str, method: str, *arguments: Any) -> Any:
        """Have the process make a call to one of its devices, and return what that returns.

        Raises
        ------
        DeviceError
            As the device has raised it; also where a call did not return and the process has switched off instead.
        """
        with self._lock:  # while another process is being started, which has switched off then
            if self._link is None:
                if method in SETTINGS:
                    raise DeviceError(f"{output}: {method}: the switch-off process has not begun")
                return None
        answer = self._ask(output, method, arguments) if not self._fault else None
        if not self._fault:
            return answer
        if method in SETTINGS:
            raise DeviceLost(self._fault)
        if self._not_off is None:
            self._replace()
        assert self._not_off is not None
        if output in self._not_off:
            raise DeviceError(self._not_off[output])
        return None

    def _ask(self, output: str, method: str, arguments: tuple[Any, ...]) -> Any:
        """Send a call and wait for its answer."""
        link, answers = self._link, SimpleQueue[Message]()
        assert link is not None
        with self._lock:
            self._number += 1
            number = self._number
            self._open[number] = answers
        link.send(number=number, output=output, method=method, arguments=list(arguments))
        latest = time.monotonic() + _ANSWERING
        while time.monotonic() < latest:
            try:
                answer = answers.get(timeout=_LOOK)
            except Empty:
                with suppress(DeviceLost):
                    self.watch()
                if not self._fault:
                    continue
                answer = {}
            self._open.pop(number, None)
            if answer.get("text"):
                raise (DeviceLost if answer["kind"] == "lost" else DeviceError)(answer["text"])
            return answer.get("value")
        self._lose(f"the switch-off process did not answer to {output}: {method} in {_ANSWERING:g} s")
        return None

    def _start(self, **also: str) -> None:
        """Start the process and wait until it is ready."""
        command = [sys.executable, "-m", _MODULE]
        flags = subprocess.CREATE_NEW_PROCESS_GROUP if ON_WINDOWS else 0  # type: ignore[attr-defined,unused-ignore]
        process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,  # no signal of this terminal reaches it
            creationflags=flags,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        )
        assert process.stdin is not None
        assert process.stdout is not None
        link = Link(process.stdout.fileno(), process.stdin.fileno())
        self._process, self._link, self._first = process, link, SimpleQueue()
        link.listen(self._take, partial(self._ended, link))
        link.send(
            files=self._files,
            path=sys.path,
            process=os.getpid(),
            started=process_start(os.getpid()),
            folder=None if self.folder is None else str(self.folder.resolve()),
            **also,
        )
        link.beat()
        try:
            first = self._first.get(timeout=_STARTING)
        except Empty:
            first = {"refused": f"was not ready in {_STARTING:g} s"}
        if "refused" in first:
            self._lose(f"the switch-off process did not start: {first['refused']}")
            raise DeviceLost(self._fault)

    def _replace(self) -> None:
        """Have another process switch off what one has left that is gone."""
        with self._lock:
            if self._not_off is not None:
                return
            fault = self._fault
            if self._process is not None and self._link is not None:
                _end(self._process, self._link)
            self._fault = ""
            try:
                self._start(takes_over=fault)
            except DeviceLost as failure:
                self._not_off = dict.fromkeys(OUTPUTS, str(failure))
            self._fault = fault

    def _take(self, message: Message) -> None:
        """Take a message of the process."""
        if "taken_over" in message:
            why, failed = message["why"], dict(message["taken_over"])
            self._not_off = failed
            for number in list(self._open):
                self._open[number].put({})
            self._fault = self._fault or f"{why}; the switch-off process has switched off"
        elif "number" in message:
            answers = self._open.get(message["number"])
            if answers is not None:
                answers.put(message)
        else:
            self._first.put(message)

    def _ended(self, link: Link) -> None:
        """Take the end of the process at a link."""
        if link is self._link:
            self._fault = self._fault or "the switch-off process has ended"
            self._first.put({"refused": "it has ended"})

    def _lose(self, fault: str) -> None:
        """Give the process up, and end it: nothing of it may act later."""
        self._fault = self._fault or fault
        if self._process is not None:
            self._process.kill()


def _end(process: "subprocess.Popen[bytes]", link: Link) -> None:
    """End a process at once where it still lives, and close the pipes to it, which no thread uses any more."""
    link.close()
    process.kill()
    with suppress(subprocess.TimeoutExpired):  # of one that the system cannot end
        process.wait(_DYING)
    is_read = not link.has_ended.wait(_DYING)  # by a thread that would go on with another file of that number
    for stream in (process.stdin, None if is_read else process.stdout):
        if stream is not None:
            with suppress(OSError):
                stream.close()


class _Apart:
    """An output that the switch-off process has.

    Parameters
    ----------
    output : str
        guard, drive or motor.
    name : str
    process : SwitchOffProcess
    """

    def __init__(self, output: str, name: str, process: SwitchOffProcess) -> None:
        self.name = name
        self._call = partial(process.call, output)

    def connect(self) -> None:
        """Connect the device."""
        self._call("connect")

    def close(self) -> None:
        """Release the device, its output off."""
        with suppress(DeviceError):
            self._call("close")


class _OutputApart(_Apart):
    """A drive or a motor."""

    def off(self) -> None:
        """Switch the output off."""
        self._call("off")

    def halt(self) -> None:
        """Switch the output off whatever it is at work on."""
        self._call("halt")


class _DriveApart(_OutputApart):
    """A source of the drive voltage."""

    def __init__(self, name: str, process: SwitchOffProcess, *, voltage_maximum: float) -> None:
        super().__init__("drive", name, process)
        self.voltage_maximum = voltage_maximum

    def drive(self, setting: DriveSetting) -> None:
        """Set the output."""
        self._call("drive", asdict(setting))

    def read_back(self) -> str:
        """Answers of the source on its output; empty where it tells nothing."""
        return str(self._call("read_back") or "")


class _MotorApart(_OutputApart):
    """A motor of the disc."""

    def __init__(self, name: str, process: SwitchOffProcess, *, rotation_speed_maximum: float) -> None:
        super().__init__("motor", name, process)
        self.rotation_speed_maximum = rotation_speed_maximum

    def turn(self, rotation_speed: float) -> None:
        """Set the speed of the disc."""
        self._call("turn", float(rotation_speed))


class _GuardApart(_Apart):
    """A watchdog or enable line."""

    def enable(self) -> None:
        """Allow the outputs."""
        self._call("enable")

    def renew(self) -> None:
        """Begin to wait anew."""
        self._call("renew")

    def disable(self) -> None:
        """Switch the outputs off."""
        self._call("disable")


def with_outputs_apart(device_map: DeviceMap) -> Devices:
    """Devices of a map, of which a switch-off process has guard, drive and motor; nothing is connected yet.

    Parameters
    ----------
    device_map : DeviceMap

    Returns
    -------
    Devices

    Raises
    ------
    InvalidInput
        If a driver cannot make its device.
    """
    here, process = device_map.devices(), SwitchOffProcess(device_map.files)
    drive, motor, guard = here.drive, here.motor, here.guard
    return replace(
        here,
        drive=_DriveApart(drive.name, process, voltage_maximum=drive.voltage_maximum),
        motor=_MotorApart(motor.name, process, rotation_speed_maximum=motor.rotation_speed_maximum),
        guard=None if guard is None else _GuardApart("guard", guard.name, process),
        switch_off=process,
    )


def ready_devices(device_map: Path) -> Devices:
    """Devices of a map whose packages and drivers are installed, its outputs in a switch-off process."""
    found = read_device_map(device_map)
    missing = missing_parts(found)
    if missing:
        raise InvalidInput(f"{device_map}: {'; '.join(missing)}")
    return with_outputs_apart(found)
