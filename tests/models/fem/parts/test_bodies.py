"""Parametric bodies against the volumes of geometry."""

import math

import pytest
from pytest import approx

pytest.importorskip("netgen.occ", reason="netgen-mesher is not installed")

from sonolube.models.fem import (
    Geometry,
    Slot,
    block,
    booster,
    conical_horn,
    cylinder,
    exponential_horn,
    generate_mesh,
    hexagon,
    ring,
    stepped_horn,
)
from sonolube.models.fem.solver.assembly import tributary_areas

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


def test_rounded_edges_reduce_the_volume_and_the_flat_faces() -> None:
    sharp, round_ = (block(length=0.06, width=0.04, thickness=0.03, edge_radius=e) for e in (0.0, 0.006))
    assert 0.93 * sharp.volume < round_.volume < 0.99 * sharp.volume
    mesh = generate_mesh(round_, element_size=0.012)
    assert tributary_areas(mesh, "+z").sum() == approx(0.048 * 0.028, rel=1e-6)
