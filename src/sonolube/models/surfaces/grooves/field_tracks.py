"""All wear tracks of a field, told apart from short and narrow features."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, NoGroove
from sonolube.models.surfaces.form_removal import fit_form
from sonolube.models.surfaces.grooves.detection import DetectedGroove, detect_groove, height_range
from sonolube.models.surfaces.height_map import HeightMap, Mask

_MAX_TRACKS = 8
_MIN_CONTRAST = 5.0  # depth of a trough over the deviation of the section
_MIN_DEPTH = 0.08  # over that of the deepest track
_UNWORN = 3.0  # deviations, within which the section between two troughs is unworn
_MIN_GAP, _MIN_GAP_BINS = 0.15, 4  # between two tracks, over the narrower one, and in bins
_MARGIN = 0.15  # of the width of a track, on either side of it
_SEGMENTS = 12  # along a track
_PRESENT = 0.25  # depth of a segment over the upper quartile of all
_MIN_PRESENT = 0.8  # fraction of the segments of a track
_NARROWEST = 0.03  # width of a track over the longer side of the field
_MIN_LENGTH = 0.5  # of a further track over the shorter side of the field: a corner shows too little of one
_MASKED = 0.25  # of the width, left out on either side of a feature


@dataclass(frozen=True, kw_only=True, slots=True)
class FieldTrack:
    """A wear track found in a field, before its unworn reference is fitted.

    Parameters
    ----------
    detected : DetectedGroove
        Its position and worn band.
    groove_width : float
        Approximate width. [m]
    groove_depth : float
        Approximate depth. [m]
    """

    detected: DetectedGroove
    groove_width: float
    groove_depth: float

    @property
    def track_offset(self) -> float:
        """Distance of the track from the centre of the field, positive to the left of its direction. [m]"""
        return self.detected.track.track_offset


class FieldTracks(NamedTuple):
    """Wear tracks of a field, from left to right or from the innermost radius outwards."""

    tracks: tuple[FieldTrack, ...]
    others: tuple[str, ...]  # short and narrow features, in words
    masked: HeightMap  # the scan without those features

    def listed(self) -> str:
        """Number of tracks, with position, width and depth of each."""
        rows = [
            f"{number} at {1e3 * track.track_offset:+.2f} mm from the centre of the field,"
            f" {1e3 * track.groove_width:.2g} mm wide, {1e6 * track.groove_depth:.2g} um deep"
            for number, track in enumerate(self.tracks, start=1)
        ]
        return f"{len(rows)} wear tracks in the field: " + "; ".join(rows)


class _Trough(NamedTuple):
    """Trough of a section between two distances, with its depth, in m."""

    left: float
    right: float
    depth: float
    band: tuple[float, float]


def field_tracks(surface: HeightMap) -> FieldTracks:
    """All wear tracks of a field, by repeated detection in what is left.

    Parameters
    ----------
    surface : HeightMap

    Returns
    -------
    FieldTracks

    Raises
    ------
    NoGroove
        If no track crosses the field; the line names what else was found.
    """
    found: list[FieldTrack] = []
    others: list[str] = []
    rest, masked = surface, surface
    for _ in range(_MAX_TRACKS):
        if found and height_range(rest) < _MIN_DEPTH * max(track.groove_depth for track in found):
            break
        try:
            detected = detect_groove(rest)
        except (NoGroove, InvalidInput):
            if not found and not others:
                raise
            break
        transverse, arc_length = detected.track.curvilinear_coordinates(surface)
        troughs = _troughs(detected)
        deepest = max([trough.depth for trough in troughs] + [track.groove_depth for track in found])
        for trough in troughs:
            long = not (found or others) or _length(rest, transverse, arc_length, trough) >= _MIN_LENGTH
            if not long or trough.depth < _MIN_DEPTH * deepest:
                continue
            if feature := _other_feature(rest, transverse, arc_length, trough):
                others.append(feature)
                masked = _without(masked, transverse, trough)
            else:
                found.append(_track(detected, trough, alone=len(troughs) == 1))
        for trough in troughs:
            rest = _without(rest, transverse, trough, wider=True)
        rest = rest.with_height(rest.height - fit_form(rest, degree=2).height)  # a hollow of the form is no track
    if not found:
        raise NoGroove(f"no groove found: {'; '.join(others)}")
    return FieldTracks(tuple(sorted(found, key=_order)), tuple(others), masked)


def without_tracks(surface: HeightMap, tracks: Sequence[FieldTrack]) -> HeightMap:
    """Scan with the bands of tracks as missing pixels."""
    for track in tracks:
        transverse, _ = track.detected.track.curvilinear_coordinates(surface)
        low, high = track.detected.worn_band
        surface = _masked(surface, (transverse > low) & (transverse < high))
    return surface


def _order(track: FieldTrack) -> float:
    """Radius of a circular track; place of a straight one from the left, or from the first row."""
    line = track.detected.track
    if abs(line.track_curvature) * track.groove_width > 1e-3:
        return abs(1 / line.track_curvature - line.track_offset)
    x, y = -math.sin(line.track_direction), math.cos(line.track_direction)
    return line.track_offset * (x if abs(x) > 0.5 else y)


def _troughs(detected: DetectedGroove) -> list[_Trough]:
    """Troughs of the section of a detected groove that unworn surface parts."""
    s, z = detected.section_transverse, detected.section_height
    deviation = detected.deviation
    depth = -float(z.min())
    unworn = -max(_UNWORN * deviation, 0.03 * depth)
    inside = (s >= detected.worn_band[0]) & (s <= detected.worn_band[1])
    low = np.flatnonzero(inside & (z < unworn))
    step = float(np.median(np.diff(s)))
    runs = [run for run in np.split(low, np.flatnonzero(np.diff(low) > 1) + 1) if run.size]
    merged: list[list[int]] = []
    for run in runs:
        first, last = int(run[0]), int(run[-1])
        if merged:
            before = merged[-1]
            narrower = min(last - first + 1, before[1] - before[0] + 1)
            if first - before[1] - 1 < max(_MIN_GAP_BINS, _MIN_GAP * narrower):
                before[1] = last
                continue
        merged.append([first, last])
    deep = [run for run in merged if -float(z[run[0] : run[1] + 1].min()) > _MIN_CONTRAST * deviation]
    if len(deep) <= 1:
        first, last = (deep or [[int(low[0]), int(low[-1])]])[0] if low.size else (0, s.size - 1)
        return [_Trough(float(s[first]) - step / 2, float(s[last]) + step / 2, depth, detected.worn_band)]
    return [
        _Trough(
            float(s[run[0]]) - step / 2,
            float(s[run[1]]) + step / 2,
            -float(z[run[0] : run[1] + 1].min()),
            _band(s, z, run, deep, number, _UNWORN * deviation),
        )
        for number, run in enumerate(deep)
    ]


def _band(
    s: Floats, z: Floats, run: list[int], runs: list[list[int]], number: int, level: float
) -> tuple[float, float]:
    """Worn band of one of several troughs, with its ridges, up to half way to the next."""
    lowest = -math.inf if number == 0 else (s[runs[number - 1][1]] + s[run[0]]) / 2
    highest = math.inf if number == len(runs) - 1 else (s[run[1]] + s[runs[number + 1][0]]) / 2
    margin = _MARGIN * (s[run[1]] - s[run[0]])
    first, last = run
    while first > 0 and abs(z[first - 1]) > level:
        first -= 1
    while last < s.size - 1 and abs(z[last + 1]) > level:
        last += 1
    left = -math.inf if first == 0 else s[first] - margin
    right = math.inf if last == s.size - 1 else s[last] + margin
    return float(max(left, lowest)), float(min(right, highest))


def _track(detected: DetectedGroove, trough: _Trough, *, alone: bool) -> FieldTrack:
    """Track of a trough; that of the detection where it is the only one."""
    width = trough.right - trough.left
    if alone:
        return FieldTrack(detected=detected, groove_width=width, groove_depth=trough.depth)
    middle = (trough.left + trough.right) / 2
    track = replace(detected.track, track_offset=detected.track.track_offset + middle)
    band = (trough.band[0] - middle, trough.band[1] - middle)
    return FieldTrack(
        detected=replace(detected, track=track, worn_band=band), groove_width=width, groove_depth=trough.depth
    )


def _other_feature(surface: HeightMap, transverse: Floats, arc_length: Floats, trough: _Trough) -> str:
    """Description of a trough too narrow or too short for a track; empty for a track."""
    width, middle = trough.right - trough.left, (trough.left + trough.right) / 2
    size = f"a trough {1e6 * width:.0f} um wide and {1e6 * trough.depth:.2g} um deep on average"
    if width < _NARROWEST * max(surface.sides):
        return f"{size} is a scratch, or too narrow for this field: scan it at a higher magnification"
    core = surface.measured & (np.abs(transverse - middle) < width / 4)
    if not core.any():
        return ""
    start, stop = float(arc_length[core].min()), float(arc_length[core].max())
    segment = np.clip((arc_length - start) / (stop - start) * _SEGMENTS, 0, _SEGMENTS - 1e-9).astype(np.intp)
    near = (transverse > trough.left - width) & (transverse < trough.right + width)
    beside = surface.measured & near & ((transverse < trough.band[0]) | (transverse > trough.band[1]))
    if np.count_nonzero(beside) < np.count_nonzero(core) / 20:
        beside = surface.measured & ((transverse < trough.left) | (transverse > trough.right))
    level = _plane_above(surface, transverse, arc_length, beside)
    depths = _segment_means(level - surface.height, segment, core)
    known = np.isfinite(depths)
    if np.count_nonzero(known) < 3:
        return ""
    least = _PRESENT * float(np.quantile(depths[known], 0.75))
    present = np.count_nonzero(depths[known] > least)
    if present >= _MIN_PRESENT * np.count_nonzero(known):
        return ""
    length = present / _SEGMENTS * (stop - start)
    return f"{size} is only {1e3 * length:.2g} mm long, where a track crosses the field: a scratch or a pit"


def _length(surface: HeightMap, transverse: Floats, arc_length: Floats, trough: _Trough) -> float:
    """Length in the field of the middle of a trough, over the shorter side of the field."""
    near = np.abs(transverse - (trough.left + trough.right) / 2) < (trough.right - trough.left) / 4
    near &= surface.measured
    return float(np.ptp(arc_length[near])) / min(surface.sides) if near.any() else 0.0


def _plane_above(surface: HeightMap, transverse: Floats, arc_length: Floats, beside: Mask) -> Floats:
    """Plane in the coordinates of the track through the pixels beside it, as heights of all pixels in m."""
    scale = max(float(np.ptp(arc_length)), float(np.ptp(transverse)))
    terms = np.stack([np.ones_like(transverse), transverse / scale, arc_length / scale])
    chosen = terms[:, beside]
    coefficients = np.linalg.lstsq(chosen @ chosen.T, chosen @ surface.height[beside], rcond=1e-9)[0]
    return np.asarray(np.tensordot(coefficients, terms, 1))


def _segment_means(values: Floats, segment: NDArray[np.intp], counted: Mask) -> Floats:
    """Mean of the counted pixels of each segment, NaN where there are few."""
    numbers = segment[counted]
    count = np.bincount(numbers, minlength=_SEGMENTS)
    total = np.bincount(numbers, values[counted], minlength=_SEGMENTS)
    return np.where(count > count.max() / 20, total / np.maximum(count, 1), np.nan)


def _without(surface: HeightMap, transverse: Floats, trough: _Trough, wider: bool = False) -> HeightMap:
    """Scan with a trough and a margin as missing pixels."""
    margin = _MASKED * (trough.right - trough.left)
    low, high = trough.left - margin, trough.right + margin
    if wider and math.isfinite(sum(trough.band)):
        low, high = min(low, trough.band[0]), max(high, trough.band[1])
    return _masked(surface, (transverse > low) & (transverse < high))


def _masked(surface: HeightMap, mask: Mask) -> HeightMap:
    """Scan with masked pixels as missing ones; the scan itself where nothing would be left."""
    height = np.where(mask, np.nan, surface.height)
    return surface.with_height(height) if np.isfinite(height).any() else surface
