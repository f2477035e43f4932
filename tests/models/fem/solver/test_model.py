"""Models: impossible meshes, media and supports."""

from pytest import raises

from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.fem import FixedSupport, Mesh, Model, box_mesh, isotropic_medium, natural_modes

STEEL = isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.29, density=7900.0)

BLOCK = {"length": 0.127, "width": 0.06096, "thickness": 0.0254}


def test_impossible_models_are_refused_by_name() -> None:
    mesh = box_mesh(**BLOCK, divisions=(1, 1, 1))
    with raises(InvalidInput, match=r"thickness must be positive, got 0\.0 m"):
        box_mesh(length=1.0, width=1.0, thickness=0.0, divisions=(1, 1, 1))
    with raises(InvalidInput, match="regions without a medium: block"):
        Model(mesh=mesh, media={})
    with raises(UnknownName, match="unknown face 'x'"):
        Model(mesh=mesh, media={"block": STEEL}, fixed=(FixedSupport(face="x"),))
    with raises(InvalidInput, match="letters of 'xyz'"):
        FixedSupport(face="-x", along="u")
    with raises(InvalidInput, match="no degree of freedom is free"):
        natural_modes(Model(mesh=mesh, media={"block": STEEL}, fixed=(FixedSupport(face=None),)), count=1)
    with raises(InvalidInput, match="count must be from 1 to 73 on this mesh, got 100"):
        natural_modes(Model(mesh=mesh, media={"block": STEEL}), count=100)
    with raises(InvalidInput, match="flat or turned inside out"):
        Mesh(
            nodes=mesh.nodes * [1, 1, 0],
            elements=mesh.elements,
            region_of_element=mesh.region_of_element,
            regions=mesh.regions,
            faces=mesh.faces,
        )
