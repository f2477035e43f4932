"""Gaussian filters after ISO 16610: waviness from roughness, on maps and profiles, past edges and missing pixels.

In the words of ISO 25178-3 a low pass that takes off the shortest wavelengths is the S-filter, a high pass that takes
off the longest the L-filter, and what lies between both the S-L surface, on which roughness is evaluated.
"""

import math
import warnings

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, ModelRangeWarning, OutsideRange
from sonolube.surfaces.height_map import HeightMap
from sonolube.surfaces.local_regression import Widths, local_regression

# Width of the weight over the cutoff, such that half of the amplitude passes there.
_WIDTH_OVER_CUTOFF = {
    0: math.sqrt(math.log(2) / math.pi),  # alpha of ISO 16610-21: transmission exp(-u), u = pi (alpha lc/l)^2
    2: 0.7309134280946760,  # gamma of ISO 16610-31: transmission (1 + u) exp(-u), half where u = 1.67834699
}
_LEAST_PIXELS = 5  # to the cutoff (ISO 25178-3, table 1)
_BISQUARE_REACH = 4.4478  # medians of the distance, three standard deviations (ISO 16610-31)
_MOST_ROUNDS = 50
_SETTLED = 1e-3


def low_pass(height_map: HeightMap, *, cutoff_length: float, order: int = 0, robust: bool = False) -> HeightMap:
    """Keep the waviness: wavelengths longer than the cutoff (as S-filter: all but the noise).

    Parameters
    ----------
    height_map : HeightMap
        The surface; take its form off first (`level`). Missing pixels weigh nothing and stay missing.
    cutoff_length : float
        Wavelength of which half the amplitude passes; five pixels at the least. [m]
    order : int
        Of the regression: 0, the Gaussian filter of ISO 16610-61; 2, which follows slopes and curvature up to the
        edges.
    robust : bool
        Whether pixels far from the waviness lose their weight (ISO 16610-71), so that a groove does not pull it down.

    Returns
    -------
    HeightMap

    Raises
    ------
    OutsideRange
        If the cutoff is shorter than five pixels.
    InvalidInput
        If the cutoff is not positive or the order neither 0 nor 2.

    Notes
    -----
    A wave of length l along any direction passes with exp(-u) at order 0 and (1 + u) exp(-u) at order 2, where
    u = pi (c cutoff/l)**2 and c = 0.4697 or 0.7309 makes it one half at the cutoff. Within one cutoff of an edge
    order 0 bends towards the mean; it keeps constants exactly, order 2 every paraboloid. The robust filter weighs by
    Tukey's bisquare at three standard deviations until the scale rests; order 2 is the standard's choice for it.

    References
    ----------
    .. [1] ISO 16610-61:2015 and ISO 16610-71:2014, areal Gaussian and robust Gaussian regression filters.
    .. [2] S. Brinkmann et al., Int. J. Mach. Tools Manuf. 41, 2153 (2001). doi:10.1016/S0890-6955(01)00082-7
    .. [3] D 4.1.3, where the waviness of plates is told from their roughness.
    """
    widths = _widths(order, cutoff_length, spacing_x=height_map.spacing_x, spacing_y=height_map.spacing_y)
    return height_map.with_height(_smooth(height_map.height, widths, order=order, robust=robust))


def high_pass(height_map: HeightMap, *, cutoff_length: float, order: int = 0, robust: bool = False) -> HeightMap:
    """Keep the roughness: wavelengths shorter than the cutoff (the L-filter).

    Parameters
    ----------
    height_map : HeightMap
        The surface; missing pixels stay missing.
    cutoff_length : float
        Wavelength of which half the amplitude passes. [m]
    order : int
        Of the regression, 0 or 2.
    robust : bool
        Whether pixels far from the waviness lose their weight, so that a groove keeps its depth.

    Returns
    -------
    HeightMap
        The heights less their `low_pass`.

    Raises
    ------
    InvalidInput
        As `low_pass`.
    """
    waviness = low_pass(height_map, cutoff_length=cutoff_length, order=order, robust=robust)
    return height_map.with_height(height_map.height - waviness.height)


