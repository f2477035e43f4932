"""The backbone of a mass on an exponential contact is that of Toda's oscillator, by quadrature of its energy."""

import numpy as np
import pytest
from pytest import approx, raises
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from sonolube.errors import InvalidInput
from sonolube.models.dynamics import ExponentialGap, LinearGap, Structure
from sonolube.models.dynamics.free_vibration import backbone

MASS, LOAD, LENGTH = 0.01, 50.0, 0.5e-6
PIN = Structure(
    mass_matrix=np.array([[MASS]]),
    damping_matrix=np.array([[3.0]]),
    stiffness_matrix=np.zeros((1, 1)),
    drive_vector=np.ones(1),
    contact_vector=np.ones(1),
    clamped_capacitance=1e-9,
)
SMALL = np.sqrt(LOAD / LENGTH / MASS) / (2 * np.pi)  # natural frequency of small motions [Hz]


def exact(energy: float) -> tuple[float, float, float]:
    """Angular frequency, first harmonic and half of the peak-to-peak motion of x'' = exp(-x) - 1."""

    def potential(x: float) -> float:
        return float(np.exp(-x) + x - 1)

    low = brentq(lambda x: potential(x) - energy, -50.0, 0.0)
    high = brentq(lambda x: potential(x) - energy, 0.0, energy + 2.0)
    middle, half = (low + high) / 2, (high - low) / 2

    def slowness(angle: float) -> float:
        return float(half * np.cos(angle) / np.sqrt(2 * (energy - potential(middle + half * np.sin(angle)))))

    period = 2 * quad(slowness, -np.pi / 2, np.pi / 2, limit=200)[0]
    times = np.linspace(0.0, period, 1025)[:-1]
    motion = solve_ivp(
        lambda _, y: [y[1], np.exp(-y[0]) - 1], (0, period), [high, 0.0],
        method="DOP853", rtol=1e-11, atol=1e-12, t_eval=times,
    )  # fmt: skip
    return 2 * np.pi / period, float(2 * np.abs(np.fft.fft(motion.y[0])[1]) / times.size), half


@pytest.mark.parametrize("energy", [0.1, 0.5, 2.0, 4.0])
def test_the_natural_frequency_falls_as_that_of_todas_oscillator(energy: float) -> None:
    rate, first, half = exact(energy)
    amplitudes = np.linspace(0.05, 1.0, 20) * first * LENGTH
    found = backbone(
        PIN, ExponentialGap(decay_length=LENGTH), normal_load=LOAD, displacement=amplitudes, frequency=SMALL, orders=24
    )
    assert found.frequency[-1] == approx(rate * SMALL, rel=1e-8)
    assert found.vibration_amplitude[-1] == approx(half * LENGTH, rel=1e-4)


def test_a_linear_contact_that_is_not_lost_has_one_natural_frequency() -> None:
    spring = LinearGap(normal_stiffness=LOAD / LENGTH)
    found = backbone(PIN, spring, normal_load=LOAD, displacement=[1e-8, 4e-7], frequency=SMALL, orders=3)
    assert found.frequency == approx(np.full(2, SMALL))


def test_a_damped_contact_is_refused() -> None:
    damped = ExponentialGap(decay_length=LENGTH, force_damping=1e-6)
    with raises(InvalidInput, match="a backbone is that of a contact without damping, got 1e-06 s/m"):
        backbone(PIN, damped, normal_load=LOAD, displacement=1e-7, frequency=SMALL)
