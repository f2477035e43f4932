"""Forced response against rods, rigid bodies and symmetry."""

import numpy as np
import pytest
from pytest import approx, raises

from sonolube.errors import InvalidInput
from sonolube.facts.materials import piezo_ceramic
from sonolube.models.fem import (
    Electrodes,
    FixedSupport,
    Medium,
    Model,
    Output,
    box_mesh,
    edge_nodes,
    forced_response,
    isotropic_medium,
    natural_modes,
    poled_medium,
)

L, W = 0.1, 0.02

PULL = Output(face="+x", along="x")


def steel(elastic_loss: float = 0.0) -> Medium:
    return isotropic_medium(youngs_modulus=200e9, poisson_ratio=0.29, density=7900.0, elastic_loss=elastic_loss)


def rod(medium: Medium, *, cells: int = 20, held: tuple[FixedSupport, ...] = ()) -> Model:
    """A rod without lateral motion, in which waves are one-dimensional."""
    mesh = box_mesh(length=L, width=W, thickness=W, divisions=(cells, 1, 1))
    return Model(mesh=mesh, media={"block": medium}, fixed=(FixedSupport(face=None, along="yz"), *held))


def test_a_static_force_stretches_a_rod_by_force_over_stiffness() -> None:
    medium = steel()
    pulled = forced_response(rod(medium, held=(FixedSupport(face="-x", along="x"),)), load=PULL, frequency=0.0)
    end = pulled[np.isclose(rod(medium).mesh.nodes[:, 0], L / 2), 0]
    assert end == approx(L / (medium.elastic_stiffness[0, 0] * W**2), rel=1e-9)


@pytest.mark.parametrize("frequency", [10e3, 29e3, 45e3])
def test_a_lossy_rod_driven_at_its_end_satisfies_the_wave_equation(frequency: float) -> None:
    medium = steel(elastic_loss=0.02)
    model = rod(medium)
    modulus = medium.elastic_stiffness[0, 0] * (1 + 0.02j)
    k = 2 * np.pi * frequency * np.sqrt(medium.density / modulus)
    x = model.mesh.nodes[:, 0]
    exact = -np.cos(k * (x + L / 2)) / (k * modulus * W**2 * np.sin(k * L))
    assert (
        np.abs(forced_response(model, load=PULL, frequency=frequency)[:, 0] - exact).max() < 2e-3 * np.abs(exact).max()
    )


def test_far_below_resonance_a_free_body_responds_as_a_rigid_mass() -> None:
    mesh = box_mesh(length=L, width=W, thickness=W, divisions=(4, 2, 2))
    moves = forced_response(Model(mesh=mesh, media={"block": steel()}), load=PULL, frequency=10.0)
    mass = 7900.0 * L * W**2
    assert moves[:, 0] == approx(np.full(mesh.node_count, -1 / ((2 * np.pi * 10.0) ** 2 * mass)), rel=1e-3)


def test_a_symmetric_force_on_a_symmetric_block_gives_symmetric_motion() -> None:
    mesh = box_mesh(length=0.127, width=0.06096, thickness=0.0254, divisions=(12, 4, 4))
    model = Model(mesh=mesh, media={"block": steel(elastic_loss=0.01)})
    stretched = forced_response(model, load=PULL, frequency=18e3)
    stretched = stretched - forced_response(model, load=Output(face="-x", along="x"), frequency=18e3)
    line = np.flatnonzero(np.isclose(mesh.nodes[:, 2], -0.0127) & np.isclose(mesh.nodes[:, 1], 0.0, atol=1e-9))
    line = line[np.argsort(mesh.nodes[line, 0])]
    axial, normal = stretched[line, 0], stretched[line, 2]
    assert np.abs(axial + axial[::-1]).max() < 2e-3 * np.abs(axial).max()
    assert np.abs(normal - normal[::-1]).max() < 1e-2 * np.abs(normal).max()  # the mesh has not the body's symmetry
    assert np.abs(axial[len(line) // 2]) < 2e-3 * np.abs(axial).max()


def test_the_lateral_motion_of_a_thin_bar_is_that_of_bar_theory() -> None:
    # B/A = pi nu D/(2 L), D 3.25, in the limit of a thin bar.
    length, thickness = 0.127, 0.004
    quarter = box_mesh(length=length, width=thickness / 2, thickness=thickness / 2, divisions=(24, 2, 2))
    held = (FixedSupport(face="-y", along="y"), FixedSupport(face="+z", along="z"))
    modes = natural_modes(Model(mesh=quarter, media={"block": steel()}, fixed=held), count=3)
    axial = np.argmax(np.abs(modes.shapes[modes.rigid_body_count :, :, 0]).mean(axis=1))
    shape = modes.shapes[modes.rigid_body_count + axial]
    line = edge_nodes(quarter, "-z", "-y", along="x")
    bulge = abs(shape[line[len(line) // 2], 2] / shape[line[-1], 0])
    assert bulge == approx(np.pi * 0.29 * thickness / (2 * length), rel=3e-3)


def test_a_static_force_on_a_free_body_is_refused() -> None:
    mesh = box_mesh(length=L, width=W, thickness=W, divisions=(2, 1, 1))
    with raises(InvalidInput, match="a static force needs a fully supported body; 6 rigid-body modes are free"):
        forced_response(Model(mesh=mesh, media={"block": steel()}), load=PULL, frequency=0.0)


def test_a_force_on_a_piezoelectric_body_is_refused() -> None:
    mesh = box_mesh(length=L, width=W, thickness=W, divisions=(2, 1, 1))
    ceramic = poled_medium(piezo_ceramic("pzt4"), along=(0.0, 0.0, 1.0))
    model = Model(mesh=mesh, media={"block": ceramic}, electrodes=Electrodes(driven=("+z",), grounded=("-z",)))
    with raises(InvalidInput, match="drive it by a voltage"):
        forced_response(model, load=PULL, frequency=1e3)
