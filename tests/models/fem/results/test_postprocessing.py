"""Fields at points and stresses against fields in closed form."""

import numpy as np
from numpy.typing import NDArray
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.models.fem import (
    Model,
    box_mesh,
    gauss_point_stress,
    interpolate_at_points,
    isotropic_medium,
    nodal_stress,
    von_mises_stress,
)

E, NU, RHO = 200e9, 0.3, 8000.0

STEEL = isotropic_medium(youngs_modulus=E, poisson_ratio=NU, density=RHO)

MESH = box_mesh(length=0.1, width=0.02, thickness=0.02, divisions=(4, 1, 1))


def test_a_quadratic_field_is_interpolated_exactly() -> None:
    def field(points: NDArray[np.float64]) -> NDArray[np.float64]:
        x, y, z = points.T
        return np.stack([x**2 - y * z, 3 * x * y + 1, z**2 + x], axis=-1)

    points = np.random.default_rng(1).uniform([-0.05, -0.01, -0.01], [0.05, 0.01, 0.01], (50, 3))
    points = np.vstack([points, [0.05, 0.01, -0.01]])
    assert interpolate_at_points(MESH, field(MESH.nodes), points=points) == approx(field(points), abs=1e-12)
    with raises(InvalidInput, match="outside the body"):
        interpolate_at_points(MESH, field(MESH.nodes), points=[[0.2, 0.0, 0.0]])


def test_a_pulled_bar_is_in_uniaxial_stress_and_a_sheared_one_in_pure_shear() -> None:
    model = Model(mesh=MESH, media={"block": STEEL})
    pulled = MESH.nodes * [1e-3, -NU * 1e-3, -NU * 1e-3]
    stress = gauss_point_stress(model, pulled)
    assert stress[..., 0] == approx(E * 1e-3)
    assert stress[..., 1:] == approx(0.0, abs=1e-4 * E * 1e-3)
    assert von_mises_stress(stress) == approx(E * 1e-3)
    sheared = np.zeros_like(MESH.nodes)
    sheared[:, 0] = 2e-3 * MESH.nodes[:, 1]
    assert von_mises_stress(gauss_point_stress(model, sheared)) == approx(np.sqrt(3) * 2e-3 * E / (2 * (1 + NU)))


def test_a_bent_bar_has_its_greatest_stress_on_its_surface() -> None:
    # Pure bending of curvature c: stress E c z along x, greatest at half the thickness, zero otherwise (Saint-Venant).
    model, curvature = Model(mesh=MESH, media={"block": STEEL}), 0.1
    x, y, z = MESH.nodes.T
    bent = curvature * np.stack([x * z, -NU * y * z, -(x**2 + NU * (z**2 - y**2)) / 2], axis=1)
    assert nodal_stress(model, bent) == approx(E * curvature * np.abs(z), abs=1e-9 * E)
    assert von_mises_stress(gauss_point_stress(model, bent)).max() < 0.95 * nodal_stress(model, bent).max()
