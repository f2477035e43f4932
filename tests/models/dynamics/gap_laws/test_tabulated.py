"""Tabulated contact laws against the closed form, direct integration and limits."""

from contextlib import nullcontext
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pytest import approx, fixture, mark, raises
from scipy.integrate import solve_ivp
from tests.models.dynamics.floquet_multipliers import floquet_multipliers

from sonolube.errors import InvalidInput
from sonolube.execution.compilation import few_points
from sonolube.models.contact import (
    ASPERITY_LAWS,
    ContactPair,
    GaussianHeights,
    RoughContact,
    normal_force,
    normal_stiffness,
    separation,
)
from sonolube.models.dynamics import (
    ExponentialGap,
    Status,
    SteadyStates,
    Structure,
    TabulatedGap,
    contact_motion,
    friction_averages,
    march,
    steady_state,
    with_contact_spring,
)
from sonolube.models.dynamics.continuation import response_curve
from sonolube.models.dynamics.sensitivities import steady_state_sensitivities
from sonolube.models.dynamics.structure import drive_receptance
from sonolube.models.surfaces import Roughness

Array = NDArray[np.float64]
DECAY_LENGTH = 2e-6
STACK, ARM = np.array([-1.0, 1.0, 0.0]), np.array([0.0, 1.0, -1.0])
STROKE, STIFFNESS = 62 * 140e-12, 2e9
FLOATING = Structure(
    mass_matrix=np.diag([0.15, 0.35, 0.5]),
    damping_matrix=300.0 * np.outer(STACK, STACK) + 20.0 * np.outer(ARM, ARM),
    stiffness_matrix=STIFFNESS * np.outer(STACK, STACK) + 2e5 * np.outer(ARM, ARM),
    drive_vector=STROKE * STIFFNESS * STACK,
    contact_vector=np.array([1.0, 0.0, 0.0]),
    clamped_capacitance=360e-9 - STROKE**2 * STIFFNESS,
)
HELD = Structure(
    mass_matrix=np.array([[0.1]]),
    damping_matrix=np.array([[2000.0]]),
    stiffness_matrix=np.array([[1e7]]),
    drive_vector=np.array([10.0]),
    contact_vector=np.array([1.0]),
    clamped_capacitance=1e-7,
)
CONTACT = RoughContact(
    roughness=Roughness(rms_height=1e-6, summit_radius=20e-6, summit_density=2e9),
    pair=ContactPair(effective_modulus=60e9, poisson_ratio=0.3, yield_strength=0.35e9, mindlin_ratio=0.8),
    nominal_area=1e-4,
    heights=GaussianHeights(),
    asperity=ASPERITY_LAWS["dong_2015"],
)


def table_of_an_exponential(force_damping: float = 0.0) -> TabulatedGap:
    d = np.linspace(-10e-6, 30e-6, 81)
    force = 7.0 * np.exp(-d / DECAY_LENGTH)
    return TabulatedGap(
        separation=d, normal_force=force, normal_stiffness=force / DECAY_LENGTH, force_damping=force_damping
    )


@fixture(scope="module")
def gaussian() -> TabulatedGap:
    d = np.linspace(-4e-6, 12e-6, 801)
    return TabulatedGap(
        separation=d,
        normal_force=normal_force(CONTACT, separation=d),
        normal_stiffness=normal_stiffness(CONTACT, separation=d),
    )


def batch(law: TabulatedGap | ExponentialGap, structure: Structure) -> SteadyStates:
    """Return steady states at light to heavy loads, with amplitudes up to many decay lengths."""
    loads, frequencies = np.array([0.5, 3.0, 40.0, 100.0]), np.array([[8e3], [15e3], [22e3]])
    swing = 5e-6 / np.abs(drive_receptance(structure, frequency=frequencies.ravel()))[:, np.newaxis]
    return steady_state(structure, law, normal_load=loads, frequency=frequencies, voltage_amplitude=swing)


@mark.parametrize(("structure", "damping"), [(FLOATING, 0.0), (HELD, 0.2)], ids=["floating", "held and damped"])
def test_a_tabulated_exponential_has_the_steady_states_of_the_exponential_law(
    structure: Structure, damping: float
) -> None:
    with few_points() if damping else nullcontext():  # damped kernels are compiled nowhere else, for some 40 s
        closed = batch(ExponentialGap(decay_length=DECAY_LENGTH, force_damping=damping), structure)
        table = batch(table_of_an_exponential(damping), structure)
    assert np.array_equal(table.status, closed.status)
    for name in ("vibration_amplitude", "mean_normal_force", "highest_normal_force", "dissipated_power"):
        assert getattr(table, name) == approx(getattr(closed, name), rel=1e-7), name
    assert table.mean_displacement == approx(closed.mean_displacement, rel=1e-7, abs=1e-7 * DECAY_LENGTH)
    assert table.contact_loss_fraction == approx(closed.contact_loss_fraction, abs=1e-7)


