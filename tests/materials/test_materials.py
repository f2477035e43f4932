"""Records of materials: sourced, in the vocabulary's units, and honest where nothing is known."""

import math
import subprocess
import sys

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.contact import ElasticBody, contact_pair
from sonolube.errors import InvalidInput, MissingProperty, UnknownName
from sonolube.materials import (
    PiezoCeramic,
    coupling_factors,
    material,
    material_names,
    piezo_ceramic,
    piezo_ceramic_from_strain_charge,
    piezo_ceramic_from_stress_charge,
    piezo_ceramic_names,
)
from sonolube.vocabulary import quantity

every_material = pytest.mark.parametrize("name", material_names())
every_ceramic = pytest.mark.parametrize("name", piezo_ceramic_names())


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


def test_the_two_hardnesses_the_dissertation_gives_each_metal_are_told() -> None:
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


def test_titanium_alone_of_the_metals_is_hexagonal() -> None:
    structures = {name: material(name).crystal_structure for name in material_names()}
    hexagonal = [name for name, structure in structures.items() if structure and "hexagonal" in structure.text]
    assert hexagonal == ["titanium_6al4v"]


def test_a_property_without_a_source_is_missing_by_name() -> None:
    line = r"^powder_coating has no youngs_modulus: no source is known; give it in the rig file$"
    with raises(MissingProperty, match=line):
        material("powder_coating").value("youngs_modulus")


def test_a_misspelt_property_is_answered_with_the_nearest_word() -> None:
    with raises(UnknownName, match=r"unknown quantity 'youngs_modulos'; did you mean youngs_modulus\?"):
        material("m50").value("youngs_modulos")


def test_an_alias_names_the_same_record() -> None:
    assert material("ss316") is material("stainless_steel_316")
    assert material("ti6al4v") is material("titanium_6al4v")
    assert material("al2024") is material("aluminium_2024")


def test_an_unknown_material_is_answered_with_the_nearest_name() -> None:
    with raises(UnknownName, match=r"unknown material 'stainles_steel_316'; did you mean stainless_steel_316\?"):
        material("stainles_steel_316")
    with raises(UnknownName, match=r"unknown piezoelectric ceramic 'pzt4x'; did you mean pzt4\?"):
        piezo_ceramic("pzt4x")


def test_a_metal_is_no_piezoelectric_ceramic() -> None:
    with raises(UnknownName, match="unknown piezoelectric ceramic 'm50'"):
        piezo_ceramic("m50")


def test_a_ceramic_without_a_complete_set_says_what_is_missing_and_keeps_its_scalars() -> None:
    with raises(MissingProperty, match="pic151 has no complete set of constants: its maker prints no s12, s13, s44"):
        piezo_ceramic("pic151")
    assert material("pic151").value("charge_constant_33") == 500e-12


def test_records_and_arrays_cannot_be_changed() -> None:
    with raises(TypeError):
        material("m50").properties["density"] = material("m50").property("hardness")  # type: ignore[index]
    with raises(ValueError, match="read-only"):
        piezo_ceramic("pzt4").stiffness_short_circuit[0, 0] = 1.0


def test_importing_materials_loads_neither_scipy_nor_pint() -> None:
    code = "import sys, sonolube.materials; sys.exit(any(name in sys.modules for name in ('scipy', 'pint')))"
    subprocess.run([sys.executable, "-c", code], check=True)


@every_ceramic
def test_a_ceramic_looks_the_same_turned_about_its_poling(name: str) -> None:
    # Class 6mm: every rotation about axis 3 leaves the tensors unchanged.
    ceramic = piezo_ceramic(name)
    turn = strain_rotation_about_3(0.7)
    turn_vector = np.array([[np.cos(0.7), np.sin(0.7), 0], [-np.sin(0.7), np.cos(0.7), 0], [0, 0, 1]])
    c, e = ceramic.stiffness_short_circuit, ceramic.stress_constants
    assert turn.T @ c @ turn == approx(c, rel=1e-12, abs=1e-3)
    assert turn_vector.T @ e @ turn == approx(e, rel=1e-12, abs=1e-12)


@every_ceramic
def test_the_two_forms_of_the_constants_say_the_same(name: str) -> None:
    # IEEE Std 176: c s = 1, e = d c, eps^T - eps^S = d e^T.
    ceramic = piezo_ceramic(name)
    c, s = ceramic.stiffness_short_circuit, ceramic.compliance_short_circuit
    d, e = ceramic.charge_constants, ceramic.stress_constants
    assert c @ s == approx(np.eye(6), abs=1e-12)
    assert e @ s == approx(d, rel=1e-9, abs=1e-24)
    assert np.diag(ceramic.permittivity_free - ceramic.permittivity_clamped) == approx(d @ e.T, rel=1e-9, abs=1e-20)


