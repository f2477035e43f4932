"""Models compared with published tests and own runs: errors, refusals, disagreement and next conditions in words."""

from types import SimpleNamespace
from typing import Any

import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.report.blocks import Table
from sonolube.report.results import model_comparison as results
from sonolube.validation.comparison import DATA_SETS, ONLY_PREDICTED, FittedParameter
from sonolube.validation.previous_study_map import StudyPoint

NAN = float("nan")


def parameter(**changes: Any) -> Any:
    """Memory length of 1.5 um within 0.1 to 10 um, fitted to all sets."""
    about = SimpleNamespace(
        name="memory length", unit="m", low=1e-7, high=1e-5, applicable_sets="ABC", reason="of a contact",
        is_angle=False,
    )  # fmt: skip
    values = {"parameter": about, "value": 1.5e-6, "interval": (1e-6, 2e-6), "leave_one_out_range": (1.2e-6, 1.8e-6)}
    return FittedParameter(**(values | changes))  # type: ignore[arg-type]


def fit(
    name: str = "kinematic", *, out_of_range: tuple[str, ...] = (), aicc: float | None = -60.74, seen: str = "",
    reasons: tuple[str | None, ...] = (), is_assessed: bool = True,
) -> Any:  # fmt: skip
    errors = SimpleNamespace(count=13, out_of_range=out_of_range, rms=0.1174, median_relative=0.256, largest=0.31)
    unseen = SimpleNamespace(rms=0.1231, count=13, out_of_range=(), median_relative=NAN, largest=NAN)
    return SimpleNamespace(
        model=SimpleNamespace(
            name=name, description="of the mean", source="D 3.1", required_inputs=("sliding_speed",),
            seen=SimpleNamespace(sets=tuple(seen)) if seen else None,
        ),
        sets="ABC",
        assessment=SimpleNamespace(fit_errors=errors, cross_validation_errors=unseen) if is_assessed else None,
        aicc=aicc,
        parameters=(parameter(),),
        predictions=tuple(
            SimpleNamespace(
                test=SimpleNamespace(label=f"T{number}", friction_ratio=0.1 * number), reason=reason,
                fitted=0.5, cross_validated=0.6,
            )
            for number, reason in enumerate(reasons, 1)
        ),
    )  # fmt: skip


def test_errors_of_a_model_have_three_digits_its_median_is_in_percent_and_tests_out_of_range_are_counted() -> None:
    assert results.error_row(fit()) == ("kinematic", "ABC", "13", "1", "0.117", "0.123", "26 %", "-60.7")
    missed = fit(out_of_range=("T1", "T2"), aicc=None)
    assert results.error_row(missed)[2] == "13/15"
    assert results.error_row(missed)[-1] == ""


def test_reasons_are_said_once_with_the_tests_and_beyond_five_with_their_number() -> None:
    some = fit(reasons=("lost", None, "lost", "needs a load", "stuck"))
    # that a model needs an input that is not printed is said of those alone that were not assessed
    assert list(results.refusal_lines(some)) == ["kinematic: lost (T1, T3)", "kinematic: stuck (T5)"]
    assert "kinematic: needs a load (T4)" in list(
        results.refusal_lines(fit(reasons=("lost", None, "lost", "needs a load"), is_assessed=False))
    )
    assert list(results.refusal_lines(fit(reasons=("lost",) * 5))) == ["kinematic: lost (T1, T2, T3, T4, T5)"]
    assert list(results.refusal_lines(fit(reasons=("lost",) * 6))) == ["kinematic: lost (6 tests)"]


