"""What the command `horn design` says and draws."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Floats
from sonolube.cli.modal_output import mode_figure
from sonolube.design.horn import (
    HornDesign,
    amplitude_limits,
    face_motion,
    loaded_frequency,
    nodal_stress,
    section_motion,
)
from sonolube.fem import face_triangulation
from sonolube.fem.solver.model import DIRECTIONS
from sonolube.figure import COLOURS, publication_style, write_figure
from sonolube.materials import Material
from sonolube.units import format_si
from sonolube.vocabulary import quantities

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SLICES = 40
_PLANES = 601  # in which the profile is drawn
_INSIDE = 1e-6  # of half the length, by which the first and last plane lie inside
_SHARP = 0.2  # change of the peak stress from mesh to mesh beyond which it is doubted
_NEAR = 3  # neighbours told
_LIMITS = {"fatigue_strength": "fatigue limit", "yield_strength": "yield point"}


def horn_object(design: HornDesign, material: Material, tool: float, written: Sequence[Path]) -> dict[str, Any]:
    """Return a design as one JSON object, all quantities in SI."""
    values = _values(design, tool)
    frequency = design.tuned.mode.frequency
    return {
        "part": design.body.name,
        "material": material.name,
        "mode": design.tuned.mode.names[design.tuned.mode.row],
        "tuned_size": design.body.tuned_size,
        "thin_bar_length": None if design.body.thin is None else {"value": design.body.thin.length, "unit": "m"},
        "sizes": {name: {"value": value, "unit": "m"} for name, value in design.body.sizes.items()},
        **{name: {"value": value, "unit": quantities()[name].unit} for name, value in values.items()},
        "stress_change": {"value": design.stress_change, "unit": ""},
        "amplitude_limits": {
            name: {"value": value, "unit": "m"} for name, value in amplitude_limits(design, material=material).items()
        },
        "neighbours": [
            {
                "name": name,
                "frequency": {"value": at, "unit": "Hz"},
                "gap": {"value": at / frequency - 1, "unit": ""},
            }
            for name, at in design.neighbours
        ],
        "nodes": design.tuned.mode.model.mesh.node_count,
        "caveats": _caveats(design),
        "files": [str(path) for path in written],
    }


def horn_lines(design: HornDesign, material: Material, tool: float, written: Sequence[Path]) -> list[str]:
    """Return a design as lines."""
    mode = design.tuned.mode
    thin = design.body.thin
    theory = "" if thin is None else f"  (thin bar {1e3 * thin.length:.2f} mm)"
    thin_gain = "" if thin is None else f"  (thin bar {thin.displacement_gain:.2f})"
    shift = loaded_frequency(design, tool_mass=tool) - mode.frequency
    sizes = ", ".join(f"{name} {format_si(value, 'm')}" for name, value in design.body.sizes.items())
    limits = amplitude_limits(design, material=material)
    near = [f"{name} {at / mode.frequency - 1:+.1%}" for name, at in design.neighbours[:_NEAR]]
    rows = {
        design.body.tuned_size: f"{1e3 * design.tuned.length:.2f} mm{theory}",
        "frequency": f"{mode.frequency:.0f} Hz +-{mode.frequency * mode.frequency_error:.0f}  {mode.names[mode.row]}",
        "trim": f"{1e-3 * design.tuned.frequency_per_length:+.1f} Hz/mm",
        "neighbours": ", ".join(near) or "none below",
        "gain": f"{design.displacement_gain:.2f}{thin_gain}",
        "node": f"{1e3 * design.node_position:.1f} mm from the driven face",
        "face": f"Umin/Umax {design.face_uniformity:.3f}, asymmetry {design.face_asymmetry:.2g}",
        "peak stress": f"{1e-12 * design.stress_per_displacement:.2f} MPa per um of the working face",
        **{_LIMITS[name]: f"{1e6 * value:.0f} um, zero to peak" for name, value in limits.items()},
        "tool": f"{1e3 * tool:g} g on the face: {shift:+.0f} Hz",
    }
    width = max(map(len, rows))
    return [
        f"{design.body.name} of {material.name}" + (f": {sizes}" if sizes else ""),
        *[f"  {name:<{width}}  {text}" for name, text in rows.items()],
        *[f"  caveat: {caveat}" for caveat in _caveats(design)],
        *[f"  {path}" for path in written],
    ]


def write_horn(design: HornDesign, *, folder: Path, name: str) -> list[Path]:
    """Draw profile, motion and stress along the axis, and the mode; return the files."""
    mode = design.tuned.mode
    title = f"{mode.names[mode.row]}, {mode.frequency:.0f} Hz"
    picture = mode_figure(mode.model.mesh, mode.displacement, title=title)
    return [
        *write_figure(axis_figure(design), folder=folder, name=f"{name}-axis"),
        *write_figure(picture, folder=folder, name=f"{name}-mode", file_formats=("png",)),
    ]


def axis_figure(design: HornDesign) -> "Figure":
    """Return profile, axial displacement and peak stress over the axis."""
    from matplotlib.figure import Figure

    mode, axis = design.tuned.mode, design.body.axis
    working = float(face_motion(mode.model, mode.displacement, design.working_face, axis).mean())
    place, moves = section_motion(mode, axis)
    along = mode.model.mesh.nodes[:, DIRECTIONS.index(axis)]
    start = along.min()
    with publication_style():
        figure = Figure(figsize=(5.6, 5.4))
        profile, motion, stress = figure.subplots(3, 1, sharex=True, height_ratios=(1, 1.3, 1.3))
        middle, radius = _profile(design)
        profile.fill_between(1e3 * (middle - start), 1e3 * radius, -1e3 * radius, color="0.8", edgecolor="0.3", lw=0.8)
        profile.set(ylabel="Half width\n[mm]")
        motion.plot(1e3 * (place - start), moves / working, color=COLOURS[0])
        motion.axhline(0, color="0.4", linewidth=0.8)
        motion.set(ylabel="Axial displacement\nover the tip's [-]")
        level = nodal_stress(mode.model, mode.displacement) / abs(working)
        middles, highest = _highest(along, level)
        stress.plot(1e3 * (middles - start), 1e-12 * highest, color=COLOURS[1])
        stress.set(xlabel="Distance from the driven face [mm]", ylabel="Peak stress\n[MPa per µm]", ylim=(0, None))
        for axes in (motion, stress, profile):
            axes.axvline(1e3 * design.node_position, color="0.4", linestyle=":")
        foot = (1e3 * design.node_position, float((moves / working).min()))
        motion.annotate("node", foot, xytext=(4, 2), textcoords="offset points")
        named = f"{design.body.name.replace('_', ' ')}, {mode.names[mode.row]}, {mode.frequency:.0f} Hz"
        profile.set_title(named, fontsize=9)
    return figure


def _values(design: HornDesign, tool_mass: float) -> dict[str, float]:
    mode = design.tuned.mode
    return {
        "length": design.tuned.length,
        "frequency": mode.frequency,
        "frequency_error": mode.frequency_error,
        "frequency_per_length": design.tuned.frequency_per_length,
        "displacement_gain": design.displacement_gain,
        "node_position": design.node_position,
        "face_uniformity": design.face_uniformity,
        "face_asymmetry": design.face_asymmetry,
        "stress_per_displacement": design.stress_per_displacement,
        "tool_mass": tool_mass,
        "loaded_frequency": loaded_frequency(design, tool_mass=tool_mass),
    }


def _caveats(design: HornDesign) -> list[str]:
    if design.stress_change <= _SHARP:
        return []
    return [
        f"the peak stress moved by {design.stress_change:.0%} with the last refinement: a sharp corner has no limit, "
        "give it an edge_radius, or lower --tolerance"
    ]


def _highest(along: Floats, level: Floats) -> tuple[Floats, Floats]:
    edges = np.linspace(along.min(), along.max(), _SLICES + 1)
    which = np.clip(np.digitize(along, edges) - 1, 0, _SLICES - 1)
    highest = np.zeros(_SLICES)
    np.maximum.at(highest, which, level)
    filled = np.unique(which)
    return ((edges[1:] + edges[:-1]) / 2)[filled], highest[filled]


def _profile(design: HornDesign) -> tuple[Floats, Floats]:
    """Return places along the axis and half the greatest width there, where planes cut the surface."""
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
        share = (plane - first[:, axis]) / rise
        cut = (share >= 0) & (share <= 1)
        points = first[cut] + share[cut, np.newaxis] * (last[cut] - first[cut])
        half[k] = np.abs(np.delete(points, axis, axis=1)).max()
    return planes + (mesh.nodes[:, axis].max() + mesh.nodes[:, axis].min()) / 2, half
