"""Profiles of horns by hand: vertices, stations and widths of each shape, the DXF file of R12, the sheet to scale."""

from collections.abc import Sequence
from math import sqrt
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from tests.same import approx

from sonolube.design.horns.profile import HornProfile, _spread, horn_drawing, horn_notes, horn_profile, profile_dxf
from sonolube.design.horns.shapes import TunableBody

if TYPE_CHECKING:
    from matplotlib.axes import Axes

QUARTER = sqrt(2) - 1  # tangent of 22.5 degrees, a quarter of the angle of a quarter of a circle


def made(shape: str, *, length: float, tuned: str = "length", **sizes: float) -> HornProfile:
    """Profile of a shape whose solid nobody needs."""
    body = TunableBody(
        name=shape, geometry_at=lambda _: pytest.fail("no solid"), length=1.0, axis="z", sizes=sizes, tuned_size=tuned
    )
    profile = horn_profile(body, length=length)
    assert profile is not None
    return profile


def test_cylinder_and_cone_have_the_corners_of_their_sizes() -> None:
    rod = made("cylinder", length=0.12, radius=0.02)
    assert np.array(rod.vertices) == approx(np.array([(0, 0, 0), (0, 0.02, 0), (0.12, 0.02, 0), (0.12, 0, 0)]))
    assert rod.stations == approx((0, 0.12))
    assert np.array(rod.widths) == approx(np.array([(0.06, 0.04)]))
    assert (rod.fillets, rod.thickness, rod.notes) == ((), None, ())
    cone = made("conical_horn", length=0.12, radius=0.02, end_radius=0.005)
    assert np.array(cone.vertices) == approx(np.array([(0, 0, 0), (0, 0.02, 0), (0.12, 0.005, 0), (0.12, 0, 0)]))
    assert cone.stations == approx((0, 0.12))
    assert np.array(cone.widths) == approx(np.array([(0, 0.04), (0.12, 0.01)]))


def test_an_exponential_horn_of_sixteen_to_one_halves_at_every_quarter() -> None:
    horn = made("exponential_horn", length=0.1, radius=0.032, end_radius=0.002)
    assert horn.stations == approx((0, 0.025, 0.05, 0.075, 0.1))
    assert np.array(horn.widths) == approx(
        np.array([(0, 0.064), (0.025, 0.032), (0.05, 0.016), (0.075, 0.008), (0.1, 0.004)])
    )
    assert horn.notes == ("diameter at z from the driven face: 64.00 (4.00/64.00)^(z/100.00)",)
    place, distance, bulge = np.array(horn.vertices[1:-1]).T
    assert (place[0], place[-1], np.diff(place).max()) == approx((0, 0.1, 0.1 / 200))
    assert distance == approx(0.032 * np.exp2(-place / 0.025))
    assert not bulge.any()


def test_a_stepped_horn_has_a_quarter_of_a_circle_at_the_foot_of_its_step() -> None:
    # 40 mm of radius 20, then 50 mm of radius 8, fillet 6: the arc from (40, 14) to (46, 8) about (46, 14)
    horn = made("stepped_horn", length=0.04, radius=0.02, end_length=0.05, end_radius=0.008, edge_radius=0.006)
    corners = [(0, 0), (0, 20), (40, 20), (40, 14), (46, 8), (90, 8), (90, 0)]
    assert 1e3 * np.array(horn.vertices)[:, :2] == approx(np.array(corners, dtype=float))
    assert [vertex[2] for vertex in horn.vertices] == approx([0, 0, 0, QUARTER, 0, 0, 0])
    assert 1e3 * np.array(horn.stations) == approx([0, 40, 90])
    assert 1e3 * np.array(horn.widths) == approx(np.array([(20, 40), (68, 16)]))  # 68: between 46 and 90
    middle = 6 * (1 - sqrt(0.5))  # of the arc, from both lines
    assert 1e3 * np.array(horn.fillets) == approx(np.array([(40 + middle, 8 + middle, 6)]))
    sharp = made("stepped_horn", length=0.04, radius=0.02, end_length=0.05, end_radius=0.008, edge_radius=0.0)
    corners = [(0, 0), (0, 20), (40, 20), (40, 8), (90, 8), (90, 0)]
    assert 1e3 * np.array(sharp.vertices) == approx(np.array([(*corner, 0) for corner in corners], dtype=float))
    assert sharp.fillets == ()
    assert 1e3 * np.array(sharp.widths[1]) == approx([65, 16])


