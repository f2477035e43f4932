"""Function generators by SCPI commands stated in a device map, with an amplifier behind their output."""

import re
from collections.abc import Sequence
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from sonolube.facts.protocol.quantity_text import SiText, Table
from sonolube.laboratory.devices import DeviceError, DriveSetting, DriveSource
from sonolube.laboratory.drivers.entry import DriveEntry, Line
from sonolube.laboratory.drivers.scpi_instruments import (
    CHECKED,
    CheckEntry,
    ErrorEntry,
    ReplyEntry,
    ScpiEntry,
    require_identity,
    require_set,
    require_state,
    send,
)
from sonolube.laboratory.drivers.visa_connection import SwitchedLine, VisaConnection
from sonolube.text.units import format_si


def _with_value(text: str) -> str:
    """Command with one place for a number."""
    if text.count("{value}") != 1 or re.search(r"[{}]", text.replace("{value}", "")):
        raise ValueError("must hold {value} once, and no other braces")
    return text


Setting = Annotated[Line, AfterValidator(_with_value)]


class StateEntry(Table):
    """Query of the state of an output.

    Parameters
    ----------
    query, on, off : str
        The query, and its answers up to a comma.
    """

    query: Line
    on: Line
    off: Line

    @model_validator(mode="after")
    def _require_different(self) -> Self:
        if self.on == self.off:
            raise ValueError("on and off must differ")
        return self


class ReadbackEntry(Table):
    """Queries of what was set.

    Parameters
    ----------
    frequency : ReplyEntry or None
        [Hz]
    amplitude, offset : ReplyEntry or None
        In V.
    """

    frequency: ReplyEntry | None = None
    amplitude: ReplyEntry | None = None
    offset: ReplyEntry | None = None

    @property
    def replies(self) -> dict[str, ReplyEntry]:
        """Queries that are stated, by the quantity that they read back."""
        return {name: entry for name, entry in self if entry is not None}


class WaveformEntry(Table):
    """Commands by waveform.

    Parameters
    ----------
    sine, square, triangle, sawtooth : str or None
    """

    sine: Line
    square: Line | None = None
    triangle: Line | None = None
    sawtooth: Line | None = None


