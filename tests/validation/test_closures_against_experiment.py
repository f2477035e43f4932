"""Closures against the measured friction ratios of the dissertation, and the error table known for them."""

from collections.abc import Iterator
from dataclasses import replace

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest
from pytest import approx
from scipy.optimize import minimize
from scipy.special import i0

from sonolube.figure import ReportFigure, publication_style
from sonolube.friction import sine_stick_slip_ratio
from sonolube.reproduce.closures import comparison, figures as closure_figures
from sonolube.validation.closure_comparison import ALL_FITTED, FITTED_ON, REPORTED, fits, judged
from sonolube.validation.closures import VARIANTS
from sonolube.validation.fit import (
    Fit,
    criteria,
    errors_left_out,
    errors_of,
    fitted,
    information,
    left_out,
    measured_in,
    profile_interval,
)
from sonolube.validation.friction_tests import SETS, friction_tests, measured_ratios
from sonolube.validation.parameters import RIGS

NAMED = {variant.name: variant for variant in VARIANTS}


def rms(name: str, sets: str, *values: float) -> float:
    return errors_of(Fit(variant=NAMED[name], sets="", values=values), measured_in(sets)).rms


@pytest.fixture(autouse=True)
def screenless() -> Iterator[None]:
    with mpl.rc_context({"backend": "Agg"}), publication_style():
        yield
    plt.close("all")


def test_measured_ratios_are_those_of_the_printed_forces() -> None:
    assert measured_ratios(measured_in("A")) == approx([0.370, 0.623, 0.707], abs=5e-4)
    assert measured_ratios(measured_in("B")) == approx([0.955, 0.753, 0.360, 0.135, 0.045], abs=5e-4)
    assert measured_ratios(measured_in("CDEF")) == approx([0.459, 0.40, 0.60, 0.337, 0.199], abs=5e-4)
    assert measured_ratios(measured_in("G")) == approx([0.511, 0.568], abs=5e-4)
    assert {test.set_name for test in friction_tests()} == set(SETS)


def test_the_tribometers_scatter_is_carried_on() -> None:
    # 0.379/1.024 with 0.041/0.379 and 0.063/1.024
    assert measured_in("A")[0].uncertainty == approx(0.370 * np.hypot(0.041 / 0.379, 0.063 / 1.024), rel=1e-3)


@pytest.mark.parametrize(
    ("name", "values", "sets", "known", "tolerance"),
    [
        ("load-balanced", (), "A", 0.31, 0.005),
        ("kinematic-fitted", (0.32,), "B", 0.48, 0.005),
        ("kinematic-fitted", (0.32,), "CDEFG", 0.09, 0.025),
        ("stick-slip-mindlin", (), "A", 0.06, 0.005),
        ("stick-slip-mindlin", (), "B", 0.65, 0.005),
        ("stick-slip-mindlin", (), "CDEFG", 0.26, 0.01),
        ("stick-slip", (1.5e-6,), "A", 0.08, 0.005),
        ("stick-slip", (1.5e-6,), "B", 0.46, 0.005),
        ("stick-slip", (1.5e-6,), "CDEFG", 0.09, 0.015),
    ],
)
def test_the_error_table_is_reproduced(
    name: str, values: tuple[float, ...], sets: str, known: float, tolerance: float
) -> None:
    assert rms(name, sets, *values) == approx(known, abs=tolerance)


def test_the_load_balanced_row_of_table_4_2_is_that_of_the_tribometers_contact_and_load() -> None:
    # the cube's height matters: with the small contact of that test and its 5 N the error is 0.81
    on_tribometer = measured_in("A")[0]
    tests = (
        replace(test, contact=on_tribometer.contact, normal_load=on_tribometer.normal_load) for test in measured_in("B")
    )
    fit = Fit(variant=NAMED["load-balanced"], sets="", values=())
    assert errors_of(fit, tests).rms == approx(0.58, abs=0.005)
    assert rms("load-balanced", "B") == approx(0.81, abs=0.005)


def test_as_printed_the_tribometers_ratios_rise_past_one() -> None:
    predicted = [NAMED["as-published"].predict(test) for test in measured_in("A")]
    assert predicted == approx([1.22, 1.91, 2.89], abs=6e-3)


