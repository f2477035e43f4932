"""Function generators by SCPI commands stated in a device map, with an amplifier behind their output."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from sonolube.laboratory.devices import DeviceError, DriveSetting
from sonolube.laboratory.drivers.output_limits import DriveLimits
from sonolube.laboratory.drivers.scpi_replies import ErrorQueue, Reply, require_identity, send
from sonolube.laboratory.drivers.switched_line import SwitchedLine
from sonolube.laboratory.drivers.visa_connection import VisaConnection
from sonolube.text.units import format_si

_DIFFERENCE: Final = {"frequency": (1e-4, 0.0), "amplitude": (2e-3, 1e-3), "offset": (2e-3, 1e-3)}
"""Share, and absolute in V, by which a value that is read back may differ from the one that was set."""

_UNITS: Final = {"frequency": "Hz", "amplitude": "V", "offset": "V"}


@dataclass(frozen=True, kw_only=True)
class SourceCommands:
    """Commands of a generator, for one of its outputs; `{value}` stands for a number in Hz or V.

    Parameters
    ----------
    identity : str
        Pattern of the answer to ``*IDN?``.
    off, on : str
        Switch the output.
    state : str
        Asks whether the output is on.
    is_off, is_on : str
        Answers to `state`, up to its first comma.
    setup : tuple of str
        Sent once while the output is off; `{highest}` and `{lowest}` stand for the limits of the output, in V.
    waveforms : mapping of str to str
        Commands by waveform.
    frequency : str
        Command with a number in Hz. [Hz]
    amplitude, offset : str
        Commands with a number in V; amplitude is peak to peak.
    amplitude_minimum : float
        Peak to peak, that the output gives, in V.
    errors : ErrorQueue or None
    readback : mapping of str to Reply
        Of frequency, amplitude and offset.
    """

    identity: str
    off: str
    on: str
    state: str
    is_off: str
    is_on: str
    setup: tuple[str, ...]
    waveforms: Mapping[str, str]
    frequency: str
    amplitude: str
    offset: str
    amplitude_minimum: float
    errors: ErrorQueue | None
    readback: Mapping[str, Reply]


class ScpiSource:
    """Source of the drive voltage.

    Parameters
    ----------
    connection : VisaConnection
    commands : SourceCommands
    limits : DriveLimits
    """

    def __init__(self, connection: VisaConnection, *, commands: SourceCommands, limits: DriveLimits) -> None:
        self.name = connection.name
        self.voltage_maximum = limits.voltage_maximum
        self._line, self._commands, self._limits = connection, commands, limits
        self._switch = SwitchedLine(connection, set_up=self._set_up, switch_off=self._switch_off)
        self._set: dict[str, float | str] = {}  # as the generator has it since it was set up
        self._is_on = False

    def connect(self) -> None:
        """Open the connection, and set the generator up with its output off."""
        self._switch.connect()

    def drive(self, setting: DriveSetting) -> None:
        """Set the output; where the generator refuses or has another value, it ends off."""
        amplitude, offset = self._limits.output_of(setting, device=self.name)
        if setting.waveform not in self._commands.waveforms:
            known = ", ".join(self._commands.waveforms)
            raise DeviceError(f"{self.name}: no command for the waveform {setting.waveform}; it has {known}")
        if 0 < amplitude < self._commands.amplitude_minimum:
            least = format_si(self._commands.amplitude_minimum * self._limits.amplifier_gain, "V")
            raise DeviceError(f"{self.name}: less than {least} peak to peak at the actuator refused; it gives no less")
        self._switch.require_connected(before="driving")
        if amplitude == 0:
            self.off()
            return
        with self._switch.setting():
            self._send_setting(setting, amplitude=amplitude, offset=offset)

    def off(self) -> None:
        """Switch the output off, over a new connection where the present one is lost, and wait for the confirmation."""
        self._switch.off()

    def halt(self) -> None:
        """Switch the output off over a further connection while a call hangs."""
        self._switch.halt()

    def close(self) -> None:
        """Switch the output off and close the connection."""
        self._switch.close()

    def _switch_off(self, line: VisaConnection) -> None:
        """Switch the output off and have that confirmed, by no answer to an earlier command."""
        self._is_on = False
        line.write(self._commands.off)
        require_identity(line, self._commands.identity)
        self._require_state(line, self._commands.is_off)

    def _require_state(self, line: VisaConnection, expected: str) -> None:
        """Ask whether the output is on or off."""
        line.ask_until(self._commands.state, lambda heard: heard.partition(",")[0] == expected, expected=expected)

    def _set_up(self) -> None:
        """Switch the output off, and send what the generator needs before it is set, with the smallest signal last."""
        commands = self._commands
        self._set.clear()
        self._switch_off(self._line)
        if commands.errors is not None:
            commands.errors.errors(self._line)  # of the last user
        limit = self._limits.voltage_maximum / self._limits.amplifier_gain
        for command in commands.setup:
            filled = command.replace("{highest}", f"{limit:.9g}").replace("{lowest}", f"{-limit:.9g}")
            send(self._line, filled, commands.errors)
        self._send_value("offset", 0.0)
        self._send_value("amplitude", commands.amplitude_minimum)
        self._require_state(self._line, commands.is_off)

    def _send_setting(self, setting: DriveSetting, *, amplitude: float, offset: float) -> None:
        """Send what has changed, in an order in which no state between exceeds a limit, and switch on last."""
        voltages = [("amplitude", amplitude), ("offset", offset)]
        if amplitude > float(self._set["amplitude"]):
            voltages.reverse()
        if self._set.get("waveform") != setting.waveform:
            send(self._line, self._commands.waveforms[setting.waveform], self._commands.errors)
            self._set["waveform"] = setting.waveform
        for name, value in [("frequency", setting.frequency), *voltages]:
            if self._set.get(name) != value:
                self._send_value(name, value)
        for name, reply in self._commands.readback.items():
            self._require_value(name, reply)
        if not self._is_on:
            send(self._line, self._commands.on, self._commands.errors)
            self._require_state(self._line, self._commands.is_on)
            self._is_on = True

    def _send_value(self, name: str, value: float) -> None:
        """Send a frequency, amplitude or offset."""
        command: str = getattr(self._commands, name)
        send(self._line, command.replace("{value}", f"{value:.9g}"), self._commands.errors)
        self._set[name] = value

    def _require_value(self, name: str, reply: Reply) -> None:
        """Raise where the generator has another value than the one that was set."""
        wanted, found = float(self._set[name]), reply.number(self._line.ask(reply.query), device=self.name)
        share, absolute = _DIFFERENCE[name]
        if not abs(found - wanted) <= share * abs(wanted) + absolute:
            has, was = format_si(found, _UNITS[name]), format_si(wanted, _UNITS[name])
            raise DeviceError(f"{self.name}: has the {name} {has} where {was} was set")
