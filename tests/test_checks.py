"""Refusals name the argument, the value and its unit."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from sonolube.checks import (
    require_finite,
    require_finite_complex,
    require_non_negative,
    require_positive,
    require_within,
)
from sonolube.errors import InvalidInput


def test_a_negative_load_is_refused_by_name_value_and_unit() -> None:
    with pytest.raises(InvalidInput, match=r"^normal_load must not be negative, got -3\.0 N$"):
        require_non_negative(normal_load=-3)


def test_the_first_offender_of_an_array_is_named() -> None:
    with pytest.raises(InvalidInput, match=r"^separation must be positive, got 0\.0 m$"):
        require_positive(separation=[1e-6, 0.0, -1.0])


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_is_refused_by_every_check(value: float) -> None:
    for check in (require_finite, require_positive, require_non_negative):
        with pytest.raises(InvalidInput, match=r"frequency must be finite, got .* Hz"):
            check(frequency=[22e3, value])


@pytest.mark.parametrize("value", ["3 N", None, [[1], [1, 2]], 1j, True, object()])
def test_what_is_no_number_is_refused(value: object) -> None:
    with pytest.raises(InvalidInput, match="normal_load must be a number or an array of numbers"):
        require_positive(normal_load=value)  # type: ignore[arg-type]


@given(st.floats(0.0, 0.5), st.floats(allow_nan=False, allow_infinity=False).filter(lambda x: not 0 <= x <= 0.5))
def test_a_range_lets_pass_what_lies_inside_and_nothing_else(inside: float, outside: float) -> None:
    assert require_within(0.0, 0.5, poisson_ratio=inside) == inside
    with pytest.raises(InvalidInput, match=r"poisson_ratio must lie between 0 and 0\.5"):
        require_within(0.0, 0.5, poisson_ratio=outside)


def test_complex_amplitudes_pass_and_their_parts_are_checked() -> None:
    passed = require_finite_complex(voltage_amplitude=[1, 2j])
    assert passed.dtype == np.complex128
    assert passed.tolist() == [1, 2j]
    with pytest.raises(InvalidInput, match=r"voltage_amplitude must be finite, got inf V"):
        require_finite_complex(voltage_amplitude=[1, complex(0, np.inf)])
    with pytest.raises(InvalidInput, match=r"voltage_amplitude must be a number or an array of numbers, got '3 V'"):
        require_finite_complex(voltage_amplitude="3 V")
