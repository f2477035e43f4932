"""Squeeze-film levitation against Reynolds's equation integrated in time, and its small-amplitude limit."""

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, ModelRangeWarning, OutsideRange
from sonolube.models.contact import (
    leakage_factor,
    levitation_amplitude,
    levitation_gap,
    squeeze_film_pressure,
    squeeze_number,
)

DISC = {"face_radius": 10e-3, "frequency": 20e3}


def mean_excess_by_reynolds(sigma: float, excursion: float, *, cells: int = 60) -> float:
    """Mean excess pressure over that around, of a disc: d(PH)/dtau = 1/(sigma R) d/dR(R H^3 P dP/dR), implicitly."""
    # cells graded towards the rim, where the leaking layer is 1/sqrt(sigma) thick
    edges = 1 - (1 - np.linspace(0, 1, cells + 1)) ** 2
    centre, volume = (edges[1:] + edges[:-1]) / 2, (edges[1:] ** 2 - edges[:-1] ** 2) / 2
    distance = np.append(np.diff(centre), 1 - centre[-1])
    steps, P = 200, np.ones(cells)
    start = np.sqrt(1 + 1.5 * excursion**2)
    P *= start / (1 + excursion)
    means = []
    for step in range(1, 12 * steps + 1):
        H = 1 + excursion * np.cos(2 * np.pi * step / steps)
        H_old = 1 + excursion * np.cos(2 * np.pi * (step - 1) / steps)
        mass = P * H_old
        new = P.copy()
        for _ in range(20):  # Newton's method for the nonlinear fluxes of P^2/2
            outer = np.append(new[1:], 1.0)
            conduct = edges[1:] / distance * H**3 / sigma * (2 * np.pi / steps)
            flux = conduct * (new**2 - outer**2) / 2
            residual = volume * (new * H - mass) + flux - np.concatenate([[0], flux[:-1]])
            main = volume * H + conduct * new + np.concatenate([[0], conduct[:-1] * new[1:]])
            matrix = np.diag(main) - np.diag(conduct[:-1] * outer[:-1], 1) - np.diag(conduct[:-1] * new[:-1], -1)
            change = np.linalg.solve(matrix, residual)
            new = new - change
            if np.abs(change).max() < 1e-11:
                break
        P = new
        if step > 11 * steps:
            means.append(float(2 * volume @ P) - 1)
    return float(np.mean(means))


def test_the_pressure_is_the_limit_of_reynolds_equation_at_high_squeeze_number() -> None:
    limit = float(squeeze_film_pressure(vibration_amplitude=0.5, film_thickness=1.0, ambient_pressure=1.0))
    errors = [1 - mean_excess_by_reynolds(sigma, 0.5) / limit for sigma in (100.0, 1600.0)]
    assert 0 < errors[1] < 0.06
    assert errors[0] == approx(4 * errors[1], rel=0.25)  # the leaking rim is 1/sqrt(sigma) wide


def test_the_pressure_of_a_small_vibration_is_five_quarters_of_the_squared_amplitude_ratio() -> None:
    excess = squeeze_film_pressure(vibration_amplitude=1e-4, film_thickness=1e-2, ambient_pressure=1e5)
    assert excess == approx(1.25 * 1e5 * 1e-4, rel=1e-3)


def test_the_film_at_the_levitation_gap_carries_the_load() -> None:
    h = levitation_gap(normal_load=3.0, vibration_amplitude=2e-6, **DISC)
    excess = squeeze_film_pressure(vibration_amplitude=2e-6, film_thickness=h, ambient_pressure=101325.0)
    assert excess * np.pi * 10e-3**2 == approx(3.0)
    assert h > 2e-6


def test_the_squeeze_number_is_hand_computed() -> None:
    # 12 x 1.82e-5 x 2 pi 2e4 x 1e-4 / (101325 x 1e-10)
    assert squeeze_number(film_thickness=10e-6, **DISC) == approx(270.86, rel=1e-3)


def test_a_low_squeeze_number_warns_of_leakage() -> None:
    with pytest.warns(ModelRangeWarning, match="gas leaks at the rim"):
        levitation_gap(normal_load=0.2, vibration_amplitude=10e-6, **DISC)


def test_an_amplitude_above_the_film_thickness_and_too_thick_a_film_are_refused() -> None:
    with raises(InvalidInput, match="must be smaller than film_thickness"):
        squeeze_film_pressure(vibration_amplitude=2e-6, film_thickness=1e-6, ambient_pressure=1e5)
    with raises(OutsideRange, match="too low"):
        levitation_gap(normal_load=1e-6, vibration_amplitude=10e-6, **DISC)


@pytest.mark.parametrize("sigma", [5.0, 30.0, 100.0])
def test_leakage_at_the_rim_is_that_of_reynolds_equation_for_a_small_amplitude(sigma: float) -> None:
    limit = float(squeeze_film_pressure(vibration_amplitude=0.1, film_thickness=1.0, ambient_pressure=1.0))
    assert leakage_factor(squeeze_number=sigma) == approx(mean_excess_by_reynolds(sigma, 0.1) / limit, rel=0.03)


def test_leakage_has_its_limits_at_slow_and_fast_vibration() -> None:
    assert leakage_factor(squeeze_number=1e6) == approx(1 - np.sqrt(2 / 1e6), abs=1e-6)
    slow = leakage_factor(squeeze_number=[0.05, 0.1])
    assert slow[1] == approx(4 * slow[0], rel=1e-2)
    assert slow[1] < 1e-3


def test_the_pressure_at_the_mean_gap_is_the_root_of_the_interior() -> None:
    # p h is constant over the period in the interior: p/p_a = sqrt(1 + 3/2 (a/h)^2) at the mean gap; its mean over
    # the period is more by the mean of h/(h + a cos) = 1/sqrt(1 - (a/h)^2)
    for ratio in (0.1, 0.5, 0.9):
        phase = np.linspace(0, 2 * np.pi, 2000, endpoint=False)
        pressure = np.sqrt(1 + 1.5 * ratio**2) / (1 + ratio * np.cos(phase))
        excess = squeeze_film_pressure(vibration_amplitude=ratio, film_thickness=1.0, ambient_pressure=1.0)
        assert 1 + excess == approx(pressure.mean(), rel=1e-9)


def test_the_amplitude_that_carries_a_load_is_that_of_the_levitation_gap() -> None:
    h = levitation_gap(normal_load=3.0, vibration_amplitude=2e-6, **DISC)
    found = levitation_amplitude(normal_load=3.0, film_thickness=h, face_radius=10e-3, ambient_pressure=101325.0)
    assert found == approx(2e-6)
