"""Rounding intervals of printed inputs carried to computed values."""

from operator import add, mul, truediv

from pytest import approx

from sonolube.facts.published import ComputedValue, as_exact, as_setting, parse_printed, propagate_rounding


def test_intervals_of_sums_products_and_quotients_are_those_of_interval_arithmetic() -> None:
    # 2.0 to within 0.05 and 4 to within 0.5
    two, four = parse_printed("2.0"), parse_printed("4")
    for function, low, value, high in (
        (add, 5.45, 6.0, 6.55),
        (mul, 1.95 * 3.5, 8.0, 2.05 * 4.5),
        (truediv, 1.95 / 4.5, 0.5, 2.05 / 3.5),
    ):
        result = propagate_rounding(function, two, four)
        assert (result.low, result.value, result.high) == approx((low, value, high))


def test_an_id_and_its_number_propagate_alike() -> None:
    # 28.6 N is not needed: Table 2.9, 10.73 to 13.02 N, is taken at its midpoint
    assert propagate_rounding(float, "table-2.9-intrinsic-friction-force-1").value == approx(11.875)


def test_an_exact_number_leaves_no_interval_and_a_setting_only_one_with_decimals() -> None:
    # 1600 revolutions were set; 292.5 m were rounded
    turns, distance = as_setting("table-2.2-revolutions-1"), as_setting("table-2.2-sliding-distance-1")
    assert turns.rounding_half_width == 0
    assert distance.rounding_half_width == approx(0.05)
    assert as_exact("table-2.2-sliding-distance-1").rounding_half_width == 0


def test_the_largest_of_computed_values_is_that_of_the_largest_value() -> None:
    narrow, wide = ComputedValue(value=2.0, low=1.9, high=2.1), ComputedValue(value=1.0, low=0.0, high=9.0)
    assert max(wide, narrow) is narrow
    assert min(wide, narrow) is wide
