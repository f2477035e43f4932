"""Figures of wear grooves: view, sections, map, ring and marks."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.figure import COLOURS, MARKERS, subplots
from sonolube.measurement.wear_track import WearTrack
from sonolube.models.surfaces import HeightMap
from sonolube.models.surfaces.grooves.groove import Groove
from sonolube.models.surfaces.grooves.track_marks import TrackMarks
from sonolube.report.measured.sheet import captioned
from sonolube.report.measured.surface_figures import length_scale, show_map

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_BLOCKS = 110  # along the longer side of a view
_SINGLE = 9  # sections shown


@captioned("The groove", "Heights over the unworn surface, the vertical stretched.")
def view(groove: Groove) -> "Figure":
    """Three-dimensional view of the groove, the vertical stretched."""
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
def sections(groove: Groove) -> "Figure":
    """Single cross-sections, and the mean one with its edges."""
    figure, axes = subplots(figsize=(6.4, 3.2))
    single = groove.cross_sections
    for at in np.linspace(0, single.arc_length.size - 1, _SINGLE + 2).round().astype(int)[1:-1]:
        axes.plot(1e3 * single.transverse, 1e6 * single.height[at], color="0.7", linewidth=0.6)
    mean = groove.mean_cross_section
    shown = (mean.transverse >= single.transverse[0]) & (mean.transverse <= single.transverse[-1])
    axes.plot(1e3 * mean.transverse[shown], 1e6 * mean.height[shown], color=COLOURS[0], label="mean section")
    axes.axhline(0, color=COLOURS[1], linewidth=1, linestyle="--", label="unworn surface")
    edges = 1e3 * groove.groove_width * np.array([-0.5, 0.5])
    axes.plot(edges, [0, 0], MARKERS[1], color=COLOURS[1], label="edges")
    axes.set(xlabel="distance from the track (mm)", ylabel="height (µm)")
    figure.legend(loc="outside upper center", ncols=3)
    return figure


@captioned("Map", "Heights over the unworn surface; the line goes round what counts as worn.")
def height_map(levelled: HeightMap, worn: NDArray[np.bool_]) -> "Figure":
    """Heights as colours, with the outline of the worn area."""
    figure, axes = subplots(figsize=(5.0, 3.4))
    show_map(axes, levelled)
    _, per_metre = length_scale(levelled.x)
    x, y = per_metre * levelled.x, per_metre * levelled.y
    axes.contour(x, y, worn.astype(float), levels=[0.5], colors="white", linewidths=0.8)
    return figure


@captioned(
    "Sections round the ring",
    "Area of the mean section of each scan; the line is the mean, the band its 95 % interval.",
)
def ring(worn: WearTrack) -> "Figure":
    """Area of the mean section of each scan, with the mean of the ring and its 95 % interval."""
    figure, axes = subplots(figsize=(4.6, 3.0))
    area = 1e12 * worn.cross_section_area
    circumference = math.pi * worn.groove_diameter
    low, high = (1e12 * end / circumference for end in worn.wear_volume_interval)
    place = np.arange(1, area.size + 1)
    axes.axhspan(low, high, color=COLOURS[5], alpha=0.4, linewidth=0, label="95 %")
    axes.axhline(float(area.mean()), color=COLOURS[0], linewidth=1.2, label="mean")
    axes.plot(place, area, MARKERS[1], color=COLOURS[1], label="scans")
    axes.set(xlabel="scan", ylabel="section (µm²)", xticks=place)
    figure.legend(loc="outside upper center", ncols=3)
    return figure


@captioned(
    "Spectrum along the track",
    "Power of the groove's floor along the track over its background; the peak is the marks' spacing.",
)
def marks(track: TrackMarks) -> "Figure":
    """Power spectrum along the track over its background."""
    figure, axes = subplots(figsize=(4.6, 3.0))
    inner = track.wavenumber > 0
    k = track.wavenumber[inner]
    axes.loglog(k, track.profile_spectral_density[inner], linewidth=1, label="along the track")
    background = np.broadcast_to(track.background, track.wavenumber.shape)[inner]
    axes.loglog(k, background, "--", color=COLOURS[1], label="background")
    if track.dot_spacing is not None:
        axes.axvline(1 / track.dot_spacing, color="0.4", linewidth=0.8, linestyle=":")
    axes.set(xlabel="wavenumber (1/m)", ylabel="power spectral density (m³)")
    axes.legend()
    return figure


def _block_means(height: Floats, size: int) -> Floats:
    """Means over square blocks of pixels without missing ones; NaN for blocks without pixels."""
    rows, columns = (n // size * size for n in height.shape)
    blocks = height[:rows, :columns].reshape(rows // size, size, columns // size, size)
    measured = np.isfinite(blocks)
    count = measured.sum(axis=(1, 3))
    total = np.where(measured, blocks, 0.0).sum(axis=(1, 3))
    return np.where(count, total / np.maximum(count, 1), np.nan)
