"""Wear groove of a scan: width, depth, wear and pile-up volume with uncertainty, against the unworn reference."""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import median_filter, uniform_filter

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, NoGroove, SeveralGrooves
from sonolube.models.surfaces.form_removal import robust_deviation
from sonolube.models.surfaces.grooves.detection import DetectedGroove
from sonolube.models.surfaces.grooves.field_tracks import FieldTracks, field_tracks, without_tracks
from sonolube.models.surfaces.grooves.groove_intervals import GrooveErrors, section_estimates
from sonolube.models.surfaces.grooves.track import (
    CrossSections,
    GrooveExtent,
    GrooveTrack,
    MeanCrossSection,
    cross_sections,
    groove_extent,
    mean_cross_section,
)
from sonolube.models.surfaces.grooves.unworn_reference import UnwornReference, unworn_reference
from sonolube.models.surfaces.height_map import HeightMap, Mask

_DEVIATIONS = 8.0  # over the standard deviation of heights about the median of their neighbours
_COMMON = 4.0  # over the deviation that 2 % of the pixels exceed
_LEAST = 0.05  # of the range of heights: the kink of an edge is less


def without_outliers(surface: HeightMap) -> HeightMap:
    """Scan with outliers of one or two pixels as missing ones."""
    measured = surface.measured
    share = uniform_filter(measured.astype(np.float64), 5)
    mean = uniform_filter(np.where(measured, surface.height, 0.0), 5) / np.maximum(share, 0.01)
    filled = np.where(measured, surface.height, mean)
    deviation = np.abs(filled - median_filter(filled, 3))
    of_measured = deviation[measured]
    low, high = np.quantile(filled[measured], [0.005, 0.995])
    limit = max(
        _DEVIATIONS * robust_deviation(of_measured),
        _COMMON * float(np.quantile(of_measured, 0.98)),
        _LEAST * float(high - low),
    )
    outlying = measured & (deviation > limit)
    if not outlying.any() or outlying.sum() == measured.sum():
        return surface
    return surface.with_height(np.where(outlying, np.nan, surface.height))


_MAX_ITERATIONS = 3
_SHOULDER = 0.25  # of the width, left out of the reference on either side
_MARGIN = 0.04  # of the width, beyond ridges
_SPIKE = 8.0  # height of debris and dust over the standard deviation of the unworn surface
_WINDOW = 5  # pixels, of the smoothing in which projections are detected
_PROJECTION = 5.0  # height of a projection over the standard deviation of the smoothed unworn surface
_CONVERGED = 2.0  # pixels, change of an edge
_BEYOND_WAVINESS = 10.0  # depth over the standard deviation of the waviness from which the evidence is not compared
_UNCERTAIN, _MISSING = 0.1, 0.3  # relative uncertainty and fraction of missing pixels from which on a caveat is given
_ZONES = 10  # of the width; in the outermost ones a height above the unworn surface belongs to the ridge
_BESIDE = 0.5  # of the width, on either side of the groove in cross-sections


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Groove:
    """Wear groove measured in one scan.

    Parameters
    ----------
    track : GrooveTrack
        Centre line of the groove.
    levelled : HeightMap
        Heights above the unworn reference, for 3D views and material ratio curves.
    reference : UnwornReference
        The unworn surface.
    worn, piled_up : bool array, shape of the heights
        Pixels of the groove, and pixels of ridges and projections above the unworn surface.
    mean_cross_section : MeanCrossSection
    cross_sections : CrossSections
        Single cross-sections along the track.
    groove_width : float
        Distance of the edges, where the mean cross-section meets the unworn surface; where an edge lies outside the
        field, to the far corner of the field. [m]
    groove_width_interval : tuple of float
        95 % interval of the width, in m.
    groove_depth : float
        Greatest depth of the mean cross-section. [m]
    groove_depth_interval : tuple of float
        95 % interval of the depth, in m.
    cross_section_area : float
        Area of the mean cross-section below the unworn surface: volume per length of track. [m2]
    cross_section_area_interval : tuple of float
        95 % interval of the area, in m2.
    track_length : float
        Length of track in the field: area of the groove over its width. [m]
    wear_volume : float
        Volume below the unworn surface within the field. [m3]
    wear_volume_uncertainty : float
        Standard uncertainty from the reference under the groove and the roughness. [m3]
    wear_volume_interval : tuple of float
        95 % interval of the wear volume, in m3.
    pile_up_volume : float
        Volume of ridges and projections above the unworn surface within the field. [m3]
    complete : bool
        Whether both edges lie in the field.
    caveat : str
        Warnings about the result; empty where there are none.
    track_number : int
        Number of the track among those in the field, from the left or from the innermost radius.
    track_count : int
        Number of wear tracks in the field.
    """

    track: GrooveTrack
    levelled: HeightMap
    reference: UnwornReference
    worn: Mask
    piled_up: Mask
    mean_cross_section: MeanCrossSection
    cross_sections: CrossSections
    groove_width: float
    groove_width_interval: tuple[float, float]
    groove_depth: float
    groove_depth_interval: tuple[float, float]
    cross_section_area: float
    cross_section_area_interval: tuple[float, float]
    track_length: float
    wear_volume: float
    wear_volume_uncertainty: float
    wear_volume_interval: tuple[float, float]
    pile_up_volume: float
    complete: bool
    caveat: str
    track_number: int = 1
    track_count: int = 1

    @property
    def net_volume(self) -> float:
        """Net wear volume: volume below the unworn surface less the pile-up volume. [m3]"""
        return self.wear_volume - self.pile_up_volume


