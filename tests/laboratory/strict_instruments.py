"""Instruments by SCPI behind a stand-in of pyvisa, which know the documented commands alone and note what is unsafe.

The tables hold commands as the programmer manuals write them: capitals are the short form, brackets optional, and a
question mark at the end says that there is a query too.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from threading import Event
from typing import Any, Final

from pytest import MonkeyPatch

NUMBER: Final = r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?"
_SWITCH: Final = "ON|OFF"


def documented(command: str, parameter: str) -> re.Pattern[str]:
    """Pattern of a command in long and short form."""
    text = command
    text = re.sub(r"([A-Z]{2,})([a-z]*)", lambda m: f"(?:{m[1]}|{m[1]}{m[2].upper()})" if m[2] else m[1], text)
    text = text.replace("[", "(?:").replace("]", ")?")
    return re.compile(rf":?{text}(?: (?P<value>{parameter}))?")


TEKTRONIX: Final[Mapping[str, tuple[str, str]]] = {  # name of what is set: command, parameter
    "output": ("OUTPut1[:STATe]", _SWITCH),
    "load": ("OUTPut1:IMPedance", "INF|INFINITY|[0-9]+"),
    "waveform": ("SOURce1:FUNCtion[:SHAPe]", "SIN|SQU|RAMP|PULS|DC"),
    "frequency": ("SOURce1:FREQuency[:CW]", NUMBER),
    "mode": ("SOURce1:FREQuency:MODE", "CW|FIX|SWE"),
    "amplitude": ("SOURce1:VOLTage[:LEVel][:IMMediate][:AMPLitude]", NUMBER),
    "offset": ("SOURce1:VOLTage[:LEVel][:IMMediate]:OFFSet", NUMBER),
    "unit": ("SOURce1:VOLTage:UNIT", "VPP|VRMS|DBM"),
    "highest": ("SOURce1:VOLTage:LIMit:HIGH", NUMBER + "V"),
    "lowest": ("SOURce1:VOLTage:LIMit:LOW", NUMBER + "V"),
    "am": ("SOURce1:AM:STATe", _SWITCH),
    "fm": ("SOURce1:FM:STATe", _SWITCH),
    "pm": ("SOURce1:PM:STATe", _SWITCH),
    "fsk": ("SOURce1:FSKey:STATe", _SWITCH),
    "pwm": ("SOURce1:PWM:STATe", _SWITCH),
    "burst": ("SOURce1:BURSt:STATe", _SWITCH),
}
RIGOL: Final[Mapping[str, tuple[str, str]]] = {
    "output": ("OUTPut1[:STATe]", _SWITCH),
    "load": ("OUTPut1:LOAD", "INF|INFINITY|[0-9]+"),
    "waveform": ("SOURce1:FUNCtion[:SHAPe]", "SIN|SQU|RAMP|PULS|DC"),
    "frequency": ("SOURce1:FREQuency[:FIXed]", NUMBER),
    "amplitude": ("SOURce1:VOLTage[:LEVel][:IMMediate][:AMPLitude]", NUMBER),
    "offset": ("SOURce1:VOLTage[:LEVel][:IMMediate]:OFFSet", NUMBER),
    "unit": ("SOURce1:VOLTage:UNIT", "VPP|VRMS|DBM"),
    "modulation": ("SOURce1:MOD[:STATe]", _SWITCH),
    "sweep": ("SOURce1:SWEep:STATe", _SWITCH),
    "burst": ("SOURce1:BURSt[:STATe]", _SWITCH),
    "sum": ("SOURce1:SUM[:STATe]", _SWITCH),
    "track": ("SOURce1:TRACK", f"{_SWITCH}|INVERTED"),
}
SIGLENT: Final[Mapping[str, tuple[str, str]]] = {
    "output": ("C1:OUTP", _SWITCH),
    "load": ("C1:OUTP LOAD,", "HZ|[0-9]+"),
    "waveform": ("C1:BSWV WVTP,", "SINE|SQUARE|RAMP|PULSE"),
    "frequency": ("C1:BSWV FRQ,", NUMBER),
    "amplitude": ("C1:BSWV AMP,", NUMBER),
    "offset": ("C1:BSWV OFST,", NUMBER),
    "modulation": ("C1:MDWV STATE,", _SWITCH),
    "sweep": ("C1:SWWV STATE,", _SWITCH),
    "burst": ("C1:BTWV STATE,", _SWITCH),
    "combined": ("C1:CMBN ", _SWITCH),
}
HIGH_IMPEDANCE: Final = ("INF", "INFINITY", "HZ")
MODULATIONS: Final = ("am", "fm", "pm", "fsk", "pwm", "burst", "modulation", "sweep", "sum", "track", "combined")


@dataclass
class StrictGenerator:
    """One output of a generator as the last user has left it: on, at 50 ohm, modulated, with a large signal."""

    identity: str
    commands: Mapping[str, tuple[str, str]]
    on: str = "1"
    off: str = "0"
    limit: float = 4.0  # V, that output and amplifier stand
    clipped_to: float = 20.0  # V, peak to peak, above which the instrument clips without a word
    has_error_queue: bool = True
    values: dict[str, str] = field(default_factory=dict)
    heard: list[str] = field(default_factory=list)
    unsafe: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=lambda: ['-410,"Query INTERRUPTED"'])
    hangs: Event | None = None
    hangs_at: str = ""
    is_unplugged: bool = False

    def __post_init__(self) -> None:
        left = {"output": "ON", "load": "50", "amplitude": "9", "offset": "4", "frequency": "77", "waveform": "SQU"}
        self.values = left | dict.fromkeys((name for name in MODULATIONS if name in self.commands), "ON") | self.values
        self._touched: set[str] = set()

    @property
    def is_on(self) -> bool:
        return self.values["output"] == "ON"

    @property
    def peak(self) -> float:
        """Greatest magnitude at a high impedance while the output is on. [V]"""
        reached = float(self.values["amplitude"]) / 2 + abs(float(self.values["offset"]))
        return reached if self.is_on else 0.0

    def answer(self, line: str) -> str | None:
        """Answer to a line, None where it has none; notes what is not documented, and what is unsafe."""
        self.heard.append(line)
        told = self._told(line)
        if told is None and not self._is_set(line):
            self.unsafe.append(f"not documented: {line}")
            if self.has_error_queue:
                self.errors.append('-113,"Undefined header"')
        if "output" in self._touched and self.peak > self.limit * (1 + 1e-6):
            self.unsafe.append(f"{self.peak} V after {line}")
        return told

    def _told(self, line: str) -> str | None:
        """Answer to a query."""
        if line == "*IDN?":
            return self.identity
        if self.has_error_queue and line.lstrip(":") == "SYST:ERR?":
            return self.errors.pop(0) if self.errors else '0,"No error"'
        if not self.has_error_queue:
            return self._told_by_siglent(line)
        if line.lstrip(":") == "SOUR1:FREQ:MODE?":
            return self.values.get("mode", "CW")
        for name in self.commands:
            if line.endswith("?") and documented(*self.commands[name]).fullmatch(line[:-1]):
                return self._answer_of(name)
        return None

    def _answer_of(self, name: str) -> str:
        """What is set of a name, as the instrument writes it."""
        value = self.values.get(name, "")
        if value in ("ON", "OFF"):
            return self.on if value == "ON" else self.off
        if name in ("frequency", "amplitude", "offset"):
            return f"{float(value):.6E}"
        return "9.9E+37" if value in HIGH_IMPEDANCE else value

    def _told_by_siglent(self, line: str) -> str | None:
        value = self.values
        if line == "C1:OUTP?":
            return f"C1:OUTP {value['output']},LOAD,{value['load']},PLRT,NOR"
        states = {"C1:MDWV?": "modulation", "C1:SWWV?": "sweep", "C1:BTWV?": "burst"}
        if line in states:
            return f"{line[:-1]} STATE,{value[states[line]]}"
        if line == "C1:CMBN?":
            return f"C1:CMBN {value['combined']}"
        if line == "C1:BSWV?":
            frequency, amplitude, offset = (float(value[name]) for name in ("frequency", "amplitude", "offset"))
            return (
                f"C1:BSWV WVTP,{value['waveform']},FRQ,{frequency:.10g}HZ,PERI,{1 / frequency:.6g}S,"
                f"AMP,{amplitude:.6g}V,AMPVRMS,0.1Vrms,OFST,{offset:.6g}V,HLEV,1V,LLEV,-1V,PHSE,0"
            )
        return None

    def _is_set(self, line: str) -> bool:
        """Take a command; whether it is documented."""
        for name, (command, parameter) in self.commands.items():
            spelled = documented(command, parameter)
            if command.endswith((",", " ")):  # a parameter and its value
                spelled = re.compile(re.escape(command) + f"(?P<value>{parameter})")
            found = spelled.fullmatch(line)
            if found and found["value"] is not None:
                self._take(name, found["value"])
                return True
        return False

    def _take(self, name: str, value: str) -> None:
        if name == "output" and value == "ON":
            missing = {"load", "waveform", "frequency", "amplitude", "offset"} - self._touched
            self.unsafe += [f"on before {each} was set" for each in sorted(missing)]
            self.unsafe += [f"on with {each}" for each in MODULATIONS if self.values.get(each) == "ON"]
            if self.values["load"] not in HIGH_IMPEDANCE:
                self.unsafe.append("on for a load of 50 ohm")
        if name == "amplitude":
            value = str(min(float(value), self.clipped_to))
        self.values[name] = value
        self._touched.add(name)


class FakeResource:
    """Session of pyvisa with an instrument."""

    def __init__(self, instrument: Any, timeout: float) -> None:
        self._instrument, self._answers, self.timeout = instrument, list[str](), timeout

    def write(self, line: str) -> None:
        self._require_plugged()
        instrument = self._instrument
        if instrument.hangs is not None and instrument.hangs_at and instrument.hangs_at in line:
            instrument.hangs_at = ""
            instrument.hangs.wait()
        answer = instrument.answer(line)
        if answer is not None:
            self._answers.append(answer)

    def read(self) -> str:
        self._require_plugged()
        if not self._answers:
            self._raise_timeout()
        return self._answers.pop(0)

    def close(self) -> None:
        pass

    def _require_plugged(self) -> None:
        if self._instrument.is_unplugged:
            self._raise_timeout()

    def _raise_timeout(self) -> None:
        import pyvisa

        raise pyvisa.errors.VisaIOError(pyvisa.constants.StatusCode.error_timeout)


def install(instruments: Mapping[str, Any], patch: MonkeyPatch) -> None:
    """Let pyvisa open sessions with these instruments, by their addresses, and with no others."""
    import pyvisa

    def open_resource(resource: str, **settings: Any) -> FakeResource:
        assert (settings["read_termination"], settings["write_termination"]) == ("\n", "\n")
        return FakeResource(instruments[resource], settings["timeout"])

    class Manager:
        def __init__(self, library: str) -> None:
            self.open_resource: Callable[..., FakeResource] = open_resource

    patch.setattr(pyvisa, "ResourceManager", Manager)


@dataclass
class StrictLogger:
    """A DAQ970A with a card of multiplexed inputs: thermocouples in degrees Celsius as it is told."""

    identity: str = "Keysight Technologies,DAQ970A,MY58000001,A.02.01-01.00-02.01-00.02-02.00-03-01"
    readings: tuple[float, ...] = (24.0, 21.5)
    heard: list[str] = field(default_factory=list)
    unsafe: list[str] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)
    hangs: Event | None = None
    hangs_at: str = ""
    is_unplugged: bool = False

    DOCUMENTED = (
        r"CONF:TEMP TC,[BEJKNRST],\(@\d{3}(,\d{3})*\)",
        r"UNIT:TEMP [CFK],\(@\d{3}(,\d{3})*\)",
        r"FORM:READ:(UNIT|CHAN|TIME|ALAR) (ON|OFF)",
        r"ROUT:SCAN \(@\d{3}(,\d{3})*\)",
    )

    def answer(self, line: str) -> str | None:
        self.heard.append(line)
        if line == "*IDN?":
            return self.identity
        if line == "SYST:ERR?":
            return self.errors.pop(0) if self.errors else '+0,"No error"'
        if line == "READ?":
            if not any(each.startswith("ROUT:SCAN") for each in self.heard):
                self.unsafe.append("read before a scan list was set")
            return ",".join(f"{reading:+.8E}" for reading in self.readings)
        if not any(re.fullmatch(pattern, line) for pattern in self.DOCUMENTED):
            self.unsafe.append(f"not documented: {line}")
            self.errors.append('-113,"Undefined header"')
        return None
