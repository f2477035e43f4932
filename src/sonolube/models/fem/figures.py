"""Deformed mode shapes as pictures, and electrical impedance spectra as charts."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sonolube.charts import Axis, Chart, Line, Panel, Part, Points
from sonolube.checks import Complexes, Floats, Integers
from sonolube.figure import publication_style
from sonolube.models.fem.impedance_spectra import SupportedSpectrum
from sonolube.models.fem.solver.element_order import change_order, transfer_field
from sonolube.models.fem.solver.mesh import HIGHEST_ORDER, Mesh, face_triangulation

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d import Axes3D

MODE_COLOURS = "viridis"
"""Colour map of the displacement in pictures of modes."""

_EXAGGERATION = 0.08  # of the part's length, for the largest displacement drawn
_TICK_DISTANCE, _LABEL_DISTANCE = 15.0, 36.0  # of their text from an axis, in points
_FEW_TICKS, _ONE_TICK = 0.5, 0.3  # side over the longest, below which there is no room for more
_OWN_DISTANCES = (8.0, 21.0)  # that matplotlib adds to the pads of ticks and labels
_MOST_TRIANGLES = 12_000  # in a picture


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ShapedSurface:
    """Triangulated surface of a body with fields of displacement on it.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        Coordinates in m.
    triangles : ndarray of int, shape (t, 3)
        Points of each triangle.
    displacement : ndarray, shape (..., n, 3)
        Displacements of the points, of any scale; one field, or one a mode. [m]
    """

    points: Floats
    triangles: Integers
    displacement: Floats


def shaped_surface(mesh: Mesh, shapes: Floats) -> ShapedSurface:
    """Outer surface of a mesh, fine enough to look smooth, with fields of displacement on it.

    Parameters
    ----------
    mesh : Mesh
    shapes : ndarray, shape (nodes, 3) or (modes, nodes, 3)
        Displacements of the nodes, of any scale.

    Returns
    -------
    ShapedSurface
        Its displacements have the leading shape of `shapes`.
    """
    finer = change_order(mesh, order=_drawn_order(mesh))
    fields = [transfer_field(shape, source=mesh, target=finer) for shape in shapes.reshape(-1, *shapes.shape[-2:])]
    patches = np.concatenate([face_triangulation(finer, face=name) for name in finer.faces if "|" not in name])
    shown, triangles = np.unique(patches, return_inverse=True)
    return ShapedSurface(
        points=finer.nodes[shown],
        triangles=triangles.reshape(patches.shape),
        displacement=np.stack(fields)[:, shown].reshape(*shapes.shape[:-2], shown.size, 3),
    )


def mode_figure(surface: ShapedSurface, *, title: str, amplitude: float = 1.0) -> "Figure":
    """Deformed surface of a body in one of its modes, coloured by the magnitude of the displacement.

    Parameters
    ----------
    surface : ShapedSurface
        With one field of displacement.
    title : str
    amplitude : float
        Displacement drawn over the largest one, -1 to 1.

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    points, patches, shape = surface.points, surface.triangles, surface.displacement
    size = np.linalg.norm(shape, axis=1)
    extent = np.ptp(points, axis=0)
    millimetres = 1e3 * (points + amplitude * shape * _EXAGGERATION * extent.max() / size.max())
    colours = ScalarMappable(norm=Normalize(0, 1), cmap=MODE_COLOURS)
    with publication_style():
        figure = Figure(figsize=(5.2, 4.0))
        axes = figure.add_subplot(projection="3d", computed_zorder=False)
        filled = colours.to_rgba(abs(amplitude) * (size / size.max())[patches].mean(axis=1))
        # Edges of the colour of their face hide the seams between neighbours.
        body = Poly3DCollection(millimetres[patches], facecolors=filled, edgecolors=filled, linewidths=0.3)
        body.set_rasterized(True)
        axes.add_collection3d(body)
        middle = 1e3 * (points.max(axis=0) + points.min(axis=0)) / 2
        half = 1e3 * extent * 0.5 + 90 * extent.max()
        axes.set(**{f"{k}lim": (middle[i] - half[i], middle[i] + half[i]) for i, k in enumerate("xyz")})
        axes.set_box_aspect(half, zoom=0.96 - 0.32 * half[2] / np.linalg.norm(half))  # tall ones need room for labels
        figure.suptitle(f"{title}\nlargest displacement drawn as {_EXAGGERATION:.0%} of the part's length", fontsize=9)
        _label_axes(axes, half)
        figure.colorbar(colours, ax=axes, shrink=0.7, pad=0.14, label="displacement over its largest")
    return figure


