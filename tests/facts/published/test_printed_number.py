"""Printed numbers: digits, rounding intervals, stated scatter and range, units and scales."""

import pytest
from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.facts.published import parse_printed

digits = st.from_regex(r"[0-9]{1,4}(\.[0-9]{1,4})?", fullmatch=True)


def test_a_printed_scatter_and_a_printed_range_bound_the_number() -> None:
    scatter = parse_printed("1.024±0.063", "N", quantity="friction_force")
    assert (scatter.low, scatter.value, scatter.high) == approx((0.961, 1.024, 1.087))
    assert scatter.rounding_half_width == approx(0.0005)
    extent = parse_printed("-0.25-0.5", "in", quantity="position")
    assert (extent.low, extent.value, extent.high) == approx((-0.00635, 0.003175, 0.0127))


def test_temperatures_have_an_origin_but_their_digits_have_none() -> None:
    room = parse_printed("21±1", "degC", quantity="temperature")
    assert (room.low, room.value, room.high, room.rounding_half_width) == approx((293.15, 294.15, 295.15, 0.5))


@given(text=digits, power=st.integers(-12, 12))
def test_a_printed_number_is_known_to_half_its_last_digit(text: str, power: int) -> None:
    number = parse_printed(f"{text}e{power}")
    decimals = len(text.partition(".")[2])
    assert number.value == approx(float(text) * 10.0**power)
    assert number.rounding_half_width == approx(0.5 * 10.0 ** (power - decimals))
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
