"""Wear grooves: how wide and deep, how much is gone and how much piled up, with what uncertainty."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter

from sonolube.checks import Floats
from sonolube.errors import NoGroove
from sonolube.surfaces.grooves.detection import detect_groove
from sonolube.surfaces.grooves.sections import (
    CrossSections,
    GrooveExtent,
    MeanCrossSection,
    band_with_margin,
    cross_sections,
    groove_extent,
    mean_cross_section,
)
from sonolube.surfaces.grooves.track import GrooveTrack
from sonolube.surfaces.grooves.unworn_reference import UnwornReference, unworn_reference
from sonolube.surfaces.height_map import HeightMap

Mask = NDArray[np.bool_]

_ROUNDS = 3
_SPIKE = 8.0  # standard deviations: debris and dust, which count for no reference
_SMOOTHED = 5  # pixels: over which a projection must stand above the unworn surface
_PROJECTION = 5.0  # standard deviations of the smoothed unworn surface
_RESTED = 2.0  # pixels that an edge still moves
_BEYOND_WAVINESS = 10.0  # depth over the spread of the waviness: beyond dispute above
_UNCERTAIN, _HOLED = 0.1, 0.3
_INNER = 10  # parts of the width, of which the outermost may hold a ridge and no projection
_BESIDE = 0.5  # of the width, shown beside it in sections


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Groove:
    """A wear groove as measured in one scan.

    Parameters
    ----------
    track : GrooveTrack
        Its middle line.
    levelled : HeightMap
        Heights above the unworn surface, for views in three dimensions and Abbott curves.
    reference : UnwornReference
        The unworn surface.
    worn, piled_up : bool array, shape of the heights
        Pixels of the groove, and pixels beside or in it that stand above the unworn surface.
    section : MeanSection
        Its mean section.
    sections : CrossSections
        Single sections along the straightened track.
    groove_width : float
        Distance of the edges, where the mean section meets the unworn surface. [m]
    groove_depth : float
        Greatest depth of the mean section. [m]
    cross_section_area : float
        Area of the mean section below the unworn surface: volume per length of track. [m2]
    track_length : float
        Length of track in the field, area of the groove over its width. [m]
    wear_volume : float
        Volume below the unworn surface within the field. [m3]
    wear_volume_uncertainty : float
        Standard uncertainty, from the unworn surface under the groove, roughness and missing pixels. [m3]
    pile_up_volume : float
        Volume of ridges and projections above the unworn surface within the field. [m3]
    complete : bool
        Whether both edges lie in the field, so that the section is the whole one.
    caveat : str
        What is doubtful about it; empty where nothing is.
    """

    track: GrooveTrack
    levelled: HeightMap
    reference: UnwornReference
    worn: Mask
    piled_up: Mask
    section: MeanCrossSection
    sections: CrossSections
    groove_width: float
    groove_depth: float
    cross_section_area: float
    track_length: float
    wear_volume: float
    wear_volume_uncertainty: float
    pile_up_volume: float
    complete: bool
    caveat: str

    @property
    def net_volume(self) -> float:
        """Volume that has left the field: what is missing below the unworn surface less what piled up. [m3]"""
        return self.wear_volume - self.pile_up_volume


def measure_groove(surface: HeightMap) -> Groove:
    """Find a groove and measure it against the surface as it was before.

    Parameters
    ----------
    surface : HeightMap
        As measured, not levelled; with the form of a ball or cylinder taken off.

    Returns
    -------
    Groove

    Raises
    ------
    NoGroove
        If nothing stands out, a trough is no more than waviness, or the groove fills the whole field.
    InvalidInput
        If too little of the field was measured.

    Notes
    -----
    The volume is the sum over pixels between the edges; a missing pixel counts as the mean section is deep there. Edges
    lie where the mean section meets the unworn surface, so that roughness is not rectified into volume. A groove must
    be worth its free section: where waves alone account for the heights with greater evidence, there is none.
    """
    found = detect_groove(surface)
    track, band = found.track, found.worn_band
    left_out: Mask | None = None
    for turn in range(_ROUNDS):
        reference = unworn_reference(surface, track=track, worn_band=band, left_out=left_out)
        levelled = surface.with_height(surface.height - reference.surface.height)
        track = reference.better_track(track)
        across, _ = track.curvilinear_coordinates(surface)
        left_out = _spikes(levelled, across, band) | _projections(levelled, across, band)
        section = mean_cross_section(levelled, across, levelled.measured)
        edges = groove_extent(section, band)
        before, around = band, band_with_margin(edges)
        band = (min(band[0], around[0]), max(band[1], around[1]))
        if turn and np.allclose(band, before, rtol=0, atol=_RESTED * section.step):
            break
    _refuse_waviness(reference, depth=-float(np.nanmin(section.height)))
    middle = (edges.left + edges.right) / 2
    track = replace(track, track_offset=track.track_offset + middle)
    section = replace(section, across=section.across - middle)
    return _measured(levelled, reference, track, section, edges.shifted(-middle))


def _measured(
    levelled: HeightMap, reference: UnwornReference, track: GrooveTrack, section: MeanCrossSection, edges: GrooveExtent
) -> Groove:
    across, _ = track.curvilinear_coordinates(levelled)
    pixel = levelled.spacing_x * levelled.spacing_y
    inside = (across > edges.left) & (across < edges.right)
    beside = (across < edges.left_foot) | (across > edges.right_foot)
    spread = float(np.std(_smooth(levelled)[beside]))
    projection = _projections(levelled, across, (edges.left, edges.right))
    worn, piled_up = inside & ~projection, projection | ~(inside | beside)
    height = np.where(levelled.measured, levelled.height, section.at(across))
    width = edges.right - edges.left
    missing = inside & ~levelled.measured
    about = levelled.height[inside & levelled.measured] - section.at(across[inside & levelled.measured])
    area = pixel * np.count_nonzero(inside)
    wear_volume = -float(height[worn].sum()) * pixel
    uncertainty = math.hypot(
        reference.volume_uncertainty(inside),
        spread * math.sqrt(_SMOOTHED**2 * pixel * area),
        float(np.std(about)) * math.sqrt(np.count_nonzero(missing)) * pixel,
    )
    return Groove(
        track=track,
        levelled=levelled,
        reference=reference,
        worn=worn,
        piled_up=piled_up,
        section=section,
        sections=cross_sections(
            levelled, track, reach=(edges.left_foot - _BESIDE * width, edges.right_foot + _BESIDE * width)
        ),
        groove_width=width,
        groove_depth=-float(np.nanmin(section.height)),
        cross_section_area=_area_of_section(height, worn, inside, across, section.step),
        track_length=area / width,
        wear_volume=wear_volume,
        wear_volume_uncertainty=uncertainty,
        pile_up_volume=float(height[piled_up].sum()) * pixel,
        complete=edges.left_seen and edges.right_seen,
        caveat=_caveat(edges, uncertainty / wear_volume, np.count_nonzero(missing) / np.count_nonzero(inside)),
    )


def _spikes(levelled: HeightMap, across: Floats, band: tuple[float, float]) -> Mask:
    beside = levelled.measured & ((across < band[0]) | (across > band[1]))
    spread = 1.4826 * float(np.median(np.abs(levelled.height[beside])))  # of Gaussian heights
    return beside & (np.abs(np.where(beside, levelled.height, 0.0)) > _SPIKE * spread)


def _projections(levelled: HeightMap, across: Floats, between: tuple[float, float]) -> Mask:
    """Return where, well inside a groove, the surface stands above the unworn one."""
    smooth, room = _smooth(levelled), (between[1] - between[0]) / _INNER
    inside = (across > between[0] + room) & (across < between[1] - room)
    spread = float(np.std(smooth[(across < between[0]) | (across > between[1])]))
    return inside & (smooth > _PROJECTION * spread)


def _smooth(levelled: HeightMap) -> Floats:
    share = uniform_filter(levelled.measured.astype(np.float64), _SMOOTHED)
    total = uniform_filter(np.where(levelled.measured, levelled.height, 0.0), _SMOOTHED)
    return np.where(share > 1 / 2, total / np.maximum(share, 1 / 2), 0.0)


def _area_of_section(height: Floats, worn: Mask, inside: Mask, across: Floats, step: float) -> float:
    bins = np.floor((across[inside] - across[inside].min()) / step).astype(np.intp)
    depth = np.where(worn, -height, 0.0)[inside]
    count = np.bincount(bins)
    return float(np.sum(np.bincount(bins, depth)[count > 0] / count[count > 0])) * step


def _refuse_waviness(reference: UnwornReference, *, depth: float) -> None:
    if depth > _BEYOND_WAVINESS * reference.waviness_height:
        return
    if not reference.groove_is_borne_out():
        raise NoGroove(
            f"no groove found: the trough, {depth:.2g} m deep, is accounted for by waviness as well as by wear"
        )


def _caveat(edges: GrooveExtent, relative_uncertainty: float, missing_fraction: float) -> str:
    caveats = []
    if not (edges.left_seen and edges.right_seen):
        caveats.append("an edge of the groove lies outside the field: width, area and volume are of what is seen")
    if relative_uncertainty > _UNCERTAIN:
        caveats.append(
            f"the volume is uncertain by {relative_uncertainty:.0%}: the unworn surface is wavy, or little of it seen"
        )
    if missing_fraction > _HOLED:
        caveats.append(f"{missing_fraction:.0%} of the groove was not measured and is taken to be as deep as the rest")
    return "; ".join(caveats)