def test_the_tuned_length_takes_the_place_of_its_size() -> None:
    sizes = {"length": 0.04, "radius": 0.02, "end_length": 0.5, "end_radius": 0.01, "edge_radius": 0.0}
    tuned = horn_profile(
        TunableBody(
            name="stepped_horn", geometry_at=lambda _: pytest.fail("no solid"), length=1.0, axis="z", sizes=sizes,
            tuned_size="end_length",
        ),
        length=0.03,
    )  # fmt: skip
    assert tuned is not None
    assert tuned.stations == approx((0, 0.04, 0.07))


def test_a_booster_has_its_flange_between_its_ends() -> None:
    # 60 mm of radius 18, a flange of 5 mm and radius 25, 50 mm of radius 14
    sizes: dict[str, Any] = {
        "radius": 0.018,
        "end_length": 0.05,
        "end_radius": 0.014,
        "flange_thickness": 0.005,
        "flange_radius": 0.025,
    }
    booster = made("booster", length=0.06, **sizes)
    corners = [(0, 0), (0, 18), (60, 18), (60, 25), (65, 25), (65, 14), (115, 14), (115, 0)]
    assert 1e3 * np.array(booster.vertices) == approx(np.array([(*corner, 0) for corner in corners], dtype=float))
    assert 1e3 * np.array(booster.stations) == approx([0, 60, 65, 115])
    assert 1e3 * np.array(booster.widths) == approx(np.array([(30, 36), (62.5, 50), (90, 28)]))


def test_a_block_states_its_thickness_its_edges_and_the_width_of_each_end() -> None:
    block = made("block", length=0.12, width=0.06, thickness=0.025)
    assert 1e3 * np.array(block.vertices) == approx(np.array([(0, 0, 0), (0, 30, 0), (120, 30, 0), (120, 0, 0)]))
    assert 1e3 * np.array(block.stations) == approx([0, 120])
    assert 1e3 * np.array(block.widths) == approx(np.array([(60, 60)]))
    assert (block.thickness, block.notes) == (0.025, ())
    tapered = made("block", length=0.12, width=0.06, end_width=0.04, thickness=0.025, edge_radius=0.0015)
    assert 1e3 * np.array(tapered.vertices) == approx(np.array([(0, 0, 0), (0, 30, 0), (120, 20, 0), (120, 0, 0)]))
    assert 1e3 * np.array(tapered.widths) == approx(np.array([(0, 60), (120, 40)]))
    assert tapered.notes == ("all edges rounded, R1.50",)


def test_the_outline_follows_arcs_of_either_bulge_about_their_centres() -> None:
    # a quarter about (3, 2) from (1, 2) to (3, 4) bulging outwards, straight edges elsewhere
    outwards = HornProfile(
        vertices=((1, 0, 0), (1, 2, -QUARTER), (3, 4, 0), (5, 0, 0)), stations=(1, 5), widths=((1, 4),)
    ).outline
    assert len(outwards) == 3 + 32
    angle = np.pi - np.arange(32) * np.pi / 64  # clockwise from the left end of the arc
    expected = np.array([3, 2]) + 2 * np.column_stack([np.cos(angle), np.sin(angle)])
    assert outwards == approx(np.array([(1, 0), *expected, (3, 4), (5, 0)]))
    # the same chord bulging inwards is about (1, 4), and runs the other way round
    inwards = HornProfile(
        vertices=((1, 0, 0), (1, 2, QUARTER), (3, 4, 0), (5, 0, 0)), stations=(1, 5), widths=((1, 4),)
    ).outline
    angle = -np.pi / 2 + np.arange(32) * np.pi / 64
    expected = np.array([1, 4]) + 2 * np.column_stack([np.cos(angle), np.sin(angle)])
    assert inwards[1:33] == approx(expected)


