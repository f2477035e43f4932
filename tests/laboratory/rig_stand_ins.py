"""Rigs whose devices are stand-ins of hardware, and what these really do."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pytest import MonkeyPatch
from tests.laboratory.daqmx_device import DaqmxDevice, install
from tests.laboratory.patience import be_patient, expect_no_answer
from tests.laboratory.scpi_generator import Generator, LineServer
from tests.laboratory.serial_motor import Controller, SerialPort

from sonolube.laboratory import Devices
from sonolube.laboratory.drivers import FunctionGenerator, LineMotor, read_device_map

EXAMPLE = Path(__file__).parents[2] / "examples" / "lab" / "devices.toml"
GAIN = 20.0  # of the amplifier, V/V
MONITOR = "ai2"  # input of its monitor
OUTPUTS = """
[drive]
driver = "daqmx"
output = "Dev1/ao0"
sample_rate = "900 kHz"
amplifier_gain = 20.0
voltage_maximum = "80 V"
frequency_maximum = "100 kHz"
output_maximum = "5 V"

[motor]
driver = "daqmx"
output = "Dev1/ao1"
voltage_at_maximum = "10 V"
rotation_speed_maximum = "300 rpm"
groove_diameter = "50 mm"
"""


@dataclass(frozen=True, kw_only=True)
class StandIn:
    """A rig, and what its actuator and disc get.

    `was_on` makes motor and drive run before anybody connects; `unplug` takes power and cable from all devices;
    `overrun` lets the buffer of the inputs run full.
    """

    devices: Devices
    was_on: Callable[[], None]
    voltage: Callable[[], float]
    rotation_speed: Callable[[], float]
    unplug: Callable[[], None]
    overrun: Callable[[], None]


def voltages(terminal: str, numbers: NDArray[np.int64]) -> NDArray[np.float64]:
    """Voltages at the inputs: a ramp of its own at each."""
    return np.asarray(1e-3 * numbers + float(terminal[-1]), dtype=np.float64)


def with_monitor(is_off: Callable[[], bool]) -> Callable[[str, NDArray[np.int64]], NDArray[np.float64]]:
    """Voltages at the inputs, 0 at the monitor of the amplifier while the drive is off."""
    return lambda terminal, numbers: (
        voltages(terminal, numbers) * (0.0 if terminal.endswith(MONITOR) and is_off() else 1.0)
    )


@contextmanager
def analogue_rig(folder: Path) -> Iterator[StandIn]:
    """All devices on one card of NI-DAQmx."""
    with ExitStack() as after:
        card = after.enter_context(_card())
        devices = read_device_map(_map(folder, OUTPUTS)).devices()
        card.voltage = with_monitor(lambda: not np.any(card.outputs.get("Dev1/ao0", 0.0)))

        def was_on() -> None:
            card.outputs |= {"Dev1/ao0": np.ones(1), "Dev1/ao1": np.ones(1)}

        yield StandIn(
            devices=devices,
            was_on=was_on,
            voltage=lambda: GAIN * float(np.abs(card.outputs["Dev1/ao0"]).max()),
            rotation_speed=lambda: float(card.outputs["Dev1/ao1"][0]) / 10.0 * 5.0,
            unplug=lambda: setattr(card, "unplugged", -88709),
            overrun=lambda: card.errors.update(read_analog_f64=-200279),
        )
        for device in (devices.drive, devices.motor, devices.acquisition):
            device.close()
        assert card.open_tasks == 0, "a task was left to the driver"


@contextmanager
def instrument_rig(folder: Path) -> Iterator[StandIn]:
    """A card for the inputs, a function generator on the network, a motor on a serial port."""
    generator, controller = Generator(), Controller()
    with ExitStack() as after:
        card = after.enter_context(_card())
        patch = after.enter_context(MonkeyPatch.context())
        be_patient(patch)
        server, port = LineServer(generator.answer), SerialPort(controller)
        after.callback(server.close)
        after.callback(port.close)
        _, _, outputs = EXAMPLE.read_text(encoding="utf-8").partition("[drive]")
        outputs = outputs.replace("TCPIP::192.168.1.21::5025::SOCKET", server.resource)
        outputs = outputs.replace("ASRL/dev/ttyUSB0::INSTR", port.resource)
        devices = read_device_map(_map(folder, f"[drive]{outputs}")).devices()
        card.voltage = with_monitor(lambda: not generator.is_on)

        instruments = [
            each for each in (devices.drive, devices.motor) if isinstance(each, FunctionGenerator | LineMotor)
        ]

        def unplug() -> None:
            card.unplugged = -50405
            controller.is_mute = True
            server.unplug()
            expect_no_answer(patch, *instruments)

        def was_on() -> None:
            generator.is_on, controller.counts, controller.is_enabled = True, 100, True

        yield StandIn(
            devices=devices,
            was_on=was_on,
            voltage=lambda: GAIN * generator.peak,
            rotation_speed=lambda: controller.counts * 0.1 / 60,
            unplug=unplug,
            overrun=lambda: card.errors.update(read_analog_f64=-200279),
        )
        for device in (devices.drive, devices.motor, devices.acquisition):
            device.close()


HARDWARE = {"analogue": analogue_rig, "instruments": instrument_rig}


@contextmanager
def _card() -> Iterator[DaqmxDevice]:
    """Card with known voltages at its inputs."""
    card = DaqmxDevice()
    card.voltage = voltages  # the monitor of the amplifier, too, until a rig says when it is at rest
    with MonkeyPatch.context() as patch:
        install(card, patch)
        yield card


def _map(folder: Path, outputs: str) -> Path:
    """Device map with the inputs of the example."""
    inputs, _, _ = EXAMPLE.read_text(encoding="utf-8").partition("[drive]")
    path = folder / "devices.toml"
    path.write_text(inputs + outputs, encoding="utf-8")
    calibration = "normal_load.csv"
    (folder / calibration).write_text((EXAMPLE.parent / calibration).read_text(encoding="utf-8"), encoding="utf-8")
    return path
