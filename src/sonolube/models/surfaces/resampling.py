"""Height maps at other points than their pixels: block means on a coarser grid, and sections along lines."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.models.surfaces.height_map import HeightMap

_Places = NDArray[np.int_]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class BlockMeans:
    """Mean heights of blocks of pixels.

    Parameters
    ----------
    x, y : ndarray, shape (columns,) and (rows,)
        Centres of the blocks in m, from the centre of the first pixel.
    height : ndarray, shape (rows, columns)
        Mean of the measured pixels; NaN where a block has none. [m]
    size : tuple of int
        Columns and rows of pixels of a block; those at the end may have fewer.
    """

    x: Floats
    y: Floats
    height: Floats
    size: tuple[int, int]


def block_means(surface: HeightMap, *, most: int) -> BlockMeans:
    """Height map reduced to a number of cells by the means of equal blocks of pixels.

    Parameters
    ----------
    surface : HeightMap
        Missing pixels do not count.
    most : int
        Cells along the longer side; blocks are as nearly square as the spacings allow.

    Returns
    -------
    BlockMeans
        The pixels themselves where the map has no more.
    """
    rows, columns = surface.height.shape
    cell = max(surface.sides) / most
    size_x, size_y = (math.ceil(cell / step - 1e-9) for step in (surface.spacing_x, surface.spacing_y))
    starts_x, starts_y = np.arange(0, columns, size_x), np.arange(0, rows, size_y)
    height = surface.height
    if size_x > 1 or size_y > 1:
        count = _block_sums(surface.measured.astype(np.float64), starts_x, starts_y)
        total = _block_sums(np.nan_to_num(height, nan=0.0), starts_x, starts_y)
        height = np.where(count > 0, total / np.maximum(count, 1), np.nan)
    return BlockMeans(
        x=surface.spacing_x * _centres(starts_x, columns),
        y=surface.spacing_y * _centres(starts_y, rows),
        height=height,
        size=(size_x, size_y),
    )


def _block_sums(values: Floats, starts_x: _Places, starts_y: _Places) -> Floats:
    """Sums over blocks that begin at some columns and rows."""
    return np.asarray(np.add.reduceat(np.add.reduceat(values, starts_y, axis=0), starts_x, axis=1))


def _centres(starts: _Places, count: int) -> Floats:
    """Centres of blocks in pixels, from the centre of the first one."""
    ends = np.append(starts[1:], count)
    return np.asarray((starts + ends - 1) / 2)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class LineSection:
    """Heights along a straight line over a surface.

    Parameters
    ----------
    distance : ndarray, shape (n,)
        From the start in m, in even steps of at most the smaller spacing.
    height : ndarray, shape (n,)
        Interpolated between the four pixels around; NaN where one of them that counts is missing. [m]
    """

    distance: Floats
    height: Floats


def line_section(surface: HeightMap, *, start: Sequence[float], end: Sequence[float]) -> LineSection:
    """Section of a height map along a line, at the resolution of its pixels.

    Parameters
    ----------
    surface : HeightMap
    start, end : sequence of two float
        x and y of the ends in m, from the centre of the first pixel; within half a pixel of the outermost centres.

    Returns
    -------
    LineSection

    Raises
    ------
    InvalidInput
        If an end is beyond the field, or both are the same point.
    """
    rows, columns = surface.height.shape
    steps, counts = np.array([surface.spacing_x, surface.spacing_y]), np.array([columns, rows])
    ends = np.asarray([start, end], dtype=np.float64)
    for name, place, step, count in zip("xyxy", ends.ravel(), [*steps, *steps], [*counts, *counts], strict=True):
        if not -0.5000001 * step <= place <= (count - 0.4999999) * step:
            lowest, highest = 1e6 * -step / 2, 1e6 * (count - 0.5) * step
            raise InvalidInput(
                f"section: {name} = {1e6 * place:.5g} um is outside the field, {lowest:.4g} um to {highest:.4g} um"
            )
    length = float(math.dist(*ends))
    if length == 0:
        raise InvalidInput("section: both ends are the same point; move one of them")
    share = np.linspace(0.0, 1.0, max(1, math.ceil(length / steps.min() - 1e-9)) + 1)
    places = np.clip((ends[0] + share[:, None] * (ends[1] - ends[0])) / steps, 0, counts - 1)
    low = np.minimum(places.astype(np.intp), np.maximum(counts - 2, 0))
    high = np.minimum(low + 1, counts - 1)
    right, below = (places - low).T
    height = np.zeros(share.size)
    for column, across in ((low[:, 0], 1 - right), (high[:, 0], right)):
        for row, along in ((low[:, 1], 1 - below), (high[:, 1], below)):
            weight = across * along
            height += np.where(weight > 0, weight * surface.height[row, column], 0.0)
    return LineSection(distance=share * length, height=height)
