"""Motor controllers by lines of text: templates, answers, refusals, over a serial port and a socket."""

from collections.abc import Iterator

import pytest
from pytest import MonkeyPatch, raises
from tests.laboratory.patience import be_patient, silence
from tests.laboratory.scpi_generator import LineServer
from tests.laboratory.serial_motor import Controller, SerialPort

from sonolube.laboratory import DeviceError, DeviceLost
from sonolube.laboratory.drivers import LineMotor
from sonolube.laboratory.drivers.line_motor import LineMotorEntry

ENTRY = {
    "driver": "line",
    "speed_command": "V{speed}",
    "speed_answer": "OK",
    "stop_command": "V0",
    "stop_answer": "OK",
    "at_connect": [{"command": "EN", "answer": "OK"}],
    "query": "GV",
    "query_answer": "{speed}",
    "speed_unit": "0.1 rpm",
    "rotation_speed_maximum": "360 rpm",
    "groove_diameter": "50 mm",
}

Bench = tuple[Controller, LineMotor]


@pytest.fixture(params=["serial port", "socket"])
def bench(request: pytest.FixtureRequest, monkeypatch: MonkeyPatch) -> Iterator[Bench]:
    be_patient(monkeypatch)
    controller = Controller()
    if request.param == "socket":
        server: LineServer | SerialPort = LineServer(controller.answer, termination="\r")
    else:
        server = SerialPort(controller)
    baud_rate = 9600 if request.param == "serial port" else None
    motor = LineMotor(LineMotorEntry.model_validate(ENTRY | {"resource": server.resource, "baud_rate": baud_rate}))
    yield controller, motor
    motor.close()
    server.close()


def test_the_speed_is_sent_in_the_unit_of_the_controller_after_it_was_enabled(bench: Bench) -> None:
    controller, motor = bench
    motor.connect()
    motor.turn(2.0)
    assert controller.counts == 1200
    assert controller.heard == ["V0", "EN", "V0", "V1200", "GV"]


def test_a_speed_that_the_controller_refuses_is_an_error_and_stops_the_motor(bench: Bench) -> None:
    controller, motor = bench
    motor.connect()
    motor.turn(2.0)
    with raises(DeviceError, match="answers 'ERR' to 'V3300'; expected 'OK'"):
        motor.turn(5.5)
    assert controller.counts == 0


def test_a_speed_that_reads_back_otherwise_is_an_error_and_stops_the_motor(bench: Bench) -> None:
    controller, motor = bench
    motor.connect()
    controller.reads_back = 1190
    with raises(DeviceError, match="was set to 1200, but answers '1190'"):
        motor.turn(2.0)
    assert controller.counts == 0


def test_a_speed_below_the_smallest_step_is_refused(bench: Bench) -> None:
    controller, motor = bench
    motor.connect()
    with raises(DeviceError, match="smallest step"):
        motor.turn(1e-4)
    assert controller.counts == 0


def test_a_command_without_an_answer_is_never_taken_as_done(bench: Bench) -> None:
    controller, motor = bench
    motor.connect()
    motor.turn(1.0)
    with silence(controller, motor):
        with raises(DeviceLost, match="does not answer"):
            motor.turn(2.0)
        with raises(DeviceLost, match="does not answer"):
            motor.off()
    motor.off()
    assert controller.counts == 0


def test_a_controller_that_does_not_answer_at_first_is_not_connected(bench: Bench) -> None:
    controller, motor = bench
    with silence(controller, motor), raises(DeviceLost):
        motor.connect()
    with raises(DeviceError, match="connect it"):
        motor.turn(1.0)
