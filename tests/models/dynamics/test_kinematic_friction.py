"""Kinematic friction factors against closed forms and fine sampling."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest import approx, raises
from scipy.special import ellipk
from tests.models.dynamics.tribometer_chain import TRIBOMETER

from sonolube.errors import InvalidInput
from sonolube.models.dynamics import (
    ExponentialGap,
    GapLaw,
    HertzGap,
    LinearGap,
    Status,
    SteadyStates,
    contact_motion,
    friction_averages,
    steady_state,
)
from sonolube.models.dynamics.harmonic_balance.extrema import response_measures
from sonolube.models.dynamics.structure import drive_receptance

ROUGH = ExponentialGap(decay_length=2e-6)
SPEEDS = np.geomspace(1e-3, 1.0, 16)


def random_states(points: int, damping: float = 0.0) -> SteadyStates:
    random = np.random.default_rng(3)
    frequency = random.uniform(5e3, 1e5, points)
    return steady_state(
        TRIBOMETER,
        replace(ROUGH, force_damping=damping),
        normal_load=random.uniform(1.0, 100.0, points),
        frequency=frequency,
        voltage_amplitude=np.abs(
            random.uniform(0.1e-6, 14e-6, points) / drive_receptance(TRIBOMETER, frequency=frequency)
        ),
        stability=False,
    )


def brute_force(states: SteadyStates, point: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    contact = contact_motion(states, point, samples=400_000)
    squared_velocity, relative_force = np.square(contact.velocity), contact.normal_force / states.normal_load[point]
    ratios = [speed / np.sqrt(speed**2 + squared_velocity) for speed in SPEEDS]
    return np.array([each.mean() for each in ratios]), np.array([np.mean(each * relative_force) for each in ratios])


@pytest.mark.parametrize("damping", [0.0, 0.2])
def test_averages_are_those_of_four_hundred_thousand_samples(damping: float) -> None:
    states = random_states(12, damping)
    means = friction_averages(states, sliding_speed=SPEEDS)
    for point in range(12):
        kinematic, loaded = brute_force(states, point)
        assert means.kinematic[point] == approx(kinematic, rel=2e-6)
        assert means.force_weighted[point] == approx(loaded, rel=1e-5)


def test_the_average_of_a_sinusoidal_motion_is_an_elliptic_integral() -> None:
    heavy = replace(
        TRIBOMETER, mass_matrix=1e6 * TRIBOMETER.mass_matrix, stiffness_matrix=1e6 * TRIBOMETER.stiffness_matrix
    )
    volts = np.abs(5e-6 / drive_receptance(heavy, frequency=22e3))
    states = steady_state(heavy, ROUGH, normal_load=3.0, frequency=22e3, voltage_amplitude=volts)
    speeds = np.geomspace(1e-5, 10.0, 13)
    ratio = 2 * np.pi * 22e3 * states.vibration_amplitude / speeds
    found = friction_averages(states, sliding_speed=speeds).kinematic
    assert found == approx(2 / np.pi * ellipk(-(ratio**2)), rel=1e-6)


def test_a_motion_with_more_than_two_extrema_is_averaged_accurately() -> None:
    drive = np.zeros(5, dtype=complex)
    drive[[0, 4]] = 1e-6 / drive_receptance(TRIBOMETER, frequency=4e3 * np.array([1, 5]))
    states = steady_state(TRIBOMETER, ROUGH, normal_load=[5.0], frequency=4e3, voltage_harmonics=drive)
    assert np.isnan(states.extremum_phases).all()
    means, (kinematic, loaded) = friction_averages(states, sliding_speed=SPEEDS), brute_force(states, 0)
    assert means.kinematic[0] == approx(kinematic, rel=1e-4)
    assert means.force_weighted[0] == approx(loaded, rel=1e-4)


@pytest.mark.parametrize("richness", [0.05, 0.3, 0.9, 1.8, 4.0])
def test_strong_higher_harmonics_between_two_extrema_are_averaged_accurately(richness: float) -> None:
    random, orders = np.random.default_rng(4), np.arange(2, 6)
    higher = random.normal(size=(24, 4)) + 1j * random.normal(size=(24, 4))
    higher *= richness / np.sum(orders**2 * (np.abs(higher.real) + np.abs(higher.imag)), axis=1, keepdims=True)
    harmonics = np.asarray(2e-6 * np.column_stack([np.ones(24), higher]), dtype=np.complex128)
    states = steady_state(TRIBOMETER, ROUGH, normal_load=3.0, frequency=20e3, voltage_amplitude=np.zeros(24))
    motion = (np.full(24, 2 * np.pi * 20e3), np.full(24, 3.0), np.full(24, 1e-6))
    phases = response_measures(ROUGH, *motion, harmonics, np.full(24, 5)).extremum_phases
    states = replace(
        states, mean_displacement=motion[2], harmonics=harmonics, extremum_phases=phases, harmonic_count=np.full(24, 5)
    )
    means = friction_averages(states, sliding_speed=SPEEDS)
    for point in np.flatnonzero(np.isfinite(phases[:, 0])):
        kinematic, loaded = brute_force(states, int(point))
        assert means.kinematic[point] == approx(kinematic, rel=2e-5)
        assert means.force_weighted[point] == approx(loaded, rel=2e-5)


@pytest.mark.parametrize(
    "law",
    [HertzGap(tip_radius=5e-3, effective_modulus=1e11), LinearGap(normal_stiffness=5e6)],
    ids=["sphere", "spring"],
)
def test_a_force_with_a_corner_at_the_loss_of_contact_is_averaged_accurately(law: GapLaw) -> None:
    frequency = np.linspace(18e3, 26e3, 12)
    swing = np.geomspace(0.5e-6, 8e-6, 12) / np.abs(drive_receptance(TRIBOMETER, frequency=frequency))
    states = steady_state(
        TRIBOMETER, law, normal_load=3.0, frequency=frequency, voltage_amplitude=swing, stability=False
    )
    found = np.flatnonzero(states.status == Status.PERIODIC)
    assert found.size > 1
    assert (states.contact_loss_fraction[found] > 0.1).any()
    means = friction_averages(states, sliding_speed=SPEEDS)
    for point in found:
        kinematic, loaded = brute_force(states, int(point))
        assert means.kinematic[point] == approx(kinematic, rel=2e-5)
        assert means.force_weighted[point] == approx(loaded, rel=2e-4)


def test_a_contact_at_rest_has_a_friction_factor_of_one() -> None:
    states = steady_state(TRIBOMETER, ROUGH, normal_load=3.0, frequency=22e3, voltage_amplitude=0.0)
    means = friction_averages(states, sliding_speed=SPEEDS)
    assert means.kinematic == approx(np.ones(16))
    assert means.force_weighted == approx(np.ones(16))


def test_without_sliding_the_mean_friction_of_a_vibrating_contact_is_zero() -> None:
    states = steady_state(TRIBOMETER, ROUGH, normal_load=3.0, frequency=22e3, voltage_amplitude=5.0)
    means = friction_averages(states, sliding_speed=[0.0, 0.1])
    assert means.kinematic[0] == means.force_weighted[0] == 0.0
    assert means.kinematic[1] > 0


def test_the_friction_factor_increases_with_speed_towards_one() -> None:
    means = friction_averages(random_states(50), sliding_speed=np.geomspace(1e-3, 1e3, 20))
    assert (np.diff(means.kinematic, axis=1) > 0).all()
    assert means.kinematic[:, -1] == approx(np.ones(50), abs=1e-4)
    assert means.force_weighted[:, -1] == approx(np.ones(50), abs=1e-4)


def test_a_negative_speed_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"sliding_speed must not be negative, got -1\.0 m/s"):
        friction_averages(random_states(1), sliding_speed=-1.0)


@pytest.mark.parametrize("tolerance", [1e-5, 1e-4, 1e-3])
def test_a_looser_tolerance_is_met_with_fewer_harmonics(tolerance: float) -> None:
    frequency, load = np.linspace(18e3, 26e3, 64), np.linspace(1.0, 10.0, 64)
    exact, loose = (
        steady_state(
            TRIBOMETER,
            ROUGH,
            normal_load=load[::-1],
            frequency=frequency,
            voltage_amplitude=np.geomspace(0.5, 14.0, 64),
            relative_tolerance=error,
        )
        for error in (1e-6, tolerance)
    )
    assert loose.harmonic_count.mean() < exact.harmonic_count.mean()
    assert loose.vibration_amplitude == approx(exact.vibration_amplitude, rel=tolerance)
    assert loose.mean_normal_force == approx(exact.mean_normal_force, rel=tolerance)
    speeds = np.geomspace(1e-3, 1.0, 7)
    means, known = (friction_averages(states, sliding_speed=speeds) for states in (loose, exact))
    assert means.force_weighted == approx(known.force_weighted, rel=3 * tolerance)
    assert means.kinematic == approx(known.kinematic, rel=3 * tolerance)
