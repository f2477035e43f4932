"""Sheets of wear grooves: volume of a scan, wear of a ring and of the pin, wear reduction by vibration."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from sonolube.measurement.wear_track import (
    WearReduction,
    WearTrack,
    wear_reduction_between_tracks,
    wear_track_from_grooves,
)
from sonolube.models.surfaces import disc_volume_loss, material_ratio_curve, measure_groove, track_marks, wear_scar
from sonolube.models.surfaces.grooves.groove import Groove
from sonolube.report.measured import groove_figures as figures, sheet
from sonolube.report.measured.surface import SurfaceSettings, surface_file, surface_source
from sonolube.report.measured.surface_figures import abbott

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
    figure = figures.ring_figure(ring)
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
    figure = captioned(figures.worn_map_chart)(cap.levelled, cap.worn)
    part = sheet.Sheet(values=values, figures=(figure,), caveats=file.caveats)
    return sheet.joined([part], title=path.name, source=surface_source(file))


def _figures(groove: Groove) -> tuple[sheet.Figure, ...]:
    """View, cross-sections, map and Abbott curve of a groove."""
    map_caption = "Heights over the unworn surface; the line goes round what counts as worn."
    curve_caption = "Of the whole field over the unworn surface; the groove is its tail."
    return (
        figures.view_figure(groove),
        figures.sections_figure(groove),
        sheet.captioned("Map", map_caption)(figures.worn_map_chart)(groove.levelled, groove.worn),
        sheet.captioned("Abbott curve", curve_caption)(abbott)(material_ratio_curve(groove.levelled)),
    )


def _marks(groove: Groove) -> sheet.Sheet:
    """Spacing of marks along the track by the spectrum of its floor."""
    marks = track_marks(groove)
    if marks.dot_spacing is None:
        return sheet.Sheet(not_found=(f"marks along the track: {marks.reason}",))
    figure = figures.marks_figure(marks)
    value = sheet.quantity_value("dot_spacing", marks.dot_spacing, uncertainty=marks.dot_spacing_uncertainty)
    return sheet.Sheet(values=(value,), figures=(figure,))
