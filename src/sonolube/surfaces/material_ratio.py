"""The material ratio curve of a height map, and what it says of bearing, running in and holding fluid."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_within
from sonolube.errors import InvalidInput
from sonolube.surfaces.height_map import HeightMap

_SECANT = 0.4  # of the material, over which ISO 25178-2 seeks the flattest part of the curve
_PEAKS_END, _CORE_END = 0.1, 0.8  # material ratios that bound the core in ISO 25178-3
_LEAST_PIXELS = 10


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MaterialRatioCurve:
    """The Abbott curve: which share of the surface lies at or above a height.

    Parameters
    ----------
    height : ndarray, shape (n,)
        Heights of all measured pixels over their mean, from the highest to the deepest. [m]

    Notes
    -----
    The i-th of n heights, counted from 1, stands at the material ratio (i - 1/2)/n; between them the curve is straight.
    """

    height: Floats

    @property
    def material_ratio(self) -> Floats:
        """Share of the surface at or above each height, of its shape. []"""
        return (np.arange(self.height.size) + 0.5) / self.height.size

    def ratio_above(self, *, intersection_height: ArrayLike) -> Floats:
        """Return the areal material ratio Smr(c). []

        Parameters
        ----------
        intersection_height : array_like, any shape
            Height of the section over the mean, c. [m]

        Returns
        -------
        ndarray, shape of `intersection_height`
            0 above the highest and 1 below the deepest pixel.
        """
        c = require_finite(intersection_height=intersection_height)
        rising, n = self.height[::-1], self.height.size
        upper = np.clip(np.searchsorted(rising, c), 1, n - 1)
        low, high = rising[upper - 1], rising[upper]
        between = np.divide(c - low, high - low, out=np.zeros_like(c), where=high > low)
        ratio = 1 - (upper - 0.5 + between) / n
        return np.where(c > rising[-1], 0.0, np.where(c < rising[0], 1.0, ratio))

    def height_at(self, *, material_ratio: ArrayLike) -> Floats:
        """Return the inverse material ratio Smc(p), as height over the mean. [m]

        Parameters
        ----------
        material_ratio : array_like, any shape
            Share of the surface at or above that height, p, from 0 to 1. []

        Returns
        -------
        ndarray, shape of `material_ratio`
        """
        p = require_within(0.0, 1.0, material_ratio=material_ratio)
        place = np.clip(p * self.height.size - 0.5, 0.0, self.height.size - 1.0)
        before = np.minimum(place.astype(np.int64), self.height.size - 2)
        high, low = self.height[before], self.height[before + 1]
        return np.asarray(high + (place - before) * (low - high))


@dataclass(frozen=True, kw_only=True, slots=True)
class FunctionalParameters:
    """The material ratio curve in numbers.

    Parameters
    ----------
    core_height : float
        Height of the core, Sk. [m]
    reduced_peak_height : float
        Mean height of the peaks above the core, Spk. [m]
    reduced_valley_depth : float
        Mean depth of the valleys below the core, Svk. [m]
    peak_material_ratio : float
        Share of the surface that is peaks, Smr1. []
    valley_material_ratio : float
        Share of the surface that is not valleys, Smr2. []
    peak_material_volume : float
        Material above the material ratio of 10 %, per area, Vmp. [m]
    core_material_volume : float
        Material between 10 and 80 %, per area, Vmc. [m]
    core_void_volume : float
        Void between 10 and 80 %, per area, Vvc. [m]
    valley_void_volume : float
        Void below 80 %, per area, Vvv. [m]
    """

    core_height: float
    reduced_peak_height: float
    reduced_valley_depth: float
    peak_material_ratio: float
    valley_material_ratio: float
    peak_material_volume: float
    core_material_volume: float
    core_void_volume: float
    valley_void_volume: float


def material_ratio_curve(surface: HeightMap) -> MaterialRatioCurve:
    """Return the material ratio curve of the measured pixels.

    Parameters
    ----------
    surface : HeightMap

    Returns
    -------
    MaterialRatioCurve

    Raises
    ------
    InvalidInput
        If fewer than two pixels were measured.

    References
    ----------
    .. [1] ISO 25178-2:2021, Geometrical product specifications, surface texture: areal, part 2.
    """
    z = surface.height[surface.measured]
    if z.size < 2:
        raise InvalidInput(f"a material ratio curve needs two measured pixels, got {z.size}")
    z -= z.mean()
    z.sort()
    return MaterialRatioCurve(height=z[::-1])


def functional_parameters(surface: HeightMap | MaterialRatioCurve) -> FunctionalParameters:
    """Return Sk, Spk, Svk, Smr1, Smr2, Vmp, Vmc, Vvc and Vvv.

    Parameters
    ----------
    surface : HeightMap or MaterialRatioCurve

    Returns
    -------
    FunctionalParameters

    Raises
    ------
    InvalidInput
        If fewer than ten pixels were measured, or the map is flat.

    Notes
    -----
    The equivalent straight line is fitted by least squares where the secant over 40 % of the material is flattest. It
    is meant for curves of one inflection, as of honed and ground surfaces; peaks and valleys are replaced by triangles
    of equal area.

    References
    ----------
    .. [1] ISO 25178-2:2021 and ISO 25178-3:2012, Geometrical product specifications, surface texture: areal.
    """
    curve = surface if isinstance(surface, MaterialRatioCurve) else material_ratio_curve(surface)
    z = curve.height
    if z.size < _LEAST_PIXELS or z[0] == z[-1]:
        raise InvalidInput(f"functional parameters need ten measured pixels that differ in height, got {z.size}")
    top, slope = _equivalent_line(z)
    bottom = top + slope
    peaks_end, valleys_start = (float(ratio) for ratio in curve.ratio_above(intersection_height=[top, bottom]))
    first, second = (float(height) for height in curve.height_at(material_ratio=[_PEAKS_END, _CORE_END]))
    level = np.array([top, bottom, first, second])
    peak_area, above_bottom, peak_material, above_second = (float(volume) for volume in _material_above(z, level))
    # heights are counted from their mean, so that the void below a level is the material above it plus the level
    valley_area, first_void, valley_void = above_bottom + bottom, peak_material + first, above_second + second
    return FunctionalParameters(
        core_height=-slope,
        reduced_peak_height=2 * peak_area / peaks_end if peaks_end > 0 else 0.0,
        reduced_valley_depth=2 * valley_area / (1 - valleys_start) if valleys_start < 1 else 0.0,
        peak_material_ratio=peaks_end,
        valley_material_ratio=valleys_start,
        peak_material_volume=peak_material,
        core_material_volume=above_second - peak_material,
        core_void_volume=first_void - valley_void,
        valley_void_volume=valley_void,
    )


def _equivalent_line(height: Floats) -> tuple[float, float]:
    """Return value at ratio 0 and slope of the line through the flattest 40 % of the curve."""
    n = height.size
    span = round(_SECANT * n)
    start = int(np.argmin(height[: n - span] - height[span:]))
    part = height[start : start + span + 1]
    p = (np.arange(start, start + span + 1) + 0.5) / n
    offset = p - p.mean()
    slope = float(offset @ part / (offset @ offset))
    return float(part.mean() - slope * p.mean()), slope


def _material_above(height: Floats, level: Floats) -> Floats:
    """Return the volume of material above each level, per area."""
    n = height.size
    counts = n - np.searchsorted(height[::-1], level, side="right")
    return np.array([np.sum(height[:count]) - one * count for count, one in zip(counts, level, strict=True)]) / n