class ScpiSourceEntry(ScpiEntry, DriveEntry):
    """Function generator whose commands for one output stand here; `{value}` stands for a number in Hz or V.

    Parameters
    ----------
    driver : str
    resource : str
        As VISA calls it.
    visa_library : str
    baud_rate : int or None
        Of a serial port.
    termination : str
    identity : str
        Pattern of the answer to *IDN?, with * for any text.
    setup : tuple of str
        Sent once while the output is off: high impedance, peak-to-peak unit, no modulation, limits by {highest} and
        {lowest}.
    waveforms : WaveformEntry
    frequency : str
        Command with a number in Hz. [Hz]
    amplitude, offset : str
        Commands with a number in V; amplitude is peak to peak.
    amplitude_minimum : float
        Peak to peak, that the output gives, in V.
    on, off : str
    state : StateEntry
    error : ErrorEntry or None
    readback : ReadbackEntry
        Of frequency, amplitude and offset; all of them where there is no error queue.
    checks : tuple of CheckEntry
        Queries of load, unit, frequency mode, modulation, combination and trips, with the answers that must come before
        the output is switched on and at each step.
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

    driver: Literal["scpi_commands"]
    waveforms: WaveformEntry
    frequency: Setting
    amplitude: Setting
    offset: Setting
    amplitude_minimum: Annotated[float, SiText("V", 1e-6, 10.0)]
    on: Line
    off: Line
    state: StateEntry
    error: ErrorEntry | None = None
    readback: ReadbackEntry = ReadbackEntry()
    checks: Annotated[tuple[CheckEntry, ...], Field(strict=False, max_length=30)] = ()

    @model_validator(mode="after")
    def _require_safe(self) -> Self:
        if self.on == self.off:
            raise ValueError("on and off must differ")
        if any(self.on in command for command in self.setup):
            raise ValueError(f"setup must not hold {self.on!r}, which switches the output on")
        if self.error is None and len(self.readback.replies) < 3:
            raise ValueError("without an error queue, readback needs frequency, amplitude and offset")
        return self

    @property
    def not_read_back(self) -> Sequence[str]:
        """What neither a check nor a read-back tells."""
        told = {each.of for each in self.checks} | set(self.readback.replies)
        return [name for name in ("frequency", "amplitude", "offset", *CHECKED) if name not in told]

    def new_device(self) -> DriveSource:
        """Generator, not connected."""
        return ScpiSource(self)


class ScpiSource(SwitchedLine):
    """Source of the drive voltage.

    Parameters
    ----------
    entry : ScpiSourceEntry
    """

    def __init__(self, entry: ScpiSourceEntry) -> None:
        super().__init__(entry.line("function generator"))
        self._entry, self._limits = entry, entry.limits
        self.voltage_maximum = self._limits.voltage_maximum
        self._waveforms: dict[str, str] = entry.waveforms.model_dump(exclude_none=True)
        self._set: dict[str, float | str] = {}  # as the generator has it since it was set up
        self._is_on = False

    def drive(self, setting: DriveSetting) -> None:
        """Set the output; where the generator refuses or has another value, it ends off."""
        amplitude, offset = self._limits.output_of(setting, device=self.name)
        if setting.waveform not in self._waveforms:
            known = ", ".join(self._waveforms)
            raise DeviceError(f"{self.name}: no command for the waveform {setting.waveform}; it has {known}")
        if 0 < amplitude < self._entry.amplitude_minimum:
            least = format_si(self._entry.amplitude_minimum * self._limits.amplifier_gain, "V")
            raise DeviceError(f"{self.name}: less than {least} peak to peak at the actuator refused; it gives no less")
        self._require_connected(before="driving")
        if amplitude == 0:
            self.off()
            return
        with self._off_where_refused():
            self._send_setting(setting, amplitude=amplitude, offset=offset)

    def read_back(self) -> str:
        """Answers on the output, in one line; raises DeviceError where one is not as it was set."""
        line, state = self._line, self._entry.state
        told = [f"{check.query} {check.require(line)}" for check in self._entry.checks]
        told += self._values()
        require_state(line, state.query, [state.on if self._is_on else state.off])
        return "; ".join(dict.fromkeys([*told, f"output {'on' if self._is_on else 'off'}"]))

    def _values(self) -> list[str]:
        """Answers with frequency, amplitude and offset, which must be those that were set."""
        told = []
        for name, reply in self._entry.readback.replies.items():
            answer = self._line.ask(reply.query)
            found, wanted = reply.number(answer, device=self.name), float(self._set[name])
            require_set(name, found=found, wanted=wanted, device=self.name)
            told.append(f"{reply.query} {answer}")
        return told

    def _switch_off(self, line: VisaConnection) -> None:
        """Switch the output off and have that confirmed, by no answer to an earlier command."""
        self._is_on = False
        line.write(self._entry.off)
        require_identity(line, self._entry.identity)
        self._require_state(line, self._entry.state.off)

    def _require_state(self, line: VisaConnection, expected: str) -> None:
        """Ask whether the output is on or off."""
        line.ask_until(self._entry.state.query, lambda heard: heard.partition(",")[0] == expected, expected=expected)

    def _set_up(self) -> None:
        """Switch the output off, and send what the generator needs before it is set, with the smallest signal last."""
        entry = self._entry
        self._set.clear()
        self._switch_off(self._line)
        if entry.error is not None:
            entry.error.errors(self._line)  # of the last user
        limit = self._limits.voltage_maximum / self._limits.amplifier_gain
        for command in entry.setup:
            filled = command.replace("{highest}", f"{limit:.9g}").replace("{lowest}", f"{-limit:.9g}")
            send(self._line, filled, entry.error)
        self._send_value("offset", 0.0)
        self._send_value("amplitude", entry.amplitude_minimum)
        self._require_state(self._line, entry.state.off)

    def _send_setting(self, setting: DriveSetting, *, amplitude: float, offset: float) -> None:
        """Send what has changed, in an order in which no state between exceeds a limit, and switch on last."""
        voltages = [("amplitude", amplitude), ("offset", offset)]
        if amplitude > float(self._set["amplitude"]):
            voltages.reverse()
        if self._set.get("waveform") != setting.waveform:
            send(self._line, self._waveforms[setting.waveform], self._entry.error)
            self._set["waveform"] = setting.waveform
        for name, value in [("frequency", setting.frequency), *voltages]:
            if self._set.get(name) != value:
                self._send_value(name, value)
        if self._is_on:
            self._values()
        else:
            self.read_back()
            send(self._line, self._entry.on, self._entry.error)
            self._require_state(self._line, self._entry.state.on)
            self._is_on = True

    def _send_value(self, name: str, value: float) -> None:
        """Send a frequency, amplitude or offset."""
        command: str = getattr(self._entry, name)
        send(self._line, command.replace("{value}", f"{value:.9g}"), self._entry.error)
        self._set[name] = value
