"""Function generators of the Agilent and Keysight 33500 family by SCPI, and their section of a device map."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Final, Literal

from sonolube.laboratory.devices import DeviceError, DeviceLost, DriveSetting, DriveSource
from sonolube.laboratory.drivers.entry import DriveEntry, DriveLimits
from sonolube.laboratory.drivers.scpi_instruments import CHECKED, CheckEntry, ReplyEntry, require_set, require_state
from sonolube.laboratory.drivers.visa_connection import SwitchedLine, VisaConnection, VisaLineEntry
from sonolube.text.units import format_si

MIN_AMPLITUDE: Final = 2e-3
"""Peak to peak, into a high impedance. [V]"""

RAMP_FREQUENCY_MAXIMUM: Final = 200e3
"""Of triangle and sawtooth. [Hz]"""

_FUNCTIONS: Final[Mapping[str, str]] = MappingProxyType(
    {"sine": "SIN", "square": "SQU", "triangle": "TRI", "sawtooth": "RAMP"}
)
_RAMPS: Final = ("triangle", "sawtooth")
_MODULATIONS: Final = ("AM", "FM", "PM", "FSK", "BPSK", "PWM", "SUM", "SWE", "BURS")
_CHECKS: Final = (  # what, query behind the source or the output, pattern of the answer
    CheckEntry(of="load", query="{output}:LOAD?", answer="*9.9*E*37|INF*"),
    CheckEntry(of="unit", query="{source}:VOLT:UNIT?", answer="VPP"),
    CheckEntry(of="frequency_mode", query="{source}:FREQ:MODE?", answer="CW|FIX*"),
    *(CheckEntry(of="modulation", query=f"{{source}}:{each}:STAT?", answer="0|OFF") for each in _MODULATIONS),
    CheckEntry(of="trips", query="STAT:QUES:COND?", answer="0|+0"),
)
_COMBINATIONS: Final = (  # with a second channel, of models that have one
    CheckEntry(of="combination", query="{source}:COMB:FEED?", answer="NONE"),
    CheckEntry(of="combination", query="{source}:TRAC?", answer="OFF|0"),
)
_UNKNOWN: Final = "-113"  # error of a command that an instrument does not have
_ERRORS: Final = "SYST:ERR?"
_NUMBER: Final = ReplyEntry(query="?")
_MAX_ERRORS: Final = 20  # that the queue of these generators holds
_KNOWN: Final = ("335", "336")  # beginnings of models


class FunctionGenerator(SwitchedLine):
    """Source of the drive voltage: a generator with an amplifier behind its output.

    Parameters
    ----------
    connection : VisaConnection
    output : int
        1 or 2.
    limits : DriveLimits
    """

    def __init__(self, connection: VisaConnection, *, output: int, limits: DriveLimits) -> None:
        super().__init__(connection)
        self.voltage_maximum = limits.voltage_maximum
        self._limits = limits
        self._output, self._source = f"OUTP{output}", f"SOUR{output}"
        self._set: dict[str, float | str] = {}  # as the generator has it since it was set up
        self._checks: tuple[CheckEntry, ...] = ()

    def drive(self, setting: DriveSetting) -> None:
        """Set the output; where the generator refuses, it ends off."""
        amplitude, offset = self._limits.output_of(setting, device=self.name)
        if setting.waveform in _RAMPS and setting.frequency > RAMP_FREQUENCY_MAXIMUM:
            most = format_si(RAMP_FREQUENCY_MAXIMUM, "Hz")
            raise DeviceError(f"{self.name}: {format_si(setting.frequency, 'Hz')} refused; a ramp has at most {most}")
        if 0 < amplitude < MIN_AMPLITUDE:
            least = format_si(MIN_AMPLITUDE * self._limits.amplifier_gain, "V")
            raise DeviceError(f"{self.name}: less than {least} peak to peak at the actuator refused; it gives no less")
        self._require_connected(before="driving")
        if amplitude == 0:
            self.off()
            return
        with self._off_where_refused():
            self._send_setting(setting, amplitude=amplitude, offset=offset)

    def read_back(self) -> str:
        """Answers on the output, in one line; raises DeviceError where one is not as it was set."""
        line = self._line
        told = [f"{check.query} {check.require(line)}" for check in self._checks]
        for key, name in {"FREQ": "frequency", "VOLT": "amplitude", "VOLT:OFFS": "offset"}.items():
            query = f"{self._source}:{key}?"
            answer = line.ask(query)
            wanted = max(float(self._set[key]), MIN_AMPLITUDE) if key == "VOLT" else float(self._set[key])
            require_set(name, found=_NUMBER.number(answer, device=self.name), wanted=wanted, device=self.name)
            told.append(f"{query} {answer}")
        on = self._set.get("output") == "on"
        require_state(line, f"{self._output}?", ("1", "ON") if on else ("0", "OFF"))
        known = {check.of for check in self._checks}
        missing = ", ".join(each.replace("_", " ") for each in CHECKED if each not in known)
        state = f"output {'on' if on else 'off'}"
        return "; ".join(filter(None, [*told, state, f"not read back: {missing}" if missing else ""]))

    def _switch_off(self, line: VisaConnection) -> None:
        """Switch the output off and have that confirmed."""
        self._set.pop("output", None)
        line.ask_for(f"{self._output} OFF;:{self._output}?", "0", "OFF")

    def _set_up(self) -> None:
        """Switch the output off, and set load, unit, smallest signal, limits and no modulation."""
        self._switch_off(self._line)
        self._line.write("*CLS")
        identity = self._line.ask("*IDN?")
        maker_and_model = identity.split(",")
        if len(maker_and_model) < 2 or not maker_and_model[1].strip().startswith(_KNOWN):
            raise DeviceError(
                f"{self.name}: answers as {identity[:80]!r}; the driver is for generators 33500 and 33600"
            )
        limit = self._limits.voltage_maximum / self._limits.amplifier_gain
        source, has_two = self._source, maker_and_model[1].strip()[4:5] in ("0", "2")
        self._command(f"{self._output}:LOAD INF")
        for command in ("COMB:FEED NONE", "TRAC OFF") if has_two else ():
            self._command(f"{source}:{command}")
        for modulation in _MODULATIONS:
            self._command(f"{source}:{modulation}:STAT OFF")
        first = ("VOLT:LIM:STAT OFF", "FUNC SIN", "FREQ 1000", "FUNC:RAMP:SYMM 100", "FUNC:SQU:DCYC 50")
        for command in (*first, "VOLT:UNIT VPP", "VOLT:OFFS 0", "VOLT MIN"):
            self._command(f"{source}:{command}")
        self._command(f"{source}:VOLT:LIM:HIGH {limit:.9g}")
        self._command(f"{source}:VOLT:LIM:LOW {-limit:.9g}")
        self._command(f"{source}:VOLT:LIM:STAT ON")
        self._set = {"VOLT": 0.0, "VOLT:OFFS": 0.0, "FUNC": "SIN", "FREQ": 1000.0}
        wanted = [*_CHECKS, *(_COMBINATIONS if has_two else ())]
        places = {"output": self._output, "source": source}
        filled = [each.model_copy(update={"query": each.query.format(**places)}) for each in wanted]
        self._checks = tuple(check for check in filled if self._knows(check))

    def _knows(self, check: CheckEntry) -> bool:
        """Whether the generator has a query, whose answer must be as it was set up; one that it lacks times out."""
        try:
            check.require(self._line)
        except DeviceLost:
            if not self._line.ask(_ERRORS).startswith(_UNKNOWN):
                raise
            return False
        return True

    def _send_setting(self, setting: DriveSetting, *, amplitude: float, offset: float) -> None:
        """Send what has changed, in an order in which no state between exceeds a limit."""
        function = _FUNCTIONS[setting.waveform]
        voltages = [("VOLT", amplitude), ("VOLT:OFFS", offset)]
        if amplitude > float(self._set["VOLT"]):
            voltages.reverse()
        shape: list[tuple[str, float | str]] = [("FREQ", setting.frequency), ("FUNC", function)]
        if setting.frequency > float(self._set["FREQ"]):
            shape.reverse()
        for key, value in [*shape, *voltages]:
            if self._set[key] != value:
                number = value if isinstance(value, str) else f"{value:.9g}"
                self._require_accepted(f"{self._source}:{key} {number}", f"{self._source}:{key} {number};:{_ERRORS}")
                self._set[key] = value
        if self._set.get("output") != "on":
            self.read_back()
            self._require_accepted(f"{self._output} ON", f"{self._output} ON;:{_ERRORS}")
            self._set["output"] = "on"

    def _command(self, text: str) -> None:
        """Send a command that the generator may not know, and then ask for errors: it drops the rest of such a line."""
        self._line.write(text)
        self._require_accepted(text, _ERRORS)

    def _require_accepted(self, command: str, line: str) -> None:
        """Send a line that ends with the query of the error queue, and raise where the queue holds errors."""
        complaints: list[str] = []
        while len(complaints) < _MAX_ERRORS:
            answer = self._line.ask(_ERRORS if complaints else line)
            if answer.partition(",")[0] in ("0", "+0"):
                break
            complaints.append(answer[:80])
        if complaints:
            raise DeviceError(f"{self.name}: refuses {command!r}: {'; '.join(complaints[:3])}")


class GeneratorEntry(VisaLineEntry, DriveEntry):
    """Function generator of the Agilent and Keysight 33500 family.

    Parameters
    ----------
    driver : str
    resource : str
        As VISA calls it.
    visa_library : str
    timeout : float
        In which it answers, in s.
    baud_rate : int or None
        Of a serial port.
    termination : str
    output : int
    description, amplifier : str
        Model and serial number.
    amplifier_gain : float
        []
    voltage_maximum : float
        Magnitude at the actuator, offset included. [V]
    frequency_maximum : float
        In Hz.
    output_maximum : float
        Magnitude that the amplifier takes, in V.
    """

    driver: Literal["scpi"]
    output: Literal[1, 2] = 1

    @property
    def not_read_back(self) -> Sequence[str]:
        """Nothing, but for what a model lacks a query for, which its read-back says."""
        return []

    def new_device(self) -> DriveSource:
        """Generator, not connected."""
        return FunctionGenerator(self.line("function generator"), output=self.output, limits=self.limits)
