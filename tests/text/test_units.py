"""Text with a unit is read once, and what is not a quantity of the right kind is refused in one line."""

import contextlib
import math
from typing import Any

import pint
import pytest
from hypothesis import given, strategies as st
from pytest import approx

from sonolube.errors import InvalidInput
from sonolube.text.unit_grammar import canonical_unit
from sonolube.text.units import (
    COMMON_FACTORS,
    convert,
    format_like,
    format_quantity,
    format_si,
    temperature_difference_to_si,
    to_si,
)


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("40N", "N", 40.0),
        ("8 um", "m", 8e-6),
        ("8 µm", "m", 8e-6),
        ("2.25 mm2", "m2", 2.25e-6),
        ("4.7e10/m2", "1/m2", 4.7e10),
        ("22kHz", "Hz", 22e3),
        ("0.0892 um/V", "m/V", 8.92e-8),
        ("2.566e-2 mm3/m", "m2", 2.566e-11),
        ("48.9 %", "", 0.489),
        ("80 degC", "K", 353.15),
        ("4 h", "s", 14400.0),
        ("6.67 rpm", "1/s", 6.67 / 60),
        ("90 deg/s", "1/s", 0.25),
        ("6.67/min", "1/s", 6.67 / 60),
        ("22 kHz", "1/s", 22e3),
        ("60 rpm", "rad/s", 2 * math.pi),
        ("90 deg", "rad", math.pi / 2),
    ],
)
def test_text_with_a_unit_becomes_si(text: str, unit: str, value: float) -> None:
    assert to_si(text, unit=unit, name="x") == approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("40mm", "--load 40mm is a length; expected a force, such as 40N"),
        ("40", "--load 40 has no unit; expected a force, such as 40N"),
        ("heavy", "--load 'heavy' is not a number with a unit; expected a force, such as 40N"),
        ("40 Nn", "--load 40 Nn: unknown unit 'Nn'; expected a force, such as 40N"),
        ("1e999 N", "--load 1e999 N is not finite"),
        ("nan N", "--load 'nan N' is not a number with a unit; expected a force, such as 40N"),
    ],
)
def test_what_is_not_a_force_is_refused_with_the_remedy(text: str, complaint: str) -> None:
    with pytest.raises(InvalidInput) as refusal:
        to_si(text, unit="N", name="--load")
    assert str(refusal.value) == complaint


@given(st.text(max_size=40))
def test_no_text_whatever_breaks_the_reader(text: str) -> None:
    with contextlib.suppress(InvalidInput):
        assert isinstance(to_si(text, unit="m", name="x"), float)


@given(st.floats(1e-12, 1e12))
def test_conversion_there_and_back_changes_nothing(value: float) -> None:
    assert convert(convert(value, from_unit="m/s", to_unit="mm/s"), from_unit="mm/s", to_unit="m/s") == approx(value)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (2.5e-6, "m", "2.5 um"),
        (4.981e-9, "m2", "4980 um2"),
        (0.0203, "m/s", "20.3 mm/s"),
        (2e9, "N/m", "2 GN/m"),
        (8.92e-8, "m/V", "89.2 nm/V"),
        (0.341, "", "0.341"),
        (0.0, "N", "0 N"),
        (2.566e-11, "m2", "25.7 um2"),
        (9.53e-13, "m2", "0.953 um2"),
        (2.25e-6, "m2", "2.25 mm2"),
        (1.355e-9, "m3", "1.35 mm3"),
        (3e-13, "m3", "0.0003 mm3"),
        (2.4e-14, "m3", "0.000024 mm3"),
        (5e-15, "m3", "5000 um3"),
        (0.1093, "kg", "109 g"),
        (2.41, "kg", "2.41 kg"),
    ],
)
def test_numbers_are_written_as_people_write_them(value: float, unit: str, text: str) -> None:
    assert format_si(value, unit) == text


def test_wear_rates_are_written_as_volumes_per_distance_and_other_quantities_with_prefixes() -> None:
    assert format_quantity(2.566e-11, "wear_rate") == "0.0257 mm3/m"  # D Table 3.4
    assert format_quantity(5e-15, "specific_wear_rate") == "5e-06 mm3/(N m)"
    assert format_quantity(2.566e-11, "asperity_area") == "25.7 um2"
    assert format_quantity(0.528, "wear_rate_ratio") == "0.528"
    assert to_si("5e-06 mm3/(N m)", unit="m2/N", name="specific_wear_rate") == approx(5e-15)


def test_a_rise_of_temperature_is_no_temperature() -> None:
    assert temperature_difference_to_si("40 K", name="--warming") == 40.0
    assert temperature_difference_to_si("72 delta_degF", name="--warming") == approx(40.0)
    for text in ("40 degC", "40 degF"):
        with pytest.raises(
            InvalidInput, match=f"^--warming {text} is a temperature; expected a temperature difference, such as 40K"
        ):
            temperature_difference_to_si(text, name="--warming")


def test_a_share_is_no_angle() -> None:
    with pytest.raises(InvalidInput, match="40 % is a pure number; expected a speed"):
        to_si("40 %", unit="m/s", name="speed")


def test_angles_are_written_in_degrees() -> None:
    assert format_si(math.pi / 2, "rad") == "90 deg"
    assert format_si(0.65, "rad") == "37.2 deg"


def test_a_column_has_the_prefix_of_its_largest_value() -> None:
    assert format_like([462e-9, 1.39e-6, 924e-9], "m") == ["0.462 um", "1.39 um", "0.924 um"]
    assert format_like([2e-6, 3e-11, math.nan], "m") == ["2 um", "30 pm", "nan m"]
    assert format_like([0.2, 12.0, -3.0], "") == ["0.2", "12", "-3"]
    assert format_like([65.5e-3, 0.2], "m/s") == ["65.5 mm/s", "200 mm/s"]
    assert format_like([0.0, 5.0], "N") == ["0 N", "5 N"]


@given(st.lists(st.floats(1e-9, 1e6), min_size=1, max_size=5), st.sampled_from(["m", "N", "Pa", "m2", "kg", "rad"]))
def test_values_of_a_column_are_those_of_single_texts(values: list[float], unit: str) -> None:
    for value, text in zip(values, format_like(values, unit), strict=True):
        assert to_si(text, unit=unit, name="value") == approx(value, rel=6e-3)


def test_the_units_that_are_read_without_pint_have_its_values_to_the_last_bit() -> None:
    registry: Any = pint.UnitRegistry(cache_folder=None)
    for unit, known in COMMON_FACTORS.items():
        for written, factor in known.items():
            one = registry.Unit(canonical_unit(written))
            for number in (1.0, 0.3, 417.0):
                expected = registry.Quantity(number, one).to(canonical_unit(unit)).magnitude
                assert to_si(f"{number} {written}", unit=unit, name="") == number * factor == expected, written


def test_what_only_rounding_leaves_of_a_force_is_no_force() -> None:
    force = 0.3
    assert format_si(3 * 0.1 - force, "N", scale=force) == "0 N"
    assert format_si(-16.5e-12, "N", scale=force) == "0 N"
    assert format_si(16.5e-12, "N") == "16.5 pN"
    assert format_si(16.5e-6, "N", scale=force) == "16.5 uN"
    assert format_si(math.nan, "N", scale=force) == "nan N"