def _label_axes(axes: "Axes3D", half: Floats) -> None:
    """Label the axes of a box of half sides in mm, text as far from slender boxes as from a cube.

    matplotlib moves text by a share of the box across the axis, which for the long axis of a slender box is next to
    nothing.
    """
    for place, name in enumerate("xyz"):
        across = np.delete(half, place)
        share = np.hypot(*across) / half.max()
        axis = getattr(axes, f"{name}axis")
        axis.set_label_text(f"{name} [mm]")
        axis.labelpad = _LABEL_DISTANCE / share - _OWN_DISTANCES[1]
        axes.tick_params(axis=name, pad=_TICK_DISTANCE / share - _OWN_DISTANCES[0])
        side = half[place] / half.max()
        intervals = 4 if side > _FEW_TICKS else 2 if side > _ONE_TICK else 1
        axes.locator_params(axis=name, nbins=intervals, min_n_ticks=min(intervals, 2))


def impedance_chart(
    spectra: Mapping[str, SupportedSpectrum], *, title: str, measured: tuple[Floats, Complexes] | None = None
) -> Chart:
    """Magnitude and phase of the impedance, and motion of the tip per volt, over frequency.

    Parameters
    ----------
    spectra : mapping of str to SupportedSpectrum
        By the name of the support, such as "free" and "clamped".
    title : str
    measured : tuple of two ndarray, optional
        Frequency [Hz] and complex impedance [ohm] of a measured spectrum.

    Returns
    -------
    Chart
    """
    magnitude: list[Part] = []
    phase: list[Part] = []
    motion: list[Part] = []
    if measured is not None:
        frequency, impedance = measured
        within = _within(frequency, spectra)
        f, z = 1e-3 * frequency[within], impedance[within]
        magnitude.append(Points(x=f, y=np.abs(z), label="measured", colour="0.5", is_faint=True))
        phase.append(Points(x=f, y=np.degrees(np.angle(z)), label="measured", colour="0.5", is_faint=True))
    for k, (name, spectrum) in enumerate(spectra.items()):
        f, z = 1e-3 * spectrum.response.frequency, spectrum.impedance
        per_volt = 1e9 * np.abs(spectrum.response.displacement_per_volt[0])
        label = name if len(spectra) > 1 or measured is not None else ""
        for parts, values in ((magnitude, np.abs(z)), (phase, np.degrees(np.angle(z))), (motion, per_volt)):
            parts.append(Line(x=f, y=values, label=label, colour=k, dash=k, weight=0.85))
    x = Axis(label="Frequency", unit="kHz")
    panels = (
        Panel(x=x, y=Axis(label="Impedance", unit="ohm", logarithmic=True), parts=tuple(magnitude), title=title),
        Panel(
            x=x,
            y=Axis(label="Phase", unit="deg", lowest=-100.0, highest=100.0, ticks=(-90, -45, 0, 45, 90)),
            parts=tuple(phase),
        ),
        Panel(x=x, y=Axis(label="Tip motion per volt", unit="nm/V", logarithmic=True), parts=tuple(motion)),
    )
    return Chart(panels=panels, size=(5.6, 5.8), heights=(1.4, 1, 1.2), legend="top", shares_x=True)


def _within(frequency: Floats, spectra: Mapping[str, SupportedSpectrum]) -> NDArray[np.bool_]:
    """Which measured frequencies lie within the computed range."""
    computed = next(iter(spectra.values())).response.frequency
    return np.asarray((frequency >= computed[0]) & (frequency <= computed[-1]))


def _drawn_order(mesh: Mesh) -> int:
    """Order of elements that looks smooth in a picture."""
    triangles = sum(len(faces) for name, faces in mesh.faces.items() if "|" not in name)
    return int(np.clip(np.sqrt(_MOST_TRIANGLES / triangles), 2, HIGHEST_ORDER))