# A group code and its value a line, by the manual of Release 12; the pattern of CENTER is that of acad.lin in inches,
# 1.25, -0.25, 0.25, -0.25, times 25.4; ten digits of 8.12345678913 mm.
# The profile ends at 30 mm, so that its centre line reaches 1.5 mm beyond.
DXF = """
999 lengths in mm|0 SECTION|2 HEADER|9 $ACADVER|1 AC1009|0 ENDSEC
0 SECTION|2 TABLES|0 TABLE|2 LTYPE|70 2
0 LTYPE|2 CONTINUOUS|70 0|3 Solid line|72 65|73 0|40 0
0 LTYPE|2 CENTER|70 0|3 Long and short dashes|72 65|73 4|40 50.8|49 31.75|49 -6.35|49 6.35|49 -6.35|0 ENDTAB
0 TABLE|2 LAYER|70 3
0 LAYER|2 PROFILE|70 0|62 7|6 CONTINUOUS
0 LAYER|2 CENTRE|70 0|62 1|6 CENTER
0 LAYER|2 TEXT|70 0|62 3|6 CONTINUOUS|0 ENDTAB|0 ENDSEC
0 SECTION|2 ENTITIES|0 POLYLINE|8 PROFILE|66 1|10 0|20 0|30 0|70 1
0 VERTEX|8 PROFILE|10 0|20 0|30 0
0 VERTEX|8 PROFILE|10 0|20 10|30 0
0 VERTEX|8 PROFILE|10 20|20 8.123456789|30 0|42 0.5
0 VERTEX|8 PROFILE|10 30|20 0|30 0|0 SEQEND|8 PROFILE
0 LINE|8 CENTRE|10 -1.5|20 0|30 0|11 31.5|21 0|31 0
0 TEXT|8 TEXT|10 0|20 -12|30 0|40 3|1 %%c in mm
0 TEXT|8 TEXT|10 0|20 -18|30 0|40 3|1 br?ss
0 ENDSEC|0 EOF
"""


def test_the_dxf_file_is_the_one_written_by_hand_from_the_manual_of_release_12() -> None:
    profile = HornProfile(
        vertices=((0.0, 0.0, 0.0), (0.0, 0.01, 0.0), (0.02, 8.12345678913e-3, 0.5), (0.03, 0.0, 0.0)),
        stations=(0.0, 0.03),
        widths=((0.0, 0.02),),
    )
    tags = [tag.split(" ", 1) for line in DXF.strip().splitlines() for tag in line.split("|")]
    expected = "".join(f"{code:>3}\n{value}\n" for code, value in tags)
    assert profile_dxf(profile, ["⌀ in mm", "bräss"]) == expected


def test_the_notes_of_a_drawing_have_mass_mode_trim_and_node_in_units_of_a_workshop() -> None:
    mode: Any = SimpleNamespace(names=["bending 1", "axial 1"], row=1, frequency=19_987.6)
    design: Any = SimpleNamespace(
        body=SimpleNamespace(name="stepped_horn", tuned_size="end_length"),
        tuned=SimpleNamespace(mode=mode, frequency_per_length=-151_234.0),
        geometry=SimpleNamespace(volume=2.5e-5),
        node_position=0.04567,
    )
    metal: Any = SimpleNamespace(name="brass", value=lambda name: {"density": 8400.0}[name])
    profile = HornProfile(vertices=(), stations=(), widths=(), notes=("all edges rounded",))
    # 25 cm3 of 8.4 g/cm3; -151.234 kHz/m are -151.2 Hz/mm
    assert horn_notes(design, metal, profile) == [
        "stepped horn of brass, 210 g",
        "axial 1 at 19988 Hz by finite elements, trim -151.2 Hz/mm of end length",
        "node of the axial motion 45.67 from the driven face",  # in mm, as the last line says
        "all edges rounded",
        "nominal lengths and diameters in mm; tolerances, finish and threads are not part of the design",
    ]
    flat = HornProfile(vertices=(), stations=(), widths=(), thickness=0.02)
    assert horn_notes(design, metal, flat)[-1].startswith("nominal lengths and width in mm")


