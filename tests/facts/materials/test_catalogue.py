"""Catalogue of materials: sourced properties in vocabulary units, aliases and refusals by name."""

import math
import subprocess
import sys

import pytest
from pytest import approx, raises

from sonolube.errors import MissingProperty, UnknownName
from sonolube.facts.materials import material, material_names, piezo_ceramic
from sonolube.models.contact.elastic_bodies import ElasticBody, contact_pair
from sonolube.vocabulary import quantity

every_material = pytest.mark.parametrize("name", material_names())


@every_material
def test_every_property_has_a_source_and_a_finite_value(name: str) -> None:
    record = material(name)
    assert record.title
    assert record.properties
    for sourced in record.properties.values():
        assert math.isfinite(sourced.value)
        assert len(sourced.source) > 10


@every_material
def test_every_property_is_a_word_of_the_vocabulary_in_its_unit(name: str) -> None:
    for property_name, sourced in material(name).properties.items():
        assert sourced.unit == quantity(property_name).unit


@pytest.mark.parametrize(
    ("name", "vickers"),
    [
        ("aluminium_2024", 137),
        ("stainless_steel_303", 262),
        ("stainless_steel_316", 217),
        ("titanium_6al4v", 349),
        ("m50", 960),
        ("alumina", 1601),
        ("uncoated_steel", 274),
        ("powder_coating", 39),
    ],
)
def test_hardness_is_the_dissertations_vickers_number_times_the_weight_of_a_kilogram_per_square_millimetre(
    name: str, vickers: float
) -> None:
    assert material(name).value("hardness") == approx(vickers * 9.80665e6, rel=1e-12)
    assert "(D)" in material(name).property("hardness").source


def test_aluminium_on_stainless_steel_has_the_dissertations_combined_modulus() -> None:
    # D Table 3.2: 59.6 GPa.
    aluminium, steel = (
        ElasticBody(
            youngs_modulus=material(name).value("youngs_modulus"), poisson_ratio=material(name).value("poisson_ratio")
        )
        for name in ("al2024", "ss316")
    )
    pair = contact_pair(
        softer=aluminium, harder=steel, yield_strength=material("aluminium_2024").value("yield_strength")
    )
    assert pair.effective_modulus == approx(59.57e9, rel=1e-4)
    assert pair.yield_strength == 410e6


def test_the_conflicting_hardnesses_of_the_dissertation_are_noted() -> None:
    assert "45-50" in material("aluminium_2024").property("hardness").note
    assert "700-950" in material("stainless_steel_316").property("hardness").note


def test_the_plates_of_the_dissertation_are_coated_sixty_micrometres_thick() -> None:
    assert material("powder_coating").value("thickness") == approx(0.00235 * 25.4e-3)


def test_metals_are_stiffer_than_they_are_hard_and_harder_than_they_are_strong() -> None:
    for name in (
        "aluminium_2024",
        "stainless_steel_303",
        "stainless_steel_304",
        "stainless_steel_316",
        "titanium_6al4v",
    ):
        value = material(name).value
        assert value("youngs_modulus") > value("hardness") > value("ultimate_strength") > value("yield_strength")


def test_only_titanium_is_hexagonal() -> None:
    structures = {name: material(name).crystal_structure for name in material_names()}
    hexagonal = [name for name, structure in structures.items() if structure and "hexagonal" in structure.text]
    assert hexagonal == ["titanium_6al4v"]


def test_a_property_without_a_source_is_missing_by_name() -> None:
    line = r"^powder_coating has no youngs_modulus: no source is known; give it in the rig file$"
    with raises(MissingProperty, match=line):
        material("powder_coating").value("youngs_modulus")


def test_a_misspelt_property_is_refused_with_the_closest_name() -> None:
    with raises(UnknownName, match=r"unknown quantity 'youngs_modulos'; did you mean youngs_modulus\?"):
        material("m50").value("youngs_modulos")


def test_an_alias_names_the_same_record() -> None:
    assert material("ss316") is material("stainless_steel_316")
    assert material("ti6al4v") is material("titanium_6al4v")
    assert material("al2024") is material("aluminium_2024")


def test_an_unknown_material_is_refused_with_the_closest_name() -> None:
    with raises(UnknownName, match=r"unknown material 'stainles_steel_316'; did you mean stainless_steel_316\?"):
        material("stainles_steel_316")
    with raises(UnknownName, match=r"unknown piezoelectric ceramic 'pzt4x'; did you mean pzt4\?"):
        piezo_ceramic("pzt4x")


def test_records_and_arrays_cannot_be_changed() -> None:
    with raises(TypeError):
        material("m50").properties["density"] = material("m50").property("hardness")  # type: ignore[index]
    with raises(ValueError, match="read-only"):
        piezo_ceramic("pzt4").stiffness_short_circuit[0, 0] = 1.0


def test_importing_materials_loads_neither_scipy_nor_pint() -> None:
    code = "import sys, sonolube.facts.materials; sys.exit(any(name in sys.modules for name in ('scipy', 'pint')))"
    subprocess.run([sys.executable, "-c", code], check=True)
