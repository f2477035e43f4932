"""Height, hybrid and spatial parameters of a height map after ISO 25178-2."""

import math
from dataclasses import dataclass

import numpy as np

from sonolube.errors import InvalidInput
from sonolube.surfaces.correlation import autocorrelation, correlation_lengths
from sonolube.surfaces.grid_kernel import central_moment_sums, count_sum_and_extremes, gradient_and_area_sums
from sonolube.surfaces.height_map import HeightMap
from sonolube.surfaces.spectrum import areal_spectrum

_THRESHOLD = 0.2  # share of the autocorrelation at which ISO 25178-2 takes it for decayed
_RAYS = 720  # over half a turn
_SECTORS = 180  # of the angular spectrum, over half a turn
_NEARBY = math.radians(10)  # within which the strongest sector is refined


@dataclass(frozen=True, kw_only=True, slots=True)
class HeightParameters:
    """How heights scatter about their mean.

    Parameters
    ----------
    arithmetic_mean_height : float
        Arithmetic mean deviation, Sa. [m]
    rms_height : float
        Standard deviation, Sq. [m]
    maximum_peak_height : float
        Highest point above the mean, Sp. [m]
    maximum_pit_depth : float
        Deepest point below the mean, Sv. [m]
    total_height : float
        Highest to deepest point, Sz. [m]
    skewness : float
        Third moment over the cube of the standard deviation, Ssk. []
    kurtosis : float
        Fourth moment over the fourth power of the standard deviation, Sku; 3 for Gaussian heights. []
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
    """How steep the surface is.

    Parameters
    ----------
    rms_gradient : float
        Root mean square of the gradient, Sdq. []
    developed_interfacial_area_ratio : float
        Excess of the surface's area over that of its plane, as a share of the latter, Sdr. []
    """

    rms_gradient: float
    developed_interfacial_area_ratio: float


@dataclass(frozen=True, kw_only=True, slots=True)
class SpatialParameters:
    """How far and which way the surface resembles itself.

    Parameters
    ----------
    autocorrelation_length : float
        Shortest distance in which the autocorrelation falls to 0.2, Sal. [m]
    texture_aspect_ratio : float
        That distance over the longest one in any direction, Str: 1 for an isotropic surface. []
    texture_direction : float
        Direction of the lay, Std, from 0 to pi; 0 along the rows, growing from columns towards rows. [rad]
    decays_in_all_directions : bool
        Whether the autocorrelation falls to 0.2 in every direction within half the map. Where it does not, the
        texture aspect ratio is an upper bound.
    """

    autocorrelation_length: float
    texture_aspect_ratio: float
    texture_direction: float
    decays_in_all_directions: bool


def height_parameters(surface: HeightMap) -> HeightParameters:
    """Return Sa, Sq, Sp, Sv, Sz, Ssk and Sku.

    Parameters
    ----------
    surface : HeightMap
        Levelled and filtered as wanted; only the mean is removed here. Missing pixels count for nothing.

    Returns
    -------
    HeightParameters

    Raises
    ------
    InvalidInput
        If the map has fewer than two rows or columns, or is flat, so that skewness and kurtosis have no meaning.

    References
    ----------
    .. [1] ISO 25178-2:2021, Geometrical product specifications, surface texture: areal, part 2.
    """
    _require_area(surface)
    z = np.ascontiguousarray(surface.height)
    count, total, lowest, highest = count_sum_and_extremes(z)
    if lowest == highest:
        raise InvalidInput(
            f"height must vary, got {lowest!r} m in every measured pixel: skewness and kurtosis have no meaning"
        )
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
    """Return Sdq and Sdr.

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
    Every cell of four measured neighbours is cut into two triangles along either diagonal; slope and area are the mean
    over both cuts, so that for small slopes Sdr is half the square of Sdq. Both grow as the spacing falls: give them
    with the spacing and the filter.

    References
    ----------
    .. [1] ISO 25178-2:2021, Geometrical product specifications, surface texture: areal, part 2.
    """
    _require_area(surface)
    z = np.ascontiguousarray(surface.height)
    cells, squares, excess = gradient_and_area_sums(z, surface.spacing_x, surface.spacing_y)
    if cells == 0:
        raise InvalidInput(
            f"a slope needs four neighbouring measured pixels; with {surface.missing_fraction:.0%} missing there "
            "are none"
        )
    return HybridParameters(rms_gradient=math.sqrt(squares / cells), developed_interfacial_area_ratio=excess / cells)


def spatial_parameters(surface: HeightMap) -> SpatialParameters:
    """Return Sal, Str and Std.

    Parameters
    ----------
    surface : HeightMap

    Returns
    -------
    SpatialParameters

    Raises
    ------
    InvalidInput
        If the map is flat, or so small beside its texture that the autocorrelation does not fall to 0.2 in any
        direction.

    Notes
    -----
    Sal and Str come from the autocorrelation along rays from its centre; Std is square to the direction in which the
    angular spectrum has its maximum, which is how ISO's integral counts it. On an isotropic surface Std is the whim of
    the sample.

    References
    ----------
    .. [1] ISO 25178-2:2021, Geometrical product specifications, surface texture: areal, part 2.
    """
    _require_area(surface)
    correlation = autocorrelation(surface)
    directions = np.arange(_RAYS) * math.pi / _RAYS
    lengths = correlation_lengths(correlation, directions=directions, threshold=_THRESHOLD)
    decayed = lengths.decayed
    if not decayed.any():
        raise InvalidInput(
            f"the map is too small for its texture: its autocorrelation stays above {_THRESHOLD} out to half its size"
        )
    shortest = float(lengths.distance[decayed].min())
    return SpatialParameters(
        autocorrelation_length=shortest,
        texture_aspect_ratio=shortest / max(shortest, float(lengths.distance.max())),
        texture_direction=_direction_of_lay(surface),
        decays_in_all_directions=bool(decayed.all()),
    )


def _direction_of_lay(surface: HeightMap) -> float:
    spectrum = areal_spectrum(surface)
    power = spectrum.areal_spectral_density.copy()
    power[spectrum.wavenumber_y == 0, 0] = 0.0
    angle = np.arctan2(spectrum.wavenumber_y[:, None], spectrum.wavenumber_x[None, :]) % math.pi
    sector = np.minimum((angle * (_SECTORS / math.pi)).astype(np.int64), _SECTORS - 1)
    angular = np.bincount(sector.ravel(), weights=power.ravel(), minlength=_SECTORS)
    strongest = (int(angular.argmax()) + 0.5) * math.pi / _SECTORS
    apart = (angle - strongest + math.pi / 2) % math.pi - math.pi / 2
    near = np.abs(apart) <= _NEARBY
    across = strongest + float(np.sum((apart * power)[near]) / np.sum(power[near]))
    return (across + math.pi / 2) % math.pi


def _require_area(surface: HeightMap) -> None:
    """Refuse a map that is only a line or a point.

    Raises
    ------
    InvalidInput
        If it has fewer than two rows or columns.
    """
    rows, columns = surface.height.shape
    if min(rows, columns) < 2:
        raise InvalidInput(f"an areal parameter needs at least 2 rows and 2 columns of height, got {rows} x {columns}")
