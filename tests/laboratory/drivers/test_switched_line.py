"""Lines of instruments and the outputs that they switch, on lines that are lost, refuse, or answer late."""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest
from pytest import MonkeyPatch, raises

from sonolube.laboratory import DeviceError, DeviceLost
from sonolube.laboratory.drivers import VisaConnection
from sonolube.laboratory.drivers.visa_connection import SwitchedLine, VisaLineEntry, visa_resource


class Wire:
    """Connection that notes what is done with it; `fails` raises at a word of it."""

    name = "source"

    def __init__(self, notes: list[str], number: int = 1) -> None:
        self.notes, self.number, self.opened = notes, number, 0
        self.fails: dict[str, Exception] = {}

    def note(self, what: str) -> None:
        self.notes.append(f"{what} {self.number}")
        if what in self.fails:
            raise self.fails[what]

    def open(self) -> None:
        self.opened += 1
        self.note("open")

    def bar(self) -> None:
        self.note("bar")

    def close(self) -> None:
        self.note("close")

    def another(self) -> "Wire":
        return Wire(self.notes, self.number + 1)


class Output(SwitchedLine):
    def _set_up(self) -> None:
        self._line.note("set up")  # type: ignore[attr-defined]

    def _switch_off(self, line: Any) -> None:
        line.note("off")

    def drive(self, act: Callable[[], None] = lambda: None) -> None:
        with self._off_where_refused():
            act()


@pytest.fixture
def wire() -> Wire:
    return Wire([])


@pytest.fixture
def output(wire: Wire) -> Output:
    """Output that is connected."""
    line: Any = wire
    made = Output(line)
    made.connect()
    assert wire.notes == ["open 1", "set up 1"]
    wire.notes.clear()
    return made


def failing(failure: Exception) -> Callable[[], None]:
    def act() -> None:
        raise failure

    return act


def test_an_output_is_connected_once_and_closed_where_it_cannot_be_set_up(output: Output, wire: Wire) -> None:
    output.connect()
    assert wire.notes == []
    other = Wire([])
    other.fails["set up"] = DeviceError("refused")
    line: Any = other
    unready = Output(line)
    with raises(DeviceError, match="refused"):
        unready.connect()
    assert other.notes == ["open 1", "set up 1", "close 1"]
    with raises(DeviceError, match="source: connect it before driving"):
        unready._require_connected(before="driving")
    output._require_connected(before="driving")


def test_an_output_that_is_set_up_is_driven_and_switched_off_over_the_line_that_it_has(
    output: Output, wire: Wire
) -> None:
    output.drive()
    output.off()
    assert wire.notes == ["off 1"]


def test_a_lost_line_is_opened_anew_to_switch_off_without_a_trial_and_once(output: Output, wire: Wire) -> None:
    with raises(DeviceLost):
        output.drive(failing(DeviceLost("unplugged")))
    assert wire.notes == []
    output.off()
    assert wire.notes == ["open 1", "off 1"]
    output.off()
    assert wire.notes == ["open 1", "off 1", "off 1"]
    wire.notes.clear()
    output.drive()
    assert wire.notes == ["open 1", "set up 1"]  # it may have lost what it was told


def test_a_refusal_ends_with_the_output_off_and_set_up_again_before_the_next(output: Output, wire: Wire) -> None:
    with raises(DeviceError, match="clipped"):
        output.drive(failing(DeviceError("clipped")))
    assert wire.notes == ["off 1"]
    output.drive()
    assert wire.notes == ["off 1", "open 1", "set up 1"]
    output.drive()
    assert wire.notes == ["off 1", "open 1", "set up 1"]


def test_a_line_that_fails_to_switch_off_is_opened_anew_and_tried_once_more(output: Output, wire: Wire) -> None:
    wire.fails["off"] = DeviceError("silent")
    with raises(DeviceError, match="silent"):
        output.off()
    assert wire.notes == ["off 1", "open 1", "off 1"]
    with raises(DeviceError, match="silent"):
        output.off()
    assert wire.notes[3:] == ["open 1", "off 1"]  # lost, and not tried as it is
    wire.fails.clear()
    output.off()
    output.off()
    assert wire.notes[5:] == ["open 1", "off 1", "off 1"]


def test_a_halt_bars_the_line_and_switches_off_over_another_that_is_closed(output: Output, wire: Wire) -> None:
    output.halt()
    assert wire.notes == ["bar 1", "open 2", "off 2", "close 2"]
    wire.notes.clear()
    output.off()
    assert wire.notes == ["bar 1", "open 2", "off 2", "close 2"]


