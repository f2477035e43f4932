"""How long tests wait for the answer of an instrument: a minute where one comes, a moment where none will."""

from collections.abc import Iterator
from contextlib import contextmanager

from pytest import MonkeyPatch
from tests.laboratory.scpi_generator import Generator
from tests.laboratory.serial_motor import Controller

from sonolube.laboratory.drivers import FunctionGenerator, LineMotor

_TIMEOUT = "sonolube.laboratory.drivers.visa_connection.TIMEOUT"
_MINUTE, _MOMENT = 60.0, 0.1  # s

Device = FunctionGenerator | LineMotor


def be_patient(patch: MonkeyPatch) -> None:
    """Give answers a minute on lines that are opened from now on, so that only a hung test ends by that."""
    patch.setattr(_TIMEOUT, _MINUTE)


def expect_no_answer(patch: MonkeyPatch, *devices: Device) -> None:
    """Give up after a moment, on lines that are open and on new ones."""
    patch.setattr(_TIMEOUT, _MOMENT)
    for device in devices:
        expect_nothing_on_open_line(device)


def expect_nothing_on_open_line(device: Device) -> None:
    """Give the present line of a device, which has been cut, up after a moment; a new one is waited for."""
    line = device._line._line
    if line is not None:
        line.timeout = round(1e3 * _MOMENT)


@contextmanager
def silence(stand_in: Generator | Controller, device: Device) -> Iterator[None]:
    """Let a stand-in of an instrument answer nothing, and its device wait no longer than a moment for that."""
    stand_in.is_mute = True
    with MonkeyPatch.context() as patch:
        expect_no_answer(patch, device)
        yield
    stand_in.is_mute = False
