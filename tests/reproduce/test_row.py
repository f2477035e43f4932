"""Verdicts follow from print, rounding and recorded evidence alone."""

from hypothesis import given, strategies as st
from pytest import approx

from sonolube.published import PrintedNumber, PublishedValue, parse_printed, propagate_rounding
from sonolube.reproduce.row import Verdict, comparison_row, range_rows, undetermined_row


def published(text: str, *, evidence: str = "", corrected: tuple[PrintedNumber, ...] = ()) -> PublishedValue:
    return PublishedValue(
        id="example",
        chapter=2,
        source="Table 2.5",
        quantity="sliding_speed",
        unit="mm/s",
        number=parse_printed(text, "mm/s", quantity="sliding_speed"),
        evidence=evidence,
        corrected=corrected,
    )


def test_a_number_within_half_the_last_digit_is_reproduced() -> None:
    assert comparison_row(published("20.3"), 20.349e-3, "").verdict is Verdict.REPRODUCED
    assert comparison_row(published("20.3"), 20.351e-3, "").verdict is Verdict.MODEL_DISAGREES


def test_a_stated_scatter_widens_the_range() -> None:
    row = comparison_row(published("20.3±2"), 22.2e-3, "")
    assert row.verdict is Verdict.REPRODUCED
    assert [row.published_low, row.published_high] == approx([18.3, 22.3])


def test_the_rounding_of_inputs_widens_the_range_by_what_it_does_to_the_result() -> None:
    # 2.0 to within 0.05 doubled is 4.0 to within 0.1
    two = parse_printed("2.0", "mm/s", quantity="sliding_speed")
    doubled = propagate_rounding(lambda speed: 2 * speed, two)
    assert [doubled.low, doubled.value, doubled.high] == approx([3.9e-3, 4e-3, 4.1e-3])
    row = comparison_row(published("4.09"), doubled, "")
    assert row.verdict is Verdict.REPRODUCED
    assert [row.published_low, row.published_high] == approx([3.985, 4.195])


def test_a_misprint_needs_evidence_and_the_corrected_number() -> None:
    corrected = (parse_printed("20.9", "mm/s", quantity="sliding_speed"),)
    assert comparison_row(published("20.3"), 20.9e-3, "").verdict is Verdict.MODEL_DISAGREES
    assert (
        comparison_row(published("20.3", evidence="75.2 m in 1 h.", corrected=corrected), 20.9e-3, "").verdict
        is Verdict.MISPRINT
    )
    assert (
        comparison_row(published("20.3", evidence="75.2 m in 1 h.", corrected=corrected), 23e-3, "").verdict
        is Verdict.MODEL_DISAGREES
    )


def test_what_cannot_be_computed_names_the_missing_input_and_has_no_error() -> None:
    row = undetermined_row("2.4.5-wear-reduction", "the mass of the arm.")
    assert row.verdict is Verdict.UNDETERMINED
    assert row.note == "Missing: the mass of the arm."
    assert row.computed is None
    assert row.relative_error is None


@given(st.floats(1e-3, 1.0))
def test_the_error_is_that_of_the_computed_number(speed: float) -> None:
    row = comparison_row(published("20.3"), speed, "")
    assert row.relative_error == approx(speed / 20.3e-3 - 1)
    assert row.unit == "mm/s"
    assert row.published == approx(20.3)


def test_rows_of_one_published_number_differ_by_their_suffix() -> None:
    # Table 2.3, row 2: 0.379 N
    plain, cube = (comparison_row("table-2.3-friction_force-2", 0.379, "", suffix=suffix) for suffix in ("", "cube"))
    assert (plain.id, cube.id) == ("table-2.3-friction-force-2", "table-2.3-friction-force-2-cube")
    assert plain.published == cube.published == approx(0.379)


def test_a_range_has_a_row_for_each_limit() -> None:
    # section 2.3.5: wear reductions from 45.8 to 48.6 %
    low, high = range_rows("2.3.5-wear-reduction", 0.458, 0.55, "low", high_note="high")
    assert (low.published, high.published) == approx((45.8, 48.6))
    assert (low.verdict, high.verdict) == (Verdict.REPRODUCED, Verdict.MODEL_DISAGREES)
    assert (low.note, high.note) == ("low", "high")
