"""Drivers of sonolube for a function generator and a motor, with instruments that this module pretends to them."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from tests.laboratory.scpi_generator import Generator, LineServer
from tests.laboratory.serial_motor import Controller, SerialPort

from sonolube.laboratory.driver_trial import PretendedInstruments
from sonolube.laboratory.drivers.function_generator import GeneratorEntry as GeneratorEntry
from sonolube.laboratory.drivers.line_motor import LineMotorEntry as LineMotorEntry

_MOTOR = {
    "termination": "CR",
    "speed_unit": "0.1 rpm",
    "speed_command": "V{speed}",
    "speed_answer": "OK",
    "stop_command": "V0",
    "stop_answer": "OK",
    "query": "GV",
    "query_answer": "{speed}",
    "at_connect": [{"command": "EN", "answer": "OK"}],
}


@contextmanager
def pretended_instruments() -> Iterator[PretendedInstruments]:
    """A generator on a socket and a motor on a pseudo-terminal, in a process that no fault reaches."""
    generator, controller = Generator(), Controller()
    server, port = LineServer(generator.answer), SerialPort(controller)
    sections: dict[str, dict[str, Any]] = {
        "drive": {"resource": server.resource, "amplifier_gain": 20.0},
        "motor": {"resource": port.resource, **_MOTOR},
    }
    try:
        yield PretendedInstruments(sections=sections, is_on=lambda: generator.peak > 0 or controller.counts > 0)
    finally:
        server.close()
        port.close()
