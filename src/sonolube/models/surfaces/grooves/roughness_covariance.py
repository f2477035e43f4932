"""Covariance of the unworn roughness by the debiased Whittle likelihood, and the variance of sums over heights."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy import fft, stats

from sonolube.checks import Floats
from sonolube.models.surfaces.grooves.track import block_edges
from sonolube.models.surfaces.height_map import HeightMap, Mask
from sonolube.models.surfaces.spectrum import half_spectrum_multiplicity

__all__: list[str] = []  # used in this room only

_CELLS = 110  # along the longer side
_MIN_FILLED = 0.5  # fraction of a cell's pixels
_LOWEST = 1.01  # periods in the field, of the waves that the removal of the form takes away
_HIGHEST = 0.75  # of the cells' Nyquist wavenumber: aliases distort shorter waves
_ITERATIONS, _CONVERGED = 25, 1e-3  # of Fisher's scoring; change of the parameters
_STEP = 1e-3  # of a parameter, for derivatives
_LARGEST_STEP = 0.7
_PRIOR = np.array([0.0, 0.0, 0.0, 0.0, 4.0, 0.02])  # precision about the starting values, for what the map leaves free
_EXPONENT = 0.8  # expected, of Hurst
_MIN_NOISE = 1e-6  # variance of the cells' noise over that of the cells
_HIGHEST_EXPONENT = 6.0


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class RoughnessCovariance:
    r"""Stationary covariance of the roughness: a self-affine spectrum with roll-off and lay, and white noise.

    Parameters
    ----------
    parameters : ndarray, shape (6,)
        Logarithms of the variance in m2 and of the geometric mean of the two roll-off lengths in m, two components of
        the logarithm of their ratio along x and along the diagonal, logarithm of the Hurst exponent, and logarithm of
        the variance of the noise of a cell in m2.
    parameter_covariance : ndarray, shape (6, 6)
        Their covariance, from Fisher's information.
    cell_sides : tuple of float
        Sides of a cell along y and x, in m.
    pixels_per_cell : float

    Notes
    -----
    .. math:: S(\mathbf k) \propto \sigma^2 \left[1 + (2\pi)^2\, \mathbf k^T M \mathbf k\right]^{-1-H}, \qquad
        M = \ell^2 \exp \begin{pmatrix} a & b \\ b & -a \end{pmatrix} .
    """

    parameters: Floats
    parameter_covariance: Floats
    cell_sides: tuple[float, float]
    pixels_per_cell: float

    def variance(self, weights: Floats) -> tuple[float, Floats]:
        """Variance of a weighted sum of heights, and its derivatives with respect to the first five parameters.

        Of weights of shape (cell rows, cell columns); in m2 times the square of their unit, without the noise.
        """
        shape = _padded(weights.shape)
        power = np.abs(fft.rfft2(weights, shape)) ** 2 * half_spectrum_multiplicity(shape[1])

        def value(parameters: Floats) -> float:
            return float(np.vdot(power, _density(parameters, shape, self.cell_sides))) / math.prod(shape)

        base = value(self.parameters)
        return base, np.array([(value(self.parameters + _STEP * row) - base) / _STEP for row in np.eye(6)[:5]])

    def smeared(self, weights: Floats) -> Floats:
        """Covariance with the height of each cell of a weighted sum over cells, without the noise, in m2."""
        shape = _padded(weights.shape)
        spread = fft.irfft2(fft.rfft2(weights, shape) * _density(self.parameters, shape, self.cell_sides), shape)
        return np.asarray(spread[: weights.shape[0], : weights.shape[1]])

    @property
    def noise_of_pixel(self) -> float:
        """Variance of the white noise of a pixel, in m2."""
        return math.exp(float(self.parameters[5])) * self.pixels_per_cell

    def uncertainty(self, variance: float, derivative: Floats) -> float:
        """Standard deviation of the logarithm of a variance because the spectrum was estimated from the map."""
        relative = derivative / max(variance, np.finfo(float).tiny)
        return math.sqrt(max(0.0, float(relative @ self.parameter_covariance[:5, :5] @ relative)))


def coverage_factor(relative_deviation: float, level: float = 0.95) -> float:
    """Student's factor of an interval whose variance is known to a standard deviation of its logarithm."""
    freedom = max(2.0, 2 / max(relative_deviation, 1e-3) ** 2)
    return float(stats.t.ppf((1 + level) / 2, freedom))


