"""Gaussian regression filters of ISO 16610 for height maps and profiles with edges and missing pixels.

In terms of ISO 25178-3, a low pass that removes the shortest wavelengths is the S-filter, a high pass that removes the
longest is the L-filter, their cutoffs are the nesting indices, and the band between both is the S-L surface, on which
roughness is evaluated.

The local polynomial regression with a Gaussian weight is computed by Fourier transform: the moments of the
neighbourhood of every pixel are correlations. Missing pixels and those outside the map have weight zero, so that edges
and holes require no extrapolation. A term that a neighbourhood does not determine is dropped there.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from sonolube.checks import Complexes, Floats, require_positive
from sonolube.errors import InvalidInput, OutsideRange, warn_of_range
from sonolube.execution.compilation import kernel
from sonolube.models.surfaces.height_map import HeightMap, Mask

REACH = 3.2  # in widths of the weight, which is 1e-14 there
_STRIP = 1 << 21  # pixels per strip, which bounds the memory
_MIN_PIVOT = 1e-6  # over the sum of weights: a smaller pivot is rounding
_MIN_WEIGHT = 1e-9  # over the weight of a full neighbourhood

Widths = tuple[float | None, float | None]
"""Widths of the weight exp(-pi (distance/width)^2) in pixels, along the columns and along the rows; None: not used."""


def local_regression(z: Floats, weights: Floats, *, widths: Widths, order: int) -> Floats:
    r"""Local polynomial regression of a map: the value at each pixel of the polynomial fitted around it.

    `z` has shape (rows, columns).

    NaN where no pixel within reach has weight.

    At each pixel :math:`r` the coefficients of the polynomial :math:`p_r` of the order minimise

    .. math:: \sum_s g(s - r)\, \omega_s \left[z_s - p_r(s - r)\right]^2 , \qquad
        g(d) = e^{-\pi (d/w)^2} ,

    with the weights :math:`\omega`, and the result is :math:`p_r(0)`.

    Source: ISO 16610-31:2016 and ISO 16610-71:2014, Gaussian regression filters.
    """
    if order == 0:
        return _patch_regression(z, weights, widths, order)
    fitted = np.empty_like(z)
    for kept, strip, inside in _strips(z.shape, widths[0]):
        fitted[kept] = _patch_regression(z[strip], weights[strip], widths, order)[inside]
    return fitted


def _strips(shape: tuple[int, ...], width: float | None) -> Iterator[tuple[slice, slice, slice]]:
    """Slices of the rows to keep, of the strip to filter with its margins, and of the kept rows within the strip."""
    margin = 0 if width is None else int(np.ceil(REACH * width))
    rows = max(_STRIP // shape[1], margin, 1)
    for first in range(0, shape[0], rows):
        start, stop = max(first - margin, 0), min(first + rows + margin, shape[0])
        last = min(first + rows, shape[0])
        yield slice(first, last), slice(start, stop), slice(first - start, last - start)


def _patch_regression(z: Floats, weights: Floats, widths: Widths, order: int) -> Floats:
    """Local polynomial regression of a map that fits into memory as a whole."""
    sums = _Correlation.of(z.shape, widths, order)
    uniform, least = bool(np.all(weights == 1)), _MIN_WEIGHT * sums.full_weight
    spectrum_z = sums.forward(z if uniform else weights * z)
    spectrum_w = None if uniform else sums.forward(weights)

    def moment(power_y: int, power_x: int) -> Floats:
        if spectrum_w is None:
            return sums.of_ones(power_y, power_x)
        return sums.backward(spectrum_w, power_y, power_x)

    if order == 0:
        weight = moment(0, 0)
        fitted = sums.backward(spectrum_z, 0, 0)
        np.divide(fitted, weight, out=fitted, where=weight > least)
        fitted[weight <= least] = np.nan
        return fitted
    terms = [(a, b) for a in range(order + 1) for b in range(order + 1 - a) if widths[0] is not None or a == 0]
    terms.reverse()  # the constant last, so that elimination yields it without back substitution
    powers = sorted({(a + c, b + d) for a, b in terms for c, d in terms})
    moments = np.empty((len(powers), *z.shape))
    for plane, (a, b) in zip(moments, powers, strict=True):
        plane[...] = moment(a, b)
    values = np.empty((len(terms), *z.shape))
    for plane, (a, b) in zip(values, terms, strict=True):
        plane[...] = sums.backward(spectrum_z, a, b)
    table = np.array([[powers.index((a + c, b + d)) for c, d in terms] for a, b in terms])
    fitted = np.empty(z.size)
    _constant_terms(moments.reshape(len(powers), -1), values.reshape(len(terms), -1), table, least, fitted)
    return fitted.reshape(z.shape)


class _Correlation(NamedTuple):
    """Correlations of a map with the weight times powers of the distance, in units that keep them near one."""

    shape: tuple[int, int]
    lines: tuple[Floats | None, Floats]  # by power: sums over a line of ones, along columns and rows
    spectra: tuple[Complexes | None, Complexes]  # by power
    full_weight: float

    @classmethod
    def of(cls, shape: tuple[int, ...], widths: Widths, order: int) -> "_Correlation":
        """Correlation for maps of a shape, with powers of the distance up to twice the order."""
        rows, columns = shape
        width_y, width_x = widths
        assert width_x is not None
        spectrum_x, line_x = _line(columns, width_x, order)
        full = min(width_x, columns)
        if width_y is None:
            return cls((rows, columns), (None, line_x), (None, spectrum_x), full)
        spectrum_y, line_y = _line(rows, width_y, order)
        full *= min(width_y, rows)
        return cls((rows, columns), (line_y, line_x), (spectrum_y, spectrum_x), full)

    def forward(self, field: Floats) -> Complexes:
        """Fourier transform of a map, padded with zeros."""
        down, along = self.spectra
        spectrum = fft.rfft(field, along.shape[1], axis=1)
        return np.asarray(spectrum if down is None else fft.fft(spectrum, down.shape[1], axis=0, overwrite_x=True))

    def backward(self, spectrum: Complexes, power_y: int, power_x: int) -> Floats:
        """Correlation of a transformed map with the weight times powers of the distance."""
        down, along = self.spectra
        product = spectrum * along[power_x, : along.shape[1] // 2 + 1]
        if down is not None:
            product *= down[power_y][:, None]
            product = fft.ifft(product, axis=0, overwrite_x=True)[: self.shape[0]]
        return np.asarray(fft.irfft(product, along.shape[1], axis=1, overwrite_x=True)[:, : self.shape[1]])

    def of_ones(self, power_y: int, power_x: int) -> Floats:
        """Correlation of a map of ones with the weight times powers of the distance."""
        down, along = self.lines
        column = np.ones(self.shape[0]) if down is None else down[power_y]
        return np.outer(column, along[power_x])


def _line(count: int, width: float, order: int) -> tuple[Complexes, Floats]:
    """Spectra of weight times powers of the distance along one axis, and their sums over a line of ones."""
    reach = min(int(np.ceil(REACH * width)), count - 1)
    size = fft.next_fast_len(count + reach, real=True)
    k = np.arange(-reach, reach + 1)
    power = np.arange(2 * order + 1)[:, None]
    wavelet = np.zeros((power.size, size))
    wavelet[:, -k % size] = np.exp(-np.pi * (k / width) ** 2) * (k / min(width, count)) ** power
    spectra = fft.fft(wavelet)
    return spectra, np.real(fft.ifft(spectra * fft.fft(np.ones(count), size)))[:, :count]


@kernel(cache=True, nogil=True, error_model="numpy")
def _constant_terms(
    moments: Floats, values: Floats, table: NDArray[np.int64], least_weight: float, fitted: Floats
) -> None:
    """Solve the normal equations of every pixel for the last unknown by elimination, dropping terms of small pivots."""
    terms = table.shape[0]
    a = np.empty((terms, terms))
    b = np.empty(terms)
    for pixel in range(fitted.size):
        weight = moments[table[terms - 1, terms - 1], pixel]
        if weight <= least_weight:
            fitted[pixel] = np.nan
            continue
        for i in range(terms):
            b[i] = values[i, pixel]
            for j in range(i + 1):
                a[i, j] = moments[table[i, j], pixel]
        for i in range(terms - 1):
            if a[i, i] <= _MIN_PIVOT * weight:
                continue
            for j in range(i + 1, terms):
                factor = a[j, i] / a[i, i]
                b[j] -= factor * b[i]
                for k in range(i + 1, j + 1):
                    a[j, k] -= factor * a[k, i]
        fitted[pixel] = b[terms - 1] / a[terms - 1, terms - 1]


# Width of the weight over the cutoff, such that half of the amplitude is transmitted at the cutoff.
_WIDTH_OVER_CUTOFF = {
    0: math.sqrt(math.log(2) / math.pi),  # alpha of ISO 16610-21: transmission exp(-u), u = pi (alpha lc/l)^2
    2: 0.7309134280946760,  # gamma of ISO 16610-31: transmission (1 + u) exp(-u), half where u = 1.67834699
}
_MIN_PIXELS = 5  # per cutoff (ISO 25178-3, table 1)
_BISQUARE_REACH = 4.4478  # medians of the absolute residuals, three standard deviations (ISO 16610-31)
_MAX_ITERATIONS = 50
_CONVERGED = 1e-3  # relative change of the scale
_MIN_SCALE = 1e-12  # over the largest height: smaller residuals are rounding, whose median never settles


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
    converges; the standard uses it with order 2. The scale is 1e-12 of the largest deviation from the mean height or
    more: where the surface is its own waviness the residuals are rounding, whose median moves with every iteration.

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
    scale, floor = math.inf, _MIN_SCALE * float(np.max(np.abs(z)))
    for _ in range(_MAX_ITERATIONS):
        residual = np.abs(z - smooth)
        previous, scale = scale, max(_BISQUARE_REACH * float(np.median(residual[measured])), floor)
        if scale == 0 or abs(previous - scale) <= _CONVERGED * scale:
            return smooth
        weights = measured * np.maximum(0.0, 1 - (residual / scale) ** 2) ** 2
        refined = local_regression(z, weights, widths=widths, order=order)
        smooth = np.where(np.isfinite(refined), refined, smooth)  # unchanged where only outliers are within reach
    warn_of_range(f"the robust filter has not converged in {_MAX_ITERATIONS} iterations", stacklevel=4)
    return smooth