def test_the_welders_speed_before_the_vibration_would_bring_its_error_below_nine_hundredths() -> None:
    # the disc speeds up once the surfaces vibrate; at the speeds from before both rows agree better
    slower = (replace(test, sliding_speed=speed) for test, speed in zip(measured_in("G"), (0.1725, 0.177), strict=True))
    fit = Fit(variant=NAMED["stick-slip"], sets="", values=(1.5e-6,))
    assert errors_of(fit, (*measured_in("CDEF"), *slower)).rms == approx(0.088, abs=2e-3)


def test_the_fitted_memory_length_lies_in_its_known_range() -> None:
    (length,) = fitted(NAMED["stick-slip"], FITTED_ON).values
    assert 0.9e-6 < length < 1.7e-6
    errors = errors_of(fitted(NAMED["stick-slip"], FITTED_ON), measured_in(FITTED_ON))
    assert errors.rms < 0.1
    assert abs(errors.worst) < 0.17


def test_the_fits_are_the_best_within_their_bounds() -> None:
    for name in ("stick-slip", "kinematic-fitted"):
        fit = fitted(NAMED[name], FITTED_ON)
        (parameter,) = fit.variant.parameters
        tried = np.geomspace(parameter.low, parameter.high, 60)
        assert errors_of(fit, measured_in(FITTED_ON)).rms <= min(rms(name, FITTED_ON, value) for value in tried) + 1e-6


@pytest.mark.parametrize("name", ["stick-slip", "kinematic-fitted"])
def test_sets_left_out_of_a_fit_are_predicted_nearly_as_well(name: str) -> None:
    seen = errors_of(fitted(NAMED[name], FITTED_ON), measured_in(FITTED_ON)).rms
    assert seen < errors_left_out(NAMED[name], FITTED_ON).rms < 1.4 * seen


def test_normal_vibration_alone_cannot_give_table_4_2() -> None:
    # below what the widest gap carries friction cannot fall, whatever the memory
    beta = measured_in("B")[-1].vibration_amplitude / 2e-6
    plateau = float(np.exp(-beta) / i0(beta))
    assert plateau == approx(0.23, abs=5e-3)
    assert measured_in("B")[-1].friction_ratio + 2 * (measured_in("B")[-1].uncertainty or 0.0) < plateau


def test_even_free_lengths_do_not_give_table_4_2() -> None:
    tests = measured_in("B")

    def off(logarithms: np.ndarray) -> float:
        decay_length, memory_length = np.exp(logarithms) * 1e-6
        predicted = sine_stick_slip_ratio(
            decay_length=decay_length,
            memory_length=memory_length,
            vibration_amplitude=[test.vibration_amplitude for test in tests],
            frequency=22e3,
            sliding_speed=65.5e-3,
        )
        return float(np.sqrt(np.mean((predicted - measured_ratios(tests)) ** 2)))

    best = min(minimize(off, start, method="Nelder-Mead").fun for start in ([0, 1], [-1, 0], [1, 3]))
    assert best == approx(0.13, abs=0.005)


def test_in_plane_motion_within_its_bounds_is_worth_its_two_parameters() -> None:
    moved, still = (judged(NAMED[name], ALL_FITTED).information for name in ("stick-slip-in-plane", "stick-slip"))
    assert moved is not None
    assert still is not None
    assert moved.free == still.free + 2
    assert moved.akaike < still.akaike - 10
    assert moved.schwarz < still.schwarz - 10


def test_more_in_plane_motion_reaches_ten_per_cent_only_on_what_it_has_seen() -> None:
    # the median error falls below a tenth in the fit, but not where a table is predicted by the others
    pins = judged(NAMED["stick-slip-in-plane-pins"], ALL_FITTED)
    assert pins.seen.median_relative < 0.1
    assert pins.unseen.median_relative > 0.2
    fewer = judged(NAMED["stick-slip-in-plane"], ALL_FITTED).information
    assert fewer is not None
    assert pins.information is not None
    assert fewer.akaike < pins.information.akaike
    assert fewer.schwarz < pins.information.schwarz


