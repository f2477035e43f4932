"""Charts and tables of friction at steps, and of tests with and without vibration, number by number."""

from typing import Any

import numpy as np
import pytest
from pytest import approx

from sonolube.charts import Band, Chart, Line, Part, Points, Rule, Zone
from sonolube.measurement.friction.force_cycle import StickSlipBurst, StickSlipEstimate, not_detected
from sonolube.measurement.friction.rotation import MotorFrictionTrace
from sonolube.measurement.friction.voltage_steps import VoltageStep
from sonolube.measurement.friction.windows import SteadyStateOnset, WindowStatistics
from sonolube.report.measured.friction_steps import (
    _bursts,
    _slips,
    _unknown_rotation,
    _zero_taken_off,
    by_cycle_figure,
    comparison_figure,
    comparison_sheet,
    loops_figure,
    motor_trace_figure,
    stick_slip_figure,
    trace_chart,
    voltage_steps_figure,
)
from sonolube.report.measured.sheet import Figure, Sheet, Value


def chart_of(figure: Figure) -> Chart:
    assert figure.drawing.chart is not None
    return figure.drawing.chart()


def only(parts: tuple[Part, ...] | list[Part], kind: type[Part]) -> list[Any]:
    return [part for part in parts if isinstance(part, kind)]


STICKING = StickSlipEstimate(
    stick_slip_frequency=8.0,
    spectral_frequency=8.1,
    stick_slip_amplitude=0.16,
    stick_slip_amplitude_interval=(0.15, 0.18),
    force_drops=12,
    stick_slip_fraction=0.4,
    bursts=(
        StickSlipBurst(start_time=11.0, end_time=12.0, force_drops=8),
        StickSlipBurst(start_time=13.0, end_time=13.5, force_drops=4),
    ),
)


def step(voltage: float, force: float, reduction: float | None, stick_slip: StickSlipEstimate) -> VoltageStep:
    return VoltageStep(
        voltage_peak_to_peak=voltage,
        start_time=voltage + 1,
        end_time=voltage + 4,
        friction_force=force,
        friction_force_deviation=0.02,
        friction_force_uncertainty=force / 100,
        sliding_speed=0.05,
        friction_reduction=reduction,
        friction_reduction_uncertainty=None if reduction is None else reduction / 20,
        force_zero=0.0,
        stick_slip=stick_slip,
    )


STEPS = [
    step(0.0, 1.0, None, not_detected("noise", 3.0)),
    step(10.0, 0.6, 0.4, STICKING),
    step(20.0, 0.2, 0.8, not_detected("too coarse", 99.0, resolved=False)),
]


def windows(channel: str = "friction_force") -> WindowStatistics:
    return WindowStatistics(
        time=np.array([1.0, 3.0, 5.0]),
        mean=np.array([0.5, 0.7, 0.6]),
        deviation=np.ones(3),
        fluctuation=np.array([0.1, 0.2, 0.05]),
        samples=np.array([10, 10, 5]),
        window_duration=2.0,
        channel=channel,
        unit="N",
    )


def onset(*, steady: bool) -> SteadyStateOnset:
    return SteadyStateOnset(
        steady=steady,
        reason="",
        start_time=2.0,
        sliding_distance=0.1,
        friction_force=0.65,
        friction_force_deviation=0.0,
        friction_force_uncertainty=0.0,
    )


def test_a_trace_shows_samples_the_band_of_the_fluctuation_the_means_and_the_steady_state() -> None:
    t, signal = np.arange(6.0), np.arange(6.0) / 10
    (panel,) = trace_chart(t, signal, windows=windows(), steady=onset(steady=True)).panels
    assert (panel.x.label, panel.x.unit, panel.y.label, panel.y.unit) == ("Time", "s", "Friction force", "N")
    samples, mean = only(panel.parts, Line)
    (band,), (rule,) = only(panel.parts, Band), only(panel.parts, Rule)
    assert samples.y == approx(signal)
    assert mean.y == approx([0.5, 0.7, 0.6])
    assert mean.label == "mean of 2 s"
    assert band.low == approx([0.4, 0.5, 0.55])
    assert band.high == approx([0.6, 0.9, 0.65])
    assert rule.value == 3.0  # since the first window
    assert rule.label == "steady after 0.1 m"
    for steady in (None, onset(steady=False)):
        (panel,) = trace_chart(None, None, windows=windows("temperature"), steady=steady).panels
        assert len(panel.parts) == 2
        assert panel.y.unit == "K"
    (panel,) = trace_chart(None, signal, windows=windows("own"), steady=None).panels
    assert (panel.y.label, panel.y.unit) == ("own", "")


