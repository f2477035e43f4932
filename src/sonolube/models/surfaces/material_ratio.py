"""Material ratio (Abbott-Firestone) curve of a height map, and its material ratio and volume parameters."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_within
from sonolube.errors import InvalidInput
from sonolube.models.surfaces.height_map import HeightMap

_SECANT = 0.4  # material ratio spanned by the secant of least slope (ISO 25178-2)
_PEAKS_END, _CORE_END = 0.1, 0.8  # material ratios that bound the core volume (ISO 25178-3)
_MIN_PIXELS = 10


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class MaterialRatioCurve:
    """Material ratio (Abbott-Firestone) curve: fraction of the surface at or above each height.

    Parameters
    ----------
    height : ndarray, shape (n,)
        Heights of all measured pixels above their mean, in descending order. [m]

    Notes
    -----
    The i-th of n heights, counted from 1, has the material ratio (i - 1/2)/n; between heights the curve is linear.
    """

    height: Floats

    @property
    def material_ratio(self) -> Floats:
        """Fraction of the surface at or above each height, of its shape. []"""
        return (np.arange(self.height.size) + 0.5) / self.height.size

    def ratio_above(self, *, intersection_height: ArrayLike) -> Floats:
        """Areal material ratio Smr(c) of ISO 25178-2. []

        Parameters
        ----------
        intersection_height : array_like, any shape
            Height c of the intersecting plane above the mean. [m]

        Returns
        -------
        ndarray, shape of `intersection_height`
            0 above the highest and 1 below the lowest pixel.
        """
        c = require_finite(intersection_height=intersection_height)
        ascending, n = self.height[::-1], self.height.size
        upper = np.clip(np.searchsorted(ascending, c), 1, n - 1)
        low, high = ascending[upper - 1], ascending[upper]
        between = np.divide(c - low, high - low, out=np.zeros_like(c), where=high > low)
        ratio = 1 - (upper - 0.5 + between) / n
        return np.where(c > ascending[-1], 0.0, np.where(c < ascending[0], 1.0, ratio))

    def height_at(self, *, material_ratio: ArrayLike) -> Floats:
        """Inverse areal material ratio Smc(p) of ISO 25178-2, as height above the mean. [m]

        Parameters
        ----------
        material_ratio : array_like, any shape
            Fraction p of the surface at or above that height, from 0 to 1. []

        Returns
        -------
        ndarray, shape of `material_ratio`
        """
        p = require_within(0.0, 1.0, material_ratio=material_ratio)
        position = np.clip(p * self.height.size - 0.5, 0.0, self.height.size - 1.0)
        before = np.minimum(position.astype(np.int64), self.height.size - 2)
        high, low = self.height[before], self.height[before + 1]
        return np.asarray(high + (position - before) * (low - high))


@dataclass(frozen=True, kw_only=True, slots=True)
class FunctionalParameters:
    """Material ratio and volume parameters of ISO 25178-2.

    Parameters
    ----------
    core_height : float
        Core height Sk. [m]
    reduced_peak_height : float
        Reduced peak height Spk: height of the triangle of the area of the peaks above the core. [m]
    reduced_valley_depth : float
        Reduced valley (dale) depth Svk: depth of the triangle of the area of the valleys below the core. [m]
    peak_material_ratio : float
        Material ratio Smr1 at the upper end of the core. []
    valley_material_ratio : float
        Material ratio Smr2 at the lower end of the core. []
    peak_material_volume : float
        Peak material volume Vmp: material above the height of 10 % material ratio, per area. [m]
    core_material_volume : float
        Core material volume Vmc: material between the heights of 10 and 80 %, per area. [m]
    core_void_volume : float
        Core void volume Vvc: void between the heights of 10 and 80 %, per area. [m]
    valley_void_volume : float
        Valley (dale) void volume Vvv: void below the height of 80 %, per area. [m]
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
    """Material ratio (Abbott-Firestone) curve of the measured pixels of a height map.

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
        raise InvalidInput(f"a material ratio curve requires two measured pixels, got {z.size}")
    z -= z.mean()
    z.sort()
    return MaterialRatioCurve(height=z[::-1])


def functional_parameters(surface: HeightMap | MaterialRatioCurve) -> FunctionalParameters:
    r"""Parameters Sk, Spk, Svk, Smr1, Smr2, Vmp, Vmc, Vvc and Vvv of ISO 25178-2 from the material ratio curve.

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
    The equivalent straight line is the least-squares fit where the secant over 40 % of the material ratio has the least
    slope. Its heights at the material ratios 0 and 1 bound the core; peaks above and valleys below are replaced by
    triangles of equal area. The method is defined for curves with one point of inflection, as of honed and ground
    surfaces. Volumes per area follow from the curve :math:`c(p)`:

    .. math:: V_m(p) = \int_0^p [c(s) - c(p)]\, \mathrm{d}s, \qquad V_v(p) = \int_p^1 [c(p) - c(s)]\, \mathrm{d}s ,

    :math:`V_{mp} = V_m(0.1)`, :math:`V_{mc} = V_m(0.8) - V_{mp}`, :math:`V_{vv} = V_v(0.8)`,
    :math:`V_{vc} = V_v(0.1) - V_{vv}`.

    References
    ----------
    .. [1] ISO 25178-2:2021 and ISO 25178-3:2012, Geometrical product specifications, surface texture: areal.
    """
    curve = surface if isinstance(surface, MaterialRatioCurve) else material_ratio_curve(surface)
    z = curve.height
    if z.size < _MIN_PIXELS or z[0] == z[-1]:
        raise InvalidInput(f"functional parameters require ten measured pixels of different heights, got {z.size}")
    top, slope = _equivalent_line(z)
    bottom = top + slope
    peaks_end, valleys_start = (float(ratio) for ratio in curve.ratio_above(intersection_height=[top, bottom]))
    first, second = (float(height) for height in curve.height_at(material_ratio=[_PEAKS_END, _CORE_END]))
    level = np.array([top, bottom, first, second])
    peak_area, above_bottom, peak_material, above_second = (float(volume) for volume in _material_above(z, level))
    # heights are relative to their mean, so that the void below a level is the material above it plus the level
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
    """Height at material ratio 0 and slope of the line fitted to the flattest 40 % of the curve."""
    n = height.size
    span = round(_SECANT * n)
    start = int(np.argmin(height[: n - span] - height[span:]))
    part = height[start : start + span + 1]
    p = (np.arange(start, start + span + 1) + 0.5) / n
    offset = p - p.mean()
    slope = float(offset @ part / (offset @ offset))
    return float(part.mean() - slope * p.mean()), slope


def _material_above(height: Floats, level: Floats) -> Floats:
    """Material volume above each level, per area."""
    n = height.size
    counts = n - np.searchsorted(height[::-1], level, side="right")
    return np.array([np.sum(height[:count]) - one * count for count, one in zip(counts, level, strict=True)]) / n