def test_a_tabulated_exponential_has_the_stability_and_friction_of_the_exponential_law() -> None:
    closed, table = (
        batch(law, FLOATING) for law in (ExponentialGap(decay_length=DECAY_LENGTH), table_of_an_exponential())
    )
    largest = [np.abs(floquet_multipliers(states, kicks=64)[..., 0]) for states in (closed, table)]
    assert largest[1] == approx(largest[0], rel=1e-7)
    speeds = [1e-3, 0.02, 0.3]
    friction = [friction_averages(states, sliding_speed=speeds) for states in (closed, table)]
    assert friction[1].kinematic == approx(friction[0].kinematic, rel=1e-6)
    assert friction[1].force_weighted == approx(friction[0].force_weighted, rel=1e-6)


@mark.parametrize("damping", [0.0, 0.2], ids=["elastic", "damped"])
def test_a_tabulated_exponential_has_the_trajectory_of_the_exponential_law(damping: float) -> None:
    laws = ExponentialGap(decay_length=DECAY_LENGTH, force_damping=damping), table_of_an_exponential(damping)
    with few_points() if damping else nullcontext():
        closed, table = (
            march(
                HELD,
                law,
                normal_load=[2.0, 40.0],
                frequency=1.2e3,
                voltage_peak_to_peak=12.0,
                periods=20,
                recorded_periods=20,
            ).last_periods
            for law in laws
        )
    assert table.displacement == approx(closed.displacement, abs=1e-7 * np.ptp(closed.displacement))
    assert table.normal_force == approx(closed.normal_force, rel=1e-6)


def test_a_tabulated_exponential_has_the_response_curve_and_sensitivity_of_the_exponential_law() -> None:
    curves, slopes = [], []
    for law in (ExponentialGap(decay_length=DECAY_LENGTH), table_of_an_exponential()):
        curve = response_curve(HELD, law, normal_load=20.0, voltage_amplitude=(0.5, 12.0), frequency=1.5e3)
        curves.append(curve.vibration_amplitude[-1])
        states = steady_state(HELD, law, normal_load=20.0, frequency=1.5e3, voltage_amplitude=8.0)
        slopes.append(float(steady_state_sensitivities(states).vibration_amplitude["normal_load"]))
    assert curves[1] == approx(curves[0], rel=1e-7)
    assert slopes[1] == approx(slopes[0], rel=1e-6)


def test_the_sensitivity_to_the_load_is_a_central_difference(gaussian: TabulatedGap) -> None:
    load, step = 20.0, 1e-3
    states = steady_state(
        HELD,
        gaussian,
        normal_load=[load - step, load, load + step],
        frequency=1.5e3,
        voltage_amplitude=8.0,
        minimum_harmonics=24,
    )
    found = steady_state_sensitivities(states).mean_displacement["normal_load"][1]
    assert found == approx(np.diff(states.mean_displacement[[0, 2]])[0] / (2 * step), rel=1e-5)


def integrate(structure: Structure, load: float, frequency: float, volts: float, periods: int) -> tuple[Array, Array]:
    """Return displacement and force over the last period, by direct integration with the force of the rough contact."""
    d, omega, inverse = (
        separation(CONTACT, normal_load=load),
        2 * np.pi * frequency,
        np.linalg.inv(structure.mass_matrix),
    )

    def force(x: float) -> float:
        return float(normal_force(CONTACT, separation=d + x))

    def rate(time: float, state: Array) -> Array:
        place, speed = np.split(state, 2)
        pull = structure.drive_vector * volts * np.cos(omega * time)
        pull = pull + structure.contact_vector * (force(float(structure.contact_vector @ place)) - load)
        pull = pull - structure.damping_matrix @ speed - structure.stiffness_matrix @ place
        return np.concatenate([speed, inverse @ pull])

    end = periods / frequency
    times = end + np.arange(256) / (256 * frequency)
    found = solve_ivp(
        rate, (0.0, end + 1 / frequency), np.zeros(2 * structure.coordinates), "DOP853", times, rtol=1e-9, atol=1e-14
    )
    x = structure.contact_vector @ found.y[: structure.coordinates]
    return x, np.array([force(each) for each in x])


@mark.parametrize(("load", "volts"), [(3.0, 6.0), (40.0, 12.0)])
def test_the_vibration_on_gaussian_heights_is_that_of_direct_integration(
    gaussian: TabulatedGap, load: float, volts: float
) -> None:
    frequency = 2e3
    x, force = integrate(HELD, load, frequency, volts, periods=30)
    states = steady_state(HELD, gaussian, normal_load=load, frequency=frequency, voltage_amplitude=volts)
    assert states.status == Status.PERIODIC
    own = contact_motion(states, (), samples=256)
    assert np.ptp(own.displacement) == approx(np.ptp(x), rel=1e-4)
    assert own.displacement.mean() == approx(x.mean(), abs=1e-4 * np.ptp(x))
    assert states.mean_normal_force == approx(force.mean(), rel=1e-4)
    marched = march(
        HELD,
        gaussian,
        normal_load=load,
        frequency=frequency,
        voltage_peak_to_peak=2 * volts,
        periods=60,
        steps_per_period=128,
        recorded_periods=1,
    ).last_periods
    assert np.ptp(marched.displacement) == approx(np.ptp(x), rel=2e-3)
    assert marched.normal_force.mean() == approx(force.mean(), rel=1e-4)


