"""The envelope of the driven vibration, its tracking and its energy."""

from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises
from scipy.integrate import quad
from scipy.optimize import brentq

from sonolube.contact import normal_stiffness, separation
from sonolube.design.control import (
    FrictionCharacteristic,
    FrictionLoop,
    Process,
    ThermalDrift,
    VibrationMode,
    assumed_mode,
    capture_limit,
    computed_characteristic,
    efficiency_characteristic,
    impedance_phase,
    mode_admittance,
    mode_at_drive,
    next_envelope,
    next_frequency,
    simulate_closed_loop,
    tuned_controller,
    tuned_tracker,
)
from sonolube.dynamics import LinearGap, electrical_admittance, march
from sonolube.errors import InvalidInput
from sonolube.metrics import EfficiencyLine, efficiency_coefficient
from sonolube.rig import friction_point, read_rig, touching_structure
from sonolube.rig.excitation import amplifier_power

RIGS = Path(__file__).parents[3] / "examples" / "rigs"
TRIBOMETER, COLLAR = read_rig(RIGS / "tribometer.toml"), read_rig(RIGS / "collar.toml")
DRIVEN = mode_at_drive(TRIBOMETER)
SHARP = VibrationMode(
    natural_frequency=25e3, damping_ratio=1e-4, motional_conductance=0.1, parallel_capacitance=1e-7, frequency=25e3
)
MAP = FrictionCharacteristic(voltage_peak_to_peak=np.array([0.0, 50.0]), friction_force=np.array([2.0, 0.5]))


def test_near_the_drive_one_mode_has_the_admittance_of_the_structure() -> None:
    width = DRIVEN.decay_rate / (2 * np.pi)
    f = DRIVEN.natural_frequency + width * np.linspace(-2, 2, 9)
    whole = electrical_admittance(touching_structure(TRIBOMETER), frequency=f)
    alone = np.array([mode_admittance(DRIVEN, frequency=float(each)) for each in f])
    assert np.abs(alone - whole) == approx(0, abs=0.03 * np.abs(whole).max())


def test_the_envelope_settles_as_the_marched_structure_does() -> None:
    assert TRIBOMETER.structure is not None
    gap = separation(TRIBOMETER.contact, normal_load=3.0)
    law = LinearGap(normal_stiffness=float(normal_stiffness(TRIBOMETER.contact, separation=gap)))
    f = DRIVEN.natural_frequency
    marched = march(
        TRIBOMETER.structure,
        law,
        normal_load=3.0,
        frequency=f,
        voltage_peak_to_peak=1.0,
        periods=60,
        steps_per_period=32,
        periods_per_window=1,
    ).envelope
    rising = marched.first_harmonic_amplitude / marched.first_harmonic_amplitude[-1]
    middle = marched.time - 0.5 / f
    mine = np.array(
        [
            abs(next_envelope(DRIVEN, 0j, voltage_peak_to_peak=1.0, rate=DRIVEN.rate(f), duration=float(t))[0])
            for t in middle
        ]
    )
    assert mine[1:] == approx(rising[1:], abs=0.01)


def test_what_the_motion_takes_it_loses_or_holds() -> None:
    envelope, taken, lost = 3 - 2j, 0.0, 0.0
    g, sigma = DRIVEN.motional_conductance, DRIVEN.decay_rate

    def held(a: complex) -> float:
        return g * abs(a) ** 2 / (16 * sigma)

    start = held(envelope)
    for volts, f in ((20.0, 22e3), (5.0, 21.7e3), (0.0, 22.4e3), (28.0, 22.1e3)):
        rate = DRIVEN.rate(f)

        def power(t: float, a: complex = envelope, u: float = volts, r: complex = rate) -> float:
            kept = sigma * u / r
            return float(g / 8 * abs(kept + (a - kept) * np.exp(-r * t)) ** 2)

        lost += quad(power, 0, 2e-4, epsabs=1e-14, epsrel=1e-12)[0]
        envelope, integral = next_envelope(DRIVEN, envelope, voltage_peak_to_peak=volts, rate=rate, duration=2e-4)
        taken += g * volts * integral.real / 8
    assert taken == approx(lost + held(envelope) - start, rel=1e-9)


def test_steady_power_is_that_of_the_conductance() -> None:
    # Re(V I*)/2 for an amplitude of half the swing.
    loop = FrictionLoop(
        plant=MAP,
        mode=DRIVEN,
        controller=tuned_controller(
            MAP, Process(time_constant=3e-4, dead_time=0.0, sample_interval=2e-4), voltage_maximum=50.0
        ),
        tracker=None,
        voltage_maximum=50.0,
    )
    run = simulate_closed_loop(loop, setpoint=np.full(200, 1.25))  # 25 V
    power = (run.electrical_energy[-1] - run.electrical_energy[-2]) / 2e-4
    volts = run.voltage_peak_to_peak[-1]
    assert power == approx(0.5 * mode_admittance(DRIVEN, frequency=22e3).real * (volts / 2) ** 2, rel=1e-9)


