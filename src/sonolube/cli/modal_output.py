"""How modes are told and drawn."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.checks import Floats
from sonolube.fem import ConvergedModes, Mesh, change_order, face_triangulation, transfer_field
from sonolube.fem.solver.mesh import HIGHEST_ORDER
from sonolube.figure import publication_style, write_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MODE_COLOURS = "viridis"
"""Colours of the displacement in pictures of modes."""

_EXAGGERATION = 0.08  # of the part's length, for the largest displacement drawn
_MOST_TRIANGLES = 12_000  # in a picture


def modes_lines(
    part: str, material: str, found: ConvergedModes, names: Sequence[str], written: Sequence[Path]
) -> list[str]:
    """Return what a user reads of modes."""
    rows = range(found.modes.rigid_body_count, len(names))
    width = max(len(names[row]) for row in rows)
    free = f"{found.modes.rigid_body_count} rigid motions, " if found.modes.rigid_body_count else "held, "
    return [
        f"{part} of {material}: {free}{found.nodes[-1]} nodes in the last of {len(found.nodes)} meshes",
        *[
            f"  {names[row]:<{width}}  {found.natural_frequency[row]:>10.1f} Hz  +-{found.frequency_error[row]:.2g}"
            for row in rows
        ],
        *[f"  {path}" for path in written],
    ]


def modes_object(
    part: str, material: str, found: ConvergedModes, names: Sequence[str], written: Sequence[Path]
) -> dict[str, Any]:
    """Return modes as one JSON object, all quantities in SI."""
    rows = range(found.modes.rigid_body_count, len(names))
    return {
        "part": part,
        "material": material,
        "rigid_motions": found.modes.rigid_body_count,
        "nodes": list(found.nodes),
        "modes": [
            {
                "name": names[row],
                "natural_frequency": {"value": float(found.natural_frequency[row]), "unit": "Hz"},
                "frequency_error": {"value": float(found.frequency_error[row]), "unit": ""},
            }
            for row in rows
        ],
        "files": [str(path) for path in written],
    }


def write_modes(found: ConvergedModes, names: Sequence[str], *, folder: Path, part: str) -> list[Path]:
    """Draw each elastic mode into a file of its own and return the files."""
    files = []
    for row in range(found.modes.rigid_body_count, len(names)):
        title = f"{names[row]}, {found.natural_frequency[row]:.0f} Hz"
        figure = mode_figure(found.model.mesh, found.modes.shapes[row], title=title)
        name = f"{part}-{row - found.modes.rigid_body_count + 1}-{names[row].replace(' ', '-')}"
        files += write_figure(figure, folder=folder, name=name, file_formats=("png",))
    return files


def mode_figure(mesh: Mesh, shape: Floats, *, title: str, share: float = 1.0) -> "Figure":
    """Return a picture of a mode at a share of its amplitude: the deformed surface, coloured by displacement."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    mesh, shape = _smooth(mesh, shape)
    patches = np.concatenate([face_triangulation(mesh, face=name) for name in mesh.faces if "|" not in name])
    size = np.linalg.norm(shape, axis=1)
    extent = np.ptp(mesh.nodes, axis=0)
    millimetres = 1e3 * (mesh.nodes + share * shape * _EXAGGERATION * extent.max() / size.max())
    colours = ScalarMappable(norm=Normalize(0, 1), cmap=MODE_COLOURS)
    with publication_style():
        figure = Figure(figsize=(5.2, 4.0))
        axes = figure.add_subplot(projection="3d", computed_zorder=False)
        filled = colours.to_rgba(abs(share) * (size / size.max())[patches].mean(axis=1))
        # Edges of the colour of their face hide the seams between neighbours.
        body = Poly3DCollection(millimetres[patches], facecolors=filled, edgecolors=filled, linewidths=0.3)
        body.set_rasterized(True)
        axes.add_collection3d(body)
        middle, half = (
            1e3 * (mesh.nodes.max(axis=0) + mesh.nodes.min(axis=0)) / 2,
            1e3 * extent * 0.5 + 90 * extent.max(),
        )
        axes.set(**{f"{k}lim": (middle[i] - half[i], middle[i] + half[i]) for i, k in enumerate("xyz")})
        axes.set_box_aspect(half, zoom=0.96 - 0.28 * half[2] / np.linalg.norm(half))  # tall ones need room for labels
        figure.suptitle(f"{title}\nlargest displacement drawn as {_EXAGGERATION:.0%} of the part's length", fontsize=9)
        for name, label in (("x", axes.set_xlabel), ("y", axes.set_ylabel), ("z", axes.set_zlabel)):
            label(f"{name} [mm]", labelpad=10)
        axes.tick_params(axis="z", pad=6)
        axes.locator_params(nbins=4)
        figure.colorbar(colours, ax=axes, shrink=0.7, pad=0.14, label="displacement over its largest")
    return figure


def _smooth(mesh: Mesh, shape: Floats) -> tuple[Mesh, Floats]:
    """Return the mesh with elements of an order that a picture shows as smooth, and the shape on its nodes."""
    triangles = sum(len(faces) for name, faces in mesh.faces.items() if "|" not in name)
    order = int(np.clip(np.sqrt(_MOST_TRIANGLES / triangles), 2, HIGHEST_ORDER))
    finer = change_order(mesh, order=order)
    return finer, transfer_field(shape, source=mesh, target=finer)