def test_no_closure_predicts_table_4_2_from_the_other_tables() -> None:
    # with 0.045 measured at 25.9 V, all of normal motion predict more than half
    for name in ("stick-slip", "stick-slip-in-plane", "kinematic-fitted"):
        fit = left_out(NAMED[name], ALL_FITTED)[ALL_FITTED.index("B")]
        ratio = fit.predict(measured_in("B")[-1])
        assert ratio is not None
        assert ratio > 0.5


def test_the_information_criteria_are_hand_computed() -> None:
    fit = fitted(NAMED["kinematic-fitted"], FITTED_ON)
    found = information(fit, measured_in(FITTED_ON))
    surprise = 2 * 10 * np.log(errors_of(fit, measured_in(FITTED_ON)).rms)
    assert found is not None
    # the share and the error: k = 2, and 2 k (k + 1)/(n - k - 1) = 12/7 for ten tests
    assert found.akaike == approx(surprise + 2 * 2 + 12 / 7)
    assert found.schwarz == approx(surprise + 2 * np.log(10))
    assert criteria(0.1, count=4, free=2).akaike == np.inf


def test_the_memory_length_is_known_to_a_third() -> None:
    fit = fitted(NAMED["stick-slip"], FITTED_ON)
    low, high = profile_interval(fit, 0)
    assert 1e-6 < low < fit.values[0] < high < 2.5e-6
    # at either end the squares have grown by exp(3.841/n): written out on the closed form
    tests = measured_in(FITTED_ON)

    def squares(memory_length: float) -> float:
        predicted = sine_stick_slip_ratio(
            decay_length=2e-6,
            vibration_amplitude=[test.vibration_amplitude for test in tests],
            frequency=[test.frequency for test in tests],
            sliding_speed=[test.sliding_speed for test in tests],
            memory_length=memory_length,
        )
        return float(np.sum((predicted - measured_ratios(tests)) ** 2))

    for end in (low, high):
        assert squares(end) / squares(fit.values[0]) == approx(np.exp(3.841 / 10), rel=5e-3)


def test_each_parameter_of_a_rig_leaves_the_others_rigs_alone() -> None:
    variant = NAMED["coupled-per-rig"]
    assert [parameter.matters_in for parameter in variant.parameters] == ["ACDEF", "B", "G"]
    before, after = (variant.predict(measured_in("A")[0], 1e-7, other, 1e-7) for other in (1e-8, 1e-6))
    assert before == after
    assert "".join(sorted("".join(RIGS.values()))) == "ABCDEFGH"


def test_every_bound_has_its_reason() -> None:
    for variant in VARIANTS:
        for parameter in variant.parameters:
            assert len(parameter.reason) > 20 or parameter.is_angle
            assert parameter.low <= parameter.rest <= parameter.high or parameter.name == "holder_compliance"


def test_a_closure_that_does_not_reach_a_test_says_so() -> None:
    fit = Fit(variant=NAMED["as-published"], sets="", values=())
    assert errors_of(fit, measured_in("G")).missed == ("G-1", "G-2")
    assert information(fit, measured_in(FITTED_ON)) is None


def test_no_fit_leaves_its_bounds() -> None:
    for fit in fits():
        for parameter, value in zip(fit.variant.parameters, fit.values, strict=True):
            assert parameter.low <= value <= parameter.high or value == parameter.rest


def test_each_reported_closure_has_a_row_for_every_reduction_it_reaches() -> None:
    rows = {row.id: row for row in comparison.rows()}
    reductions = [test for test in friction_tests() if test.published]
    assert len(rows) == len(REPORTED) * len(reductions) - 2  # the welder closes the gap as published
    row = rows["closure-stick-slip-A-1"]
    assert (row.source, row.unit, row.published) == ("Table 2.5", "%", 62.22)
    assert row.note.startswith("Stick-slip, memory length fitted; fitted on sets A, C, D, E, F, G: memory_length 1.6")
    assert row.note.endswith("measured 0.370.")


@pytest.mark.parametrize("figure", closure_figures.figures(), ids=lambda figure: figure.name)
def test_figures_are_drawn_with_units(figure: ReportFigure) -> None:
    drawn = figure.draw()
    labels = [axes.get_xlabel() + axes.get_ylabel() for axes in drawn.axes]
    assert any("[" in label for label in labels)
