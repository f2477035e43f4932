"""Ultrasonic horns tuned to a frequency by finite elements: gain, node, stress, modes, and their figure."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.interpolate import PchipInterpolator

from sonolube.charts import Axis, Band, Chart, Line, Panel, Rule
from sonolube.checks import Floats, require_positive
from sonolube.design.horns.shapes import TunableBody
from sonolube.errors import InvalidInput
from sonolube.facts.materials import Material
from sonolube.models.fem import (
    Geometry,
    Medium,
    Model,
    NamedMode,
    TunedMode,
    face_triangulation,
    generate_mesh,
    mode_names,
    tuned_mode,
)
from sonolube.models.fem.mesh.element_order import change_order
from sonolube.models.fem.mesh.mesh import DIRECTIONS
from sonolube.models.fem.mode_analysis import face_residual_compliance, mass_loaded_frequencies
from sonolube.models.fem.results.nodal_fields import nodal_stress
from sonolube.models.fem.results.sections import section_means, sign_changes
from sonolube.models.fem.solver.modes import lanczos_modes, spectral_shift
from sonolube.models.fem.solver.system import assemble_system, shift_invert_solver

_ELEMENTS_ACROSS = 2.5  # in the first mesh, over the edge of a cube with the volume of the horn


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class HornDesign:
    """Ultrasonic horn whose length has been tuned to a frequency, with the properties of the tuned mode.

    Parameters
    ----------
    body : TunableBody
    tuned : TunedMode
        Tuned length, frequency and mode.
    displacement_gain : float
        Mean axial displacement of the working face over that of the driven face. []
    face_uniformity : float
        Least over greatest axial displacement of the working face; negative where parts of it move in antiphase. []
    face_asymmetry : float
        Range over the working face of the plane fitted to the axial displacement, over its mean: tilt of the face. []
    node_position : float
        Distance of the displacement node from the driven face. [m]
    stress_per_displacement : float
        Greatest von Mises stress per displacement of the working face. [Pa/m]
    stress_change : float
        Relative change of that stress from elements of one order less; large at sharp re-entrant corners, where the
        stress does not converge.
    residual_compliance : float
        Residual compliance of the working face by the modes above those computed. [m/N]
    neighbours : tuple of (str, float)
        Name and frequency in Hz of the other elastic modes computed, by distance from the tuned one.

    See Also
    --------
    tuned_horn
    """

    body: TunableBody
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
        """Name of the working face."""
        return f"+{self.body.axis}"

    @property
    def total_length(self) -> float:
        """Distance from the driven to the working face. [m]"""
        return float(np.ptp(self.tuned.mode.model.mesh.nodes[:, DIRECTIONS.index(self.body.axis)]))

    @property
    def geometry(self) -> Geometry:
        """Solid of the tuned length."""
        return self.body.geometry_at(self.tuned.length)


def tuned_horn(
    body: TunableBody,
    *,
    medium: Medium,
    frequency: float,
    mode: str = "axial 1",
    relative_tolerance: float = 3e-3,
    advance: Callable[[str, int, int], None] | None = None,
) -> HornDesign:
    """Horn tuned by its length so that a named mode has a target frequency, by finite elements.

    See Also
    --------
    horn_body, body_from_geometry, amplitude_limits, loaded_frequency
    """
    require_positive(relative_tolerance=relative_tolerance)

    def model_at(length: float, element_size: float) -> Model:
        geometry = body.geometry_at(length)
        return Model(mesh=generate_mesh(geometry, element_size=element_size), media={geometry.regions[0]: medium})

    tuned = tuned_mode(
        model_at,
        name=mode,
        axis=body.axis,
        frequency=frequency,
        length=body.length,
        element_size=float(body.geometry_at(body.length).volume ** (1 / 3) / _ELEMENTS_ACROSS),
        relative_tolerance=relative_tolerance,
        advance=advance,
    )
    named = tuned.mode
    working = face_motion(named.model, named.displacement, f"+{body.axis}", body.axis)
    driven = face_motion(named.model, named.displacement, f"-{body.axis}", body.axis)
    peak = _peak_stress(named.model, named.displacement, body.axis)
    change, compliance = _lower_order_results(named, mode, body.axis, peak)
    return HornDesign(
        body=body,
        tuned=tuned,
        displacement_gain=abs(float(working.mean()) / float(driven.mean())),
        face_uniformity=_uniformity(working),
        face_asymmetry=_asymmetry(named, body.axis),
        node_position=_node(named, body.axis),
        stress_per_displacement=peak,
        stress_change=change,
        residual_compliance=compliance,
        neighbours=_neighbours(named),
    )


def amplitude_limits(design: HornDesign, *, material: Material) -> dict[str, float]:
    """Displacement amplitude of the working face in m at which the peak stress reaches each known strength.

    By "fatigue_strength" and "yield_strength", where the material has them.

    With the strength :math:`S` and the peak stress per displacement :math:`s`, as the model is linear,

    .. math:: a = S / s
    """
    return {
        name: material.value(name) / design.stress_per_displacement
        for name in ("fatigue_strength", "yield_strength")
        if name in material.properties
    }


def loaded_frequency(design: HornDesign, *, tool_mass: float) -> float:
    """Natural frequency of the tuned mode with a rigid tool on the working face. [Hz]"""
    mode = design.tuned.mode
    loaded = mass_loaded_frequencies(
        mode.modes,
        mode.model,
        face=design.working_face,
        along=design.body.axis,
        tool_mass=tool_mass,
        residual_compliance=design.residual_compliance,
    )
    own = mode.modes.natural_frequency[mode.row]
    return float(loaded[mode.row] / own * mode.frequency)  # the ratio cancels the discretisation error


def face_motion(model: Model, shape: Floats, face: str, axis: str) -> Floats:
    """Displacements along an axis at the nodes of a face.

    `shape` has shape (n, 3). Shape (nodes of the face,).
    """
    return np.asarray(shape[model.mesh.face_nodes(face), DIRECTIONS.index(axis)])


def _peak_stress(model: Model, shape: Floats, axis: str) -> float:
    """Greatest nodal von Mises stress per mean displacement of the working face, in Pa/m."""
    return float(nodal_stress(model, shape).max() / abs(face_motion(model, shape, f"+{axis}", axis).mean()))


def _lower_order_results(mode: NamedMode, name: str, axis: str, peak: float) -> tuple[float, float]:
    """Relative change of the peak stress and residual compliance, on elements of one order less."""
    model = replace(mode.model, mesh=change_order(mode.model.mesh, order=mode.model.mesh.order - 1))
    equations = assemble_system(model)
    inverse = shift_invert_solver(model, equations, shift=spectral_shift(model))
    modes = lanczos_modes(model, equations, inverse=inverse, count=len(mode.names) - mode.modes.rigid_body_count)
    compliance = face_residual_compliance(modes, model, equations, inverse=inverse, face=f"+{axis}", along=axis)
    names = mode_names(model, modes, axis=axis)
    if name not in names:
        return np.inf, compliance
    return abs(_peak_stress(model, modes.shapes[names.index(name)], axis) / peak - 1), compliance


def _uniformity(displacements: Floats) -> float:
    """Least over greatest displacement, positive along the mean."""
    signed = displacements * np.sign(displacements.mean())
    return float(signed.min() / signed.max())


def _asymmetry(mode: NamedMode, axis: str) -> float:
    """Range over the working face of the least-squares plane of the axial displacement, over its mean."""
    nodes = mode.model.mesh.face_nodes(f"+{axis}")
    across = mode.model.mesh.nodes[nodes][:, [k for k in range(3) if k != DIRECTIONS.index(axis)]]
    columns = np.column_stack([np.ones(len(nodes)), across - across.mean(axis=0)])
    plane = np.linalg.lstsq(columns, mode.displacement[nodes, DIRECTIONS.index(axis)], rcond=None)[0]
    return float(np.ptp(columns[:, 1:] @ plane[1:]) / abs(plane[0]))


def _node(mode: NamedMode, axis: str) -> float:
    """Distance from the driven face to the first sign change of the mean axial displacement of sections."""
    nodes = sign_changes(*section_motion(mode, axis))
    if not nodes.size:
        raise InvalidInput("this mode has no displacement node along the axis: tune an axial mode, such as axial 1")
    return float(nodes[0] - mode.model.mesh.nodes[:, DIRECTIONS.index(axis)].min())


def section_motion(mode: NamedMode, axis: str) -> tuple[Floats, Floats]:
    """Mean axial displacement of the cross-sections along an axis.

    Positions along the axis in m, and displacements there; both means over the volume of a thin slice.
    """
    return section_means(mode.model.mesh, mode.displacement[:, DIRECTIONS.index(axis)], axis=axis)


def _neighbours(mode: NamedMode) -> tuple[tuple[str, float], ...]:
    """Name and frequency of the other elastic modes, by distance from the tuned frequency."""
    elastic = range(mode.modes.rigid_body_count, len(mode.names))
    others = [(mode.names[k], float(mode.modes.natural_frequency[k])) for k in elastic if k != mode.row]
    return tuple(sorted(others, key=lambda other: abs(other[1] - mode.frequency)))


_STRESS_SLICES = 40  # across the axis, in each of which the highest stress is taken
_POINTS = 801  # of each curve
_PLANES = 601  # in which the profile is drawn
_INSIDE = 1e-6  # of half the length, by which the first and last plane lie inside


def horn_axis_chart(design: HornDesign) -> Chart:
    """Profile, axial displacement over that of the tip, and highest equivalent stress along the axis of a horn.

    Three panels over the distance from the driven face, with the displacement node marked.
    """
    mode, axis = design.tuned.mode, design.body.axis
    tip = float(face_motion(mode.model, mode.displacement, design.working_face, axis).mean())
    along = mode.model.mesh.nodes[:, DIRECTIONS.index(axis)]
    start = along.min()
    place, displacement = _curve(*_motion(design))
    middle, half = (1e3 * each for each in _profile(design))
    where, highest = _curve(*_highest(along, nodal_stress(mode.model, mode.displacement) / abs(tip)))
    node = Rule(value=1e3 * design.node_position, label="node")
    profile = Band(x=middle - 1e3 * start, low=-half, high=half, colour="0.6", opacity=0.6)
    motion = Line(x=1e3 * (place - start), y=displacement / tip)
    stress = Line(x=1e3 * (where - start), y=1e-12 * highest, colour=1)
    rows = (
        (Axis("Half width", "mm"), (profile, node)),
        (Axis("Axial displacement over the tip's"), (motion, Rule(along="y", value=0.0, dash=0), node)),
        (Axis("Peak stress", "MPa per µm", lowest=0.0), (stress, node)),
    )
    x = Axis("Distance from the driven face", "mm")
    return Chart(
        panels=tuple(Panel(x=x, y=y, parts=parts) for y, parts in rows),
        size=(5.6, 5.6),
        heights=(1, 1.3, 1.3),
        title=f"{design.body.name.replace('_', ' ')}, {mode.names[mode.row]}, {mode.frequency:.0f} Hz",
        legend="top",
        shares_x=True,
    )


def _curve(place: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Smooth curve through values, without maxima of its own."""
    fine = np.union1d(place, np.linspace(place[0], place[-1], _POINTS))
    return fine, np.asarray(PchipInterpolator(place, values)(fine))