@every_ceramic
def test_any_strain_and_field_store_positive_energy(name: str) -> None:
    ceramic = piezo_ceramic(name)
    assert np.linalg.eigvalsh(ceramic.stiffness_short_circuit).min() > 0
    assert np.all(ceramic.permittivity_clamped > 0)
    assert np.all(ceramic.permittivity_free > ceramic.permittivity_clamped)


@every_ceramic
def test_a_ceramic_grows_along_a_field_along_its_poling_and_shrinks_across(name: str) -> None:
    strain = piezo_ceramic(name).charge_constants.T @ np.array([0.0, 0.0, 1e6])
    assert strain[2] > 0 > strain[0]
    assert strain[0] == approx(strain[1])


@every_ceramic
def test_stiffening_by_an_open_circuit_gives_the_thickness_coupling(name: str) -> None:
    # k_t^2 = 1 - c33^E/c33^D with c^D = c^E + e^T (eps^S)^-1 e.
    ceramic = piezo_ceramic(name)
    e = ceramic.stress_constants
    open_circuit = ceramic.stiffness_short_circuit + e.T @ np.diag(1 / ceramic.permittivity_clamped) @ e
    squared = 1 - ceramic.stiffness_short_circuit[2, 2] / open_circuit[2, 2]
    assert coupling_factors(ceramic)["coupling_factor_thickness"] ** 2 == approx(squared)


def test_either_form_returns_the_ceramic_it_was_computed_from() -> None:
    original = piezo_ceramic("pzt5h")
    c, e = original.stiffness_short_circuit, original.stress_constants
    eps = original.permittivity_clamped / 8.8541878128e-12
    again = piezo_ceramic_from_stress_charge(
        material=original.material,
        elastic={"11": c[0, 0], "12": c[0, 1], "13": c[0, 2], "33": c[2, 2], "44": c[3, 3]},
        piezoelectric={"31": e[2, 0], "33": e[2, 2], "15": e[0, 4]},
        relative_permittivity={"11": eps[0], "33": eps[2]},
    )
    assert again.charge_constants == approx(original.charge_constants, rel=1e-9, abs=1e-24)
    assert again.permittivity_free == approx(original.permittivity_free, rel=1e-9)


PZT4_COMPLIANCES = {"11": 12.3e-12, "12": -4.05e-12, "13": -5.31e-12, "33": 15.5e-12, "44": 39e-12}
PZT4_CHARGE_CONSTANTS = {"31": -123e-12, "33": 289e-12, "15": 496e-12}


def own_ceramic(
    *, elastic: dict[str, float] = PZT4_COMPLIANCES, piezoelectric: dict[str, float] = PZT4_CHARGE_CONSTANTS
) -> PiezoCeramic:
    return piezo_ceramic_from_strain_charge(
        material=material("pzt4"),
        elastic=elastic,
        piezoelectric=piezoelectric,
        relative_permittivity={"11": 1475.0, "33": 1300.0},
    )


def test_charge_constants_too_large_for_the_permittivity_are_refused() -> None:
    with raises(InvalidInput, match="the constants of pzt4 store no positive energy"):
        own_ceramic(piezoelectric={"31": -123e-12, "33": 900e-12, "15": 496e-12})


def test_constants_of_other_indices_are_refused_by_name() -> None:
    with raises(InvalidInput, match="piezoelectric constants must be those of index 31, 33, 15, got 31, 33"):
        own_ceramic(piezoelectric={"31": -123e-12, "33": 289e-12})


def test_elastic_constants_without_an_inverse_are_refused() -> None:
    with raises(InvalidInput, match="singular"):
        own_ceramic(elastic={"11": 12e-12, "12": -4e-12, "13": -5e-12, "33": 15e-12, "44": 0.0})


def strain_rotation_about_3(angle: float) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Return what turns a column of engineering strains, from the rotated tensor itself."""
    turn = np.array([[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    pairs = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
    columns = []
    for i, j in pairs:
        strain = np.zeros((3, 3))
        strain[i, j] = strain[j, i] = 1.0 if i == j else 0.5
        turned = turn @ strain @ turn.T
        columns.append([turned[k, m] * (1 if k == m else 2) for k, m in pairs])
    return np.array(columns).T
