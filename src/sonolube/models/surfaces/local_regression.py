"""Local polynomial regression with a Gaussian weight at every pixel, by Fourier transform.

The moments of the neighbourhood of every pixel are correlations. Missing pixels and those outside the map have weight
zero, so that edges and holes require no extrapolation. A term that a neighbourhood does not determine is dropped there.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import fft

from sonolube.checks import Complexes, Floats
from sonolube.execution.compilation import kernel

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
