"""Dry runs: currents and powers by hand, heat by power times time, durations and data by count, limits by step."""

from dataclasses import replace
from math import exp, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from tests.tiers import examples

from sonolube.charts import draw_chart
from sonolube.design.control import Amplifier
from sonolube.errors import InvalidInput
from sonolube.facts.protocol import PROMPT_DURATIONS, Protocol, protocol_by_name_or_file, protocol_from, protocol_names
from sonolube.figure import publication_style, render_figure
from sonolube.laboratory.devices import DriveSetting
from sonolube.laboratory.dry_run import DryRun, HeatingAssumptions, drive_load, dry_run, dry_run_chart, dry_run_lines
from sonolube.rig import Rig, read_rig

RIGS = Path(__file__).parents[3] / "examples" / "rigs"
LIMITS = {"voltage_maximum": "100 V", "duration_maximum": "100 h"}
STEEL = HeatingAssumptions(pin_material="stainless_steel_304", disc_material="stainless_steel_304")


@pytest.fixture(scope="module")
def tribometer() -> Rig:
    return read_rig(RIGS / "tribometer.toml")


@pytest.fixture(scope="module")
def power_map() -> Rig:
    return read_rig(RIGS / "power_map.toml")


def made(*steps: dict[str, Any], **limits: str) -> Protocol:
    return protocol_from(
        {
            "title": "a test",
            "source": "nobody",
            "limits": LIMITS | limits,
            "metadata": {"normal_load": "3 N"},
            "steps": list(steps),
        }
    )


def wait(text: str) -> dict[str, Any]:
    return {"kind": "wait", "duration": text}


def slide(text: str) -> dict[str, Any]:
    return {"kind": "motor_speed", "sliding_speed": text}


def drive(volts: float, frequency: str = "22 kHz") -> dict[str, Any]:
    return {
        "kind": "drive",
        "voltage_peak_to_peak": f"{volts!r} V",
        "voltage_offset": f"{volts / 2!r} V",
        "frequency": frequency,
    }


@given(volts=st.floats(0.1, 200), frequency=st.floats(10, 1e5), capacitance=st.floats(1e-9, 1e-5))
@examples(50)
def test_a_sine_on_a_capacitance_needs_pi_f_c_u_of_current(volts: float, frequency: float, capacitance: float) -> None:
    load = drive_load(DriveSetting(voltage_peak_to_peak=volts, frequency=frequency), capacitance=capacitance)
    assert load.peak_current == pytest.approx(pi * frequency * capacitance * volts)
    assert load.slew_rate == pytest.approx(pi * frequency * volts)
    assert load.capacitive_power == pytest.approx(2 * pi * frequency * capacitance * volts**2 / 8)


def test_the_current_of_a_triangle_is_that_of_its_slope_and_never_told_too_low() -> None:
    setting = DriveSetting(voltage_peak_to_peak=20.0, frequency=1e3, waveform="triangle")
    exact = 1e-6 * 2 * 20 * 1e3
    assert exact <= drive_load(setting, capacitance=1e-6).peak_current <= 1.19 * exact  # 18 % by truncation


def test_the_map_test_charges_the_capacitance_with_the_powers_of_table_4_1(power_map: Rig) -> None:
    found = dry_run(protocol_by_name_or_file("map_test"), rig=power_map)
    powers = [point.load.power for point in found.points if point.load and point.load.power.charging_power]
    assert [each.charging_power for each in powers] == pytest.approx([0.21, 0.84, 1.9, 3.39, 5.31], abs=0.006)
    # the motion grows with the voltage, and turns more into heat
    assert [each.power_to_supply for each in powers] == [each.dissipated_power for each in powers]
    assert found.amplifier_energy == pytest.approx(4 * sum(each.power_to_supply for each in powers))


def test_the_map_test_has_the_amplitudes_of_table_4_1(power_map: Rig) -> None:
    found = dry_run(protocol_by_name_or_file("map_test"), rig=power_map)
    amplitudes = [point.vibration_amplitude for point in found.points if point.vibration_amplitude]
    assert amplitudes == pytest.approx([0.46e-6, 0.92e-6, 1.38e-6, 1.85e-6, 2.31e-6], abs=0.01e-6)


@pytest.mark.parametrize("name", protocol_names())
def test_every_protocol_of_the_package_can_be_gone_through_without_a_rig(name: str) -> None:
    protocol = protocol_by_name_or_file(name)
    found = dry_run(protocol, rig=None)
    assert sum(point.duration for point in found.points) == pytest.approx(found.duration)
    assert not found.refusals
    assert found.heating is None
    assert len(dry_run_lines(found)) > len(found.points)


