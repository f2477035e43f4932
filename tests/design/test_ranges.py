"""Ranges and lists of values of a key, as they are typed: even steps, even ratios, names, and what is refused."""

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.design.ranges import ends_of, values_of
from sonolube.errors import InvalidInput

FREQUENCY = "drive.frequency"


def test_a_range_has_even_steps_or_even_ratios_in_si() -> None:
    assert values_of(FREQUENCY, "20kHz:24kHz:5") == approx(1e3 * np.arange(20.0, 25.0))
    assert values_of(FREQUENCY, "1 kHz : 100 kHz : 3:log") == approx([1e3, 1e4, 1e5])
    assert values_of(FREQUENCY, "20kHz:24kHz:2") == approx([20e3, 24e3])
    assert values_of("drive.voltage_offset", "-3V:3V:3") == approx([-3.0, 0.0, 3.0])


def test_a_list_has_its_numbers_in_their_order_and_another_key_its_words() -> None:
    assert values_of(FREQUENCY, "22kHz, 21000 Hz").tolist() == [22e3, 21e3]
    assert values_of(FREQUENCY, "22kHz").tolist() == [22e3]
    assert values_of("friction.model", "kinematic, coulomb").tolist() == ["kinematic", "coulomb"]


def test_two_ends_stand_for_what_lies_between_them() -> None:
    assert ends_of(FREQUENCY, "20kHz:24 kHz") == (20e3, 24e3)
    for text in ("20kHz", "20kHz:21kHz:3"):
        with raises(InvalidInput, match=rf"over {FREQUENCY}={text}: points are drawn between two ends, such as"):
            ends_of(FREQUENCY, text)


@pytest.mark.parametrize(
    ("key", "text", "message"),
    [
        (FREQUENCY, "20kHz:24kHz", "must look like drive.frequency=first:last:count, with :log for even ratios"),
        (FREQUENCY, "20kHz:24kHz:5:log:2", "must look like"),
        (FREQUENCY, "20kHz:24kHz:5:lin", "must look like"),
        (FREQUENCY, "20kHz:24kHz:x", "must look like"),
        (FREQUENCY, "20kHz:24kHz:1", "needs at least 2 values that rise"),
        (FREQUENCY, "24kHz:24kHz:3", "needs at least 2 values that rise"),
        ("drive.voltage_offset", "0V:3V:3:log", "needs at least 2 values that rise, the first above 0"),
        ("friction.model", "a:b:3", "no quantity, and so without a range; list its values, such as friction.model=one"),
        (FREQUENCY, "20mm", "is a length; expected a frequency"),
    ],
)
def test_what_is_no_range_is_refused_with_the_form(key: str, text: str, message: str) -> None:
    with raises(InvalidInput) as refusal:
        values_of(key, text, option="--over")
    assert message in str(refusal.value)
    assert str(refusal.value).startswith(f"--over {key}")


def test_a_range_that_does_not_rise_needs_no_positive_end_in_even_steps() -> None:
    with raises(InvalidInput) as refusal:
        values_of("drive.voltage_offset", "3V:-3V:3")
    assert not str(refusal.value).endswith("above 0")