def measure_groove(surface: HeightMap, *, track_number: int | None = None) -> Groove:
    r"""Wear groove of a scan: detection, unworn reference, and volumes by integration over pixels.

    Parameters
    ----------
    surface : HeightMap
        As measured, not levelled; the form of a ball or cylinder removed beforehand.
    track_number : int, optional
        Which of several tracks to measure, from 1: from the left or, for circular tracks, from the innermost radius.

    Returns
    -------
    Groove

    Raises
    ------
    NoGroove
        If no track crosses the field, waviness alone has the greater evidence, or the groove fills the field.
    SeveralGrooves
        If there are several tracks and no number, with their positions, widths and depths.
    InvalidInput
        If too little of the field was measured, or there is no track of that number.

    See Also
    --------
    sonolube.models.surfaces.grooves.ball_on_disc.disc_volume_loss : Volume from width and tip radius alone, by ASTM
    G99.

    Notes
    -----
    With the heights :math:`z` above the unworn reference and the area :math:`\Delta x \Delta y` of a pixel

    .. math:: V = -\Delta x \Delta y \sum_{\text{worn}} z, \qquad
        V_\text{pile-up} = \Delta x \Delta y \sum_{\text{piled up}} z .

    A missing pixel takes the height of the mean cross-section. The edges are those of the mean cross-section, so that
    roughness is not rectified into volume. A shallow groove is accepted only if a reference with a free section has
    greater evidence than waviness alone.
    """
    surface = without_outliers(surface)
    field = field_tracks(surface)
    number = _chosen(field, track_number)
    others = [track for place, track in enumerate(field.tracks, start=1) if place != number]
    surface = without_tracks(field.masked, others)
    detected = field.tracks[number - 1].detected
    track = detected.track
    transverse, _ = track.curvilinear_coordinates(surface)
    band = _worn_band(_detected_extent(detected, transverse), transverse)
    excluded = np.zeros(surface.height.shape, dtype=np.bool_)
    for iteration in range(_MAX_ITERATIONS):
        reference = unworn_reference(surface, track=track, worn_band=band, excluded=excluded)
        levelled = surface.with_height(surface.height - reference.surface.height)
        track = reference.refined_track(track)
        transverse, _ = track.curvilinear_coordinates(surface)
        excluded = _spikes(levelled, transverse, band) | _projections(levelled, transverse, band)
        section = mean_cross_section(levelled, transverse, levelled.measured)
        edges = groove_extent(section, band)
        previous, band = band, _worn_band(edges, transverse)
        if iteration and np.allclose(band, previous, rtol=0, atol=_CONVERGED * section.step):
            break
    _require_evidence(reference, depth=-float(np.nanmin(section.height)))
    middle = (edges.left + edges.right) / 2
    track = replace(track, track_offset=track.track_offset + middle)
    section = replace(section, transverse=section.transverse - middle)
    counted = levelled.measured & ~excluded
    found = _measured(levelled, surface, reference, track, section, edges.shifted(-middle), counted)
    caveat = "; ".join(part for part in (found.caveat, *field.others) if part)
    return replace(found, track_number=number, track_count=len(field.tracks), caveat=caveat)


