"""Deformed mode shapes as pictures, and electrical impedance spectra as charts."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sonolube.charts import Axis, Chart, Line, Panel, Part, Points
from sonolube.checks import Complexes, Floats, Integers
from sonolube.figure import publication_style
from sonolube.models.fem.mesh.element_order import change_order, transfer_field
from sonolube.models.fem.mesh.mesh import HIGHEST_ORDER, Mesh, face_triangulation
from sonolube.models.fem.results.impedance_spectra import SupportedSpectrum

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MODE_COLOURS = "viridis"
"""Colour map of the displacement in pictures of modes."""

_EXAGGERATION = 0.08  # of the part's length, for the largest displacement drawn
_WIDTH, _HEIGHTS = 6.85, (2.6, 4.8)  # of a picture, in inches
_BODY_WIDTH, _TITLE_HEIGHT = 5.8, 0.56  # of it, in inches
_MARGIN = 0.01  # about the body, of its size
_VIEW = (32.0, 24.0)  # degrees of turn about the upward axis and of tilt
_SLENDER = 1.5  # upward over the other sides, above which a body is laid down
_LIGHT = (-0.3, 0.5, 0.81)  # direction to the light: right, up and to the viewer
_DARKEST = 0.8
_DIRECTIONS_AT, _DIRECTION_LENGTH = (0.28, -0.6), 0.26  # inches from the lower left corner of the scale
_MAX_TRIANGLES = 12_000  # in a picture


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

    `shapes` has shape (nodes, 3).

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

    Seen in parallel projection with the longest side of the body from left to right, which fills the width or the
    height beside the scale of colours.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    points, patches, shape = surface.points, surface.triangles, surface.displacement
    size = np.linalg.norm(shape, axis=1)
    extent = np.ptp(points, axis=0)
    drawn = shape * _EXAGGERATION * extent.max() / size.max()
    view = _view(extent)
    seen = (points + amplitude * drawn) @ view.T
    reach = np.concatenate([(points + end * drawn) @ view[:2].T for end in (-1.0, 0.0, 1.0)])
    low, high = reach.min(axis=0), reach.max(axis=0)
    sides = ((high - low) * (1 + 2 * _MARGIN)).tolist()
    height = float(np.clip(_BODY_WIDTH * sides[1] / sides[0] + _TITLE_HEIGHT, *_HEIGHTS))
    colours = ScalarMappable(norm=Normalize(0, 1), cmap=MODE_COLOURS)
    with publication_style():
        figure = Figure(figsize=(_WIDTH, height))
        axes = figure.add_subplot()
        corners = seen[patches]
        order = np.argsort(corners[:, :, 2].mean(axis=1))
        filled = colours.to_rgba(abs(amplitude) * (size / size.max())[patches].mean(axis=1))
        filled[:, :3] *= _brightness(corners)[:, np.newaxis]
        # Edges of the colour of their face hide the seams between neighbours.
        body = PolyCollection(corners[order, :, :2], facecolors=filled[order], edgecolors=filled[order], linewidths=0.3)
        body.set_rasterized(True)
        axes.add_collection(body, autolim=False)
        middle = (low + high) / 2
        limits = [(middle[k] - sides[k] / 2, middle[k] + sides[k] / 2) for k in range(2)]
        axes.set(xlim=limits[0], ylim=limits[1])
        axes.set_aspect("equal")
        axes.set_axis_off()
        lengths = " × ".join(f"{1e3 * side:.3g}" for side in extent)
        figure.suptitle(
            f"{title}\n{lengths} mm; largest displacement drawn as {_EXAGGERATION:.0%} of the part's length", fontsize=9
        )
        scale = figure.colorbar(
            colours, ax=axes, shrink=0.6, anchor=(0.0, 1.0), pad=0.01, aspect=14, ticks=(0.0, 0.5, 1.0)
        )
        scale.set_label("Displacement\nover its largest [1]", fontsize=8)
        _draw_directions(scale.ax, view)
    return figure


def _view(extent: Floats) -> Floats:
    """Rows to the right, upwards and to the viewer, for sides of a body; slender bodies lie, others stand."""
    order = [0, 1, 2]
    if extent[2] > _SLENDER * extent[:2].max():
        order = [2, 0, 1]
    elif extent[1] > extent[0]:
        order = [1, 0, 2]
    turn, tilt = np.radians(_VIEW)
    rows = np.array(
        [
            [np.cos(turn), np.sin(turn), 0.0],
            [-np.sin(tilt) * np.sin(turn), np.sin(tilt) * np.cos(turn), np.cos(tilt)],
            [np.cos(tilt) * np.sin(turn), -np.cos(tilt) * np.cos(turn), np.sin(tilt)],
        ]
    )
    axes = np.eye(3)[order]
    if np.linalg.det(axes) < 0:
        axes[1] *= -1
    return np.asarray(rows @ axes)


def _brightness(corners: Floats) -> Floats:
    """Brightness of triangles by the angle between their normal and the direction to the viewer."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    facing = np.divide(np.abs(normal @ _LIGHT), length, out=np.ones_like(length), where=length > 0)
    return np.asarray(_DARKEST + (1 - _DARKEST) * facing)


