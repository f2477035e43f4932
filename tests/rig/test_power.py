"""Power to supply: closed forms of its parts, the larger-of rule, and what rigs of examples need."""

from math import nan, pi
from pathlib import Path

import numpy as np
from hypothesis import given, strategies as st
from pytest import approx, mark

from sonolube.rig import friction_point, larger_power, operating_points, power_to_supply, read_rig, simulate
from sonolube.rig.power import apparent_power, with_former_key

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
watts = st.floats(1e-6, 1e6)


@given(charge=watts, heat=watts)
def test_the_larger_part_is_supplied(charge: float, heat: float) -> None:
    found = power_to_supply(charging_power=charge, dissipated_power=heat)
    assert found is not None
    assert found.power_to_supply == max(charge, heat)
    assert not found.is_at_least
    assert ("must supply the larger" in found.energy_balance) == (heat > charge)


@mark.parametrize("unknown", [None, nan])
def test_one_part_alone_is_a_lower_bound_and_none_is_no_power(unknown: float | None) -> None:
    charged = power_to_supply(charging_power=6.21, dissipated_power=unknown)
    assert charged is not None
    assert (charged.text, charged.dissipated_power) == ("at least 6.21 W", None)
    assert "no structure with losses gives" in charged.energy_balance
    heated = power_to_supply(charging_power=unknown, dissipated_power=43.9)
    assert heated is not None
    assert (heated.text, heated.charging_power) == ("at least 43.9 W", None)
    assert "give actuator.capacitance" in heated.energy_balance
    assert power_to_supply(charging_power=unknown, dissipated_power=unknown) is None


def test_arrays_follow_the_same_rule() -> None:
    found = larger_power(charging_power=[1.0, 3.0, 1.0, nan, nan], dissipated_power=[2.0, 2.0, nan, 2.0, nan])
    assert found.tolist() == approx([2.0, 3.0, 1.0, 2.0, nan], nan_ok=True)


def test_the_apparent_power_of_a_sine_is_half_the_product_of_the_amplitudes() -> None:
    # 14 V and 3 A, zero to peak, whatever their phase; and two harmonics add by their squares
    assert apparent_power(voltage_harmonics=np.array([14.0]), current_harmonics=np.array([3j])) == approx(21.0)
    both = apparent_power(voltage_harmonics=np.array([3.0, 4j]), current_harmonics=np.array([1.0 + 0j, 0.0]))
    assert both == approx(0.5 * 5.0 * 1.0)


def test_the_reference_rig_supplies_the_heat_of_its_motion_of_which_d_1_9_charges_a_seventh() -> None:
    rig = read_rig(RIGS / "tribometer.toml")
    power = friction_point(rig).power
    assert power is not None
    assert power.charging_power == approx(360e-9 * 28.0 * 28.0 * 22e3)  # D 1.9, 6.21 W
    assert power.text == "43.9 W"
    assert power.power_to_supply == approx(simulate(rig).vibration.dissipated_power, rel=1e-12)
    # at least the heat of the tip's damper, c w^2 a^2/2, and less than the product of rms voltage and current
    tip = 702 * (2 * pi * 22e3 * 2.5e-6) ** 2 / 2
    assert tip < power.power_to_supply < (power.apparent_power or 0.0)
    assert power.apparent_power == approx(0.5 * 14.0 * (power.peak_current or 0.0), rel=1e-9)  # of a sine


def test_a_rig_without_known_losses_needs_its_charge_at_least() -> None:
    rig = read_rig(RIGS / "collar.toml")
    power = friction_point(rig).power
    assert power is not None
    assert power.is_at_least
    assert power.power_to_supply == power.charging_power
    assert (power.apparent_power, power.peak_current) == (None, None)
    points = operating_points(rig, voltage_peak_to_peak=[14.0, 28.0])
    assert points.power_to_supply == approx(points.charging_power, rel=1e-12)
    assert np.isnan(points.dissipated_power).all()


def test_a_rig_without_a_capacitance_has_no_power() -> None:
    assert friction_point(read_rig(RIGS / "welder_flat.toml")).power is None


def test_the_charging_power_keeps_its_former_key_in_json() -> None:
    assert with_former_key({"charging_power": 6.21, "friction_ratio": 0.35}) == {
        "charging_power": 6.21, "friction_ratio": 0.35, "actuator_power": 6.21,
    }  # fmt: skip
    assert with_former_key({"friction_ratio": 0.35}) == {"friction_ratio": 0.35}