def test_an_output_that_is_not_connected_or_closed_is_left_alone(output: Output, wire: Wire) -> None:
    line: Any = Wire([])
    unconnected = Output(line)
    unconnected.off()
    unconnected.halt()
    assert line.notes == []
    output.close()
    assert wire.notes == ["off 1", "close 1"]
    output.off()
    output.halt()
    assert wire.notes == ["off 1", "close 1"]
    output.connect()
    assert wire.notes[2:] == ["open 1", "set up 1"]


class Answers:
    """Line of VISA that answers in turn, and is silent after that."""

    def __init__(self, *answers: str) -> None:
        self.answers, self.written, self.is_closed = list(answers), list[str](), False

    def write(self, text: str) -> None:
        self.written.append(text)

    def read(self) -> str:
        if not self.answers:
            raise OSError("timeout")
        return self.answers.pop(0)

    def close(self) -> None:
        self.is_closed = True


def connected(*answers: str) -> tuple[VisaConnection, Answers]:
    pytest.importorskip("pyvisa")
    connection, line = VisaConnection(name="source", resource="TCPIP::host"), Answers(*answers)
    connection._line = line
    return connection, line


def test_eight_answers_at_most_are_passed_over_until_one_is_as_expected() -> None:
    connection, line = connected(*"1234567", " OFF \r")
    connection.ask_for("OUTP?", "0", "OFF")
    assert line.written == ["OUTP?"]
    assert line.answers == []
    connection, line = connected(*"12345678", "OFF")
    with raises(DeviceError, match=r"^source: answers '8' to 'OUTP\?'; expected '0'$"):
        connection.ask_for("OUTP?", "0", "OFF")
    assert line.answers == ["OFF"]


def test_an_instrument_that_answers_otherwise_and_stops_is_told_from_one_that_is_lost() -> None:
    connection, _ = connected("x" * 100)
    with raises(DeviceError, match=rf"answers '{'x' * 80}' to 'OUTP\?'; expected 'OFF'"):
        connection.ask_for("OUTP?", "OFF")
    connection, _ = connected()
    with raises(DeviceLost, match=r"source: does not answer \(timeout\): look at its cable and power"):
        connection.ask_for("OUTP?", "OFF")


def test_a_barred_or_closed_line_sends_nothing_and_another_is_neither() -> None:
    connection, line = connected("a")
    further = connection.another()
    assert connection.is_open
    assert not further.is_open
    with raises(DeviceError, match="connect it first"):
        further.write("X")
    connection.bar()
    with raises(DeviceError, match="was switched off while a call hung"):
        connection.ask("X")
    assert line.written == []
    again = connection.another()
    again._line = Answers("b")
    assert again.ask("X") == "b"
    connection.close()
    assert line.is_closed
    assert not connection.is_open


def test_a_connection_has_two_seconds_and_the_end_of_line_and_rate_of_its_entry(monkeypatch: MonkeyPatch) -> None:
    pyvisa = pytest.importorskip("pyvisa")
    asked: dict[str, Any] = {}

    def manager(library: str) -> SimpleNamespace:
        return SimpleNamespace(open_resource=lambda name, **given: asked.update(given, name=name, library=library))

    monkeypatch.setattr(pyvisa, "ResourceManager", manager)
    entry = VisaLineEntry(resource="ASRL3::INSTR", baud_rate=9600, termination="CRLF", visa_library="@ivi")
    entry.line("motor").open()
    assert asked == {
        "library": "@ivi",
        "name": "ASRL3::INSTR",
        "open_timeout": 2000,
        "timeout": 2000,
        "read_termination": "\r\n",
        "write_termination": "\r\n",
        "baud_rate": 9600,
    }
    asked.clear()
    VisaLineEntry(resource="ASRL3::INSTR").line("motor", termination="\r").open()
    assert "baud_rate" not in asked
    assert asked["read_termination"] == "\r"
    assert asked["library"] == "@py"


@pytest.mark.parametrize(
    ("resource", "name"),
    [
        ("ASRL3::INSTR", "serial 3"),
        ("com3", "serial 3"),
        (r"\\.\COM12", "serial 12"),
        ("ASRL", "serial 0"),
        ("TCPIP0::192.168.1.21::inst0::INSTR", "tcpip 192.168.1.21"),
        ("TCPIP::192.168.1.21::INST1", "tcpip 192.168.1.21 inst1"),
        ("TCPIP::192.168.1.21::0005025::SOCKET", "tcpip 192.168.1.21 5025"),
        ("USB0::0x0699::0x0353::C01::INSTR", "usb 1689 851 c01"),
        ("USB::1689::851::C01::0::RAW", "usb 1689 851 c01"),
        ("USB::1689::851::C01::1::RAW", "usb 1689 851 c01 1"),
        ("GPIB::07::INSTR", "gpib0 7"),
        (" GPIB2::7::3 ", "gpib2 7 3"),
    ],
)
def test_addresses_of_one_instrument_have_one_name(resource: str, name: str) -> None:
    assert visa_resource(resource) == name
