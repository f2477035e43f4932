"""Figure of a tuned horn along its axis: profile, axial displacement and peak stress."""

import numpy as np
from scipy.interpolate import PchipInterpolator

from sonolube.charts import Axis, Band, Chart, Line, Panel, Rule
from sonolube.checks import Floats
from sonolube.design.horns.tuning import HornDesign, face_motion, nodal_stress, section_motion
from sonolube.models.fem import face_triangulation
from sonolube.models.fem.mesh.mesh import DIRECTIONS

_SLICES = 40  # across the axis, in each of which the highest stress is taken
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
    edges = np.linspace(along.min(), along.max(), _SLICES + 1)
    slices = np.digitize(along, edges[1:-1])
    thin = 1e-6 * (edges[-1] - edges[0])
    slices[along < edges[0] + thin], slices[along > edges[-1] - thin] = -1, _SLICES
    order = np.lexsort((stress, slices))
    highest = order[np.flatnonzero(np.diff(slices[order], append=_SLICES + 1))]
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
