"""Resonance tracking: capture range, convergence and drift, against the impedance of a mode."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.design.control import (
    FrictionCharacteristic,
    FrictionLoop,
    Process,
    ThermalDrift,
    VibrationMode,
    capture_limit,
    impedance_phase,
    mode_at_drive,
    next_frequency,
    simulate_closed_loop,
    tuned_controller,
    tuned_tracker,
)
from sonolube.errors import InvalidInput
from sonolube.rig import read_rig

DRIVEN = mode_at_drive(read_rig(Path(__file__).parents[3] / "examples" / "rigs" / "tribometer.toml"))
SHARP = VibrationMode(
    natural_frequency=25e3, damping_ratio=1e-4, motional_conductance=0.1, parallel_capacitance=1e-7, frequency=25e3
)
LINE = FrictionCharacteristic(level=np.array([0.0, 50.0]), friction_force=np.array([2.0, 0.5]))


@pytest.mark.parametrize("mode", [DRIVEN, SHARP], ids=["tribometer", "sharp"])
def test_the_capture_range_ends_where_the_phase_returns_to_its_nominal_value(mode: VibrationMode) -> None:
    nominal, edge = impedance_phase(mode, frequency=mode.frequency), capture_limit(mode)
    beyond = edge - mode.frequency
    f = mode.frequency + beyond * np.linspace(0.05, 1.5, 3000)
    miss = np.array([impedance_phase(mode, frequency=float(each)) for each in f]) - nominal
    recrossing = f[np.flatnonzero((miss[:-1] > 0) & (miss[1:] <= 0))[0]]
    # the susceptance of the capacitance is taken as constant, which it is to edge/f
    assert recrossing - mode.frequency == approx(beyond, rel=1.2 * beyond / mode.frequency + 2e-3)


@pytest.mark.parametrize(("start", "converges"), [(-5.0, True), (0.9, True), (1.1, False)])
def test_a_tracker_converges_from_below_the_capture_limit_and_not_from_above(start: float, converges: bool) -> None:
    tracker = tuned_tracker(SHARP, sample_interval=1e-4, closed_loop_time=5e-3)
    f = SHARP.frequency + start * (capture_limit(SHARP) - SHARP.frequency)
    free = type(tracker)(
        phase=tracker.phase,
        frequency=tracker.frequency,
        frequency_gain=tracker.frequency_gain,
        lowest_frequency=0.5 * SHARP.frequency,
        highest_frequency=2 * SHARP.frequency,
    )
    for _ in range(60_000):
        f = next_frequency(free, frequency=f, phase=impedance_phase(SHARP, frequency=f))
    assert (f == approx(SHARP.frequency, rel=1e-9)) == converges


def test_near_lock_the_phase_error_decays_with_the_closed_loop_time() -> None:
    tracker = tuned_tracker(SHARP, sample_interval=1e-3, closed_loop_time=0.1)
    f = SHARP.frequency * (1 + 1e-7)
    for _ in range(100):
        f = next_frequency(tracker, frequency=f, phase=impedance_phase(SHARP, frequency=f))
    assert f - SHARP.frequency == approx(SHARP.frequency * 1e-7 * 0.99**100, rel=1e-3)


def test_a_tracked_drive_follows_the_drifting_resonance_at_constant_voltage() -> None:
    process = Process(time_constant=DRIVEN.time_constant, dead_time=1e-3, sample_interval=2e-4)
    parts = {
        "plant": LINE,
        "mode": DRIVEN,
        "controller": tuned_controller(LINE, process, level_maximum=50.0),
        "level_maximum": 50.0,
    }
    drift = ThermalDrift(final_temperature_rise=100.0, warming_time=0.05)
    tracker = tuned_tracker(DRIVEN, sample_interval=2e-4)
    tracked = simulate_closed_loop(FrictionLoop(**parts, tracker=tracker), setpoint=np.full(3000, 1.0), drift=drift)  # type: ignore[arg-type]
    fixed = simulate_closed_loop(FrictionLoop(**parts, tracker=None), setpoint=np.full(3000, 1.0), drift=drift)  # type: ignore[arg-type]
    shift = DRIVEN.natural_frequency * 2e-4 * 100 * (1 - np.exp(-0.6 / 0.05))
    assert tracked.frequency[-1] == approx(22e3 - shift, abs=5)
    assert tracked.level[-1] == approx(LINE.level[1] * 1.0 / 1.5, rel=1e-3)
    detuned = 2 * np.pi * shift / DRIVEN.decay_rate
    assert fixed.level[-1] == approx(50 / 1.5 * np.hypot(1, detuned), rel=0.02)


def test_a_drive_at_which_the_phase_falls_with_frequency_is_refused() -> None:
    above = VibrationMode(
        natural_frequency=25e3, damping_ratio=0.02, motional_conductance=0.1, parallel_capacitance=1e-7, frequency=30e3
    )
    with raises(InvalidInput, match="the phase of the impedance falls with frequency"):
        tuned_tracker(above, sample_interval=1e-4)
