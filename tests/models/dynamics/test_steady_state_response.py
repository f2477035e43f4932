"""Steady states against direct integration, closed forms and conservation of energy."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest import approx, raises
from scipy.integrate import solve_ivp
from scipy.special import i0
from tests.same import same

from sonolube.errors import InvalidInput
from sonolube.models.dynamics import (
    ExponentialGap,
    GapLaw,
    HertzGap,
    LinearGap,
    Status,
    SteadyStates,
    contact_motion,
    steady_state,
)
from sonolube.models.dynamics.structure import Structure, drive_receptance, with_contact_spring

STACK, ARM = np.array([-1.0, 1.0, 0.0]), np.array([0.0, 1.0, -1.0])
STROKE, STIFFNESS = 62 * 140e-12, 2e9
TRIBOMETER = Structure(
    mass_matrix=np.diag([0.15, 0.35, 0.5]),
    damping_matrix=30.0 * np.outer(STACK, STACK) + 20.0 * np.outer(ARM, ARM),
    stiffness_matrix=STIFFNESS * np.outer(STACK, STACK) + 2e5 * np.outer(ARM, ARM),
    drive_vector=STROKE * STIFFNESS * STACK,
    contact_vector=np.array([1.0, 0.0, 0.0]),
    clamped_capacitance=360e-9 - STROKE**2 * STIFFNESS,
)
HELD = replace(TRIBOMETER, stiffness_matrix=TRIBOMETER.stiffness_matrix + np.diag([0.0, 0.0, 3e7]))
ROUGH = ExponentialGap(decay_length=2e-6)
BALL = HertzGap(tip_radius=5e-3, effective_modulus=60e9)
SPRING = LinearGap(normal_stiffness=5e6)


def voltage_for(amplitude: float, frequency: float, structure: Structure = TRIBOMETER) -> float:
    return float(abs(amplitude / drive_receptance(structure, frequency=frequency)))


def coordinates(states: SteadyStates) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Return harmonics and mean of all coordinates from the contact force over the period and the matrices."""
    structure, samples = states.structure, 2048
    force = np.fft.rfft(contact_motion(states, (), samples=samples).normal_force) / samples
    voltage = np.zeros(65, dtype=complex)
    voltage[1 : states.voltage_harmonics.size + 1] = states.voltage_harmonics
    k = np.arange(1, 65)[:, np.newaxis, np.newaxis] * 2 * np.pi * states.frequency
    stiffness = structure.stiffness_matrix + 1j * k * structure.damping_matrix - k**2 * structure.mass_matrix
    loads = np.multiply.outer(voltage[1:65], structure.drive_vector)
    loads = loads + np.multiply.outer(2 * force[1:65], structure.contact_vector)
    harmonics = np.linalg.solve(stiffness, loads[..., np.newaxis])[..., 0]
    pull = (
        structure.contact_vector * (force[0].real - states.normal_load) + structure.drive_vector * states.voltage_offset
    )
    mean = np.linalg.lstsq(structure.stiffness_matrix, pull, rcond=1e-12)[0]
    # a floating structure rests where its contact does
    rigid = states.mean_displacement - mean @ structure.contact_vector
    if np.linalg.matrix_rank(structure.stiffness_matrix) < structure.coordinates:
        mean = mean + rigid
    return harmonics.astype(np.complex128), np.asarray(mean, dtype=np.float64)


