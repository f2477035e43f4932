"""Cross-sections of a wear groove: the mean one with its edges and ridges, and single ones along the track."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import NoGroove
from sonolube.models.surfaces.grooves.track import GrooveTrack
from sonolube.models.surfaces.height_map import HeightMap, Mask

_MIN_PIXELS = 0.02  # of a bin, over those of the fullest
_SIGNIFICANT = 4.0  # height over the standard deviation of the mean section beside the groove
_MIN_FRACTION = 0.005  # of the depth, from which a height counts as worn or piled up
_ROUNDING = 1e-4  # of the depth
_GAP = 5  # pixels, largest between edge and ridge


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MeanCrossSection:
    """Mean cross-section of a wear groove.

    Parameters
    ----------
    transverse : ndarray, shape (n,)
        Distance from the track, ascending in equal steps, in m.
    height : ndarray, shape (n,)
        Mean height above the unworn surface; NaN where nothing was measured. [m]
    pixels : ndarray, shape (n,)
        Number of measured pixels in each mean.
    """

    transverse: Floats
    height: Floats
    pixels: NDArray[np.intp]

    @property
    def step(self) -> float:
        """Distance of neighbouring points. [m]"""
        return float(self.transverse[1] - self.transverse[0])

    def at(self, transverse: Floats) -> Floats:
        """Mean height at distances in m from the track, by linear interpolation, in m."""
        known = np.isfinite(self.height)
        return np.interp(transverse, self.transverse[known], self.height[known])


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class CrossSections:
    """Cross-sections perpendicular to the track, resampled at the nearest pixels.

    Parameters
    ----------
    arc_length : ndarray, shape (sections,)
        Length along the track of each section from the centre of the field, in m.
    transverse : ndarray, shape (points,)
        Distance from the track, in m.
    height : ndarray, shape (sections, points)
        Height above the unworn surface at the nearest pixel; NaN where that is missing or outside the field. [m]
    """

    arc_length: Floats
    transverse: Floats
    height: Floats


class GrooveExtent(NamedTuple):
    """Edges of the groove and outer ends of its ridges in the mean cross-section, as distances from the track in m."""

    left: float
    right: float
    left_foot: float  # outer end of the ridge; the edge itself where there is no ridge
    right_foot: float
    left_in_field: bool
    right_in_field: bool

    def shifted(self, shift: float) -> "GrooveExtent":
        """The same with `shift` in m added to all distances."""
        return self._replace(**{name: getattr(self, name) + shift for name in self._fields[:4]})


def mean_cross_section(levelled: HeightMap, transverse: Floats, counted: Mask) -> MeanCrossSection:
    """Mean cross-section: means of the heights over pixels of equal distance from the track."""
    step = max(levelled.spacing_x, levelled.spacing_y)
    first = math.floor(float(transverse.min()) / step)
    bins = np.floor(transverse / step).astype(np.intp) - first
    size = int(bins.max()) + 1
    count = np.bincount(bins[counted], minlength=size)
    height_sum = np.bincount(bins[counted], levelled.height[counted], minlength=size)
    position_sum = np.bincount(bins[counted], transverse[counted], minlength=size)
    middle = np.asarray((np.arange(size) + first + 0.5) * step, dtype=np.float64)
    known = count > 0
    height = np.full(size, np.nan)
    height[known] = np.interp(middle[known], position_sum[known] / count[known], height_sum[known] / count[known])
    return MeanCrossSection(transverse=middle, height=height, pixels=count)


def groove_extent(section: MeanCrossSection, worn_band: tuple[float, float]) -> GrooveExtent:
    """Edges of the groove and outer ends of its ridges, from the mean cross-section."""
    populated = section.pixels >= _MIN_PIXELS * section.pixels.max()
    s, z = section.transverse[populated], section.height[populated]
    band = (s > worn_band[0]) & (s < worn_band[1])
    deviation = math.sqrt(float(np.mean(z[~band] ** 2))) if np.any(~band) else 0.0
    depth = -float(np.min(z[band], initial=0.0))
    least = max(_SIGNIFICANT * deviation, _MIN_FRACTION * depth)
    low = np.flatnonzero(band & (z < -least))
    if not low.size:
        raise NoGroove(
            f"no groove found: its mean section is {depth:.2g} m deep, and the surface varies by {deviation:.2g} m"
        )
    tolerance = max(min(deviation, least / 2), _ROUNDING * depth)
    first = _last_outward(z, low[0], -1, lambda height: height < -tolerance)
    last = _last_outward(z, low[-1], 1, lambda height: height < -tolerance)
    left, right = _zero_crossing(s, z, first, first - 1), _zero_crossing(s, z, last, last + 1)
    return GrooveExtent(
        left=left,
        right=right,
        left_foot=_ridge_end(s, z, first, -1, least, tolerance, left),
        right_foot=_ridge_end(s, z, last, 1, least, tolerance, right),
        left_in_field=bool(first > 0),
        right_in_field=bool(last < s.size - 1),
    )


def cross_sections(levelled: HeightMap, track: GrooveTrack, *, reach: tuple[float, float]) -> CrossSections:
    """Cross-sections perpendicular to the track, at every arc length at which one crosses the field."""
    transverse, arc_length = track.curvilinear_coordinates(levelled)
    near = (transverse >= reach[0]) & (transverse <= reach[1])
    step = max(levelled.spacing_x, levelled.spacing_y)
    start, stop = float(arc_length[near].min()), float(arc_length[near].max())
    t = np.linspace(start, stop, max(2, 1 + round((stop - start) / step)))
    s = np.linspace(reach[0], reach[1], max(2, round((reach[1] - reach[0]) / step)))
    row, column = (np.rint(each).astype(np.intp) for each in track.pixel_position(levelled, *np.meshgrid(s, t)))
    rows, columns = levelled.height.shape
    inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
    height = np.where(inside, levelled.height[row.clip(0, rows - 1), column.clip(0, columns - 1)], np.nan)
    return CrossSections(arc_length=t, transverse=s, height=height)


def _last_outward(z: Floats, index: int, step: int, condition: Callable[[float], bool]) -> int:
    """Last index in steps of +1 or -1 up to which the heights satisfy a condition."""
    while 0 <= index + step < z.size and condition(float(z[index + step])):
        index += step
    return index


def _zero_crossing(s: Floats, z: Floats, inner: int, outer: int) -> float:
    """Distance at which the height is zero between two points, by linear interpolation; the outer one if below zero."""
    if not 0 <= outer < z.size:
        return float(s[inner])
    if z[outer] <= 0:
        return float(s[outer])
    return float(s[inner] - z[inner] * (s[outer] - s[inner]) / (z[outer] - z[inner]))


def _ridge_end(s: Floats, z: Floats, edge: int, step: int, least: float, tolerance: float, otherwise: float) -> float:
    """Outer end of the ridge beyond an edge, `otherwise` where there is none."""
    beyond = z[edge:][1 : _GAP + 1] if step > 0 else z[:edge][::-1][:_GAP]
    if not np.any(beyond > tolerance):
        return otherwise
    start = edge + step * (1 + int(np.argmax(beyond > tolerance)))
    end = _last_outward(z, start, step, lambda height: height > tolerance)
    return float(s[end]) if z[min(start, end) : max(start, end) + 1].max() > least else otherwise
