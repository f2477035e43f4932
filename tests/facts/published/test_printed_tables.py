"""Tables are complete, named in the vocabulary, and have the printed digits in SI."""

import math

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.published import statements, table, table_ids
from sonolube.text.units import convert
from sonolube.vocabulary import quantity

TABLES = [f"{chapter}.{k}" for chapter, count in ((2, 15), (3, 5), (4, 7)) for k in range(1, count + 1)]
COLUMNS = [column for number in table_ids() for column in table(number).columns.values()]


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
    assert all(number.low <= number.value <= number.high and number.rounding_half_width > 0 for number in numbers)


def test_a_cell_keeps_its_digits_and_is_in_si() -> None:
    rate = table("2.5").columns["intrinsic_wear_rate"]
    assert rate.printed[0] == "2.237"
    assert rate.values[0] == approx(2.237e-11)
    cell = rate.cells[0]
    assert cell is not None
    assert cell.rounding_half_width == approx(0.5e-14)


def test_an_empty_cell_is_no_number() -> None:
    assert np.isnan(table("4.2").columns["friction_reduction"].values[0])
    assert table("4.2").columns["friction_reduction"].cells[0] is None


def test_words_are_no_numbers() -> None:
    with raises(InvalidInput, match="column pin contains words, not numbers"):
        _ = table("2.14").columns["pin"].values


@pytest.mark.parametrize("number", TABLES)
def test_a_dataset_carries_units_and_long_names(number: str) -> None:
    dataset = table(number).to_dataset()
    for name, column in table(number).columns.items():
        assert dataset[name].attrs["long_name"] == column.meaning
        if column.quantity:
            assert dataset[name].attrs["units"] == quantity(column.quantity).unit
            np.testing.assert_array_equal(dataset[name], column.values)


def test_an_unknown_table_is_refused_with_a_known_one() -> None:
    with raises(UnknownName, match=r"unknown table '2\.16'; did you mean"):
        table("2.16")
