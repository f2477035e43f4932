"""Detection of a straight or circular wear groove in a scan, by least squares over the direction and curvature."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dptsv
from scipy.optimize import minimize

from sonolube.checks import Floats
from sonolube.errors import InvalidInput, NoGroove
from sonolube.models.surfaces.grooves.track import (
    GrooveTrack,
    arc_coordinates,
    block_edges,
    block_means,
    centred_coordinates,
)
from sonolube.models.surfaces.height_map import HeightMap, Mask

__all__ = ["DetectedGroove", "detect_groove"]  # `height_range` serves this room only

_SCREENED, _COARSE, _FINE = 36, 72, 160  # blocks along the longer side
_MIN_POINTS = 100  # measured blocks
_KEPT = 0.25  # residual of a start above the least one over that of the median, up to which it is not screened out
_DIRECTIONS = 60
_TURNS = (-1.0, -0.4, -0.15, 0.0, 0.15, 0.4, 1.0)  # change of direction of the track over the longer side, in rad
_MAX_BENT = 4.0  # of a refined track, in rad
_MIN_BLOCKS = 0.1  # of a bin of the section, over those of the fullest
_EXTREME = 1e-3  # fraction of the blocks, less than those of the narrowest track
_MIN_UNWORN = 0.06  # fraction of the section
_MIN_WORN = 3  # bins
_MIN_CONTRAST = 5.0  # depth over the standard deviation beside the groove
_LARGEST_SHOULDER = 0.4  # slope of the unworn ends over the mean slope of the flanks
_MARGIN = 0.05  # of the worn width, on either side of it
_REGULARIZATION = 1e-9


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class DetectedGroove:
    """Position of a detected wear groove, before the unworn reference is fitted.

    Parameters
    ----------
    track : GrooveTrack
        Centre line of the groove.
    worn_band : tuple of float
        Distances from the track in m between which the surface is worn or piled up, with a margin; infinite where the
        field ends within.
    contrast : float
        Greatest depth of the mean section over the standard deviation of the mean section beside the groove.
    deviation : float
        That standard deviation, in m.
    section_transverse, section_height : ndarray, shape (n,)
        Mean section over the line through its unworn ends: distance from the track and height, in m.
    """

    track: GrooveTrack
    worn_band: tuple[float, float]
    contrast: float
    deviation: float
    section_transverse: Floats
    section_height: Floats


def detect_groove(surface: HeightMap) -> DetectedGroove:
    r"""Position of a straight or circular wear groove in a scan, by least squares and a likelihood ratio.

    Parameters
    ----------
    surface : HeightMap
        As measured: tilted, wavy, rough, with missing pixels; the form of a ball or cylinder removed beforehand.

    Returns
    -------
    DetectedGroove

    Raises
    ------
    NoGroove
        If the contrast is below 5, or the groove fills the field.

    Notes
    -----
    The cross-section is the same all along a groove. The direction and curvature of the track minimise the residual sum
    of squares of the heights about one section f(s) and a slope along the track,

    .. math:: \min_{\text{direction, curvature}} \ \min_{f, g} \sum \left[z - f(s) - g\, t\right]^2 ,

    in the curvilinear coordinates :math:`s`, :math:`t`. The worn interval of the section divides it into inner and
    outer points about the regression line of the outer ones with the greatest likelihood,

    .. math:: n_o \ln \overline{r_o^2} + n_i \ln \overline{r_i^2} \to \min .

    Only a sixteenth of the section has to be unworn.
    """
    track = _track(surface)
    section = _section(_block_means(surface, _FINE), track)
    first, last, line = _worn_interval(section)
    outer = np.ones(section.transverse.size, dtype=np.bool_)
    outer[first:last] = False
    residual = section.height - line[0] - line[1] * section.transverse
    deviation = math.sqrt(float(np.mean(residual[outer] ** 2)) + section.noise**2)
    depth = -float(np.min(_moving_average(residual[first:last])))
    if depth < _MIN_CONTRAST * deviation:
        raise NoGroove(
            f"no groove found: the deepest trough is {depth:.2g} m deep; heights beside it vary by {deviation:.2g} m"
        )
    _require_shoulders(section.transverse, residual, first, last, depth)
    left, right = section.transverse[first], section.transverse[last - 1]
    middle, margin = (left + right) / 2, section.step / 2 + _MARGIN * (right - left)
    left_margin = margin if first > 0 else math.inf  # a groove cut by the field may extend to its corner
    right_margin = margin if last < section.transverse.size else math.inf
    return DetectedGroove(
        track=replace(track, track_offset=float(middle)),
        worn_band=(float(left - middle - left_margin), float(right - middle + right_margin)),
        contrast=depth / deviation,
        deviation=deviation,
        section_transverse=section.transverse - float(middle),
        section_height=residual,
    )


def height_range(surface: HeightMap) -> float:
    """Range of the heights of a scan without the extreme 0.1 %: no track in it is deeper. [m]"""
    low, high = np.quantile(_block_means(surface, _FINE).height, [_EXTREME, 1 - _EXTREME])
    return float(high - low)


class _Blocks(NamedTuple):
    """Means of a scan over square blocks."""

    x: Floats
    y: Floats
    height: Floats
    side: float
    reach: float  # longer side of the field


class _Section(NamedTuple):
    """Mean height over the distance from a track."""

    transverse: Floats
    height: Floats
    noise: float
    step: float


def _block_means(surface: HeightMap, blocks: int) -> _Blocks:
    """Means of positions and heights over square blocks, so many along the longer side of the field."""
    reach = max(surface.sides)
    fields = (*centred_coordinates(surface), surface.height)
    px, py, height, _ = block_means(fields, surface.measured, block_edges(surface, reach / blocks))
    side = max(surface.spacing_x, surface.spacing_y, reach / blocks)
    return _Blocks(px, py, height - height.mean(), side, reach)


def _track(surface: HeightMap) -> GrooveTrack:
    """Track through the centre of the field of least residual, by grid search and simplex refinement."""
    points = _block_means(surface, _COARSE)
    if points.height.size < _MIN_POINTS:
        side = points.reach / _COARSE
        raise InvalidInput(
            f"detection of a groove requires at least {_MIN_POINTS} measured blocks of {side:.2g} m, got"
            f" {points.height.size}; scan a larger field or more finely"
        )
    residuals = _residuals_of_starts(_block_means(surface, _SCREENED), np.ones((len(_TURNS), _DIRECTIONS), np.bool_))
    screened = residuals <= residuals.min() + _KEPT * (np.median(residuals) - residuals.min())
    residuals = _residuals_of_starts(points, screened)
    turn, step = np.unravel_index(int(np.argmin(residuals)), residuals.shape)
    direction, curvature = _refined_track(points, math.pi * step / _DIRECTIONS, _TURNS[turn] / points.reach)
    direction, curvature = _refined_track(_block_means(surface, _FINE), direction, curvature)
    half_turns = math.floor(direction / math.pi)  # reversal of the direction changes the sign of the curvature
    return GrooveTrack(
        track_direction=direction - half_turns * math.pi,
        track_curvature=-curvature if half_turns % 2 else curvature,
        track_offset=0.0,
    )


def _residuals_of_starts(points: _Blocks, chosen: Mask) -> Floats:
    """Residual sums of squares of chosen starts, infinite for the others, shape (turns, directions)."""
    residuals = np.full(chosen.shape, math.inf)
    for row, turn, steps in zip(residuals, _TURNS, chosen, strict=True):
        row[steps] = _residual_sums(points, math.pi * np.flatnonzero(steps) / _DIRECTIONS, turn / points.reach)
    return residuals


def _refined_track(points: _Blocks, direction: float, curvature: float) -> tuple[float, float]:
    """Direction and curvature of least residual near the given ones, by the simplex method of Nelder and Mead."""

    def at(offset: Floats) -> float:
        bent = curvature + offset[1] / points.reach
        if abs(bent) * points.reach > _MAX_BENT:
            return math.inf
        return float(_residual_sums(points, np.array([direction + offset[0]]), bent)[0])

    simplex = np.array([[0.0, 0.0], [0.03, 0.0], [0.0, 0.08]])
    options = {"initial_simplex": simplex, "xatol": 1e-4, "fatol": 1e-6 * at(np.zeros(2)), "maxfev": 120}
    found = minimize(at, np.zeros(2), method="Nelder-Mead", options=options).x
    return float(direction + found[0]), float(curvature + found[1] / points.reach)


def _residual_sums(points: _Blocks, directions: Floats, curvature: float) -> Floats:
    """Residual sums of squares of the heights about one section and a slope along the track, for each direction."""
    if not directions.size:
        return np.empty(0)
    transverse, arc_length = arc_coordinates(points.x, points.y, directions[:, None], curvature)
    z, t = points.height, arc_length - arc_length.mean(axis=1, keepdims=True)
    of_z, of_zt, of_t = _projected_products(transverse, points.side, np.broadcast_to(z, t.shape), t)
    zz, zt, tt = z @ z - of_z, t @ z - of_zt, np.einsum("ij,ij->i", t, t) - of_t
    return np.asarray(zz - zt**2 / np.maximum(tt, np.finfo(float).tiny))


def _projected_products(transverse: Floats, step: float, z: Floats, t: Floats) -> tuple[Floats, Floats, Floats]:
    """Scalar products z z, z t and t t of the projections on piecewise linear functions of the distance from the track.

    Each row is a track of its own; their tridiagonal systems are solved as one.
    """
    position = (transverse - transverse.min(axis=1, keepdims=True)) / step
    knot = position.astype(np.intp)
    share = position - knot
    rows, knots = len(knot), int(knot.max()) + 2
    knot += knots * np.arange(rows)[:, None]

    def total(values: Floats | None = None) -> Floats:
        weights = None if values is None else values.ravel()
        return np.bincount(knot.ravel(), weights, minlength=rows * knots).astype(np.float64, copy=False)

    first, second = total(share), total(share**2)
    diagonal = total() - 2 * first + second
    diagonal[1:] += second[:-1]  # the last knot of a row has no points
    by_row = diagonal.reshape(rows, knots)
    by_row += _REGULARIZATION * by_row.max(axis=1, keepdims=True)
    moments = np.empty((rows * knots, 2), order="F")
    for moment, values in zip(moments.T, (z, t), strict=True):
        farther = total(share * values)
        moment[:] = total(values) - farther
        moment[1:] += farther[:-1]
    _, _, coefficients, _ = dptsv(diagonal, (first - second)[:-1], moments)
    pairs = (0, 0), (0, 1), (1, 1)
    of_z, of_zt, of_t = ((moments[:, i] * coefficients[:, j]).reshape(rows, knots).sum(axis=1) for i, j in pairs)
    return of_z, of_zt, of_t


def _section(points: _Blocks, track: GrooveTrack) -> _Section:
    """Mean section of a track, its slope along the track removed."""
    transverse, arc_length = arc_coordinates(points.x, points.y, track.track_direction, track.track_curvature)
    bins = ((transverse - transverse.min()) / points.side).astype(np.intp)
    count = np.bincount(bins).astype(np.float64)
    used = count > 0

    def mean(values: Floats) -> Floats:
        return np.bincount(bins, values) / np.maximum(count, 1.0)

    z, t = points.height - mean(points.height)[bins], arc_length - mean(arc_length)[bins]
    slope = float(z @ t) / max(float(t @ t), np.finfo(float).tiny)
    residual = z - slope * t
    used &= count >= _MIN_BLOCKS * np.quantile(count[used], 0.9)
    noise = float(np.std(residual)) / math.sqrt(float(np.median(count[used])))
    return _Section(mean(transverse)[used], mean(points.height - slope * arc_length)[used], noise, points.side)


def _worn_interval(section: _Section) -> tuple[int, int, tuple[float, float]]:
    """First bin, end and outer regression line of the interval of greatest likelihood."""
    s, z, count = section.transverse, section.height, section.transverse.size
    origin = float(s.mean())
    powers = np.stack([np.ones(count), s - origin, (s - origin) ** 2, z, (s - origin) * z, z**2])
    sums = np.concatenate([np.zeros((6, 1)), np.cumsum(powers, axis=1)], axis=1)
    if not np.ptp(z):
        raise NoGroove("no groove found: the surface is flat")
    first, last = (index.ravel() for index in np.triu_indices(count + 1, k=_MIN_WORN))
    inner = sums[:, last] - sums[:, first]
    outer = sums[:, -1:] - inner
    wide = outer[0] >= max(_MIN_UNWORN * count, 4)
    first, last, inner, outer = first[wide], last[wide], inner[:, wide], outer[:, wide]
    if not first.size:
        raise NoGroove("no groove found: too few measured heights across any track")
    n, sx, sxx, sz, sxz, _ = outer
    slope = (n * sxz - sx * sz) / (n * sxx - sx**2)
    level = (sz - slope * sx) / n

    def variance(part: Floats) -> Floats:
        n, sx, sxx, sz, sxz, szz = part
        squares = szz - 2 * level * sz - 2 * slope * sxz + level**2 * n + 2 * level * slope * sx + slope**2 * sxx
        return np.asarray(np.maximum(squares, 0.0) / n + floor)

    floor = section.noise**2 + (1e-4 * float(np.ptp(z))) ** 2
    cost = outer[0] * np.log(variance(outer)) + inner[0] * np.log(variance(inner))
    below = inner[3] - level * inner[0] - slope * inner[1] < 0
    cost[~below] = np.inf
    best = int(np.argmin(cost))
    if not np.isfinite(cost[best]):
        raise NoGroove("no groove found: nothing lies below its surroundings")
    line = (float(level[best] - slope[best] * origin), float(slope[best]))
    return int(first[best]), int(last[best]), line


def _require_shoulders(transverse: Floats, residual: Floats, first: int, last: int, depth: float) -> None:
    """Refuse a section whose ends slope towards the groove on both sides: it extends beyond the field."""
    if min(first, transverse.size - last) < 2:
        return
    ends = (slice(0, first), -1), (slice(last, None), 1)
    slope = min(sign * np.polyfit(transverse[end], residual[end], 1)[0] for end, sign in ends)
    if slope > _LARGEST_SHOULDER * 2 * depth / (transverse[last - 1] - transverse[first]):
        raise NoGroove("no groove found: the worn surface fills the whole field; scan a wider one")


def _moving_average(values: Floats) -> Floats:
    """Mean over three neighbours, where there are three."""
    return np.convolve(values, np.full(3, 1 / 3), mode="valid") if values.size >= 3 else values