def _draw_directions(axes: "Axes", view: Floats) -> None:
    """Lines along x, y and z below the scale of colours."""
    from matplotlib.transforms import ScaledTranslation

    figure = axes.get_figure(root=True)
    assert figure is not None
    inches = figure.dpi_scale_trans + ScaledTranslation(0, 0, axes.transAxes)  # type: ignore[arg-type]
    foot = np.array(_DIRECTIONS_AT)
    for name, along in zip("xyz", _DIRECTION_LENGTH * view[:2].T, strict=True):
        (line,) = axes.plot(*np.transpose([foot, foot + along]), color="black", lw=1, transform=inches, clip_on=False)
        right, up = (foot + 1.5 * along).tolist()
        letter = axes.text(right, up, name, transform=inches, fontsize=8, ha="center", va="center")
        line.set_in_layout(False)
        letter.set_in_layout(False)


def impedance_chart(
    spectra: Mapping[str, SupportedSpectrum], *, title: str, measured: tuple[Floats, Complexes] | None = None
) -> Chart:
    """Magnitude and phase of the impedance, and motion of the tip per volt, over frequency."""
    drawn: tuple[list[Part], list[Part], list[Part]] = [], [], []  # magnitude, phase and motion
    if measured is not None:
        frequency, impedance = measured
        computed = next(iter(spectra.values())).response.frequency
        within = (frequency >= computed[0]) & (frequency <= computed[-1])
        f, z = 1e-3 * frequency[within], impedance[within]
        for parts, values in zip(drawn, (np.abs(z), np.degrees(np.angle(z))), strict=False):
            parts.append(Points(x=f, y=values, label="measured", colour="0.5", is_faint=True))
    for k, (name, spectrum) in enumerate(spectra.items()):
        f, z = 1e-3 * spectrum.response.frequency, spectrum.impedance
        per_volt = 1e9 * np.abs(spectrum.response.displacement_per_volt[0])
        label = name if len(spectra) > 1 or measured is not None else ""
        for parts, values in zip(drawn, (np.abs(z), np.degrees(np.angle(z)), per_volt), strict=True):
            parts.append(Line(x=f, y=values, label=label, colour=k, dash=k, weight=0.85))
    x = Axis(label="Frequency", unit="kHz")
    axes = (
        Axis(label="Impedance", unit="ohm", logarithmic=True),
        Axis(label="Phase", unit="deg", lowest=-100.0, highest=100.0, ticks=(-90, -45, 0, 45, 90)),
        Axis(label="Tip motion per volt", unit="nm/V", logarithmic=True),
    )
    titled = zip(axes, drawn, (title, "", ""), strict=True)
    panels = tuple(Panel(x=x, y=y, parts=tuple(parts), title=own) for y, parts, own in titled)
    return Chart(panels=panels, size=(5.6, 5.8), heights=(1.4, 1, 1.2), legend="top", shares_x=True)


def _drawn_order(mesh: Mesh) -> int:
    """Order of elements that looks smooth in a picture."""
    triangles = sum(len(faces) for name, faces in mesh.faces.items() if "|" not in name)
    return int(np.clip(np.sqrt(_MAX_TRIANGLES / triangles), 2, HIGHEST_ORDER))
