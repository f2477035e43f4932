"""The switch-off process: ``python -m sonolube.laboratory.switch_off.process``, started by the program of a run.

It follows the calls to motor, drive and guard. Where the program of the run ends without a word or does not beat for
five seconds, it ends that program, switches off, prints the verdict on standard error and closes the record. Where a
call does not return, it begins anew in place: the call ends with the old program, the new one connects the outputs and
switches them off.
"""

import json
import os
import signal
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Lock, Thread
from typing import Any, Final

from sonolube.errors import SonolubeError, fault_line, words_of
from sonolube.laboratory.devices import DeviceError, DeviceLost, Devices, DriveSetting, fault_of
from sonolube.laboratory.supervision import all_within
from sonolube.laboratory.switch_off.messages import OUTPUTS, SETTINGS, SILENT, Link, Message
from sonolube.laboratory.verdict import Outputs, Verdict, verdict_on
from sonolube.operating_system import ON_WINDOWS, process_start

_LOOK: Final = 0.1  # s, between two looks at clocks and calls
_RETURNING: Final = 2.0  # s, for a setting that is at work when the outputs are switched off
_RELEASING: Final = 8.0  # s, for a call that switches off or releases
_SWITCHING: Final = 10.0  # s
_TRYING: Final = 0.5  # s, between two attempts to connect to an instrument that the ended call may still hold
_PIECE: Final = 60_000  # characters of an argument, of which systems take 128 KiB
_DYING: Final = 2.0  # s, for the program of a run that was killed

_IGNORED: Final = ("HUP", "INT", "QUIT", "TERM", "TSTP", "TTIN", "TTOU", "PIPE", "USR1", "USR2", "ALRM", "BREAK")


def main() -> None:
    """Serve the program of a run to its end."""
    for name in _IGNORED:
        if hasattr(signal, f"SIG{name}"):
            signal.signal(getattr(signal, f"SIG{name}"), signal.SIG_IGN)
    if len(sys.argv) > 1:
        link, given = Link(int(sys.argv[1]), int(sys.argv[2])), json.loads("".join(sys.argv[3:]))
    else:
        link, given = Link(os.dup(0), os.dup(1)), {}
        nothing, writer = os.pipe()
        os.close(writer)
        os.dup2(nothing, 0)  # a driver that reads standard input finds its end
        os.dup2(2, 1)  # what a driver prints is no message
    try:
        _Server(link, given).serve()
    except BaseException as failure:
        link.send(refused=words_of(failure) if isinstance(failure, SonolubeError) else fault_line(failure))
        raise


def outputs_of(devices: Devices) -> dict[str, Any]:
    """Guard, drive and motor by name; no guard where the rig has none."""
    found = {"guard": devices.guard, "drive": devices.drive, "motor": devices.motor}
    return {name: found[name] for name in OUTPUTS if found[name] is not None}


