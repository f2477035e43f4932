"""Generated meshes: nodes on the geometry, untangled elements, reproducibility."""

import math
from pathlib import Path

import numpy as np
import pytest
from pytest import approx, raises

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from tests.same import same

from sonolube.errors import InvalidInput
from sonolube.models.fem import (
    Model,
    change_order,
    cylinder,
    generate_mesh,
    isotropic_medium,
    natural_modes,
    read_step,
    stepped_horn,
)
from sonolube.models.fem.solver.assembly import assemble_matrices, tributary_areas

R, r, L = 0.02, 0.01, 0.06

FILLET = 0.004


def test_nodes_of_a_round_bar_lie_on_its_curved_side_and_on_its_flat_ends() -> None:
    mesh = generate_mesh(cylinder(radius=R, length=L), element_size=0.006)
    side = mesh.nodes[mesh.face_nodes("side")]
    assert np.hypot(side[:, 0], side[:, 1]) == approx(R, rel=1e-9)
    assert mesh.nodes[mesh.face_nodes("+z"), 2] == approx(L, abs=1e-9)
    assert tributary_areas(mesh, "-z").sum() == approx(math.pi * R**2, rel=2e-3)


def test_the_axial_mode_of_a_round_bar_is_below_bar_theory_by_rayleighs_correction() -> None:
    # f = f0 (1 - (n pi nu a/L)^2/4): lateral inertia of a slender bar.
    mesh = generate_mesh(cylinder(radius=0.004, length=0.08), element_size=0.006)
    model = Model(
        mesh=mesh, media={"cylinder": isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.3, density=7900.0)}
    )
    found = natural_modes(model, count=12).elastic_frequency
    expected = math.sqrt(200e9 / 7900) / 0.16 * (1 - (math.pi * 0.3 * 0.05) ** 2 / 4)
    assert np.abs(found / expected - 1).min() < 2e-4


def test_a_coarse_mesh_of_a_fillet_has_no_tangled_element() -> None:
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
        same(mesh.nodes, first.nodes)
        assert np.array_equal(mesh.elements, first.elements)
        same(change_order(mesh, order=4).nodes, change_order(first, order=4).nodes)


@pytest.mark.parametrize(
    ("corners", "message"),
    [
        ([(0, 0), (20, 20), (20, 0), (0, 20)], "must be one closed body with a volume"),  # both halves cancel
        ([(0, 0), (30, 20), (30, 0), (0, 10)], "is it open, or does it cut itself.*more elements on face"),
    ],
)
def test_a_prism_with_crossing_sides_is_refused_without_output_of_the_kernel(
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


def test_a_coarse_mesh_of_a_slender_bar_has_no_tangled_element_at_any_order() -> None:
    # Straightening folds a neighbour here, again and again, before all elements are right.
    mesh = generate_mesh(cylinder(radius=0.006, length=0.125), element_size=0.02)
    media = {"cylinder": isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.3, density=7900.0)}
    for order in (2, 5):
        assert assemble_matrices(Model(mesh=change_order(mesh, order=order), media=media)).mass.sum() > 0
