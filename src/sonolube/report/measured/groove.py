"""Scans of wear grooves as sheets: width, depth, volume and pile-up of a scan, wear of a ring, wear reduction."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from sonolube.measurement.surface_files.reader import read_surface_file
from sonolube.measurement.wear_track import (
    WearReduction,
    WearTrack,
    wear_reduction_between_tracks,
    wear_track_from_grooves,
)
from sonolube.report.measured import groove_figures as figures
from sonolube.report.measured.sheet import (
    Column,
    Part,
    Sheet,
    SheetFigure,
    SheetTable,
    Value,
    attempted,
    known,
    sheet_of,
)
from sonolube.report.measured.surface import SurfaceSettings, surface_source
from sonolube.report.measured.surface_figures import abbott
from sonolube.surfaces import disc_volume_loss, material_ratio_curve, measure_groove, track_marks, wear_scar
from sonolube.surfaces.grooves.groove import Groove

_STRAIGHT = 100  # lengths of track, beyond which a diameter is the scan's whim


@dataclass(frozen=True, kw_only=True, slots=True)
class RingSettings:
    """What the wear of a ring depends on beside its scans.

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


def groove_sheet(path: Path, *, settings: SurfaceSettings) -> tuple[Sheet, Groove]:
    """Return what a scan says of the groove in it, and the groove for its ring.

    Parameters
    ----------
    path : Path
        In any format of `read_surface_file`, as measured.
    settings : SurfaceSettings
        Of which spacing and unit are taken.

    Returns
    -------
    Sheet
    Groove

    Raises
    ------
    NoGroove
        If nothing stands out of the scan as a groove.
    InvalidInput
        If the file cannot be read or too little was measured.
    """
    file = read_surface_file(
        path, spacing_x=settings.spacing_x, spacing_y=settings.spacing_y, length_unit=settings.length_unit
    )
    groove = measure_groove(file.height_map)
    values = [
        known("wear_volume", groove.wear_volume, uncertainty=groove.wear_volume_uncertainty),
        Value(name="pile_up_volume", label="Volume of ridges and projections", value=groove.pile_up_volume, unit="m3"),
        Value(name="net_volume", label="Volume that has left the field", value=groove.net_volume, unit="m3"),
        known("groove_width", groove.groove_width),
        Value(name="groove_depth", label="Greatest depth of the mean section", value=groove.groove_depth, unit="m"),
        Value(name="cross_section_area", label="Area of the mean section", value=groove.cross_section_area, unit="m2"),
        Value(name="track_length", label="Length of track in the field", value=groove.track_length, unit="m"),
    ]
    if groove.track.groove_diameter < _STRAIGHT * groove.track_length:
        values.append(known("groove_diameter", groove.track.groove_diameter, label="Diameter of the track's arc"))
    caveats = (groove.caveat,) if groove.caveat else ()
    parts = [
        Part(values=tuple(values), figures=_figures(groove), caveats=caveats),
        attempted(partial(_marks, groove), what="marks along the track"),
    ]
    return sheet_of(parts, title=f"{path.parent.name}/{path.name}", source=surface_source(file)), groove


def ring_sheet(
    title: str, grooves: Sequence[tuple[str, Groove | str]], *, settings: RingSettings
) -> tuple[Sheet, WearTrack]:
    """Return the wear of a ring from the grooves of its scans.

    Parameters
    ----------
    title : str
        Which ring it is.
    grooves : sequence of (str, Groove or str)
        Name of each scan, and its groove or why it shows none.
    settings : RingSettings

    Returns
    -------
    Sheet
    WearTrack

    Raises
    ------
    InvalidInput
        If fewer than two scans show a whole groove.
    """
    ring = wear_track_from_grooves(
        [groove for _, groove in grooves],
        groove_diameter=settings.groove_diameter,
        sliding_distance=settings.sliding_distance,
    )
    counted = [name for name, groove in grooves if isinstance(groove, Groove) and groove.complete]
    values = [
        Value(
            name="ring_volume",
            label="Wear volume of the ring",
            value=ring.wear_volume,
            unit="m3",
            uncertainty=ring.wear_volume_uncertainty,
        ),
        Value(
            name="ring_pile_up_volume",
            label="Ridges and projections of the ring",
            value=ring.pile_up_volume,
            unit="m3",
        ),
        Value(name="ring_net_volume", label="Volume that has left the disc", value=ring.net_volume, unit="m3"),
        known("wear_rate", ring.wear_rate, interval=ring.wear_rate_interval),
    ]
    if settings.tip_radius is not None:
        width = float(np.mean([g.groove_width for _, g in grooves if isinstance(g, Groove) and g.complete]))
        volume = disc_volume_loss(
            groove_diameter=settings.groove_diameter, groove_width=width, tip_radius=settings.tip_radius
        )
        label = "The same by ASTM G99's geometry, from width and tip"
        values.append(Value(name="geometric_volume", label=label, value=float(volume), unit="m3"))
    table = SheetTable(
        name="sections",
        title="Area of the mean section by scan",
        columns=(Column(name="scan", label="Scan"), Column(name="cross_section_area", label="Area", unit="m2")),
        rows=tuple(zip(counted, map(float, ring.cross_section_area), strict=True)),
    )
    drawn = SheetFigure(
        name="ring",
        title="Sections round the ring",
        caption="Area of the mean section of each scan; the line is the mean, the band its 95 % interval.",
        draw=partial(figures.ring, ring),
    )
    part = Part(values=tuple(values), tables=(table,), figures=(drawn,), caveats=ring.excluded_scans)
    return sheet_of([part], title=title, source={}), ring


