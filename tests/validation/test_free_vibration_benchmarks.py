"""Free vibration of solids: NAFEMS FV41, and a measured aluminium parallelepiped.

NAFEMS, Selected Benchmarks for Natural Frequency Analysis (R0015), test FV41: free cylinder, axisymmetric vibration;
length 10 m, mean radius 2 m, thickness 0.4 m.
H. Ogi, K. Sato, T. Asada and M. Hirao, J. Acoust. Soc. Am. 112, 2553 (2002), doi:10.1121/1.1512700: measured resonances
of 11.92 x 10.93 x 9.86 mm of aluminium, its density and the stiffnesses found from them.
"""

from dataclasses import replace

import numpy as np
from pytest import approx
from tests.models.fem.ritz import rectangular_section, ritz_frequencies

from sonolube.models.fem import FaceSpring, FixedSupport, Medium, Model, box_mesh, isotropic_medium, natural_modes

FV41 = np.array([243.53, 377.41, 394.11, 397.72, 405.28])
OGI_MEASURED = 1e3 * np.array(
    [116.716, 143.783, 158.081, 166.5, 169.523, 177.846, 183.875, 186.047, 190.341, 197.386, 201.133, 207.386]
)
OGI_COMPUTED = 1e3 * np.array(
    [116.32, 143.186, 158.44, 166.113, 169.338, 178.36, 184.57, 185.078, 190.206, 197.692, 201.462, 207.096]
)

OGI_SIZES = (11.92e-3, 10.93e-3, 9.86e-3)


def aluminium_of_ogi() -> Medium:
    c11, c44 = 109.26e9, 26.72e9
    c12 = c11 - 2 * c44
    nu = c12 / (c11 + c12)
    return isotropic_medium(youngs_modulus=2 * c44 * (1 + nu), poisson_ratio=nu, density=2788.0)


def test_ritz_finds_the_resonances_of_ogis_parallelepiped() -> None:
    length, width, thickness = OGI_SIZES
    found = ritz_frequencies(
        rectangular_section(length=length, width=width, order=12), length=thickness, medium=aluminium_of_ogi(), order=12
    )[:12]
    assert found == approx(OGI_COMPUTED, rel=2e-3)
    assert found == approx(OGI_MEASURED, rel=6e-3)


def test_finite_elements_find_the_resonances_of_ogis_parallelepiped() -> None:
    length, width, thickness = OGI_SIZES
    mesh = box_mesh(length=length, width=width, thickness=thickness, divisions=(6, 6, 6))
    found = natural_modes(Model(mesh=mesh, media={"block": aluminium_of_ogi()}), count=12).elastic_frequency
    assert found == approx(OGI_COMPUTED, rel=4e-3)
    assert found == approx(OGI_MEASURED, rel=8e-3)


def test_the_free_cylinder_of_nafems_has_its_axisymmetric_frequencies() -> None:
    # A wedge of five degrees, cut from a bent block; both cuts glide on planes of symmetry, the second one on springs
    # a thousand times stiffer than the wedge.
    flat = box_mesh(length=0.4, width=1.0, thickness=10.0, divisions=(2, 1, 24))
    angle = np.radians(5.0) * (flat.nodes[:, 1] + 0.5)
    radius = 2.0 + flat.nodes[:, 0]
    mesh = replace(flat, nodes=np.stack([radius * np.cos(angle), radius * np.sin(angle), flat.nodes[:, 2]], axis=1))
    steel = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.3, density=8000.0)
    normal = (-np.sin(np.radians(5.0)), np.cos(np.radians(5.0)), 0.0)
    model = Model(
        mesh=mesh,
        media={"block": steel},
        fixed=(FixedSupport(face="-y", along="y"),),
        springs=(FaceSpring(face="+y", spring_stiffness=1e3 * 200e9 * 4.0 / 0.17, along=normal),),
    )
    modes = natural_modes(model, count=5)
    assert modes.rigid_body_count == 1
    assert modes.elastic_frequency == approx(FV41, rel=2e-3)