def band_pass(
    height_map: HeightMap,
    *,
    short_cutoff_length: float,
    long_cutoff_length: float,
    order: int = 0,
    robust: bool = False,
) -> HeightMap:
    """Keep what lies between two cutoffs: the S-L surface, without noise and without waviness.

    Parameters
    ----------
    height_map : HeightMap
        The surface; missing pixels stay missing.
    short_cutoff_length : float
        Nesting index of the S-filter: shorter waves are taken off. [m]
    long_cutoff_length : float
        Nesting index of the L-filter: longer waves are taken off. [m]
    order : int
        Of the regression, 0 or 2.
    robust : bool
        Whether the L-filter lets pixels far from the waviness lose their weight.

    Returns
    -------
    HeightMap

    Raises
    ------
    InvalidInput
        As `low_pass`, or if the cutoffs are not in order.
    """
    require_positive(short_cutoff_length=short_cutoff_length, long_cutoff_length=long_cutoff_length)
    if short_cutoff_length >= long_cutoff_length:
        raise InvalidInput(
            f"short_cutoff_length {short_cutoff_length:g} m must be less than long_cutoff_length"
            f" {long_cutoff_length:g} m"
        )
    without_noise = low_pass(height_map, cutoff_length=short_cutoff_length, order=order)
    return high_pass(without_noise, cutoff_length=long_cutoff_length, order=order, robust=robust)


def profile_low_pass(
    *, height: ArrayLike, spacing_x: float, cutoff_length: float, order: int = 0, robust: bool = False
) -> Floats:
    """Keep the waviness of profiles.

    Parameters
    ----------
    height : array_like, shape (..., points)
        Profiles, each filtered for itself along its last axis; NaN where it was not measured. [m]
    spacing_x : float
        Distance of neighbouring points. [m]
    cutoff_length : float
        Wavelength of which half the amplitude passes; five points at the least. [m]
    order : int
        Of the regression: 0, the Gaussian filter of ISO 16610-21; 2, which follows slopes up to the ends.
    robust : bool
        Whether points far from the waviness lose their weight (ISO 16610-31); all profiles share one scale.

    Returns
    -------
    ndarray, shape of `height`
        Subtract it for the roughness.

    Raises
    ------
    OutsideRange
        If the cutoff is shorter than five points.
    InvalidInput
        If a spacing or the cutoff is not positive, the order is neither 0 nor 2, or nothing was measured.

    References
    ----------
    .. [1] ISO 16610-21:2011 and ISO 16610-31:2016, Gaussian and robust Gaussian regression profile filters.
    """
    z = np.asarray(height, dtype=np.float64)
    if z.ndim == 0 or not np.isfinite(z).any() or np.isinf(z).any():
        raise InvalidInput(
            "height must be an array of profiles, finite or NaN where not measured, and somewhere measured"
        )
    widths = _widths(order, cutoff_length, spacing_x=spacing_x, spacing_y=None)
    return _smooth(z.reshape(-1, z.shape[-1]), widths, order=order, robust=robust).reshape(z.shape)


def _widths(order: int, cutoff_length: float, *, spacing_x: float, spacing_y: float | None) -> Widths:
    if order not in _WIDTH_OVER_CUTOFF:
        raise InvalidInput(f"order must be 0 or 2, got {order!r}")
    coarsest = float(require_positive(spacing_x=spacing_x))
    if spacing_y is not None:
        coarsest = max(coarsest, spacing_y)
    require_positive(cutoff_length=cutoff_length)
    if cutoff_length < _LEAST_PIXELS * coarsest * (1 - 1e-9):
        raise OutsideRange(
            f"cutoff_length {cutoff_length:g} m is shorter than {_LEAST_PIXELS} pixels of {coarsest:g} m:"
            " they cannot show the wave that it halves"
        )
    width = _WIDTH_OVER_CUTOFF[order] * cutoff_length
    return (None if spacing_y is None else width / spacing_y, width / spacing_x)


def _smooth(height: Floats, widths: Widths, *, order: int, robust: bool) -> Floats:
    measured = np.isfinite(height)
    middle = float(np.mean(height[measured]))  # taken off and added again: constants pass to the last digit
    z = np.where(measured, height - middle, 0.0)
    weights = measured.astype(np.float64)
    smooth = local_regression(z, weights, widths=widths, order=order)
    if robust:
        smooth = _robust(z, measured, smooth, widths, order)
    return np.where(measured, smooth + middle, np.nan)


def _robust(
    z: Floats, measured: np.ndarray[tuple[int, ...], np.dtype[np.bool_]], smooth: Floats, widths: Widths, order: int
) -> Floats:
    scale = math.inf
    for _ in range(_MOST_ROUNDS):
        distance = np.abs(z - smooth)
        before, scale = scale, _BISQUARE_REACH * float(np.median(distance[measured]))
        if scale == 0 or abs(before - scale) <= _SETTLED * scale:
            return smooth
        weights = measured * np.maximum(0.0, 1 - (distance / scale) ** 2) ** 2
        again = local_regression(z, weights, widths=widths, order=order)
        smooth = np.where(np.isfinite(again), again, smooth)  # amid outliers only: as it was
    warnings.warn(
        ModelRangeWarning(f"the robust filter has not settled in {_MOST_ROUNDS} rounds; its scale still moves"),
        stacklevel=4,
    )
    return smooth
