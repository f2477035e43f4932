"""Places, directions, participations and static corrections of three modes at four nodes, by hand."""

from typing import Any

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.measurement.mode_shapes.formats import UNIVERSAL_FILE, ModeShapes
from sonolube.measurement.mode_shapes.participation import (
    FoundNode,
    contact_participation,
    direction_vector,
    find_node,
    kept_compliance,
    modal_lists,
    port_participation,
    truncated_compliance,
    with_static_correction,
)

NOWHERE = np.nan
SHAPE = np.array(
    [
        [[1.0, 2, 3], [4, 5, 6], [0, 1, 0], [0, 0, 0]],
        [[0.5, 0, -1], [1.5, 0, 3], [2, 2, 2], [0, 0, 1]],
        [[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]],
    ]
)


def modes(**changed: np.ndarray) -> ModeShapes:
    values: dict[str, Any] = {
        "natural_frequency": np.array([0.0, 100.0, 300.0]),
        "damping_ratio": np.array([np.nan, 0.01, np.nan]),
        "modal_mass": np.array([4.0, 9.0, np.nan]),
        "node": np.array([3, 7, 12, 40]),
        "position": np.array([[0.0, 0, 0], [0, 0.03, 0.04], [0.1, 0, 0], [NOWHERE] * 3]),
        "shape": SHAPE,
    }
    return ModeShapes(format_name=UNIVERSAL_FILE, **(values | changed))


def test_a_node_is_found_by_its_number_or_nearest_to_a_point() -> None:
    assert find_node(modes(), "12", name="tip") == FoundNode(row=2, number=12, distance=0.0)
    assert find_node(modes(), " 3 ", name="tip").row == 0
    found = find_node(modes(), "0, 30, 43 mm", name="tip")
    assert (found.row, found.number) == (1, 7)
    assert found.distance == approx(0.003)
    assert find_node(modes(), "10 cm, 0 m, 4.9 mm", name="tip").number == 12
    with raises(InvalidInput, match="tip 5: no such node; numbers of nodes are 3 to 40"):
        find_node(modes(), "5", name="tip")
    # the longest side is 0.1 m: 5 mm are near
    with raises(
        InvalidInput, match=r"the nearest node, 12 at 10 cm, .*0 m, 0 m, is 5\.1 mm away|the nearest node, 12 at"
    ):
        find_node(modes(), "100, 0, 5.1 mm", name="tip")
    with raises(InvalidInput, match="the file has no positions of nodes; give the number of one"):
        find_node(modes(position=np.full((4, 3), NOWHERE)), "0,0,0mm", name="tip")
    with raises(InvalidInput, match="tip 1,2 must be the number of a node, or a point such as 0,0,50mm"):
        find_node(modes(), "1,2", name="tip")


@pytest.mark.parametrize(
    ("text", "vector"),
    [("x", [1, 0, 0]), ("+y", [0, 1, 0]), (" -z", [0, 0, -1]), ("0, 3, -4", [0, 0.6, -0.8]), ("1e3,0,0", [1, 0, 0])],
)
def test_a_direction_is_a_unit_vector(text: str, vector: list[float]) -> None:
    assert direction_vector(text, name="direction") == approx(vector)


@pytest.mark.parametrize("text", ["w", "0,0,0", "1,2", "1,2,3,4", "1,a,0", "--x", "inf,0,0"])
def test_what_is_no_direction_is_refused(text: str) -> None:
    with raises(InvalidInput, match=r"direction .* must look like \+x, -z or 0,0\.6,0\.8"):
        direction_vector(text, name="direction")


def test_the_contact_moves_away_from_the_other_body_by_the_mean_of_its_nodes() -> None:
    tip = [FoundNode(row=0, number=3), FoundNode(row=1, number=7)]
    outward = np.array([0.0, 0.6, 0.8])
    # means: (2.5, 3.5, 4.5), (1, 0, 1), (0.5, 0.5, 0)
    assert contact_participation(modes(), tip, outward=outward) == approx([-(2.1 + 3.6), -0.8, -0.3])


def test_a_stack_is_elongated_along_the_line_of_its_ends_in_either_order() -> None:
    ends = FoundNode(row=0, number=3), FoundNode(row=1, number=7)
    # along (0, 0.6, 0.8): differences (3, 3, 3), (1, 0, 4), (-1, 1, 0)
    assert port_participation(modes(), ends, name="port") == approx([4.2, 3.2, 0.6])
    assert port_participation(modes(), ends[::-1], name="port") == approx([4.2, 3.2, 0.6])
    for same in ((ends[0], ends[0]), (ends[0], FoundNode(row=3, number=40))):
        with raises(InvalidInput, match="port: needs two ends of the stack at different positions"):
            port_participation(modes(), same, name="port")


CONTACT, DRIVE = np.array([2.0, 3.0, 4.0]), np.array([0.0, 6.0, 8.0])