def test_blocks_of_a_comparison_have_the_assessed_models_their_parameters_and_what_was_not_reached() -> None:
    fits = [fit(seen="AB", reasons=("lost", None)), fit("bare", is_assessed=False, reasons=("needs a load",) * 2)]
    head, table, *lines = results.fit_blocks(fits)
    letters = ", ".join(DATA_SETS)
    assert head == (
        f"2 models, 2 tests in sets {letters}; errors of the friction ratio,"
        " unseen: of each set by what has not seen it"
    )
    assert isinstance(table, Table)
    assert list(table.heads) == ["model", "sets", "tests", "k", "rms", "unseen", "median", "AICc"]
    assert [row[0] for row in table.rows] == ["kinematic"]
    assert lines == [
        "  kinematic: memory length 1.5 um (95 %: 1 um to 2 um)",
        "  kinematic: rms and AICc in sample: a default has seen sets A, B; unseen by refits",
        *(f"  not fitted: set {letter}: {reason}" for letter, reason in ONLY_PREDICTED.items()),
        "  not reached: kinematic: lost (T1)",
        "  not reached: bare: needs a load (T1, T2)",
    ]


RIG: Any = SimpleNamespace(
    title="Own", normal_load=3.0, sliding_speed=0.02, friction_coefficient=0.2, assumptions={"a": "b"}, name="own",
    file=None,
)  # fmt: skip


def own(reason: str | None = None) -> Any:
    return SimpleNamespace(
        reason=reason, friction_ratio=0.35 if reason is None else NAN, friction_force=1.2, friction_model="own law",
        vibration_amplitude=2.5e-6, amplitude_origin="stated", amplitude_source="file",
    )  # fmt: skip


def predicted(name: str, ratio: float | None, error: float | None, reason: str | None = None) -> Any:
    return SimpleNamespace(
        model=SimpleNamespace(name=name), friction_ratio=ratio, raw_friction_ratio=ratio, uncertainty=error,
        reason=reason,
    )  # fmt: skip


def test_friction_on_a_rig_is_the_ratio_times_coefficient_and_load() -> None:
    # 0.2 * 3 N = 0.6 N without vibration; times 2 and 2.5
    rows = results.rig_rows(
        RIG, own(), [predicted("a", 2.0, 0.125), predicted("b", 2.5, None), predicted("c", None, 1)]
    )
    assert rows == [
        ("own law, its own", "ratio 0.350", "friction 1.2 N"),
        ("a", "ratio 2.000 +- 0.12", "friction 1.2 N"),
        ("b", "ratio 2.500, error not known", "friction 1.5 N"),
    ]
    assert results.rig_rows(RIG, own("lost contact"), []) == [("own law, its own", "lost contact", "")]


def test_models_disagree_where_their_difference_is_more_than_the_root_sum_square_of_their_errors() -> None:
    # errors 0.03 and 0.04: 0.05 together
    assert results.disagreement([predicted("a", 0.50, 0.03), predicted("b", 0.545, 0.04)]) == []
    assert results.disagreement([predicted("a", 0.50, 0.03), predicted("b", 0.56, 0.04)]) == [
        "  models differ by more than their errors: a 0.50 +- 0.03, b 0.56 +- 0.04"
    ]
    # c is the farthest from a, and the nearest for its error; models without ratio or error do not count
    found = results.disagreement(
        [predicted("a", 0.2, 0.1), predicted("b", 0.5, 0.1), predicted("c", 0.9, 0.9), predicted("d", 9.0, None),
         predicted("e", None, 0.1), predicted("f", 9.0, 0.0)]
    )  # fmt: skip
    assert found == ["  models differ by more than their errors: a 0.20 +- 0.10, b 0.50 +- 0.10"]
    assert results.disagreement([]) == []


def test_the_rig_has_its_conditions_its_rows_and_the_reasons_of_models_that_do_not_apply() -> None:
    blocks = list(results.rig_blocks(RIG, own(), [predicted("a", 0.5, 0.1), predicted("b", None, None, "needs oil")]))
    assert blocks[0] == "Own, 3 N, 20 mm/s, 2.5 um: stated"
    assert blocks[-1] == "  not applicable: b: needs oil"
    assert len(blocks) == 3


