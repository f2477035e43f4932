"""Classes of materials: medians and spreads over members, cited ranges, families of soft bodies, and sources."""

from math import exp, log, sqrt
from statistics import NormalDist, mean, stdev

import pytest
from pytest import approx

from sonolube.facts.materials import material, material_classes, material_families, material_names

STEELS = [material(name) for name in material_names() if material(name).family == "steel"]


def test_the_modulus_of_steel_is_the_geometric_mean_of_its_grades() -> None:
    moduli = [each.value("youngs_modulus") for each in STEELS if "youngs_modulus" in each.properties]
    product = 1.0
    for modulus in moduli:
        product *= modulus / 1e9
    assert material("steel").value("youngs_modulus") == approx(1e9 * product ** (1 / len(moduli)))


def test_the_spread_of_a_class_is_that_of_one_more_member() -> None:
    # one more draw of a normal of which n are known scatters about their mean by s sqrt(1 + 1/n)
    values = [log(each.value("hardness")) for each in STEELS]
    expected = stdev(values) * sqrt(1 + 1 / len(values))
    assert material("steel").property("hardness").deviation == approx(expected)
    assert exp(expected) == approx(2.14, abs=0.01)  # annealed 1020 has 126, hardened M50 960 HV


@pytest.mark.parametrize("name", ["steel", "stainless_steel", "brass", "bronze", "aluminium", "titanium", "cast_iron"])
def test_members_of_a_class_lie_within_its_spread(name: str) -> None:
    of_class = material(name).property("hardness")
    members = [material(each) for each in material_names() if material(each).family == name]
    law = NormalDist(log(of_class.value), of_class.deviation)
    ranks = [law.cdf(log(each.value("hardness"))) for each in members if "hardness" in each.properties]
    assert all(0.01 < rank < 0.99 for rank in ranks)
    assert mean(ranks) == approx(0.5, abs=0.15)


def test_the_hardness_of_a_metal_varies_at_least_as_one_alloy_over_its_tempers() -> None:
    # the half-hard brasses of the catalogue differ by a tenth; C36000 alone spans 124 to 310 MPa
    brass = material("brass").property("hardness")
    assert brass.deviation == approx(log(310 / 124) / 4)
    assert "tempers" in brass.note


def test_a_cited_range_holds_95_of_100() -> None:
    rubber = material("rubber").property("youngs_modulus")
    law = NormalDist(log(rubber.value), rubber.deviation)
    assert law.cdf(log(20e6)) - law.cdf(log(0.7e6)) == approx(0.954, abs=0.001)


@pytest.mark.parametrize(
    ("typed", "family"),
    [
        *(
            (name, "polymer")
            for name in ("PTFE", "POM", "PA", "PEEK", "UHMWPE", "PMMA", "PET", "plastic", "Kunststoff")
        ),
        *((name, "rubber") for name in ("rubber", "Gummi", "silicone", "NBR", "natural rubber")),
        *((name, "felt") for name in ("felt", "Filz", "fabric")),
        *((name, "skin") for name in ("skin", "Haut", "finger")),
    ],
)
def test_soft_bodies_are_told_by_their_family(typed: str, family: str) -> None:
    assert material(typed).family == family


def test_soft_bodies_are_softer_than_any_metal() -> None:
    softest = material("magnesium").value("youngs_modulus")
    for name in ("polymer", "rubber", "felt", "skin"):
        assert material(name).value("youngs_modulus") < softest / 10


def test_every_property_of_a_class_has_a_source() -> None:
    assert set(material_classes()) <= {*material_families(), "dlc", "tool_steel"}
    for name in material_classes():
        of_class = material(name)
        assert of_class.is_class
        assert "youngs_modulus" in of_class.properties
        assert all(len(known.source) > 10 for known in of_class.properties.values())


def test_a_class_names_the_members_that_it_is_made_of() -> None:
    source = material("brass").property("hardness").source
    assert all(name in source for name in ("brass_c26000", "brass_c27000", "brass_c36000", "brass_c38500"))
    assert not material("brass_c36000").is_class


@pytest.mark.parametrize(("name", "words"), [("brass", "brass"), ("steel", "steel"), ("felt", "felt or cloth")])
def test_a_material_is_named_within_a_sentence(name: str, words: str) -> None:
    assert material(name).words == words