def test_a_signal_by_cycle_is_a_line_with_its_points() -> None:
    (panel,) = chart_of(by_cycle_figure(np.array([3.0, 4.0]), np.array([0.2, 0.3]), "friction_coefficient")).panels
    assert (panel.x.label, panel.y.label) == ("Cycle", "Coefficient of friction")
    for part in panel.parts:
        assert isinstance(part, Line | Points)
        assert part.x.tolist() == [3, 4]
        assert part.y.tolist() == [0.2, 0.3]


def test_friction_over_voltage_has_all_steps_and_its_reduction_those_with_vibration() -> None:
    force, reduction = chart_of(voltage_steps_figure(STEPS)).panels
    (points,), (percent,) = force.parts, reduction.parts
    assert isinstance(points, Points)
    assert isinstance(percent, Points)
    assert points.x.tolist() == [0, 10, 20]
    assert points.y.tolist() == [1.0, 0.6, 0.2]
    assert points.y_error == approx(np.array([0.01, 0.006, 0.002]))
    assert points.sources == ("1 to 4 s", "11 to 14 s", "21 to 24 s")
    assert percent.x.tolist() == [10, 20]
    assert percent.y == approx([40, 80])
    assert percent.y_error == approx(np.array([2, 4]))
    assert percent.sources == ("11 to 14 s", "21 to 24 s")
    assert (force.y.label, force.y.unit, force.y.lowest) == ("Friction force", "N", 0.0)
    assert (reduction.y.label, reduction.y.unit, reduction.y.lowest) == ("Friction reduction", "%", 0.0)
    below = [STEPS[0], step(10.0, -0.1, 1.1, STICKING)]
    assert [panel.y.lowest for panel in chart_of(voltage_steps_figure(below)).panels] == [None, 0.0]


def test_stick_slip_is_shaded_where_it_is_and_its_fall_has_its_interval() -> None:
    left, right = chart_of(stick_slip_figure(np.arange(5.0), np.ones(5), STEPS)).panels
    (zone,), (line,) = only(left.parts, Zone), only(left.parts, Line)
    assert zone.first.tolist() == [11.0, 13.0]
    assert zone.last.tolist() == [12.0, 13.5]
    assert line.y.tolist() == [1.0] * 5
    (points,) = right.parts
    assert isinstance(points, Points)
    assert points.x.tolist() == [10.0]
    assert points.y == approx([160.0])  # mN
    assert points.y_error == approx(np.array([[10.0], [20.0]]))
    assert right.x.highest == approx(21.0)
    assert right.y.highest == approx(1.15 * 180)
    assert (right.x.lowest, right.y.lowest, right.y.unit) == (0.0, 0.0, "mN")


def test_a_long_loop_is_thinned_to_twenty_thousand_values() -> None:
    velocity = np.arange(45_000.0)
    (panel,) = chart_of(loops_figure(velocity, 2 * velocity)).panels
    (line,), rules = only(panel.parts, Line), only(panel.parts, Rule)
    assert line.x.size == 22_500
    assert line.y == approx(2 * line.x)
    assert sorted(rule.along for rule in rules) == ["x", "y"]
    assert [rule.value for rule in rules] == [0.0, 0.0]
    (short,) = chart_of(loops_figure(velocity[:39_999], velocity[:39_999])).panels
    assert only(short.parts, Line)[0].x.size == 39_999


def test_friction_by_the_motor_has_its_uncertainty() -> None:
    trace = MotorFrictionTrace(
        time=np.array([1.0, 2.0]), friction_force=np.array([3.0, 4.0]), friction_force_uncertainty=np.array([0.3, 0.5])
    )
    (panel,) = chart_of(motor_trace_figure(trace)).panels
    (points,) = only(panel.parts, Points)
    assert points.y.tolist() == [3, 4]
    assert points.y_error.tolist() == [0.3, 0.5]


