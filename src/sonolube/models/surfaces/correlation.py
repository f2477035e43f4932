"""Autocorrelation of a height map, and the distances over which it decays."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from sonolube.checks import Floats, require_finite
from sonolube.errors import InvalidInput
from sonolube.execution.compilation import kernel
from sonolube.models.surfaces.height_map import HeightMap


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Autocorrelation:
    """Autocovariance of the heights of a map over the lag.

    Parameters
    ----------
    lag_x : ndarray, shape (2p + 1,)
        Lag along the rows, from -p to p columns. [m]
    lag_y : ndarray, shape (2q + 1,)
        Lag along the columns, from -q to q rows. [m]
    autocovariance : ndarray, shape (2q + 1, 2p + 1)
        Mean product of deviations from the mean height at that lag; NaN where no pair of pixels was measured. [m2]
    """

    lag_x: Floats
    lag_y: Floats
    autocovariance: Floats

    @property
    def normalized(self) -> Floats:
        """Autocovariance over its value at zero lag, of the same shape."""
        rows, columns = self.autocovariance.shape
        return np.asarray(self.autocovariance / self.autocovariance[rows // 2, columns // 2])


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class CorrelationLengths:
    """Distances over which the autocorrelation decays to a threshold, by direction.

    Parameters
    ----------
    distance : ndarray, shape (n,)
        Distance in m at which it first falls to the threshold; where it does not, up to which it is known.
    decayed : ndarray of bool, shape (n,)
        Whether it falls to the threshold.
    """

    distance: Floats
    decayed: NDArray[np.bool_]


def autocorrelation(surface: HeightMap) -> Autocorrelation:
    r"""Autocorrelation of a height map for lags up to half its size, by Fourier transform.

    Parameters
    ----------
    surface : HeightMap
        The mean of the measured pixels is removed here.

    Returns
    -------
    Autocorrelation

    Raises
    ------
    InvalidInput
        If the map is flat.

    Notes
    -----
    .. math:: A(\tau) = \frac{\sum_r z(r)\, z(r + \tau)}{\#\{r : \text{both measured}\}}

    with the deviations z from the mean height. Division by the number of products makes the estimate unbiased at edges
    and missing pixels; its scatter increases as that number decreases. Both sums are correlations, taken by Fourier
    transform with zero padding against wrap-around.
    """
    measured = surface.measured
    z = surface.height
    deviation = np.where(measured, z - np.mean(z, where=measured), 0.0)
    if not np.ptp(z[measured]) > 0:
        raise InvalidInput("height must vary: a flat map has no autocorrelation")
    rows, columns = z.shape
    half_y, half_x = rows // 2, columns // 2
    lag_y, lag_x = np.arange(-half_y, half_y + 1), np.arange(-half_x, half_x + 1)
    if measured.all():
        counts = np.outer(rows - np.abs(lag_y), columns - np.abs(lag_x)).astype(np.float64)
    else:
        counts = np.rint(_sums_of_products(measured.astype(np.float64), half_y, half_x))
    sums = _sums_of_products(deviation, half_y, half_x)
    return Autocorrelation(
        lag_x=lag_x * surface.spacing_x,
        lag_y=lag_y * surface.spacing_y,
        autocovariance=np.divide(sums, counts, out=np.full_like(sums, np.nan), where=counts > 0),
    )


def correlation_lengths(correlation: Autocorrelation, *, directions: ArrayLike, threshold: float) -> CorrelationLengths:
    """Distances over which the normalised autocorrelation decays to a threshold, by direction.

    Parameters
    ----------
    correlation : Autocorrelation
    directions : array_like, shape (n,)
        Angles from the direction of the rows, in rad.
    threshold : float
        Value of the normalised autocorrelation, between 0 and 1.

    Returns
    -------
    CorrelationLengths
    """
    angles = np.atleast_1d(require_finite(directions=directions))
    step_x, step_y = (lag[1] - lag[0] if lag.size > 1 else 1.0 for lag in (correlation.lag_x, correlation.lag_y))
    distance = np.zeros(angles.size)
    decayed = np.zeros(angles.size, dtype=np.bool_)
    _first_decay(correlation.normalized, np.cos(angles) / step_x, np.sin(angles) / step_y, threshold, distance, decayed)
    return CorrelationLengths(distance=distance, decayed=decayed)


def _sums_of_products(value: Floats, half_y: int, half_x: int) -> Floats:
    """Sums of the products of values at each lag up to half the map, shape (2 half_y + 1, 2 half_x + 1)."""
    rows, columns = value.shape
    long_y, long_x = fft.next_fast_len(rows + half_y, real=True), fft.next_fast_len(columns + half_x, real=True)
    spectrum = fft.fft(fft.rfft(value, n=long_x, axis=1, workers=-1), n=long_y, axis=0, workers=-1, overwrite_x=True)
    power = spectrum.real**2 + spectrum.imag**2
    upper = fft.ihfft(power, axis=0, workers=-1, overwrite_x=True)[: half_y + 1]
    line = fft.irfft(upper, n=long_x, axis=1, workers=-1)
    sums = np.empty((2 * half_y + 1, 2 * half_x + 1))
    sums[half_y:, half_x:] = line[:, : half_x + 1]
    sums[half_y:, :half_x] = line[:, long_x - half_x :]
    sums[:half_y] = sums[:half_y:-1, ::-1]  # products at opposite lags are the same
    return sums


@kernel(cache=True, nogil=True, error_model="numpy")
def _first_decay(
    correlation: Floats, per_x: Floats, per_y: Floats, threshold: float, distance: Floats, decayed: NDArray[np.bool_]
) -> None:
    """Write distance and decay for each direction, by bilinear interpolation in steps of half a pixel from zero lag."""
    half_y, half_x = correlation.shape[0] // 2, correlation.shape[1] // 2
    for ray in range(per_x.size):
        stride = 0.5 / max(abs(per_x[ray]), abs(per_y[ray]))
        before, step = 1.0, 0
        while True:
            step += 1
            x, y = half_x + step * stride * per_x[ray], half_y + step * stride * per_y[ray]
            column, row = int(np.floor(x)), int(np.floor(y))
            if column < 0 or row < 0 or column > 2 * half_x or row > 2 * half_y:
                break
            east, north = min(column + 1, 2 * half_x), min(row + 1, 2 * half_y)
            u, v = x - column, y - row
            south_side = (1 - u) * correlation[row, column] + u * correlation[row, east]
            north_side = (1 - u) * correlation[north, column] + u * correlation[north, east]
            now = (1 - v) * south_side + v * north_side
            if now != now:
                break
            distance[ray] = step * stride
            if now <= threshold:
                distance[ray] -= stride * (threshold - now) / (before - now)
                decayed[ray] = True
                break
            before = now
