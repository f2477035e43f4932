"""Summit statistics of a rough surface, counted or by Nayak's theory, and the roughness that contact models take."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.surfaces.grid_kernel import (
    central_moment_sums,
    column_difference_sums,
    count_sum_and_extremes,
    local_maxima,
    row_difference_sums,
)
from sonolube.models.surfaces.height_map import HeightMap, Roughness
from sonolube.models.surfaces.spectrum import SpectralMoments

# constants of Nayak's theory of isotropic Gaussian surfaces
_DENSITY = 1 / (6 * math.pi * math.sqrt(3))
_CURVATURE = 8 / (3 * math.sqrt(math.pi))
_MEAN_HEIGHT = 4 / math.sqrt(math.pi)
_VARIANCE_LOSS = 0.8968


@dataclass(frozen=True, kw_only=True, slots=True)
class SummitStatistics:
    """Density, curvature and heights of the summits of a surface.

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
        """Inverse of the mean curvature; a mean of radii would be dominated by the flattest summits. [m]"""
        return 1 / self.mean_summit_curvature


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SamplingDependence:
    """Contact roughness of one surface over the sampling interval.

    Parameters
    ----------
    sampling_interval : ndarray, shape (n,)
        Square root of the area of a pixel. [m]
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
    r"""Statistics of the summits of a height map, the pixels higher than all their eight neighbours.

    Parameters
    ----------
    surface : HeightMap
        Pixels at the edge or beside a missing one are left out of the count and of the area.

    Returns
    -------
    SummitStatistics

    Raises
    ------
    InvalidInput
        If there are fewer than two summits.

    See Also
    --------
    nayak_summit_statistics : The same from spectral moments, for an isotropic Gaussian surface.
    sonolube.models.surfaces.feature_parameters : Density of significant peaks Spd, which is not the summit density.

    Notes
    -----
    The curvature of a summit is the mean of the negative second differences along row and column,

    .. math:: \kappa = \frac12 \left( \frac{2 z_{i,j} - z_{i,j-1} - z_{i,j+1}}{\Delta x^2}
        + \frac{2 z_{i,j} - z_{i-1,j} - z_{i+1,j}}{\Delta y^2} \right) ,

    which underestimates narrow summits: by about 1 % with ten pixels per correlation length. Noise of the instrument
    counts as summits: filter beforehand, and see `sampling_dependence`.

    References
    ----------
    .. [1] J. A. Greenwood, Proc. R. Soc. A 393, 133 (1984). doi:10.1098/rspa.1984.0050
    """
    z = np.ascontiguousarray(surface.height)
    candidates, indices = local_maxima(z)
    if indices.size < 2:
        raise InvalidInput(f"summit statistics require two summits, got {indices.size} among {candidates} pixels")
    columns = z.shape[1]
    flat = z.ravel()
    top = flat[indices]
    second_x = 2 * top - flat[indices - 1] - flat[indices + 1]
    second_y = 2 * top - flat[indices - columns] - flat[indices + columns]
    return SummitStatistics(
        summit_density=indices.size / (candidates * surface.spacing_x * surface.spacing_y),
        mean_summit_curvature=float(np.mean(second_x / surface.spacing_x**2 + second_y / surface.spacing_y**2)) / 2,
        mean_summit_height=float(np.mean(top)) - _mean_and_variance(z)[0],
        summit_height_deviation=float(np.std(top)),
    )


def spectral_moments(surface: HeightMap) -> SpectralMoments:
    r"""Spectral moments m0, m2 and m4 of a height map by finite differences, averaged over both directions.

    Parameters
    ----------
    surface : HeightMap
        Differences that include a missing pixel are left out.

    Returns
    -------
    SpectralMoments

    Raises
    ------
    InvalidInput
        If the map is flat, or no three neighbouring pixels were measured along a row or along a column.

    Notes
    -----
    .. math:: m_0 = \overline{z^2}, \qquad
        m_2 = \overline{\left(\frac{z_{i+1} - z_i}{\Delta}\right)^2}, \qquad
        m_4 = \overline{\left(\frac{z_{i+1} - 2 z_i + z_{i-1}}{\Delta^2}\right)^2} .

    References
    ----------
    .. [1] J. I. McCool, Wear 107, 37 (1986). doi:10.1016/0043-1648(86)90045-1
    """
    z = np.ascontiguousarray(surface.height)
    firsts_x, slopes_x, seconds_x, curvatures_x = row_difference_sums(z)
    firsts_y, slopes_y, seconds_y, curvatures_y = column_difference_sums(z)
    if not min(firsts_x, firsts_y, seconds_x, seconds_y) > 0:
        raise InvalidInput("spectral moments require three neighbouring measured pixels along a row and along a column")
    dx, dy = surface.spacing_x, surface.spacing_y
    return SpectralMoments(
        height_variance=_mean_and_variance(z)[1],
        slope_variance=(slopes_x / firsts_x / dx**2 + slopes_y / firsts_y / dy**2) / 2,
        curvature_variance=(curvatures_x / seconds_x / dx**4 + curvatures_y / seconds_y / dy**4) / 2,
    )


def nayak_summit_statistics(moments: SpectralMoments) -> SummitStatistics:
    r"""Summit statistics of an isotropic Gaussian surface from its spectral moments, by Nayak's theory.

    Parameters
    ----------
    moments : SpectralMoments

    Returns
    -------
    SummitStatistics

    Raises
    ------
    InvalidInput
        If the bandwidth is not above 1, which no profile has.

    Notes
    -----
    With the bandwidth :math:`\alpha = m_0 m_4/m_2^2`, 1.5 or more for an isotropic Gaussian surface, density, mean
    curvature, mean height and variance of the heights of summits are

    .. math:: \eta = \frac{m_4}{6\pi\sqrt3\, m_2}, \qquad \bar\kappa_s = \frac83 \sqrt{\frac{m_4}{\pi}}, \qquad
        \bar z_s = 4 \sqrt{\frac{m_0}{\pi\alpha}}, \qquad
        \sigma_s^2 = \left(1 - \frac{0.8968}{\alpha}\right) m_0 .

    References
    ----------
    .. [1] P. R. Nayak, J. Lubr. Technol. 93, 398 (1971). doi:10.1115/1.3451608
    .. [2] J. I. McCool, Wear 107, 37 (1986). doi:10.1016/0043-1648(86)90045-1

    Examples
    --------
    >>> from sonolube.models.surfaces import SpectralMoments, nayak_summit_statistics
    >>> q, l = 1e-6, 10e-6  # rms height and correlation length
    >>> slope, curvature = 2 * (q / l) ** 2, 12 * (q / l**2) ** 2
    >>> moments = SpectralMoments(height_variance=q**2, slope_variance=slope, curvature_variance=curvature)
    >>> round(1e-9 * nayak_summit_statistics(moments).summit_density, 3)  # 1/(pi sqrt(3) l^2), in 1e9/m2
    1.838
    """
    m0, m2, m4, alpha = moments.height_variance, moments.slope_variance, moments.curvature_variance, moments.bandwidth
    if not alpha > 1:
        raise InvalidInput(f"bandwidth must exceed 1, got {alpha!r}: no profile has such moments")
    return SummitStatistics(
        summit_density=_DENSITY * m4 / m2,
        mean_summit_curvature=_CURVATURE * math.sqrt(m4),
        mean_summit_height=_MEAN_HEIGHT * math.sqrt(m0 / alpha),
        summit_height_deviation=math.sqrt((1 - _VARIANCE_LOSS / alpha) * m0),
    )


_METHODS: Mapping[str, Callable[[HeightMap], SummitStatistics]] = MappingProxyType(
    {"summits": summit_statistics, "moments": lambda surface: nayak_summit_statistics(spectral_moments(surface))}
)


def contact_roughness(surface: HeightMap, *, method: str = "summits") -> Roughness:
    """Roughness of a height map as the statistical contact models take it.

    Parameters
    ----------
    surface : HeightMap
    method : {"summits", "moments"}
        Summits counted (`summit_statistics`), or inferred from the spectral moments (`nayak_summit_statistics`).

    Returns
    -------
    Roughness
        Its `rms_height` is the standard deviation of summit heights, not that of the surface.

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
        rms_height=found.summit_height_deviation, summit_radius=found.summit_radius, summit_density=found.summit_density
    )


