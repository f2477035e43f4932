"""Piezoelectric ceramics: symmetry of class 6mm, equivalent forms, positive energy and refusals by name."""

import numpy as np
import pytest
from pytest import approx, raises
from tests.facts.materials.coupling_factors import coupling_factors

from sonolube.errors import InvalidInput, MissingProperty, UnknownName
from sonolube.facts.materials import (
    PiezoCeramic,
    material,
    piezo_ceramic,
    piezo_ceramic_from_strain_charge,
    piezo_ceramic_from_stress_charge,
    piezo_ceramic_names,
)

every_ceramic = pytest.mark.parametrize("name", piezo_ceramic_names())


def test_a_metal_is_no_piezoelectric_ceramic() -> None:
    with raises(UnknownName, match="unknown piezoelectric ceramic 'm50'"):
        piezo_ceramic("m50")


def test_a_ceramic_without_a_complete_set_names_the_missing_constants_and_keeps_its_scalars() -> None:
    with raises(MissingProperty, match="pic151 has no complete set of constants: its maker prints no s12, s13, s44"):
        piezo_ceramic("pic151")
    assert material("pic151").value("charge_constant_33") == 500e-12


@every_ceramic
def test_the_constants_are_invariant_under_rotation_about_the_poling_axis(name: str) -> None:
    # Class 6mm: every rotation about axis 3 leaves the tensors unchanged.
    ceramic = piezo_ceramic(name)
    turn = strain_rotation_about_3(0.7)
    turn_vector = np.array([[np.cos(0.7), np.sin(0.7), 0], [-np.sin(0.7), np.cos(0.7), 0], [0, 0, 1]])
    c, e = ceramic.stiffness_short_circuit, ceramic.stress_constants
    assert turn.T @ c @ turn == approx(c, rel=1e-12, abs=1e-3)
    assert turn_vector.T @ e @ turn == approx(e, rel=1e-12, abs=1e-12)


@every_ceramic
def test_the_strain_charge_and_stress_charge_forms_are_equivalent(name: str) -> None:
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
def test_a_field_along_the_poling_extends_along_it_and_contracts_across(name: str) -> None:
    strain = piezo_ceramic(name).charge_constants.T @ np.array([0.0, 0.0, 1e6])
    assert strain[2] > 0 > strain[0]
    assert strain[0] == approx(strain[1])


@every_ceramic
def test_open_circuit_stiffening_gives_the_thickness_coupling_factor(name: str) -> None:
    # k_t^2 = 1 - c33^E/c33^D with c^D = c^E + e^T (eps^S)^-1 e.
    ceramic = piezo_ceramic(name)
    e = ceramic.stress_constants
    open_circuit = ceramic.stiffness_short_circuit + e.T @ np.diag(1 / ceramic.permittivity_clamped) @ e
    squared = 1 - ceramic.stiffness_short_circuit[2, 2] / open_circuit[2, 2]
    assert coupling_factors(ceramic)["coupling_factor_thickness"] ** 2 == approx(squared)


@every_ceramic
def test_all_coupling_factors_of_one_set_are_those_of_its_own_open_circuit_constants(name: str) -> None:
    # k^2 = 1 - s^D/s^E for length, face and width modes, 1 - c^E/c^D for the thickness, s^D = s^E - d^T (eps^T)^-1 d
    ceramic = piezo_ceramic(name)
    s, d, e = ceramic.compliance_short_circuit, ceramic.charge_constants, ceramic.stress_constants
    c = ceramic.stiffness_short_circuit
    s_open = s - d.T @ np.diag(1 / ceramic.permittivity_free) @ d
    c_open = c + e.T @ np.diag(1 / ceramic.permittivity_clamped) @ e
    assert s_open @ c_open == approx(np.eye(6), abs=1e-9)
    plane, plane_open = s[0, 0] + s[0, 1], s_open[0, 0] + s_open[0, 1]
    squares = {
        "coupling_factor_31": 1 - s_open[0, 0] / s[0, 0],
        "coupling_factor_33": 1 - s_open[2, 2] / s[2, 2],
        "coupling_factor_15": 1 - s_open[4, 4] / s[4, 4],
        "coupling_factor_planar": 1 - plane_open / plane,
        "coupling_factor_thickness": 1 - c[2, 2] / c_open[2, 2],
    }
    assert coupling_factors(ceramic) == approx({key: np.sqrt(square) for key, square in squares.items()}, rel=1e-9)


def test_the_two_tables_of_one_source_are_two_sets_with_couplings_of_their_own() -> None:
    # Berlincourt prints k31 0.334, k33 0.70, k15 0.71, kt 0.513 and kp 0.58, measured on resonators
    printed = {"31": 0.334, "33": 0.70, "15": 0.71, "thickness": 0.513, "planar": 0.58}
    by_compliance, by_stiffness = (coupling_factors(piezo_ceramic(name)) for name in ("pzt4", "pzt4_stress_charge"))
    for key, value in printed.items():
        name = f"coupling_factor_{key}"
        assert 1.01 < by_stiffness[name] / by_compliance[name] < 1.02, name
        assert by_compliance[name] < by_stiffness[name] < value, name
        assert by_stiffness[name] == approx(value, rel=0.015), name
    assert "pzt4_stress_charge" in piezo_ceramic("pzt4").note
    assert "pzt4" in piezo_ceramic("pzt4_stress_charge").note


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
    with raises(InvalidInput, match="the constants of pzt4 do not give a positive stored energy"):
        own_ceramic(piezoelectric={"31": -123e-12, "33": 900e-12, "15": 496e-12})


def test_constants_of_other_indices_are_refused_by_name() -> None:
    with raises(InvalidInput, match="piezoelectric constants must be those of index 31, 33, 15, got 31, 33"):
        own_ceramic(piezoelectric={"31": -123e-12, "33": 289e-12})


def test_elastic_constants_without_an_inverse_are_refused() -> None:
    with raises(InvalidInput, match="singular"):
        own_ceramic(elastic={"11": 12e-12, "12": -4e-12, "13": -5e-12, "33": 15e-12, "44": 0.0})


def strain_rotation_about_3(angle: float) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """Return what turns a column of format_si strains, from the rotated tensor itself."""
    turn = np.array([[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    pairs = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
    columns = []
    for i, j in pairs:
        strain = np.zeros((3, 3))
        strain[i, j] = strain[j, i] = 1.0 if i == j else 0.5
        turned = turn @ strain @ turn.T
        columns.append([turned[k, m] * (1 if k == m else 2) for k, m in pairs])
    return np.array(columns).T
