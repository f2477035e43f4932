"""A function generator of the 33500 family on a loopback socket: SCPI in long and short form, error queue, limits."""

import re
import socket
import threading
from collections.abc import Callable
from dataclasses import dataclass, field

KEYWORDS = {  # long forms by the short ones
    "OUTP": "OUTPUT",
    "SOUR": "SOURCE",
    "LOAD": "LOAD",
    "FUNC": "FUNCTION",
    "FREQ": "FREQUENCY",
    "VOLT": "VOLTAGE",
    "OFFS": "OFFSET",
    "UNIT": "UNIT",
    "LIM": "LIMIT",
    "HIGH": "HIGH",
    "LOW": "LOW",
    "STAT": "STATE",
    "RAMP": "RAMP",
    "SYMM": "SYMMETRY",
    "SQU": "SQUARE",
    "DCYC": "DCYCLE",
    "SYST": "SYSTEM",
    "ERR": "ERROR",
    "SWE": "SWEEP",
    "BURS": "BURST",
    "FSK": "FSKEY",
    "AM": "AM",
    "FM": "FM",
    "PM": "PM",
    "BPSK": "BPSK",
    "PWM": "PWM",
    "SUM": "SUM",
    "MODE": "MODE",
    "COMB": "COMBINE",
    "FEED": "FEED",
    "TRAC": "TRACK",
    "QUES": "QUESTIONABLE",
    "COND": "CONDITION",
}
FUNCTIONS = {"SIN": 30e6, "SQU": 30e6, "TRI": 200e3, "RAMP": 200e3}  # highest frequency in Hz
INTO_50_OHM = 0.5
MODULATIONS = ("AM", "FM", "PM", "FSK", "BPSK", "PWM", "SUM", "SWE", "BURS")


@dataclass
class Generator:
    """State of one output; as the manual says, a value beyond a limit is clipped, and an error goes into the queue."""

    identity: str = "Agilent Technologies,33522A,MY50001234,2.03-1.19-2.00-52-00"
    is_on: bool = False
    load: str = "50"
    function: str = "SIN"
    frequency: float = 1000.0
    amplitude: float = 0.1
    offset: float = 0.0
    limits: tuple[float, float] = (-10.0, 10.0)
    are_limits_on: bool = False
    modulations: dict[str, bool] = field(default_factory=lambda: {"SWE": True})
    unit: str = "VRMS"
    mode: str = "CW"
    combined: str = "CH2"
    tracks: str = "ON"
    tripped: int = 0
    lacks: tuple[str, ...] = ()  # first parts of commands that the model does not have
    errors: list[str] = field(default_factory=list)
    heard: list[str] = field(default_factory=list)
    is_mute: bool = False

    @property
    def peak(self) -> float:
        """Greatest magnitude at a high impedance. [V]"""
        return self.amplitude / 2 + abs(self.offset) if self.is_on else 0.0

    def answer(self, line: str) -> str | None:
        """Answer to a line, None where it has none; an undefined header ends the line."""
        self.heard.append(line)
        if self.is_mute:
            return None
        told = []
        for command in line.split(";"):
            known = len(self.errors)
            told.append(self._answer(command.removeprefix(":")))
            if '-113,"Undefined header"' in self.errors[known:]:
                break
        return next((each for each in told if each is not None), None)

    def _answer(self, line: str) -> str | None:
        """Answer to one command."""
        if line == "*IDN?":
            return self.identity
        if line == "*CLS":
            self.errors.clear()
            return None
        header, _, value = line.partition(" ")
        path = tuple(_short(part) for part in header.rstrip("?").split(":"))
        path = path[1:] if path[0] in ("SOUR", "SOUR1") else path
        path = tuple(part.removesuffix("1") for part in path)
        if path[0] in self.lacks:
            self.errors.append('-113,"Undefined header"')
            return None
        if header.endswith("?"):
            return self._told(path)
        if not self._set(path, value.strip().upper()):
            self.errors.append('-113,"Undefined header"')
        return None

    def _told(self, path: tuple[str, ...]) -> str | None:
        if path == ("SYST", "ERR"):
            return self.errors.pop(0) if self.errors else '+0,"No error"'
        states: dict[tuple[str, ...], str] = {
            ("OUTP",): "1" if self.is_on else "0",
            ("OUTP", "LOAD"): "9.9E+37" if self.load == "INF" else "+5.0000000000000E+01",
            ("VOLT",): f"{self.amplitude:+.13E}",
            ("VOLT", "OFFS"): f"{self.offset:+.13E}",
            ("VOLT", "UNIT"): self.unit,
            ("FREQ",): f"{self.frequency:+.13E}",
            ("FREQ", "MODE"): self.mode,
            ("COMB", "FEED"): self.combined,
            ("TRAC",): self.tracks,
            ("STAT", "QUES", "COND"): f"{self.tripped:+d}",
            **{(name, "STAT"): str(int(self.modulations.get(name, False))) for name in MODULATIONS},
        }
        if path in states:
            return states[path]
        self.errors.append('-113,"Undefined header"')
        return None

    def _set(self, path: tuple[str, ...], value: str) -> bool:
        setters: dict[tuple[str, ...], Callable[[str], None]] = {
            ("OUTP",): self._switch,
            ("OUTP", "LOAD"): self._set_load,
            ("FUNC",): self._set_function,
            ("FREQ",): self._set_frequency,
            ("VOLT",): lambda text: self._set_levels(text, "amplitude"),
            ("VOLT", "OFFS"): lambda text: self._set_levels(text, "offset"),
            ("VOLT", "UNIT"): lambda text: setattr(self, "unit", text),
            ("COMB", "FEED"): lambda text: setattr(self, "combined", text),
            ("TRAC",): lambda text: setattr(self, "tracks", text),
            ("VOLT", "LIM", "STAT"): self._switch_limits,
            ("VOLT", "LIM", "HIGH"): lambda text: self._set_limit(1, float(text)),
            ("VOLT", "LIM", "LOW"): lambda text: self._set_limit(0, float(text)),
            ("FUNC", "RAMP", "SYMM"): lambda text: None,
            ("FUNC", "SQU", "DCYC"): lambda text: None,
        }
        if path[-1:] == ("STAT",) and path[0] in MODULATIONS:
            if value not in ("ON", "OFF", "1", "0"):
                self.errors.append('-224,"Illegal parameter value"')
            elif value in ("ON", "1") and any(on for name, on in self.modulations.items() if name != path[0]):
                self.errors.append('-221,"Settings conflict; other modulation turned off"')
            self.modulations[path[0]] = value in ("ON", "1")
            return True
        if path not in setters:
            return False
        setters[path](value)
        return True

    def _switch(self, value: str) -> None:
        self.is_on = value in ("ON", "1")

    def _set_load(self, value: str) -> None:
        self.load = value

    def _switch_limits(self, value: str) -> None:
        self.are_limits_on = value in ("ON", "1")

    def _set_limit(self, end: int, value: float) -> None:
        low, high = self.limits
        self.limits = (low, value) if end else (value, high)

    def _set_function(self, value: str) -> None:
        if value not in FUNCTIONS:
            self.errors.append('-224,"Illegal parameter value"')
        elif self.frequency > FUNCTIONS[value]:
            self.errors.append('-221,"Settings conflict; frequency reduced for new function"')
            self.frequency = FUNCTIONS[value]
        if value in FUNCTIONS:
            self.function = value

    def _set_frequency(self, value: str) -> None:
        if float(value) > FUNCTIONS[self.function]:
            self.errors.append('-222,"Data out of range; value clipped to upper limit"')
        self.frequency = min(float(value), FUNCTIONS[self.function])

    def _set_levels(self, text: str, name: str) -> None:
        least = 2e-3 if self.load == "INF" else 1e-3
        value = least if text == "MIN" else float(text)
        levels = {"amplitude": self.amplitude, "offset": self.offset} | {name: value}
        highest = 10.0 * (1.0 if self.load == "INF" else INTO_50_OHM)
        reach = self.limits if self.are_limits_on else (-highest, highest)
        if levels["amplitude"] < least * (1 - 1e-6):
            self.errors.append('-222,"Data out of range; value clipped to lower limit"')
            self.amplitude = least
        elif not (
            reach[0] - 1e-6 <= levels["offset"] - levels["amplitude"] / 2
            and levels["offset"] + levels["amplitude"] / 2 <= reach[1] + 1e-6
        ):
            self.errors.append('-221,"Settings conflict; amplitude has been adjusted due to offset"')
            self.offset = min(max(levels["offset"], reach[0] + least / 2), reach[1] - least / 2)
            self.amplitude = min(levels["amplitude"], 2 * (reach[1] - self.offset), 2 * (self.offset - reach[0]))
        else:
            self.amplitude, self.offset = levels["amplitude"], levels["offset"]