def test_tests_of_each_kind_are_spread_about_its_place_with_its_mean() -> None:
    without, vibrated = [("a", 1.0), ("b", 1.4), ("c", 0.9)], [("d", 0.4), ("e", 0.6)]
    (panel,) = chart_of(comparison_figure(without, vibrated, "mean_force")).panels
    first, second = only(panel.parts, Points)
    means = only(panel.parts, Line)
    assert first.x == approx([-0.04, 0.0, 0.04])
    assert first.y.tolist() == [1.0, 1.4, 0.9]
    assert first.sources == ("a", "b", "c")
    assert first.label == "without: 3 tests"
    assert second.x == approx([0.98, 1.02])
    assert second.label == "with: 2 tests"
    assert means[0].x == approx([-0.25, 0.25])
    assert means[0].y == approx([1.1, 1.1])
    assert means[1].x == approx([0.75, 1.25])
    assert means[1].y == approx([0.5, 0.5])
    assert panel.x.words == ("without", "with vibration")
    assert (panel.x.lowest, panel.x.highest) == (-0.5, 1.5)
    assert (panel.y.label, panel.y.unit, panel.y.lowest) == ("Steady friction", "N", 0.0)
    assert panel.y.highest == approx(1.12 * 1.4)
    (known,) = chart_of(comparison_figure(without, vibrated, "friction_force")).panels
    assert known.y.label == "Friction force"


def test_each_step_says_whether_it_sticks_and_slips() -> None:
    table = _slips(STEPS)
    names = [column.name for column in table.columns]
    no, yes, unseen = (dict(zip(names, row, strict=True)) for row in table.rows)
    assert no == {"voltage_peak_to_peak": 0.0, "detected": "no"} | dict.fromkeys(names[2:])
    assert unseen["detected"] == "cannot be seen"
    assert yes == {
        "voltage_peak_to_peak": 10.0,
        "detected": "yes",
        "force_drops": 12.0,
        "stick_slip_amplitude": 0.16,
        "stick_slip_amplitude_lower": 0.15,
        "stick_slip_amplitude_upper": 0.18,
        "stick_slip_frequency": 8.0,
        "stick_slip_period": 0.125,
        "stick_slip_fraction": 0.4,
    }
    assert _bursts(STEPS[1:2]).rows == ((10.0, 11.0, 12.0, 8.0), (10.0, 13.0, 13.5, 4.0))


def test_a_zero_that_was_taken_off_and_a_missing_rotation_are_said() -> None:
    assert _zero_taken_off(STEPS[0], "N") == ()
    from dataclasses import replace

    (said,) = _zero_taken_off(replace(STEPS[0], force_zero=0.031), "N")
    assert said.startswith("31 mN, the mean force at rest before sliding")
    assert "in the friction over 23 s, and no wobble taken off" in _unknown_rotation(STEPS)


def levels_of(name: str, *levels: float) -> list[Sheet]:
    return [Sheet(title=f"{name}{level:g}", values=(Value(name, "L", level, "N"),)) for level in levels]


def test_a_comparison_has_the_reduction_by_fieller_and_the_significance_of_few_tests() -> None:
    found = comparison_sheet(levels_of("mean_force", 0.5, 0.6, 0.55), levels_of("mean_force", 1.0, 1.1, 1.05, 0.95))
    numbers = {value.name: value for value in found.values}
    reduction = numbers["friction_reduction"]
    assert reduction.value == approx(1 - 0.55 / 1.025)
    assert reduction.interval is not None
    assert reduction.interval[0] < reduction.value < reduction.interval[1]
    assert numbers["permutation_p"].value == approx(1 / 35)
    assert numbers["welch_p"].value < 0.01
    assert found.caveats == ()
    assert found.title == "3 with vibration against 4 without"
    assert found.source == {"compared": "mean force"}
    few = comparison_sheet(levels_of("mean_force", 0.5, 0.6), levels_of("mean_force", 1.0, 1.1))
    assert "2 and 2 tests are too few for significance at 95% " in few.caveats[-1]
    assert "the least possible p value is 0.33" in few.caveats[-1]


def test_levels_are_compared_by_the_best_that_all_tests_have() -> None:
    both = [Sheet(values=(*levels_of("mean_force", 1.0)[0].values, *levels_of("friction_force", 2.0)[0].values))]
    found = comparison_sheet(levels_of("friction_force", 0.5), both)
    assert found.source == {"compared": "friction force"}
    assert {value.name: value.value for value in found.values}["friction_reduction"] == approx(0.75)
    none = comparison_sheet(levels_of("mean_force", 0.5), levels_of("friction_force", 1.0))
    assert none.not_found == ("comparison: the tests have no level of friction in common",)


@pytest.mark.parametrize("scatter", [0.0, 0.9])
def test_a_reduction_against_a_level_that_may_be_zero_has_no_interval(scatter: float) -> None:
    found = comparison_sheet(
        levels_of("mean_force", 0.5, 0.6), levels_of("mean_force", 1.0 - scatter, 1.0 + scatter + 0.01)
    )
    reduction = next(value for value in found.values if value.name == "friction_reduction")
    assert (reduction.interval is None) == (scatter > 0)
    assert any("may be zero" in caveat for caveat in found.caveats) == (scatter > 0)
