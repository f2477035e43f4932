"""Sections across a groove: the mean one, its edges and ridges, and single ones along the straightened track."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import NoGroove
from sonolube.surfaces.grooves.track import GrooveTrack
from sonolube.surfaces.height_map import HeightMap

Mask = NDArray[np.bool_]

_LEAST_SEEN = 0.02  # of the fullest bin
_SURE = 4.0  # spreads of the mean section beside the groove
_LEAST_SHARE = 0.005  # of the depth: what counts as worn or piled up
_EXACT = 1e-4  # of the depth: less is rounding
_GAP = 5  # pixels between edge and ridge
_ROOM = 0.04  # of the worn width, left beside it


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MeanCrossSection:
    """The mean section of a groove.

    Parameters
    ----------
    across : ndarray, shape (n,)
        Distance from the track, rising in equal steps, in m.
    height : ndarray, shape (n,)
        Mean height above the unworn surface; NaN where nothing was measured. [m]
    pixels : ndarray, shape (n,)
        Measured pixels in each mean.
    """

    across: Floats
    height: Floats
    pixels: NDArray[np.intp]

    @property
    def step(self) -> float:
        """Distance of neighbouring means. [m]"""
        return float(self.across[1] - self.across[0])

    def at(self, across: Floats) -> Floats:
        """Return the mean height at distances from the track, in m."""
        known = np.isfinite(self.height)
        return np.interp(across, self.across[known], self.height[known])


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class CrossSections:
    """Sections square to the track, the track laid straight.

    Parameters
    ----------
    along : ndarray, shape (sections,)
        Length of the track up to each section, from the middle of the field, in m.
    across : ndarray, shape (points,)
        Distance from the track, in m.
    height : ndarray, shape (sections, points)
        Height above the unworn surface at the nearest pixel; NaN where that is missing or outside the field. [m]
    """

    along: Floats
    across: Floats
    height: Floats


class GrooveExtent(NamedTuple):
    """What of the mean section is worn and what piled up, as distances from the track in m."""

    left: float
    right: float
    left_foot: float  # of the ridge, or the edge itself where there is none
    right_foot: float
    left_seen: bool
    right_seen: bool

    def shifted(self, shift: float) -> "GrooveExtent":
        """Return it with all distances moved by `shift`, in m."""
        return self._replace(
            left=self.left + shift,
            right=self.right + shift,
            left_foot=self.left_foot + shift,
            right_foot=self.right_foot + shift,
        )


def mean_cross_section(levelled: HeightMap, across: Floats, counted: Mask) -> MeanCrossSection:
    """Return the mean over pixels of equal distance from the track.

    Parameters
    ----------
    levelled : HeightMap
        Heights above the unworn surface.
    across : ndarray, shape of the heights
        Distance of each pixel from the track, in m.
    counted : bool array, shape of the heights
        Pixels that count.

    Returns
    -------
    MeanSection
    """
    step = max(levelled.spacing_x, levelled.spacing_y)
    first = math.floor(float(across.min()) / step)
    bins = np.floor(across / step).astype(np.intp) - first
    size = int(bins.max()) + 1
    shown = np.bincount(bins[counted], minlength=size)
    total = np.bincount(bins[counted], levelled.height[counted], minlength=size)
    place = np.bincount(bins[counted], across[counted], minlength=size)
    middle = np.asarray((np.arange(size) + first + 0.5) * step, dtype=np.float64)
    known = shown > 0
    height = np.full(size, np.nan)
    height[known] = np.interp(middle[known], place[known] / shown[known], total[known] / shown[known])
    return MeanCrossSection(across=middle, height=height, pixels=shown)


def groove_extent(section: MeanCrossSection, worn_band: tuple[float, float]) -> GrooveExtent:
    """Return edges of the groove and feet of its ridges.

    Parameters
    ----------
    section : MeanSection
    worn_band : tuple of float
        Between which distances wear was taken for possible; what lies outside tells how sure the heights are.

    Returns
    -------
    Extent

    Raises
    ------
    NoGroove
        If the mean section nowhere falls clearly below the unworn surface.
    """
    seen = section.pixels >= _LEAST_SEEN * section.pixels.max()
    s, z = section.across[seen], section.height[seen]
    band = (s > worn_band[0]) & (s < worn_band[1])
    spread = math.sqrt(float(np.mean(z[~band] ** 2))) if np.any(~band) else 0.0
    depth = -float(np.min(z[band], initial=0.0))
    least = max(_SURE * spread, _LEAST_SHARE * depth)
    low = np.flatnonzero(band & (z < -least))
    if not low.size:
        raise NoGroove(f"no groove found: its mean section, {depth:.2g} m deep, is lost in a spread of {spread:.2g} m")
    tolerance = max(min(spread, least / 2), _EXACT * depth)
    first = _outward(z, low[0], -1, lambda height: height < -tolerance)
    last = _outward(z, low[-1], 1, lambda height: height < -tolerance)
    left, right = _crossing(s, z, first, first - 1), _crossing(s, z, last, last + 1)
    return GrooveExtent(
        left=left,
        right=right,
        left_foot=_foot(s, z, first, -1, least, tolerance, left),
        right_foot=_foot(s, z, last, 1, least, tolerance, right),
        left_seen=bool(first > 0),
        right_seen=bool(last < s.size - 1),
    )


def band_with_margin(found: GrooveExtent) -> tuple[float, float]:
    """Return worn width and ridges with a little room on both sides, in m."""
    room = _ROOM * (found.right - found.left)
    return found.left_foot - room, found.right_foot + room


def cross_sections(
    levelled: HeightMap, track: GrooveTrack, *, reach: tuple[float, float], sections: int | None = None
) -> CrossSections:
    """Return sections square to the track, wherever one crosses the field.

    Parameters
    ----------
    levelled : HeightMap
        Heights above the unworn surface.
    track : GrooveTrack
    reach : tuple of float
        From which to which distance from the track they run, in m.
    sections : int, optional
        How many; one a pixel where it is not given.

    Returns
    -------
    CrossSections
    """
    across, along = track.curvilinear_coordinates(levelled)
    near = (across >= reach[0]) & (across <= reach[1])
    step = max(levelled.spacing_x, levelled.spacing_y)
    start, stop = float(along[near].min()), float(along[near].max())
    t = np.linspace(start, stop, sections or max(2, round((stop - start) / step)))
    s = np.linspace(reach[0], reach[1], max(2, round((reach[1] - reach[0]) / step)))
    row, column = (np.rint(place).astype(np.intp) for place in track.place(levelled, *np.meshgrid(s, t)))
    rows, columns = levelled.height.shape
    inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
    height = np.where(inside, levelled.height[row.clip(0, rows - 1), column.clip(0, columns - 1)], np.nan)
    return CrossSections(along=t, across=s, height=height)


def _outward(z: Floats, index: int, way: int, goes_on: Callable[[float], bool]) -> int:
    while 0 <= index + way < z.size and goes_on(float(z[index + way])):
        index += way
    return index


def _crossing(s: Floats, z: Floats, inner: int, outer: int) -> float:
    if not 0 <= outer < z.size:
        return float(s[inner])
    if z[outer] <= 0:
        return float(s[outer])
    return float(s[inner] - z[inner] * (s[outer] - s[inner]) / (z[outer] - z[inner]))


def _foot(s: Floats, z: Floats, edge: int, way: int, least: float, tolerance: float, otherwise: float) -> float:
    """Return where the ridge beyond an edge ends, or else the edge."""
    beyond = z[edge:][1 : _GAP + 1] if way > 0 else z[:edge][::-1][:_GAP]
    if not np.any(beyond > tolerance):
        return otherwise
    start = edge + way * (1 + int(np.argmax(beyond > tolerance)))
    end = _outward(z, start, way, lambda height: height > tolerance)
    return float(s[end]) if z[min(start, end) : max(start, end) + 1].max() > least else otherwise