STEPPED = HornProfile(  # in mm: 60 of diameter 40, then 40 of diameter 20 with a fillet of 5
    vertices=(
        *((0.0, 0.0, 0.0), (0.0, 0.02, 0.0), (0.06, 0.02, 0.0), (0.06, 0.015, QUARTER)),
        *((0.065, 0.01, 0.0), (0.1, 0.01, 0.0), (0.1, 0.0, 0.0)),
    ),
    stations=(0.0, 0.06, 0.1),
    widths=((0.03, 0.04), (0.0825, 0.02)),
    fillets=((0.06 + 0.005 * (1 - sqrt(0.5)), 0.01 + 0.005 * (1 - sqrt(0.5)), 0.005),),
)
LEFT, RIGHT = 37.0, 137.0  # 100 mm in the middle of a page of 174 mm


def sheet(profile: HornProfile, *notes: str) -> "Axes":
    (axes,) = horn_drawing(profile, notes=notes).axes
    return axes


def lines_of(axes: "Axes", points: int) -> list[np.ndarray]:
    """Lines of so many points, each an array of places in mm."""
    found = [np.column_stack([np.asarray(each) for each in line.get_data()]) for line in axes.lines]
    return [each for each in found if len(each) == points]


def text_of(axes: "Axes", text: str) -> tuple[float, float]:
    (found,) = (each for each in axes.texts if each.get_text() == text)
    return found.get_position()


def test_the_view_stands_to_scale_in_the_middle_of_the_sheet_on_its_centre_line() -> None:
    axes = sheet(STEPPED, "a note")
    corners = np.asarray(axes.patches[0].get_path().vertices)
    centre = next(line for line in lines_of(axes, 2) if line[0, 1] == line[1, 1] and line[0, 0] == approx(LEFT - 3))
    middle = centre[0, 1]
    assert centre[:, 0] == approx([LEFT - 3, RIGHT + 3])  # it reaches beyond the part
    upper = {(round(x - LEFT, 6), round(y - middle, 6)) for x, y in corners}
    for corner in ((0, 20), (60, 20), (60, 15), (65, 10), (100, 10)):
        assert {corner, (corner[0], -corner[1])} <= upper
    arc = np.array([(x, abs(y)) for x, y in upper if 60 < x < 65 and abs(y) < 15])
    assert np.hypot(arc[:, 0] - 65, arc[:, 1] - 15) == approx(5.0)
    assert text_of(axes, "driven\nface") == approx((LEFT - 4, middle))
    assert text_of(axes, "working\nface") == approx((RIGHT + 4, middle))
    assert {each.get_text(): each.get_horizontalalignment() for each in axes.texts[:2]} == {
        "driven\nface": "right",
        "working\nface": "left",
    }
    assert axes.get_xlim() == (0.0, 174.0)
    figure = axes.get_figure(root=True)
    assert figure is not None
    assert 25.4 * figure.get_size_inches() == approx([174.0, axes.get_ylim()[1]])  # so that a mm of it is one of paper


