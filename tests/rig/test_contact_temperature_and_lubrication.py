"""Heat and lubrication of a rig from its file."""

from pathlib import Path

import numpy as np
from pytest import approx, raises

from sonolube.errors import InvalidInput, MissingProperty
from sonolube.facts.materials import material
from sonolube.models.friction import BoundaryLubricant
from sonolube.rig import (
    Rig,
    TemperaturePoint,
    lubrication_map,
    lubrication_point,
    read_rig,
    temperature_point,
    thermal_solid,
    wear_of_materials,
)

RIG = Path(__file__).parents[2] / "examples" / "rigs" / "tribometer.toml"
LUBRICANT = BoundaryLubricant(film_coefficient=0.25, full_asperity_pressure=10e6)


def heat_of(rig: Rig, *, vibration_heat_rate: float | list[float] = 0.0, **stated: float) -> TemperaturePoint:
    return temperature_point(
        rig,
        pin=thermal_solid("stainless_steel_316"),
        disc=thermal_solid("aluminium_2024"),
        heat_capacity=1.5,
        thermal_conductance=0.05,
        duration=50.0,
        vibration_heat_rate=vibration_heat_rate,
        **stated,  # type: ignore[arg-type]
    )


def test_without_heat_of_vibration_a_rig_cools_as_much_as_its_friction_falls() -> None:
    found = heat_of(read_rig(RIG))
    assert found.temperature_rise_ratio == approx(found.friction_ratio)
    assert found.frictional_heat_rate == approx(found.friction_ratio * 0.341 * 3 * 0.0203)


def test_heat_of_vibration_comes_on_top() -> None:
    rig = read_rig(RIG)
    without, with_heat = (heat_of(rig, vibration_heat_rate=q) for q in (0.0, 0.02))
    assert with_heat.temperature_rise / without.temperature_rise == approx(1 + 0.02 / without.frictional_heat_rate)
    assert len(without.caveats) == len(with_heat.caveats) + 1


def test_a_part_without_vibration_and_heats_one_after_another_superpose() -> None:
    # the bulk is linear in the heat: 1.5 J/K that lose 0.05 W/K have a time constant of 30 s
    dry, first, second = 0.5, 0.6, 0.9  # of the heat of friction without vibration, in steps of 10, 20 and 20 s
    without = 0.341 * 3 * 0.0203
    levels = [(share - dry) * without for share in (first, second)]
    found = heat_of(read_rig(RIG), friction_ratio=dry, dry_duration=10.0, vibration_heat_rate=levels)
    decay = np.exp(-np.array([50.0, 40.0, 20.0]) / 30.0)
    weights = np.array([1.0, first - 1.0, second - first])
    expected = float(weights @ (1 - decay)) / (1 - decay[0])
    assert found.with_vibration.bulk_rise[-1] / found.without_vibration.bulk_rise[-1] == approx(expected)
    assert (found.friction_ratio, found.friction_model) == (dry, "stated")


def test_a_test_that_is_dry_to_its_end_is_refused() -> None:
    with raises(InvalidInput, match=r"dry_duration must lie from 0 to below the 50 s of the test, got 50\.0 s"):
        heat_of(read_rig(RIG), dry_duration=50.0)


def test_a_stated_ratio_that_is_no_number_is_refused() -> None:
    with raises(InvalidInput, match="friction_ratio"):
        heat_of(read_rig(RIG), friction_ratio=float("nan"))


def test_a_rig_at_rest_has_no_heat_of_friction() -> None:
    with raises(InvalidInput, match=r"sliding\.sliding_speed must be positive"):
        heat_of(read_rig(RIG, changes=["sliding.sliding_speed=0m/s"]))


def test_the_map_holds_the_best_of_the_point_in_its_middle() -> None:
    rig = read_rig(RIG)
    about = lubrication_map(rig, lubricant=LUBRICANT)
    middle = about.best.shape[0] // 2, about.best.shape[1] // 2
    assert about.sliding_speed[middle[1]] == approx(rig.sliding_speed)
    assert about.best[middle] == lubrication_point(rig, lubricant=LUBRICANT).best == "ultrasonic"


def test_a_material_without_a_structure_is_refused_by_name() -> None:
    with raises(MissingProperty, match="stainless_steel_304 has no crystal_structure"):
        wear_of_materials(material("stainless_steel_304"), material("m50"))


def test_a_material_without_thermal_properties_is_refused() -> None:
    with raises(MissingProperty, match="no thermal_conductivity"):
        thermal_solid("uncoated_steel")


def test_the_coating_of_d_4_1_says_that_its_thermal_properties_are_assumed() -> None:
    found = material("powder_coating")
    for name in ("thermal_conductivity", "density", "specific_heat_capacity"):
        assert "assumed" in found.property(name).source
