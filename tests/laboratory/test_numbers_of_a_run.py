"""Numbers that no run has are refused by their names, wherever one of its records is made."""

from dataclasses import fields, replace
from typing import Any

import pytest
from pytest import raises

from sonolube.errors import InvalidInput
from sonolube.laboratory.heating_assumptions import HeatingAssumptions
from sonolube.laboratory.virtual_tribometer.disturbances import Disturbances

POSITIVE = {
    *("noise_time", "motor_time", "vibration_time", "thermocouple_time", "run_in_distance"),
    *("holder_stiffness", "holder_mass", "deflected_stiffness"),
}


@pytest.mark.parametrize("name", [each.name for each in fields(Disturbances) if each.name != "run_in_share"])
def test_no_disturbance_is_negative_and_times_and_stiffnesses_are_above_zero(name: str) -> None:
    usual = Disturbances()
    change: dict[str, Any] = {name: -1e-12}
    with raises(InvalidInput, match=name):
        replace(usual, **change)
    change = {name: 0}
    if name in POSITIVE:
        with raises(InvalidInput, match=f"{name} must be positive"):
            replace(usual, **change)
    else:
        assert getattr(replace(usual, **change), name) == 0


def test_shares_of_disturbances_have_their_ends() -> None:
    usual = Disturbances()
    for name in ("contact_share", "holder_damping_ratio"):
        change: dict[str, Any] = {name: 1.0}
        assert getattr(replace(usual, **change), name) == 1.0
        change = {name: 1.01}
        with raises(InvalidInput, match=f"{name} must not be above 1, got 1.01"):
            replace(usual, **change)
    assert replace(usual, run_in_share=-0.99).run_in_share == -0.99
    with raises(InvalidInput, match="run_in_share must be above -1, got -1"):
        replace(usual, run_in_share=-1.0)


def test_heat_capacities_and_conductances_are_positive_and_a_loss_may_be_none() -> None:
    for name in (
        *("pin_heat_capacity", "pin_conductance", "actuator_heat_capacity", "actuator_conductance"),
        "ambient_temperature",
    ):
        change: dict[str, Any] = {name: 0.0}
        with raises(InvalidInput, match=f"{name} must be positive"):
            HeatingAssumptions(**change)
    assert HeatingAssumptions(loss_factor=0.0).loss_factor == 0.0
    with raises(InvalidInput, match="loss_factor must not be negative"):
        HeatingAssumptions(loss_factor=-0.1)
