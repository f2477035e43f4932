"""Function generators: what is sent, in which order, and what happens where the generator refuses or is cut off."""

from collections.abc import Iterator
from itertools import pairwise
from threading import Event, Thread

import pytest
from hypothesis import HealthCheck, given, strategies as st
from pytest import MonkeyPatch, approx, raises
from tests.laboratory.patience import be_patient, expect_nothing_on_open_line, silence
from tests.laboratory.scpi_generator import MODULATIONS, Generator, LineServer
from tests.tiers import examples

from sonolube.errors import MissingPackage
from sonolube.laboratory import DeviceError, DeviceLost, DriveSetting
from sonolube.laboratory.drivers import DriveLimits, FunctionGenerator, VisaConnection

GAIN = 20.0
LIMITS = DriveLimits(amplifier_gain=GAIN, actuator_voltage=150.0, output_voltage=10.0, frequency_maximum=1e6)
UNCHECKED = (HealthCheck.too_slow, HealthCheck.function_scoped_fixture)
SETTING = DriveSetting(voltage_peak_to_peak=28.0, frequency=22e3)

reaches = st.floats(0.01, 1.0)
settings_of_drive = st.builds(
    lambda reach, share, sign, frequency, waveform: DriveSetting(
        voltage_peak_to_peak=max(2 * 150.0 * reach * share, 0.05),
        voltage_offset=sign * max(150.0 * reach * (1 - share) - 0.05, 0.0),
        frequency=min(frequency, 200e3) if waveform in ("triangle", "sawtooth") else frequency,
        waveform=waveform,
    ),
    reaches,
    st.floats(0.0, 1.0),
    st.sampled_from([-1, 1]),
    st.floats(1.0, 1e6),
    st.sampled_from(["sine", "square", "triangle", "sawtooth"]),
)


@pytest.fixture
def bench(monkeypatch: MonkeyPatch) -> Iterator[tuple[Generator, LineServer, FunctionGenerator]]:
    be_patient(monkeypatch)
    generator = Generator()
    server = LineServer(generator.answer)
    device = FunctionGenerator(VisaConnection(name="generator", resource=server.resource), output=1, limits=LIMITS)
    yield generator, server, device
    device.close()
    server.close()


Bench = tuple[Generator, LineServer, FunctionGenerator]


def test_after_connecting_the_load_is_high_nothing_is_modulated_and_the_limits_are_set(bench: Bench) -> None:
    generator, _, device = bench
    generator.is_on = True
    device.connect()
    assert not generator.is_on
    assert generator.load == "INF"
    assert not any(generator.modulations.values())
    assert generator.are_limits_on
    assert generator.limits == (-7.5, 7.5)
    assert generator.heard[0].startswith("OUTP1 OFF")


@pytest.mark.parametrize("modulation", MODULATIONS)
def test_a_modulation_that_the_last_user_left_is_off_before_the_output_is_on(modulation: str, bench: Bench) -> None:
    generator, _, device = bench
    generator.modulations = {modulation: True}
    device.connect()
    device.drive(SETTING)
    lines = [line.partition(";")[0] for line in generator.heard]
    assert lines.index(f"SOUR1:{modulation}:STAT OFF") < lines.index("OUTP1 ON")
    assert not generator.modulations[modulation]
    assert generator.errors == []


def test_the_output_is_switched_on_last(bench: Bench) -> None:
    generator, _, device = bench
    device.connect()
    generator.heard.clear()
    device.drive(SETTING)
    assert settings_in(generator) == ["SOUR1:FREQ 22000", "SOUR1:VOLT 1.4", "OUTP1 ON"]
    generator.heard.clear()
    device.drive(DriveSetting(voltage_peak_to_peak=28.0, frequency=22.1e3))
    assert settings_in(generator) == ["SOUR1:FREQ 22100"]


def settings_in(generator: Generator) -> list[str]:
    """Commands that the generator has heard, without queries."""
    commands = (line.partition(";")[0] for line in generator.heard)
    return [command for command in commands if not command.endswith("?")]


CHANGED = {  # at the panel, by another program or the instrument itself, and what is said of it
    "load": ("50", r"answers '\+5.0000000000000E\+01' to 'OUTP1:LOAD\?', of its load"),
    "unit": ("VRMS", r"answers 'VRMS' to 'SOUR1:VOLT:UNIT\?', of its unit; VPP was set up"),
    "mode": ("SWE", r"of its frequency mode; CW or FIX\* was set up"),
    "modulations": ({"AM": True}, r"to 'SOUR1:AM:STAT\?', of its modulation"),
    "combined": ("CH2", r"'SOUR1:COMB:FEED\?', of its combination"),
    "tracks": ("ON", r"'SOUR1:TRAC\?', of its combination"),
    "tripped": (1, r"'STAT:QUES:COND\?', of its trips"),
    "amplitude": (0.7, "has the amplitude 700 mV where 1.4 V was set"),
    "offset": (0.5, "has the offset 500 mV where 0 V was set"),
    "frequency": (21e3, "has the frequency 21 kHz where 22 kHz was set"),
    "is_on": (False, r"answers '0' to 'OUTP1\?'; expected '1'"),
}


