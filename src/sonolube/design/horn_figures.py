"""Figure of a tuned horn along its axis: profile, axial displacement and peak stress."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.design.horn import HornDesign, face_motion, nodal_stress, section_motion
from sonolube.figure import COLOURS
from sonolube.models.fem import face_triangulation
from sonolube.models.fem.solver.model import DIRECTIONS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SLICES = 40  # across the axis, in each of which the highest stress is drawn
_PLANES = 601  # in which the profile is drawn
_INSIDE = 1e-6  # of half the length, by which the first and last plane lie inside


def horn_axis_figure(design: HornDesign) -> "Figure":
    """Profile, axial displacement over that of the tip, and highest equivalent stress along the axis of a horn.

    Parameters
    ----------
    design : HornDesign

    Returns
    -------
    matplotlib.figure.Figure
        Three panels over the distance from the driven face, with the displacement node marked.
    """
    from matplotlib.figure import Figure

    mode, axis = design.tuned.mode, design.body.axis
    tip = float(face_motion(mode.model, mode.displacement, design.working_face, axis).mean())
    place, displacement = section_motion(mode, axis)
    along = mode.model.mesh.nodes[:, DIRECTIONS.index(axis)]
    start = along.min()
    figure = Figure(figsize=(5.6, 5.4))
    profile, motion, stress = figure.subplots(3, 1, sharex=True, height_ratios=(1, 1.3, 1.3))
    middle, half = _profile(design)
    profile.fill_between(1e3 * (middle - start), 1e3 * half, -1e3 * half, color="0.8", edgecolor="0.3", lw=0.8)
    profile.set(ylabel="Half width\n[mm]")
    motion.plot(1e3 * (place - start), displacement / tip, color=COLOURS[0])
    motion.axhline(0, color="0.4", linewidth=0.8)
    motion.set(ylabel="Axial displacement\nover the tip's [-]")
    middles, highest = _highest(along, nodal_stress(mode.model, mode.displacement) / abs(tip))
    stress.plot(1e3 * (middles - start), 1e-12 * highest, color=COLOURS[1])
    stress.set(xlabel="Distance from the driven face [mm]", ylabel="Peak stress\n[MPa per µm]", ylim=(0, None))
    for axes in (motion, stress, profile):
        axes.axvline(1e3 * design.node_position, color="0.4", linestyle=":")
    foot = (1e3 * design.node_position, float((displacement / tip).min()))
    motion.annotate("node", foot, xytext=(4, 2), textcoords="offset points")
    title = f"{design.body.name.replace('_', ' ')}, {mode.names[mode.row]}, {mode.frequency:.0f} Hz"
    profile.set_title(title, fontsize=9)
    return figure


def _highest(along: Floats, stress: Floats) -> tuple[Floats, Floats]:
    """Middles of slices across the axis, and the highest stress of the nodes in each."""
    edges = np.linspace(along.min(), along.max(), _SLICES + 1)
    which = np.clip(np.digitize(along, edges) - 1, 0, _SLICES - 1)
    highest = np.zeros(_SLICES)
    np.maximum.at(highest, which, stress)
    filled = np.unique(which)
    return ((edges[1:] + edges[:-1]) / 2)[filled], highest[filled]


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
