"""Bodies of a rig by its file: materials, families and hardness."""

from dataclasses import replace
from pathlib import Path

from pytest import approx

from sonolube.facts.materials import material
from sonolube.prediction.bodies import named_bodies
from sonolube.rig import read_rig

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def test_bodies_are_those_of_the_file_with_their_family_and_hardness() -> None:
    softer, harder = named_bodies(read_rig(RIGS / "poisson_al_steel.toml"))
    assert (softer.name, softer.family, harder.name) == ("aluminium_2024", "aluminium", "stainless_steel_304")
    assert softer.hardness == approx(137 * 9.80665e6)  # 137 HV, D Table 2.15


def test_the_pin_comes_first_and_a_stated_hardness_counts() -> None:
    rig = read_rig(RIGS / "poisson_steel_steel.toml").replace("contact.harder.role", "pin")
    rig = rig.replace("contact.harder.material", "m50").replace("contact.harder.hardness", "700 HV")
    pin, disc = named_bodies(rig)
    assert (pin.name, disc.name) == ("m50", "stainless_steel_304")
    assert pin.hardness == approx(700 * 9.80665e6)


def test_without_a_hardness_three_times_the_yield_strength_is_taken_and_said() -> None:
    rig = read_rig(RIGS / "poisson_steel_steel.toml").replace("contact.softer.material", "bronze_c51000")
    body = named_bodies(rig.replace("contact.softer.yield_strength", "500 MPa"))[0]
    assert body.is_estimated
    assert body.hardness == approx(1.5e9)


def test_a_rig_changed_in_python_has_the_materials_of_its_fields() -> None:
    rig = read_rig(RIGS / "poisson_steel_steel.toml")
    changed = replace(rig, pin_material="m50", disc_material="alumina")
    assert [body.name for body in named_bodies(changed)] == ["m50", "alumina"]


def test_a_rig_of_combined_properties_names_no_bodies() -> None:
    assert named_bodies(read_rig(RIGS / "tribometer.toml")) == ()


def test_a_hardness_of_the_catalogue_goes_before_the_yield_strength_and_is_no_estimate() -> None:
    # 2024: 137 HV; its table states a yield strength, of which three times would be an estimate
    rig = read_rig(RIGS / "poisson_steel_steel.toml").replace("contact.softer.material", "aluminium_2024")
    softer = named_bodies(rig.replace("contact.softer.yield_strength", "300 MPa"))[0]
    assert softer.hardness == approx(137 * 9.80665e6)
    assert not softer.is_estimated


def test_without_any_property_the_catalogue_s_yield_strength_counts_and_else_nothing() -> None:
    rig = read_rig(RIGS / "poisson_steel_steel.toml")
    bronze, unknown = named_bodies(replace(rig, pin_material="bronze_c51000", disc_material="pzt4"))
    assert bronze.hardness == approx(3 * material("bronze_c51000").value("yield_strength"))
    assert bronze.is_estimated
    assert unknown.hardness is None
    assert unknown.is_estimated


def test_materials_that_the_catalogue_lacks_or_that_are_not_named_are_left_out() -> None:
    rig = read_rig(RIGS / "poisson_steel_steel.toml")
    assert [each.name for each in named_bodies(replace(rig, pin_material="unobtainium", disc_material="m50"))] == [
        "m50"
    ]
    assert [each.name for each in named_bodies(replace(rig, pin_material=None, disc_material="m50"))] == ["m50"]


def test_the_disc_comes_last_and_without_roles_the_softer_body_first() -> None:
    rig = read_rig(RIGS / "poisson_steel_steel.toml").replace("contact.harder.material", "m50")
    assert [each.name for each in named_bodies(rig)] == ["stainless_steel_304", "m50"]
    disc = rig.replace("contact.softer.role", "disc")
    assert [each.name for each in named_bodies(disc)] == ["m50", "stainless_steel_304"]
