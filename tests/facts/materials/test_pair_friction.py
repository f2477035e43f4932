"""Dry friction by pair: symmetric, names before families, and ranges that hold what the dissertation measured."""

import pytest
from pytest import raises
from tests.same import same

from sonolube.errors import UnknownName
from sonolube.facts.materials import (
    dry_friction,
    dry_friction_classes,
    dry_friction_pairs,
    material_classes,
    material_families,
    material_names,
)
from sonolube.facts.published import si_value


@pytest.mark.parametrize(
    ("first", "second"), [("brass", "ss304"), ("alumina", "m50"), ("ptfe", "52100"), ("pom", "pa66"), ("al2024", "304")]
)
def test_the_order_of_a_pair_does_not_matter(first: str, second: str) -> None:
    same(dry_friction(first, second), dry_friction(second, first))


def test_names_go_before_a_name_and_a_family_and_that_before_families() -> None:
    assert dry_friction("m50", "m50").high < dry_friction("52100", "52100").high
    assert dry_friction("ptfe", "304").high < dry_friction("peek", "304").high
    same(dry_friction("m50", "52100"), dry_friction("304", "316"))


# Forces over loads that D measured without vibration.
@pytest.mark.parametrize(
    ("first", "second", "force", "load"),
    [
        ("stainless_steel_316", "aluminium_2024", "table-2.3-friction_force-1", 3.0),
        ("stainless_steel_316", "aluminium_2024", "table-2.3-friction_force-5", 3.0),
        ("stainless_steel_316", "titanium_6al4v", "2.5.2-friction-titanium-off", 3.0),
        ("alumina", "m50", "2.5.4-friction-ceramic-off", 3.0),
        ("m50", "m50", "2.5.5-friction-m50-off", 3.0),
        ("uncoated_steel", "uncoated_steel", "table-4.2-friction_force-1", 5.0),
    ],
)
def test_the_range_holds_what_the_dissertation_measured(first: str, second: str, force: str, load: float) -> None:
    known = dry_friction(first, second)
    assert known.low <= si_value(force) / load <= known.high


def test_every_range_is_wide_and_has_a_source_and_sides_that_exist() -> None:
    names = {*material_names(), *material_families()}
    for pair in dry_friction_pairs():
        assert set().union(*pair.sides) <= names
        assert 0 < pair.friction.low < pair.friction.high < 2
        assert pair.friction.high / pair.friction.low >= 1.5
        assert len(pair.friction.source) > 10
        assert pair.friction.note


def test_no_pair_stands_twice_with_the_same_right_to_answer() -> None:
    pairs = dry_friction_pairs()
    for index, one in enumerate(pairs):
        for other in pairs[index + 1 :]:
            assert not (one.sides[0] & other.sides[0] and one.sides[1] & other.sides[1])
            assert not (one.sides[0] & other.sides[1] and one.sides[1] & other.sides[0])


def test_a_misspelt_material_is_refused_with_a_near_one() -> None:
    with raises(UnknownName, match=r"did you mean brass\?"):
        dry_friction("bras", "304")


@pytest.mark.parametrize(
    ("first", "second", "pair_class"),
    [
        ("zirconia", "c36000", "ceramic on metal"),
        ("ss304", "alumina", "ceramic on metal"),
        ("alumina", "zirconia", "ceramic on ceramic"),
        ("titanium", "ti64", "metal on one of its own family"),
        ("titanium", "brass", "metal on metal"),
        ("ptfe", "silicon_carbide", "polymer on any material"),
        ("pom", "peek", "polymer on any material"),
        ("dlc", "304", "carbon film on any material"),
        ("rubber", "glass", "rubber on any material"),
        ("felt", "304", "felt on any material"),
        ("skin", "rubber", "skin on any material"),
        ("steel", "brass", ""),
    ],
)
def test_a_pair_that_no_source_names_has_the_range_of_its_class(first: str, second: str, pair_class: str) -> None:
    assert dry_friction(first, second).pair_class == pair_class
    same(dry_friction(second, first), dry_friction(first, second))


def test_no_pair_of_materials_or_classes_is_without_friction() -> None:
    names = (*material_names(), *material_classes())
    assert all(dry_friction(one, other).low > 0 for one in names for other in names)


def test_the_range_of_a_class_of_pairs_is_wide_and_holds_the_middles_of_its_pairs() -> None:
    metals = {"aluminium", "brass", "bronze", "cast_iron", "copper", "steel", "stainless_steel", "titanium"}
    pairs = [pair for pair in dry_friction_pairs() if pair.sides[0] <= metals and pair.sides[1] <= metals]
    unlike = [pair.friction for pair in pairs if not pair.sides[0] & pair.sides[1]]
    found = dry_friction("titanium", "brass")
    assert len(unlike) >= 8
    assert all(found.low <= (each.low + each.high) / 2 <= found.high for each in unlike)
    for each in dry_friction_classes():
        assert each.friction.high / each.friction.low > 2.5
        assert each.friction.source
        assert each.friction.note