def _short(keyword: str) -> str:
    """Short form of a keyword in long or short form, whose number stays; others are no keyword."""
    name, number = re.fullmatch(r"([A-Z*]+)(\d*)", keyword.upper()).groups()  # type: ignore[union-attr]
    forms = KEYWORDS | {long: long for long in KEYWORDS.values()}
    if name not in forms:
        return keyword
    return next(short for short, long in KEYWORDS.items() if name in (short, long)) + number


class LineServer:
    """Serves lines of text on a loopback socket to its clients, each in a thread of its own, until it is closed."""

    def __init__(self, answer: Callable[[str], str | None], *, termination: str = "\n") -> None:
        self._answer, self._end = answer, termination.encode()
        self._socket = socket.create_server(("127.0.0.1", 0))
        self._socket.settimeout(0.05)
        self.port = int(self._socket.getsockname()[1])
        self._client: socket.socket | None = None
        self._is_closing = threading.Event()
        self.is_refusing = False
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    @property
    def resource(self) -> str:
        """Name by VISA."""
        return f"TCPIP::127.0.0.1::{self.port}::SOCKET"

    def drop_client(self) -> None:
        """Cut the present connection; a new one is taken."""
        client = self._client
        if client is not None:
            client.shutdown(socket.SHUT_RDWR)

    def unplug(self) -> None:
        """Cut the present connection, and cut every new one at once."""
        self.is_refusing = True
        self.drop_client()

    def close(self) -> None:
        """End the thread."""
        self._is_closing.set()
        self._thread.join()
        self._socket.close()

    def _serve(self) -> None:
        while not self._is_closing.is_set():
            try:
                client, _ = self._socket.accept()
            except TimeoutError:
                continue
            self._client = client
            threading.Thread(target=self._attend, args=[client], daemon=True).start()

    def _attend(self, client: socket.socket) -> None:
        with client:
            client.settimeout(0.05)
            if not self.is_refusing:
                self._talk(client)
        if self._client is client:
            self._client = None

    def _talk(self, client: socket.socket) -> None:
        waiting = b""
        while not self._is_closing.is_set():
            if hasattr(socket, "TCP_QUICKACK"):  # Linux: an acknowledgement at once, so that tests take no time
                client.setsockopt(socket.IPPROTO_TCP, socket.TCP_QUICKACK, 1)
            try:
                received = client.recv(4096)
            except TimeoutError:
                continue
            except OSError:
                return
            if not received:
                return
            waiting += received
            while self._end in waiting:
                line, waiting = waiting.split(self._end, 1)
                answer = self._answer(line.decode("ascii"))
                if answer is not None:
                    client.sendall(answer.encode("ascii") + self._end)
