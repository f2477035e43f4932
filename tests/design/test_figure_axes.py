"""Axes of charts over quantities of the vocabulary, and levels of contours."""

import numpy as np
import pytest
from pytest import approx

from sonolube.design.sweep_figures import contour_levels, scaled_axis


def test_a_wear_rate_has_an_axis_in_mm3_per_metre() -> None:
    scale, axis = scaled_axis("wear_rate", np.array([1e-12, 2.566e-11]))  # m2, D Table 3.4
    assert axis.text == "Wear volume per sliding distance [mm3/m]"
    assert scale * 2.566e-11 == approx(2.566e-2)


def test_a_length_has_the_prefix_that_suits_it() -> None:
    scale, axis = scaled_axis("vibration_amplitude", np.array([2.5e-6]))
    assert axis.text == "Vibration amplitude, zero to peak [µm]"
    assert scale == approx(1e6)


def test_an_angle_is_in_degrees() -> None:
    scale, axis = scaled_axis("phase", np.array([0.0, np.pi / 2]))
    assert axis.unit == "deg"
    assert scale * np.pi == approx(180)


def test_another_name_is_its_own_label() -> None:
    scale, axis = scaled_axis("blade_count", np.array([1.0, 3.0, 4.0]))
    assert (scale, axis.text) == (1.0, "Blade count")


@pytest.mark.parametrize(
    ("values", "logarithmic"),
    [
        (np.geomspace(0.01, 0.2, 7), True),
        (np.geomspace(0.2, 0.01, 3), True),
        (np.linspace(0.01, 0.2, 7), False),
        (np.full(4, 0.02), False),
        (np.array([0.02, 0.2]), False),
        (np.array([0.0, 1.0, 10.0]), False),
        (np.array([0.1, np.nan, 10.0]), False),
    ],
)
def test_an_axis_is_logarithmic_over_geometric_sequences(values: np.ndarray, logarithmic: bool) -> None:
    assert scaled_axis("sliding_speed", values)[1].logarithmic is logarithmic


@pytest.mark.parametrize("ends", [(0.237, 0.998), (-3.2, 17.0), (4e-9, 5e-9), (1e5, 1.2e5), (0.0, 1.0)])
def test_levels_of_contours_are_round_and_enclose_the_values(ends: tuple[float, float]) -> None:
    levels = contour_levels(np.array([*ends, np.nan]))
    step = levels[1] - levels[0]
    assert np.diff(levels) == approx(step)
    assert levels[0] <= ends[0] + 1e-6 * step
    assert levels[-1] >= ends[1] - 1e-6 * step
    assert 7 <= levels.size <= 21
    mantissa = step / 10.0 ** np.floor(np.log10(step) + 1e-9)
    assert min(abs(mantissa - each) for each in (1, 2, 2.5, 5)) < 1e-6


@pytest.mark.parametrize("values", [np.full((2, 2), 0.3), np.full((2, 2), np.nan), np.zeros((2, 2))])
def test_levels_of_one_value_or_none_are_two_at_least(values: np.ndarray) -> None:
    assert np.all(np.diff(contour_levels(values)) > 0)
    assert contour_levels(values).size >= 2