def combined_roughness(first: Roughness, second: Roughness) -> Roughness:
    r"""Equivalent roughness of two rough surfaces in contact, as one rough surface against a smooth one.

    Parameters
    ----------
    first, second : Roughness

    Returns
    -------
    Roughness

    Notes
    -----
    The spectral moments of independent surfaces add. Each roughness is taken for the isotropic Gaussian surface with
    such summits, and the sums of the moments give the summits of the gap:

    .. math:: \frac{1}{R^2} = \frac{1}{R_1^2} + \frac{1}{R_2^2}, \qquad
        \frac{1}{\eta R^2} = \frac{1}{\eta_1 R_1^2} + \frac{1}{\eta_2 R_2^2}, \qquad
        \sigma^2 = \sigma_1^2 + \sigma_2^2
        + 0.8968\, \frac{(m_{2,1} m_{4,2} - m_{2,2} m_{4,1})^2}{m_{4,1} m_{4,2} (m_{4,1} + m_{4,2})} .

    References
    ----------
    .. [1] J. I. McCool, Wear 107, 37 (1986). doi:10.1016/0043-1648(86)90045-1
    """
    m2_1, m4_1 = _equivalent_moments(first)
    m2_2, m4_2 = _equivalent_moments(second)
    m2, m4 = m2_1 + m2_2, m4_1 + m4_2
    # m0 - 0.8968 m2^2/m4 of the sums, less that of each, in a form that is never negative
    excess = _VARIANCE_LOSS * (m2_1 * m4_2 - m2_2 * m4_1) ** 2 / (m4_1 * m4_2 * m4)
    return Roughness(
        rms_height=math.sqrt(first.rms_height**2 + second.rms_height**2 + excess),
        summit_radius=1 / (_CURVATURE * math.sqrt(m4)),
        summit_density=_DENSITY * m4 / m2,
    )


