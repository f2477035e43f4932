"""Figures of wear grooves: view, sections, map, ring and marks."""

import math
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sonolube.charts import Axis, Chart, Line, Part, Points, Rule, Zone, one_panel
from sonolube.checks import Floats
from sonolube.measurement.wear_track import WearTrack
from sonolube.models.surfaces import HeightMap
from sonolube.models.surfaces.grooves.groove import Groove
from sonolube.models.surfaces.grooves.track_marks import TrackMarks
from sonolube.report.measured import sheet
from sonolube.report.measured.sheet import captioned
from sonolube.report.measured.surface_figures import WAVENUMBER, length_scale, map_panel
from sonolube.report.page import Drawing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_BLOCKS = 110  # along the longer side of a view
_SINGLE = 9  # sections shown


def view_figure(groove: Groove) -> sheet.Figure:
    """Three-dimensional view of the groove, the vertical stretched."""
    caption = "Heights over the unworn surface, the vertical stretched."
    return sheet.Figure(title="The groove", drawing=Drawing(draw=partial(_view, groove), caption=caption, forms=()))


def _view(groove: Groove) -> "Figure":
    """Drawing of the view."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 4.2))
    axes: Any = figure.add_subplot(projection="3d")
    levelled = groove.levelled
    size = max(1, math.ceil(max(levelled.height.shape) / _BLOCKS))
    z = 1e6 * _block_means(levelled.height, size)
    y, x = (
        1e3 * size * step * np.arange(n)
        for step, n in zip((levelled.spacing_y, levelled.spacing_x), z.shape, strict=True)
    )
    low, high = np.nanquantile(z, [0.002, 0.998])
    axes.plot_surface(*np.meshgrid(x, y), z, cmap="cividis", vmin=low, vmax=high, rstride=1, cstride=1, linewidth=0)
    axes.set(xlabel="x (mm)", ylabel="y (mm)", zlabel="height (µm)")
    axes.set_box_aspect((x[-1], y[-1], 0.35 * x[-1]), zoom=0.92)
    axes.invert_yaxis()  # as on the map, whose first row is the top
    axes.view_init(elev=38, azim=-62)
    return figure


@captioned(
    "Cross-sections",
    "Single sections square to the track in grey, the mean in colour, its edges where it meets the unworn surface.",
)
def sections_figure(groove: Groove) -> Chart:
    """Single cross-sections, and the mean one with its edges."""
    single, mean = groove.cross_sections, groove.mean_cross_section
    chosen = np.linspace(0, single.arc_length.size - 1, _SINGLE + 2).round().astype(int)[1:-1]
    grey = [Line(x=1e3 * single.transverse, y=1e6 * single.height[at], colour="0.7", weight=0.45) for at in chosen]
    shown = (mean.transverse >= single.transverse[0]) & (mean.transverse <= single.transverse[-1])
    edges = 1e3 * groove.groove_width * np.array([-0.5, 0.5])
    parts: tuple[Part, ...] = (
        *grey,
        Line(x=1e3 * mean.transverse[shown], y=1e6 * mean.height[shown], label="mean section"),
        Rule(value=0.0, along="y", label="unworn surface", colour=1, dash=1),
        Points(x=edges, y=np.zeros(2), label="edges", colour=1, marker=1),
    )
    return one_panel(Axis("Distance from the track", "mm"), Axis("Height", "µm"), parts, size=(6.4, 3.2), legend="top")


def worn_map_chart(levelled: HeightMap, worn: NDArray[np.bool_]) -> Chart:
    """Heights over the unworn surface, with a line round what counts as worn."""
    _, per_metre = length_scale(levelled.x)
    x, y = _outline(per_metre * levelled.x, per_metre * levelled.y, worn)
    return Chart(panels=(map_panel(levelled, Line(x=x, y=y, colour="1", weight=0.6)),), size=(6.4, 3.6))


def _outline(x: Floats, y: Floats, inside: NDArray[np.bool_]) -> tuple[Floats, Floats]:
    """Line round the pixels inside, interrupted between its pieces."""
    from contourpy import contour_generator

    pieces = contour_generator(x, y, inside.astype(np.float64)).lines(0.5)
    between = np.full((1, 2), np.nan)
    found = np.concatenate([between, *(part for piece in pieces for part in (np.asarray(piece), between))])
    return found[:, 0], found[:, 1]


@captioned(
    "Sections round the ring",
    "Area of the mean section of each scan; the line is the mean, the band its 95 % interval.",
)
def ring_figure(worn: WearTrack) -> Chart:
    """Area of the mean section of each scan, with the mean of the ring and its 95 % interval."""
    area = 1e12 * worn.cross_section_area
    circumference = math.pi * worn.groove_diameter
    low, high = (np.array([1e12 * end / circumference]) for end in worn.wear_volume_interval)
    place = np.arange(1.0, area.size + 1)
    parts = (
        Zone(first=low, last=high, along="y", label="95 %", colour=5, opacity=0.4),
        Rule(value=float(area.mean()), along="y", label="mean", colour=0, dash=0),
        Points(x=place, y=area, label="scans", colour=1, marker=1),
    )
    return one_panel(Axis("Scan", ticks=tuple(place)), Axis("Section", "µm²"), parts, size=(4.6, 3.0), legend="top")


@captioned(
    "Spectrum along the track",
    "Power of the groove's floor along the track over its background; the peak is the marks' spacing.",
)
def marks_figure(track: TrackMarks) -> Chart:
    """Power spectrum along the track over its background."""
    inner = track.wavenumber > 0
    k = track.wavenumber[inner]
    background = np.broadcast_to(track.background, track.wavenumber.shape)[inner]
    peak = () if track.dot_spacing is None else (Rule(value=1 / track.dot_spacing),)
    parts = (
        Line(x=k, y=track.profile_spectral_density[inner], label="along the track", weight=0.7),
        Line(x=k, y=background, label="background", colour=1, dash=1),
        *peak,
    )
    density = Axis("Power spectral density", "m³", logarithmic=True)
    return one_panel(WAVENUMBER, density, parts, size=(4.6, 3.0))


def _block_means(height: Floats, size: int) -> Floats:
    """Means over square blocks of pixels without missing ones; NaN for blocks without pixels."""
    rows, columns = (n // size * size for n in height.shape)
    blocks = height[:rows, :columns].reshape(rows // size, size, columns // size, size)
    measured = np.isfinite(blocks)
    count = measured.sum(axis=(1, 3))
    total = np.where(measured, blocks, 0.0).sum(axis=(1, 3))
    return np.where(count, total / np.maximum(count, 1), np.nan)
