"""Verdicts follow from print, rounding and recorded evidence alone."""

import pytest
from hypothesis import given, strategies as st
from pytest import approx

from dong2015.row import RowKind, Verdict, comparison_row, not_computed_row, range_rows, undetermined_row
from sonolube.facts.published import (
    ComputedValue,
    PrintedNumber,
    PublishedValue,
    parse_printed,
    propagate_rounding,
    published_value,
)

FORMULA, MODEL = RowKind.PUBLISHED_FORMULA, RowKind.DEFAULT_MODEL


def published(
    text: str, *, evidence: str = "", errata: tuple[str, ...] = ("E28",), corrected: tuple[PrintedNumber, ...] = ()
) -> PublishedValue:
    return PublishedValue(
        id="example",
        chapter=2,
        source="Table 2.5",
        quantity="sliding_speed",
        unit="mm/s",
        number=parse_printed(text, "mm/s", quantity="sliding_speed"),
        evidence=evidence,
        errata=errata if evidence else (),
        corrected=corrected,
    )


def test_a_number_within_half_the_last_digit_is_reproduced() -> None:
    assert comparison_row(published("20.3"), 20.349e-3, "", kind=FORMULA).verdict is Verdict.REPRODUCED
    assert comparison_row(published("20.3"), 20.351e-3, "", kind=FORMULA).verdict is Verdict.NOT_REPRODUCED


def test_a_stated_scatter_widens_the_range() -> None:
    row = comparison_row(published("20.3±2"), 22.2e-3, "", kind=FORMULA)
    assert row.verdict is Verdict.REPRODUCED
    assert [row.published_low, row.published_high] == approx([18.3, 22.3])


def test_the_rounding_of_inputs_widens_the_range_by_what_it_does_to_the_result() -> None:
    # 2.0 to within 0.05 doubled is 4.0 to within 0.1
    two = parse_printed("2.0", "mm/s", quantity="sliding_speed")
    doubled = propagate_rounding(lambda speed: 2 * speed, two)
    assert [doubled.low, doubled.value, doubled.high] == approx([3.9e-3, 4e-3, 4.1e-3])
    row = comparison_row(published("4.09"), doubled, "", kind=FORMULA)
    assert row.verdict is Verdict.REPRODUCED
    assert [row.published_low, row.published_high] == approx([3.985, 4.195])


def test_a_number_that_entered_the_computation_is_fitted_if_it_agrees() -> None:
    agreeing, missing = (
        comparison_row(published("20.3"), speed, "by a spring", kind=MODEL, fitted="the spring")
        for speed in (20.3e-3, 25e-3)
    )
    assert (agreeing.verdict, missing.verdict) == (Verdict.FITTED, Verdict.NOT_REPRODUCED)
    assert agreeing.note == "by a spring. Fitted to this number: the spring."
    assert missing.note == "by a spring"


@pytest.mark.parametrize(
    ("possible", "verdict"),
    [
        ((10e-3, 30e-3), Verdict.UNDETERMINED),
        ((30e-3, 20.3e-3), Verdict.UNDETERMINED),  # in any order
        ((30e-3, 40e-3), Verdict.NOT_REPRODUCED),  # whatever the input
        ((25e-3, 25e-3), Verdict.NOT_REPRODUCED),
    ],
)
def test_an_input_that_is_not_printed_leaves_open_what_it_decides(
    possible: tuple[float, float], verdict: Verdict
) -> None:
    row = comparison_row(published("20.3"), 25e-3, "", kind=MODEL, possible=possible)
    assert row.verdict is verdict
    assert row.possible_low == approx(1e3 * min(*possible, 25e-3))
    assert row.possible_high == approx(1e3 * max(*possible, 25e-3))


def test_an_input_that_is_not_printed_and_decides_nothing_leaves_a_number_reproduced() -> None:
    row = comparison_row(published("20.3"), 20.3e-3, "", kind=MODEL, possible=(20.29e-3, 20.31e-3))
    assert row.verdict is Verdict.REPRODUCED


def test_about_leaves_a_tenth_and_never_less_than_the_rounding() -> None:
    # "about 40 %", "about 80 degC" in its printed unit, "about 1" to within half a unit
    numbers = [
        published_value(name).number
        for name in ("2.1.5-reduction-aluminium-horn", "4.3.5-temperature-peak", "2.2.5-littmann-ratio")
    ]
    assert [(number.low, number.high) for number in numbers] == [
        approx((0.36, 0.44)),
        approx((345.15, 361.15)),
        approx((0.5, 1.5)),
    ]


def test_a_misprint_needs_evidence_and_the_corrected_number() -> None:
    corrected = (parse_printed("20.9", "mm/s", quantity="sliding_speed"),)
    assert comparison_row(published("20.3"), 20.9e-3, "", kind=FORMULA).verdict is Verdict.NOT_REPRODUCED
    assert (
        comparison_row(
            published("20.3", evidence="75.2 m in 1 h.", corrected=corrected), 20.9e-3, "", kind=FORMULA
        ).verdict
        is Verdict.MISPRINT
    )
    assert (
        comparison_row(
            published("20.3", evidence="75.2 m in 1 h.", corrected=corrected), 23e-3, "", kind=FORMULA
        ).verdict
        is Verdict.NOT_REPRODUCED
    )


