"""Response curves through folds, each branch against direct integration."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from pytest import approx, raises
from scipy.integrate import solve_ivp

from sonolube.errors import InvalidInput
from sonolube.models.dynamics import HertzGap, LinearGap, Status, steady_state
from sonolube.models.dynamics.continuation import ResponseCurve, reached_by_ramp, response_curve, solutions_at
from sonolube.models.dynamics.structure import Structure, drive_receptance, with_contact_spring

BALL = HertzGap(tip_radius=5e-3, effective_modulus=60e9)
BLOCKS = Structure(
    mass_matrix=np.diag([0.25, 0.25]),
    damping_matrix=np.diag([100.0, 0.0]),
    stiffness_matrix=2e9 * np.array([[1.0, -1.0], [-1.0, 1.0]]),
    drive_vector=17.36 * np.array([-1.0, 1.0]),
    contact_vector=np.array([1.0, 0.0]),
    clamped_capacitance=2e-7,
)
RESONANCE = 809.2  # Hz, of both blocks on the ball's stiffness at 20 N


@pytest.fixture(scope="module")
def falling_frequency() -> ResponseCurve:
    return response_curve(
        BLOCKS, BALL, normal_load=20.0, voltage_amplitude=50.0, frequency=(1.5 * RESONANCE, 0.5 * RESONANCE)
    )


def marched_amplitude(point: ResponseCurve, periods: int) -> float:
    """Return half the peak-to-peak displacement after some periods of direct integration from a point of the curve."""
    omega, volts = 2 * np.pi * float(point.frequency[0]), float(point.voltage_amplitude[0])
    balance = point.equations.at(
        point.equations.stack(float(point.mean_displacement[0]), point.harmonics[0]), omega=omega, scale=volts
    )
    k = np.arange(1, point.harmonics.shape[1] + 1)[:, np.newaxis]
    inverse = np.linalg.inv(BLOCKS.mass_matrix)

    def rate(time: float, state: NDArray[np.float64]) -> NDArray[np.float64]:
        place, speed = state[:2], state[2:]
        pull = BLOCKS.drive_vector * volts * np.cos(omega * time) - BLOCKS.damping_matrix @ speed
        pull = pull - BLOCKS.stiffness_matrix @ place
        pull[0] += float(BALL.force(place[0], np.float64(20.0))) - 20.0
        return np.concatenate([speed, inverse @ pull])

    start = np.concatenate(
        [
            point.mean_displacement[0] + balance.coordinates.sum(axis=0).real,
            (1j * omega * k * balance.coordinates).sum(axis=0).real,
        ]
    )
    last = np.linspace(periods - 1, periods, 400) * 2 * np.pi / omega
    found = solve_ivp(rate, (0, last[-1]), start, method="DOP853", rtol=1e-9, atol=1e-15, t_eval=last)
    return float(np.ptp(found.y[0]) / 2)


def test_a_softening_contact_bends_the_resonance_curve_to_two_folds(falling_frequency: ResponseCurve) -> None:
    assert falling_frequency.complete
    assert len(falling_frequency.folds) == 2
    top = np.argmax(falling_frequency.vibration_amplitude)
    assert falling_frequency.frequency[top] < 0.95 * RESONANCE


def test_between_the_folds_the_outer_branches_are_stable_and_the_middle_one_is_not(
    falling_frequency: ResponseCurve,
) -> None:
    between = float(falling_frequency.frequency[falling_frequency.folds].mean())
    found = solutions_at(falling_frequency, at=between)
    assert found.frequency == approx(np.full(3, between))
    assert found.stable.tolist() == [True, False, True]
    large, _, small = found.vibration_amplitude
    assert large > 3 * small


def test_direct_integration_stays_on_both_stable_branches(falling_frequency: ResponseCurve) -> None:
    between = float(falling_frequency.frequency[falling_frequency.folds].mean())
    for backward in (False, True):
        point = reached_by_ramp(falling_frequency, at=between, backward=backward)
        assert marched_amplitude(point, 60) == approx(point.vibration_amplitude[0], rel=1e-3)


def test_direct_integration_leaves_the_unstable_branch(falling_frequency: ResponseCurve) -> None:
    between = float(falling_frequency.frequency[falling_frequency.folds].mean())
    found = solutions_at(falling_frequency, at=between)
    middle = replace(found, mean_displacement=found.mean_displacement[1:2], harmonics=found.harmonics[1:2])
    assert abs(marched_amplitude(middle, 120) / found.vibration_amplitude[1] - 1) > 0.1


def test_raised_and_lowered_voltages_end_on_different_branches(falling_frequency: ResponseCurve) -> None:
    between = float(falling_frequency.frequency[falling_frequency.folds].mean())
    curve = response_curve(BLOCKS, BALL, normal_load=20.0, voltage_amplitude=(2.0, 200.0), frequency=between)
    assert curve.complete
    rising, falling = (reached_by_ramp(curve, at=50.0, backward=backward) for backward in (False, True))
    assert rising.vibration_amplitude[0] < falling.vibration_amplitude[0]
    for point, backward in ((rising, False), (falling, True)):
        states = steady_state(
            BLOCKS, BALL, normal_load=20.0, frequency=between, voltage_amplitude=50.0, upper_branch=backward
        )
        assert states.status == Status.MULTISTABLE
        assert states.vibration_amplitude == approx(point.vibration_amplitude[0], rel=1e-4)
    beyond = float(curve.voltage_amplitude[curve.folds].max()) * 1.1
    jumped = reached_by_ramp(curve, at=beyond)
    assert jumped.vibration_amplitude[0] > 3 * rising.vibration_amplitude[0]


def test_the_response_curve_on_a_linear_contact_is_that_of_a_spring() -> None:
    spring = LinearGap(normal_stiffness=1.3e7)
    curve = response_curve(BLOCKS, spring, normal_load=20.0, voltage_amplitude=0.5, frequency=(600.0, 1100.0), orders=4)
    sprung = with_contact_spring(BLOCKS, normal_stiffness=1.3e7)
    expected = np.abs(drive_receptance(sprung, frequency=curve.frequency)) * 0.5
    assert curve.vibration_amplitude == approx(expected, rel=1e-8)
    assert not curve.folds.size
    assert curve.stable.all()


def test_a_narrow_resonance_is_not_stepped_over() -> None:
    light = replace(BLOCKS, damping_matrix=0.01 * BLOCKS.damping_matrix)
    spring = LinearGap(normal_stiffness=1.3e7)
    curve = response_curve(light, spring, normal_load=20.0, voltage_amplitude=0.05, frequency=(600.0, 1400.0), orders=2)
    sprung = with_contact_spring(light, normal_stiffness=1.3e7)
    dense = np.linspace(600.0, 1400.0, 200_001)
    highest = float(np.abs(drive_receptance(sprung, frequency=dense)).max()) * 0.05
    assert curve.vibration_amplitude.max() == approx(highest, rel=0.05)


def test_a_curve_without_a_range_is_refused() -> None:
    with raises(InvalidInput, match="give a pair, start and end of the curve,"):
        response_curve(BLOCKS, BALL, normal_load=20.0, voltage_amplitude=50.0, frequency=700.0)


def test_a_value_beyond_the_curve_is_refused(falling_frequency: ResponseCurve) -> None:
    with raises(InvalidInput, match="the curve does not reach frequency 5000"):
        reached_by_ramp(falling_frequency, at=5000.0)
