"""Areal surface texture parameters after ISO 25178-2: height, hybrid, spatial and feature parameters of a map."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats, require_within
from sonolube.errors import InvalidInput
from sonolube.execution.compilation import kernel
from sonolube.models.surfaces.correlation import autocorrelation, correlation_lengths
from sonolube.models.surfaces.grid_kernel import central_moment_sums, count_sum_and_extremes, gradient_and_area_sums
from sonolube.models.surfaces.height_map import HeightMap
from sonolube.models.surfaces.spectrum import areal_spectrum

_THRESHOLD = 0.2  # of the normalised autocorrelation, in ISO 25178-2
_DIRECTIONS = 720  # over half a turn
_SECTORS = 180  # of the angular spectrum, over half a turn
_NEIGHBOURHOOD = math.radians(10)  # about the strongest sector, over which its centroid is taken


@dataclass(frozen=True, kw_only=True, slots=True)
class HeightParameters:
    """Height parameters of ISO 25178-2: moments and extremes of the heights about their mean.

    Parameters
    ----------
    arithmetic_mean_height : float
        Mean absolute deviation from the mean height, Sa. [m]
    rms_height : float
        Root mean square deviation from the mean height, Sq. [m]
    maximum_peak_height : float
        Highest point above the mean height, Sp. [m]
    maximum_pit_depth : float
        Lowest point below the mean height, Sv, as a positive depth. [m]
    total_height : float
        Maximum height Sz = Sp + Sv. [m]
    skewness : float
        Third moment over the cube of the root mean square, Ssk. []
    kurtosis : float
        Fourth moment over the fourth power of the root mean square, Sku; 3 for Gaussian heights. []
    """

    arithmetic_mean_height: float
    rms_height: float
    maximum_peak_height: float
    maximum_pit_depth: float
    total_height: float
    skewness: float
    kurtosis: float


@dataclass(frozen=True, kw_only=True, slots=True)
class HybridParameters:
    """Hybrid parameters of ISO 25178-2: gradient and developed area.

    Parameters
    ----------
    rms_gradient : float
        Root mean square of the magnitude of the gradient, Sdq. []
    developed_interfacial_area_ratio : float
        Area of the surface over that of its projection, less 1, Sdr. []
    """

    rms_gradient: float
    developed_interfacial_area_ratio: float


@dataclass(frozen=True, kw_only=True, slots=True)
class SpatialParameters:
    """Spatial parameters of ISO 25178-2: decay of the autocorrelation and direction of the lay.

    Parameters
    ----------
    autocorrelation_length : float
        Shortest distance over which the autocorrelation decays to 0.2, Sal. [m]
    texture_aspect_ratio : float
        Shortest over longest distance of that decay, Str: 1 for an isotropic surface. []
    texture_direction : float
        Direction of the lay, Std, from 0 to pi; 0 along the rows, growing from columns towards rows. [rad]
    decays_in_all_directions : bool
        Whether the autocorrelation decays to 0.2 in every direction within half the map. Where it does not, the
        texture aspect ratio is an upper bound.
    """

    autocorrelation_length: float
    texture_aspect_ratio: float
    texture_direction: float
    decays_in_all_directions: bool


def height_parameters(surface: HeightMap) -> HeightParameters:
    r"""Height parameters Sa, Sq, Sp, Sv, Sz, Ssk and Sku of ISO 25178-2.

    Parameters
    ----------
    surface : HeightMap
        Scale-limited surface: form removed and filtered beforehand; only the mean is removed here. Missing pixels are
        left out.

    Returns
    -------
    HeightParameters

    Raises
    ------
    InvalidInput
        If the map has fewer than two rows or columns, or is flat, so that skewness and kurtosis are not defined.

    See Also
    --------
    hybrid_parameters, spatial_parameters : Other field parameters.
    sonolube.models.surfaces.roughness_profile.profile_parameters : Parameters of a profile.

    Notes
    -----
    With the heights :math:`z` of the :math:`n` measured pixels, counted from their mean,

    .. math:: S_a = \frac1n \sum |z|, \quad S_q^2 = \frac1n \sum z^2, \quad
        S_{sk} = \frac{1}{n S_q^3} \sum z^3, \quad S_{ku} = \frac{1}{n S_q^4} \sum z^4 .

    References
    ----------
    .. [1] ISO 25178-2:2021, Geometrical product specifications, surface texture: areal, part 2.

    Examples
    --------
    >>> import numpy as np
    >>> from sonolube.models.surfaces import HeightMap, height_parameters
    >>> wave = np.tile(1e-6 * np.sin(2 * np.pi * np.arange(64) / 64), (64, 1))
    >>> found = height_parameters(HeightMap(height=wave, spacing_x=1e-6, spacing_y=1e-6))
    >>> round(1e6 * found.rms_height, 4), round(found.kurtosis, 3)  # of a sine 1/sqrt(2) and 1.5
    (0.7071, 1.5)
    """
    _require_area(surface)
    z = np.ascontiguousarray(surface.height)
    count, total, lowest, highest = count_sum_and_extremes(z)
    if lowest == highest:
        raise InvalidInput(f"height must vary, got {lowest!r} m in every measured pixel: no skewness, no kurtosis")
    mean = total / count
    first, second, third, fourth = (part / count for part in central_moment_sums(z, mean))
    return HeightParameters(
        arithmetic_mean_height=first,
        rms_height=math.sqrt(second),
        maximum_peak_height=highest - mean,
        maximum_pit_depth=mean - lowest,
        total_height=highest - lowest,
        skewness=third / second**1.5,
        kurtosis=fourth / second**2,
    )


def hybrid_parameters(surface: HeightMap) -> HybridParameters:
    r"""Hybrid parameters Sdq and Sdr of ISO 25178-2.

    Parameters
    ----------
    surface : HeightMap

    Returns
    -------
    HybridParameters

    Raises
    ------
    InvalidInput
        If no four neighbouring pixels were all measured.

    Notes
    -----
    Every cell of four measured pixels is divided into two triangles along either diagonal. With the slopes :math:`p`,
    :math:`q` of a triangle and the mean over all triangles of both divisions

    .. math:: S_{dq}^2 = \overline{p^2 + q^2}, \qquad S_{dr} = \overline{\sqrt{1 + p^2 + q^2}} - 1 ,

    so that :math:`S_{dr} = S_{dq}^2/2` for small slopes. Both increase as the spacing decreases: report them with the
    spacing and the filter.

    References
    ----------
    .. [1] ISO 25178-2:2021, Geometrical product specifications, surface texture: areal, part 2.
    """
    _require_area(surface)
    z = np.ascontiguousarray(surface.height)
    cells, squares, excess = gradient_and_area_sums(z, surface.spacing_x, surface.spacing_y)
    if cells == 0:
        raise InvalidInput(
            f"a gradient requires four neighbouring measured pixels; with {surface.missing_fraction:.0%} of the pixels "
            "missing there are none"
        )
    return HybridParameters(rms_gradient=math.sqrt(squares / cells), developed_interfacial_area_ratio=excess / cells)


def spatial_parameters(surface: HeightMap) -> SpatialParameters:
    r"""Spatial parameters Sal, Str and Std of ISO 25178-2.

    Parameters
    ----------
    surface : HeightMap

    Returns
    -------
    SpatialParameters

    Raises
    ------
    InvalidInput
        If the map is flat, or so small that the autocorrelation does not decay to 0.2 in any direction.

    Notes
    -----
    With the normalised autocorrelation :math:`f(\tau, \theta)` at distance :math:`\tau` in direction :math:`\theta`

    .. math:: S_{al} = \min_\theta \tau_{0.2}(\theta), \qquad
        S_{tr} = \frac{\min_\theta \tau_{0.2}(\theta)}{\max_\theta \tau_{0.2}(\theta)}, \qquad
        f(\tau_{0.2}, \theta) = 0.2 ,

    along 720 directions. Std is perpendicular to the direction of the maximum of the angular spectrum. On an isotropic
    surface Std is random.

    References
    ----------
    .. [1] ISO 25178-2:2021, Geometrical product specifications, surface texture: areal, part 2.
    """
    _require_area(surface)
    correlation = autocorrelation(surface)
    directions = np.arange(_DIRECTIONS) * math.pi / _DIRECTIONS
    lengths = correlation_lengths(correlation, directions=directions, threshold=_THRESHOLD)
    decayed = lengths.decayed
    if not decayed.any():
        raise InvalidInput(
            f"the map is too small for its texture: its autocorrelation stays above {_THRESHOLD} up to half the size of"
            " the map; measure a larger area"
        )
    shortest = float(lengths.distance[decayed].min())
    return SpatialParameters(
        autocorrelation_length=shortest,
        texture_aspect_ratio=shortest / max(shortest, float(lengths.distance.max())),
        texture_direction=_direction_of_lay(surface),
        decays_in_all_directions=bool(decayed.all()),
    )


def _direction_of_lay(surface: HeightMap) -> float:
    """Direction perpendicular to the maximum of the angular spectrum, from 0 to pi. [rad]"""
    spectrum = areal_spectrum(surface)
    power = spectrum.areal_spectral_density.copy()
    power[spectrum.wavenumber_y == 0, 0] = 0.0
    angle = np.arctan2(spectrum.wavenumber_y[:, None], spectrum.wavenumber_x[None, :]) % math.pi
    sector = np.minimum((angle * (_SECTORS / math.pi)).astype(np.int64), _SECTORS - 1)
    angular = np.bincount(sector.ravel(), weights=power.ravel(), minlength=_SECTORS)
    strongest = (int(angular.argmax()) + 0.5) * math.pi / _SECTORS
    apart = (angle - strongest + math.pi / 2) % math.pi - math.pi / 2
    near = np.abs(apart) <= _NEIGHBOURHOOD
    across = strongest + float(np.sum((apart * power)[near]) / np.sum(power[near]))
    return (across + math.pi / 2) % math.pi


def _require_area(surface: HeightMap) -> None:
    """Refuse a map with fewer than two rows or columns."""
    rows, columns = surface.height.shape
    if min(rows, columns) < 2:
        raise InvalidInput(f"an areal parameter requires at least 2 rows and 2 columns, got {rows} x {columns}")


@dataclass(frozen=True, kw_only=True, slots=True)
class FeatureParameters:
    """Density and curvature of the significant peaks of a surface.

    Parameters
    ----------
    peak_density : float
        Density of peaks Spd: significant hills per area; not the summit density of a contact model. [1/m2]
    mean_peak_curvature : float
        Arithmetic mean peak curvature Spc: mean of both principal curvatures, averaged over the peaks. [1/m]
    """

    peak_density: float
    mean_peak_curvature: float


def feature_parameters(surface: HeightMap, *, pruning: float = 0.05) -> FeatureParameters:
    """Density of peaks Spd and arithmetic mean peak curvature Spc of ISO 25178-2, with Wolf pruning.

    Parameters
    ----------
    surface : HeightMap
        Scale-limited surface. Hills do not extend across missing pixels.
    pruning : float
        Wolf pruning threshold: least height of a significant hill above its highest saddle over the total height Sz,
        from 0 to 1.

    Returns
    -------
    FeatureParameters

    Raises
    ------
    InvalidInput
        If the map is flat, or no peak has four measured neighbours.

    Notes
    -----
    The map is segmented into hills by the watershed of the inverted surface. A hill whose peak is less than 5 % of Sz
    above the saddle to a higher hill is merged with it, the lowest first. The remaining hills are about a wavelength of
    the waviness apart: Spd can be fifty times below the density of summits, which counts every pixel above its eight
    neighbours, and it decreases when a single scratch raises Sz. A contact model requires
    `sonolube.models.surfaces.asperities.summit_statistics`, not Spd.

    References
    ----------
    .. [1] ISO 25178-2:2021, Geometrical product specifications, surface texture: areal, part 2.
    .. [2] G. W. Wolf, in: Advances in Geographic Information Systems (1991); P. J. Scott, Int. J. Mach. Tools Manuf.
       38, 559 (1998).
    """
    require_within(0.0, 1.0, pruning=pruning)
    z = np.ascontiguousarray(surface.height)
    count, _, lowest, highest = count_sum_and_extremes(z)
    if lowest == highest:
        raise InvalidInput(f"height must vary, got {lowest!r} m in every measured pixel: a flat map has no hills")
    peaks = _significant_peaks(z, np.argsort(-z, axis=None)[:count], pruning * (highest - lowest))
    row, column = np.divmod(peaks, z.shape[1])
    inside = (row > 0) & (row < z.shape[0] - 1) & (column > 0) & (column < z.shape[1] - 1)
    row, column = row[inside], column[inside]
    curvature_x = (2 * z[row, column] - z[row, column - 1] - z[row, column + 1]) / surface.spacing_x**2
    curvature_y = (2 * z[row, column] - z[row - 1, column] - z[row + 1, column]) / surface.spacing_y**2
    curvature = (curvature_x + curvature_y)[np.isfinite(curvature_x + curvature_y)] / 2
    if curvature.size == 0:
        raise InvalidInput(f"none of the {peaks.size} peaks has four measured neighbours, as their curvature requires")
    return FeatureParameters(
        peak_density=peaks.size / (count * surface.spacing_x * surface.spacing_y),
        mean_peak_curvature=float(curvature.mean()),
    )


def _significant_peaks(height: Floats, descending: NDArray[np.int64], least: float) -> NDArray[np.int64]:
    """Flat indices of the peaks at least `least` above the saddle to a higher peak.

    A hill that missing pixels separate from all higher ones is measured from its lowest pixel.
    """
    z = height.ravel()
    hill = np.full(z.size, -1, dtype=np.int32)
    foot = np.empty(z.size)
    significant = np.zeros(z.size, dtype=np.bool_)
    _watershed(height, descending, least, hill, foot, significant)
    unmerged = np.flatnonzero(hill == np.arange(z.size))
    significant[unmerged] = z[unmerged] - foot[unmerged] >= least
    return np.flatnonzero(significant)


@kernel(cache=True, nogil=True, error_model="numpy")
def _watershed(
    height: Floats,
    descending: NDArray[np.int64],
    least: float,
    hill: NDArray[np.int32],
    foot: Floats,
    significant: NDArray[np.bool_],
) -> None:
    """Segment the map into hills by union-find over the pixels in descending order of height.

    Writes the parent of each pixel in the tree of its hill, the lowest pixel of each peak's hill, and which peaks are
    significant. A pixel without a higher neighbour is a peak; one that joins two hills is their saddle, where the lower
    hill is merged into the higher one.
    """
    rows, columns = height.shape
    z = height.ravel()
    for order in range(descending.size):
        pixel = descending[order]
        row, column = pixel // columns, pixel % columns
        peak: int = -1
        for r in range(max(row - 1, 0), min(row + 2, rows)):
            for c in range(max(column - 1, 0), min(column + 2, columns)):
                if hill[r * columns + c] < 0:
                    continue
                other = _peak_of(hill, r * columns + c)
                if peak < 0:
                    peak = other
                elif other != peak:
                    higher, lower = (peak, other) if z[peak] >= z[other] else (other, peak)
                    significant[lower] = z[lower] - z[pixel] >= least
                    hill[lower] = higher
                    peak = higher
        if peak < 0:
            peak = pixel
        hill[pixel] = peak
        foot[peak] = z[pixel]


@kernel(cache=True, error_model="numpy")
def _peak_of(hill: NDArray[np.int32], pixel: int) -> int:
    """Peak of a pixel's hill: the root of its tree, with path halving."""
    while hill[pixel] != pixel:
        hill[pixel] = hill[hill[pixel]]
        pixel = hill[pixel]
    return pixel