def test_a_rig_in_json_has_its_own_model_every_prediction_and_its_assumptions() -> None:
    found = results.rig_object(RIG, own("lost"), [predicted("a", 0.5, 0.1)])
    assert found["title"] == "Own"
    assert found["own_model"] == {
        "model": "own law", "friction_ratio": None, "reason": "lost", "amplitude_source": "file",
        "amplitude_origin": "stated", "vibration_amplitude": 2.5e-6,
    }  # fmt: skip
    assert found["predictions"] == [
        {"model": "a", "friction_ratio": 0.5, "raw_friction_ratio": 0.5, "uncertainty": 0.1, "reason": None}
    ]
    assert (found["disagreement"], found["assumptions"]) == ([], {"a": "b"})


def test_a_model_in_json_has_its_errors_and_each_test_measured_and_predicted() -> None:
    found = results.model_object(fit(seen="A", out_of_range=("T9",), reasons=(None, "lost")))
    assert found["errors"] == {
        "rms": approx(0.1174), "rms_cross_validated": approx(0.1231), "largest_error": approx(0.31),
        "median_relative": approx(0.256), "aicc": approx(-60.74), "out_of_range": ["T9"],
    }  # fmt: skip
    assert (found["name"], found["source"], found["required_inputs"]) == ("kinematic", "D 3.1", ["sliding_speed"])
    assert (found["sets"], found["seen_by_default"]) == (["A", "B", "C"], ["A"])
    assert found["predictions"][1] == {
        "test": "T2", "measured": approx(0.2), "fitted": 0.5, "cross_validated": 0.6, "reason": "lost",
    }  # fmt: skip
    bare = results.model_object(fit(is_assessed=False))
    assert (bare["errors"], bare["seen_by_default"]) == (None, [])


def test_a_fitted_parameter_has_its_ranges_and_whether_it_is_at_a_bound() -> None:
    assert results.parameter_object(parameter(value=1e-7)) == {
        "name": "memory length", "applicable_sets": ["A", "B", "C"], "value": 1e-7, "unit": "m",
        "interval": (1e-6, 2e-6), "leave_one_out_range": (1.2e-6, 1.8e-6), "bounds": (1e-7, 1e-5), "at_bound": True,
        "bounds_reason": "of a contact",
    }  # fmt: skip
    assert results.parameter_object(parameter())["at_bound"] is False


CONDITIONS = tuple(
    SimpleNamespace(label=label, friction_ratio=ratio, uncertainty=0.02, repeats=2)
    for label, ratio in (("slow", 0.5), ("fast", 0.8), ("faster", 0.9))
)
RUNS: Any = SimpleNamespace(title="Own runs", runs=6, conditions=CONDITIONS, scatter=0.03)


def of_runs(name: str, rms: float | None, mean: float | None, unseen: float | None, reason: str | None) -> Any:
    return SimpleNamespace(
        model=SimpleNamespace(name=name), rms=rms, mean=mean, cross_validated_rms=unseen, reason=reason, reached=2,
        ratios=(0.5, None),
    )  # fmt: skip


def test_errors_on_own_runs_have_a_sign_and_the_error_to_expect() -> None:
    several = [
        of_runs("a", 0.1234, -0.05, 0.117, None),
        of_runs("b", 0.2, 0.05, None, "too fast"),
        of_runs("c", None, None, None, "too fast"),
    ]
    assert results.runs_rows(RUNS, several) == [
        ("a", "2/3", "0.123", "-0.050", "0.117"), ("b", "2/3", "0.200", "+0.050", ""),
    ]  # fmt: skip
    head, table, *reasons = list(results.runs_blocks(RUNS, several))
    assert head == "Own runs: 6 runs under 3 conditions, by models as published tests fitted them"
    assert isinstance(table, Table)
    assert list(table.heads) == ["model", "reached", "rms", "mean", "expected"]
    assert reasons == ["  own runs not reached: b, c: too fast"]
    found = results.runs_object(RUNS, several[:1])
    assert found["conditions"][1] == {"label": "fast", "friction_ratio": 0.8}
    assert found["runs"] == 6
    assert found["predictions"] == [
        {"model": "a", "friction_ratios": [0.5, None], "rms": 0.1234, "mean_error": -0.05, "expected_rms": 0.117,
         "reason": None}
    ]  # fmt: skip