def _worn_band(edges: GrooveExtent, transverse: Floats) -> tuple[float, float]:
    """Distances in m beyond which nothing is worn or piled up; infinite where the field ends within the groove.

    Ridges too low to be seen would lift the reference: so a shoulder is left out on either side, at most half of what
    is unworn beside it.
    """
    wide, margin = _SHOULDER * (edges.right - edges.left), _MARGIN * (edges.right - edges.left)
    left = min(edges.left_foot - margin, edges.left - min(wide, (edges.left - float(transverse.min())) / 2))
    right = max(edges.right_foot + margin, edges.right + min(wide, (float(transverse.max()) - edges.right) / 2))
    return left if edges.left_in_field else -math.inf, right if edges.right_in_field else math.inf


def _detected_extent(detected: DetectedGroove, transverse: Floats) -> GrooveExtent:
    """Worn band of the detection as first edges."""
    band = detected.worn_band
    left, right = max(band[0], float(transverse.min())), min(band[1], float(transverse.max()))
    return GrooveExtent(left, right, left, right, math.isfinite(band[0]), math.isfinite(band[1]))


def _chosen(field: FieldTracks, number: int | None) -> int:
    """Number of the track to measure."""
    count = len(field.tracks)
    if number is None:
        if count > 1:
            raise SeveralGrooves(f"{field.listed()}; choose one by its number (--track)")
        return 1
    if not 1 <= number <= count:
        there = field.listed() if count > 1 else "one wear track in the field"
        raise InvalidInput(f"track_number must be 1 to {count}, got {number}: {there}")
    return number


def _measured(
    levelled: HeightMap,
    surface: HeightMap,
    reference: UnwornReference,
    track: GrooveTrack,
    section: MeanCrossSection,
    first_edges: GrooveExtent,
    counted: Mask,
) -> Groove:
    """Groove about a known track, with its intervals."""
    transverse, arc_length = track.curvilinear_coordinates(levelled)
    errors = GrooveErrors(levelled, surface, reference, (transverse, arc_length), section, first_edges, counted)
    estimates = section_estimates(errors, first_edges)
    if estimates is None:
        raise NoGroove(
            f"no groove found: a trough {(first_edges.right - first_edges.left) / section.step:.0f} pixels wide is too"
            " narrow to be measured; scan it at a higher magnification"
        )
    edges, width_estimate, depth_estimate = estimates
    pixel = levelled.spacing_x * levelled.spacing_y
    inside = (transverse > edges.left) & (transverse < edges.right)
    beside = (transverse < edges.left_foot) | (transverse > edges.right_foot)
    projection = _projections(levelled, transverse, (edges.left, edges.right))
    worn, piled_up = inside & ~projection, projection | ~(inside | beside)
    height = np.where(levelled.measured, levelled.height, section.at(transverse))
    width = edges.right - edges.left
    area = pixel * np.count_nonzero(inside)
    wear_volume = -float(height[worn].sum()) * pixel
    volume_estimate = errors.sum_over(worn, wear_volume)
    section_area = _mean_section_area(height, worn, inside, transverse, section.step)
    relative = volume_estimate.half_width / wear_volume
    missing = np.count_nonzero(inside & ~levelled.measured) / np.count_nonzero(inside)
    return Groove(
        track=track,
        levelled=levelled,
        reference=reference,
        worn=worn,
        piled_up=piled_up,
        mean_cross_section=section,
        cross_sections=cross_sections(
            levelled, track, reach=(edges.left_foot - _BESIDE * width, edges.right_foot + _BESIDE * width)
        ),
        groove_width=width_estimate.value,
        groove_width_interval=width_estimate.interval,
        groove_depth=depth_estimate.value,
        groove_depth_interval=depth_estimate.interval,
        cross_section_area=section_area,
        cross_section_area_interval=(section_area * (1 - relative), section_area * (1 + relative)),
        track_length=area / width,
        wear_volume=wear_volume,
        wear_volume_uncertainty=volume_estimate.uncertainty,
        wear_volume_interval=volume_estimate.interval,
        pile_up_volume=float(height[piled_up].sum()) * pixel,
        complete=edges.left_in_field and edges.right_in_field,
        caveat=_caveat(edges, volume_estimate.uncertainty / wear_volume, missing),
    )