def test_a_supposed_mode_has_its_coupling_between_series_and_parallel_resonance() -> None:
    mode = assumed_mode(COLLAR, quality_factor=5000.0, coupling_factor=0.1)

    def reactance(f: float) -> float:
        return mode_admittance(mode, frequency=f).imag

    lower, upper = 25e3 * (1 + 1e-4), 25e3 * 1.02
    parallel = brentq(reactance, lower, upper)
    assert 1 - (25e3 / parallel) ** 2 == approx(0.1**2, rel=0.02)


@pytest.mark.parametrize("mode", [DRIVEN, SHARP], ids=["tribometer", "sharp"])
def test_capture_ends_where_the_phase_comes_back(mode: VibrationMode) -> None:
    wanted, edge = impedance_phase(mode, frequency=mode.frequency), capture_limit(mode)
    beyond = edge - mode.frequency
    f = mode.frequency + beyond * np.linspace(0.05, 1.5, 3000)
    miss = np.array([impedance_phase(mode, frequency=float(each)) for each in f]) - wanted
    back = f[np.flatnonzero((miss[:-1] > 0) & (miss[1:] <= 0))[0]]
    # the susceptance of the capacitance is taken as constant, which it is to edge/f
    assert back - mode.frequency == approx(beyond, rel=1.2 * beyond / mode.frequency + 2e-3)


@pytest.mark.parametrize(("start", "home"), [(-5.0, True), (0.9, True), (1.1, False)])
def test_a_tracker_comes_home_from_below_the_edge_and_not_from_above(start: float, home: bool) -> None:
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
    assert (f == approx(SHARP.frequency, rel=1e-9)) == home


def test_near_lock_the_phase_error_decays_with_the_time_asked_for() -> None:
    tracker = tuned_tracker(SHARP, sample_interval=1e-3, closed_loop_time=0.1)
    f = SHARP.frequency * (1 + 1e-7)
    for _ in range(100):
        f = next_frequency(tracker, frequency=f, phase=impedance_phase(SHARP, frequency=f))
    assert f - SHARP.frequency == approx(SHARP.frequency * 1e-7 * 0.99**100, rel=1e-3)


def test_a_tracked_drive_follows_the_drifting_resonance_and_keeps_its_voltage() -> None:
    process = Process(time_constant=DRIVEN.time_constant, dead_time=1e-3, sample_interval=2e-4)
    parts = {
        "plant": MAP,
        "mode": DRIVEN,
        "controller": tuned_controller(MAP, process, voltage_maximum=50.0),
        "voltage_maximum": 50.0,
    }
    drift = ThermalDrift(final_temperature_rise=100.0, warming_time=0.05)
    tracker = tuned_tracker(DRIVEN, sample_interval=2e-4)
    tracked = simulate_closed_loop(FrictionLoop(**parts, tracker=tracker), setpoint=np.full(3000, 1.0), drift=drift)  # type: ignore[arg-type]
    fixed = simulate_closed_loop(FrictionLoop(**parts, tracker=None), setpoint=np.full(3000, 1.0), drift=drift)  # type: ignore[arg-type]
    fell = DRIVEN.natural_frequency * 2e-4 * 100 * (1 - np.exp(-0.6 / 0.05))
    assert tracked.frequency[-1] == approx(22e3 - fell, abs=5)
    assert tracked.voltage_peak_to_peak[-1] == approx(MAP.voltage_peak_to_peak[1] * 1.0 / 1.5, rel=1e-3)
    detuned = 2 * np.pi * fell / DRIVEN.decay_rate
    assert fixed.voltage_peak_to_peak[-1] == approx(50 / 1.5 * np.hypot(1, detuned), rel=0.02)


def test_a_drive_where_the_phase_falls_cannot_be_tracked() -> None:
    above = VibrationMode(
        natural_frequency=25e3, damping_ratio=0.02, motional_conductance=0.1, parallel_capacitance=1e-7, frequency=30e3
    )
    with raises(InvalidInput, match="the phase of the impedance falls with frequency"):
        tuned_tracker(above, sample_interval=1e-4)


def test_the_map_of_a_rig_without_structure_goes_through_its_own_operating_point() -> None:
    known = computed_characteristic(COLLAR, voltage_maximum=56.0, points=3)
    own = friction_point(COLLAR).friction_force
    assert known.voltage_peak_to_peak[1] == 28.0
    assert known.friction_force[1] == approx(own)
    assert known.highest_force == approx(0.26 * 6.7)


def test_every_point_of_an_efficiency_map_has_the_efficiency_of_the_line() -> None:
    line = EfficiencyLine(slope=0.0, intercept=2e-9)
    known = efficiency_characteristic(TRIBOMETER, line, voltage_maximum=20.0, points=5)
    assert TRIBOMETER.drive is not None
    volts = known.voltage_peak_to_peak[1:]
    power = amplifier_power(
        TRIBOMETER.drive, capacitance=360e-9, voltage_peak_to_peak=volts, voltage_offset=0.5 * volts
    )
    found = efficiency_coefficient(
        intrinsic_friction_force=known.highest_force,
        reduced_friction_force=known.friction_force[1:],
        sliding_speed=0.0203,
        nominal_area=2.25e-6,
        normal_load=3.0,
        actuator_power=power,
    )
    assert found == approx(2e-9)
