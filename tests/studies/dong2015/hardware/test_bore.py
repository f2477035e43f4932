"""Motion of the bore of a thin ring against ring theory."""

from dataclasses import replace

import numpy as np
import pytest
from pytest import approx

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from dong2015.hardware.collar_analysis import BoreMotion, bore_motion
from sonolube.models.fem import Model, generate_mesh, isotropic_medium, natural_modes, ring

STEEL = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.29, density=8000.0)


def test_a_thin_ring_breathes_at_the_speed_of_sound_over_its_circumference() -> None:
    mesh = generate_mesh(ring(outer_radius=22e-3, inner_radius=18e-3, length=4e-3), element_size=5e-3)
    modes = natural_modes(Model(mesh=mesh, media={"ring": STEEL}), count=30)
    inside = np.flatnonzero(np.hypot(*mesh.nodes.T[:2]) < 18.5e-3)
    on_bore = np.isin(mesh.faces["side"], inside).all(axis=1)
    bored = replace(mesh, faces={**mesh.faces, "bore": mesh.faces["side"][on_bore]})
    shares, _ = bore_motion(bored, modes.shapes, faces=("bore",), centre=(0.0, 0.0), odd_across=False)
    best = int(np.argmax(shares[BoreMotion.BREATHING]))
    assert shares[BoreMotion.BREATHING][best] > 0.99
    assert modes.natural_frequency[best] == approx(np.sqrt(200e9 / 8000.0) / (2 * np.pi * 20e-3), rel=0.01)
