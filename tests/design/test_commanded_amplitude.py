"""Rigs commanded by their amplitude against the same rigs under the voltage that gives it."""

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from pytest import approx, raises

from sonolube.charts import draw_chart
from sonolube.design import map_chart, velocity_amplitude_map, velocity_power_map, velocity_stress_map
from sonolube.design.control import (
    ControlSettings,
    amplitude_mode,
    computed_characteristic,
    controller_source,
    design_control,
    level_for_friction,
)
from sonolube.errors import InvalidInput
from sonolube.figure import render_figure
from sonolube.rig import (
    AMPLITUDE,
    STUDY_CHARTS,
    VOLTAGE,
    Rig,
    amplitude_study,
    commanded_quantity,
    load_study,
    operating_points,
    own_level,
    read_rig,
    speed_study,
    voltage_study,
)

PER_VOLT = 40e-9
UNDER_VOLTAGE = read_rig(
    Path(__file__).parents[2] / "examples" / "rigs" / "flextensional.toml",
    changes=[f"actuator.amplitude_per_volt={PER_VOLT}m/V"],
)
VOLTS = np.array([30.0, 60.0, 90.0])
SPEEDS = [0.02, 0.1]
COMPILER = next((found for name in ("cc", "gcc", "clang") if (found := shutil.which(name))), None)


def by_amplitude(rig: Rig) -> Rig:
    assert rig.drive is not None
    return replace(
        rig,
        drive=replace(rig.drive, voltage_peak_to_peak=None, voltage_offset=0.0),
        amplitude_per_volt=None,
        amplitude_source=None,
        measured_under=None,
        vibration_amplitude=3e-6,
    )


BY_AMPLITUDE = by_amplitude(UNDER_VOLTAGE)


def test_a_rig_is_commanded_by_its_voltage_or_else_by_its_amplitude() -> None:
    assert commanded_quantity(UNDER_VOLTAGE) is VOLTAGE
    assert commanded_quantity(BY_AMPLITUDE) is AMPLITUDE
    assert own_level(BY_AMPLITUDE) == 3e-6


def test_a_voltage_and_the_amplitude_that_it_makes_have_the_same_friction() -> None:
    loads = [4.0, 8.0]
    volts = velocity_stress_map(UNDER_VOLTAGE, sliding_speed=SPEEDS, normal_load=loads, voltage_peak_to_peak=VOLTS)
    amplitudes = velocity_stress_map(
        BY_AMPLITUDE, sliding_speed=SPEEDS, normal_load=loads, vibration_amplitude=PER_VOLT * VOLTS
    )
    assert amplitudes["friction_ratio"].values == approx(volts["friction_ratio"].values, rel=1e-12)
    up = velocity_amplitude_map(
        BY_AMPLITUDE, sliding_speed=SPEEDS, normal_load=loads, vibration_amplitude=PER_VOLT * VOLTS
    )
    power = velocity_power_map(UNDER_VOLTAGE, sliding_speed=SPEEDS, normal_load=loads, voltage_peak_to_peak=VOLTS)
    assert up["friction_ratio"].values == approx(power["friction_ratio"].values, rel=1e-12)


def test_studies_over_voltage_and_over_amplitude_agree() -> None:
    volts = voltage_study(UNDER_VOLTAGE, voltage_peak_to_peak=[0.0, *VOLTS])
    amplitudes = amplitude_study(BY_AMPLITUDE, vibration_amplitude=PER_VOLT * np.array([0.0, *VOLTS]))
    assert volts["vibration_amplitude"].values == approx(amplitudes["vibration_amplitude"].values)
    for name in ("friction_ratio", "displacement", "normal_force"):
        assert amplitudes[name].values == approx(volts[name].values, rel=1e-12, abs=1e-18)
    assert amplitudes["friction_ratio"].values[0] == approx(1.0)
    fast = speed_study(BY_AMPLITUDE, sliding_speed=SPEEDS, vibration_amplitude=PER_VOLT * VOLTS)
    driven = speed_study(UNDER_VOLTAGE, sliding_speed=SPEEDS, voltage_peak_to_peak=VOLTS)
    assert fast["friction_ratio"].values == approx(driven["friction_ratio"].values, rel=1e-12)


def test_a_sine_carries_every_load_in_its_mean() -> None:
    study = amplitude_study(BY_AMPLITUDE, vibration_amplitude=[1e-6, 3e-6])
    assert study["normal_force"].mean("phase").values == approx(BY_AMPLITUDE.normal_load, rel=1e-6)


def test_what_has_no_voltage_has_no_power() -> None:
    results = (
        velocity_amplitude_map(BY_AMPLITUDE, sliding_speed=SPEEDS, normal_load=[5.0], vibration_amplitude=[1e-6, 2e-6]),
        amplitude_study(BY_AMPLITUDE, vibration_amplitude=[1e-6]),
        speed_study(BY_AMPLITUDE, sliding_speed=SPEEDS),
        load_study(BY_AMPLITUDE, normal_load=[3.0, 5.0]),
    )
    for result in results:
        units = {variable.attrs.get("units") for variable in result.variables.values()}
        assert not units & {"V", "W"}


