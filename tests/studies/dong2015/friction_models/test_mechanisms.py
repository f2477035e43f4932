"""Mechanisms fitted to Tables 2.3 and 4.2 together, by hand computation and against each other."""

import numpy as np
from pytest import approx

from dong2015.friction_models.mechanisms import (
    REPORTED,
    Mechanism,
    mechanism_figures,
    mechanism_predictions,
    mechanisms,
    speeds_of_no_reduction,
)
from sonolube.figure import publication_style
from sonolube.validation.published_tests import friction_tests

FOUND: dict[str, Mechanism] = {one.fit.variant.name: one for one in mechanisms()}


def aicc(name: str) -> float:
    information = FOUND[name].information
    assert information is not None
    return information.aicc


def test_with_mindlins_stiffness_sliding_of_table_4_2_is_too_fast_for_normal_vibration() -> None:
    # v_c = mu omega a C, with C = (2 - nu)/(2 (1 - nu)) of steel and mu = 0.89/5
    expected = 0.178 * 2 * np.pi * 22e3 * np.array([0.46, 0.92, 1.38, 1.85, 2.31]) * 1e-6 * 1.71 / 1.42
    assert speeds_of_no_reduction() == approx(expected, rel=1e-3)
    for test, speed in zip(friction_tests("B"), speeds_of_no_reduction(), strict=True):
        if speed < test.sliding_speed:
            assert FOUND["normal-mindlin"].fit.predict(test) == 1.0


def test_in_plane_motion_of_half_the_normal_one_reaches_the_scatter_of_table_4_2() -> None:
    assert 0.5 < FOUND["in-plane-unbounded"].fit.values[1] < 1.0
    for name in ("in-plane", "in-plane-unbounded"):
        assert FOUND[name].table_4_2.rms < 0.045  # the scatter of one reading is 0.04 N of 0.89 N


def test_the_same_in_plane_motion_in_both_tables_has_no_effect() -> None:
    fitted, normal = FOUND["in-plane-in-both"], FOUND["normal"]
    assert fitted.fit.values[1] < 0.05
    assert fitted.table_4_2.rms == approx(normal.table_4_2.rms, abs=0.02)


def test_the_zero_error_that_fits_best_is_half_the_friction_that_was_read() -> None:
    assert FOUND["zero-error-unbounded"].fit.values[1] == approx(0.44, abs=0.02)
    # 0.35 N: (0.04 + 0.35)/(0.89 + 0.35) = 0.31 is then the true ratio of the last row
    assert FOUND["slack-string"].table_4_2.rms < 0.6 * FOUND["normal"].table_4_2.rms
    assert FOUND["slack-string"].table_2_3.rms < FOUND["normal"].table_2_3.rms


def test_the_criteria_prefer_a_zero_error_to_in_plane_motion() -> None:
    ranked = sorted(FOUND, key=aicc)
    assert ranked[:3] == ["slack-string", "zero-error-unbounded", "in-plane-unbounded"]


def test_a_reading_with_a_zero_error_is_the_true_force_less_it() -> None:
    mechanism = FOUND["zero-error-unbounded"]
    memory, zero = mechanism.fit.values
    test = friction_tests("B")[2]
    normal = mechanism.fit.variant.predict(test, memory, 0.0)
    assert normal is not None
    assert mechanism.fit.predict(test) == approx((normal * (0.89 + zero) - zero) / 0.89, rel=1e-6)


def test_a_mechanism_predicts_every_test_of_table_4_2() -> None:
    predictions = [mechanism_predictions(test) for test in friction_tests("B")]
    assert [set(one) for one in predictions] == [set(REPORTED)] * 5
    assert predictions[0]["normal-mindlin"][0] == approx(1.0, abs=1e-9)
    assert not any(mechanism_predictions(test) for test in friction_tests("A"))


def test_the_figure_of_the_mechanisms_is_drawn_with_units() -> None:
    from matplotlib import pyplot as plt

    (figure,) = mechanism_figures()
    with publication_style():
        drawn = figure.draw()
    labels = [axes.get_xlabel() + axes.get_ylabel() for axes in drawn.axes]
    assert any("[" in label for label in labels)
    plt.close(drawn)