def _spikes(levelled: HeightMap, transverse: Floats, band: tuple[float, float]) -> Mask:
    """Mask of debris and dust beside the band, by the median absolute deviation."""
    beside = levelled.measured & ((transverse < band[0]) | (transverse > band[1]))
    highest = _SPIKE * robust_deviation(levelled.height[beside])
    return beside & (np.abs(np.where(beside, levelled.height, 0.0)) > highest)


def _projections(levelled: HeightMap, transverse: Floats, between: tuple[float, float]) -> Mask:
    """Mask of adhered material: pixels well inside a groove that lie above the unworn surface after smoothing."""
    smooth, margin = _smooth(levelled), (between[1] - between[0]) / _ZONES
    inside = (transverse > between[0] + margin) & (transverse < between[1] - margin)
    deviation = float(np.std(smooth[(transverse < between[0]) | (transverse > between[1])]))
    return inside & (smooth > _PROJECTION * deviation)


def _smooth(levelled: HeightMap) -> Floats:
    """Moving average of the measured heights; zero where less than half of the window was measured."""
    fraction = uniform_filter(levelled.measured.astype(np.float64), _WINDOW)
    total = uniform_filter(np.where(levelled.measured, levelled.height, 0.0), _WINDOW)
    return np.where(fraction > 1 / 2, total / np.maximum(fraction, 1 / 2), 0.0)


def _mean_section_area(height: Floats, worn: Mask, inside: Mask, transverse: Floats, step: float) -> float:
    """Area below the unworn surface of the mean cross-section of the worn pixels."""
    bins = np.floor((transverse[inside] - transverse[inside].min()) / step).astype(np.intp)
    depth = np.where(worn, -height, 0.0)[inside]
    count = np.bincount(bins)
    return float(np.sum(np.bincount(bins, depth)[count > 0] / count[count > 0])) * step


def _require_evidence(reference: UnwornReference, *, depth: float) -> None:
    """Refuse a shallow groove for which waviness alone has the greater evidence."""
    if depth > _BEYOND_WAVINESS * reference.waviness_height:
        return
    if not reference.groove_has_evidence():
        raise NoGroove(f"no groove found: the trough, {depth:.2g} m deep, is explained by waviness as well as by wear")


def _caveat(edges: GrooveExtent, relative_uncertainty: float, missing_fraction: float) -> str:
    """Warnings about cut edges, a large uncertainty and missing pixels."""
    caveats = []
    if not (edges.left_in_field and edges.right_in_field):
        caveats.append("an edge of the groove lies outside the field: width, area and volume are of the part inside")
    if relative_uncertainty > _UNCERTAIN:
        caveats.append(
            f"the volume is uncertain by {relative_uncertainty:.0%}: the unworn surface is wavy, or little of it is in"
            " the field"
        )
    if missing_fraction > _MISSING:
        caveats.append(f"{missing_fraction:.0%} of the groove was not measured, and is assumed as deep as the rest")
    return "; ".join(caveats)