def march_one_period(states: SteadyStates) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the state at the start of a period and, by direct integration, at its end."""
    structure, gap_law = states.structure, states.gap_law
    omega, load = 2 * np.pi * float(states.frequency), float(states.normal_load)
    k = np.arange(1, states.voltage_harmonics.size + 1)
    inverse = np.linalg.inv(structure.mass_matrix)

    def rate(time: float, state: NDArray[np.float64]) -> NDArray[np.float64]:
        place, speed = np.split(state, 2)
        voltage = states.voltage_offset + float(np.sum((states.voltage_harmonics * np.exp(1j * k * omega * time)).real))
        x, v = structure.contact_vector @ place, structure.contact_vector @ speed
        force = float(gap_law.force(x, np.float64(load))) * max(float(1 - gap_law.force_damping * v), 0.0)
        pull = structure.drive_vector * voltage + structure.contact_vector * (force - load)
        return np.concatenate(
            [speed, inverse @ (pull - structure.damping_matrix @ speed - structure.stiffness_matrix @ place)]
        )

    harmonics, mean = coordinates(states)
    orders = 1j * omega * np.arange(1, 65)[:, np.newaxis]
    start = np.concatenate([mean + harmonics.sum(axis=0).real, (orders * harmonics).sum(axis=0).real])
    scale = np.abs(start) + 1e-30
    found = solve_ivp(
        rate,
        (0.0, 2 * np.pi / omega),
        start,
        method="DOP853",
        rtol=1e-11,
        atol=1e-13 * scale,
        max_step=0.02 / omega * 2 * np.pi,
    )
    return start, found.y[:, -1]


@pytest.mark.parametrize(
    ("gap_law", "load", "frequency", "amplitude"),
    [
        (ROUGH, 3.0, 22e3, 2.5e-6),
        (ROUGH, 3.0, 22e3, 14e-6),
        (ROUGH, 100.0, 30e3, 0.5e-6),
        (ROUGH, 100.0, 12e3, 14e-6),
        (ROUGH, 60.0, 5e3, 7e-6),
        (ExponentialGap(decay_length=2e-6, force_damping=0.3), 40.0, 22e3, 5e-6),
        (BALL, 20.0, 24e3, 0.5e-6),
        (SPRING, 20.0, 24e3, 2e-6),
    ],
)
@pytest.mark.parametrize("structure", [TRIBOMETER, HELD], ids=["floating", "held"])
def test_a_steady_state_is_periodic_under_direct_integration(
    gap_law: GapLaw, load: float, frequency: float, amplitude: float, structure: Structure
) -> None:
    volts = voltage_for(amplitude, frequency)
    states = steady_state(structure, gap_law, normal_load=load, frequency=frequency, voltage_amplitude=volts)
    assert states.status != Status.NOT_CONVERGED
    start, end = march_one_period(states)
    corners = 3e-5 if isinstance(gap_law, LinearGap) else 1e-6
    assert np.abs(end - start)[:3].max() < corners * np.abs(start[:3]).max()
    assert np.abs(end - start)[3:].max() < corners * 2 * np.pi * frequency * states.vibration_amplitude


def test_the_steady_state_under_a_square_wave_is_periodic_under_direct_integration() -> None:
    k = np.arange(1, 10)
    square = np.where(k % 2 == 1, -4j / (np.pi * k), 0) * 6.0
    states = steady_state(TRIBOMETER, ROUGH, normal_load=20.0, frequency=15e3, voltage_harmonics=square)
    start, end = march_one_period(states)
    assert np.abs(end - start).max() < 1e-6 * np.abs(start).max()


def test_amplitude_and_extreme_forces_are_those_of_the_sampled_motion() -> None:
    states = steady_state(
        TRIBOMETER, ROUGH, normal_load=80.0, frequency=11.2e3, voltage_amplitude=voltage_for(8e-6, 11.2e3)
    )
    contact = contact_motion(states, (), samples=20_000)
    assert states.vibration_amplitude == approx(np.ptp(contact.displacement) / 2, rel=1e-6)
    assert states.highest_normal_force == approx(contact.normal_force.max(), rel=1e-6)
    assert states.lowest_normal_force == approx(contact.normal_force.min(), rel=1e-6)
    assert states.contact_loss_fraction == approx(np.mean(contact.normal_force < 0.8), abs=1e-4)
    assert states.mean_normal_force == approx(contact.normal_force.mean(), rel=1e-9)


@pytest.mark.parametrize("samples", [2, 3, 5, 16])
def test_a_few_samples_of_a_motion_are_among_many(samples: int) -> None:
    states = steady_state(
        TRIBOMETER, ROUGH, normal_load=80.0, frequency=11.2e3, voltage_amplitude=voltage_for(8e-6, 11.2e3)
    )
    assert samples < 2 * int(states.harmonic_count)
    few, many = (contact_motion(states, (), samples=count) for count in (samples, 1000 * samples))
    assert few.displacement == approx(many.displacement[::1000], rel=1e-12, abs=1e-18)
    assert few.velocity == approx(many.velocity[::1000], rel=1e-12, abs=1e-12)


def test_motions_with_more_than_two_extrema_are_measured_by_samples() -> None:
    k = np.array([1, 5])
    drive = np.zeros(5, dtype=complex)
    drive[k - 1] = 1e-6 / drive_receptance(TRIBOMETER, frequency=4e3 * k)
    states = steady_state(TRIBOMETER, ROUGH, normal_load=5.0, frequency=4e3, voltage_harmonics=drive)
    contact = contact_motion(states, (), samples=20_000)
    assert np.isnan(states.extremum_phases).all()
    assert states.vibration_amplitude == approx(np.ptp(contact.displacement) / 2, rel=1e-6)
    assert states.highest_normal_force == approx(contact.normal_force.max(), rel=1e-6)


def test_a_heavy_structure_rises_until_the_mean_force_balances_its_load() -> None:
    heavy = replace(
        TRIBOMETER, mass_matrix=1e6 * TRIBOMETER.mass_matrix, stiffness_matrix=1e6 * TRIBOMETER.stiffness_matrix
    )
    amplitude = np.array([0.1e-6, 1e-6, 5e-6, 14e-6])
    volts = np.abs(amplitude / drive_receptance(heavy, frequency=22e3))
    states = steady_state(heavy, ROUGH, normal_load=3.0, frequency=22e3, voltage_amplitude=volts)
    assert states.vibration_amplitude == approx(amplitude, rel=1e-5)
    assert states.mean_displacement == approx(2e-6 * np.log(i0(amplitude / 2e-6)), rel=1e-5)  # Bessel: mean of exp
    assert states.mean_normal_force == approx(3.0)


def test_a_linear_contact_without_separation_is_a_spring() -> None:
    frequency, volts = np.array([3e3, 15e3, 22e3, 40e3]), 0.1
    states = steady_state(TRIBOMETER, SPRING, normal_load=20.0, frequency=frequency, voltage_amplitude=volts)
    sprung = with_contact_spring(TRIBOMETER, normal_stiffness=5e6)
    assert states.harmonics[:, 0] == approx(drive_receptance(sprung, frequency=frequency) * volts, rel=1e-9)
    assert states.mean_displacement == approx(np.zeros(4), abs=1e-18)


def test_a_constant_voltage_displaces_a_grounded_structure_on_its_contact() -> None:
    states = steady_state(HELD, SPRING, normal_load=20.0, frequency=22e3, voltage_amplitude=0.0, voltage_offset=-10.0)
    sprung = with_contact_spring(HELD, normal_stiffness=5e6)
    rest = np.linalg.solve(sprung.stiffness_matrix, sprung.drive_vector * -10.0)
    assert states.mean_displacement == approx(rest[0], rel=1e-9)
    assert states.mean_normal_force == approx(20.0 - 5e6 * rest[0], rel=1e-9)


@pytest.mark.parametrize("structure", [TRIBOMETER, HELD], ids=["floating", "held"])
def test_the_electrical_power_is_dissipated_by_dampers_and_contact(structure: Structure) -> None:
    gap_law = ExponentialGap(decay_length=2e-6, force_damping=0.5)
    states = steady_state(structure, gap_law, normal_load=60.0, frequency=20e3, voltage_amplitude=20.0)
    harmonics, _ = coordinates(states)
    speeds = 2j * np.pi * 20e3 * np.arange(1, 65)[:, np.newaxis] * harmonics
    in_dampers = 0.5 * np.einsum("ki,ij,kj->", speeds.conj(), structure.damping_matrix, speeds).real
    contact = contact_motion(states, (), samples=2048)
    in_contact = -np.mean(contact.normal_force * contact.velocity)
    assert in_contact > 0
    assert states.dissipated_power == approx(in_dampers + in_contact, rel=1e-6)


def test_without_voltage_the_structure_is_at_rest() -> None:
    states = steady_state(TRIBOMETER, ROUGH, normal_load=3.0, frequency=22e3, voltage_amplitude=0.0)
    assert states.vibration_amplitude == approx(0.0, abs=1e-20)
    assert states.mean_displacement == approx(0.0, abs=1e-18)
    assert states.lowest_normal_force == approx(3.0)
    assert states.status == Status.PERIODIC


def test_points_of_a_batch_have_the_solutions_that_they_have_alone() -> None:
    random = np.random.default_rng(5)
    loads, frequencies = random.uniform(1, 100, 40), random.uniform(5e3, 1e5, 40)
    volts = np.abs(random.uniform(0.5e-6, 14e-6, 40) / drive_receptance(TRIBOMETER, frequency=frequencies))
    batch = steady_state(
        TRIBOMETER, ROUGH, normal_load=loads, frequency=frequencies, voltage_amplitude=volts, workers=2
    )
    for i in range(0, 40, 7):
        alone = steady_state(
            TRIBOMETER, ROUGH, normal_load=loads[i], frequency=frequencies[i], voltage_amplitude=volts[i]
        )
        for name in ("vibration_amplitude", "mean_displacement", "highest_normal_force", "extremum_phases", "status"):
            same(getattr(batch, name)[i], getattr(alone, name), place=name)


def test_additional_harmonics_change_results_within_the_tolerance() -> None:
    random = np.random.default_rng(6)
    loads, frequencies = random.uniform(1, 100, 300), random.uniform(5e3, 1e5, 300)
    volts = np.abs(random.uniform(0.1e-6, 14e-6, 300) / drive_receptance(TRIBOMETER, frequency=frequencies))

    def solve(least: int) -> SteadyStates:
        return steady_state(
            TRIBOMETER,
            ROUGH,
            normal_load=loads,
            frequency=frequencies,
            voltage_amplitude=volts,
            minimum_harmonics=least,
            stability=False,
        )

    usual, fine = solve(1), solve(32)
    assert usual.vibration_amplitude == approx(fine.vibration_amplitude, rel=2e-6)
    assert usual.mean_displacement == approx(fine.mean_displacement, rel=2e-6)
    assert usual.highest_normal_force == approx(fine.highest_normal_force, rel=1e-5)


def test_the_dissipated_power_is_that_of_voltage_and_current_in_phase() -> None:
    states = steady_state(TRIBOMETER, ROUGH, normal_load=3.0, frequency=22e3, voltage_amplitude=5.0)
    assert states.dissipated_power == approx(0.5 * (states.current_harmonics[0] * 5.0).real)


def test_touching_mean_planes_are_reported_where_a_separation_is_given() -> None:
    states = steady_state(
        TRIBOMETER, ROUGH, normal_load=3.0, frequency=22e3, voltage_amplitude=[1.0, 30.0], separation=2e-6
    )
    assert states.gap_closed.tolist() == [False, True]


def test_coexisting_vibrations_are_both_found_one_per_branch() -> None:
    floating = Structure(
        mass_matrix=np.diag([0.25, 0.25]),
        damping_matrix=np.diag([100.0, 0.0]),
        stiffness_matrix=2e9 * np.array([[1.0, -1.0], [-1.0, 1.0]]),
        drive_vector=17.36 * np.array([-1.0, 1.0]),
        contact_vector=np.array([1.0, 0.0]),
        clamped_capacitance=2e-7,
    )
    up, down = (
        steady_state(floating, BALL, normal_load=20.0, frequency=690.0, voltage_amplitude=50.0, upper_branch=upper)
        for upper in (False, True)
    )
    assert up.status == down.status == Status.MULTISTABLE
    assert up.vibration_amplitude < down.vibration_amplitude
    assert up.coexisting_amplitude == approx(down.vibration_amplitude, rel=1e-6)
    assert "depends on how the voltage was raised or lowered" in up.reason(())
    for states in (up, down):
        start, end = march_one_period(states)
        assert np.abs(end - start)[:2].max() < 1e-5 * np.abs(start[:2]).max()


def test_an_undamped_resonance_has_no_steady_state_and_a_reason() -> None:
    lossless = replace(TRIBOMETER, damping_matrix=np.zeros((3, 3)))
    far = LinearGap(normal_stiffness=0.0)
    from sonolube.models.dynamics.linear import modes

    resonance = modes(lossless).natural_frequency[-1]
    states = steady_state(lossless, far, normal_load=1.0, frequency=resonance, voltage_amplitude=1.0)
    assert states.status == Status.NOT_CONVERGED
    assert "not_converged" in states.reason(())
    assert np.isnan(states.vibration_amplitude)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"normal_load": -3.0}, r"normal_load must be positive, got -3\.0 N"),
        ({"normal_load": np.nan}, r"normal_load must be finite, got nan N"),
        ({"frequency": 0.0}, r"frequency must be positive, got 0\.0 Hz"),
        ({"voltage_amplitude": -1.0}, r"voltage_amplitude must not be negative, got -1\.0 V"),
        ({"voltage_offset": np.inf}, r"voltage_offset must be finite, got inf V"),
        ({"voltage_amplitude": None}, "give either voltage_amplitude or voltage_harmonics"),
        ({"minimum_harmonics": 65}, "minimum_harmonics must lie between 1 and 64, got 65"),
        ({"workers": 0}, "workers must be at least 1, got 0"),
        ({"voltage_amplitude": []}, r"there are no points to compute: .* have shapes \(\), \(\), \(0,\), \(\), \(\)"),
        ({"voltage_amplitude": [1, 2], "frequency": [1, 2, 3]}, "must have matching shapes"),
    ],
)
def test_invalid_arguments_are_refused_by_name(wrong: dict[str, float], message: str) -> None:
    good = {"normal_load": 3.0, "frequency": 22e3, "voltage_amplitude": 5.0}
    with raises(InvalidInput, match=message):
        steady_state(TRIBOMETER, ROUGH, **(good | wrong))  # type: ignore[arg-type]


def test_a_drive_of_a_rigid_body_mode_is_refused() -> None:
    pushed = replace(TRIBOMETER, drive_vector=np.array([1.0, 0.0, 0.0]))
    with raises(InvalidInput, match="drive_vector drives a rigid-body mode"):
        steady_state(pushed, ROUGH, normal_load=3.0, frequency=22e3, voltage_amplitude=5.0)
