"""Tabulated ratios of a flat spring contact: the closed form, limits, borders between its regimes."""

import numpy as np
import pytest
from pytest import approx, raises
from tests.models.friction.worst_errors import worst_error
from tests.same import same

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.friction import (
    SpringContact,
    load_balanced_approach,
    normal_oscillation_ratio,
    tabulated_spring_ratio,
)

UNIT = SpringContact(friction_coefficient=1.0, mindlin_ratio=1.0)
SECOND = 1 / (2 * np.pi)  # frequency of one radian a second


def tabulated(beta: Floats, v: Floats) -> Floats:
    return tabulated_spring_ratio(
        approach=1.0, normal_amplitude=beta, frequency=SECOND, sliding_speed=v * beta, slip_length=1.0
    )


def computed(beta: Floats, v: Floats) -> Floats:
    return normal_oscillation_ratio(
        UNIT,
        approach=load_balanced_approach(UNIT, approach=1.0, normal_amplitude=beta),
        normal_amplitude=beta,
        frequency=SECOND,
        sliding_speed=v * beta,
    )


@pytest.mark.parametrize("decades", [(-4.0, 3.0), (-0.1, 0.6)])
def test_no_amplitude_and_speed_is_farther_than_two_millionths_from_the_closed_form(
    decades: tuple[float, float],
) -> None:
    assert worst_error(tabulated, computed, decades=decades) < 2e-6


def test_springs_that_touch_for_short_have_the_ratio_of_their_phases_of_touching_and_sticking() -> None:
    psi, share = np.geomspace(0.022, 0.5, 40)[:, None], np.linspace(0.01, 1.0, 100)
    h = psi * share  # half the phase of sticking, from which speed and ratio follow
    v = np.sin(h) * np.sin(psi - h) / h
    limit = np.sin(psi) - psi * np.cos(psi)
    ratio = 1 - np.cos(psi - h) * (np.sin(h) - h * np.cos(h)) / limit
    beta = np.broadcast_to(np.pi / limit, h.shape)
    assert tabulated(beta, np.maximum(v, 1e-30)) == approx(ratio, abs=2e-6)


def test_beyond_the_table_the_ratio_is_the_closed_form() -> None:
    beta, v = np.array([2e6, 1e8]), np.array([3e-3, 1e-3])
    same(tabulated(beta, v), computed(beta, v))


@pytest.mark.parametrize("beta", [1e-6, 0.3, 0.999])
def test_slow_sliding_leaves_the_friction_of_the_smallest_approach(beta: float) -> None:
    assert tabulated(np.array(beta), np.array(1e-20)) == approx(1 - beta, abs=1e-9)


@pytest.mark.parametrize("beta", [1.0, 1.2, 3.2, 400.0])
def test_where_contact_is_lost_slow_sliding_leaves_no_friction(beta: float) -> None:
    assert tabulated(np.array(beta), np.array(1e-20)) == approx(0.0, abs=1e-9)


def test_friction_is_whole_without_vibration_and_from_the_critical_speed_on() -> None:
    assert np.all(tabulated(np.geomspace(1e-9, 1e9, 50), np.ones(50)) == 1.0)
    assert tabulated_spring_ratio(
        approach=2e-6, normal_amplitude=0.0, frequency=2e4, sliding_speed=0.02, slip_length=2e-6
    ) == approx(1.0, abs=0)


def test_springs_that_touch_for_less_than_half_a_period_never_stick_above_the_speed_of_their_last_touch() -> None:
    psi = np.linspace(0.1, 1.5, 15)  # half of the phase in which they touch; they stick until v = sin psi
    beta = np.pi / (np.sin(psi) - psi * np.cos(psi))
    assert np.all(tabulated(beta, (1 + 1e-6) * np.sin(psi)) == 1.0)
    assert np.all(tabulated(beta, 0.98 * np.sin(psi)) < 1.0)


@pytest.mark.parametrize("border", [1.0, np.pi])
def test_the_ratio_is_continuous_where_its_tables_meet(border: float) -> None:
    v = np.linspace(0.0, 1.0, 200)[1:]
    below, above = (tabulated(np.full(199, border * factor), v) for factor in (1 - 1e-9, 1 + 1e-9))
    assert below == approx(above, abs=2e-6)


def test_a_slip_length_that_is_not_positive_is_refused_by_name() -> None:
    with raises(InvalidInput, match=r"slip_length must be positive, got 0\.0 m"):
        tabulated_spring_ratio(approach=1e-6, normal_amplitude=1e-6, frequency=2e4, sliding_speed=0.02, slip_length=0.0)