def test_lengths_stand_in_chains_below_the_view_with_extension_lines_from_the_surface() -> None:
    axes = sheet(STEPPED, "a note")
    middle = text_of(axes, "driven\nface")[1]
    bottom = middle - 20
    # ISO 129-1: extension lines from near the outline to just beyond the dimension line, which ends in oblique strokes
    upright = {round(line[0, 0] - LEFT, 6): line[:, 1] for line in lines_of(axes, 2) if line[0, 0] == line[1, 0]}
    assert set(upright) == {0.0, 60.0, 100.0}
    chains = [line for line in lines_of(axes, 2) if line[0, 1] == line[1, 1] and line[0, 0] == approx(LEFT)]
    parts, whole = sorted((line[0, 1] for line in chains), reverse=True)
    assert {round(line[1, 0], 6) for line in chains} == {RIGHT}
    assert bottom > parts + 5 > whole + 5
    assert upright[0.0] == approx([middle - 20 - 1, whole - 1])
    assert upright[100.0] == approx([middle - 10 - 1, whole - 1])
    assert upright[60.0][1] == approx(parts - 1)
    assert middle - 20 - 1 - 1e-9 <= upright[60.0][0] <= middle - 15 - 1 + 1e-9  # at the step
    strokes = [line for line in lines_of(axes, 2) if np.diff(line, axis=0)[0] == approx([2.0, 2.0])]
    ends = sorted((round(x - LEFT, 6), y) for x, y in (line.mean(axis=0) for line in strokes))
    assert ends == [approx(each) for each in ((0, whole), (0, parts), (60, parts), (100, whole), (100, parts))]
    assert text_of(axes, "60.00") == approx((LEFT + 30, parts - 2))
    assert text_of(axes, "40.00") == approx((LEFT + 80, parts - 2))
    assert text_of(axes, "100.00") == approx((LEFT + 50, whole - 2))


def test_widths_stand_above_the_view_with_leaders_to_a_dot_on_the_surface() -> None:
    axes = sheet(STEPPED, "a note")
    middle = text_of(axes, "driven\nface")[1]
    dots = sorted(tuple(line[0]) for line in lines_of(axes, 1))
    fillet = 5 * (1 - sqrt(0.5))
    expected = ((30, 20), (60 + fillet, 10 + fillet), (82.5, 10))
    assert dots == [approx((LEFT + x, middle + y)) for x, y in expected]
    leaders = lines_of(axes, 3)
    assert sorted(tuple(line[2]) for line in leaders) == dots
    for line, text in zip(leaders, ("⌀40.00", "R5.00", "⌀20.00"), strict=True):
        place, height = text_of(axes, text)
        assert line[:, 0] == approx([place, line[2, 0], line[2, 0]])
        assert middle + 20 < line[1, 1] < line[0, 1] < height
        assert (line[1, 1], line[0, 1], height) == approx(tuple(middle + 20 + gap for gap in (2, 5, 5.5)))


def test_notes_stand_in_rows_of_five_millimetres_at_the_foot_with_the_scale_last() -> None:
    axes = sheet(STEPPED, "a note", "another")
    places = [text_of(axes, text) for text in ("a note", "another", "scale 1:1 at a width of 174 mm")]
    assert places == [approx((8, height)) for height in (13, 8, 3)]
    lowest = min(line[:, 1].min() for line in lines_of(axes, 2))
    assert lowest > 15  # above the rows of the notes


@pytest.mark.parametrize(
    ("length", "radius", "scale"),
    [
        (0.132, 0.022, "1:1"),  # the view fills 132 mm by 44 mm
        (0.1321, 0.022, "1:2"),
        (0.132, 0.0221, "1:2"),
        (0.066, 0.011, "2:1"),
        (0.0026, 0.0004, "50:1"),
        (50.0, 1.0, "1:50"),
    ],
)
def test_the_scale_is_the_largest_of_iso_5455_that_the_sheet_has_room_for(
    length: float, radius: float, scale: str
) -> None:
    axes = sheet(made("cylinder", length=length, radius=radius))
    assert f"scale {scale} at a width of 174 mm" in {each.get_text() for each in axes.texts}


