"""Generators and loggers whose commands a device map tells: the shipped maps on strict simulators."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from threading import Event, Thread
from typing import cast

import numpy as np
import pytest
from hypothesis import HealthCheck, given, strategies as st
from pytest import MonkeyPatch, approx, raises
from tests.laboratory import strict_instruments
from tests.laboratory.strict_instruments import RIGOL, SIGLENT, TEKTRONIX, StrictGenerator, StrictLogger
from tests.tiers import examples

from sonolube.errors import InvalidInput
from sonolube.laboratory import DeviceError, DeviceLost, DriveSetting, SamplesLost
from sonolube.laboratory.drivers import ScpiSource, read_device_map
from sonolube.laboratory.drivers.scpi_instruments import ErrorEntry, ReplyEntry
from sonolube.laboratory.drivers.visa_connection import VisaConnection

MAPS = Path(__file__).parents[3] / "examples" / "lab"
GAIN = 20.0
SETTING = DriveSetting(voltage_peak_to_peak=28.0, frequency=22e3)
GENERATORS: dict[str, Callable[[], StrictGenerator]] = {
    "tektronix_afg": lambda: StrictGenerator("TEKTRONIX,AFG31021,C000001,SCPI:99.0 FV:1.5.2", TEKTRONIX),
    "rigol_dg1000z": lambda: StrictGenerator(
        "Rigol Technologies,DG1062Z,DG1ZA000000001,03.01.12", RIGOL, on="ON", off="OFF"
    ),
    "siglent_sdg": lambda: StrictGenerator(
        "Siglent Technologies,SDG2042X,SDG2XCAX000001,2.01.01.35R3B2", SIGLENT, has_error_queue=False, errors=[]
    ),
}
UNCHECKED = (HealthCheck.too_slow, HealthCheck.function_scoped_fixture)


@dataclass
class Bench:
    """Drive of a shipped map with the instrument behind it."""

    generator: StrictGenerator
    drive: ScpiSource


@pytest.fixture(params=GENERATORS)
def bench(request: pytest.FixtureRequest, monkeypatch: MonkeyPatch) -> Iterator[Bench]:
    generator = GENERATORS[request.param]()
    read = read_device_map(MAPS / f"{request.param}.toml")
    strict_instruments.install({read.entries.drive.where: generator}, monkeypatch)
    drive = read.devices().drive
    assert isinstance(drive, ScpiSource)
    yield Bench(generator, drive)
    if generator.hangs is not None:
        generator.hangs.set()


def is_on(bench: Bench) -> bool:
    return bench.generator.is_on


def test_a_generator_is_off_before_anything_else_and_on_after_all_was_set(bench: Bench) -> None:
    generator = bench.generator
    assert generator.peak > 8.0  # as the last user left it
    bench.drive.connect()
    assert not is_on(bench)
    assert generator.heard[0] == bench.drive._entry.off
    bench.drive.drive(SETTING)
    assert is_on(bench)
    assert float(generator.values["amplitude"]) * GAIN == approx(28.0)
    assert [float(generator.values[name]) for name in ("frequency", "offset")] == [22e3, 0.0]
    assert generator.values["waveform"].startswith("SIN")
    bench.drive.drive(DriveSetting(voltage_peak_to_peak=20.0, frequency=23e3, waveform="square"))
    assert generator.values["waveform"].startswith("SQU")
    bench.drive.off()
    assert not is_on(bench)
    bench.drive.close()
    assert generator.unsafe == []


CHANGED = {  # at the panel or by the instrument itself, where it has that
    "load": "50", "unit": "VRMS", "am": "ON", "burst": "ON", "modulation": "ON", "sum": "ON", "track": "ON",
    "combined": "ON", "amplitude": "0.9", "offset": "0.3", "frequency": "20000", "output": "OFF",
}  # fmt: skip


def test_an_output_that_was_changed_behind_the_program_is_found_when_it_is_read_back(bench: Bench) -> None:
    generator, drive = bench.generator, bench.drive
    drive.connect()
    drive.drive(SETTING)
    for name in CHANGED.keys() & generator.commands.keys():
        assert drive.read_back().endswith("; output on")
        before, generator.values[name] = generator.values[name], CHANGED[name]
        with raises(DeviceError, match=r"was set|expected"):
            drive.read_back()
        generator.values[name] = before
    generator.values["load"] = "50"
    drive.off()
    with raises(DeviceError, match=r"of its load; .* was set up"):
        drive.drive(SETTING)
    assert not generator.is_on


def test_what_a_map_has_no_check_for_is_told_by_it() -> None:
    told = {name: read_device_map(MAPS / f"{name}.toml").devices().description for name in GENERATORS}
    assert {name: each.get("drive not read back") for name, each in told.items()} == {
        "tektronix_afg": "combination, trips",
        "rigol_dg1000z": "frequency mode, trips",
        "siglent_sdg": "unit, frequency mode, trips",
    }


def test_an_instrument_is_given_the_time_that_its_map_states(monkeypatch: MonkeyPatch, tmp_path: Path) -> None:
    text = (MAPS / "tektronix_afg.toml").read_text(encoding="utf-8")
    (tmp_path / "slow.toml").write_text(text.replace("amplifier =", 'timeout = "7.5 s"\namplifier =', 1))
    (tmp_path / "normal_load.csv").write_text((MAPS / "normal_load.csv").read_text(encoding="utf-8"))
    entry = read_device_map(tmp_path / "slow.toml").entries.drive
    given: list[tuple[float, float]] = []

    class Manager:
        def __init__(self, library: str) -> None:
            self.library = library

        def open_resource(self, resource: str, **settings: float) -> None:
            given.append((settings["timeout"], settings["open_timeout"]))

    import pyvisa

    monkeypatch.setattr(pyvisa, "ResourceManager", Manager)
    entry.line("instrument").open()  # type: ignore[attr-defined]
    read_device_map(MAPS / "tektronix_afg.toml").entries.drive.line("instrument").open()  # type: ignore[attr-defined]
    assert given == [(7500, 7500), (2000, 2000)]  # ms


def test_every_command_of_the_simulators_is_told_from_others() -> None:
    generator = GENERATORS["tektronix_afg"]()
    generator.answer("SOURCE1:VOLTAGE:LEVEL:IMMEDIATE:AMPLITUDE 1.5")
    generator.answer("SOUR1:FUNC:SHAP SIN")
    assert generator.unsafe == []
    for line in ("SOUR1:VOLT:AMPL:LEV 1", "OUTP1 2", "SOUR1:FREQ 22kHz", "OUTPU1 ON", "SOUR1:VOLT", "OUTP2 ON"):
        generator.answer(line)
        assert generator.unsafe.pop() == f"not documented: {line}"
    generator = GENERATORS["siglent_sdg"]()
    generator.answer("C1:OUTP ON")
    assert "on before amplitude was set" in generator.unsafe
    assert "on with modulation" in generator.unsafe


reaches = st.floats(0.05, 1.0)
possible = st.builds(
    lambda reach, share, sign, frequency: DriveSetting(
        voltage_peak_to_peak=max(2 * 80.0 * reach * share, 0.1),
        voltage_offset=sign * max(80.0 * reach * (1 - share) - 0.1, 0.0),
        frequency=frequency,
    ),
    reaches,
    st.floats(0.0, 1.0),
    st.sampled_from([-1, 1]),
    st.floats(1.0, 1e5),
)


@examples(20, suppress_health_check=UNCHECKED)
@given(several=st.lists(possible, min_size=2, max_size=5))
def test_no_order_of_possible_settings_is_beyond_the_limit_on_the_way(
    several: list[DriveSetting], bench: Bench
) -> None:
    bench.drive.connect()
    for setting in several:
        bench.drive.drive(setting)
        assert bench.generator.peak * GAIN == approx(setting.voltage_maximum, rel=1e-6)
    assert bench.generator.unsafe == []


@pytest.mark.parametrize(
    ("setting", "reason"),
    [
        (DriveSetting(voltage_peak_to_peak=0.01, frequency=22e3), "it gives no less"),
        (DriveSetting(voltage_peak_to_peak=200.0, frequency=22e3), "it gives at most 80 V"),
        (DriveSetting(voltage_peak_to_peak=20.0, frequency=22e3, waveform="triangle"), "no command for the waveform"),
        (DriveSetting(voltage_peak_to_peak=20.0, frequency=2e6), "frequencies up to 100 kHz"),
    ],
)
def test_what_the_map_does_not_allow_is_never_sent(setting: DriveSetting, reason: str, bench: Bench) -> None:
    bench.drive.connect()
    heard = len(bench.generator.heard)
    with raises(DeviceError, match=reason):
        bench.drive.drive(setting)
    assert len(bench.generator.heard) == heard


def test_a_value_that_the_generator_clips_is_found_by_reading_back_and_ends_with_the_output_off(bench: Bench) -> None:
    bench.drive.connect()
    bench.drive.drive(SETTING)
    bench.generator.clipped_to = 1.5
    with raises(DeviceError, match=r"has the amplitude 1\.5 V where 2 V was set"):
        bench.drive.drive(DriveSetting(voltage_peak_to_peak=40.0, frequency=22e3))
    assert not is_on(bench)
    bench.drive.drive(SETTING)  # set up anew
    assert is_on(bench)
    assert bench.generator.unsafe == []


@pytest.mark.parametrize("name", ["tektronix_afg", "rigol_dg1000z"])
def test_an_error_of_the_queue_is_told_in_its_words_and_ends_with_the_output_off(
    name: str, monkeypatch: MonkeyPatch
) -> None:
    generator = GENERATORS[name]()
    read = read_device_map(MAPS / f"{name}.toml")
    strict_instruments.install({read.entries.drive.where: generator}, monkeypatch)
    drive = read.devices().drive
    drive.connect()
    drive.drive(SETTING)
    generator.errors.append('-222,"Data out of range"')
    with raises(DeviceError, match=r'refuses .*FREQ 23000.: -222,"Data out of range"'):
        drive.drive(DriveSetting(voltage_peak_to_peak=28.0, frequency=23e3))
    assert not generator.is_on


def test_another_instrument_is_refused_before_it_is_set(bench: Bench) -> None:
    bench.generator.identity = "RIGOL TECHNOLOGIES,DP832,DP8C000001,00.01.16"
    with raises(DeviceError, match="answers 'RIGOL TECHNOLOGIES,DP832"):
        bench.drive.connect()
    assert not is_on(bench)
    assert len(bench.generator.heard) == 2


def test_an_output_that_stays_on_is_told(bench: Bench, monkeypatch: MonkeyPatch) -> None:
    bench.drive.connect()
    bench.drive.drive(SETTING)
    taken = type(bench.generator)._take
    monkeypatch.setattr(
        type(bench.generator), "_take", lambda self, name, value: name == "output" or taken(self, name, value)
    )
    with raises(DeviceError):
        bench.drive.off()


def test_the_output_is_off_although_a_call_hangs_and_the_call_sends_nothing_later(bench: Bench) -> None:
    generator, release = bench.generator, Event()
    bench.drive.connect()
    bench.drive.drive(SETTING)
    generator.hangs, generator.hangs_at = release, "FRQ" if not generator.has_error_queue else "FREQ"
    failures: list[BaseException] = []

    def hang() -> None:
        try:
            bench.drive.drive(DriveSetting(voltage_peak_to_peak=28.0, frequency=24e3))
        except DeviceError as failure:
            failures.append(failure)

    thread = Thread(target=hang)
    thread.start()
    while generator.hangs_at:
        pass
    bench.drive.halt()
    assert not is_on(bench)
    release.set()
    thread.join()
    assert "was switched off while a call hung" in str(failures[0])
    assert not is_on(bench)
    bench.drive.off()
    bench.drive.close()
    assert not is_on(bench)


def test_a_lost_generator_is_switched_off_over_a_new_connection_when_it_is_back(bench: Bench) -> None:
    bench.drive.connect()
    bench.drive.drive(SETTING)
    bench.generator.is_unplugged = True
    with raises(DeviceLost):
        bench.drive.drive(DriveSetting(voltage_peak_to_peak=20.0, frequency=22e3))
    with raises(DeviceError):
        bench.drive.off()
    bench.generator.is_unplugged = False
    bench.drive.off()
    assert not is_on(bench)


def test_an_answer_to_an_earlier_command_does_not_confirm_that_the_output_is_off(bench: Bench) -> None:
    bench.drive.connect()
    bench.drive.drive(SETTING)
    bench.drive._line._line._answers[:] = ["0", "OFF", "C1:OUTP OFF", '0,"No error"']
    bench.drive.off()
    assert not is_on(bench)
    assert bench.drive._line._line._answers == []


CHANGES = [
    (('off = "OUTP1:STAT OFF"', 'off = "OUTP1:STAT ON"'), "on and off must differ"),
    (('  "OUTP1:IMP INF",', '  "OUTP1:STAT ON",'), "setup must not hold 'OUTP1:STAT ON'"),
    (('"SOUR1:VOLT {value}"', '"SOUR1:VOLT 3"'), "drive.amplitude: must hold {value} once"),
    (('"OUTP1:IMP INF"', '"OUTP1:IMP {load}"'), "must hold no braces but"),
    (('on = "1", off = "0"', 'on = "1", off = "1"'), "drive.state: on and off must differ"),
    (('error = { query = "SYST:ERR?", none = "0" }\n', ""), None),
    (('error = { query = "SYST:ERR?", none = "0" }\n\n[drive.waveforms]', "\n[drive.waveforms]"), None),
    (('identity = "TEKTRONIX,AFG3*"\n', ""), "drive.identity: missing"),
]


@pytest.mark.parametrize(("change", "reason"), CHANGES)
def test_a_map_whose_commands_could_not_be_safe_is_refused(
    change: tuple[str, str], reason: str | None, tmp_path: Path
) -> None:
    text = (MAPS / "tektronix_afg.toml").read_text(encoding="utf-8")
    assert change[0] in text
    path = tmp_path / "devices.toml"
    path.write_text(text.replace(*change), encoding="utf-8")
    if reason is None:
        read_device_map(path)
        path.write_text(path.read_text().replace('offset = { query = "SOUR1:VOLT:OFFS?" }\n', ""), encoding="utf-8")
        reason = "without an error queue, readback needs frequency, amplitude and offset"
    with raises(InvalidInput) as refusal:
        read_device_map(path)
    assert reason in str(refusal.value)


@pytest.mark.parametrize(
    ("answer", "reply", "value"),
    [
        ("+2.34000000E+01,+1.1E+00", ReplyEntry(query="READ?", item=2), 1.1),
        ("C1:BSWV WVTP,SINE,FRQ,100HZ,AMP,2V", ReplyEntry(query="?", after="FRQ"), 100.0),
        ("C1:BSWV FRQ,100HZ", ReplyEntry(query="?", after="FRQ"), 100.0),
        ("  7 ", ReplyEntry(query="?"), 7.0),
        ("+9.90000000E+37", ReplyEntry(query="?"), None),
    ],
)
def test_numbers_of_answers(answer: str, reply: ReplyEntry, value: float | None) -> None:
    found = reply.number(answer, device="it")
    assert np.isnan(found) if value is None else found == value


@pytest.mark.parametrize("answer", ["", "OFF", "1,2", "C1:BSWV WVTP,SINE", "1.4KHZ,0,1.4KHZ", "1e3e3,2,x"])
def test_an_answer_without_the_number_is_refused(answer: str) -> None:
    with raises(DeviceError, match="expected a number"):
        ReplyEntry(query="?", item=3).number(answer, device="it")


def test_the_thermocouples_of_a_logger_are_read_by_one_query_a_period_in_si(monkeypatch: MonkeyPatch) -> None:
    logger = StrictLogger()
    read = read_device_map(MAPS / "several_clocks.toml")
    strict_instruments.install({read.entries.acquisitions["slow"].where: logger}, monkeypatch)
    slept: list[float] = []
    clock = [100.0]

    def sleep(seconds: float) -> None:
        slept.append(seconds)
        clock[0] += seconds

    monkeypatch.setattr("sonolube.laboratory.drivers.scpi_instruments.time.sleep", sleep)
    monkeypatch.setattr("sonolube.laboratory.drivers.scpi_instruments.time.monotonic", lambda: clock[0])
    slow = read.devices().further["slow"]
    slow.connect()
    assert slow.start(["disc_temperature", "pin_temperature"], sample_rate=1.0) == 1.0
    block = slow.read(2)
    assert block.values == approx(np.tile([294.65, 297.15], (2, 1)))
    assert (block.first_sample, slow.read(1).first_sample) == (0, 2)
    assert sum(slept) == approx(2.0)
    assert logger.heard.count("READ?") == 3
    assert logger.unsafe == []
    logger.readings = (9.9e37, 21.0)
    assert np.isnan(slow.read(1).values).tolist() == [[False, True]]
    clock[0] += 2.5
    with raises(SamplesLost, match="longer than the period of 1 s; lengthen it"):
        slow.read(1)
    slow.close()


class Queue:
    """Instrument with errors in its queue, each answered once."""

    name = "logger"

    def __init__(self, count: int) -> None:
        self.left = count

    def ask(self, query: str) -> str:
        assert query == "SYST:ERR?"
        self.left -= 1
        return '-113,"Undefined header"' if self.left >= 0 else '+0,"No error"'


def test_a_queue_of_errors_has_an_end_within_fifty() -> None:
    assert ErrorEntry().errors(cast(VisaConnection, Queue(50))) == ['-113,"Undefined header"'] * 50
    with raises(DeviceError, match=r"logger: answers '-113,.*' to 'SYST:ERR\?' without end"):
        ErrorEntry().errors(cast(VisaConnection, Queue(51)))
