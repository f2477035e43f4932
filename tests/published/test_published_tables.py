"""The tables, statements, figures and errata of D are whole, named in the vocabulary, and read as printed."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput, UnknownName
from sonolube.published import (
    errata,
    erratum,
    figure,
    figures,
    parse_printed,
    statement,
    statements,
    table,
    table_ids,
)
from sonolube.units import convert
from sonolube.vocabulary import quantity

TABLES = [f"{chapter}.{k}" for chapter, count in ((2, 15), (3, 5), (4, 7)) for k in range(1, count + 1)]
COLUMNS = [column for number in table_ids() for column in table(number).columns.values()]
digits = st.from_regex(r"[0-9]{1,4}(\.[0-9]{1,4})?", fullmatch=True)


def test_all_tables_of_the_dissertation_are_there() -> None:
    assert list(table_ids()) == TABLES


@pytest.mark.parametrize("number", TABLES)
def test_a_table_is_whole(number: str) -> None:
    found = table(number)
    lengths = {len(column.printed) for column in found.columns.values()}
    assert found.id == number
    assert found.section.startswith(number[0])
    assert found.title
    assert len(lengths) == 1
    assert lengths.pop() > 0


def test_every_column_is_named_in_the_vocabulary_and_in_a_unit_of_its_kind() -> None:
    for column in COLUMNS:
        assert column.meaning
        assert column.role in ("given", "measured", "derived", "modelled")
        if column.quantity:
            assert math.isfinite(convert(1.0, from_unit=column.unit, to_unit=quantity(column.quantity).unit))
            assert any(column.cells)
        else:
            assert not column.unit
            assert not any(column.cells)


def test_every_number_lies_within_its_own_range() -> None:
    numbers = [cell for column in COLUMNS for cell in column.cells if cell] + [entry.number for entry in statements()]
    assert len(numbers) > 1000
    assert all(number.low <= number.value <= number.high and number.half_digit > 0 for number in numbers)


def test_a_cell_keeps_its_digits_and_is_in_si() -> None:
    rate = table("2.5").columns["intrinsic_wear_rate"]
    assert rate.printed[0] == "2.237"
    assert rate.values[0] == approx(2.237e-11)
    cell = rate.cells[0]
    assert cell is not None
    assert cell.half_digit == approx(0.5e-14)


def test_an_empty_cell_is_no_number() -> None:
    assert np.isnan(table("4.2").columns["friction_reduction"].values[0])
    assert table("4.2").columns["friction_reduction"].cells[0] is None


def test_words_are_no_numbers() -> None:
    with raises(InvalidInput, match="column pin holds words, not numbers"):
        _ = table("2.14").columns["pin"].values


@pytest.mark.parametrize("number", TABLES)
def test_a_dataset_carries_units_and_long_names(number: str) -> None:
    dataset = table(number).to_dataset()
    for name, column in table(number).columns.items():
        assert dataset[name].attrs["long_name"] == column.meaning
        if column.quantity:
            assert dataset[name].attrs["units"] == quantity(column.quantity).unit
            np.testing.assert_array_equal(dataset[name], column.values)


def test_a_printed_scatter_and_a_printed_range_bound_the_number() -> None:
    scatter = parse_printed("1.024±0.063", "N", quantity="friction_force")
    assert (scatter.low, scatter.value, scatter.high) == approx((0.961, 1.024, 1.087))
    assert scatter.half_digit == approx(0.0005)
    extent = parse_printed("-0.25-0.5", "in", quantity="position")
    assert (extent.low, extent.value, extent.high) == approx((-0.00635, 0.003175, 0.0127))


def test_temperatures_have_an_origin_but_their_digits_have_none() -> None:
    room = parse_printed("21±1", "degC", quantity="temperature")
    assert (room.low, room.value, room.high, room.half_digit) == approx((293.15, 294.15, 295.15, 0.5))


@given(text=digits, power=st.integers(-12, 12))
def test_a_printed_number_is_known_to_half_its_last_digit(text: str, power: int) -> None:
    number = parse_printed(f"{text}e{power}")
    decimals = len(text.partition(".")[2])
    assert number.value == approx(float(text) * 10.0**power)
    assert number.half_digit == approx(0.5 * 10.0 ** (power - decimals))
    assert f"{number.value / 10.0**power:.{decimals}f}" == f"{float(text):.{decimals}f}"


@given(text=digits, scale=st.sampled_from([1e-12, 1e-2, 1.0, 1e9]))
def test_scale_and_unit_multiply_value_and_resolution_alike(text: str, scale: float) -> None:
    plain, scaled = parse_printed(text), parse_printed(text, "mm", scale, quantity="length")
    assert (scaled.low, scaled.value, scaled.high) == approx(
        tuple(1e-3 * scale * number for number in (plain.low, plain.value, plain.high)), rel=1e-9, abs=1e-30
    )


@pytest.mark.parametrize("text", ["", "N/A", "1,5", "3-1", "1.0±", "nan"])
def test_what_is_no_printed_number_is_refused(text: str) -> None:
    with raises(InvalidInput):
        parse_printed(text)


def test_a_unit_of_another_kind_is_refused() -> None:
    with raises(InvalidInput):
        parse_printed("3", "N", quantity="length")


def test_every_statement_has_a_name_of_its_own_and_a_quantity_of_the_vocabulary() -> None:
    names = [entry.id for entry in statements()]
    assert len(names) == len(set(names))
    for entry in statements():
        assert entry.id.startswith(f"{entry.section}-")
        assert entry.relation in ("=", "about", "up to", "<", ">")
        assert entry.meaning
        if entry.quantity:
            assert quantity(entry.quantity)


def test_the_chapters_hold_their_own_statements() -> None:
    for chapter in range(1, 6):
        assert {entry.section[0] for entry in statements(chapter)} == {str(chapter)}
    assert statement("2.5.2-friction-titanium-off").number.text == "1.33±0.1"


def test_figures_carry_no_data_and_name_known_statements() -> None:
    counts = {"1": 5, "2": 45, "3": 18, "4": 57, "B": 6, "C": 4}
    assert [entry.number for entry in figures()] == [
        f"{part}.{k}" for part, n in counts.items() for k in range(1, n + 1)
    ]
    assert all(entry.no_data and entry.shows for entry in figures())
    for entry in figures():
        for name in entry.numbers:
            statement(name)


def test_the_errata_are_numbered_without_a_gap() -> None:
    names = [entry.id for entry in errata()]
    extra = len(names) - 36
    assert extra > 0
    assert names == [f"E{k}" for k in range(1, 37)] + [f"N{k}" for k in range(1, extra + 1)]
    assert all(entry.where and entry.printed and entry.right and entry.evidence for entry in errata())


def test_every_correction_belongs_to_an_erratum() -> None:
    for correction in (correction for number in table_ids() for correction in table(number).corrections):
        assert erratum(correction.erratum)
    for entry in statements():
        assert bool(entry.erratum) == bool(entry.reason) == bool(entry.right)
        assert not entry.erratum or erratum(entry.erratum)


def test_an_unknown_name_is_answered_with_what_is_known() -> None:
    with raises(UnknownName, match=r"unknown table '2\.16'; did you mean"):
        table("2.16")
    with raises(UnknownName, match=r"unknown figure '5\.1'"):
        figure("5.1")
    with raises(UnknownName, match="unknown erratum 'E37'"):
        erratum("E37")
    with raises(UnknownName, match=r"did you mean 2\.5\.2-friction-titanium-off"):
        statement("2.5.2-friction-titanum-off")
    with raises(UnknownName, match="unknown part of D 'chapter6'"):
        statements(6)
