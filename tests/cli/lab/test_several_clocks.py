"""`lab check`, `lab run`, `lab show` and `lab export` on a rig with several clocks, free channels and SCPI by TOML."""

from collections.abc import Iterator
from pathlib import Path
from time import sleep

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest import MonkeyPatch, approx
from tests.cli.conftest import Program
from tests.laboratory import strict_instruments
from tests.laboratory.daqmx_device import DaqmxDevice, install
from tests.laboratory.rig_stand_ins import OUTPUTS, voltages
from tests.laboratory.strict_instruments import TEKTRONIX, StrictGenerator, StrictLogger

from sonolube.measurement import read_recording

LAB = Path(__file__).parents[3] / "examples" / "lab"
MOTOR = OUTPUTS.partition("[motor]")[2]
PROTOCOL = """title = "Two clocks"
source = "none"

[limits]
voltage_maximum = "30 V"
duration_maximum = "4 s"

[[steps]]
kind = "motor_speed"
rotation_speed = "1 Hz"

[[steps]]
kind = "acquire"
channels = ["friction_force", "humidity", "pin_temperature"]
sample_rate = "400 Hz"
duration = "2 s"

[[steps]]
kind = "drive"
voltage_peak_to_peak = "20 V"
frequency = "22 kHz"

[[steps]]
kind = "wait"
duration = "2 s"
"""


@pytest.fixture
def instruments(monkeypatch: MonkeyPatch) -> Iterator[tuple[StrictGenerator, StrictLogger]]:
    card = DaqmxDevice()

    def paced(terminal: str, numbers: NDArray[np.int64]) -> NDArray[np.float64]:
        if terminal.endswith("ai0"):
            sleep(numbers.size / 400)
        noise = 1e-4 * np.random.default_rng(int(numbers[0])).standard_normal(numbers.size)
        return 0.05 + 0.01 * voltages(terminal, 0 * numbers) + noise

    card.voltage = paced
    install(card, monkeypatch)
    generator = StrictGenerator("TEKTRONIX,AFG31021,C000001,SCPI:99.0 FV:1.5.2", TEKTRONIX)
    logger = StrictLogger(readings=(30.0, 21.0))
    addresses = {"USB0::0x0699::0x0358::C000001::INSTR": generator, "TCPIP::192.168.1.30::5025::SOCKET": logger}
    strict_instruments.install(addresses, monkeypatch)
    yield generator, logger
    assert not generator.is_on
    assert (generator.unsafe, logger.unsafe) == ([], [])
    assert card.open_tasks == 0


@pytest.fixture
def rig(tmp_path: Path) -> tuple[Path, Path]:
    """Device map and protocol: inputs of the shipped map of several clocks, drive of that of a Tektronix."""
    clocks = (LAB / "several_clocks.toml").read_text(encoding="utf-8").partition("[drive]")[0]
    slow = (
        clocks.partition("[acquisitions.fast]")[0] + "[acquisitions.slow]" + clocks.partition("[acquisitions.slow]")[2]
    )
    _, _, drive = (LAB / "tektronix_afg.toml").read_text(encoding="utf-8").partition("[drive]")
    drive = f"[drive]{drive.partition('[motor]')[0]}[motor]{MOTOR}"
    (tmp_path / "devices.toml").write_text(slow.replace('period = "1 s"', 'period = "20 ms"') + drive)
    (tmp_path / "short.toml").write_text(PROTOCOL)
    return tmp_path / "devices.toml", tmp_path / "short.toml"


def test_a_rig_of_several_clocks_is_checked_run_shown_measured_and_exported(
    sonolube: Program, rig: tuple[Path, Path], instruments: tuple[StrictGenerator, StrictLogger], tmp_path: Path
) -> None:
    device_map, protocol = rig
    checked = sonolube("lab", "check", device_map, "--protocol", protocol, "--connect", "--json")
    assert checked.code == 0, checked.err
    readings = checked.answer["readings"]
    assert readings["pin_temperature"] == {"value": approx(303.15), "unit": "K"}
    assert readings["humidity"] == {"value": approx(0.006, rel=0.01), "unit": ""}
    run = sonolube("lab", "run", protocol, "--device", device_map, "--out", tmp_path / "runs", "--json")
    made = run.answer
    assert (made["outcome"], made["state"]) == ("completed", "safe"), made["reason"]
    (slow,) = made["clocks"]["slow"]
    assert read_recording(Path(slow))["pin_temperature"].to_numpy() == approx(303.15)
    shown = sonolube("lab", "show", made["folder"])
    told = " ".join(shown.out.split())
    assert "humidity (relative_humidity, 1), pin_temperature (temperature, K, clock slow)" in told
    assert f"clock slow {Path(slow).name}" in told
    assert sonolube("lab", "show", made["folder"], "--out", tmp_path / "figures").code == 0
    assert len(list((tmp_path / "figures").glob("*-channels-slow*"))) >= 1
    assert sonolube("lab", "export", made["folder"], "--format", "csv", "--out", tmp_path / "csv").code == 0
    heads = sorted(path.read_text().splitlines()[0] for path in (tmp_path / "csv").glob("*.csv"))
    assert any("humidity [1]" in line for line in heads)
    assert any("pin_temperature [K]" in line for line in heads)
    found = sonolube("measure", "friction", made["folder"], "--json")
    assert found.code == 0, found.err
    assert np.isfinite(read_recording(Path(made["recordings"][0]))["friction_force"]).all()


def test_a_limit_of_a_thermocouple_ends_a_run_with_the_generator_off(
    sonolube: Program, rig: tuple[Path, Path], instruments: tuple[StrictGenerator, StrictLogger], tmp_path: Path
) -> None:
    instruments[1].readings = (130.0, 21.0)
    device_map, protocol = rig
    protocol.write_text(PROTOCOL.replace('"2 s"', '"20 s"').replace('"4 s"', '"60 s"'))
    made = sonolube("lab", "run", protocol, "--device", device_map, "--out", tmp_path / "runs", "--json").answer
    assert made["reason"] == "channel pin_temperature is 403 K; its limit is 393 K"
    assert (made["outcome"], made["state"]) == ("stopped", "safe")