class _Server:
    """Outputs of a run, and the calls to them.

    Parameters
    ----------
    link : Link
    given : mapping of str to object
        First message, where it was heard by the program that this one has replaced.
    """

    def __init__(self, link: Link, given: Message) -> None:
        self._link, self._given = link, dict(given)
        self._heard: SimpleQueue[Message | None] = SimpleQueue()
        self._lock = Lock()
        self._calls: dict[int, tuple[str, str, float]] = {}  # at work: output, method, when it began
        self._connected: set[str] = set()
        self._is_over = False  # no setting is followed any more
        self._outputs: dict[str, Any] = {}
        self._verdict: Verdict | None = None  # of the program of the run

    def serve(self) -> None:
        """Follow calls until the program of the run says that it has done, ends or falls silent."""
        self._link.listen(self._heard.put, lambda: self._heard.put(None))
        self._link.beat()
        if not self._given:
            first = self._heard.get()
            if first is None:
                return
            self._given = dict(first)
        sys.path[:] = self._given["path"]
        self._outputs = outputs_of(_devices_of(self._given["files"]))
        if self._takes_over:
            failures = self._take_over()
            if self._given.get("alone"):
                self._say_last(self._given["alone"], _verdict_on(failures))
                return
        self._link.send(ready=True)
        while self._goes_on():
            if self._link.silence > SILENT:
                self._end_alone(f"has given no sign of life for {SILENT:g} s, and was ended")
                return
            if self._is_over and not self._takes_over and self._stuck and not ON_WINDOWS:
                self._begin_anew()

    def _goes_on(self) -> bool:
        """Follow the next message, if one has come; False after the last."""
        try:
            message = self._heard.get(timeout=_LOOK)
        except Empty:
            return True
        if message is None:
            self._end_alone("has ended before it switched off")
        elif message.get("end"):
            self._close()
        elif "outputs" in message:
            self._verdict = Verdict(Outputs(message["outputs"]), message["basis"])
            return True
        else:
            Thread(target=self._follow, args=(message,), daemon=True, name="sonolube output").start()
            return True
        return False

    @property
    def _takes_over(self) -> str:
        """Why this program has replaced another; empty where it has not."""
        return str(self._given.get("takes_over", ""))

    # -- calls

    def _follow(self, message: Message) -> None:
        """Make a call and answer it."""
        number, name, method = message["number"], message["output"], message["method"]
        try:
            value = self._make(number, name, method, message["arguments"])
            if method in ("halt", "disable") and self._awaits_settings(name):
                self._make(number, name, method, [])  # anew, after a setting that was late
            self._link.send(number=number, value=value)
        except BaseException as failure:  # whatever a driver raises
            kind = "lost" if isinstance(failure, DeviceLost) else "error"
            self._link.send(number=number, kind=kind, text=fault_of(self._outputs[name].name, failure))

    def _make(self, number: int, name: str, method: str, arguments: Sequence[Any]) -> str | None:
        """Make a call to an output; after the first halt, none that may switch on."""
        device = self._outputs[name]
        with self._lock:
            self._is_over = self._is_over or method == "halt"
            if self._is_over and method in SETTINGS:
                raise DeviceError(f"{device.name}: was switched off for good")
            self._calls[number] = (name, method, time.monotonic())
            if method == "connect":
                self._connected.add(name)
        try:
            if method == "halt":
                _off_at_once(device)()
            elif method == "drive":
                device.drive(DriveSetting(**arguments[0]))
            elif method == "read_back":
                return str(device.read_back()) if hasattr(device, "read_back") else None
            else:
                getattr(device, method)(*arguments)
            return None
        finally:
            with self._lock:
                del self._calls[number]
                if method == "close":
                    self._connected.discard(name)

    def _awaits_settings(self, name: str) -> bool:
        """Wait for settings of an output, and return whether there were any; one that hangs ends with the program."""
        waited = False
        while any(output == name and method in SETTINGS for output, method, _ in self._at_work()):
            waited = True
            time.sleep(_LOOK)
        return waited

    def _at_work(self) -> list[tuple[str, str, float]]:
        """Output, method and beginning of each call that has not returned."""
        with self._lock:
            return list(self._calls.values())

    @property
    def _stuck(self) -> bool:
        """Whether a call has been at work for too long."""
        now = time.monotonic()
        return any(
            now - begun > (_RETURNING if method in SETTINGS else _RELEASING) for _, method, begun in self._at_work()
        )

    # -- ends

    def _close(self) -> None:
        """Release the outputs at the end of a run."""
        all_within(_SWITCHING, [(each.name, each.close) for each in self._outputs.values()])

    def _end_alone(self, what: str) -> None:
        """Switch off without the program of the run, which has ended or is ended."""
        with self._lock:
            self._is_over = True
        self._end_the_program()
        if self._verdict is not None and self._verdict.is_off and not self._connected:
            self._say_last(what, self._verdict)
            return
        if not self._connected:
            self._say_last(what, _verdict_on(self._take_over()))
            return
        on = [self._outputs[name] for name in OUTPUTS if name in self._connected]
        all_within(_RETURNING, [(each.name, _off_at_once(each)) for each in on])
        latest = time.monotonic() + _RETURNING
        while self._at_work() and time.monotonic() < latest:
            time.sleep(_LOOK)
        stuck = self._said_at_work()
        if stuck and not ON_WINDOWS:
            self._begin_anew(alone=what)
        calls = [(f"{each.name}: off", each.disable if hasattr(each, "disable") else each.off) for each in on]
        self._say_last(what, _verdict_on([*all_within(_SWITCHING, calls), stuck]))

    def _end_the_program(self) -> None:
        """End the program of the run where it still lives: nothing of it may act later."""
        process, started = self._given["process"], self._given["started"]
        latest = time.monotonic() + _DYING
        while process_start(process) == started and time.monotonic() < latest:
            with suppress(OSError):
                os.kill(process, signal.SIGTERM if ON_WINDOWS else signal.SIGKILL)
            time.sleep(_LOOK)

    def _begin_anew(self, *, alone: str = "") -> None:
        """Replace this program, and the call that does not return with it, by one that connects and switches off.

        Windows cannot replace a program.
        """
        given = self._given | {"takes_over": self._said_at_work(), "alone": alone}
        handles, text = (self._link.incoming, self._link.outgoing), json.dumps(given)
        pieces = [text[place : place + _PIECE] for place in range(0, len(text), _PIECE)]
        for handle in handles:
            os.set_inheritable(handle, True)
        os.execv(sys.executable, [sys.executable, "-m", __spec__.name, *map(str, handles), *pieces])

    def _said_at_work(self) -> str:
        """Calls that have not returned, in words; empty without one."""
        calls = ", ".join(f"{self._outputs[name].name}: {method}" for name, method, _ in self._at_work())
        return f"{calls} did not return" if calls else ""

    def _take_over(self) -> list[str]:
        """Connect the outputs and switch them off, as another program of this run has left them; say what failed."""
        self._is_over = True
        self._connected = set(self._outputs)
        latest = time.monotonic() + _SWITCHING
        calls = [(device.name, partial(_taken_over, device, latest)) for device in self._outputs.values()]
        failures = all_within(_SWITCHING + _TRYING, calls)
        failed = {name: failure for name, failure in zip(self._outputs, failures, strict=True) if failure}
        self._link.send(taken_over=failed, why=self._takes_over)
        return failures

    def _say_last(self, what: str, verdict: Verdict) -> None:
        """Print the verdict, release the outputs and close the record of the run."""
        process, folder = self._given["process"], self._given["folder"]
        _print(f"sonolube: the program of the run, process {process}, {what}; motor and drive: {verdict.text}")
        self._close()
        if folder:
            _print(f"sonolube: the record is {_closed(Path(folder), verdict)}")


