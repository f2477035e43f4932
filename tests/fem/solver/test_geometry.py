"""Parametric bodies against the volumes of geometry, and what cannot be a body."""

import math
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from sonolube.errors import InvalidInput
from sonolube.fem import (
    Geometry,
    Model,
    Slot,
    annular_section,
    block,
    bond,
    booster,
    change_order,
    conical_horn,
    cylinder,
    exponential_horn,
    generate_mesh,
    hexagon,
    isotropic_medium,
    natural_modes,
    read_step,
    ring,
    ritz_frequencies,
    stepped_horn,
    translate,
)
from sonolube.fem.solver.assembly import assemble_matrices, tributary_areas

R, r, L = 0.02, 0.01, 0.06
FILLET = 0.004


@pytest.mark.parametrize(
    ("body", "volume"),
    [
        (block(length=0.1, width=0.04, thickness=0.02), 0.1 * 0.04 * 0.02),
        (block(length=0.1, width=0.04, thickness=0.02, end_width=0.02), 0.1 * 0.03 * 0.02),
        (
            block(length=0.1, width=0.04, thickness=0.02, slots=(Slot(length=0.05, width=0.004),)),
            0.02 * (0.004 - 0.0002),
        ),
        (cylinder(radius=R, length=L), math.pi * R**2 * L),
        (ring(outer_radius=R, inner_radius=r, length=L), math.pi * (R**2 - r**2) * L),
        (hexagon(width=0.02, length=L, inner_radius=0.004), (math.sqrt(3) / 2 * 0.02**2 - math.pi * 0.004**2) * L),
        (conical_horn(radius=R, end_radius=r, length=L), math.pi * L * (R**2 + R * r + r**2) / 3),
        (stepped_horn(radius=R, end_radius=r, length=L, end_length=L), math.pi * (R**2 + r**2) * L),
        (
            booster(radius=R, end_radius=r, length=L, end_length=L, flange_radius=0.03, flange_thickness=0.005),
            math.pi * ((R**2 + r**2) * L + 0.03**2 * 0.005),
        ),
        (exponential_horn(radius=R, end_radius=r, length=L), math.pi * (R**2 - r**2) * L / (2 * math.log(R / r))),
        (
            stepped_horn(radius=R, end_radius=r, length=L, end_length=L, edge_radius=FILLET),
            # and by Pappus a square of the fillet's radius turned about the axis, less its quarter circle
            math.pi * (R**2 + r**2) * L
            + 2 * math.pi * (r + FILLET / 2) * FILLET**2
            - 2 * math.pi * (r + FILLET - 4 * FILLET / (3 * math.pi)) * math.pi * FILLET**2 / 4,
        ),
    ],
    ids=lambda value: "" if isinstance(value, float) else value.regions[0],
)
def test_bodies_have_the_volume_of_their_formula(body: Geometry, volume: float) -> None:
    assert body.volume == approx(volume, rel=2e-4)


def test_rounding_the_edges_takes_material_away_and_leaves_the_faces() -> None:
    sharp, round_ = (block(length=0.06, width=0.04, thickness=0.03, edge_radius=e) for e in (0.0, 0.006))
    assert 0.93 * sharp.volume < round_.volume < 0.99 * sharp.volume
    mesh = generate_mesh(round_, element_size=0.012)
    assert tributary_areas(mesh, "+z").sum() == approx(0.048 * 0.028, rel=1e-6)


def test_nodes_of_a_round_bar_lie_on_its_curved_side_and_on_its_flat_ends() -> None:
    mesh = generate_mesh(cylinder(radius=R, length=L), element_size=0.006)
    side = mesh.nodes[mesh.face_nodes("side")]
    assert np.hypot(side[:, 0], side[:, 1]) == approx(R, rel=1e-9)
    assert mesh.nodes[mesh.face_nodes("+z"), 2] == approx(L, abs=1e-9)
    assert tributary_areas(mesh, "-z").sum() == approx(math.pi * R**2, rel=2e-3)


def test_the_axial_mode_of_a_round_bar_falls_below_bar_theory_as_rayleigh_said() -> None:
    # f = f0 (1 - (n pi nu a/L)^2/4): lateral inertia of a slender bar.
    mesh = generate_mesh(cylinder(radius=0.004, length=0.08), element_size=0.006)
    model = Model(
        mesh=mesh, media={"cylinder": isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.3, density=7900.0)}
    )
    found = natural_modes(model, count=12).elastic_frequency
    expected = math.sqrt(200e9 / 7900) / 0.16 * (1 - (math.pi * 0.3 * 0.05) ** 2 / 4)
    assert np.abs(found / expected - 1).min() < 2e-4


def test_a_coarse_mesh_of_a_fillet_has_no_folded_element() -> None:
    horn = stepped_horn(radius=R, end_radius=r, length=L, end_length=L, edge_radius=FILLET)
    mesh = generate_mesh(horn, element_size=0.035)
    model = Model(mesh=mesh, media={"horn": isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.3, density=7900.0)})
    mass = assemble_matrices(model).mass.sum() / 3
    assert mass == approx(7900.0 * horn.volume, rel=0.02)


