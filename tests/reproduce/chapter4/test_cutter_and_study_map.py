"""The cutter head's rows and the map of earlier studies."""

import numpy as np
from pytest import approx

from sonolube.figure import publication_style
from sonolube.reproduce.chapter4.cutter import cutter_rows, soft_layer_fits
from sonolube.validation.study_map import MapPoint, study_map, study_points

MINE = MapPoint(
    label="mine",
    direction="perpendicular",
    friction_reduction=0.5,
    sliding_speed=(0.05, 0.05),
    nominal_pressure=1e6,
)


def test_only_the_stiffening_layer_has_coefficients_alike_under_all_loads() -> None:
    # ratios of the printed forces: 0.21/0.57, 0.29/1.04, 0.44/1.42
    stiffening, linear = soft_layer_fits()
    for fit in (stiffening, linear):
        assert fit.measured == approx((0.36842, 0.27885, 0.30986), abs=1e-5)
    # one number for three ratios: least squares is their mean
    assert stiffening.computed == approx(np.full(3, np.mean(stiffening.measured)), abs=1e-6)
    assert np.abs(np.subtract(linear.computed, linear.measured)).max() > 0.1


def test_the_stiffening_layer_is_within_a_sixth_of_each_printed_coefficient() -> None:
    rows = [row for row in cutter_rows() if row.id.startswith("soft-stiffening")]
    assert [row.published for row in rows] == [0.105, 0.096, 0.11]
    for row in rows:
        assert row.relative_error is not None
        assert abs(row.relative_error) < 1 / 6
        assert "fitted to the three loads" in row.note
        assert "assumed" in row.note


def test_the_map_shows_what_the_text_states_and_leaves_the_rest_out() -> None:
    points = {point.label: point for point in study_points()}
    assert points["Gutowski and Leus"].nominal_pressure == 31e3
    assert points["Littmann et al."].sliding_speed == (0.0, 0.5)
    assert points["Littmann et al."].nominal_pressure is None
    assert points["Oiwa"].sliding_speed is None


def test_the_map_has_units_on_both_axes_and_a_place_for_ones_own_point() -> None:
    import matplotlib.pyplot as plt

    with publication_style():
        figure = study_map(MINE)
    aside, axes, bar = figure.axes
    assert axes.get_xlabel() == "Sliding speed [m/s]"
    assert axes.get_ylabel() == "Nominal pressure [Pa]"
    assert bar.get_ylabel() == "Friction reduction [%]"
    assert "mine" in axes.get_legend_handles_labels()[1]
    assert "stated" in aside.get_xlabel()
    plt.close(figure)