@pytest.mark.parametrize("name", CHANGED)
def test_an_output_that_was_changed_behind_the_program_is_found_when_it_is_read_back(name: str, bench: Bench) -> None:
    generator, _, device = bench
    device.connect()
    device.drive(SETTING)
    told = device.read_back()
    assert "OUTP1:LOAD? 9.9E+37; SOUR1:VOLT:UNIT? VPP; SOUR1:FREQ:MODE? CW" in told
    assert "SOUR1:VOLT? +1.4000000000000E+00; " in told
    assert told.endswith("; output on")
    value, said = CHANGED[name]
    setattr(generator, name, value)
    with raises(DeviceError, match=said):
        device.read_back()
    device.off()
    assert not generator.is_on


@pytest.mark.parametrize("name", ["load", "unit", "combined"])
def test_an_output_that_does_not_take_its_setup_is_never_switched_on(
    name: str, bench: Bench, monkeypatch: MonkeyPatch
) -> None:
    generator, _, device = bench
    device.connect()
    setattr(generator, name, CHANGED[name][0])
    with raises(DeviceError, match="was set up"):
        device.drive(SETTING)
    assert "OUTP1 ON" not in [line.partition(";")[0] for line in generator.heard]


def test_what_a_model_has_no_query_for_is_said_to_be_not_read_back(bench: Bench, monkeypatch: MonkeyPatch) -> None:
    generator, _, device = bench
    generator.identity, generator.lacks = "Agilent Technologies,33511B,MY50001234,2.03", ("STAT",)
    monkeypatch.setattr("sonolube.laboratory.drivers.visa_connection.TIMEOUT", 0.2)
    device.connect()
    device.drive(SETTING)
    assert device.read_back().endswith("; output on; not read back: combination, trips")
    assert not [line for line in generator.heard if "COMB" in line or "TRAC" in line]


@examples(15, suppress_health_check=UNCHECKED)
@given(several=st.lists(settings_of_drive, min_size=2, max_size=5))
def test_no_order_of_possible_settings_meets_a_limit_of_the_generator_on_the_way(
    several: list[DriveSetting], bench: Bench
) -> None:
    generator, _, device = bench
    device.connect()
    for _, setting in pairwise([SETTING, *several]):
        device.drive(setting)
        assert generator.amplitude * GAIN == approx(setting.voltage_peak_to_peak)
        assert generator.offset * GAIN == approx(setting.voltage_offset, abs=1e-6)
        assert generator.frequency == approx(setting.frequency)


def test_a_refusal_of_the_generator_is_told_with_its_words_and_leaves_the_output_off(bench: Bench) -> None:
    generator, _, device = bench
    device.connect()
    device.drive(SETTING)
    generator.limits = (-1.0, 1.0)  # somebody at the front panel
    with raises(DeviceError, match=r"refuses 'SOUR1:VOLT 4': -221,\"Settings conflict"):
        device.drive(DriveSetting(voltage_peak_to_peak=80.0, frequency=22e3))
    assert not generator.is_on
    device.drive(SETTING)
    assert generator.amplitude == approx(1.4)
    assert generator.is_on


@pytest.mark.parametrize(
    ("setting", "reason"),
    [
        (DriveSetting(voltage_peak_to_peak=0.03, frequency=22e3), "less than 40 mV"),
        (DriveSetting(voltage_peak_to_peak=1.0, frequency=201e3, waveform="triangle"), "a ramp has at most 200 kHz"),
        (DriveSetting(voltage_peak_to_peak=1.0, frequency=1e3, waveform="pulse"), "no waveform 'pulse'"),
    ],
)
def test_what_the_generator_cannot_give_is_not_sent(setting: DriveSetting, reason: str, bench: Bench) -> None:
    generator, _, device = bench
    device.connect()
    generator.heard.clear()
    with raises(DeviceError, match=reason):
        device.drive(setting)
    assert generator.heard == []