def test_a_contradiction_has_the_kind_of_its_erratum() -> None:
    corrected = (parse_printed("20.9", "mm/s", quantity="sliding_speed"),)
    for errata, verdict in ((("E28",), Verdict.MISPRINT), (("E27",), Verdict.OTHER_AVERAGING)):
        value = published("20.3", evidence="75.2 m in 1 h.", errata=errata, corrected=corrected)
        row = comparison_row(value, 20.9e-3, "", kind=FORMULA)
        assert (row.verdict, row.errata) == (verdict, errata)
        assert comparison_row(value, 20.3e-3, "", kind=FORMULA).errata == ()


@pytest.mark.parametrize(("reach", "verdict"), [(6.7e-3, Verdict.REPRODUCED), (6.8e-3, Verdict.TRIVIALLY_MET)])
def test_agreement_says_nothing_where_the_inputs_leave_a_third_open(reach: float, verdict: Verdict) -> None:
    computed = ComputedValue(value=21e-3, low=21e-3 - reach, high=21e-3 + reach)
    row = comparison_row(published("20.3"), computed, "by hand", kind=FORMULA)
    assert row.verdict is verdict
    stated = "by hand. Could not fail: scatter and rounding of its inputs leave 14.2 to 27.8."
    assert row.note == ("by hand" if verdict is Verdict.REPRODUCED else stated)


def test_what_could_not_fail_for_a_stated_reason_is_met_trivially_if_it_agrees() -> None:
    agreeing, missing = (
        comparison_row(published("20.3"), speed, "a sum", kind=MODEL, trivial="it is always so")
        for speed in (20.3e-3, 25e-3)
    )
    assert (agreeing.verdict, missing.verdict) == (Verdict.TRIVIALLY_MET, Verdict.NOT_REPRODUCED)
    assert (agreeing.note, missing.note) == ("a sum. Could not fail: it is always so.", "a sum")


def test_what_cannot_be_computed_names_the_missing_input_and_has_no_error() -> None:
    row = undetermined_row("2.4.5-wear-reduction", "the mass of the arm.")
    assert row.verdict is Verdict.UNDETERMINED
    assert row.note == "Missing: the mass of the arm."
    assert row.computed is None
    assert row.relative_error is None


@given(st.floats(1e-3, 1.0))
def test_the_error_is_that_of_the_computed_number(speed: float) -> None:
    row = comparison_row(published("20.3"), speed, "", kind=FORMULA)
    assert row.relative_error == approx(speed / 20.3e-3 - 1)
    assert row.unit == "mm/s"
    assert row.published == approx(20.3)


def test_rows_of_one_published_number_differ_by_their_suffix() -> None:
    # Table 2.3, row 2: 0.379 N
    plain, cube = (
        comparison_row("table-2.3-friction_force-2", 0.379, "", kind=FORMULA, suffix=suffix) for suffix in ("", "cube")
    )
    assert (plain.id, cube.id) == ("table-2.3-friction-force-2", "table-2.3-friction-force-2-cube")
    assert plain.published == cube.published == approx(0.379)


def test_a_range_has_a_row_for_each_limit() -> None:
    # section 2.3.5: wear reductions from 45.8 to 48.6 %
    low, high = range_rows("2.3.5-wear-reduction", 0.458, 0.55, "low", high_note="high")
    assert (low.published, high.published) == approx((45.8, 48.6))
    assert (low.verdict, high.verdict) == (Verdict.REPRODUCED, Verdict.NOT_REPRODUCED)
    assert (low.note, high.note) == ("low", "high")


def test_a_model_that_misses_a_test_finds_no_misprint() -> None:
    # D has the multi-scale model err by less than 10 %, with an erratum on record; a larger error is no misprint
    for kind in (RowKind.PUBLISHED_MODEL, RowKind.DEFAULT_MODEL):
        assert comparison_row("3.3.4-error", 0.7, "", kind=kind).verdict is Verdict.NOT_REPRODUCED
    assert comparison_row("table-2.5-friction_reduction-1", 0.6299, "", kind=FORMULA).errata == ("E27",)
    assert comparison_row("table-2.5-friction_reduction-1", 0.6299, "", kind=MODEL).verdict is Verdict.NOT_REPRODUCED


def test_less_than_ten_percent_is_met_trivially_by_none_at_all() -> None:
    for reduction, verdict in ((0.0, "trivially_met"), (0.05, "reproduced"), (0.11, "not_reproduced")):
        assert comparison_row("4.1.2-arm-extra-reduction", reduction, "", kind=MODEL).verdict == verdict
    # an error of nothing is a result
    assert comparison_row("3.2.2-error", 0.0, "", kind=MODEL).verdict is Verdict.REPRODUCED


def test_a_missing_part_is_not_computed_and_a_missing_print_undetermined() -> None:
    row = not_computed_row("4.5.4-work-reduction", "pip install netgen-mesher", kind=MODEL)
    assert (row.verdict, row.computed) == (Verdict.NOT_COMPUTED, None)
    assert row.note == "Not computed: pip install netgen-mesher"
    assert undetermined_row("4.5.4-work-reduction", "the load").verdict is Verdict.UNDETERMINED


def test_an_alternative_stands_beside_the_row_and_leaves_its_verdict() -> None:
    # 48.9 % of the work of friction
    row = comparison_row("4.5.4-work-reduction", 0.489, "", kind=MODEL, alternatives={"half": (0.245, "half of it")})
    assert row.verdict is Verdict.REPRODUCED
    assert row.alternatives["half"].computed == approx(24.5)
    assert not row.alternatives["half"].reproduced
    assert row.alternatives["half"].note == "half of it"