class Cells:
    """Sums of pixel weights and means of heights over the cells of a map."""

    def __init__(self, surface: HeightMap) -> None:
        self._edges = block_edges(surface, max(surface.sides) / _CELLS)
        self._shape = surface.height.shape
        sizes = [int(edge[1]) if edge.size > 1 else surface.height.shape[axis] for axis, edge in enumerate(self._edges)]
        self.cell_sides = (sizes[0] * surface.spacing_y, sizes[1] * surface.spacing_x)
        self.pixels_per_cell = float(math.prod(sizes))

    def sums(self, weights: Floats) -> Floats:
        """Sums of pixel weights over each cell, shape (..., cell rows, cell columns)."""
        rows = np.add.reduceat(weights, self._edges[0], axis=-2)
        return np.asarray(np.add.reduceat(rows, self._edges[1], axis=-1))

    def of_pixels(self, values: Floats) -> Floats:
        """Value of the cell of each pixel."""
        rows, columns = (
            np.searchsorted(edge, np.arange(count), side="right") - 1
            for edge, count in zip(self._edges, self._shape, strict=True)
        )
        return np.asarray(values[np.ix_(rows, columns)])

    def means(self, height: Floats, counted: Mask) -> tuple[Floats, Mask]:
        """Means of the counted pixels of each cell, zero where too few are, and mask of the cells with enough."""
        count = self.sums(counted.astype(np.float64))
        filled = count >= _MIN_FILLED * self.pixels_per_cell
        total = self.sums(np.where(counted, height, 0.0))
        return np.where(filled, total / np.maximum(count, 1.0), 0.0), filled


def roughness_covariance(cells: Cells, random_part: Floats, counted: Mask) -> RoughnessCovariance:
    """Covariance of the roughness from the unworn pixels of a map, by maximum likelihood.

    `random_part` has shape (rows, columns).

    The periodogram of the masked map is compared with its expectation, the transform of the covariance times the
    autocorrelation of the mask, so that neither mask nor border biases the spectrum Waves of one period in the
    field and longer, which the removal of the form takes away, do not count.

    Source: A. P. Guillaumin et al., J. R. Stat. Soc. B 84, 1526 (2022). doi:10.1111/rssb.12539
    """
    mean, mask = cells.means(random_part, counted)
    mean = np.where(mask, mean - mean[mask].mean(), 0.0)
    shape = _padded(mean.shape)
    window = mask.astype(np.float64)
    total = float(window.sum())
    overlap = _lags(np.abs(fft.rfft2(window, shape)) ** 2 / total, shape)
    periods_y, periods_x = np.abs(fft.fftfreq(shape[0], 1 / mean.shape[0])), fft.rfftfreq(shape[1], 1 / mean.shape[1])
    counted_waves = (periods_y[:, None] > _LOWEST) | (periods_x > _LOWEST)
    counted_waves &= (periods_y[:, None] < _HIGHEST * mean.shape[0] / 2) & (periods_x < _HIGHEST * mean.shape[1] / 2)
    used = np.flatnonzero(counted_waves)
    weight = np.broadcast_to(half_spectrum_multiplicity(shape[1]), counted_waves.shape).take(used)
    weight *= total / math.prod(shape) / 2  # as many as there are cells, in pairs
    periodogram = np.abs(fft.rfft2(mean, shape).take(used)) ** 2 / total
    variance = max(float(np.sum(mean**2)) / total, np.finfo(float).tiny)

    def without_noise(parameters: Floats) -> Floats:
        """Expected periodogram of heights without the noise, whose own is its variance at all wavenumbers."""
        covariance = _lags(_density(parameters, shape, cells.cell_sides), shape)
        return np.asarray(fft.hfft(fft.rfft(covariance * overlap, axis=1), shape[0], axis=0).take(used))

    def scored(length: float) -> tuple[float, Floats, Floats]:
        """Best fit from a correlation length in cells."""
        size, reach = math.log(variance), math.log(length * math.sqrt(math.prod(cells.cell_sides)))
        start = np.array([size, reach, 0.0, 0.0, math.log(_EXPONENT), math.log(0.05 * variance)])
        limits = 1e-9 * variance, math.log(_MIN_NOISE * variance)
        return _scored(start, without_noise, periodogram, weight, *limits)

    _, parameters, parameter_covariance = min((scored(length) for length in (2.0, 8.0)), key=lambda found: found[0])
    return RoughnessCovariance(
        parameters=parameters,
        parameter_covariance=parameter_covariance,
        cell_sides=cells.cell_sides,
        pixels_per_cell=cells.pixels_per_cell,
    )


