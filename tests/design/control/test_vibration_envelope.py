"""Envelope of one mode against the admittance, the time march and the energy balance of the structure."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from pytest import approx, raises
from scipy.integrate import quad
from scipy.optimize import brentq

from sonolube.design.control import (
    FrictionCharacteristic,
    FrictionLoop,
    Process,
    amplitude_mode,
    assumed_mode,
    mode_admittance,
    mode_at_drive,
    next_envelope,
    simulate_closed_loop,
    tuned_controller,
)
from sonolube.errors import InvalidInput
from sonolube.models.contact import normal_stiffness, separation
from sonolube.models.dynamics import LinearGap, electrical_admittance, march
from sonolube.rig import read_rig, structure_in_contact
from sonolube.rig.driven_rig import driven_rig

RIGS = Path(__file__).parents[3] / "examples" / "rigs"
TRIBOMETER, COLLAR = driven_rig(read_rig(RIGS / "tribometer.toml")), read_rig(RIGS / "collar.toml")
DRIVEN = mode_at_drive(TRIBOMETER)
LINE = FrictionCharacteristic(level=np.array([0.0, 50.0]), friction_force=np.array([2.0, 0.5]))


def test_near_its_resonance_one_mode_has_the_admittance_of_the_structure() -> None:
    width = DRIVEN.decay_rate / (2 * np.pi)
    f = DRIVEN.natural_frequency + width * np.linspace(-2, 2, 9)
    structure = electrical_admittance(structure_in_contact(TRIBOMETER), frequency=f)
    mode = np.array([mode_admittance(DRIVEN, frequency=float(each)) for each in f])
    assert np.abs(mode - structure) == approx(0, abs=0.03 * np.abs(structure).max())


def test_the_envelope_rises_like_the_amplitude_of_the_marched_structure() -> None:
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
    computed = np.array(
        [abs(next_envelope(DRIVEN, 0j, level=1.0, rate=DRIVEN.rate(f), duration=float(t))[0]) for t in middle]
    )
    assert computed[1:] == approx(rising[1:], abs=0.01)


def test_the_supplied_energy_is_dissipated_or_stored() -> None:
    envelope, supplied, dissipated = 3 - 2j, 0.0, 0.0
    assert DRIVEN.motional_conductance is not None
    g, sigma = DRIVEN.motional_conductance, DRIVEN.decay_rate

    def stored(a: complex) -> float:
        return g * abs(a) ** 2 / (16 * sigma)

    start = stored(envelope)
    for volts, f in ((20.0, 22e3), (5.0, 21.7e3), (0.0, 22.4e3), (28.0, 22.1e3)):
        rate = DRIVEN.rate(f)

        def power(t: float, a: complex = envelope, u: float = volts, r: complex = rate) -> float:
            steady = sigma * u / r
            return float(g / 8 * abs(steady + (a - steady) * np.exp(-r * t)) ** 2)

        dissipated += quad(power, 0, 2e-4, epsabs=1e-14, epsrel=1e-12)[0]
        envelope, integral = next_envelope(DRIVEN, envelope, level=volts, rate=rate, duration=2e-4)
        supplied += g * volts * integral.real / 8
    assert supplied == approx(dissipated + stored(envelope) - start, rel=1e-9)


def test_the_steady_power_is_that_of_the_conductance() -> None:
    # Re(V I*)/2 for an amplitude of half the swing.
    loop = FrictionLoop(
        plant=LINE,
        mode=DRIVEN,
        controller=tuned_controller(
            LINE, Process(time_constant=3e-4, dead_time=0.0, sample_interval=2e-4), level_maximum=50.0
        ),
        tracker=None,
        level_maximum=50.0,
    )
    run = simulate_closed_loop(loop, setpoint=np.full(200, 1.25))  # 25 V
    assert run.electrical_energy is not None
    power = (run.electrical_energy[-1] - run.electrical_energy[-2]) / 2e-4
    volts = run.level[-1]
    assert power == approx(0.5 * mode_admittance(DRIVEN, frequency=22e3).real * (volts / 2) ** 2, rel=1e-9)


def test_an_assumed_mode_has_its_coupling_factor_between_series_and_parallel_resonance() -> None:
    mode = assumed_mode(COLLAR, quality_factor=5000.0, coupling_factor=0.1)

    def reactance(f: float) -> float:
        return mode_admittance(mode, frequency=f).imag

    lower, upper = 25e3 * (1 + 1e-4), 25e3 * 1.02
    parallel = brentq(reactance, lower, upper)
    assert 1 - (25e3 / parallel) ** 2 == approx(0.1**2, rel=0.02)


def test_an_assumed_mode_of_an_impossible_coupling_or_quality_is_refused() -> None:
    rig = read_rig(RIGS / "collar.toml")
    for coupling in (0.0, 5e-7, 1 - 5e-7, 1.0, 1.5, -0.2):
        with raises(InvalidInput, match="coupling_factor"):
            assumed_mode(rig, quality_factor=50.0, coupling_factor=coupling)
    for coupling in (2e-6, 1 - 2e-6):
        assert assumed_mode(rig, quality_factor=50.0, coupling_factor=coupling).damping_ratio == approx(0.01)
    for quality in (0.0, 0.5):
        with raises(InvalidInput, match="quality_factor"):
            assumed_mode(rig, quality_factor=quality, coupling_factor=0.2)
    assert amplitude_mode(rig, quality_factor=0.51).damping_ratio == approx(1 / 1.02)
    with raises(InvalidInput, match=r"actuator\.capacitance is missing"):
        assumed_mode(replace(rig, capacitance=None), quality_factor=50.0, coupling_factor=0.2)