def test_a_lost_connection_is_opened_anew_to_switch_off(bench: Bench) -> None:
    generator, server, device = bench
    device.connect()
    device.drive(SETTING)
    server.drop_client()
    expect_nothing_on_open_line(device)
    with raises(DeviceLost):
        device.drive(DriveSetting(voltage_peak_to_peak=30.0, frequency=22e3))
    assert generator.is_on
    device.off()
    assert not generator.is_on


def test_a_generator_that_was_switched_off_and_on_is_set_up_again_before_it_drives(bench: Bench) -> None:
    generator, server, device = bench
    device.connect()
    device.drive(SETTING)
    server.drop_client()
    expect_nothing_on_open_line(device)
    generator.__init__()  # type: ignore[misc]  # as it starts: 50 ohm, 0.1 V
    device.off()
    device.drive(SETTING)
    assert generator.amplitude == approx(1.4)
    assert (generator.load, generator.is_on) == ("INF", True)


def test_an_answer_to_a_command_that_was_broken_off_is_not_taken_for_the_confirmation(bench: Bench) -> None:
    generator, _, device = bench
    device.connect()
    device.drive(SETTING)
    device._line.write("SYST:ERR?")  # a signal comes before the answer is read
    device.off()
    assert not generator.is_on


def test_a_generator_that_keeps_silent_is_lost_in_the_time_that_is_given_to_it(bench: Bench) -> None:
    generator, _, device = bench
    device.connect()
    with silence(generator, device):
        with raises(DeviceLost, match="does not answer"):
            device.drive(SETTING)
        with raises(DeviceLost, match="does not answer"):
            device.off()


def test_the_output_is_switched_off_over_another_connection_while_a_call_hangs(
    bench: Bench, monkeypatch: MonkeyPatch
) -> None:
    generator, _, device = bench
    be_patient(monkeypatch)
    device.connect()
    device.drive(SETTING)
    hangs, release = Event(), Event()
    answer = generator._answer

    def hang(command: str) -> str | None:
        if command.startswith("SOUR1:FREQ"):
            hangs.set()
            assert release.wait()
        return answer(command)

    monkeypatch.setattr(generator, "_answer", hang)
    other = DriveSetting(voltage_peak_to_peak=28.0, frequency=23e3)

    def goes_on() -> None:
        with raises(DeviceError, match="was switched off while a call hung"):
            device.drive(other)

    thread = Thread(target=goes_on, daemon=True)
    thread.start()
    assert hangs.wait()
    device.halt()
    assert not generator.is_on
    assert thread.is_alive()
    release.set()
    thread.join()
    assert not generator.is_on  # although the call went on
    device.off()
    assert not generator.is_on


def test_another_instrument_is_refused_by_its_name(bench: Bench) -> None:
    generator, _, device = bench
    generator.identity = "RIGOL TECHNOLOGIES,DS1054Z,DS1ZA,00.04.04"
    with raises(DeviceError, match="answers as 'RIGOL TECHNOLOGIES,DS1054Z"):
        device.connect()
    with raises(DeviceError, match="connect it"):
        device.drive(SETTING)


def test_the_simulated_generator_takes_long_forms_and_queues_errors() -> None:
    generator = Generator()
    generator.answer("OUTPut1:LOAD INF")
    generator.answer(":SOURce1:VOLTage:OFFSet 2.5")
    assert (generator.load, generator.offset) == ("INF", 2.5)
    generator.answer("VOLT 19;:NOTHING 1;:FREQ 5")
    assert (generator.amplitude, generator.frequency) == (15.0, 1000.0)
    assert generator.answer("SYSTem:ERRor?") == '-221,"Settings conflict; amplitude has been adjusted due to offset"'
    assert generator.answer("SYST:ERR?") == '-113,"Undefined header"'
    assert generator.answer("SYST:ERR?") == '+0,"No error"'


@pytest.mark.parametrize("module", ["pyvisa", "pyvisa_py", "serial"])
def test_without_its_packages_the_command_that_installs_them_is_named(module: str, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, module, None)
    with raises(MissingPackage, match=r"pip install pyserial pyvisa pyvisa-py"):
        VisaConnection(name="generator", resource="TCPIP::127.0.0.1::1::SOCKET").open()


@pytest.mark.parametrize("resource", ["TCPIP::127.0.0.1::1::SOCKET", "ASRL/dev/no-such-port::INSTR", "nonsense"])
def test_what_cannot_be_opened_is_refused_in_one_line_with_its_name(resource: str, monkeypatch: MonkeyPatch) -> None:
    be_patient(monkeypatch)
    device = FunctionGenerator(VisaConnection(name="generator", resource=resource), output=1, limits=LIMITS)
    with raises(DeviceError, match=r"^generator: .*look at") as failure:
        device.connect()
    assert "\n" not in str(failure.value)
    device.off()
    device.close()
