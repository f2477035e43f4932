"""Waviness models of a few plane waves, by stepwise nonlinear least squares and the Bayesian information criterion."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sonolube.checks import Floats
from sonolube.models.surfaces.grooves.blocks import SHORTEST_RELATIVE_WAVELENGTH, BlockAverages, WavinessModel
from sonolube.models.surfaces.height_map import Mask

_MAX_WAVES = 4
_LONGEST = 3.0  # wavelength over the longer side: longer ones are form
_HIGHEST = 5.0  # amplitude over the standard deviation of the unworn blocks: higher waves cancel each other
_NEWTON_STEPS = 15
_CONVERGED = 1e-4  # change of the misfit, in variances of the noise
_MIN_NOISE = 1e-6  # over the standard deviation of the unworn blocks
_ROUNDING = 1e-12
_IMPROBABLE = 12.0  # cost above the least: a likelihood ratio of 1/400
_DEVIATION_OVER_MEDIAN = 1.4826  # standard deviation over median absolute deviation of Gaussian heights
_STARTS = 6  # local maxima of the explained misfit from which a further wave is refined, by default


def _noise_of_neighbours(blocks: BlockAverages) -> tuple[float, ...]:
    """Variances in m2 of the noise of unworn and worn blocks, from third differences along the rows."""
    scale = (_DEVIATION_OVER_MEDIAN**2) / 20  # variance of the third difference of noise is 20 times its own
    differences = (np.diff(blocks.mean_height[part], 3) for part in blocks.parts)
    return tuple(
        max(scale * float(np.median(np.abs(part))) ** 2 if part.size else 0.0, (_MIN_NOISE * blocks.deviation) ** 2)
        for part in differences
    )


@dataclass(frozen=True, slots=True, eq=False)
class PlaneWaves:
    """Fits of up to four plane waves, the most probable first, then those not much less probable.

    Parameters
    ----------
    fits : list of PlaneWaveFit
    sufficient : bool
        Whether a further wave would not reduce the misfit significantly.
    """

    fits: list["PlaneWaveFit"]
    sufficient: bool


class PlaneWaveFit(NamedTuple):
    """Plane waves of least misfit.

    Parameters
    ----------
    modes : ndarray, shape (n, 2)
        Wavenumbers along x and y, in 1/m.
    amplitudes : ndarray, shape (2 n,)
        Of the cosines, then of the sines, in m.
    residual : ndarray, shape (blocks,)
        Misfit of the blocks over the standard deviation of their noise.
    cost : float
        Bayesian information criterion, up to a constant; infinite for waves out of range.
    """

    modes: Floats
    amplitudes: Floats
    residual: Floats
    cost: float


class PlaneWaveSearch:
    """Search for plane waves in weighted blocks, form and section eliminated by projection (variable projection).

    Parameters
    ----------
    blocks : BlockAverages
    noise : tuple of float, optional
        Variances of unworn and of worn blocks in m2, by which to weigh them; estimated from neighbouring blocks by
        default.
    form_terms : int
        Terms of the form: 3 for a plane, 6 for a form of second degree.
    """

    def __init__(self, blocks: BlockAverages, *, noise: tuple[float, ...] | None = None, form_terms: int = 3) -> None:
        self._blocks, self._form_terms = blocks, form_terms
        self._root = np.sqrt(blocks.weight / blocks.per_part(noise or _noise_of_neighbours(blocks)))
        self._places = np.stack([blocks.x, blocks.y])
        form, section = (self._root[:, None] * functions for functions in (blocks.form(form_terms), blocks.section))
        self._linear = np.concatenate([form, section], axis=1)
        # an orthonormal basis of both, that of the section zero at the unworn blocks
        self._section_basis = np.linalg.qr(section[blocks.unworn :])[0]
        form[blocks.unworn :] -= self._section_basis @ (self._section_basis.T @ form[blocks.unworn :])
        self._form_basis = np.linalg.qr(form)[0]
        height = self._root * blocks.mean_height
        self._height = height - self._expanded(self._coefficients(height))
        self._fits: dict[bytes, PlaneWaveFit] = {}

    def stepwise(self, starts: int = _STARTS) -> PlaneWaves:
        """Up to four plane waves of any direction and length, with the number chosen by evidence.

        Waves are added one by one. Each starts from the Fourier modes that reduce the misfit most, and all wavenumbers
        and amplitudes are refined together by Gauss-Newton steps. A wave is kept if it lowers the Bayesian information
        criterion, in which it counts four parameters.
        """
        (best,) = self._refined([np.empty((0, 2))])
        fits = [best]
        sufficient = False
        for _ in range(_MAX_WAVES + 1):
            gain = self._misfit_reduction(best.residual) / float(np.mean(best.residual**2))
            # half of what a wave costs, for the best one may lie between two modes
            sufficient = bool(gain.max() < 2 * math.log(best.residual.size))
            if sufficient or len(best.modes) == _MAX_WAVES:
                break
            modes = _local_maxima(self._candidates, gain)[:starts]
            extended = self._refined([np.vstack([best.modes, mode]) for mode in modes])
            fits += extended
            most_probable = min(extended, key=lambda fit: fit.cost)
            if most_probable.cost >= best.cost:
                break
            best = most_probable
        distinct = {round(fit.cost, 1): fit for fit in fits if fit.cost < best.cost + _IMPROBABLE}
        return PlaneWaves([distinct[cost] for cost in sorted(distinct)], sufficient)

    def models(self, waves: PlaneWaves) -> list[WavinessModel]:
        """Waviness models of fits, with form, section and response."""
        return [self._model(fit) for fit in waves.fits]

    @cached_property
    def _candidates(self) -> "_Candidates":
        """Fourier modes from which waves start."""
        cosine, sine = (self._root * wave.T for wave in self._blocks.fourier_waves)
        of_cosine, of_sine = self._coefficients(cosine), self._coefficients(sine)
        cc, ss, cs = (
            np.einsum("ij,ij->i", first, second) - np.einsum("ij,ij->i", of_first, of_second)
            for first, second, of_first, of_second in (
                (cosine, cosine, of_cosine, of_cosine),
                (sine, sine, of_sine, of_sine),
                (cosine, sine, of_cosine, of_sine),
            )
        )
        modes = self._blocks.modes()
        return _Candidates(modes, _neighbours(modes), cosine, sine, cc, ss, cs)

    def _misfit_reduction(self, residual: Floats) -> Floats:
        """Reduction of the residual sum of squares by each of the candidates, of a projected residual."""
        _, _, cosine, sine, cc, ss, cs = self._candidates
        a, b = cosine @ residual, sine @ residual
        return np.asarray((ss * a**2 - 2 * cs * a * b + cc * b**2) / np.maximum(cc * ss - cs**2, _ROUNDING * cc * ss))

    def _coefficients(self, rows: Floats) -> Floats:
        """Coefficients of the projection on form and section of rows of values at the blocks."""
        flat = rows.reshape(-1, rows.shape[-1])
        found = np.concatenate([flat @ self._form_basis, flat[:, self._blocks.unworn :] @ self._section_basis], axis=1)
        return found.reshape(*rows.shape[:-1], found.shape[1])

    def _expanded(self, coefficients: Floats) -> Floats:
        """Projection on form and section of given coefficients, rows of values at the blocks."""
        form_terms = self._form_basis.shape[1]
        rows = np.asarray(coefficients[..., :form_terms] @ self._form_basis.T)
        rows[..., self._blocks.unworn :] += coefficients[..., form_terms:] @ self._section_basis.T
        return rows

    def _waves(self, modes: Floats) -> Floats:
        """Weighted cosines and sines of modes, shape (..., n, 2), at each block, shape (..., 2 n, blocks)."""
        phase = 2 * math.pi * (modes @ self._places)
        return np.asarray(self._root * np.concatenate([np.cos(phase), np.sin(phase)], axis=-2))

    def _derivatives(self, waves: Floats, amplitudes: Floats) -> Floats:
        """Derivatives of the waves with respect to their wavenumbers along x, then along y."""
        (cosine, sine), (c, s) = np.split(waves, 2, axis=-2), np.split(amplitudes[..., None], 2, axis=-2)
        by_phase = 2 * math.pi * (s * cosine - c * sine)
        return np.concatenate([self._blocks.x * by_phase, self._blocks.y * by_phase], axis=-2)

    def _refined(self, starts: list[Floats]) -> list[PlaneWaveFit]:
        """Plane waves of least misfit near given ones, each found once."""
        new = {start.tobytes(): start for start in starts if start.tobytes() not in self._fits}
        if new:
            self._fits.update(zip(new, self._least_misfits(np.stack(list(new.values()))), strict=True))
        return [self._fits[start.tobytes()] for start in starts]

    def _least_misfits(self, modes: Floats) -> list[PlaneWaveFit]:
        """Plane waves of least misfit near starts by Gauss-Newton steps; infinite cost where these diverge.

        Parameters
        ----------
        modes : ndarray, shape (starts, n, 2)
        """
        count, longest_step = modes.shape[1], 1 / (3 * self._blocks.longer_side)
        amplitudes, residuals = np.zeros((len(modes), 2 * count)), np.tile(self._height, (len(modes), 1))
        misfits = np.sum(residuals**2, axis=1)
        active = np.arange(len(modes))
        for _ in range(_NEWTON_STEPS if count else 0):
            waves = self._waves(modes[active])
            of_waves = self._coefficients(waves)
            fitted = _solved(_products(waves) - _products(of_waves), waves @ self._height)
            explained, of_explained = ((fitted[:, None] @ each)[:, 0] for each in (waves, of_waves))
            residual = self._height - explained + self._expanded(of_explained)
            misfit = np.sum(residual**2, axis=1)
            moving = np.abs(misfits[active] - misfit) >= _CONVERGED
            amplitudes[active], residuals[active], misfits[active] = fitted, residual, misfit
            if not moving.any():
                break
            active, waves, of_waves, fitted, residual = (
                each[moving] for each in (active, waves, of_waves, fitted, residual)
            )
            derivatives = self._derivatives(waves, fitted)
            jacobian = np.concatenate([waves, derivatives], axis=1)
            projected = np.concatenate([of_waves, self._coefficients(derivatives)], axis=1)
            moments = (jacobian @ residual[..., None])[..., 0]
            step = _solved(_products(jacobian) - _products(projected), moments)[:, 2 * count :]
            step = step.reshape(-1, 2, count).swapaxes(1, 2)
            size = np.maximum(np.linalg.norm(step, axis=2, keepdims=True), _ROUNDING)
            modes[active] += step * np.minimum(1.0, longest_step / size)
        return [
            PlaneWaveFit(mode, amplitude, residual, self._cost(mode, amplitude, float(misfit)))
            for mode, amplitude, residual, misfit in zip(modes, amplitudes, residuals, misfits, strict=True)
        ]

    def _cost(self, modes: Floats, amplitudes: Floats, misfit: float) -> float:
        """Bayesian information criterion, up to a constant; infinite for waves out of range."""
        longer, wavenumber = self._blocks.longer_side, np.hypot(*modes.T)
        if (
            np.any(wavenumber > 1 / (SHORTEST_RELATIVE_WAVELENGTH * longer))
            or np.any(wavenumber < 1 / (_LONGEST * longer))
            or np.any(np.hypot(*amplitudes.reshape(2, -1)) > _HIGHEST * self._blocks.deviation)
        ):
            return math.inf
        count = self._height.size
        cost = count * math.log(max(misfit, _ROUNDING) / count) + count - float(np.sum(np.log(self._root**2)))
        return cost + float(np.sum(np.log(self._blocks.weight))) + (self._form_terms + 4 * len(modes)) * math.log(count)

    def _model(self, fit: PlaneWaveFit) -> WavinessModel:
        """Waviness model of a fit, with form, section and response."""
        waves = self._waves(fit.modes)
        unexplained = self._root * self._blocks.mean_height - fit.amplitudes @ waves
        (linear,) = _solved((self._linear.T @ self._linear)[None], (unexplained @ self._linear)[None])
        jacobian = np.concatenate([self._linear, waves.T, self._derivatives(waves, fit.amplitudes).T], axis=1)
        size = np.maximum(np.linalg.norm(jacobian, axis=0), np.finfo(float).tiny)
        inverse = np.linalg.pinv((jacobian / size).T @ (jacobian / size)) / np.outer(size, size)
        kept = np.concatenate([np.arange(self._form_terms), np.arange(linear.size, jacobian.shape[1])])
        response = inverse @ (self._root[:, None] * jacobian).T
        cosine, sine = fit.amplitudes.reshape(2, -1)
        return WavinessModel(
            form=linear[: self._form_terms],
            half_side=self._blocks.longer_side / 2,
            modes=fit.modes,
            cosine=cosine,
            sine=sine,
            section=linear[self._form_terms :],
            response=response[kept],
            section_response=response[self._form_terms : linear.size],
            cost=fit.cost,
        )


class _Candidates(NamedTuple):
    """Fourier modes with their weighted waves at the blocks, and scalar products of the projected ones."""

    modes: Floats
    neighbours: Mask
    cosine: Floats
    sine: Floats
    cc: Floats
    ss: Floats
    cs: Floats


def _products(rows: Floats) -> Floats:
    """Scalar products of the rows of each matrix."""
    return np.asarray(rows @ rows.swapaxes(-1, -2))


def _solved(grams: Floats, moments: Floats) -> Floats:
    """Solutions of normal equations with scaled columns, of least norm where they are singular."""
    size = np.sqrt(np.maximum(np.einsum("ijj->ij", grams), 0.0))
    size[size == 0] = 1.0
    values, vectors = np.linalg.eigh(grams / (size[:, :, None] * size[:, None, :]))
    kept = values > _ROUNDING * values.max(axis=1, keepdims=True)
    along = ((moments / size)[:, None] @ vectors)[:, 0]
    solved = vectors @ np.where(kept, along / np.where(kept, values, 1.0), 0.0)[..., None]
    return np.asarray(solved[..., 0] / size)


def _neighbours(modes: Floats) -> Mask:
    """Whether each mode or its opposite is next to each of the others, or the same."""
    spacing = np.min(np.ptp(modes, axis=0) / np.maximum([len(np.unique(k)) - 1 for k in modes.T], 1))
    distance = np.hypot(*(modes[:, None] - modes[None, :]).T)
    opposite = np.hypot(*(modes[:, None] + modes[None, :]).T)
    return np.asarray(np.minimum(distance, opposite) < 1.5 * spacing)


def _local_maxima(candidates: _Candidates, gain: Floats) -> Floats:
    """Modes whose reduction exceeds that of all neighbours, the largest first."""
    maxima = np.flatnonzero(gain >= np.max(np.where(candidates.neighbours, gain[None, :], -np.inf), axis=1))
    return candidates.modes[maxima[np.argsort(-gain[maxima])]]