def test_time_data_and_prompts_of_the_map_test_are_counted() -> None:
    found = dry_run(protocol_by_name_or_file("map_test"), rig=None)
    assert found.duration == pytest.approx(32.5)
    assert found.prompt_time == PROMPT_DURATIONS["cleaning"] + PROMPT_DURATIONS["load"]
    assert found.samples == 5 * 32.5 * 400  # five channels
    assert found.bytes == 8 * found.samples


def test_prompts_of_a_repeat_count_each_time() -> None:
    ask = {"kind": "prompt", "task": "load", "text": "Hang the weight."}
    found = dry_run(made({"kind": "repeat", "count": 3, "steps": [ask, wait("1 s")]}), rig=None)
    assert found.prompt_time == 3 * PROMPT_DURATIONS["load"]


def test_work_of_friction_is_force_times_speed_times_time(tribometer: Rig) -> None:
    found = dry_run(made(wait("1 s"), slide("20 mm/s"), wait("100 s")), rig=tribometer)
    assert found.heating is not None
    assert found.heating.frictional_heat == pytest.approx(tribometer.friction_coefficient * 3.0 * 0.02 * 100)


def test_heat_of_the_actuator_is_its_loss_times_the_time(tribometer: Rig) -> None:
    found = dry_run(made(drive(28.0), wait("50 s")), rig=tribometer, heating=replace(STEEL, loss_factor=0.1))
    assert found.heating is not None
    reactive = 2 * pi * 22e3 * 360e-9 * 28.0**2 / 8
    assert found.heating.actuator_heat == pytest.approx(0.1 * reactive * 50)


def test_the_actuator_warms_and_cools_by_its_first_order_law(tribometer: Rig) -> None:
    found = dry_run(made(drive(28.0), wait("300 s"), drive(0.0), wait("200 s")), rig=tribometer, heating=STEEL)
    assert found.heating is not None
    tau = STEEL.actuator_heat_capacity / STEEL.actuator_conductance
    final = STEEL.loss_factor * 2 * pi * 22e3 * 360e-9 * 28.0**2 / 8 / STEEL.actuator_conductance
    at = dict(zip(np.round(found.heating.time, 6), found.heating.actuator_rise, strict=True))
    assert at[300.0] == pytest.approx(final * (1 - exp(-300 / tau)))
    assert at[500.0] == pytest.approx(final * (1 - exp(-300 / tau)) * exp(-200 / tau))


def test_the_actuator_of_study_one_ends_at_the_temperature_of_table_2_2(tribometer: Rig) -> None:
    # 31 +- 1 degC in a room of 21 +- 1 degC; the assumed loss is the one that gives this
    found = dry_run(protocol_by_name_or_file("study_1"), rig=tribometer)
    assert found.heating is not None
    assert found.heating.actuator_rise.max() == pytest.approx(10.0, abs=1.0)


def test_the_contact_stays_warmer_than_the_pin_while_it_slides_and_not_after(tribometer: Rig) -> None:
    found = dry_run(made(slide("87 mm/s"), wait("20 s"), slide("0 m/s"), wait("20 s")), rig=tribometer, heating=STEEL)
    heating = found.heating
    assert heating is not None
    assert heating.contact_rise is not None
    assert heating.pin_rise is not None
    sliding = (heating.time > 0) & (heating.time <= 20 + 1e-9)
    assert np.all(heating.contact_rise[sliding] > heating.pin_rise[sliding])
    assert heating.contact_rise[~sliding] == pytest.approx(heating.pin_rise[~sliding])


def refusals(protocol: Protocol, rig: Rig, amplifier: Amplifier | None = None) -> tuple[str, ...]:
    return dry_run(protocol, rig=rig, amplifier=amplifier, heating=STEEL).refusals


def test_a_current_beyond_the_amplifier_names_step_and_both_currents(tribometer: Rig) -> None:
    protocol = made(wait("1 s"), drive(28.0), wait("1 s"))  # pi 22 kHz 360 nF 28 V = 0.697 A
    weak = Amplifier(voltage_maximum=100, current_maximum=0.2)
    assert refusals(protocol, tribometer, weak) == ("step 2: needs 697 mA peak; the amplifier gives 200 mA",)


def test_swing_and_slew_rate_beyond_the_amplifier_are_named(tribometer: Rig) -> None:
    slow = Amplifier(voltage_maximum=20, slew_rate_maximum=1e6)  # pi 22 kHz 28 V = 1.94 V/us
    lines = refusals(made(drive(28.0), wait("1 s")), tribometer, slow)
    assert lines == (
        "step 1: needs 28 V peak to peak; the amplifier gives 20 V",
        "step 1: needs 1.94 V/us; the amplifier gives 1 V/us",
    )


