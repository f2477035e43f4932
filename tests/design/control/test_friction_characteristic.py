"""Static characteristic of the plant: inverse, refusals, and the models that it is computed by."""

from pathlib import Path

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, raises

from sonolube.design.control import (
    FrictionCharacteristic,
    computed_characteristic,
    efficiency_characteristic,
    friction_at_level,
    level_for_friction,
)
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.facts.metrics import EfficiencyLine, efficiency_coefficient
from sonolube.rig import friction_point, read_rig
from sonolube.rig.driven_rig import DriveVoltage, driven_rig

RIGS = Path(__file__).parents[3] / "examples" / "rigs"
TRIBOMETER, COLLAR = driven_rig(read_rig(RIGS / "tribometer.toml")), read_rig(RIGS / "collar.toml")
LINE = FrictionCharacteristic(level=np.array([0.0, 50.0]), friction_force=np.array([2.0, 0.5]))


@given(force=st.floats(0.5, 2.0))
def test_the_inverse_of_a_characteristic_restores_the_force(force: float) -> None:
    volts = level_for_friction(LINE, friction_force=force)
    assert friction_at_level(LINE, level=volts) == approx(force)


def test_friction_out_of_reach_is_refused_with_the_attainable_range() -> None:
    with raises(OutsideRange, match=r"between 0\.5 N, at 50 V, and 2 N without vibration, got 0\.1 N"):
        level_for_friction(LINE, friction_force=0.1)


def test_a_characteristic_whose_forces_do_not_decrease_is_refused() -> None:
    with raises(InvalidInput, match="voltages must increase and forces decrease"):
        FrictionCharacteristic(level=np.array([0.0, 1.0]), friction_force=np.array([1.0, 1.0]))


def test_without_a_structure_the_characteristic_passes_through_the_rigs_operating_point() -> None:
    characteristic = computed_characteristic(COLLAR, level_maximum=56.0, points=3)
    force = friction_point(COLLAR).friction_force
    assert characteristic.level[1] == 28.0
    assert characteristic.friction_force[1] == approx(force)
    assert characteristic.highest_force == approx(0.26 * 6.7)


def test_a_characteristic_ends_where_the_vibration_begins_to_drive_the_slider() -> None:
    rig = read_rig(RIGS / "tribometer.toml", changes=["friction.in_plane_fraction=0.5"])
    assert friction_point(rig).friction_force < 0  # at 28 V
    characteristic = computed_characteristic(rig, level_maximum=28.0, points=15)
    assert 0 <= characteristic.lowest_force < 0.2 * characteristic.highest_force
    assert characteristic.level[-1] < 28.0


def test_every_point_of_an_efficiency_characteristic_has_the_efficiency_of_the_line() -> None:
    line = EfficiencyLine(slope=0.0, intercept=2e-9)
    characteristic = efficiency_characteristic(TRIBOMETER, line, voltage_maximum=20.0, points=5)
    volts = characteristic.level[1:]
    power = DriveVoltage(drive=TRIBOMETER.drive).charging_power(
        capacitance=360e-9, voltage_peak_to_peak=volts, voltage_offset=0.5 * volts
    )
    found = efficiency_coefficient(
        intrinsic_friction_force=characteristic.highest_force,
        reduced_friction_force=characteristic.friction_force[1:],
        sliding_speed=0.0203,
        nominal_area=2.25e-6,
        normal_load=3.0,
        actuator_power=power,
    )
    assert found == approx(2e-9)
