"""Sensitivity of the Poisson horn to single assumptions: first axial frequency and node of the axial motion."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from typing import Final

import numpy as np

from sonolube.models.fem import FaceSpring, Model
from sonolube.reproduction.chapter2.horn_bending import PAD_STIFFNESS
from sonolube.reproduction.chapter2.horn_friction import driven_face
from sonolube.reproduction.chapter2.poisson_horn import (
    ASSUMED_SOLIDS,
    INCH,
    AxialMode,
    HornShape,
    HornSolid,
    assumed_shape,
    axial_mode,
    axial_mode_of,
    horn_model,
    node_position,
    printed_shape,
    printed_solid,
)

_TIP_MASS: Final = 0.02  # kg, about that of a steel stud of 1/2 in
_WEDGE: Final = 0.1


@cache
def frequency_changes() -> dict[str, float]:
    """Relative changes of the first axial frequency of the plain steel block by single assumptions. []

    By the assumption in words.
    """
    solid = printed_solid("steel")
    plain = axial_mode(printed_shape(), solid).natural_frequency
    return {assumption: frequency / plain - 1 for assumption, frequency in _varied(printed_shape(), solid)}


def _varied(shape: HornShape, solid: HornSolid) -> Iterator[tuple[str, float]]:
    """Yield assumptions with the first axial frequency of a horn that differs in each alone. [Hz]"""

    def of(shape: HornShape = shape, solid: HornSolid = solid) -> float:
        return axial_mode(shape, solid).natural_frequency

    yield "ends tapered to 3/4 in over 1 in", of(replace(shape, end_thickness_ratio=0.75))
    yield "the same over 1/2 in", of(replace(shape, end_thickness_ratio=0.75, taper_length=INCH / 2))
    yield "ends tapered to 1/2 in over 1 in", of(replace(shape, end_thickness_ratio=0.5))
    yield "one end 10 % wider than the other", of(replace(shape, wedge=_WEDGE))
    yield "1 % shorter", of(replace(shape, length=0.99 * shape.length))
    yield "10 % narrower", of(replace(shape, width=0.9 * shape.width))
    yield "10 % thinner", of(replace(shape, thickness=0.9 * shape.thickness))
    yield "Poisson's ratio 0.01 lower", of(solid=replace(solid, poisson_ratio=solid.poisson_ratio - 0.01))
    yield "Young's modulus 2.5 % higher", of(solid=replace(solid, youngs_modulus=1.025 * solid.youngs_modulus))
    yield "density 7850 kg/m³", of(solid=replace(solid, density=7850.0))
    yield ("two pads of 10⁸ N/m on either face", axial_mode_of(_on_pads(horn_model(shape, solid))).natural_frequency)
    yield ("20 g on one end", axial_mode_of(with_tip(horn_model(shape, solid), tip_mass=_TIP_MASS)).natural_frequency)


@cache
def node_positions() -> dict[str, float]:
    """Nodes of the axial motion of the steel horn of the printed frequency under single asymmetries. [m]

    Position from the centre, by the asymmetry in words.
    """
    return dict(_asymmetric())


def _asymmetric() -> Iterator[tuple[str, float]]:
    """Yield asymmetries with the position of the node under each alone. [m]"""
    shape, solid = assumed_shape(), ASSUMED_SOLIDS["steel"]
    resonance = axial_mode(shape, solid).natural_frequency

    def driven(frequency: float, elastic_loss: float) -> float:
        motion = driven_face("steel", frequency=frequency, elastic_loss=elastic_loss)
        return node_position(position=motion.position, axial=motion.axial.real)

    def free(mode: AxialMode) -> float:
        return node_position(position=mode.position, axial=mode.axial)

    yield "driven at its own 20.8 kHz", driven(resonance, 1e-3)
    yield "the same, loss factor 0.04", driven(resonance, 0.04)
    yield "driven at 20.0 kHz", driven(20.0e3, 1e-3)
    yield "driven at 19.6 kHz", driven(19.6e3, 1e-3)
    yield "right end 10 % wider than left", free(axial_mode(replace(shape, wedge=_WEDGE), solid))
    yield ("20 g on the right end", free(axial_mode_of(with_tip(horn_model(shape, solid), tip_mass=_TIP_MASS))))


def with_tip(model: Model, *, tip_mass: float) -> Model:
    """Model of a horn with a mass on its right end, distributed over the last layer of elements."""
    mesh, medium = model.mesh, model.media["block"]
    corners = mesh.nodes[mesh.elements[:, :4]]
    last = corners[:, :, 0].mean(axis=1) > np.unique(mesh.nodes[:, 0].round(9))[-3]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    layer = replace(medium, density=medium.density + tip_mass / 4 / float(volumes[last].sum()))
    return replace(
        model,
        mesh=replace(mesh, region_of_element=last.astype(np.int64), regions=("block", "tip")),
        media={"block": medium, "tip": layer},
    )


def _on_pads(model: Model) -> Model:
    """Model of a horn on two pads on either face."""
    spring = FaceSpring(face="-z", spring_stiffness=2 * PAD_STIFFNESS / 2, along=(0.0, 0.0, 1.0))
    return replace(model, springs=(spring,))