def wear_reduction_sheet(without: Sequence[WearTrack], with_vibration: Sequence[WearTrack]) -> Sheet:
    """Return what vibration takes off the wear.

    Parameters
    ----------
    without, with_vibration : sequence of WearTrack
        One a specimen.

    Returns
    -------
    Sheet
    """
    found: WearReduction = wear_reduction_between_tracks(without, with_vibration)
    caveats: tuple[str, ...] = ()
    if not found.between_specimens:
        caveats = (
            "the interval knows the scatter round each ring only, not that between specimens: wear more of them",
        )
    value = known("wear_reduction", found.wear_reduction, interval=found.interval)
    title = f"{len(with_vibration)} ring with vibration against {len(without)} without"
    return sheet_of([Part(values=(value,), caveats=caveats)], title=title, source={})


def cap_sheet(path: Path, *, settings: SurfaceSettings, tip_radius: float | None) -> Sheet:
    """Return what a pin has lost at its tip.

    Parameters
    ----------
    path : Path
        A scan of the tip.
    settings : SurfaceSettings
        Of which spacing and unit are taken.
    tip_radius : float or None
        Radius of the tip, fitted to what is unworn where None. [m]

    Returns
    -------
    Sheet

    Raises
    ------
    SonolubeError
        If the file cannot be read or shows no scar.
    """
    file = read_surface_file(
        path, spacing_x=settings.spacing_x, spacing_y=settings.spacing_y, length_unit=settings.length_unit
    )
    cap = wear_scar(file.height_map, tip_radius=tip_radius)
    values = (
        Value(
            name="pin_volume",
            label="Wear volume of the pin",
            value=cap.wear_volume,
            unit="m3",
            uncertainty=cap.wear_volume_uncertainty,
        ),
        Value(name="scar_diameter", label="Diameter of the scar", value=cap.scar_diameter, unit="m"),
        known("tip_radius", cap.tip_radius),
    )
    drawn = SheetFigure(
        name="cap",
        title="Scar of the pin",
        caption="Heights over the ball; the line goes round the scar.",
        draw=partial(figures.height_map, cap.levelled, cap.worn),
    )
    return sheet_of([Part(values=values, figures=(drawn,))], title=path.name, source=surface_source(file))


def _figures(groove: Groove) -> tuple[SheetFigure, ...]:
    return (
        SheetFigure(
            name="view",
            title="The groove",
            caption="Heights over the unworn surface, the vertical stretched.",
            draw=partial(figures.view, groove),
        ),
        SheetFigure(
            name="sections",
            title="Cross-sections",
            caption="Single sections square to the track in grey, the mean in colour, its edges where it meets the"
            " unworn surface.",
            draw=partial(figures.sections, groove),
        ),
        SheetFigure(
            name="map",
            title="Map",
            caption="Heights over the unworn surface; the line goes round what counts as worn.",
            draw=partial(figures.height_map, groove.levelled, groove.worn),
        ),
        SheetFigure(
            name="abbott",
            title="Abbott curve",
            caption="Of the whole field over the unworn surface; the groove is its tail.",
            draw=partial(abbott, material_ratio_curve(groove.levelled)),
        ),
    )


def _marks(groove: Groove) -> Part:
    marks = track_marks(groove)
    if marks.dot_spacing is None:
        return Part(not_found=(f"marks along the track: {marks.reason}",))
    drawn = SheetFigure(
        name="marks",
        title="Spectrum along the track",
        caption="Power of the groove's floor along the track over its background; the peak is the marks' spacing.",
        draw=partial(figures.marks, marks),
    )
    value = known("dot_spacing", marks.dot_spacing, uncertainty=marks.dot_spacing_uncertainty)
    return Part(values=(value,), figures=(drawn,))