def test_the_same_geometry_and_size_give_the_same_mesh_whatever_was_meshed_before() -> None:
    horn = stepped_horn(radius=R, end_radius=r, length=L, end_length=L)
    first = generate_mesh(horn, element_size=0.02)
    generate_mesh(horn, element_size=0.012)
    again = generate_mesh(horn, element_size=0.02)
    anew = generate_mesh(stepped_horn(radius=R, end_radius=r, length=L, end_length=L), element_size=0.02)
    for mesh in (again, anew):
        assert np.array_equal(mesh.nodes, first.nodes)
        assert np.array_equal(mesh.elements, first.elements)
        assert np.array_equal(change_order(mesh, order=4).nodes, change_order(first, order=4).nodes)


def test_bonded_bodies_share_their_face_and_move_as_one() -> None:
    halves = {
        "lower": cylinder(radius=0.01, length=0.02),
        "upper": translate(cylinder(radius=0.01, length=0.02), by=(0.0, 0.0, 0.02)),
    }
    mesh = generate_mesh(bond(halves), element_size=0.005)
    steel = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.3, density=7900.0)
    two = natural_modes(Model(mesh=mesh, media={"lower": steel, "upper": steel}), count=6).elastic_frequency
    one = ritz_frequencies(
        annular_section(outer_radius=0.01, inner_radius=0.0, order=12), length=0.04, medium=steel, order=12
    )
    assert tributary_areas(mesh, "lower|upper").sum() == approx(math.pi * 1e-4, rel=5e-3)
    assert two == approx(one[:6], rel=1e-2)


def test_a_part_comes_back_from_its_step_file(tmp_path: Path) -> None:
    part = stepped_horn(radius=R, end_radius=r, length=L, end_length=L)
    part.shape.WriteStep(str(tmp_path / "horn.step"))
    assert read_step(tmp_path / "horn.step").volume == approx(part.volume, rel=1e-6)


def test_what_is_no_body_is_refused(tmp_path: Path) -> None:
    with raises(InvalidInput, match=r"thickness must be positive, got 0\.0 m"):
        block(length=0.1, width=0.04, thickness=0.0)
    with raises(InvalidInput, match="the wall has no thickness"):
        ring(outer_radius=0.01, inner_radius=0.01, length=0.01)
    with raises(InvalidInput, match="must be one closed body"):
        block(length=0.1, width=0.04, thickness=0.02, slots=(Slot(length=0.01, width=0.05),))
    with raises(InvalidInput, match="overlap"):
        bond({"one": cylinder(radius=R, length=L), "other": cylinder(radius=r, length=L)})
    (tmp_path / "empty.step").write_text("nothing")
    with raises(InvalidInput, match="STEP"):
        read_step(tmp_path / "empty.step")
    with raises(InvalidInput, match="no such file"):
        read_step(tmp_path / "none.step")


def test_an_open_surface_from_a_step_file_is_refused(tmp_path: Path) -> None:
    cylinder(radius=R, length=L).shape.faces[0].WriteStep(str(tmp_path / "open.step"))
    with raises(InvalidInput, match="no closed solid"):
        read_step(tmp_path / "open.step")


def test_a_step_file_of_a_sheet_without_thickness_is_refused(tmp_path: Path) -> None:
    block(length=R, width=r, thickness=FILLET).shape.faces[0].WriteStep(str(tmp_path / "sheet.step"))
    with raises(InvalidInput, match="no closed solid"):
        read_step(tmp_path / "sheet.step")


@pytest.mark.parametrize(
    ("corners", "message"),
    [
        ([(0, 0), (20, 20), (20, 0), (0, 20)], "must be one closed body with a volume"),  # both halves cancel
        ([(0, 0), (30, 20), (30, 0), (0, 10)], "is it open, or does it cut itself.*more elements on face"),
    ],
)
def test_a_step_file_of_a_prism_whose_sides_cross_is_refused(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], corners: list[tuple[int, int]], message: str
) -> None:
    occ = pytest.importorskip("netgen.occ")
    outline = occ.WorkPlane(occ.Axes((0, 0, 0), n=occ.Z, h=occ.X)).MoveTo(*corners[0])
    for corner in corners[1:]:
        outline = outline.LineTo(*corner)
    outline.Close().Face().Extrude(10).WriteStep(str(tmp_path / "crossed.step"))
    capfd.readouterr()
    with raises(InvalidInput, match=message) as refusal:
        generate_mesh(read_step(tmp_path / "crossed.step"), element_size=8e-3)
    assert capfd.readouterr() == ("", "")
    assert "\n" not in str(refusal.value)


def test_a_slender_bar_of_coarse_elements_has_no_folded_one_at_any_order() -> None:
    # Straightening folds a neighbour here, again and again, before all elements are right.
    mesh = generate_mesh(cylinder(radius=0.006, length=0.125), element_size=0.02)
    media = {"cylinder": isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.3, density=7900.0)}
    for order in (2, 3, 4, 5):
        assert assemble_matrices(Model(mesh=change_order(mesh, order=order), media=media)).mass.sum() > 0
