"""The rule of wear mechanisms against the six pairs of its evidence, and the limits of its range."""

from itertools import pairwise

import pytest
from tests.same import same

from sonolube.facts.materials import material
from sonolube.facts.published import table
from sonolube.models.wear import (
    CrystalStructure,
    VibrationEffect,
    WearMechanism,
    WearMechanismAssessment,
    WearPairBody,
    assess_wear_mechanism,
)
from sonolube.rig import wear_of_materials

NAMES = {
    "stainless steel": "stainless_steel_316",
    "aluminium": "aluminium_2024",
    "titanium": "titanium_6al4v",
    "ceramic": "alumina",
    "M50 tool steel": "m50",
}
PAIRS = table("2.14").columns


@pytest.mark.parametrize("row", range(6))
def test_the_rule_classifies_the_six_pairs_as_table_2_14(row: int) -> None:
    pin, disc = (material(NAMES[PAIRS[body].printed[row]]) for body in ("pin", "disc"))
    assessed = wear_of_materials(pin, disc)
    assert assessed.mechanism == PAIRS["wear_type"].printed[row]
    reduced = PAIRS["wear_outcome"].printed[row] == "reduction"
    assert assessed.vibration_effect is (VibrationEffect.LESS_WEAR if reduced else VibrationEffect.MORE_WEAR)


def test_titanium_wears_more_under_vibration_in_any_pair() -> None:
    titanium = material("titanium_6al4v")
    for name in NAMES.values():
        assert wear_of_materials(material(name), titanium).vibration_effect is VibrationEffect.MORE_WEAR


def test_the_order_of_the_bodies_has_no_effect() -> None:
    names = list(NAMES.values())
    for first, second in pairwise(names):
        same(wear_of_materials(material(first), material(second)), wear_of_materials(material(second), material(first)))


def test_an_assessment_gives_reasons_and_evidence_and_no_number() -> None:
    assessed = wear_of_materials(material("m50"), material("alumina"))
    fields = [getattr(assessed, name) for name in WearMechanismAssessment.__slots__]
    assert not any(isinstance(value, int | float) for value in fields)
    assert assessed.reasons
    assert any("six pairs" in line for line in assessed.evidence)


def test_a_pair_of_ceramics_is_outside_the_evidence() -> None:
    body = WearPairBody(name="alumina", hardness=15e9, structure=CrystalStructure.NOT_A_METAL)
    assert any("does not cover" in line for line in assess_wear_mechanism(body, body).evidence)


def test_a_soft_body_paired_with_one_as_soft_is_not_ploughed() -> None:
    soft = WearPairBody(name="aluminium", hardness=1.3e9, structure=CrystalStructure.FACE_CENTRED_CUBIC)
    assert assess_wear_mechanism(soft, soft).mechanism is WearMechanism.ADHESIVE