def ranked(name: str, reached: int, *, tied: bool = False, aicc: float | None = -7.25) -> Any:
    return SimpleNamespace(
        name=name, fit=SimpleNamespace(variant=SimpleNamespace(source="D 3")), parameters=(parameter(interval=None),),
        fitted=(0.5, 0.8, None), unseen=(0.6, None, None), rms_fit=0.05, rms_unseen=0.1 if reached else NAN, aicc=aicc,
        probability=0.04, tied=tied, reached=reached,
    )  # fmt: skip


def next_condition(is_beyond: bool, amplitude: float | None = 2e-6) -> Any:
    condition = SimpleNamespace(
        settings="20 mm/s", vibration_amplitude=amplitude, vibration_velocity=None, sliding_speed=0.02
    )
    return SimpleNamespace(
        condition=condition, is_beyond=is_beyond, first="a", second="b", first_ratio=0.254, second_ratio=0.757,
        contrast=3.14,
    )  # fmt: skip


FIT: Any = SimpleNamespace(
    table=RUNS, models=(ranked("a", 3), ranked("b", 3, tied=True, aicc=None), ranked("c", 1)), rms_of_mean=0.2,
    inapplicable={"x": "needs oil", "y": "needs oil", "z": "too fast"}, verdict="not decided", is_decided=False,
    next_conditions=(next_condition(True),),
)  # fmt: skip


def test_models_on_own_runs_are_tied_or_miss_conditions_and_the_mean_stands_last() -> None:
    assert results.error_rows(FIT) == [
        ("a", "1", "0.100", "0.050", "-7.2", ""),
        ("b", "1", "0.100", "0.050", "", "tied"),
        ("c", "1", "0.100", "0.050", "-7.2", "out of range: 2 conditions"),
        ("mean of the other conditions", "0", "0.200", "", "", ""),
    ]
    assert results.parameter_lines(FIT)[0] == "  a: memory length 1.5 um (one condition left out: 1.2 um to 1.8 um)"
    assert results.inapplicable_lines(FIT) == ["  not applicable: x, y: needs oil", "  not applicable: z: too fast"]


def test_the_next_condition_has_its_voltage_where_voltage_and_amplitude_are_known() -> None:
    told = ": a has 0.25, b 0.76, 3.1 of their errors apart"
    # 10 V per micrometre, 2 um: 20 V
    assert results.next_line(next_condition(True), 1e7) == (
        f"  measure next: 20 mm/s (20 V peak to peak), beyond the runs{told}"
    )
    assert results.next_line(next_condition(False), None) == f"  measure next: 20 mm/s{told}"
    assert results.next_line(next_condition(False, None), 1e7) == f"  measure next: 20 mm/s{told}"


def test_a_fit_in_json_has_each_models_errors_and_no_bounds_of_published_sets() -> None:
    found = results.fit_object(FIT)
    assert found["conditions"][0] == {"label": "slow", "friction_ratio": 0.5, "uncertainty": 0.02, "repeats": 2}
    assert (found["runs"], found["scatter"], found["rms_of_mean"]) == (6, 0.03, 0.2)
    assert (found["verdict"], found["decided"]) == ("not decided", False)
    first = found["models"][0]
    assert (first["name"], first["source"], first["tied"], first["conditions_in_range"]) == ("a", "D 3", False, 3)
    assert (first["rms_unseen"], first["rms"]) == approx((0.1, 0.05))
    assert first["unseen_ratio"] == [0.6, None, None]
    assert first["fitted_ratio"] == [0.5, 0.8, None]
    assert set(first["fitted"][0]) == {"name", "value", "unit", "interval", "leave_one_out_range", "at_bound"}
    assert found["measure_next"] == [
        {"vibration_amplitude": 2e-6, "vibration_velocity": None, "sliding_speed": 0.02, "models": ["a", "b"],
         "friction_ratios": [0.254, 0.757], "contrast": 3.14, "beyond_the_runs": True}
    ]  # fmt: skip
    assert found["not_applicable"] == FIT.inapplicable


