"""A worn scan in blocks: unworn ones as they are, worn ones less the mean section of the groove."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from sonolube.checks import Floats
from sonolube.errors import InvalidInput
from sonolube.surfaces.grooves.plane_coordinates import centred_coordinates, monomials
from sonolube.surfaces.grooves.track import GrooveTrack
from sonolube.surfaces.height_map import HeightMap

Mask = NDArray[np.bool_]

SHORTEST_RELATIVE_WAVELENGTH = 1 / 6
"""Shortest wave of a reference, over the longer side of the field."""

HEIGHT_RESOLUTION = 1e-12
"""No instrument shows less, in m."""

_BOX = 1.5  # period of the modes over the field: a wave of any length lies near one
_BLOCKS = 48  # along the longer side
_KNOT = 50e-6 / 2.4e-3  # distance of the knots of the section, over the longer side
_SLOPE_OVER = 7  # pixels
_LEAST_UNWORN = 12
_UNEVEN, _SHORTEST_UNEVEN = 12, 8.0  # waves of the groove's depth along it, and the most of them to the longer side
_WILD = 5.0  # spreads: a block of the groove so far from its mean section is debris or torn out, not waviness
_DEVIATION_OVER_MEDIAN = 1.4826  # of Gaussian heights


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class BlockAverages:
    """Means of a scan over small squares.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
        Their centres from the middle of the field, in m.
    mean_height : ndarray, shape (n,)
        Mean height, of worn blocks less the mean section of the groove, in m.
    weight : ndarray, shape (n,)
        Measured pixels over those of a full block.
    mean_section : ndarray, shape (n,)
        What was taken off, in m.
    section : ndarray, shape (n, functions)
        What the mean section may have taken off with the groove, linear between knots; what it leaves where the groove
        is deeper and shallower in turn; and last what it leaves where the track turns by a radian, and where its turn
        over the field grows by one, both over the longer side of the field.
        Zero for unworn blocks, and without columns where no block is worn.
    unworn : int
        The first so many blocks are unworn.
    field : tuple of float
        Length of the field along x and y, in m.
    """

    x: Floats
    y: Floats
    mean_height: Floats
    weight: Floats
    mean_section: Floats
    section: Floats
    unworn: int
    field: tuple[float, float]

    @property
    def longer_side(self) -> float:
        """Longer side of the field. [m]"""
        return max(self.field)

    @property
    def parts(self) -> list[slice]:
        """The unworn blocks, and the worn ones where there are any."""
        both = slice(0, self.unworn), slice(self.unworn, self.x.size)
        return [part for part in both if part.start < part.stop]

    @property
    def spread(self) -> float:
        """Standard deviation of the unworn blocks. [m]"""
        return max(float(np.std(self.mean_height[: self.unworn])), HEIGHT_RESOLUTION)

    def modes(self) -> Floats:
        """Return the waves of a box around the field, one of each pair k and -k, in waves per metre, shape (n, 2)."""
        longer = self.longer_side
        box_x, box_y = (_BOX * length for length in self.field)
        reach_x, reach_y = (int(box / (SHORTEST_RELATIVE_WAVELENGTH * longer)) for box in (box_x, box_y))
        i, j = (part.ravel() for part in np.meshgrid(np.arange(reach_x + 1), np.arange(-reach_y, reach_y + 1)))
        modes = np.stack([i / box_x, j / box_y], axis=1)
        return np.asarray(
            modes[((i > 0) | (j > 0)) & (np.hypot(*modes.T) <= 1 / (SHORTEST_RELATIVE_WAVELENGTH * longer))]
        )

    def waves(self, modes: Floats) -> tuple[Floats, Floats]:
        """Return cosine and sine of each mode in the middle of each block, both of shape (blocks, modes)."""
        turn = 2 * math.pi * (np.outer(self.x, modes[:, 0]) + np.outer(self.y, modes[:, 1]))
        return np.cos(turn), np.sin(turn)

    def form(self, terms: int) -> Floats:
        """Return the first powers of position over half the longer side, shape (blocks, terms)."""
        half = self.longer_side / 2
        return np.stack(monomials(self.x / half, self.y / half, terms), axis=1)

    def without_groove(self) -> "BlockAverages":
        """Return the blocks as if nothing were worn."""
        return replace(
            self,
            mean_height=self.mean_height + self.mean_section,
            mean_section=np.zeros_like(self.mean_section),
            section=self.section[:, :0],
            unworn=self.x.size,
        )


def block_averages(
    surface: HeightMap, *, track: GrooveTrack, worn_band: tuple[float, float], left_out: Mask | None = None
) -> BlockAverages:
    """Return the scan in blocks.

    Parameters
    ----------
    surface : HeightMap
        Less the plane through what is unworn.
    track : GrooveTrack
    worn_band : tuple of float
        Between which distances from the track the surface is worn, in m.
    left_out : bool array, shape of the heights, optional
        Pixels that do not count.

    Returns
    -------
    WornBlocks

    Raises
    ------
    InvalidInput
        If hardly anything is unworn.
    """
    rows, columns = surface.height.shape
    field = (columns * surface.spacing_x, rows * surface.spacing_y)
    longer = max(field)
    across, along = track.curvilinear_coordinates(surface)
    counted = surface.measured if left_out is None else surface.measured & ~left_out
    inside = (across > worn_band[0]) & (across < worn_band[1])
    worn = counted & inside
    section, turned, bent = np.zeros((3, rows, columns))
    if worn.any():
        ahead = along[worn] / longer
        means, slope = _section(across[worn], np.stack([surface.height[worn], ahead, ahead**2 / 2]), surface)
        section[worn] = means[0]
        turned[worn] = -slope * (ahead - means[1])
        bent[worn] = -slope * (ahead**2 / 2 - means[2])
    x, y = centred_coordinates(surface)
    fields = (x, y, surface.height - section, section, across, turned, bent, along)
    edges = _edges(surface, longer / _BLOCKS)
    unworn, groove = (_means(fields, mask, edges) for mask in (counted & ~inside, worn))
    if unworn.shape[1] < _LEAST_UNWORN:
        raise InvalidInput(
            f"hardly anything of the scan is unworn, {unworn.shape[1]} squares of {longer / _BLOCKS:.2g} m"
        )
    groove = groove[:, np.abs(groove[2]) < _WILD * _spread(unworn[2], groove[2])]
    free = np.empty((0, 0))
    if groove.size:
        free = np.column_stack(
            [_hats(groove[4], _KNOT * longer), _uneven(groove[3], groove[7] / longer), groove[5:7].T]
        )
    both = np.concatenate([unworn, groove], axis=1)
    return BlockAverages(
        x=both[0],
        y=both[1],
        mean_height=both[2],
        weight=both[-1] / both[-1].max(),
        mean_section=both[3],
        section=np.concatenate([np.zeros((unworn.shape[1], free.shape[1])), free]),
        unworn=unworn.shape[1],
        field=field,
    )


def _spread(unworn: Floats, groove: Floats) -> float:
    """Return how far a block of the groove may lie from its mean section, as unworn blocks do or most of its own."""
    own = _DEVIATION_OVER_MEDIAN * float(np.median(np.abs(groove))) if groove.size else 0.0
    return max(float(np.std(unworn)), own)


def _hats(at: Floats, step: float) -> Floats:
    """Return functions that are linear between knots, shape (n, knots)."""
    hats = np.maximum(0.0, 1 - np.abs(at[:, None] - np.arange(at.min(), at.max() + step, step)) / step)
    return np.asarray(hats[:, hats.sum(axis=0) > 0])


def _section(across: Floats, values: Floats, surface: HeightMap) -> tuple[Floats, Floats]:
    """Return means of values over pixels at equal distance from the track, and the slope of the first of them."""
    position = across / min(surface.spacing_x, surface.spacing_y)
    bins = np.floor(position - position.min()).astype(np.intp)
    count = np.bincount(bins)
    used = count > 0
    at = np.bincount(bins, position)[used] / count[used]
    means = [np.bincount(bins, value)[used] / count[used] for value in values]
    step = min(surface.spacing_x, surface.spacing_y)
    slope = np.gradient(uniform_filter1d(means[0], _SLOPE_OVER, mode="nearest"), at * step) if at.size > 1 else at * 0
    return np.stack([np.interp(position, at, mean) for mean in means]), np.interp(position, at, slope)


def _uneven(section: Floats, along: Floats) -> Floats:
    """Return the section, deeper and shallower in turn along the track, shape (n, functions)."""
    turns = 2 * math.pi * np.outer(along, np.arange(1, _UNEVEN + 1) / _UNEVEN * _SHORTEST_UNEVEN)
    depth = section[:, None] / max(float(np.max(np.abs(section))), np.finfo(float).tiny)
    return np.concatenate([depth * np.cos(turns), depth * np.sin(turns)], axis=1)


def _edges(surface: HeightMap, side: float) -> list[NDArray[np.intp]]:
    counts, spacings = surface.height.shape, (surface.spacing_y, surface.spacing_x)
    return [np.arange(0, count, max(1, round(side / spacing))) for count, spacing in zip(counts, spacings, strict=True)]


def _means(fields: tuple[Floats, ...], mask: Mask, edges: list[NDArray[np.intp]]) -> Floats:
    """Return the mean of each field over the blocks that hold any masked pixel, and last their count."""

    def total(values: Floats) -> Floats:
        return np.asarray(np.add.reduceat(np.add.reduceat(values, edges[0], axis=0), edges[1], axis=1))

    count = total(mask.astype(np.float64))
    used = count > 0
    return np.array([*(total(np.where(mask, values, 0.0))[used] / count[used] for values in fields), count[used]])
