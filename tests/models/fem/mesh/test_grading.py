"""Grading towards re-entrant edges: mass, areas and frequencies of the graded body."""

import numpy as np
import pytest
from pytest import approx

from sonolube.models.fem import Mesh, Model, box_mesh, change_order, isotropic_medium, natural_modes
from sonolube.models.fem.mesh.grading import grade_reentrant_edges
from sonolube.models.fem.solver.assembly import assemble_matrices, tributary_areas

STEEL = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.29, density=7900.0)


def l_shaped() -> Mesh:
    """A bar with a quarter cut away, whose corner re-enters along z."""
    box = box_mesh(length=0.04, width=0.04, thickness=0.01, divisions=(2, 2, 1))
    centre = box.nodes[box.elements[:, :4]].mean(axis=1)
    kept = box.elements[(centre[:, 0] < 0) | (centre[:, 1] < 0)]
    used, elements = np.unique(kept, return_inverse=True)
    faces = {
        name: np.searchsorted(used, own[np.isin(own, used).all(axis=1)])
        for name, own in box.faces.items()
        if name in ("-x", "-y", "-z")
    }
    return Mesh(
        nodes=box.nodes[used],
        elements=elements.reshape(kept.shape),
        region_of_element=np.zeros(len(kept), dtype=np.int64),
        regions=("block",),
        faces=faces,
    )


@pytest.mark.parametrize("levels", [1, 2, 3])
def test_grading_conserves_the_body_and_lowers_its_frequencies(levels: int) -> None:
    coarse = l_shaped()
    fine = grade_reentrant_edges(coarse, levels=levels)
    assert len(fine.elements) > 2 * len(coarse.elements)
    assert assemble_matrices(Model(mesh=fine, media={"block": STEEL})).mass.sum() / 3 == approx(7900.0 * 1.2e-5)
    assert tributary_areas(fine, "-x").sum() == approx(4e-4)
    assert tributary_areas(fine, "-z").sum() == approx(1.2e-3)
    assert fine.face_nodes("-z").size > coarse.face_nodes("-z").size
    before, after = (
        natural_modes(Model(mesh=change_order(mesh, order=3), media={"block": STEEL}), count=6).elastic_frequency
        for mesh in (coarse, fine)
    )
    assert np.all(after < before)  # the finer space holds the coarser one


def test_a_convex_body_is_not_graded() -> None:
    mesh = box_mesh(length=0.03, width=0.02, thickness=0.01, divisions=(3, 2, 1))
    assert grade_reentrant_edges(mesh, levels=2) is mesh