def _scored(
    start: Floats,
    without_noise: Callable[[Floats], Floats],
    periodogram: Floats,
    weight: Floats,
    floor: float,
    least_noise: float,
) -> tuple[float, Floats, Floats]:
    """Minus log-likelihood, parameters and covariance, by Fisher's scoring from a start."""

    def cost(parameters: Floats, rough: Floats) -> float:
        mean, change = np.maximum(rough + math.exp(parameters[5]), floor), parameters - start
        return float(np.sum(weight * (np.log(mean) + periodogram / mean))) + float(change @ (_PRIOR * change)) / 2

    def stepped(parameters: Floats, rough: Floats) -> list[Floats]:
        """Expected periodograms with each parameter a step larger."""
        noise, factor = math.exp(parameters[5]), math.exp(_STEP)
        shapes = [without_noise(parameters + _STEP * row) + noise for row in np.eye(6)[1:5]]
        return [factor * rough + noise, *shapes, rough + factor * noise]

    theta, rough = start, without_noise(start)
    value = cost(theta, rough)
    damping = 1e-3
    information = np.eye(6)
    for _ in range(_ITERATIONS):
        mean = np.maximum(rough + math.exp(theta[5]), floor)
        slopes = (np.maximum(stepped(theta, rough), floor) / mean - 1) / _STEP
        weighted = slopes * weight
        gradient = weighted @ (periodogram / mean - 1) - _PRIOR * (theta - start)
        information = weighted @ slopes.T + np.diag(_PRIOR)
        for _ in range(8):
            step = np.linalg.solve(information + damping * np.diag(np.diag(information) + 1e-9), gradient)
            step *= min(1.0, _LARGEST_STEP / max(float(np.max(np.abs(step))), 1e-12))
            trial = theta + step
            trial[4] = min(trial[4], math.log(_HIGHEST_EXPONENT))
            trial[5] = max(trial[5], least_noise)
            tried_rough = without_noise(trial)
            tried = cost(trial, tried_rough)
            if tried <= value:
                break
            damping = max(10 * damping, 1e-2)
        else:
            break
        moved = float(np.max(np.abs(trial - theta)))
        gained = value - tried
        theta, value, rough, damping = trial, tried, tried_rough, damping / 10
        if moved < _CONVERGED or gained < 1e-2:
            break
    return value, theta, np.asarray(np.linalg.pinv(information + 1e-6 * np.eye(6)), dtype=np.float64)


def _padded(shape: tuple[int, ...]) -> tuple[int, int]:
    """Shape of the periodic grid on which sums over the cells do not wrap round."""
    return (fft.next_fast_len(2 * shape[-2], real=True), fft.next_fast_len(2 * shape[-1], real=True))


def _lags(spectrum: Floats, shape: tuple[int, int]) -> Floats:
    """Inverse transform of an even spectrum, at lags of zero and more along y; the others follow by point symmetry."""
    return np.asarray(fft.irfft(fft.ihfft(spectrum, axis=0), shape[1], axis=1))


@lru_cache(maxsize=4)
def _wavenumbers(shape: tuple[int, int], spacing: tuple[float, float]) -> tuple[Floats, Floats, Floats, Floats]:
    """Products kx kx, ky ky and kx ky of the wavenumbers of a periodic grid, and the transfer function of its cells."""
    ky, kx = fft.fftfreq(shape[0], spacing[0])[:, None], fft.rfftfreq(shape[1], spacing[1])
    return kx**2, ky**2, kx * ky, (np.sinc(ky * spacing[0]) * np.sinc(kx * spacing[1])) ** 2


def _density(parameters: Floats, shape: tuple[int, int], spacing: tuple[float, float]) -> Floats:
    """Eigenvalues of the covariance of cell means on the periodic grid, in m2, without the noise."""
    along_x, along_y, mixed, averaging = _wavenumbers(shape, spacing)
    variance, length, a, b, exponent, _ = parameters
    size = math.hypot(a, b)
    cosh, sinh = math.cosh(size), math.sinh(size) / size if size > 1e-12 else 1.0
    squared = along_x * (cosh + a * sinh) + along_y * (cosh - a * sinh) + 2 * b * sinh * mixed
    hurst = math.exp(exponent)
    inner = (2 * math.pi) ** 2 * math.exp(2 * length)
    continuous = 4 * math.pi * hurst * math.exp(variance + 2 * length) / math.prod(spacing)
    return np.asarray(continuous * np.exp(-(1 + hurst) * np.log1p(inner * squared)) * averaging)