def _verdict_on(failures: Sequence[str]) -> Verdict:
    """Verdict on outputs that were switched off one by one; empty without a failure."""
    return verdict_on(list(filter(None, failures)), {})


def _devices_of(files: Mapping[str, str]) -> Devices:
    """Devices of the text of a map, not connected."""
    from sonolube.laboratory.drivers.device_map import device_map_of

    return device_map_of(files).devices()


def _off_at_once(device: Any) -> Any:
    """Function of a device that switches it off whatever it is at work on."""
    if hasattr(device, "disable"):
        return device.disable
    return getattr(device, "halt", device.off)


def _taken_over(device: Any, latest: float) -> None:
    """Connect a device and switch it off; tried anew for a time, since what has ended may still hold the instrument."""
    while True:
        try:
            device.connect()
            (device.disable if hasattr(device, "disable") else device.off)()
            return
        except BaseException:
            if time.monotonic() > latest - _TRYING:
                raise
            time.sleep(_TRYING)


def _closed(folder: Path, verdict: Verdict) -> str:
    """Close the record of a run, and say what became of it."""
    from sonolube.laboratory.records import recover_run

    try:
        recover_run(folder, outputs=verdict)
    except Exception as failure:
        return f"as it was left, {folder}: {words_of(failure)}"
    return f"closed: {folder}"


def _print(line: str) -> None:
    """Print a line on standard error, where there still is one."""
    with suppress(OSError):
        os.write(2, f"{line}\n".encode())


if __name__ == "__main__":
    main()
