"""Sheets of wear grooves with their figures: volume of a scan, wear of a ring and of the pin, wear reduction."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sonolube.charts import Axis, Chart, Line, Part, Points, Rule, Zone, one_panel
from sonolube.checks import Floats
from sonolube.measurement.wear_track import (
    WearReduction,
    WearTrack,
    wear_reduction_between_tracks,
    wear_track_from_grooves,
)
from sonolube.models.surfaces import (
    HeightMap,
    disc_volume_loss,
    material_ratio_curve,
    measure_groove,
    track_marks,
    wear_scar,
)
from sonolube.models.surfaces.grooves.groove import Groove
from sonolube.models.surfaces.grooves.track_marks import TrackMarks
from sonolube.models.surfaces.resampling import block_means
from sonolube.report.measured import sheet
from sonolube.report.measured.sheet import captioned
from sonolube.report.measured.surface import SurfaceSettings, surface_file, surface_source
from sonolube.report.measured.surface_figures import WAVENUMBER, abbott, length_scale, map_panel
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
    cells = block_means(groove.levelled, most=_BLOCKS)
    x, y, z = 1e3 * cells.x, 1e3 * cells.y, 1e6 * cells.height
    low, high = np.nanquantile(z, [0.002, 0.998])
    axes.plot_surface(*np.meshgrid(x, y), z, cmap="cividis", vmin=low, vmax=high, rstride=1, cstride=1, linewidth=0)
    axes.set(xlabel="x (mm)", ylabel="y (mm)", zlabel="height (µm)")
    axes.set_box_aspect((np.ptp(x), np.ptp(y), 0.35 * np.ptp(x)), zoom=0.92)
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


_STRAIGHT = 100  # lengths of track, beyond which a diameter is not determined by the scan


@dataclass(frozen=True, kw_only=True, slots=True)
class RingSettings:
    """Geometry and sliding distance of a worn ring.

    Parameters
    ----------
    groove_diameter : float
        Diameter of the ring. [m]
    sliding_distance : float
        Distance the pin slid on it. [m]
    tip_radius : float or None
        Radius of the pin's tip, for the volume by ASTM G99's geometry. [m]
    """

    groove_diameter: float
    sliding_distance: float
    tip_radius: float | None = None


def groove_sheet(
    path: Path, *, settings: SurfaceSettings, track_number: int | None = None
) -> tuple[sheet.Sheet, Groove]:
    """Wear groove in a scan: width, depth, volumes and pile-up."""
    file = surface_file(path, settings)
    groove = measure_groove(file.height_map, track_number=track_number)
    values = [
        sheet.Value("track_count", "Wear tracks in the field", groove.track_count, ""),
        sheet.field_value(groove, "wear_volume"),
        sheet.field_value(groove, "pile_up_volume", "Volume of ridges and projections", "m3"),
        sheet.field_value(groove, "net_volume", "Net volume lost in the field", "m3"),
        sheet.field_value(groove, "groove_width"),
        sheet.field_value(groove, "groove_depth", "Greatest depth of the mean section", "m"),
        sheet.field_value(groove, "cross_section_area", "Area of the mean section", "m2"),
        sheet.field_value(groove, "track_length", "Length of track in the field", "m"),
    ]
    if groove.track_count > 1:
        values.insert(1, sheet.Value("track_number", "The one measured", groove.track_number, ""))
    if groove.track.groove_diameter < _STRAIGHT * groove.track_length:
        values.append(sheet.field_value(groove.track, "groove_diameter", "Diameter of the track's arc"))
    caveats = (*file.caveats, *((groove.caveat,) if groove.caveat else ()))
    sections = [
        sheet.Sheet(values=tuple(values), figures=_figures(groove), caveats=caveats),
        sheet.attempted(partial(_marks, groove), what="marks along the track"),
    ]
    return sheet.joined(sections, title=f"{path.parent.name}/{path.name}", source=surface_source(file)), groove


def ring_sheet(
    title: str, grooves: Sequence[tuple[str, Groove | str]], *, settings: RingSettings
) -> tuple[sheet.Sheet, WearTrack]:
    """Wear of a ring by the mean section of its scans and the theorem of Pappus."""
    ring = wear_track_from_grooves(
        [groove for _, groove in grooves],
        groove_diameter=settings.groove_diameter,
        sliding_distance=settings.sliding_distance,
    )
    counted = [name for name, groove in grooves if isinstance(groove, Groove) and groove.complete]
    volume, error = ring.wear_volume, ring.wear_volume_uncertainty
    values = [
        sheet.Value("ring_volume", "Wear volume of the ring", volume, "m3", uncertainty=error),
        sheet.Value("ring_pile_up_volume", "Ridges and projections of the ring", ring.pile_up_volume, "m3"),
        sheet.Value("ring_net_volume", "Net volume lost by the disc", ring.net_volume, "m3"),
        sheet.quantity_value("wear_rate", ring.wear_rate, interval=ring.wear_rate_interval),
    ]
    if settings.tip_radius is not None:
        width = float(np.mean([g.groove_width for _, g in grooves if isinstance(g, Groove) and g.complete]))
        loss = disc_volume_loss(
            groove_diameter=settings.groove_diameter, groove_width=width, tip_radius=settings.tip_radius
        )
        label = "Wear volume by the geometry of ASTM G99, from width and tip"
        values.append(sheet.Value("geometric_volume", label, float(loss), "m3"))
    table = sheet.Table(
        name="sections",
        title="Area of the mean section by scan",
        columns=(sheet.Column("scan", "Scan"), sheet.Column("cross_section_area", "Area", "m2")),
        rows=tuple(zip(counted, map(float, ring.cross_section_area), strict=True)),
    )
    figure = ring_figure(ring)
    section = sheet.Sheet(values=tuple(values), tables=(table,), figures=(figure,), caveats=ring.excluded_scans)
    return sheet.joined([section], title=title, source={}), ring


def wear_reduction_sheet(without: Sequence[WearTrack], with_vibration: Sequence[WearTrack]) -> sheet.Sheet:
    """Wear reduction by vibration from worn rings, with its interval."""
    reduction: WearReduction = wear_reduction_between_tracks(without, with_vibration)
    caveat = "the interval covers the scatter along each ring only, not that between specimens: test more specimens"
    caveats = () if reduction.between_specimens else (caveat,)
    value = sheet.quantity_value("wear_reduction", reduction.wear_reduction, interval=reduction.interval)
    title = f"{len(with_vibration)} ring with vibration against {len(without)} without"
    return sheet.joined([sheet.Sheet(values=(value,), caveats=caveats)], title=title, source={})


def cap_sheet(path: Path, *, settings: SurfaceSettings, tip_radius: float | None) -> sheet.Sheet:
    """Wear of a pin by the scar in a scan of its tip."""
    file = surface_file(path, settings)
    cap = wear_scar(file.height_map, tip_radius=tip_radius)
    volume, error = cap.wear_volume, cap.wear_volume_uncertainty
    values = (
        sheet.Value("pin_volume", "Wear volume of the pin", volume, "m3", uncertainty=error),
        sheet.Value("scar_diameter", "Diameter of the scar", cap.scar_diameter, "m"),
        sheet.quantity_value("tip_radius", cap.tip_radius),
    )
    captioned = sheet.captioned("Scar of the pin", "Heights over the ball; the line goes round the scar.")
    figure = captioned(worn_map_chart)(cap.levelled, cap.worn)
    part = sheet.Sheet(values=values, figures=(figure,), caveats=file.caveats)
    return sheet.joined([part], title=path.name, source=surface_source(file))


def _figures(groove: Groove) -> tuple[sheet.Figure, ...]:
    """View, cross-sections, map and Abbott curve of a groove."""
    map_caption = "Heights over the unworn surface; the line goes round what counts as worn."
    curve_caption = "Of the whole field over the unworn surface; the groove is its tail."
    return (
        view_figure(groove),
        sections_figure(groove),
        sheet.captioned("Map", map_caption)(worn_map_chart)(groove.levelled, groove.worn),
        sheet.captioned("Abbott curve", curve_caption)(abbott)(material_ratio_curve(groove.levelled)),
    )


def _marks(groove: Groove) -> sheet.Sheet:
    """Spacing of marks along the track by the spectrum of its floor."""
    marks = track_marks(groove)
    if marks.dot_spacing is None:
        return sheet.Sheet(not_found=(f"marks along the track: {marks.reason}",))
    figure = marks_figure(marks)
    value = sheet.quantity_value("dot_spacing", marks.dot_spacing, uncertainty=marks.dot_spacing_uncertainty)
    return sheet.Sheet(values=(value,), figures=(figure,))