def test_two_stations_have_one_chain_of_lengths_and_a_block_its_thickness() -> None:
    axes = sheet(made("block", length=0.1, width=0.04, thickness=0.025))
    middle = text_of(axes, "driven\nface")[1]
    assert [each.get_text() for each in axes.texts if each.get_text() == "100.00"] == ["100.00"]
    assert len([line for line in lines_of(axes, 2) if line[0, 0] == line[1, 0]]) == 2
    dots = sorted(tuple(line[0]) for line in lines_of(axes, 1))
    assert dots == [approx((LEFT + 50, middle + 20)), approx((LEFT + 90, middle + 20))]  # thickness at nine tenths
    assert {"width 40.00", "thickness 25.00"} <= {each.get_text() for each in axes.texts}
    tapered = sheet(made("block", length=0.1, width=0.04, end_width=0.02, thickness=0.025))
    dots = sorted(tuple(line[0]) for line in lines_of(tapered, 1))
    middle = text_of(tapered, "driven\nface")[1]
    assert dots == [approx((LEFT + x, middle + y)) for x, y in ((0, 20), (90, 10), (100, 10))]


def test_a_part_of_half_the_size_is_the_same_drawing_at_two_to_one() -> None:
    half = HornProfile(
        vertices=tuple((x / 2, y / 2, bulge) for x, y, bulge in STEPPED.vertices),
        stations=tuple(place / 2 for place in STEPPED.stations),
        widths=tuple((place / 2, width / 2) for place, width in STEPPED.widths),
        fillets=tuple((x / 2, y / 2, radius / 2) for x, y, radius in STEPPED.fillets),
    )
    large, small = sheet(STEPPED, "a note"), sheet(half, "a note")
    assert "scale 2:1 at a width of 174 mm" in {each.get_text() for each in small.texts}
    assert np.asarray(small.patches[0].get_path().vertices) == approx(np.asarray(large.patches[0].get_path().vertices))
    for one, other in zip(large.lines, small.lines, strict=True):
        assert np.array(other.get_data(), dtype=float) == approx(np.array(one.get_data(), dtype=float), abs=1e-2)


def gaps(places: Sequence[float], widths: Sequence[float]) -> np.ndarray:
    """Space between neighbours."""
    return np.asarray(np.diff(places) - (np.array(widths[1:]) + np.array(widths[:-1])) / 2)


def test_texts_that_have_room_stay_and_those_that_have_none_move_apart_evenly() -> None:
    assert _spread([20.0, 60.0, 100.0], [10.0, 12.0, 8.0]) == [20.0, 60.0, 100.0]
    assert _spread([100.0], [10.0]) == [100.0]
    assert _spread([3.0], [10.0]) == [5.0]  # not beyond the left end of the sheet
    # two texts of 10 mm and 14 mm, 2 mm apart, need 12: half of the missing 10 mm each
    assert _spread([50.0, 52.0], [10.0, 14.0]) == approx([45.0, 57.0])
    # three of 10, 20 and 6 mm at one place need 15 and 13 mm: the last would move by 28, so that all go back by 14
    assert _spread([50.0, 50.0, 50.0], [10.0, 20.0, 6.0]) == approx([36.0, 51.0, 64.0])
    # at the right end of the sheet, 174 mm, they move to the left
    assert _spread([168.0, 172.0], [10.0, 14.0]) == approx([155.0, 167.0])
    crowded = _spread([30.0, 31.0, 90.0, 90.5], widths := [8.0, 6.0, 20.0, 4.0])
    assert gaps(crowded, widths).min() > -1e-9


def test_a_sheet_of_many_stations_puts_its_short_lengths_beside_their_places() -> None:
    # 4 mm between two stations have no room for a text of 4 characters beside 48.00: a line leads to it
    booster = made(
        "booster", length=0.048, radius=0.018, end_length=0.048, end_radius=0.014, flange_thickness=0.004,
        flange_radius=0.02,
    )  # fmt: skip
    axes = sheet(booster)
    texts = ["48.00", "4.00", "48.00"]
    places = [each.get_position()[0] - LEFT for each in axes.texts if each.get_text() in texts]
    assert places == approx([24, 50, 76])
