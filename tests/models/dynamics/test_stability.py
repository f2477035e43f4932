"""Floquet multipliers against the directly integrated variational equation and closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest import approx
from scipy.integrate import solve_ivp
from tests.models.dynamics.floquet_multipliers import floquet_multipliers
from tests.models.dynamics.tribometer_chain import TRIBOMETER

from sonolube.models.dynamics import ExponentialGap, GapLaw, HertzGap, LinearGap, Status, SteadyStates, steady_state
from sonolube.models.dynamics.linear import poles
from sonolube.models.dynamics.structure import drive_receptance, with_contact_spring

ROUGH = ExponentialGap(decay_length=2e-6)


def states_at(gap_law: GapLaw, load: float, frequency: float, amplitude: float) -> SteadyStates:
    volts = abs(amplitude / drive_receptance(TRIBOMETER, frequency=frequency))
    return steady_state(TRIBOMETER, gap_law, normal_load=load, frequency=frequency, voltage_amplitude=volts)


def integrated(states: SteadyStates) -> NDArray[np.complex128]:
    """Return the multipliers from direct integration of the variational equation of the coordinates."""
    structure, law, n = states.structure, states.gap_law, states.structure.coordinates
    omega, load = 2 * np.pi * float(states.frequency), np.float64(states.normal_load)
    inverse, k = np.linalg.inv(structure.mass_matrix), np.arange(1, states.harmonics.size + 1)
    share = np.outer(structure.contact_vector, structure.contact_vector)

    def rate(time: float, flat: NDArray[np.float64]) -> NDArray[np.float64]:
        place, speed = flat.reshape(2, n, 2 * n)
        turning = states.harmonics * np.exp(1j * k * omega * time)
        x, v = states.mean_displacement + turning.sum().real, (1j * k * omega * turning).sum().real
        fade = max(1 - law.force_damping * v, 0.0)
        stiffness = structure.stiffness_matrix + fade * law.stiffness(x, load) * share
        damping = structure.damping_matrix + law.force_damping * law.force(x, load) * share
        return np.concatenate([speed, -inverse @ (damping @ speed + stiffness @ place)]).reshape(-1)

    scaled = np.diag(np.repeat([1.0, omega], n))
    period = solve_ivp(
        rate,
        (0, 2 * np.pi / omega),
        scaled.reshape(-1),
        method="DOP853",
        rtol=1e-11,
        atol=1e-12,
        max_step=0.05 / omega * 6.28,
    ).y[:, -1]
    multipliers = np.linalg.eigvals(np.linalg.solve(scaled, period.reshape(2 * n, 2 * n)))
    return np.asarray(multipliers[np.argsort(-np.abs(multipliers))])


@pytest.mark.parametrize(
    ("gap_law", "load", "frequency", "amplitude"),
    [
        (ROUGH, 3.0, 22.5e3, 2.5e-6),
        (ROUGH, 80.0, 23.9e3, 8e-6),
        (ROUGH, 60.0, 6e3, 10e-6),
        (ExponentialGap(decay_length=2e-6, force_damping=0.2), 40.0, 15e3, 5e-6),
        (HertzGap(tip_radius=5e-3, effective_modulus=60e9), 20.0, 24e3, 0.2e-6),
    ],
)
def test_multipliers_are_those_of_the_integrated_variational_equation(
    gap_law: GapLaw, load: float, frequency: float, amplitude: float
) -> None:
    states = states_at(gap_law, load, frequency, amplitude)
    found, expected = floquet_multipliers(states), integrated(states)
    assert np.sort(np.abs(found)) == approx(np.sort(np.abs(expected)), abs=2e-7)
    assert np.sum(found) == approx(np.sum(expected), abs=2e-7)


def test_the_status_agrees_with_the_multipliers() -> None:
    random = np.random.default_rng(8)
    points = 75
    frequency = np.concatenate([random.uniform(5e3, 1e5, 45), random.uniform(22.8e3, 24.2e3, 30)])
    volts = np.abs(random.uniform(0.5e-6, 14e-6, points) / drive_receptance(TRIBOMETER, frequency=frequency))
    states = steady_state(
        TRIBOMETER, ROUGH, normal_load=random.uniform(1, 100, points), frequency=frequency, voltage_amplitude=volts
    )
    growth = np.log(np.abs(floquet_multipliers(states, kicks=256)[:, 0]))
    clear = np.abs(growth) > 2e-5
    assert (states.status == Status.UNSTABLE)[clear].tolist() == (growth > 0)[clear].tolist()
    assert 3 < np.count_nonzero(states.status == Status.UNSTABLE) < points


def test_multipliers_on_a_linear_contact_follow_from_the_poles_of_the_sprung_structure() -> None:
    states = steady_state(
        TRIBOMETER, LinearGap(normal_stiffness=5e6), normal_load=20.0, frequency=22e3, voltage_amplitude=0.1
    )
    exponents = poles(with_contact_spring(TRIBOMETER, normal_stiffness=5e6))
    expected = np.abs(np.exp(exponents / 22e3))
    assert np.sort(np.abs(floquet_multipliers(states))) == approx(np.sort(expected), abs=1e-8)


def test_the_product_of_the_multipliers_is_the_phase_space_contraction() -> None:
    # Liouville: volumes in phase space shrink at the trace of M^-1 C
    states = states_at(ROUGH, 60.0, 8e3, 10e-6)
    shrunk = np.exp(-np.trace(np.linalg.solve(TRIBOMETER.mass_matrix, TRIBOMETER.damping_matrix)) / 8e3)
    assert np.prod(floquet_multipliers(states)) == approx(shrunk, rel=1e-8)


def test_without_dampers_all_multipliers_lie_on_the_unit_circle() -> None:
    lossless = replace(TRIBOMETER, damping_matrix=np.zeros((3, 3)))
    states = steady_state(lossless, ROUGH, normal_load=3.0, frequency=30e3, voltage_amplitude=20.0)
    assert states.status == Status.PERIODIC
    assert np.abs(floquet_multipliers(states)) == approx(np.ones(6), abs=1e-7)


def test_the_reason_of_an_unstable_vibration_names_a_remedy() -> None:
    states = states_at(ROUGH, 80.0, 23.9e3, 8e-6)
    assert states.status == Status.UNSTABLE
    assert "march the point in time" in states.reason(())
    assert np.abs(floquet_multipliers(states)[0]) > 1.001
