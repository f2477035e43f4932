"""Ranges of an exported plant by hand, and the variable that takes the place of the speed in its tables."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.design.fmu.chebyshev import ChebyshevTable
from sonolube.design.fmu.plant import PlantTables, plant_ranges, reduced_speed, speed_over_scale
from sonolube.design.fmu.tabulation import _tables
from sonolube.errors import InvalidInput
from sonolube.rig import VOLTAGE, read_rig
from sonolube.rig.resolved_rig import resolved_rig

RIGS = "examples/rigs"
COLLAR = read_rig(f"{RIGS}/collar.toml")  # 28 V at 25 kHz, a sine of its amplitude per volt
DRIVEN = replace(read_rig(f"{RIGS}/tribometer.toml"), amplitude_source="computed")


def test_ranges_lie_about_the_point_of_the_rig() -> None:
    # 0.5 % of the frequency, a factor of 1.25 of the load and of 2 of the speed to either side
    found = plant_ranges(DRIVEN)
    assert found.level == (0.0, 28.0)
    assert found.frequency == approx((21_890.0, 22_110.0))
    assert found.normal_load == approx((2.4, 3.75))
    assert found.sliding_speed == approx((0.01015, 0.0406))
    assert found.ends == (found.level, found.frequency, found.normal_load)


def test_a_sine_holds_at_its_own_frequency() -> None:
    found = plant_ranges(COLLAR)
    assert found.frequency == (25e3, 25e3)
    with raises(InvalidInput, match="the amplitude per-volt holds at 25 kHz only; choose the amplitude computed for a"):
        plant_ranges(COLLAR, over={"drive.frequency": (24e3, 26e3)})


def test_given_ranges_take_their_places() -> None:
    over = {
        "drive.voltage_peak_to_peak": (0.0, 20.0),
        "drive.frequency": (21e3, 23e3),
        "contact.normal_load": (1.0, 4.0),
        "sliding.sliding_speed": (0.01, 0.02),
    }
    found = plant_ranges(DRIVEN, over=over)
    assert (found.level, *found.ends[1:], found.sliding_speed) == tuple(over.values())


@pytest.mark.parametrize(
    ("over", "message"),
    [
        ({"contact.nominal_area": (1.0, 2.0)}, "contact.nominal_area: no input of the plant; choose the ranges of"),
        ({"contact.normal_load": (2.0, 2.0)}, "contact.normal_load: needs a range from above 0 that rises, got 2 to 2"),
        ({"contact.normal_load": (0.0, 2.0)}, "needs a range from above 0 that rises, got 0 to 2"),
        ({"drive.voltage_peak_to_peak": (-1.0, 2.0)}, "needs a range from above 0 that rises, got -1 to 2"),
        ({"sliding.sliding_speed": (1.0, np.inf)}, "needs a range from above 0 that rises, got 1 to inf"),
    ],
)
def test_a_range_that_is_none_is_refused(over: dict[str, tuple[float, float]], message: str) -> None:
    with raises(InvalidInput) as refusal:
        plant_ranges(DRIVEN, over=over)
    assert message in str(refusal.value)


def test_a_rig_without_a_point_is_refused_by_what_is_missing() -> None:
    with raises(InvalidInput, match=r"sliding\.sliding_speed must be above 0 for a plant about the rig's own point"):
        plant_ranges(replace(COLLAR, sliding_speed=0.0))
    with raises(InvalidInput, match=r"drive\.voltage_peak_to_peak must be above 0"):
        plant_ranges(read_rig(f"{RIGS}/collar.toml", changes=["drive.voltage_peak_to_peak=0V"]))
    amplitude = read_rig(f"{RIGS}/cutter_head.toml", changes=["friction.model=dong_2015_half_period"])
    with raises(InvalidInput, match=r"drive\.frequency must be above 0"):
        plant_ranges(replace(amplitude, drive=None))


def test_the_speed_of_the_tables_is_a_fourth_root_below_the_threshold_and_a_ratio_without_one() -> None:
    assert reduced_speed(np.array([0.0016, 0.81, 1.0, 50.0]), True) == approx([0.2, 0.9486833, 1.0, 1.0])
    assert reduced_speed(np.array([0.0, 1.0, 3.0]), False) == approx([0.0, np.sqrt(0.5), np.sqrt(0.75)])
    assert speed_over_scale(np.array([0.2, 0.5]), True) == approx([0.0016, 0.0625])
    assert speed_over_scale(np.sqrt(np.array([0.5, 0.75])), False) == approx([1.0, 3.0])


def constant(value: float, count: int) -> ChebyshevTable:
    return ChebyshevTable(ends=((0.0, 1.0),) * count, coefficients=np.full((1,) * count, value))


def tables(**changes: Any) -> PlantTables:
    """Velocity of 0.02 m/s a volt, threshold of 3 times it, ratio 0.2 + 0.6 s below and 0.9 above."""
    slow = ChebyshevTable(ends=((0.0, 1.0),) * 4, coefficients=np.array([0.5, 0.3]).reshape(1, 1, 1, 2))
    known = {
        "rig": COLLAR,
        "quantity": VOLTAGE,
        "ranges": plant_ranges(COLLAR),
        "amplitude_per_level": constant(4e-8, 3),
        "velocity_per_level": constant(0.02, 3),
        "threshold": constant(3.0, 1),
        "has_threshold": True,
        "slow_ratio": slow,
        "fast_ratio": constant(0.9, 3),
        "resonance": {"motional_conductance": constant(0.0, 1)},
        "heat": None,
        "heat_partition": None,
        "flash_rise_per_heat": None,
    }
    return PlantTables(**{**known, **changes})


def test_friction_by_tables_is_slow_below_the_threshold_and_fast_above() -> None:
    level, one = np.array([10.0, 10.0, 10.0]), np.ones(3)
    # threshold at 0.6 m/s for 10 V: 0.0375 is its 16th part, whose fourth root is 0.5
    found = tables().friction_ratio(level, one, one, np.array([0.0375, 0.59999, 0.60001]))
    assert found == approx([0.2 + 0.6 * 0.5, 0.8, 0.9], abs=1e-4)
    endless = tables(has_threshold=False).friction_ratio(level, one, one, np.array([0.0, 0.6, 1.8]))
    assert endless == approx([0.2, 0.2 + 0.6 * np.sqrt(0.5), 0.2 + 0.6 * np.sqrt(0.75)])
    still = tables().friction_ratio(np.zeros(1), np.ones(1), np.ones(1), np.array([0.1]))
    assert still == approx([0.9])  # without vibration every speed is fast
    assert tables().vibration_amplitude(level, one, one) == approx([4e-7] * 3)


def test_a_resonance_takes_a_current_where_its_conductance_is_known() -> None:
    assert not tables().has_current
    assert tables(resonance={"motional_conductance": constant(0.2, 1)}).has_current


class Steady:
    """Operating points whose amplitude follows the voltage above some load, and is that of 28 V below it."""

    def __init__(self, follows_above: float) -> None:
        self.follows_above, self.ranges, self.resolved = follows_above, plant_ranges(DRIVEN), resolved_rig(DRIVEN)

    def __call__(self, level: Any, frequency: Any, load: Any, speed: Any) -> Any:
        level, _, load, speed = np.broadcast_arrays(level, frequency, load, speed)
        amplitude = 1e-7 * np.where(load > self.follows_above, level, 28.0)
        return SimpleNamespace(
            vibration_amplitude=amplitude, vibration_velocity=1e5 * amplitude, amplitude_source="measured",
            friction_ratio=np.full(level.shape, 0.5),
        )  # fmt: skip


def test_tables_have_the_amplitude_per_volt_and_are_refused_where_it_is_not_that_at_some_load_alone() -> None:
    constant = ChebyshevTable(ends=((2.4, 3.75),), coefficients=np.ones(1))
    follows: Any = Steady(0.0)
    tables = _tables(follows, constant, False, (3, 2, 3, 2))
    assert float(tables.amplitude_per_level(14.0, 22e3, 3.0)) == approx(1e-7)
    assert float(tables.velocity_per_level(14.0, 22e3, 3.0)) == approx(1e-2)
    for follows_above in (3.0, 10.0):
        stuck: Any = Steady(follows_above)
        with raises(
            InvalidInput, match="the amplitude measured does not follow the voltage; choose the amplitude comp"
        ):
            _tables(stuck, constant, False, (3, 2, 3, 2))
