"""Candidate tests of a rig by hand: values as typed, points, drive, heat, and limits that they exceed."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.design.test_plan.candidates import (
    MAX_CANDIDATES,
    Candidates,
    Factors,
    RigLimits,
    candidate_tests,
    factor_values,
)
from sonolube.errors import InvalidInput
from sonolube.prediction.inputs import rig_inputs
from sonolube.rig import read_rig, thermal_solid

RIG = read_rig(Path(__file__).parents[3] / "examples" / "rigs" / "power_map.toml")
INPUTS = rig_inputs(RIG)


def speeds(text: str, count: int = 5) -> list[float]:
    return list(factor_values(text, unit="m/s", option="--speed", count=count).tolist())


def test_values_are_a_list_in_one_unit_or_a_range_of_equal_ratios() -> None:
    assert speeds("20,5mm/s") == approx([0.005, 0.02])
    assert speeds("5 mm/s, 0.02 m/s, 20 mm/s") == approx([0.005, 0.02])
    assert speeds("10:1000mm/s", count=3) == approx([0.01, 0.1, 1.0])
    assert speeds("10:1000:3mm/s", count=9) == approx([0.01, 0.1, 1.0])
    assert speeds("1:2:4mm/s") == approx([0.001, 0.00126, 0.00159, 0.002])  # three digits of 2^(1/3) and 2^(2/3)
    assert speeds("1:2:2mm/s") == approx([0.001, 0.002])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1:2:x3mm/s", "the third part is a number of values, such as 20:200:7mm/s"),
        ("1:2:2.5mm/s", "the third part is a number of values"),
        ("1:2:1mm/s", "a range has 2 to 200 values"),
        ("1:2:201mm/s", "a range has 2 to 200 values"),
        ("1:2:3:4mm/s", "must look like first:last, first:last:count or one,two,..."),
        ("0:2mm/s", "the first value must be above 0 and below the last"),
        ("2:2mm/s", "the first value must be above 0 and below the last"),
        ("0,2mm/s", "values must be above 0"),
        (",".join(["1"] * 201) + "mm/s", "201 values; at most 200"),
    ],
)
def test_values_that_are_none_are_refused(text: str, message: str) -> None:
    with raises(InvalidInput) as refusal:
        speeds(text)
    assert message in str(refusal.value)
    assert str(refusal.value).startswith("--speed")


def factors(loads: list[float], speeds: list[float], amplitudes: list[float]) -> Factors:
    return Factors(
        normal_load=np.array(loads), sliding_speed=np.array(speeds), vibration_amplitude=np.array(amplitudes)
    )


def test_more_points_than_can_be_compared_are_refused() -> None:
    assert MAX_CANDIDATES == 200
    factors([1.0, 2.0], list(np.linspace(1, 2, 10)), list(np.linspace(1, 2, 10)))
    with raises(InvalidInput, match="the factors have 201 points, but at most 200 are compared; give fewer values"):
        factors([1.0], list(np.linspace(1, 2, 67)), [1.0, 2.0, 3.0])
    with raises(InvalidInput, match="sliding_speed must be positive"):
        factors([1.0], [0.0], [1.0])


def candidates(points: Factors, **options: Any) -> Candidates:
    return candidate_tests(RIG, INPUTS, points, **{"limits": RigLimits(), **options})


def test_every_combination_is_a_candidate_and_the_point_of_the_rig_the_first_where_it_is_new() -> None:
    found = candidates(factors([3.0, 6.0], [0.05], [1e-6, 2e-6]))
    own = (RIG.normal_load, INPUTS.sliding_speed, INPUTS.amplitude.value)
    rows = np.column_stack([found.normal_load, found.sliding_speed, 1e6 * found.vibration_amplitude])
    expected = [(own[0], own[1], 1e6 * own[2]), (3, 0.05, 1), (3, 0.05, 2), (6, 0.05, 1), (6, 0.05, 2)]
    assert rows == approx(np.array(expected))
    assert found.own == 0
    same = candidates(factors([own[0]], [0.05, own[1] * (1 + 5e-6)], [own[2] * (1 - 5e-6)]))
    assert (same.own, same.normal_load.size) == (1, 2)
    other = candidates(factors([own[0]], [0.05, own[1] * (1 + 3e-5)], [own[2]]))
    assert (other.own, other.normal_load.size) == (0, 3)


def test_the_drive_follows_the_amplitude_in_proportion_and_its_power_by_the_square() -> None:
    assert RIG.drive is not None
    own = INPUTS.amplitude.value
    found = candidates(factors([3.0], [0.05], [own / 2, own]))
    half, whole = found.voltage_peak_to_peak[[-2, -1]]
    assert (half, whole) == approx((INPUTS.voltage_peak_to_peak / 2, INPUTS.voltage_peak_to_peak))  # type: ignore[operator]
    assert found.voltage_offset[[-2, -1]] == approx([RIG.drive.voltage_offset / 2, RIG.drive.voltage_offset])
    assert found.charging_power[-1] == approx(4 * found.charging_power[-2])
    assert RIG.capacitance is not None or RIG.stack is not None
    unknown = candidate_tests(
        RIG, replace(INPUTS, voltage_peak_to_peak=None), factors([3.0], [0.05], [own]), limits=RigLimits()
    )
    assert np.isnan(unknown.voltage_peak_to_peak).all()
    assert np.isnan(unknown.power_to_supply).all()
    assert not unknown.voltage_offset.any()


def test_the_heat_of_friction_rises_with_load_and_is_known_with_both_materials_only() -> None:
    points = factors([2.0, 4.0], [0.05], [1e-6])
    found = candidates(points, pin="stainless_steel_316", disc="aluminium_2024").mean_temperature_rise
    assert found[2] == approx(2 * found[1])
    # slow sliding of a circle a on two bodies: mean rise q/(pi a^2) 8 a/(3 pi (k1 + k2))
    slow = factors([2.0], [1e-6], [1e-6])
    rise = candidates(slow, pin="stainless_steel_316", disc="aluminium_2024").mean_temperature_rise[-1]
    k = sum(thermal_solid(name).thermal_conductivity for name in ("stainless_steel_316", "aluminium_2024"))
    radius = np.sqrt(RIG.contact.nominal_area / np.pi)
    heat = INPUTS.friction.value * 2.0 * 1e-6
    assert rise == approx(heat * 8 / (3 * np.pi**2 * radius * k), rel=0.02)
    assert np.isnan(candidates(points).mean_temperature_rise).all()
    for one in ({"pin": "m50"}, {"disc": "m50"}):
        with raises(InvalidInput, match="the temperature rise needs both materials; give --pin and --disc, or neither"):
            candidates(points, **one)


def test_what_exceeds_a_limit_says_by_how_much() -> None:
    own = INPUTS.amplitude.value
    points = factors([3.0], [0.05], [own / 4, own])
    free = candidates(points)
    reach = np.abs(free.voltage_offset) + free.voltage_peak_to_peak / 2
    assert set(free.refused) == {""}
    at_limit = candidates(points, limits=RigLimits(voltage_maximum=float(reach[-1])))
    assert set(at_limit.refused) == {""}
    strict = candidates(points, limits=RigLimits(voltage_maximum=0.99 * float(reach[-1]), power_to_supply=1e-3))
    assert strict.refused[-1].startswith("drive reaches ")
    assert "; amplifier would supply " in strict.refused[-1]
    assert strict.refused[-1].endswith(", limit 1 mW")
    assert strict.refused[-2].startswith("amplifier would supply")
    hot = candidates(
        points, limits=RigLimits(mean_temperature_rise=1e-9), pin="stainless_steel_316", disc="aluminium_2024"
    )
    assert all(reason.startswith("contact would be hotter by ") for reason in hot.refused)
