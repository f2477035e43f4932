"""Coulomb friction under in-plane vibration against the averaged direction cosine and its limits."""

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, mark, raises
from scipy.integrate import quad

from sonolube.errors import InvalidInput
from sonolube.models.friction import (
    oblique_vibration_ratio,
    parallel_vibration_ratio,
    torsional_vibration_ratio,
    transverse_vibration_ratio,
)

speeds = st.floats(1e-3, 10)
angles = st.floats(0, np.pi)


def mean_direction_cosine(zeta: float, angle: float) -> float:
    """Return the mean of the direction cosine by adaptive quadrature, split at the reversals."""

    def cosine(theta: float) -> float:
        along, across = zeta + np.cos(angle) * np.cos(theta), np.sin(angle) * np.cos(theta)
        return float(along / np.hypot(along, across))

    reversals = [np.arccos(-zeta * np.cos(angle))] if abs(zeta * np.cos(angle)) < 1 else []
    mean, _ = quad(cosine, 0, np.pi, points=[np.pi / 2, *reversals], limit=400, epsabs=1e-11, epsrel=1e-11)
    return float(mean / np.pi)


@mark.parametrize("angle", [0.01, 0.3, 0.8, 1.2, 1.55, np.pi / 2, 2.5])
@mark.parametrize("zeta", [0.003, 0.1, 0.5, 0.97, 1.0, 1.3, 4.0])
def test_the_closed_form_at_any_angle_is_the_mean_direction_cosine(zeta: float, angle: float) -> None:
    ratio = oblique_vibration_ratio(sliding_speed=zeta, vibration_velocity=1.0, vibration_direction=angle)
    assert float(ratio) == approx(mean_direction_cosine(zeta, angle), abs=1e-9)


@given(sliding=speeds, vibration=speeds)
def test_along_the_sliding_the_ratio_is_the_fraction_of_the_period_without_reversal(
    sliding: float, vibration: float
) -> None:
    theta = (np.arange(40000) + 0.5) * 2 * np.pi / 40000
    mean = np.mean(np.sign(sliding + vibration * np.cos(theta)))
    ratio = parallel_vibration_ratio(sliding_speed=sliding, vibration_velocity=vibration)
    assert float(ratio) == approx(mean, abs=2e-4)


@given(sliding=speeds, vibration=speeds)
def test_the_oblique_ratio_approaches_the_arcsine_along_the_sliding(sliding: float, vibration: float) -> None:
    along = parallel_vibration_ratio(sliding_speed=sliding, vibration_velocity=vibration)
    nearly = oblique_vibration_ratio(sliding_speed=sliding, vibration_velocity=vibration, vibration_direction=1e-9)
    assert float(nearly) == approx(
        float(along), abs=1e-4
    )  # at equal speeds the difference is proportional to the root of the angle


@given(sliding=speeds, vibration=speeds)
def test_a_turning_ring_has_the_mean_of_its_places(sliding: float, vibration: float) -> None:
    places = (np.arange(4000) + 0.5) * np.pi / 8000
    each = oblique_vibration_ratio(sliding_speed=sliding, vibration_velocity=vibration, vibration_direction=places)
    ring = float(torsional_vibration_ratio(sliding_speed=sliding, vibration_velocity=vibration))
    assert ring == approx(float(each.mean()), abs=1e-5)


@given(sliding=speeds, vibration=speeds, angle=angles)
def test_vibration_in_the_plane_never_raises_friction(sliding: float, vibration: float, angle: float) -> None:
    ratio = oblique_vibration_ratio(sliding_speed=sliding, vibration_velocity=vibration, vibration_direction=angle)
    assert 0 <= float(ratio) <= 1


@given(sliding=speeds, vibration=speeds, angle=angles)
def test_reversing_the_vibration_direction_changes_nothing(sliding: float, vibration: float, angle: float) -> None:
    here, there = (
        oblique_vibration_ratio(sliding_speed=sliding, vibration_velocity=vibration, vibration_direction=direction)
        for direction in (angle, np.pi - angle)
    )
    assert float(here) == approx(float(there), abs=1e-7)


def test_slow_sliding_across_a_vibration_has_its_logarithmic_asymptote() -> None:
    zeta = 1e-6  # K(1 - z^2) tends to ln(4/z)
    ratio = transverse_vibration_ratio(sliding_speed=zeta, vibration_velocity=1.0)
    assert float(ratio) == approx(2 / np.pi * zeta * np.log(4 / zeta), rel=1e-9)


def test_without_vibration_nothing_changes() -> None:
    assert float(transverse_vibration_ratio(sliding_speed=0.1, vibration_velocity=0.0)) == 1
    assert float(parallel_vibration_ratio(sliding_speed=0.1, vibration_velocity=0.0)) == 1


def test_arguments_broadcast() -> None:
    ratio = oblique_vibration_ratio(
        sliding_speed=np.ones((3, 1)), vibration_velocity=np.ones(4), vibration_direction=0.1
    )
    assert ratio.shape == (3, 4)


def test_a_sliding_speed_of_zero_is_refused() -> None:
    with raises(InvalidInput, match=r"sliding_speed must be positive, got 0\.0 m/s"):
        parallel_vibration_ratio(sliding_speed=0.0, vibration_velocity=1.0)
