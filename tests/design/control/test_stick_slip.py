"""Suppression of stick-slip for a rig, and figures of control, on runs made by hand."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.charts import Line, Points, Rule
from sonolube.design.control import ClosedLoopRun, FrictionCharacteristic, PIGains, Process
from sonolube.design.control.closed_loop_simulation import Disturbance, ThermalDrift
from sonolube.design.control.control_design import (
    ControlSettings,
    _highest_level,
    _plant_gain,
    _require_no_voltage,
    _setpoint_history,
    control_dataset,
)
from sonolube.design.control.resonance_tracking import Amplifier
from sonolube.design.control.stick_slip import (
    closed_loop_chart,
    control_design_chart,
    stick_slip_chart,
    stick_slip_suppression,
)
from sonolube.design.control.stick_slip_oscillator import StickSlipMotion
from sonolube.errors import InvalidInput, OutsideRange, UnknownName
from sonolube.rig import AMPLITUDE, VOLTAGE, read_rig

RIG = read_rig(Path(__file__).parents[3] / "examples" / "rigs" / "collar.toml")  # 6.7 N, 0.26
PLANT = FrictionCharacteristic(level=np.array([0.0, 10.0, 40.0]), friction_force=np.array([2.0, 1.5, 0.5]))


def test_the_slider_is_held_by_the_assumed_holder_at_the_voltage_of_the_target() -> None:
    force = 0.26 * 6.7
    plant = FrictionCharacteristic(level=np.array([0.0, 28.0]), friction_force=np.array([force, 0.5 * force]))
    study: Any = SimpleNamespace(plant=plant, friction_force=0.75 * force)
    found = stick_slip_suppression(RIG, study)
    assert found.level == approx(14.0)
    assert found.quantity is VOLTAGE
    # 50 g on 20 kN/m: 80 periods of 2 pi sqrt(m/k)
    period = 2 * np.pi * np.sqrt(0.05 / 2e4)
    for motion in (found.still, found.vibrating):
        assert motion.time[-1] == approx(80 * period, rel=1e-3)
    # damping ratio 0.01: c = 0.02 sqrt(m k), less the fall of friction, (F_s - F_c) 2/v e^-1 at its own speed
    c = 0.02 * np.sqrt(0.05 * 2e4)
    slope = -0.3 * force * 2 / RIG.sliding_speed * np.exp(-1)
    assert found.damping[0] == approx(c + slope, rel=1e-3)
    assert found.damping[1] > found.damping[0]
    # it sticks up to the static friction, 1.3 of that of sliding
    held = found.still.friction_force[found.still.sticking]
    assert held.max() == approx(1.3 * force, rel=0.01)


def test_the_figure_of_stick_slip_shows_three_tenths_of_the_motion_in_milliseconds() -> None:
    time = np.linspace(0, 1.0, 20_001)
    motions = [
        StickSlipMotion(time=time, displacement=time, friction_force=scale * time, sticking=np.zeros(20_001, bool))
        for scale in (2.0, 3.0)
    ]
    known: Any = SimpleNamespace(still=motions[0], vibrating=motions[1], level=14.0, quantity=VOLTAGE)
    (panel,) = stick_slip_chart(known).panels
    still, vibrating = panel.parts
    assert isinstance(still, Line)
    assert isinstance(vibrating, Line)
    assert (still.x[0], still.x[-1], panel.x.highest) == approx((0.0, 300.0, 300.0), rel=0.01)
    assert still.x.size <= 3000
    assert still.x.size > 1500
    assert still.y == approx(2e-3 * still.x)
    assert vibrating.y == approx(3e-3 * vibrating.x)
    assert (still.label, vibrating.label) == ("without vibration", "with 14 V peak to peak")


def run_of(**changes: Any) -> ClosedLoopRun:
    known = {
        "time": np.array([0.0, 0.01, 0.02]),
        "setpoint": np.array([2.0, 1.0, 1.0]),
        "friction_force": np.array([2.0, 1.4, 1.1]),
        "measured_force": np.array([2.0, 2.0, 1.4]),
        "level": np.array([0.0, 20.0, 22.0]),
        "frequency": np.array([22e3, 21.9e3, 21.8e3]),
        "resonance_frequency": np.array([22e3, 21.7e3, 21.6e3]),
        "envelope": np.zeros(3, complex),
        "phase": np.array([0.1, 0.2, 0.3]),
        "electrical_energy": np.array([0.0, 1.0, 3.0]),
    }
    return ClosedLoopRun(**{**known, **changes})


def study_of(**changes: Any) -> Any:
    process = Process(time_constant=1e-3, dead_time=1e-3, sample_interval=2e-4)
    controller = SimpleNamespace(
        process=process,
        gains=PIGains(proportional_gain=0.4, integral_time=1.2e-3),
        intrinsic_friction_force=2.0,
        force_reduction=(0.0, 0.8, 1.5),
        level=(0.0, 20.0, 40.0),
    )
    known = {
        "plant": PLANT,
        "controller": controller,
        "run": run_of(),
        "fixed_frequency_run": None,
        "level_maximum": 40.0,
        "limit": "current",
        "friction_force": 1.0,
        "plant_gain": 0.8,
        "margins": SimpleNamespace(sensitivity_peak=1.6),
    }
    return SimpleNamespace(**{**known, **changes})


def test_the_closed_loop_is_drawn_with_its_target_limit_and_frequencies() -> None:
    friction, drive, frequency = closed_loop_chart(study_of()).panels
    force, target = friction.parts
    assert isinstance(force, Line)
    assert isinstance(target, Line)
    assert force.x == approx([0, 10, 20])
    assert force.y == approx([2.0, 1.4, 1.1])
    assert force.label == "friction"
    assert target.y == approx([2.0, 1.0, 1.0])
    assert target.is_stepped
    level, limit = drive.parts
    assert isinstance(level, Line)
    assert isinstance(limit, Rule)
    assert level.y == approx([0.0, 20.0, 22.0])
    assert (limit.value, limit.along, limit.label) == (40.0, "y", "current limit")
    assert drive.y.highest == approx(1.12 * 40)
    own, resonance = frequency.parts
    assert isinstance(own, Line)
    assert isinstance(resonance, Line)
    assert own.y == approx([22.0, 21.9, 21.8])
    assert resonance.y == approx([22.0, 21.7, 21.6])
    # from 21.6 to 22 kHz: a margin of a twentieth of the span
    assert (frequency.y.lowest, frequency.y.highest) == approx((21.8 - 0.22, 21.8 + 0.22))
    assert (friction.x.lowest, friction.x.highest) == approx((0.0, 20.0))


def test_rounding_of_a_frequency_is_not_drawn_as_motion() -> None:
    still = run_of(frequency=np.full(3, 22e3), resonance_frequency=np.full(3, 22e3 + 1e-6))
    axis = closed_loop_chart(study_of(run=still)).panels[2].y
    assert (axis.lowest, axis.highest) == approx((22 - 0.022, 22 + 0.022))


def test_a_run_at_a_fixed_frequency_stands_beside_and_an_amplitude_has_no_frequencies() -> None:
    fixed = run_of(friction_force=np.array([2.0, 1.8, 1.7]), level=np.array([0.0, 30.0, 40.0]))
    friction, drive, _ = closed_loop_chart(study_of(fixed_frequency_run=fixed)).panels
    assert [getattr(part, "label", "") for part in friction.parts] == ["frequency fixed", "resonance tracked", "target"]
    first = drive.parts[0]
    assert isinstance(first, Line)
    assert first.y == approx([0.0, 30.0, 40.0])
    commanded = study_of(
        run=run_of(phase=None, electrical_energy=None, level=np.array([0.0, 1e-6, 2e-6])),
        plant=replace(PLANT, level=1e-7 * PLANT.level, quantity=AMPLITUDE),
        level_maximum=4e-6,
    )
    panels = closed_loop_chart(commanded).panels
    assert len(panels) == 2
    amplitude = panels[1].parts[0]
    assert isinstance(amplitude, Line)
    assert amplitude.y == approx([0.0, 1.0, 2.0])  # um


def test_the_design_is_drawn_by_its_map_and_its_sensitivity() -> None:
    lookup, loop = control_design_chart(study_of()).panels
    model, table, target = lookup.parts
    assert isinstance(model, Line)
    assert isinstance(table, Line)
    assert isinstance(target, Points)
    assert model.x == approx([0.0, 10.0, 40.0])
    assert model.y == approx([2.0, 1.5, 0.5])
    assert table.x == approx([0.0, 20.0, 40.0])
    assert table.y == approx([2.0, 1.2, 0.5])
    assert (target.x[0], target.y[0]) == approx((25.0, 1.0))  # half of the way from 1.5 N to 0.5 N
    curve, peak, one = loop.parts
    assert isinstance(curve, Line)
    assert isinstance(peak, Rule)
    assert isinstance(one, Rule)
    assert (curve.x[0], curve.x[-1]) == approx((2.5, 2500.0))
    assert (peak.value, one.value, peak.label) == (1.6, 1.0, "maximum, 1.60")
    assert loop.y.highest == approx(1.25 * 1.6)
    # |1 + g L| with P of a lag and d intervals, C = K (1 + T/(tau (z - 1)) z) of a PI in each interval
    f, t, k, integral = 100.0, 2e-4, 0.4, 1.2e-3
    z = np.exp(2j * np.pi * f * t)
    p = np.exp(-t / 1e-3)
    response = 0.8 * (1 - p) / (z - p) * z**-5 * k * (1 + t / integral / (z - 1))
    assert np.interp(f, curve.x, curve.y) == approx(1 / abs(1 + response), rel=0.02)


def test_settings_ask_for_twenty_intervals_and_a_known_feed_forward() -> None:
    assert ControlSettings(duration=20 * 2e-4).duration == approx(4e-3)
    with raises(InvalidInput, match=r"makes 19 intervals of 0\.0002 s; take one that makes 20 to 500000"):
        ControlSettings(duration=19 * 2e-4)
    with raises(InvalidInput, match="intervals"):
        ControlSettings(duration=500_002 * 2e-4)
    with raises(UnknownName, match="unknown feed-forward 'magic'"):
        ControlSettings(feed_forward="magic")


def test_the_set_point_steps_after_a_tenth_and_after_eleven_twentieths() -> None:
    history = _setpoint_history(ControlSettings(duration=0.02, sample_interval=2e-4), 2.0, 1.0)
    assert history.size == 100
    assert np.flatnonzero(np.diff(history)).tolist() == [9, 54]
    assert history[[0, 10, 55]] == approx([2.0, 1.0, 1.5])


def test_a_commanded_amplitude_takes_no_options_of_a_voltage() -> None:
    _require_no_voltage(ControlSettings())
    with raises(InvalidInput, match="feed-forward by efficiency is over power, which a commanded amplitude has none"):
        _require_no_voltage(ControlSettings(feed_forward="efficiency"))
    with raises(InvalidInput, match="a commanded amplitude has no drift here"):
        _require_no_voltage(ControlSettings(drift=ThermalDrift(final_temperature_rise=10.0)))


def test_the_highest_level_is_that_of_the_amplifier_or_of_the_amplitude() -> None:
    amplitude = read_rig(Path(__file__).parents[3] / "examples" / "rigs" / "cutter_head.toml")
    mode: Any = SimpleNamespace(frequency=25e3)
    assert _highest_level(amplitude, ControlSettings(), mode) == (amplitude.vibration_amplitude, "amplitude")
    assert _highest_level(amplitude, ControlSettings(amplitude_maximum=1e-6), mode) == (1e-6, "amplitude")
    with raises(InvalidInput, match="a drive voltage needs the limits of its amplifier"):
        _highest_level(RIG, ControlSettings(), mode)


def test_the_gain_is_the_slope_of_the_plant_over_that_of_the_table() -> None:
    # at 1 N the plant falls by 1 N in 30 V; the table by 0.7 N in 20 V there: 25 V
    controller: Any = study_of().controller
    assert _plant_gain(PLANT, controller, 1.0, 1.0) == approx((1 / 30) / (0.7 / 20))
    # friction of 1.25 times that of the plant: 0.8 N of it, at 31 V
    assert _plant_gain(PLANT, controller, 1.0, 1.25) == approx(1.25 * (1 / 30) / (0.7 / 20))
    short: Any = SimpleNamespace(intrinsic_friction_force=2.0, force_reduction=(0.0, 0.8), level=(0.0, 20.0))
    with raises(OutsideRange, match=r"friction_force 1 N needs 25 V by the rig's model, .* predicts 1\.2 N at 20 V"):
        _plant_gain(PLANT, short, 1.0, 1.0)


def test_the_dataset_of_a_run_has_electrical_quantities_under_a_voltage_only() -> None:
    found = control_dataset(study_of(), title="run")
    assert found["voltage_peak_to_peak"].values == approx([0.0, 20.0, 22.0])
    assert {"frequency", "resonance_frequency", "phase", "electrical_energy"} <= set(found.variables)
    commanded = control_dataset(
        study_of(run=run_of(phase=None, electrical_energy=None), plant=replace(PLANT, quantity=AMPLITUDE)), title="run"
    )
    assert set(commanded.variables) == {"time", "friction_force", "vibration_amplitude"}


def test_drift_warms_towards_its_end_and_is_refused_beyond_a_tenth() -> None:
    drift = ThermalDrift(final_temperature_rise=50.0, warming_time=2.0, frequency_per_temperature=-1e-3)
    assert drift.shift(0.0) == 0.0
    assert drift.shift(2.0) == approx(-0.05 * (1 - np.exp(-1)))
    ThermalDrift(final_temperature_rise=100.0, frequency_per_temperature=-1e-3)
    with raises(InvalidInput, match="must shift the resonance by no more than a tenth"):
        ThermalDrift(final_temperature_rise=101.0, frequency_per_temperature=-1e-3)
    refused: tuple[dict[str, Any], ...] = ({"friction_factor": 0.0}, {"later_factor": -1.0}, {"start_time": -1.0})
    for changes in refused:
        with raises(InvalidInput):
            Disturbance(**changes)


@pytest.mark.parametrize("changes", [{"voltage_maximum": 0.0}, {"current_maximum": -1.0}, {"slew_rate_maximum": 0.0}])
def test_a_limit_of_an_amplifier_is_positive(changes: dict[str, float]) -> None:
    with raises(InvalidInput, match=next(iter(changes))):
        Amplifier(**{"voltage_maximum": 10.0, **changes})