def test_an_amplifier_that_is_just_strong_enough_is_not_refused(tribometer: Rig) -> None:
    enough = Amplifier(voltage_maximum=28, current_maximum=pi * 22e3 * 360e-9 * 28, slew_rate_maximum=pi * 22e3 * 28)
    assert refusals(made(drive(28.0), wait("1 s")), tribometer, enough) == ()


def test_limits_of_the_protocol_that_would_end_it_are_named(tribometer: Rig) -> None:
    limits = {"current_maximum": "0.5 A", "friction_force_maximum": "0.9 N", "temperature_maximum": "25 degC"}
    protocol = made(slide("20 mm/s"), drive(28.0), wait("1000 s"), **limits)
    current, force, temperature = refusals(protocol, tribometer)
    assert current == "step 2: reaches 697 mA; limits.current_maximum of 500 mA ends the test"
    assert force == "step 1: reaches 1.02 N of friction; limits.friction_force_maximum of 900 mN ends the test"
    assert temperature.startswith("step 3: reaches ")
    assert "too hot after 125 s" in temperature  # 4 of 10 K after tau ln(10/6) = 245 s * 0.511 = 125 s
    assert "limits.temperature_maximum of 25 degC ends the test" in temperature


def test_static_friction_near_the_limit_is_told(tribometer: Rig) -> None:
    found = dry_run(made(slide("20 mm/s"), wait("1 s"), friction_force_maximum="1.2 N"), rig=tribometer)
    assert not found.refusals
    assert any("static friction may reach 1.38 N" in line for line in found.caveats)


def test_a_stack_that_would_be_overdriven_is_refused_at_its_step(tribometer: Rig) -> None:
    assert tribometer.stack is not None
    weak = replace(tribometer, stack=replace(tribometer.stack, highest_voltage=20.0, lowest_voltage=0.0))
    lines = refusals(made(wait("1 s"), drive(28.0), wait("1 s")), weak)
    assert len(lines) >= 1
    assert lines[0].startswith("step 2: ")


def test_what_a_rig_does_not_hold_is_left_out_and_told(tribometer: Rig) -> None:
    bare = Rig(
        title="bare",
        source="nobody",
        contact=tribometer.contact,
        normal_load=3.0,
        friction_coefficient=0.341,
        sliding_speed=0.02,
        drive=tribometer.drive,
    )
    found = dry_run(made(slide("20 mm/s"), drive(28.0), wait("1 s")), rig=bare)
    assert found.amplifier_energy is None
    assert any("capacitance is missing" in line for line in found.caveats)
    assert any("amplitude and friction under vibration are left out" in line for line in found.caveats)


def test_a_disc_whose_groove_is_unknown_has_no_sliding_speed(tribometer: Rig) -> None:
    found = dry_run(made({"kind": "motor_speed", "rotation_speed": "1 /s"}, wait("1 s")), rig=tribometer)
    assert found.points[0].sliding_speed is None
    assert any("groove_diameter is missing" in line for line in found.caveats)


def test_an_unphysical_heat_capacity_is_refused_by_name() -> None:
    with pytest.raises(InvalidInput, match="actuator_heat_capacity must be positive"):
        HeatingAssumptions(actuator_heat_capacity=0.0)


def lines_of(found: DryRun) -> str:
    return "\n".join(dry_run_lines(found))


def test_the_lines_tell_time_speed_voltage_amplitude_current_and_force(power_map: Rig) -> None:
    text = lines_of(dry_run(protocol_by_name_or_file("map_test"), rig=power_map, heating=STEEL))
    assert "0:12.5  7     voltage steps 65.5 mm/s  5.1 V pp 22 kHz  454 nm  127 mA peak" in text
    assert "duration     0:32.5, about 6:32.5 with 2 prompts" in text
    assert "65,000 samples, 0.52 MB" in text


@pytest.mark.parametrize(("name", "panels"), [("map_test", 3), ("resonance_sweep", 4)])
def test_the_figure_has_units_on_every_axis(power_map: Rig, name: str, panels: int) -> None:
    found = dry_run(protocol_by_name_or_file(name), rig=power_map, heating=STEEL)
    chart = dry_run_chart(found)
    with publication_style():
        assert render_figure(draw_chart(chart), "png")
    assert len(chart.panels) == panels
    assert all(panel.y.unit for panel in chart.panels)
    assert chart.size[0] * 25.4 == pytest.approx(174, abs=1)
