"""Dry friction by pair: symmetric, names before families, and ranges that hold what the dissertation measured."""

import pytest
from pytest import raises

from sonolube.errors import MissingProperty, UnknownName
from sonolube.materials import dry_friction, dry_friction_pairs, material_families, material_names
from sonolube.published import si_value


@pytest.mark.parametrize(
    ("first", "second"), [("brass", "ss304"), ("alumina", "m50"), ("ptfe", "52100"), ("pom", "pa66"), ("al2024", "304")]
)
def test_the_order_of_a_pair_does_not_matter(first: str, second: str) -> None:
    assert dry_friction(first, second) == dry_friction(second, first)


def test_names_go_before_a_name_and_a_family_and_that_before_families() -> None:
    assert dry_friction("m50", "m50").high < dry_friction("52100", "52100").high
    assert dry_friction("ptfe", "304").high < dry_friction("peek", "304").high
    assert dry_friction("m50", "52100") == dry_friction("304", "316")


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


def test_an_unknown_pair_is_refused_by_name_and_a_misspelt_material_with_a_near_one() -> None:
    with raises(MissingProperty, match=r"no dry friction is known of zirconia on brass_c36000: measure it"):
        dry_friction("zirconia", "brass")
    with raises(UnknownName, match=r"did you mean brass\?"):
        dry_friction("bras", "304")
