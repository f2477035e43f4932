"""Tabor's relation, against heat-treated steels and metals of the catalogue."""

import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.facts.materials import material, yield_strength_from_hardness


def test_three_hundred_vickers_is_a_yield_strength_near_a_gigapascal() -> None:
    # 300 kgf/mm2 over 3, the rule of thumb of workshops.
    assert yield_strength_from_hardness(hardness=300 * 9.80665e6).yield_strength == approx(980.665e6)


@pytest.mark.parametrize("vickers", [160.0, 300.0, 500.0, 600.0])
def test_the_range_holds_the_regression_over_150_steels(vickers: float) -> None:
    # Pavlina and Van Tyne 2008: Y = -90.7 + 2.876 HV, in MPa.
    estimate = yield_strength_from_hardness(hardness=vickers * 9.80665e6)
    assert estimate.low < (-90.7 + 2.876 * vickers) * 1e6 < estimate.high


@pytest.mark.parametrize(
    "name", ["steel_1020", "steel_4340", "brass_c36000", "bronze_c93200", "aluminium_6061", "titanium_6al4v"]
)
def test_the_range_holds_the_printed_yield_strength_of_metals(name: str) -> None:
    estimate = yield_strength_from_hardness(hardness=material(name).value("hardness"))
    assert estimate.low <= material(name).value("yield_strength") <= estimate.high
    assert estimate.low < estimate.yield_strength < estimate.high
    assert "Tabor" in estimate.source
    assert "\n" not in estimate.reason


def test_a_hardness_that_is_not_positive_is_refused() -> None:
    with raises(InvalidInput, match="hardness must be positive"):
        yield_strength_from_hardness(hardness=0.0)
