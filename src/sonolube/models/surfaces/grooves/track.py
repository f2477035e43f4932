"""Track of a wear groove in a scan, a line or a circular arc: coordinates about it, and cross-sections of it."""

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats, require_finite
from sonolube.errors import NoGroove
from sonolube.models.surfaces.height_map import HeightMap, Mask


def centred_coordinates(surface: HeightMap) -> tuple[Floats, Floats]:
    """Positions of columns and rows relative to the centre of the field.

    `x`: Positions of the columns, in m. `y`: Positions of the rows, in m.
    """
    rows, columns = surface.height.shape
    x = surface.x - surface.spacing_x * (columns - 1) / 2
    y = surface.y - surface.spacing_y * (rows - 1) / 2
    return x[None, :], y[:, None]


def arc_coordinates(x: Floats, y: Floats, direction: float | Floats, curvature: float) -> tuple[Floats, Floats]:
    r"""Curvilinear coordinates of points with respect to a circle through the origin.

    `transverse`: Distance from the circle in m, positive to the left of its direction. `arc_length`: Length along the
    circle from the origin to the foot of the point, in m.

    With the coordinates :math:`a` ahead and :math:`l` to the left of the origin and the curvature :math:`\kappa`

    .. math:: s = \frac{2 l - \kappa (l^2 + a^2)}{1 + \sqrt{(1 - \kappa l)^2 + (\kappa a)^2}}, \qquad
        t = \frac1\kappa \operatorname{atan2}(\kappa a, 1 - \kappa l) ,

    which has the limit :math:`s = l`, :math:`t = a` of a line without cancellation.
    """
    cos, sin = np.cos(direction), np.sin(direction)
    ahead, left = x * cos + y * sin, y * cos - x * sin
    if curvature == 0:
        return left, ahead
    power = 2 * left - curvature * (np.square(left) + np.square(ahead))
    from_centre = np.sqrt(np.maximum(1 - curvature * power, 0.0))  # times the curvature
    return power / (1 + from_centre), np.arctan2(curvature * ahead, 1 - curvature * left) / curvature


def monomials(u: Floats, v: Floats, terms: int) -> list[Floats]:
    """First monomials 1, u, v, u^2, u v and v^2 of two coordinates."""
    return [np.ones_like(u + v), u + 0 * v, v + 0 * u, u**2 + 0 * v, u * v, v**2 + 0 * u][:terms]


def block_edges(surface: HeightMap, side: float) -> list[NDArray[np.intp]]:
    """First rows and first columns of the blocks of a side in m."""
    counts, spacings = surface.height.shape, (surface.spacing_y, surface.spacing_x)
    return [np.arange(0, count, max(1, round(side / spacing))) for count, spacing in zip(counts, spacings, strict=True)]


def block_means(fields: tuple[Floats, ...], mask: Mask, edges: list[NDArray[np.intp]]) -> Floats:
    """Mean of each field over the masked pixels of the blocks with any, and last their number."""

    def total(values: Floats) -> Floats:
        return np.asarray(np.add.reduceat(np.add.reduceat(values, edges[0], axis=0), edges[1], axis=1))

    count = total(mask.astype(np.float64))
    used = count > 0
    return np.array([*(total(np.where(mask, values, 0.0))[used] / count[used] for values in fields), count[used]])


@dataclass(frozen=True, kw_only=True, slots=True)
class GrooveTrack:
    """Centre line of a wear groove in a scan, relative to the centre of the field.

    Parameters
    ----------
    track_direction : float
        Direction of the track past the centre of the field, from the rows towards the columns. [rad]
    track_curvature : float
        Curvature of the concentric circle through the centre of the field; zero for a straight track, positive for a
        centre to the left of the direction. [1/m]
    track_offset : float
        Distance of the track from the centre of the field, positive to the left of the direction. [m]
    """

    track_direction: float
    track_curvature: float
    track_offset: float

    def __post_init__(self) -> None:
        require_finite(**asdict(self))

    @property
    def groove_diameter(self) -> float:
        """Diameter of the circular wear track on the disc; infinite for a straight track. [m]"""
        return 2 * abs(1 / self.track_curvature - self.track_offset) if self.track_curvature else math.inf

    def curvilinear_coordinates(self, surface: HeightMap) -> tuple[Floats, Floats]:
        """Transverse distance and arc length of each pixel with respect to the track.

        Parameters
        ----------
        surface : HeightMap

        Returns
        -------
        transverse : ndarray, shape of the heights
            Distance from the track in m, positive to the left of its direction.
        arc_length : ndarray, shape of the heights
            Length along the track from the centre of the field, in m.
        """
        x, y = centred_coordinates(surface)
        transverse, arc_length = arc_coordinates(x, y, self.track_direction, self.track_curvature)
        return transverse - self.track_offset, arc_length * (1 - self.track_curvature * self.track_offset)

    def pixel_position(self, surface: HeightMap, transverse: Floats, arc_length: Floats) -> tuple[Floats, Floats]:
        """Fractional row and column of points given by curvilinear coordinates; inverse of `curvilinear_coordinates`.

        Parameters
        ----------
        surface : HeightMap
        transverse : ndarray, any shape
            Distances from the track in m.
        arc_length : ndarray, shape of `transverse`
            Lengths along the track in m.

        Returns
        -------
        row : ndarray, shape of `transverse`
        column : ndarray, shape of `transverse`
        """
        k, from_circle = self.track_curvature, transverse + self.track_offset
        angle = k * arc_length / (1 - k * self.track_offset)
        half = arc_length / (1 - k * self.track_offset) * np.sinc(angle / (2 * math.pi)) / 2  # sin(angle/2)/k
        radius = 1 - k * from_circle
        left, ahead = from_circle + 2 * k * half**2 * radius, 2 * half * np.cos(angle / 2) * radius
        cos, sin = math.cos(self.track_direction), math.sin(self.track_direction)
        rows, columns = surface.height.shape
        column = (ahead * cos - left * sin) / surface.spacing_x + (columns - 1) / 2
        row = (ahead * sin + left * cos) / surface.spacing_y + (rows - 1) / 2
        return row, column


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