@pytest.mark.parametrize(("amplitude", "volts", "found"), [(2e-6, 20.0, 1e7), (0.0, 20.0, None), (2e-6, None, None)])
def test_voltage_per_amplitude_needs_both(
    amplitude: float, volts: float | None, found: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    steady = SimpleNamespace(vibration_amplitude=amplitude)
    monkeypatch.setattr(results, "steady_vibration", lambda rig: steady)
    rig: Any = SimpleNamespace(drive=None if volts is None else SimpleNamespace(voltage_peak_to_peak=volts))
    assert results.volts_per_amplitude(rig) == (None if found is None else approx(found))


def test_a_rig_on_the_map_of_studies_has_its_pressure_and_its_speed_at_both_ends(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(
        results, "friction_point", lambda rig: SimpleNamespace(friction_reduction=0.65, reason="beyond")
    )
    rig: Any = SimpleNamespace(
        name="own", title="Own", file=None, sliding_speed=0.02, normal_load=3.0,
        contact=SimpleNamespace(nominal_area=1.5e-6),
    )  # fmt: skip
    point, reason = results.point_of_rig(rig)
    assert (point.label, point.direction, reason) == ("own", "perpendicular", "beyond")
    assert point.sliding_speed == approx((0.02, 0.02))
    assert point.nominal_pressure == approx(2e6)  # 3 N over 1.5 mm2
    assert point.friction_reduction == approx(0.65)
    rig.sliding_speed = 0.0
    with raises(InvalidInput, match=r"^Own: the map needs a sliding\.sliding_speed above 0$"):
        results.point_of_rig(rig)


def test_a_point_of_an_own_table_says_what_is_known_of_it() -> None:
    full = StudyPoint(
        label="Own", direction="transverse", friction_reduction=0.654, sliding_speed=(0.01, 0.02), nominal_pressure=2e6
    )
    assert results.own_point_line(full) == ("Own, own table: friction reduction 65 %, transverse, 20 mm/s, 2 MPa")
    bare = StudyPoint(label="Own", direction="", friction_reduction=0.5, sliding_speed=None, nominal_pressure=None)
    assert results.own_point_line(bare) == "Own, own table: friction reduction 50 %, direction not stated"


def number(quantity: str, relation: str, text: str, unit: str) -> Any:
    return SimpleNamespace(
        quantity=quantity, relation=relation, number=SimpleNamespace(text=text, value=0.5), unit=unit, meaning="passes"
    )


def test_a_study_has_its_direction_references_and_numbers_as_printed() -> None:
    study: Any = SimpleNamespace(
        study="Mason", direction="", section="1.2", references=(3, 4), summary="slides", numbers=(
            number("sliding_speed", "up to", "0.5", "m/s"), number("", "=", "12", ""),
        ),
    )  # fmt: skip
    lines = results.study_lines(study)
    assert lines[:2] == ["Mason, direction not stated, D 1.2 [3, 4]", "  slides"]
    assert lines[2] == "  Sliding speed up to 0.5 m/s; passes 12"
    assert results.study_object(study) == {
        "study": "Mason", "section": "1.2", "references": [3, 4], "direction": "", "summary": "slides",
        "sliding_speed": {"value": 0.5, "relation": "up to", "printed": "0.5 m/s", "unit": "m/s"},
    }  # fmt: skip
    study.numbers, study.direction = (), "normal"
    assert results.study_lines(study) == ["Mason, normal, D 1.2 [3, 4]", "  slides"]
