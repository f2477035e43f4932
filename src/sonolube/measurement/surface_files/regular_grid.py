"""Restoration of the regular grid on which positions in a file were measured, and of even steps along a profile."""

import math

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput

_COINCIDENCE = 1e-6  # of the extent: closer positions are one
_GRID_TOLERANCE = 0.1  # of the spacing: by which rounding may move positions
_MIN_FILLED = 0.9  # fraction of the steps of a profile that have a point: with fewer its steps are uneven


def grid_index(coordinate: Floats, *, axis: str) -> tuple[NDArray[np.intp], float]:
    """Index of each coordinate on the regular grid of one axis, and the spacing of that grid.

    From zero at the smallest coordinate. Spacing, in the unit of the positions.
    """
    with np.errstate(over="ignore"):
        distinct = np.unique(coordinate)
        extent = float(distinct[-1] - distinct[0])
    if not (0 < extent < math.inf):
        raise InvalidInput(f"points of one {axis} make no surface, which needs at least two")
    lines = distinct[np.concatenate(([True], np.diff(distinct) > _COINCIDENCE * extent))]
    steps = np.diff(lines)
    if not steps.size:
        raise InvalidInput(f"more {axis} than {1 / _COINCIDENCE:.0e} are no measured grid")
    spacing = extent / float(np.sum(np.rint(steps / steps.min())))  # the shortest step alone is too coarsely rounded
    index = np.rint((coordinate - distinct[0]) / spacing)
    off = np.abs(coordinate - distinct[0] - index * spacing)
    if off.max() > _GRID_TOLERANCE * spacing:
        worst = float(coordinate[np.argmax(off)])
        raise InvalidInput(f"{axis} = {worst:g} lies off the grid of spacing {spacing:g} of its neighbours")
    return index.astype(np.intp), spacing


def even_profile(coordinate: Floats, measured: Floats) -> tuple[Floats, float, tuple[str, ...]]:
    """Heights of a profile at even steps, interpolated linearly where its positions are uneven.

    Heights in the order of the positions, as the one row of a map. Their spacing, in the unit of the positions. That
    heights were interpolated, where they were.

    Positions that rounding moves by a tenth of the spacing at most, of which up to a tenth may be missing, keep their
    heights. Others are replaced by as many even steps over the same length.
    """
    order = np.argsort(coordinate, kind="stable")
    x, z = np.asarray(coordinate, dtype=np.float64)[order], np.asarray(measured, dtype=np.float64)[order]
    with np.errstate(over="ignore"):
        steps = np.diff(x)
        extent = float(x[-1] - x[0]) if x.size else 0.0
    if not (0 < extent < math.inf):
        raise InvalidInput("points of one position make no profile, which needs at least two")
    if not steps.min() > 0:
        raise InvalidInput(f"more than one point at {x[int(np.argmin(steps))]:g} along the profile")
    if np.isnan(z).all():
        raise InvalidInput(f"none of the {z.size} points has a height")
    mean_step = extent / steps.size
    if mean_step > 0 and np.abs(x - x[0] - mean_step * np.arange(x.size)).max() <= _GRID_TOLERANCE * mean_step:
        return z[np.newaxis], mean_step, ()
    if (filled := _filled(x, z)) is not None:
        return filled[0][np.newaxis], filled[1], ()
    even = np.interp(np.linspace(x[0], x[-1], x.size), x, z)
    if np.isnan(even).all():
        raise InvalidInput("too few of the points have a height to interpolate between them")
    shortest, longest = steps.min() / mean_step, steps.max() / mean_step
    note = f"steps are uneven, {shortest:.3g} to {longest:.3g} of their mean: heights interpolated at even steps"
    return even[np.newaxis], mean_step, (note,)


def _filled(coordinate: Floats, height: Floats) -> tuple[Floats, float] | None:
    """Heights of a profile on its regular grid, NaN where that has no point, and its spacing; None without a grid."""
    try:
        index, spacing = grid_index(coordinate, axis="position")
    except InvalidInput:
        return None
    points = int(index[-1]) + 1
    if coordinate.size < _MIN_FILLED * points or np.unique(index).size < index.size:
        return None
    grid = np.full(points, np.nan)
    grid[index] = height
    return grid, spacing
