"""Numbers of abstract, summaries and conclusions: each is judged by what was computed where it is first stated."""

from pytest import approx

from dong2015.row import RowKind, Verdict, comparison_row, undetermined_row
from dong2015.summaries import _REPEATED, summary_rows
from sonolube.facts.published import ComputedValue, published_value, statements

FORMULA, MODEL = RowKind.PUBLISHED_FORMULA, RowKind.DEFAULT_MODEL


def test_a_summary_has_the_number_and_the_interval_of_what_it_repeats() -> None:
    # 1 - 0.096/0.251 within the rounding of both: 61.75 (61.5 to 62.0) against 61
    computed = ComputedValue(value=0.6175, low=0.615, high=0.62)
    first = comparison_row("2.3.7-stick-slip-reduction", computed, "arithmetic", kind=FORMULA)
    (again, *_) = (row for row in summary_rows({first.id: first}) if row.id == "5.1.1-stick-slip-reduction")
    assert (again.chapter, again.kind, again.verdict) == (5, FORMULA, Verdict.REPRODUCED)
    assert (again.computed, again.computed_low, again.computed_high) == approx((61.75, 61.5, 62.0))
    assert again.note == "As 2.3.7-stick-slip-reduction: arithmetic"


def test_what_is_open_or_missing_in_a_section_is_so_in_its_summary() -> None:
    rows = {
        row.id: row
        for row in (
            comparison_row("4.5.4-work-reduction", 0.43, "rod", kind=MODEL, possible=(0.0, 0.67)),
            undetermined_row("2.4.5-wear-reduction", "the worn volumes."),
        )
    }
    found = {row.id: row for row in summary_rows(rows)}
    for name in ("4.5.6-work-reduction", "5.1.3-collar-work-reduction"):
        assert found[name].verdict is Verdict.UNDETERMINED
        assert (found[name].possible_low, found[name].possible_high) == approx((0.0, 67.0))
    assert found["5.1.1-high-stress-wear-reduction"].verdict is Verdict.UNDETERMINED
    assert found["5.1.1-high-stress-wear-reduction"].note == "As 2.4.5-wear-reduction: Missing: the worn volumes."


def test_the_abstract_promises_less_error_than_the_conclusions() -> None:
    (row,) = (row for row in summary_rows({}) if row.id == "abstract-model-error")
    assert (row.verdict, row.errata) == (Verdict.MISPRINT, ("E36",))
    assert row.computed == approx(20.0)


def test_every_number_of_the_conclusions_is_judged_but_what_it_wants_of_another_rig() -> None:
    judged = {name.removesuffix("-from").removesuffix("-to") for name in _REPEATED} | {
        row.id for row in summary_rows({})
    }
    asked = {each.id for each in statements(5)} - {"5.1.2-outlier-load", "5.3-normal-load"}
    assert asked <= judged
    assert all(published_value(name).chapter in (2, 4, 5) for name in judged)
