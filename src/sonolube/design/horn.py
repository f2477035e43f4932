"""Horns tuned to a frequency, and what a designer asks of them: neighbours, face, gain, node, stress and trim."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from sonolube.checks import Floats
from sonolube.design.horn_shapes import Body
from sonolube.errors import InvalidInput
from sonolube.fem import (
    Medium,
    Model,
    NamedMode,
    TunedMode,
    face_residual_compliance,
    generate_mesh,
    mass_loaded_frequencies,
    mode_names,
    tuned_mode,
)
from sonolube.fem.solver.element_order import change_order
from sonolube.fem.solver.model import DIRECTIONS
from sonolube.fem.solver.modes import lanczos_modes, spectral_shift
from sonolube.fem.solver.postprocessing import gauss_point_stress, nodal_average, von_mises_stress
from sonolube.fem.solver.simplex import shape_functions, simplex_quadrature
from sonolube.fem.solver.system import assemble_system, shift_invert_solver
from sonolube.materials import Material

_ELEMENTS_ACROSS = 2.5  # of a horn as thick as a cube of its volume would be, in the first mesh
_SLICES = 48  # across the axis, over which motion is averaged


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class HornDesign:
    """A tuned horn.

    Parameters
    ----------
    body : Body
    tuned : TunedMode
        Its length, frequency and mode.
    displacement_gain : float
        Mean displacement of the working face over that of the driven one. []
    face_uniformity : float
        Least over greatest displacement along the axis on the working face; negative where parts move against. []
    face_asymmetry : float
        What a plane through these displacements rises over the face, over its mean. []
    node_position : float
        Where sections stand still, from the driven face. [m]
    stress_per_displacement : float
        Greatest equivalent stress per displacement of the working face. [Pa/m]
    stress_change : float
        Relative change of it from elements of one order less: large where corners are sharp, and then it has no limit.
    residual_compliance : float
        Displacement per force of the working face by modes above those found. [m/N]
    neighbours : tuple of (str, float)
        Name and frequency in Hz of the elastic modes found, the tuned one left out, by distance.
    """

    body: Body
    tuned: TunedMode
    displacement_gain: float
    face_uniformity: float
    face_asymmetry: float
    node_position: float
    stress_per_displacement: float
    stress_change: float
    residual_compliance: float
    neighbours: tuple[tuple[str, float], ...] = field(default=())

    @property
    def working_face(self) -> str:
        """Name of the face that works."""
        return f"+{self.body.axis}"


def designed_horn(
    body: Body,
    *,
    medium: Medium,
    frequency: float,
    mode: str = "axial 1",
    relative_tolerance: float = 3e-3,
    advance: Callable[[str, int, int], None] | None = None,
) -> HornDesign:
    """Return a horn whose length is tuned so that a named mode has a frequency.

    Parameters
    ----------
    body : Body
    medium : Medium
        What it is made of.
    frequency : float
        Frequency at which it shall ring. [Hz]
    mode : str
        Name of the mode.
    relative_tolerance : float
        Largest estimated relative error of the frequency.
    advance : callable, optional
        Told what is being done.

    Returns
    -------
    HornDesign

    Raises
    ------
    InvalidInput
        If no mode has this name or the body lacks a flat working or driven face.
    NotConverged
        If no length near the start gives the frequency.
    """

    def model_at(length: float, element_size: float) -> Model:
        geometry = body.at(length)
        return Model(mesh=generate_mesh(geometry, element_size=element_size), media={geometry.regions[0]: medium})

    tuned = tuned_mode(
        model_at,
        name=mode,
        axis=body.axis,
        frequency=frequency,
        length=body.length,
        element_size=float(body.at(body.length).volume ** (1 / 3) / _ELEMENTS_ACROSS),
        relative_tolerance=relative_tolerance,
        advance=advance,
    )
    found = tuned.mode
    peak = _peak_stress(found.model, found.displacement, body.axis)
    change, compliance = _of_one_order_less(found, mode, body.axis, peak)
    return HornDesign(
        body=body,
        tuned=tuned,
        displacement_gain=abs(
            float(face_motion(found.model, found.displacement, f"+{body.axis}", body.axis).mean())
            / float(face_motion(found.model, found.displacement, f"-{body.axis}", body.axis).mean())
        ),
        face_uniformity=_uniformity(face_motion(found.model, found.displacement, f"+{body.axis}", body.axis)),
        face_asymmetry=_asymmetry(found, body.axis),
        node_position=_node(found, body.axis),
        stress_per_displacement=peak,
        stress_change=change,
        residual_compliance=compliance,
        neighbours=_neighbours(found),
    )


def amplitude_limits(design: HornDesign, *, material: Material) -> dict[str, float]:
    """Return the amplitude of the working face in m at which the peak stress reaches each known strength.

    Parameters
    ----------
    design : HornDesign
    material : Material

    Returns
    -------
    dict of str to float
        By "fatigue_strength" and "yield_strength", where the material has them.
    """
    return {
        name: material.value(name) / design.stress_per_displacement
        for name in ("fatigue_strength", "yield_strength")
        if name in material.properties
    }


def loaded_frequency(design: HornDesign, *, tool_mass: float) -> float:
    """Return the frequency of the tuned mode with a rigid tool on the working face. [Hz]

    Parameters
    ----------
    design : HornDesign
    tool_mass : float
        Its mass. [kg]

    Returns
    -------
    float
    """
    found = design.tuned.mode
    loaded = mass_loaded_frequencies(
        found.modes,
        found.model,
        face=design.working_face,
        along=design.body.axis,
        tool_mass=tool_mass,
        residual_compliance=design.residual_compliance,
    )
    own = found.modes.natural_frequency[found.row]
    return float(loaded[found.row] / own * found.frequency)  # with the error of the mesh taken out


def face_motion(model: Model, shape: Floats, face: str, axis: str) -> Floats:
    """Return displacements along an axis of the nodes on a face.

    Parameters
    ----------
    model : Model
    shape : ndarray, shape (n, 3)
    face : str
    axis : str

    Returns
    -------
    ndarray, shape (nodes of the face,)
    """
    return np.asarray(shape[model.mesh.face_nodes(face), DIRECTIONS.index(axis)])


def nodal_stress(model: Model, shape: Floats) -> Floats:
    """Return the equivalent stress at the nodes, averaged over the elements that meet there.

    Parameters
    ----------
    model : Model
    shape : ndarray, shape (n, 3)

    Returns
    -------
    ndarray, shape (n,)
        In Pa for displacements in m.
    """
    at_corners = gauss_point_stress(model, shape)
    return von_mises_stress(
        np.stack([nodal_average(model.mesh, at_corners[:, :, component]) for component in range(6)], axis=-1)
    )


def _peak_stress(model: Model, shape: Floats, axis: str) -> float:
    return float(nodal_stress(model, shape).max() / abs(face_motion(model, shape, f"+{axis}", axis).mean()))


def _of_one_order_less(found: NamedMode, name: str, axis: str, peak: float) -> tuple[float, float]:
    """Return by how much the peak stress differs on elements of one order less, and what modes above yield there."""
    model = replace(found.model, mesh=change_order(found.model.mesh, order=found.model.mesh.order - 1))
    equations = assemble_system(model)
    inverse = shift_invert_solver(model, equations, shift=spectral_shift(model))
    modes = lanczos_modes(model, equations, inverse=inverse, count=len(found.names) - found.modes.rigid_body_count)
    compliance = face_residual_compliance(modes, model, equations, inverse=inverse, face=f"+{axis}", along=axis)
    names = mode_names(model, modes, axis=axis)
    if name not in names:
        return np.inf, compliance
    return abs(_peak_stress(model, modes.shapes[names.index(name)], axis) / peak - 1), compliance


def _uniformity(moves: Floats) -> float:
    ordered = moves * np.sign(moves.mean())
    return float(ordered.min() / ordered.max())


def _asymmetry(found: NamedMode, axis: str) -> float:
    nodes = found.model.mesh.face_nodes(f"+{axis}")
    across = found.model.mesh.nodes[nodes][:, [k for k in range(3) if k != DIRECTIONS.index(axis)]]
    columns = np.column_stack([np.ones(len(nodes)), across - across.mean(axis=0)])
    plane = np.linalg.lstsq(columns, found.displacement[nodes, DIRECTIONS.index(axis)], rcond=None)[0]
    return float(np.ptp(columns[:, 1:] @ plane[1:]) / abs(plane[0]))


def _node(found: NamedMode, axis: str) -> float:
    """Return where the mean motion of sections changes sign for the first time."""
    place, moves = section_motion(found, axis)
    turn = np.flatnonzero(np.diff(np.sign(moves)))
    if not turn.size:
        raise InvalidInput("no section of this mode stands still; is it an axial mode?")
    k = int(turn[0])
    start = float(found.model.mesh.nodes[:, DIRECTIONS.index(axis)].min())
    return float(place[k] - moves[k] * (place[k + 1] - place[k]) / (moves[k + 1] - moves[k])) - start


def section_motion(found: NamedMode, axis: str) -> tuple[Floats, Floats]:
    """Return places along an axis in m and the mean motion along it there.

    Parameters
    ----------
    found : NamedMode
    axis : str

    Returns
    -------
    tuple of two ndarray
        Means over the volume of each slice.
    """
    mesh, along = found.model.mesh, DIRECTIONS.index(axis)
    points, weights = simplex_quadrature(2 * mesh.order, corners=4)
    value, slope = shape_functions(mesh.order, points)
    volume = np.linalg.det(np.einsum("eax,adq->eqdx", mesh.nodes[mesh.elements], slope, optimize=True)) * weights
    place, moves = (own[mesh.elements, along] @ value for own in (mesh.nodes, found.displacement))
    edges = np.linspace(place.min(), place.max(), _SLICES + 1)
    which = np.clip(np.digitize(place, edges) - 1, 0, _SLICES - 1).ravel()
    filled = np.bincount(which, volume.ravel(), minlength=_SLICES)
    means = [np.bincount(which, (own * volume).ravel(), minlength=_SLICES)[filled > 0] for own in (place, moves)]
    return means[0] / filled[filled > 0], means[1] / filled[filled > 0]


def _neighbours(found: NamedMode) -> tuple[tuple[str, float], ...]:
    elastic = range(found.modes.rigid_body_count, len(found.names))
    others = [(found.names[k], float(found.modes.natural_frequency[k])) for k in elastic if k != found.row]
    return tuple(sorted(others, key=lambda mode: abs(mode[1] - found.frequency)))