@pytest.mark.parametrize(
    ("of", "study"),
    [
        ("amplitude", amplitude_study(BY_AMPLITUDE, vibration_amplitude=[1e-6, 3e-6])),
        ("speed", speed_study(BY_AMPLITUDE, sliding_speed=SPEEDS)),
        ("load", load_study(BY_AMPLITUDE, normal_load=[3.0, 5.0])),
    ],
)
def test_studies_without_a_voltage_are_drawn_in_micrometres(of: str, study: xr.Dataset) -> None:
    chart = STUDY_CHARTS[of](study)
    labels = [panel.x.text for panel in chart.panels]
    assert not any("[V]" in label for label in labels)
    assert ("Vibration amplitude [µm]" in labels) == (of == "amplitude")
    assert len(render_figure(draw_chart(chart), "svg")) > 5_000


def test_panels_of_amplitudes_are_titled_by_them() -> None:
    mapped = velocity_stress_map(
        BY_AMPLITUDE, sliding_speed=SPEEDS, normal_load=[4.0, 8.0], vibration_amplitude=[1.5e-6, 3e-6]
    )
    assert [panel.title for panel in map_chart(mapped).panels[:2]] == ["amplitude 1.5 um", "amplitude 3 um"]


def test_the_quantity_that_does_not_set_the_vibration_is_refused() -> None:
    with raises(InvalidInput, match=r"its voltage sets its amplitude; vary drive\.voltage_peak_to_peak"):
        velocity_amplitude_map(UNDER_VOLTAGE, sliding_speed=SPEEDS, normal_load=[5.0], vibration_amplitude=[1e-6])
    with raises(InvalidInput, match=r"its voltage sets its amplitude"):
        operating_points(UNDER_VOLTAGE, vibration_amplitude=1e-6)
    with raises(InvalidInput, match=r"drive\.voltage_peak_to_peak is missing"):
        voltage_study(BY_AMPLITUDE, voltage_peak_to_peak=[1.0])
    with raises(InvalidInput, match="vibration_amplitude must not be negative"):
        operating_points(BY_AMPLITUDE, vibration_amplitude=-1e-6)


def test_both_characteristics_are_one_curve() -> None:
    volts = computed_characteristic(UNDER_VOLTAGE, level_maximum=90.0, points=10)
    amplitudes = computed_characteristic(BY_AMPLITUDE, level_maximum=90.0 * PER_VOLT, points=10)
    assert amplitudes.level == approx(PER_VOLT * volts.level)
    assert amplitudes.friction_force == approx(volts.friction_force, rel=1e-12)
    assert amplitudes.quantity is AMPLITUDE


@pytest.mark.parametrize("highest", [None, 2e-6])
def test_a_controller_commands_a_rising_table_of_amplitudes_up_to_its_limit(highest: float | None) -> None:
    mode = amplitude_mode(BY_AMPLITUDE, quality_factor=50.0)
    design = design_control(BY_AMPLITUDE, ControlSettings(amplitude_maximum=highest), mode=mode)
    assert design.level_maximum == (highest or 3e-6)
    assert np.all(np.diff(design.controller.level) > 0)
    assert np.all(np.diff(design.controller.force_reduction) > 0)
    assert design.run.level.max() <= design.level_maximum
    assert design.run.phase is design.run.electrical_energy is None
    assert design.energy.amplifier_energy is design.energy.electrical_energy is None
    before_second_step = int(0.5 * design.run.time.size)
    wanted = float(level_for_friction(design.plant, friction_force=design.friction_force))
    assert design.run.level[before_second_step] == approx(wanted, rel=1e-6)


def test_a_sharper_resonance_follows_its_set_point_more_slowly() -> None:
    # the envelope of a resonance decays by 1/(pi f/Q)
    mode = amplitude_mode(BY_AMPLITUDE, quality_factor=50.0)
    assert mode.time_constant == approx(50.0 / (np.pi * mode.frequency))
    with raises(InvalidInput, match="no electrical branch"):
        _ = mode.branch


@pytest.mark.skipif(COMPILER is None, reason="no C compiler on this machine")
def test_the_source_of_an_amplitude_compiles_and_names_no_voltage(tmp_path: Path) -> None:
    mode = amplitude_mode(BY_AMPLITUDE, quality_factor=50.0)
    text = controller_source(design_control(BY_AMPLITUDE, ControlSettings(), mode=mode).controller, None, title="a rig")
    assert "volt" not in text.lower()
    (tmp_path / "controller.c").write_text(text, encoding="utf-8")
    strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"]
    assert COMPILER is not None
    subprocess.run([COMPILER, *strict, "-c", "-o", tmp_path / "controller.o", tmp_path / "controller.c"], check=True)
