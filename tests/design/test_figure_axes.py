"""Axes of figures over quantities of the vocabulary."""

import numpy as np
from pytest import approx

from sonolube.design.figure_axes import scaled_label


def test_a_wear_rate_has_an_axis_in_mm3_per_metre() -> None:
    factor, label = scaled_label("wear_rate", np.array([1e-12, 2.566e-11]))  # m2, D Table 3.4
    assert label == "Wear volume per sliding distance [mm3/m]"
    assert factor * 2.566e-11 == approx(2.566e-2)


def test_a_length_has_the_prefix_that_suits_it() -> None:
    factor, label = scaled_label("vibration_amplitude", np.array([2.5e-6]))
    assert label == "Vibration amplitude, zero to peak [µm]"
    assert factor == approx(1e6)