def test_gaussian_heights_carry_the_dead_load_of_a_floating_structure_in_the_mean(gaussian: TabulatedGap) -> None:
    states = batch(gaussian, FLOATING)
    assert np.all(states.status != Status.NOT_CONVERGED)
    for index in np.ndindex(states.status.shape):
        own = contact_motion(states, index, samples=4096)
        at_rest = separation(CONTACT, normal_load=states.normal_load[index])
        assert normal_force(CONTACT, separation=at_rest + own.displacement).mean() == approx(
            states.normal_load[index], rel=1e-5
        )


def test_at_small_amplitudes_the_stiffness_is_that_of_the_rough_contact(gaussian: TabulatedGap) -> None:
    load, frequency, volts = np.array([0.5, 10.0, 80.0]), 15e3, 1e-4
    states = steady_state(FLOATING, gaussian, normal_load=load, frequency=frequency, voltage_amplitude=volts)
    stiffness = normal_stiffness(CONTACT, separation=separation(CONTACT, normal_load=load))
    for k, amplitude in zip(stiffness, states.vibration_amplitude, strict=True):
        linear = abs(drive_receptance(with_contact_spring(FLOATING, normal_stiffness=float(k)), frequency=frequency))
        assert amplitude == approx(volts * float(linear), rel=1e-6)


def test_between_the_points_of_the_table_the_force_is_that_of_the_rough_contact(gaussian: TabulatedGap) -> None:
    d = np.random.default_rng(1).uniform(-4e-6, 12e-6, 2000)
    x = d - separation(CONTACT, normal_load=10.0)
    assert gaussian.force(x, 10.0) == approx(normal_force(CONTACT, separation=d), rel=1e-8)
    assert gaussian.stiffness(x, 10.0) == approx(normal_stiffness(CONTACT, separation=d), rel=1e-6)


def test_points_with_many_uncoupled_harmonics_do_not_depend_on_uninitialised_memory(gaussian: TabulatedGap) -> None:
    # 56 harmonics of which a few are coupled: a stiff contact lost in every period
    for law in (gaussian, ExponentialGap(decay_length=3.36e-7)):
        states = steady_state(HELD, law, normal_load=[3.0, 10.0, 40.0], frequency=2e3, voltage_amplitude=12.0)
        assert np.all(states.status == Status.PERIODIC)


def test_beyond_the_ends_of_the_table_the_force_continues_exponentially(gaussian: TabulatedGap) -> None:
    load = 10.0
    for end, beyond in ((0, -3e-6), (-1, 3e-6)):
        force, k = gaussian.normal_force[end], gaussian.normal_stiffness[end]
        x = gaussian.separation[end] + beyond - separation(CONTACT, normal_load=load)
        assert gaussian.force(x, load) == approx(force * np.exp(-beyond * k / force), rel=1e-9)
    assert 0 < gaussian.force(np.array(1.0), load) < 1e-300
    assert np.isfinite(gaussian.force(np.array(-1.0), load))


@mark.parametrize(
    ("change", "message"),
    [
        (
            {"normal_force": [4.0, 3.0, 3.0, 1.0]},
            "normal_force must decrease from point to point, but .* separation 1e-06 m",
        ),
        ({"normal_force": [4.0, 3.0, np.nan, 1.0]}, "normal_force must be"),
        ({"normal_force": [4.0, 3.0, 2.0, 0.0]}, "normal_force must be positive"),
        (
            {"normal_stiffness": [1e6, 1e6, 2e7, 1e6]},
            "normal_stiffness must be the decrease .* after separation 1e-06 m",
        ),
        ({"normal_stiffness": [1e6, 1e6, 1e6]}, r"the same four or more points, got shapes \(4,\), \(4,\) and \(3,\)"),
        ({"separation": [0.0, 1e-6, 2e-6, 4e-6]}, "separation must be evenly spaced and increasing"),
        ({"separation": [0.0, 1e-6, np.inf, 3e-6]}, "separation must be finite"),
        ({"force_damping": -1.0}, "force_damping must not be negative"),
    ],
)
def test_an_inconsistent_table_is_refused_by_name(change: dict[str, Any], message: str) -> None:
    table: dict[str, Any] = {
        "separation": np.arange(4) * 1e-6,
        "normal_force": np.array([4.0, 3.0, 2.0, 1.0]),
        "normal_stiffness": np.full(4, 1e6),
    }
    TabulatedGap(**table)
    with raises(InvalidInput, match=message):
        TabulatedGap(**(table | change))


def test_a_table_of_three_points_is_refused() -> None:
    three = table_of_an_exponential()
    with raises(InvalidInput, match="four or more points"):
        TabulatedGap(
            separation=three.separation[:3],
            normal_force=three.normal_force[:3],
            normal_stiffness=three.normal_stiffness[:3],
        )