def test_shapes_are_scaled_to_one_kilogram_and_gaps_of_the_file_filled() -> None:
    lists = modal_lists(modes(), contact=CONTACT, drive=DRIVE, modal_mass=16.0, quality_factor=25.0)
    assert lists["natural_frequency"].tolist() == [0, 100, 300]
    assert lists["damping_ratio"] == approx([0.0, 0.01, 0.02])  # a rigid motion has none; 1/(2 Q)
    assert lists["contact_participation"] == approx([1.0, 1.0, 1.0])
    assert lists["drive_participation"] == approx([0.0, 2.0, 2.0])


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"quality_factor": 25.0}, "the file states no modal mass of 1 of 3 modes; give modal_mass"),
        ({"modal_mass": 16.0}, "the file states no damping of 1 of 3 modes; give quality_factor"),
        ({"modal_mass": -1.0, "quality_factor": 25.0}, "modal_mass must be positive"),
        ({"modal_mass": 16.0, "quality_factor": 0.0}, "quality_factor must be positive"),
        (
            {"modal_mass": 16.0, "quality_factor": 9.0, "drive": np.array([5.0, 0, 0])},
            "stack is strained in none of the 2",
        ),
        ({"modal_mass": 16.0, "quality_factor": 9.0, "contact": np.zeros(3)}, "contact moves in none of the 2 elastic"),
    ],
)
def test_what_is_missing_or_does_not_move_is_named(given: dict[str, object], words: str) -> None:
    with raises(InvalidInput, match=words):
        modal_lists(modes(), **({"contact": CONTACT, "drive": DRIVE} | given))  # type: ignore[arg-type]


def test_what_the_file_states_of_every_mode_is_not_given_again() -> None:
    stated = modes(modal_mass=np.ones(3), damping_ratio=np.full(3, 0.03))
    assert modal_lists(stated, contact=CONTACT, drive=DRIVE)["damping_ratio"] == approx([0, 0.03, 0.03])
    with raises(InvalidInput, match="modal_mass: the file states the modal mass of every mode; leave it out"):
        modal_lists(stated, contact=CONTACT, drive=DRIVE, modal_mass=1.0)
    with raises(InvalidInput, match="quality_factor: the file states the damping of every mode; leave it out"):
        modal_lists(stated, contact=CONTACT, drive=DRIVE, quality_factor=9.0)


LISTS = {
    "natural_frequency": np.array([0.0, 4.0, 2.0]) / (2 * np.pi),  # omega 0, 4 and 2
    "damping_ratio": np.array([0.0, 0.03, 0.01]),
    "drive_participation": np.array([9.0, 8.0, 1.0]),
    "contact_participation": np.array([7.0, 2.0, 3.0]),
}


def test_one_more_mode_carries_the_static_share_of_those_that_are_left_out() -> None:
    # kept: 4/16 + 9/4 = 2.5 m/N; 16/16 + 3/4 = 1.75 m/V
    assert kept_compliance(LISTS) == approx(2.5)
    corrected, left = with_static_correction(
        LISTS, static_compliance=6.5, displacement_per_volt=2.25, clamped_capacitance=1.0
    )
    # the rest: 4 m/N and 0.5 m/V; omega 16, capacitance 0.25/4
    assert corrected["natural_frequency"][-1] == approx(16 / (2 * np.pi))
    assert corrected["damping_ratio"].tolist() == [0.0, 0.03, 0.01, 0.03]  # of the highest
    assert corrected["contact_participation"][-1] == approx(32.0)
    assert corrected["drive_participation"][-1] == approx(4.0)
    assert left == approx(1 - 0.0625)
    assert kept_compliance(corrected) == approx(6.5)
    with raises(InvalidInput, match=r"static_compliance 2\.5 m/N must exceed 2\.5 m/N"):
        with_static_correction(LISTS, static_compliance=2.5, displacement_per_volt=2.0, clamped_capacitance=1.0)
    with raises(InvalidInput, match=r"leaves 2 m/V to the truncated modes, whose capacitance 1 F exceeds"):
        with_static_correction(LISTS, static_compliance=6.5, displacement_per_volt=3.75, clamped_capacitance=1.0)


def test_the_modes_above_go_on_as_the_upper_half_of_those_below() -> None:
    lists = {
        "natural_frequency": np.array([7.0, 0.0, 1.0, 2.0, 4.0]) / (2 * np.pi),
        "contact_participation": np.array([3.0, 50.0, 90.0, 5.0, 1.0]),
    }
    # of omega 1, 2, 4, 7 the last three: distances of 2.5 in the mean, squares (25 + 1 + 9)/3
    assert truncated_compliance(lists) == approx(35 / 3 / (2.5 * (7 + 1.25)))
    two = {name: values[[1, 0]] for name, values in lists.items()}
    assert np.isnan(truncated_compliance(two))  # one elastic mode
    pair = {"natural_frequency": np.array([2.0, 3.0]) / (2 * np.pi), "contact_participation": np.array([1.0, 2.0])}
    assert truncated_compliance(pair) == approx(2.5 / (1 * 3.5))
    equal = {"natural_frequency": np.array([1.0, 1.0]), "contact_participation": np.array([1.0, 2.0])}
    assert np.isnan(truncated_compliance(equal))
