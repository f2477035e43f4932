"""A verdict follows from print, rounding and recorded evidence, and from nothing else."""

from hypothesis import given, strategies as st
from pytest import approx

from sonolube.published import PrintedNumber, parse_printed
from sonolube.published.values import Published, over_rounding
from sonolube.reproduce.row import Verdict, compare, undetermined


def published(text: str, *, reason: str = "", right: tuple[PrintedNumber, ...] = ()) -> Published:
    return Published(
        id="example",
        chapter=2,
        source="Table 2.5",
        quantity="sliding_speed",
        unit="mm/s",
        number=parse_printed(text, "mm/s", quantity="sliding_speed"),
        reason=reason,
        right=right,
    )


def test_a_number_within_half_the_last_digit_is_reproduced() -> None:
    assert compare(published("20.3"), 20.349e-3, "").verdict is Verdict.REPRODUCED
    assert compare(published("20.3"), 20.351e-3, "").verdict is Verdict.MODEL_DISAGREES


def test_a_stated_scatter_widens_the_range() -> None:
    row = compare(published("20.3±2"), 22.2e-3, "")
    assert row.verdict is Verdict.REPRODUCED
    assert [row.published_low, row.published_high] == approx([18.3, 22.3])


def test_the_rounding_of_inputs_widens_the_range_by_what_it_does_to_the_result() -> None:
    # 2.0 to within 0.05 doubled is 4.0 to within 0.1
    two = parse_printed("2.0", "mm/s", quantity="sliding_speed")
    doubled = over_rounding(lambda speed: 2 * speed, two)
    assert [doubled.low, doubled.value, doubled.high] == approx([3.9e-3, 4e-3, 4.1e-3])
    row = compare(published("4.09"), doubled, "")
    assert row.verdict is Verdict.REPRODUCED
    assert [row.published_low, row.published_high] == approx([3.985, 4.195])


def test_a_misprint_needs_evidence_and_the_right_number() -> None:
    right = (parse_printed("20.9", "mm/s", quantity="sliding_speed"),)
    assert compare(published("20.3"), 20.9e-3, "").verdict is Verdict.MODEL_DISAGREES
    assert compare(published("20.3", reason="75.2 m in 1 h.", right=right), 20.9e-3, "").verdict is Verdict.MISPRINT
    assert (
        compare(published("20.3", reason="75.2 m in 1 h.", right=right), 23e-3, "").verdict is Verdict.MODEL_DISAGREES
    )


def test_what_cannot_be_computed_names_the_missing_input_and_has_no_error() -> None:
    row = undetermined(published("20.3"), "the mass of the arm.")
    assert row.verdict is Verdict.UNDETERMINED
    assert row.note == "Missing: the mass of the arm."
    assert row.computed is None
    assert row.relative_error is None


@given(st.floats(1e-3, 1.0))
def test_the_error_is_that_of_the_computed_number(speed: float) -> None:
    row = compare(published("20.3"), speed, "")
    assert row.relative_error == approx(speed / 20.3e-3 - 1)
    assert row.unit == "mm/s"
    assert row.published == approx(20.3)