def _motion(design: HornDesign) -> tuple[Floats, Floats]:
    """Places of sections and their mean axial displacements, from the driven to the working face."""
    mode, axis = design.tuned.mode, design.body.axis
    along = mode.model.mesh.nodes[:, DIRECTIONS.index(axis)]
    place, displacement = section_motion(mode, axis)
    ends = (face_motion(mode.model, mode.displacement, f"{sign}{axis}", axis).mean() for sign in "-+")
    driven, working = map(float, ends)
    return np.r_[along.min(), place, along.max()], np.r_[driven, displacement, working]


def _highest(along: Floats, stress: Floats) -> tuple[Floats, Floats]:
    """Places of the highest stress of the nodes in slices across the axis, and of the end faces, and that stress."""
    edges = np.linspace(along.min(), along.max(), _STRESS_SLICES + 1)
    slices = np.digitize(along, edges[1:-1])
    thin = 1e-6 * (edges[-1] - edges[0])
    slices[along < edges[0] + thin], slices[along > edges[-1] - thin] = -1, _STRESS_SLICES
    order = np.lexsort((stress, slices))
    highest = order[np.flatnonzero(np.diff(slices[order], append=_STRESS_SLICES + 1))]
    return along[highest], stress[highest]


def _profile(design: HornDesign) -> tuple[Floats, Floats]:
    """Places along the axis and half the greatest width there, where planes cut the surface."""
    mesh, axis = design.tuned.mode.model.mesh, DIRECTIONS.index(design.body.axis)
    triangles = np.concatenate([face_triangulation(mesh, face=name) for name in mesh.faces])
    centred = mesh.nodes - (mesh.nodes.max(axis=0) + mesh.nodes.min(axis=0)) / 2
    first, last = np.moveaxis(centred[np.sort(triangles[:, [[0, 1], [1, 2], [0, 2]]]).reshape(-1, 2)], 1, 0)
    rise = last[:, axis] - first[:, axis]
    steep = np.abs(rise) > 0
    first, last, rise = first[steep], last[steep], rise[steep]
    end = centred[:, axis].max() * (1 - _INSIDE)
    planes = np.linspace(-end, end, _PLANES)
    half = np.zeros(_PLANES)
    for k, plane in enumerate(planes):
        fraction = (plane - first[:, axis]) / rise
        cut = (fraction >= 0) & (fraction <= 1)
        points = first[cut] + fraction[cut, np.newaxis] * (last[cut] - first[cut])
        half[k] = np.abs(np.delete(points, axis, axis=1)).max()
    return planes + (mesh.nodes[:, axis].max() + mesh.nodes[:, axis].min()) / 2, half
