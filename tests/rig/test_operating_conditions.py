"""Quantity that sets the vibration of a rig, its own level, and conditions of points that are refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.rig import AMPLITUDE, VOLTAGE, Rig, commanded_quantity, level_settings, operating_points, read_rig
from sonolube.rig.operating_conditions import own_level, quantity_of_axis, require_commanded

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


@pytest.fixture(scope="module")
def tribometer() -> Rig:
    """28 V peak to peak about 14 V at 22 kHz."""
    return read_rig(RIGS / "tribometer.toml")


@pytest.fixture(scope="module")
def bush() -> Rig:
    """Sine of 2 um at 20 kHz without a voltage."""
    return read_rig(RIGS / "bronze_bush.toml")


def test_a_voltage_sets_the_vibration_where_a_rig_has_one_and_else_an_amplitude(tribometer: Rig, bush: Rig) -> None:
    assert commanded_quantity(tribometer) is VOLTAGE
    assert commanded_quantity(bush) is AMPLITUDE
    assert commanded_quantity(replace(bush, drive=None)) is AMPLITUDE
    assert own_level(tribometer) == approx(28.0)
    assert own_level(bush) == approx(2e-6)
    assert tribometer.drive is not None
    still = replace(tribometer, drive=replace(tribometer.drive, voltage_peak_to_peak=0.0, voltage_offset=0.0))
    assert own_level(still) == 0.0
    assert quantity_of_axis({"vibration_amplitude", "sliding_speed"}) is AMPLITUDE
    assert quantity_of_axis({"voltage_peak_to_peak", "sliding_speed"}) is VOLTAGE


def test_levels_carry_the_offset_in_the_ratio_of_the_drive(tribometer: Rig, bush: Rig) -> None:
    found = level_settings(tribometer, [0.0, 10.0, 40.0])
    assert set(found) == {"voltage_peak_to_peak", "voltage_offset"}
    assert found["voltage_peak_to_peak"] == approx([0.0, 10.0, 40.0])
    assert found["voltage_offset"] == approx([0.0, 5.0, 20.0])
    assert tribometer.drive is not None
    biased = replace(tribometer, drive=replace(tribometer.drive, voltage_peak_to_peak=0.0, voltage_offset=14.0))
    assert level_settings(biased, [10.0, 20.0])["voltage_offset"] == approx([14.0, 14.0])
    assert {name: value.tolist() for name, value in level_settings(bush, [1e-6]).items()} == {
        "vibration_amplitude": [approx(1e-6)]
    }
    with raises(InvalidInput, match="voltage_peak_to_peak must not be negative"):
        level_settings(tribometer, -1.0)


def test_another_quantity_than_that_of_the_rig_is_refused(tribometer: Rig, bush: Rig) -> None:
    require_commanded(tribometer, VOLTAGE)
    require_commanded(bush, AMPLITUDE)
    with raises(InvalidInput, match=r"its voltage sets its amplitude; vary drive\.voltage_peak_to_peak instead"):
        require_commanded(tribometer, AMPLITUDE)
    with raises(InvalidInput, match=r"drive\.voltage_peak_to_peak"):
        require_commanded(bush, VOLTAGE)
    with raises(InvalidInput, match=r"its voltage sets its amplitude; vary drive\.voltage_peak_to_peak instead"):
        operating_points(tribometer, vibration_amplitude=1e-6)
    for setting in ({"voltage_peak_to_peak": 1.0}, {"voltage_offset": 1.0}):
        with raises(InvalidInput, match=r"drive\.voltage_peak_to_peak is missing; give it to vary the voltage"):
            operating_points(bush, **setting)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("setting", "message"),
    [({"frequency": 0.0}, "frequency must be positive"), ({"normal_load": 0.0}, "normal_load must be positive"),
     ({"sliding_speed": -1e-3}, "sliding_speed must not be negative"),
     ({"voltage_peak_to_peak": -1.0}, "voltage_peak_to_peak must not be negative"),
     ({"voltage_offset": np.nan}, "voltage_offset must be finite")],
)  # fmt: skip
def test_conditions_that_are_none_are_refused_by_their_names(
    tribometer: Rig, setting: dict[str, float], message: str
) -> None:
    with raises(InvalidInput, match=message):
        operating_points(tribometer, **setting)  # type: ignore[arg-type]


def test_conditions_that_are_not_given_are_those_of_the_rig(tribometer: Rig) -> None:
    assert tribometer.drive is not None
    own = operating_points(tribometer)
    given = operating_points(
        tribometer,
        voltage_peak_to_peak=28.0,
        voltage_offset=tribometer.drive.voltage_offset,
        frequency=22e3,
        normal_load=tribometer.normal_load,
        sliding_speed=tribometer.sliding_speed,
    )
    assert float(own.friction_ratio) == approx(float(given.friction_ratio), rel=1e-12)
    assert operating_points(
        tribometer, voltage_peak_to_peak=[[1.0], [2.0]], sliding_speed=[1e-3, 2e-3, 3e-3]
    ).friction_ratio.shape == (2, 3)
