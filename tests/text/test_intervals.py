"""Digits of values with intervals, by hand."""

import math

import pytest
from hypothesis import assume, given, strategies as st

from sonolube.text.intervals import interval_texts


@pytest.mark.parametrize(
    ("numbers", "texts"),
    [
        ((19999.982, 19999.966, 19999.998), ("19999.98", "19999.96", "20000.00")),
        ((20000.0, 19999.9, 20000.1), ("20000.00", "19999.90", "20000.10")),
        ((803.532, 799.61, 807.47), ("804", "799", "808")),
        ((0.2499526, 0.2498996, 0.2500056), ("0.24995", "0.24989", "0.25001")),
        ((0.01991, 0.019664, 0.020159), ("0.0199", "0.0196", "0.0202")),
        ((12345.0, 11845.0, 12845.0), ("12300", "11800", "12900")),  # to hundreds
        ((0.42, 0.3123, 0.5321), ("0.42", "0.31", "0.54")),
        ((-0.42, -0.5321, -0.3123), ("-0.42", "-0.54", "-0.31")),
        ((5.0, 5.0, 5.0), ("5", "5", "5")),  # of no width
        ((5.0, 5.0, 5.3), ("5.0", "5.0", "5.3")),
        ((1.5, 0.0123, 50.0), ("1.5", "0.012", "50")),  # ends of another size
        ((1.5, 0.0, math.inf), ("1.5", "0", "inf")),
        ((2.0, 1.99999999999, 2.00000000001), ("2.000000000", "1.999999999", "2.000000001")),
        ((0.3, 0.1 + 0.2 - 0.1, 0.1 + 0.3), ("0.30", "0.20", "0.40")),  # rounding of floats is no width
        ((0.0, -0.2, 0.1), ("0.00", "-0.20", "0.10")),
        ((math.nan, 1.0, 2.0), ("nan", "1", "2")),
    ],
)
def test_digits_follow_the_narrower_half_of_the_interval(
    numbers: tuple[float, float, float], texts: tuple[str, str, str]
) -> None:
    assert interval_texts(*numbers) == texts


@given(value=st.floats(1e-6, 1e6), below=st.floats(1e-9, 0.9), above=st.floats(1e-9, 9.0))
def test_what_an_interval_holds_is_within_its_text(value: float, below: float, above: float) -> None:
    lower, upper = value * (1 - below), value * (1 + above)
    number, low, high = map(float, interval_texts(value, lower, upper))
    assert low <= lower * (1 + 1e-9)
    assert high >= upper * (1 - 1e-9)
    assume(below > 1e-8 and above > 1e-8)
    assert abs(number - value) <= 0.5 * min(value - lower, upper - value) or abs(number - value) <= 0.05 * value
