"""Modes on surfaces: nodal planes and ends of bars with closed forms, and the volume that the surface encloses."""

import numpy as np
import pytest
from pytest import approx

from sonolube.facts.materials import material
from sonolube.models.fem import Model, isotropic_medium, medium_from_material, nodal_stress
from sonolube.models.fem.mesh.mesh import box_mesh
from sonolube.models.fem.results.mode_surfaces import SurfaceModes, surface_modes
from sonolube.models.fem.results.sections import mode_section_motion

LENGTH, WIDTH = 0.2, 0.01
BAR = box_mesh(length=LENGTH, width=WIDTH, thickness=WIDTH, divisions=(12, 1, 1))
STEEL = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.3, density=7900.0)
FREE_BEAM = 4.730040745  # first root of cos x cosh x = 1
NODE_OF_BEAM = 0.2241577  # of its length, of the first bending mode of a free beam


def along(values: np.ndarray, component: int) -> np.ndarray:
    """Displacement of the nodes in one direction."""
    shape = np.zeros_like(BAR.nodes)
    shape[:, component] = values
    return shape


def modes() -> SurfaceModes:
    """Axial, bending and torsional mode of a free bar by their closed forms."""
    x = BAR.nodes[:, 0] / LENGTH + 0.5
    ratio = (np.cosh(FREE_BEAM) - np.cos(FREE_BEAM)) / (np.sinh(FREE_BEAM) - np.sin(FREE_BEAM))
    s = FREE_BEAM * x
    deflection = np.cosh(s) + np.cos(s) - ratio * (np.sinh(s) + np.sin(s))
    turn = np.cross([1.0, 0.0, 0.0], BAR.nodes) * np.cos(2 * np.pi * x)[:, np.newaxis]
    shapes = np.stack([along(3e-6 * np.cos(np.pi * x), 0), along(deflection, 1) + along(deflection, 2), turn])
    names = [("axial 1", "12.6 kHz"), ("bending 1", "1 kHz"), ("torsional 2", "16 kHz")]
    return surface_modes(Model(mesh=BAR, media={"block": STEEL}), shapes, frequencies=names, axis="x")


def test_nodal_planes_of_a_bar_lie_where_theory_has_them() -> None:
    axial, bending, torsional = (mode.motion for mode in modes().modes)
    assert axial is not None
    assert bending is not None
    assert torsional is not None
    assert axial.nodal_planes == approx([LENGTH / 2], rel=1e-6)
    assert bending.nodal_planes == approx([NODE_OF_BEAM * LENGTH, (1 - NODE_OF_BEAM) * LENGTH], rel=2e-3)
    assert torsional.nodal_planes == approx([LENGTH / 4, 3 * LENGTH / 4], rel=5e-3)
    assert [each.end_ratio for each in (axial, bending, torsional)] == approx([1.0, 1.0, 1.0], rel=1e-6)


def test_a_mode_of_no_family_has_no_nodal_planes_and_an_end_at_rest_no_ratio() -> None:
    shape = along(BAR.nodes[:, 0] - BAR.nodes[:, 0].min(), 0)
    assert mode_section_motion(BAR, shape, axis="x", family="breathing") is None
    held = mode_section_motion(BAR, shape, axis="x", family="axial")
    assert held is not None
    assert (held.end_ratio, held.nodal_planes) == (None, ())


def test_the_surface_encloses_the_body() -> None:
    # Divergence theorem: a third of the flux of the position through the triangles, seen from within, is the volume.
    found = modes()
    corners = found.points[found.triangles]
    assert np.abs(np.linalg.det(corners)).sum() / 6 == approx(LENGTH * WIDTH**2, rel=1e-12)


def test_displacement_and_stress_are_stated_over_the_largest_displacement() -> None:
    axial = modes().modes[0]
    assert np.linalg.norm(axial.shape, axis=1).max() == approx(1.0)
    assert axial.stress is not None
    # E k of a bar that moves along itself alone, whose stress has the lateral constraint of its strain: (1 - 2v) of it
    slope, share = np.pi / LENGTH, 200e9 / (1 + 0.3)
    assert axial.stress.max() == approx(share * slope, rel=2e-2)


def test_the_peak_stress_of_a_half_wave_bar_is_that_of_theory() -> None:
    pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")
    from sonolube.models.fem import cylinder, generate_mesh, mode_names, natural_modes

    length, solid = 0.127, material("titanium_6al4v")
    geometry = cylinder(radius=0.006, length=length)
    mesh = generate_mesh(geometry, element_size=0.008)
    model = Model(mesh=mesh, media={geometry.regions[0]: medium_from_material(solid)})
    found = natural_modes(model, count=8)
    shape = found.shapes[mode_names(model, found, axis="z").index("axial 1")]
    tip = abs(shape[mesh.face_nodes("+z"), 2].mean())
    assert nodal_stress(model, shape).max() / tip == approx(solid.value("youngs_modulus") * np.pi / length, rel=0.02)
