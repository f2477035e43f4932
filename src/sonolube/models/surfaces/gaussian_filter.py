"""Gaussian regression filters of ISO 16610 for height maps and profiles with edges and missing pixels.

In terms of ISO 25178-3, a low pass that removes the shortest wavelengths is the S-filter, a high pass that removes the
longest is the L-filter, their cutoffs are the nesting indices, and the band between both is the S-L surface, on which
roughness is evaluated.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_positive
from sonolube.errors import InvalidInput, OutsideRange, warn_of_range
from sonolube.models.surfaces.height_map import HeightMap, Mask
from sonolube.models.surfaces.local_regression import Widths, local_regression

# Width of the weight over the cutoff, such that half of the amplitude is transmitted at the cutoff.
_WIDTH_OVER_CUTOFF = {
    0: math.sqrt(math.log(2) / math.pi),  # alpha of ISO 16610-21: transmission exp(-u), u = pi (alpha lc/l)^2
    2: 0.7309134280946760,  # gamma of ISO 16610-31: transmission (1 + u) exp(-u), half where u = 1.67834699
}
_MIN_PIXELS = 5  # per cutoff (ISO 25178-3, table 1)
_BISQUARE_REACH = 4.4478  # medians of the absolute residuals, three standard deviations (ISO 16610-31)
_MAX_ITERATIONS = 50
_CONVERGED = 1e-3  # relative change of the scale


def low_pass(surface: HeightMap, *, cutoff_length: float, order: int = 0, robust: bool = False) -> HeightMap:
    r"""Low-pass (waviness or S-filtered) surface by an areal Gaussian regression filter of ISO 16610.

    Parameters
    ----------
    surface : HeightMap
        Surface with its form removed (`remove_form`). Missing pixels have weight zero and stay missing.
    cutoff_length : float
        Nesting index: wavelength at which half the amplitude is transmitted, five pixels or more. [m]
    order : int
        Order of the regression: 0, the Gaussian filter of ISO 16610-61, or 2, which reproduces slopes and curvature up
        to the edges.
    robust : bool
        Whether pixels far from the waviness lose weight (ISO 16610-71), so that a groove does not distort it.

    Returns
    -------
    HeightMap

    Raises
    ------
    OutsideRange
        If the cutoff is shorter than five pixels.
    InvalidInput
        If the cutoff is not positive or the order neither 0 nor 2.

    See Also
    --------
    high_pass, profile_low_pass : L-filter, and the filter for profiles.

    Notes
    -----
    Away from edges the transmission at the wavelength :math:`\lambda` in any direction is

    .. math:: e^{-u} \ \text{(order 0)}, \qquad (1 + u)\, e^{-u} \ \text{(order 2)}, \qquad
        u = \pi \left(\frac{c \lambda_c}{\lambda}\right)^2 ,

    with :math:`c = 0.4697` or :math:`0.7309`, which make it one half at the cutoff :math:`\lambda_c`. Order 0
    reproduces constants exactly and deviates towards the mean within one cutoff of an edge; order 2 reproduces every
    paraboloid.
    The robust filter weighs residuals by Tukey's bisquare at three standard deviations, iterated until the scale
    converges; the standard uses it with order 2.

    References
    ----------
    .. [1] ISO 16610-61:2015 and ISO 16610-71:2014, areal Gaussian and robust Gaussian regression filters.
    .. [2] S. Brinkmann et al., Int. J. Mach. Tools Manuf. 41, 2153 (2001). doi:10.1016/S0890-6955(01)00082-7
    .. [3] D 4.1.3, where waviness and roughness of plates are separated.

    Examples
    --------
    >>> import numpy as np
    >>> from sonolube.models.surfaces import HeightMap, low_pass
    >>> wave = np.tile(1e-6 * np.cos(2 * np.pi * np.arange(400) / 100), (200, 1))
    >>> smooth = low_pass(HeightMap(height=wave, spacing_x=1e-6, spacing_y=1e-6), cutoff_length=100e-6)
    >>> round(1e6 * float(smooth.height[100, 200]), 2)  # half the amplitude at the cutoff
    0.5
    """
    widths = _widths(order, cutoff_length, spacing_x=surface.spacing_x, spacing_y=surface.spacing_y)
    return surface.with_height(_smooth(surface.height, widths, order=order, robust=robust))


def high_pass(surface: HeightMap, *, cutoff_length: float, order: int = 0, robust: bool = False) -> HeightMap:
    """High-pass (roughness) surface: the surface less its low pass (L-filter).

    Parameters
    ----------
    surface : HeightMap
        Missing pixels stay missing.
    cutoff_length : float
        Nesting index: wavelength at which half the amplitude is transmitted. [m]
    order : int
        Order of the regression, 0 or 2.
    robust : bool
        Whether pixels far from the waviness lose weight, so that a groove keeps its depth.

    Returns
    -------
    HeightMap
        Heights less their `low_pass`.

    Raises
    ------
    InvalidInput
        As `low_pass`.

    Examples
    --------
    >>> import numpy as np
    >>> from sonolube.models.surfaces import HeightMap, high_pass
    >>> wave = np.tile(1e-6 * np.cos(2 * np.pi * np.arange(400) / 100), (200, 1))
    >>> rough = high_pass(HeightMap(height=wave, spacing_x=1e-6, spacing_y=1e-6), cutoff_length=50e-6)
    >>> round(1e6 * float(rough.height[100, 200]), 2)  # 1 - 2^(-1/4) at twice the cutoff
    0.16
    """
    waviness = low_pass(surface, cutoff_length=cutoff_length, order=order, robust=robust)
    return surface.with_height(surface.height - waviness.height)


def profile_low_pass(
    *, height: ArrayLike, spacing_x: float, cutoff_length: float, order: int = 0, robust: bool = False
) -> Floats:
    """Low-pass (waviness) profiles by a profile Gaussian regression filter of ISO 16610.

    Parameters
    ----------
    height : array_like, shape (..., points)
        Profiles, each filtered along the last axis; NaN where not measured. [m]
    spacing_x : float
        Distance of neighbouring points. [m]
    cutoff_length : float
        Nesting index: wavelength at which half the amplitude is transmitted, five points or more. [m]
    order : int
        Order of the regression: 0, the Gaussian filter of ISO 16610-21, or 2, which reproduces slopes up to the ends.
    robust : bool
        Whether points far from the waviness lose weight (ISO 16610-31); all profiles share one scale.

    Returns
    -------
    ndarray, shape of `height`
        The waviness; subtract it from the profiles for the roughness.

    Raises
    ------
    OutsideRange
        If the cutoff is shorter than five points.
    InvalidInput
        If the spacing or the cutoff is not positive, the order is neither 0 nor 2, or nothing was measured.

    References
    ----------
    .. [1] ISO 16610-21:2011 and ISO 16610-31:2016, Gaussian and robust Gaussian regression profile filters.
    """
    z = np.asarray(height, dtype=np.float64)
    if z.ndim == 0 or not np.isfinite(z).any() or np.isinf(z).any():
        raise InvalidInput("height must be an array of profiles with a measured point, finite or NaN if unmeasured")
    widths = _widths(order, cutoff_length, spacing_x=spacing_x, spacing_y=None)
    return _smooth(z.reshape(-1, z.shape[-1]), widths, order=order, robust=robust).reshape(z.shape)


def _widths(order: int, cutoff_length: float, *, spacing_x: float, spacing_y: float | None) -> Widths:
    """Widths of the Gaussian weight in pixels, for checked order, spacings and cutoff."""
    if order not in _WIDTH_OVER_CUTOFF:
        raise InvalidInput(f"order must be 0 or 2, got {order!r}")
    coarsest = float(require_positive(spacing_x=spacing_x))
    if spacing_y is not None:
        coarsest = max(coarsest, spacing_y)
    require_positive(cutoff_length=cutoff_length)
    if cutoff_length < _MIN_PIXELS * coarsest * (1 - 1e-9):
        raise OutsideRange(
            f"cutoff_length must be at least {_MIN_PIXELS} pixels of {coarsest:g} m, which resolve a wave of that"
            f" length; got {cutoff_length:g} m"
        )
    width = _WIDTH_OVER_CUTOFF[order] * cutoff_length
    return (None if spacing_y is None else width / spacing_y, width / spacing_x)


def _smooth(height: Floats, widths: Widths, *, order: int, robust: bool) -> Floats:
    """Filtered heights, NaN where missing."""
    measured = np.isfinite(height)
    mean = float(np.mean(height[measured]))  # subtracted and added again, so that constants are reproduced exactly
    z = np.where(measured, height - mean, 0.0)
    weights = measured.astype(np.float64)
    smooth = local_regression(z, weights, widths=widths, order=order)
    if robust:
        smooth = _robust_smooth(z, measured, smooth, widths, order)
    return np.where(measured, smooth + mean, np.nan)


def _robust_smooth(z: Floats, measured: Mask, smooth: Floats, widths: Widths, order: int) -> Floats:
    """Robust regression by iteratively reweighted least squares with Tukey's bisquare, from a first smooth."""
    scale = math.inf
    for _ in range(_MAX_ITERATIONS):
        residual = np.abs(z - smooth)
        previous, scale = scale, _BISQUARE_REACH * float(np.median(residual[measured]))
        if scale == 0 or abs(previous - scale) <= _CONVERGED * scale:
            return smooth
        weights = measured * np.maximum(0.0, 1 - (residual / scale) ** 2) ** 2
        refined = local_regression(z, weights, widths=widths, order=order)
        smooth = np.where(np.isfinite(refined), refined, smooth)  # unchanged where only outliers are within reach
    warn_of_range(f"the robust filter has not converged in {_MAX_ITERATIONS} iterations", stacklevel=4)
    return smooth
