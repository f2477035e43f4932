"""Summits of a rough surface, counted or inferred from its spectrum, for the contact models."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, UnknownName
from sonolube.surfaces.grid_kernel import (
    central_moment_sums,
    column_difference_sums,
    count_sum_and_extremes,
    local_maxima,
    row_difference_sums,
)
from sonolube.surfaces.height_map import HeightMap
from sonolube.surfaces.roughness import Roughness
from sonolube.surfaces.spectrum import SpectralMoments

# Nayak's theory of isotropic Gaussian surfaces
_DENSITY = 1 / (6 * math.pi * math.sqrt(3))
_CURVATURE = 8 / (3 * math.sqrt(math.pi))
_MEAN_HEIGHT = 4 / math.sqrt(math.pi)
_LOST_VARIANCE = 0.8968


@dataclass(frozen=True, kw_only=True, slots=True)
class SummitStatistics:
    """What the summits of one surface are like.

    Parameters
    ----------
    summit_density : float
        Summits per area. [1/m2]
    mean_summit_curvature : float
        Mean over the summits of the mean of both principal curvatures, positive for a hill. [1/m]
    mean_summit_height : float
        Mean height of summits above the mean plane of the surface. [m]
    summit_height_deviation : float
        Standard deviation of summit heights. [m]
    """

    summit_density: float
    mean_summit_curvature: float
    mean_summit_height: float
    summit_height_deviation: float

    @property
    def summit_radius(self) -> float:
        """Inverse of the mean curvature; the mean of radii would be ruled by the flattest summits. [m]"""
        return 1 / self.mean_summit_curvature


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SamplingDependence:
    """What becomes of the summits as the surface is sampled more coarsely.

    Parameters
    ----------
    sampling_interval : ndarray, shape (n,)
        Root of the area of a pixel. [m]
    rms_height : ndarray, shape (n,)
        Standard deviation of asperity heights. [m]
    summit_radius : ndarray, shape (n,)
        Mean radius of asperity summits. [m]
    summit_density : ndarray, shape (n,)
        Areal density of asperity summits. [1/m2]
    """

    sampling_interval: Floats
    rms_height: Floats
    summit_radius: Floats
    summit_density: Floats


def summit_statistics(surface: HeightMap) -> SummitStatistics:
    """Return the statistics of the pixels that are higher than all their eight neighbours.

    Parameters
    ----------
    surface : HeightMap
        Pixels at the edge or beside a missing one are neither counted nor charged to the area.

    Returns
    -------
    SummitStatistics

    Raises
    ------
    InvalidInput
        If there are fewer than two summits.

    Notes
    -----
    A summit's curvature is the mean of the negative second differences along row and column at its pixel, which
    underrates narrow summits: with ten pixels to the correlation length by about 1 %. Noise of the instrument counts as
    summits: filter first, and see `sampling_dependence`.

    References
    ----------
    .. [1] J. A. Greenwood, Proc. R. Soc. A 393, 133 (1984). doi:10.1098/rspa.1984.0050
    """
    z = np.ascontiguousarray(surface.height)
    candidates, places = local_maxima(z)
    if places.size < 2:
        raise InvalidInput(f"a surface needs two summits for statistics, got {places.size} among {candidates} pixels")
    columns = z.shape[1]
    flat = z.ravel()
    top = flat[places]
    bend_x = 2 * top - flat[places - 1] - flat[places + 1]
    bend_y = 2 * top - flat[places - columns] - flat[places + columns]
    return SummitStatistics(
        summit_density=places.size / (candidates * surface.spacing_x * surface.spacing_y),
        mean_summit_curvature=float(np.mean(bend_x / surface.spacing_x**2 + bend_y / surface.spacing_y**2)) / 2,
        mean_summit_height=float(np.mean(top)) - _mean_and_variance(z)[0],
        summit_height_deviation=float(np.std(top)),
    )


def spectral_moments(surface: HeightMap) -> SpectralMoments:
    """Return m0, m2 and m4 from finite differences of neighbouring pixels, the mean of both directions.

    Parameters
    ----------
    surface : HeightMap
        Differences with a missing pixel in them are left out.

    Returns
    -------
    SpectralMoments

    Raises
    ------
    InvalidInput
        If the map is flat, or no three neighbouring pixels were measured in either direction.

    References
    ----------
    .. [1] J. I. McCool, Wear 107, 37 (1986). doi:10.1016/0043-1648(86)90045-1
    """
    z = np.ascontiguousarray(surface.height)
    firsts_x, slopes_x, seconds_x, bends_x = row_difference_sums(z)
    firsts_y, slopes_y, seconds_y, bends_y = column_difference_sums(z)
    if not min(firsts_x, firsts_y, seconds_x, seconds_y) > 0:
        raise InvalidInput("spectral moments need three neighbouring measured pixels along a row and along a column")
    dx, dy = surface.spacing_x, surface.spacing_y
    return SpectralMoments(
        height_variance=_mean_and_variance(z)[1],
        slope_variance=(slopes_x / firsts_x / dx**2 + slopes_y / firsts_y / dy**2) / 2,
        curvature_variance=(bends_x / seconds_x / dx**4 + bends_y / seconds_y / dy**4) / 2,
    )


def nayak_summit_statistics(moments: SpectralMoments) -> SummitStatistics:
    """Return the summits of an isotropic Gaussian surface with these spectral moments.

    Parameters
    ----------
    moments : SpectralMoments

    Returns
    -------
    SummitStatistics

    Raises
    ------
    InvalidInput
        If the bandwidth is so small that no surface has such moments.

    Notes
    -----
    An isotropic Gaussian surface has a bandwidth of 1.5 or more.

    References
    ----------
    .. [1] P. R. Nayak, J. Lubr. Technol. 93, 398 (1971). doi:10.1115/1.3451608
    """
    m0, m2, m4, alpha = moments.height_variance, moments.slope_variance, moments.curvature_variance, moments.bandwidth
    if not alpha > 1:
        raise InvalidInput(f"bandwidth must exceed 1, got {alpha!r}: no profile has such moments")
    return SummitStatistics(
        summit_density=_DENSITY * m4 / m2,
        mean_summit_curvature=_CURVATURE * math.sqrt(m4),
        mean_summit_height=_MEAN_HEIGHT * math.sqrt(m0 / alpha),
        summit_height_deviation=math.sqrt((1 - _LOST_VARIANCE / alpha) * m0),
    )


def _from_moments(surface: HeightMap) -> SummitStatistics:
    return nayak_summit_statistics(spectral_moments(surface))


_METHODS: Mapping[str, Callable[[HeightMap], SummitStatistics]] = MappingProxyType(
    {"summits": summit_statistics, "moments": _from_moments}
)


def contact_roughness(surface: HeightMap, *, method: str = "summits") -> Roughness:
    """Return the roughness as the contact models take it.

    Parameters
    ----------
    surface : HeightMap
    method : {"summits", "moments"}
        Whether summits are counted, or inferred from the spectral moments as of an isotropic Gaussian surface.

    Returns
    -------
    Roughness
        Its `rms_height` is the deviation of summit heights, not that of the surface.

    Raises
    ------
    UnknownName
        If the method is unknown.
    InvalidInput
        As by `summit_statistics`, `spectral_moments` and `nayak_summit_statistics`.
    """
    if method not in _METHODS:
        raise UnknownName.among(_METHODS, kind="method", name=method)
    found = _METHODS[method](surface)
    return Roughness(
        rms_height=found.summit_height_deviation,
        summit_radius=found.summit_radius,
        summit_density=found.summit_density,
    )


def combined_roughness(first: Roughness, second: Roughness) -> Roughness:
    """Return the roughness of two surfaces in contact, as of one rough surface against a smooth one.

    Parameters
    ----------
    first, second : Roughness

    Returns
    -------
    Roughness

    Notes
    -----
    Heights of unrelated surfaces add up, and so do their spectral moments. Each roughness stands for the moments of the
    isotropic Gaussian surface with such summits; the sum of the moments gives the summits of the gap.

    References
    ----------
    .. [1] J. I. McCool, Wear 107, 37 (1986). doi:10.1016/0043-1648(86)90045-1
    """
    slope_1, bend_1 = _equivalent_moments(first)
    slope_2, bend_2 = _equivalent_moments(second)
    slope, bend = slope_1 + slope_2, bend_1 + bend_2
    # m0 - 0.8968 m2^2/m4 of the sums, less that of each: written so that it cannot fall below zero
    unlikeness = _LOST_VARIANCE * (slope_1 * bend_2 - slope_2 * bend_1) ** 2 / (bend_1 * bend_2 * bend)
    return Roughness(
        rms_height=math.sqrt(first.rms_height**2 + second.rms_height**2 + unlikeness),
        summit_radius=1 / (_CURVATURE * math.sqrt(bend)),
        summit_density=_DENSITY * bend / slope,
    )


def _equivalent_moments(one: Roughness) -> tuple[float, float]:
    """Return m2 and m4 of the Gaussian surface that has such summit_statistics."""
    curvature_variance = (1 / (_CURVATURE * one.summit_radius)) ** 2
    return _DENSITY * curvature_variance / one.summit_density, curvature_variance


def sampling_dependence(
    surface: HeightMap, *, sampling_interval: ArrayLike, method: str = "summits"
) -> SamplingDependence:
    """Return the roughness as found with coarser sampling.

    Parameters
    ----------
    surface : HeightMap
    sampling_interval : array_like, shape (n,)
        Distances of neighbouring points wanted; along rows and columns the nearest whole number of pixels is taken. [m]
    method : {"summits", "moments"}
        As by `contact_roughness`.

    Returns
    -------
    SamplingDependence

    Raises
    ------
    InvalidInput
        If an interval is shorter than half a pixel, or so long that too few points or summits are left.

    Notes
    -----
    Radius and density of summits have no value of their own on a surface with ever finer detail: they follow the
    interval. A contact model takes them at the interval that suits its scale.
    """
    wanted = np.atleast_1d(require_positive(sampling_interval=sampling_interval))
    coarser = [_decimated(surface, float(interval)) for interval in wanted]
    found = [contact_roughness(one, method=method) for one in coarser]
    return SamplingDependence(
        sampling_interval=np.array([math.sqrt(one.spacing_x * one.spacing_y) for one in coarser]),
        rms_height=np.array([one.rms_height for one in found]),
        summit_radius=np.array([one.summit_radius for one in found]),
        summit_density=np.array([one.summit_density for one in found]),
    )


def _mean_and_variance(height: Floats) -> tuple[float, float]:
    count, total, _, _ = count_sum_and_extremes(height)
    mean = total / count
    return mean, central_moment_sums(height, mean)[1] / count


def _decimated(surface: HeightMap, interval: float) -> HeightMap:
    step_x, step_y = round(interval / surface.spacing_x), round(interval / surface.spacing_y)
    if min(step_x, step_y) < 1:
        raise InvalidInput(
            f"sampling_interval must be at least the spacing of the map, {surface.spacing_x!r} m by "
            f"{surface.spacing_y!r} m, got {interval!r} m"
        )
    return HeightMap(
        height=np.ascontiguousarray(surface.height[::step_y, ::step_x]),
        spacing_x=step_x * surface.spacing_x,
        spacing_y=step_y * surface.spacing_y,
    )
