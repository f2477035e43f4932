"""Published values by id: places, intervals, corrections, and ids that name nothing."""

import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.published import (
    column_numbers,
    published_number,
    published_value,
    si_value,
    statements,
    table,
    table_ids,
)


def test_every_number_of_a_table_has_an_id_that_counts_rows_from_one() -> None:
    for number in table_ids():
        for name, column in table(number).columns.items():
            for row, cell in enumerate(column.cells, start=1):
                if cell is not None:
                    assert published_value(f"table-{number}-{name}-{row}").number is cell
                    assert column_numbers(number, name)[row] is cell


def test_hyphens_and_underscores_name_the_same_column() -> None:
    assert published_value("table-2.3-friction_force-2").id == "table-2.3-friction-force-2"
    assert si_value("table-2.3-friction_force-2") == si_value("table-2.3-friction-force-2") == 0.379


def test_a_quoted_number_has_its_section_and_its_chapter() -> None:
    for entry in statements():
        if entry.section[0].isdigit():
            value = published_value(entry.id)
            assert (value.source, value.chapter) == (f"Section {entry.section}", int(entry.section[0]))
    assert published_value("A.1.3.6-groove-radius").source == "Appendix A.1.3.6"
    assert published_value("A.1.3.6-groove-radius").chapter == 2


def test_a_number_stated_as_an_upper_bound_runs_from_zero() -> None:
    value = published_value("4.3.4-slope-ratio").number
    assert (value.low, value.high) == (0.0, 1.0)


def test_a_range_has_two_limits_each_with_its_rounding_interval() -> None:
    # 10.73 to 13.02 N
    low, high = published_value("table-2.9-intrinsic-friction-force-1").limits()
    assert (low.id[-5:], high.id[-3:]) == ("-from", "-to")
    assert (low.number.low, low.number.value, low.number.high) == approx((10.725, 10.73, 10.735))
    assert (high.number.low, high.number.value, high.number.high) == approx((13.015, 13.02, 13.025))


def test_alternatives_of_a_correction_are_numbers_and_words_are_not() -> None:
    corrected = published_value("2.1.2-normal-load").corrected  # 60-240 or 40-240
    assert [(each.low, each.high) for each in corrected] == [(60.0, 240.0), (40.0, 240.0)]
    in_words = published_value("4.3.4-example-warmer-20.7V")
    assert in_words.corrected == ()
    assert in_words.evidence.endswith("[N15]")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("table-2.3-friction-farce-2", "table 2.3 has no column friction_farce"),
        ("table-2.3-friction-force-7", "no number in row 7 of column friction_force"),
        ("table-4.2-friction-reduction-1", "no number in row 1"),
        ("table-2.3-friction-force", "table 2.3 has no column friction"),
    ],
)
def test_an_id_that_names_no_number_of_a_table_is_refused(name: str, message: str) -> None:
    with raises(InvalidInput, match=message):
        published_number(name)


def test_an_id_of_no_table_or_statement_is_refused_with_the_nearest() -> None:
    with raises(UnknownName, match=r"unknown table '2\.16'"):
        published_number("table-2.16-friction-force-1")
    with raises(UnknownName, match=r"did you mean 2\.1\.2-normal-load"):
        si_value("2.1.2-normal-laod")
