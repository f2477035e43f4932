"""Finding a wear groove in a scan, wherever it lies, however wide it is and whichever way it runs."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.linalg import solveh_banded
from scipy.optimize import minimize

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, NoGroove
from sonolube.surfaces.grooves.plane_coordinates import arc_coordinates, centred_coordinates
from sonolube.surfaces.grooves.track import GrooveTrack
from sonolube.surfaces.height_map import HeightMap

_COARSE, _FINE = 72, 160  # blocks along the longer side
_DIRECTIONS = 60
_TURNS = (-1.0, -0.4, -0.15, 0.0, 0.15, 0.4, 1.0)  # turn of the track over the longer side, in rad
_LEAST_SEEN = 0.1  # of the fullest bin of a section: others see too little of the track
_LEAST_UNWORN = 0.06  # share of the section
_LEAST_WORN = 3  # bins
_LEAST_CONTRAST = 5.0  # depth over the spread beside the groove
_SHOULDER = 0.4  # slope of the unworn ends over the mean slope of the flanks
_ROOM = 0.05  # of the width, left beside what is worn
_RIDGE = 1e-9


@dataclass(frozen=True, kw_only=True, slots=True)
class DetectedGroove:
    """Where a groove lies, before the unworn surface is known well.

    Parameters
    ----------
    track : GrooveTrack
        Its middle line.
    worn_band : tuple of float
        Between which distances from the track the surface is worn or piled up, with some room beside it, in m;
        infinite where the field ends before.
    contrast : float
        Greatest depth of its mean section over the spread of the mean section beside it.
    """

    track: GrooveTrack
    worn_band: tuple[float, float]
    contrast: float


def detect_groove(surface: HeightMap) -> DetectedGroove:
    """Find a straight or circular groove.

    Parameters
    ----------
    surface : HeightMap
        As measured: tilted, wavy, rough, with missing pixels; with the form of a ball or cylinder taken off.

    Returns
    -------
    FoundGroove

    Raises
    ------
    NoGroove
        If nothing stands out, or a groove leaves nothing of the unworn surface in the field.

    Notes
    -----
    Along a groove the section stays the same. Of all directions and curvatures that is taken in which one section and
    a slope along the track leave the least of the heights unexplained. In this section the worn stretch is the one
    that splits it into two populations about a straight line with the greatest likelihood, the line going through the
    outer one. No share of the field has to be unworn but a sixteenth of the section.
    """
    track = _track(surface)
    section = _section(_points(surface, _FINE), track)
    first, last, line = _worn_stretch(section)
    outer = np.ones(section.across.size, dtype=np.bool_)
    outer[first:last] = False
    below = section.height - line[0] - line[1] * section.across
    spread = math.sqrt(float(np.mean(below[outer] ** 2)) + section.noise**2)
    depth = -float(np.min(_smoothed(below[first:last])))
    if depth < _LEAST_CONTRAST * spread:
        raise NoGroove(
            f"no groove found: the deepest trough is {depth:.2g} m deep, and heights beside it vary by {spread:.2g} m"
        )
    _refuse_a_bowl(section.across, below, first, last, depth)
    left, right = section.across[first], section.across[last - 1]
    middle, room = (left + right) / 2, section.step / 2 + _ROOM * (right - left)
    room_left = room if first > 0 else math.inf  # what the field cuts may be worn to its very corner
    room_right = room if last < section.across.size else math.inf
    return DetectedGroove(
        track=GrooveTrack(
            track_direction=track.track_direction, track_curvature=track.track_curvature, track_offset=float(middle)
        ),
        worn_band=(float(left - middle - room_left), float(right - middle + room_right)),
        contrast=depth / spread,
    )


class _Points(NamedTuple):
    """Means of small squares of a scan."""

    x: Floats
    y: Floats
    height: Floats
    side: float
    reach: float  # longer side of the field


class _Section(NamedTuple):
    """Mean height across a track."""

    across: Floats
    height: Floats
    noise: float
    step: float


def _points(surface: HeightMap, blocks: int) -> _Points:
    rows, columns = surface.height.shape
    reach = max(rows * surface.spacing_y, columns * surface.spacing_x)
    edges = [
        np.arange(0, count, max(1, round(reach / blocks / spacing)))
        for count, spacing in ((rows, surface.spacing_y), (columns, surface.spacing_x))
    ]

    def total(values: Floats) -> Floats:
        return np.asarray(np.add.reduceat(np.add.reduceat(values, edges[0], axis=0), edges[1], axis=1))

    measured = surface.measured
    count = total(measured.astype(np.float64))
    used = count > 0
    x, y = centred_coordinates(surface)
    fields = (np.where(measured, values, 0.0) for values in (x + 0 * y, y + 0 * x, surface.height))
    px, py, height = (total(values)[used] / count[used] for values in fields)
    if height.size < 100:
        raise InvalidInput(
            f"a groove needs more of the field measured than {height.size} blocks of {reach / blocks:.2g} m"
        )
    side = max(surface.spacing_x, surface.spacing_y, reach / blocks)
    return _Points(px, py, height - height.mean(), side, reach)


def _track(surface: HeightMap) -> GrooveTrack:
    points = _points(surface, _COARSE)
    starts = [(math.pi * step / _DIRECTIONS, turn / points.reach) for step in range(_DIRECTIONS) for turn in _TURNS]
    unexplained = [_unexplained(points, *start) for start in starts]
    best = starts[int(np.argmin(unexplained))]
    direction, curvature = _least_unexplained(points, *best)
    direction, curvature = _least_unexplained(_points(surface, _FINE), direction, curvature)
    half_turns = math.floor(direction / math.pi)  # the other way along the same track, left is right
    return GrooveTrack(
        track_direction=direction - half_turns * math.pi,
        track_curvature=-curvature if half_turns % 2 else curvature,
        track_offset=0.0,
    )


def _least_unexplained(points: _Points, direction: float, curvature: float) -> tuple[float, float]:
    def at(offset: Floats) -> float:
        return _unexplained(points, direction + offset[0], curvature + offset[1] / points.reach)

    simplex = np.array([[0.0, 0.0], [0.03, 0.0], [0.0, 0.08]])
    options = {"initial_simplex": simplex, "xatol": 1e-4, "fatol": 1e-6 * at(np.zeros(2)), "maxfev": 120}
    found = minimize(at, np.zeros(2), method="Nelder-Mead", options=options).x
    return float(direction + found[0]), float(curvature + found[1] / points.reach)


def _unexplained(points: _Points, direction: float, curvature: float) -> float:
    """Return the squares of heights that no section and no slope along the track explain."""
    if abs(curvature) * points.reach > 4:
        return math.inf
    across, along = arc_coordinates(points.x, points.y, direction, curvature)
    sections = _hats(across, points.side, np.stack([points.height, along - along.mean()]))
    z, t = points.height, along - along.mean()
    rest_zz = z @ z - sections[0, 0]
    rest_zt, rest_tt = z @ t - sections[0, 1], t @ t - sections[1, 1]
    return float(rest_zz - rest_zt**2 / max(rest_tt, np.finfo(float).tiny))


def _hats(across: Floats, step: float, values: Floats) -> Floats:
    """Return products of values as projected on functions that are linear between knots across the track."""
    place = (across - across.min()) / step
    knot = place.astype(np.intp)
    share = place - knot
    knots = int(knot.max()) + 2
    banded = np.zeros((2, knots))
    banded[1] = np.bincount(knot, (1 - share) ** 2, minlength=knots)
    banded[1] += np.bincount(knot + 1, share**2, minlength=knots)
    banded[0, 1:] = np.bincount(knot, share * (1 - share), minlength=knots)[:-1]
    banded[1] += _RIDGE * banded[1].max()
    moments = np.stack(
        [
            np.bincount(knot, (1 - share) * value, minlength=knots)
            + np.bincount(knot + 1, share * value, minlength=knots)
            for value in values
        ]
    )
    return np.asarray(moments @ solveh_banded(banded, moments.T, check_finite=False))


def _section(points: _Points, track: GrooveTrack) -> _Section:
    across, along = arc_coordinates(points.x, points.y, track.track_direction, track.track_curvature)
    bins = ((across - across.min()) / points.side).astype(np.intp)
    count = np.bincount(bins).astype(np.float64)
    used = count > 0

    def mean(values: Floats) -> Floats:
        return np.bincount(bins, values) / np.maximum(count, 1.0)

    z, t = points.height - mean(points.height)[bins], along - mean(along)[bins]
    slope = float(z @ t) / max(float(t @ t), np.finfo(float).tiny)
    rest = z - slope * t
    used &= count >= _LEAST_SEEN * np.quantile(count[used], 0.9)
    noise = float(np.std(rest)) / math.sqrt(float(np.median(count[used])))
    return _Section(mean(across)[used], mean(points.height - slope * along)[used], noise, points.side)


def _worn_stretch(section: _Section) -> tuple[int, int, tuple[float, float]]:
    """Return first and last bin of the stretch that stands out most, and the line through the others."""
    s, z, count = section.across, section.height, section.across.size
    origin = float(s.mean())
    powers = np.stack([np.ones(count), s - origin, (s - origin) ** 2, z, (s - origin) * z, z**2])
    sums = np.concatenate([np.zeros((6, 1)), np.cumsum(powers, axis=1)], axis=1)
    if not np.ptp(z):
        raise NoGroove("no groove found: the surface is flat")
    first, last = (index.ravel() for index in np.triu_indices(count + 1, k=_LEAST_WORN))
    inner = sums[:, last] - sums[:, first]
    outer = sums[:, -1:] - inner
    wide = outer[0] >= max(_LEAST_UNWORN * count, 4)
    first, last, inner, outer = first[wide], last[wide], inner[:, wide], outer[:, wide]
    if not first.size:
        raise NoGroove("no groove found: the field shows too few heights across any track")
    n, sx, sxx, sz, sxz, _ = outer
    slope = (n * sxz - sx * sz) / (n * sxx - sx**2)
    level = (sz - slope * sx) / n

    def squares(part: Floats) -> Floats:
        n, sx, sxx, sz, sxz, szz = part
        rest = szz - 2 * level * sz - 2 * slope * sxz + level**2 * n + 2 * level * slope * sx + slope**2 * sxx
        return np.asarray(np.maximum(rest, 0.0) / n + floor)

    floor = section.noise**2 + (1e-4 * float(np.ptp(z))) ** 2
    likelihood = outer[0] * np.log(squares(outer)) + inner[0] * np.log(squares(inner))
    sunk = inner[3] - level * inner[0] - slope * inner[1] < 0
    likelihood[~sunk] = np.inf
    best = int(np.argmin(likelihood))
    if not np.isfinite(likelihood[best]):
        raise NoGroove("no groove found: nothing lies below its surroundings")
    line = (float(level[best] - slope[best] * origin), float(slope[best]))
    return int(first[best]), int(last[best]), line


def _refuse_a_bowl(across: Floats, below: Floats, first: int, last: int, depth: float) -> None:
    """Refuse a section that falls from end to end: the groove goes on beyond the field."""
    if min(first, across.size - last) < 2:
        return
    ends = (slice(0, first), -1), (slice(last, None), 1)
    steepness = min(way * np.polyfit(across[end], below[end], 1)[0] for end, way in ends)
    if steepness > _SHOULDER * 2 * depth / (across[last - 1] - across[first]):
        raise NoGroove("no groove found: what is worn fills the whole field; scan a wider one")


def _smoothed(values: Floats) -> Floats:
    return np.convolve(values, np.full(3, 1 / 3), mode="valid") if values.size >= 3 else values