def _equivalent_moments(one: Roughness) -> tuple[float, float]:
    """Spectral moments m2 and m4 of the isotropic Gaussian surface that has such summits."""
    curvature_variance = (1 / (_CURVATURE * one.summit_radius)) ** 2
    return _DENSITY * curvature_variance / one.summit_density, curvature_variance


def sampling_dependence(
    surface: HeightMap, *, sampling_interval: ArrayLike, method: str = "summits"
) -> SamplingDependence:
    """Contact roughness of a height map resampled at coarser intervals.

    Parameters
    ----------
    surface : HeightMap
    sampling_interval : array_like, shape (n,)
        Requested distances of neighbouring points; along rows and columns the nearest whole number of pixels is taken.
        [m]
    method : {"summits", "moments"}
        As in `contact_roughness`.

    Returns
    -------
    SamplingDependence

    Raises
    ------
    InvalidInput
        If an interval is shorter than half a pixel, or so long that too few points or summits remain.

    Notes
    -----
    On a surface with detail at all scales the radius and density of summits have no limit as the interval decreases. A
    contact model requires them at the interval that suits its scale.
    """
    requested = np.atleast_1d(require_positive(sampling_interval=sampling_interval))
    coarser = [_decimated(surface, float(interval)) for interval in requested]
    found = [contact_roughness(one, method=method) for one in coarser]
    return SamplingDependence(
        sampling_interval=np.array([math.sqrt(one.spacing_x * one.spacing_y) for one in coarser]),
        **{field.name: np.array([getattr(one, field.name) for one in found]) for field in fields(Roughness)},
    )


def _mean_and_variance(height: Floats) -> tuple[float, float]:
    """Mean and variance of the measured heights."""
    count, total, _, _ = count_sum_and_extremes(height)
    mean = total / count
    return mean, central_moment_sums(height, mean)[1] / count


def _decimated(surface: HeightMap, interval: float) -> HeightMap:
    """Every n-th row and column of a map, at about the interval."""
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
