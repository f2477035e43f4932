"""Autocorrelation of a height map, and how far it reaches."""

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import fft

from sonolube.checks import Floats, require_finite
from sonolube.errors import InvalidInput
from sonolube.surfaces.height_map import HeightMap


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Autocorrelation:
    """Mean product of height deviations some way apart.

    Parameters
    ----------
    lag_x : ndarray, shape (2p + 1,)
        Distance along the rows, from -p to p columns. [m]
    lag_y : ndarray, shape (2q + 1,)
        Distance along the columns, from -q to q rows. [m]
    autocovariance : ndarray, shape (2q + 1, 2p + 1)
        Mean product of deviations so far apart; NaN where no two measured pixels are. [m2]
    """

    lag_x: Floats
    lag_y: Floats
    autocovariance: Floats

    @property
    def normalized(self) -> Floats:
        """Autocovariance over its value at no lag, of the same shape."""
        rows, columns = self.autocovariance.shape
        return np.asarray(self.autocovariance / self.autocovariance[rows // 2, columns // 2])


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class CorrelationLengths:
    """How far the autocorrelation stays above a threshold, direction by direction.

    Parameters
    ----------
    distance : ndarray, shape (n,)
        Distance at which it first falls to the threshold; where it does not, how far it is known.
    decayed : ndarray of bool, shape (n,)
        Whether it falls to the threshold.
    """

    distance: Floats
    decayed: NDArray[np.bool_]


def autocorrelation(surface: HeightMap) -> Autocorrelation:
    """Return the autocorrelation for lags up to half the map each way.

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
    The sum of products at each lag is divided by the number of products in it, so that neither edges nor missing
    pixels bias it; the estimate scatters more the fewer products there are. Sums are taken by Fourier transform,
    padded with so many zeros that opposite edges do not meet.
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
        pairs = np.outer(rows - np.abs(lag_y), columns - np.abs(lag_x)).astype(np.float64)
    else:
        pairs = np.rint(_sums_of_products(measured.astype(np.float64), half_y, half_x))
    sums = _sums_of_products(deviation, half_y, half_x)
    return Autocorrelation(
        lag_x=lag_x * surface.spacing_x,
        lag_y=lag_y * surface.spacing_y,
        autocovariance=np.divide(sums, pairs, out=np.full_like(sums, np.nan), where=pairs > 0),
    )


def correlation_lengths(correlation: Autocorrelation, *, directions: ArrayLike, threshold: float) -> CorrelationLengths:
    """Return how far the normalized autocorrelation stays above a threshold.

    Parameters
    ----------
    correlation : Autocorrelation
    directions : array_like, shape (n,)
        Angles in rad from the direction of the rows.
    threshold : float
        Between 0 and 1.

    Returns
    -------
    DecayLengths
    """
    angles = np.atleast_1d(require_finite(directions=directions))
    step_x, step_y = (lag[1] - lag[0] if lag.size > 1 else 1.0 for lag in (correlation.lag_x, correlation.lag_y))
    distance = np.zeros(angles.size)
    decayed = np.zeros(angles.size, dtype=np.bool_)
    _march(correlation.normalized, np.cos(angles) / step_x, np.sin(angles) / step_y, threshold, distance, decayed)
    return CorrelationLengths(distance=distance, decayed=decayed)


def _sums_of_products(value: Floats, half_y: int, half_x: int) -> Floats:
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


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _march(
    correlation: Floats,
    per_x: Floats,
    per_y: Floats,
    threshold: float,
    distance: Floats,
    decayed: NDArray[np.bool_],
) -> None:
    """Walk out from the centre along each direction, half a pixel at a time, reading between pixels linearly."""
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
