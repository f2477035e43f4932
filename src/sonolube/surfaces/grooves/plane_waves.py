"""Waviness models of a few plane waves, by stepwise nonlinear least squares and the Bayesian information criterion."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sonolube.checks import Floats
from sonolube.surfaces.grooves.blocks import SHORTEST_RELATIVE_WAVELENGTH, BlockAverages
from sonolube.surfaces.grooves.waviness_model import WavinessModel

_MOST_WAVES = 4
_LONGEST = 3.0  # wavelength over the longer side: longer ones are form
_HIGHEST = 5.0  # amplitude over the standard deviation of the unworn blocks: higher waves cancel each other
_NEWTON_STEPS = 15
_CONVERGED = 1e-4  # change of the misfit, in variances of the noise
_LEAST_NOISE = 1e-6  # over the standard deviation of the unworn blocks
_ROUNDING = 1e-12
_IMPROBABLE = 12.0  # cost above the least: a likelihood ratio of 1/400
_DEVIATION_OVER_MEDIAN = 1.4826  # standard deviation over median absolute deviation of Gaussian heights
_STARTS = 6  # local maxima of the explained misfit from which a further wave is refined, by default


def fit_plane_waves(
    blocks: BlockAverages, *, noise: tuple[float, ...] | None = None, form_terms: int = 3, starts: int = _STARTS
) -> tuple[list[WavinessModel], bool]:
    """Waviness models of up to four plane waves of any direction and length, with the number chosen by evidence.

    Parameters
    ----------
    blocks : BlockAverages
    noise : tuple of float, optional
        Variances of unworn and of worn blocks in m2, by which to weigh them; estimated from neighbouring blocks by
        default.
    form_terms : int
        Terms of the form: 3 for a plane, 6 for a form of second degree.
    starts : int
        Local maxima of the explained misfit from which each further wave is refined.

    Returns
    -------
    models : list of WavinessModel
        The most probable model first, then those not much less probable.
    sufficient : bool
        Whether a further wave would not reduce the misfit significantly.

    Notes
    -----
    Waves are added one by one. Each starts from the Fourier modes that reduce the misfit most, and all wavenumbers and
    amplitudes are refined together by Gauss-Newton steps. A wave is kept if it lowers the Bayesian information
    criterion, in which it counts four parameters.
    """
    search = _Search.of(blocks, noise or _noise_of_neighbours(blocks), form_terms)
    candidates = blocks.modes()
    cosine, sine = search.projected(*search.waves(candidates))
    best = search.refined(np.empty((0, 2)))
    fits = [best]
    sufficient = False
    for _ in range(_MOST_WAVES + 1):
        gain = _misfit_reduction(cosine, sine, best.residual) / float(np.mean(best.residual**2))
        # half of what a wave costs, for the best one may lie between two modes
        sufficient = bool(gain.max() < 2 * math.log(best.residual.size))
        if sufficient or len(best.modes) == _MOST_WAVES:
            break
        extended = [search.refined(np.vstack([best.modes, mode])) for mode in _local_maxima(candidates, gain)[:starts]]
        fits += extended
        most_probable = min(extended, key=lambda fit: fit.cost)
        if most_probable.cost >= best.cost:
            break
        best = most_probable
    distinct = {round(fit.cost, 1): fit for fit in fits if fit.cost < best.cost + _IMPROBABLE}
    return [search.model(distinct[cost]) for cost in sorted(distinct)], sufficient


def _noise_of_neighbours(blocks: BlockAverages) -> tuple[float, ...]:
    """Variances in m2 of the noise of unworn and worn blocks, from third differences along the rows."""
    scale = (_DEVIATION_OVER_MEDIAN**2) / 20  # variance of the third difference of noise is 20 times its own
    differences = (np.diff(blocks.mean_height[part], 3) for part in blocks.parts)
    return tuple(
        max(scale * float(np.median(np.abs(part))) ** 2 if part.size else 0.0, (_LEAST_NOISE * blocks.deviation) ** 2)
        for part in differences
    )


class _Fit(NamedTuple):
    """Plane waves of least misfit."""

    modes: Floats
    amplitudes: Floats  # cosines, sines
    residual: Floats
    cost: float


@dataclass(frozen=True, slots=True, eq=False)
class _Search:
    """Fits of plane waves to weighted blocks, with form and section eliminated by projection (variable projection)."""

    blocks: BlockAverages
    form_terms: int
    root: Floats  # of the weights, (n, 1)
    linear: Floats  # form and section, weighted
    basis: Floats  # orthonormal basis of the same space
    projected_height: Floats

    @classmethod
    def of(cls, blocks: BlockAverages, noise: tuple[float, ...], form_terms: int) -> "_Search":
        """Search with the blocks weighted by their noise."""
        root = np.sqrt(blocks.weight / blocks.per_part(noise))[:, None]
        linear = root * np.concatenate([blocks.form(form_terms), blocks.section], axis=1)
        basis = np.linalg.qr(linear)[0]
        height = root[:, 0] * blocks.mean_height
        return cls(blocks, form_terms, root, linear, basis, height - basis @ (basis.T @ height))

    def waves(self, modes: Floats) -> tuple[Floats, Floats]:
        """Weighted cosine and sine of each mode at each block."""
        cosine, sine = self.blocks.waves(modes)
        return self.root * cosine, self.root * sine

    def projected(self, *columns: Floats) -> list[Floats]:
        """Columns less their projection on form and section."""
        return [column - self.basis @ (self.basis.T @ column) for column in columns]

    def derivatives(self, cosine: Floats, sine: Floats, amplitudes: Floats) -> tuple[Floats, Floats]:
        """Derivatives of the waves with respect to their wavenumbers along x and along y."""
        c, s = amplitudes.reshape(2, -1)
        by_phase = 2 * math.pi * (s * cosine - c * sine)
        return self.blocks.x[:, None] * by_phase, self.blocks.y[:, None] * by_phase

    def refined(self, modes: Floats) -> _Fit:
        """Plane waves of least misfit near the given ones by Gauss-Newton steps; infinite cost where these diverge."""
        amplitudes, residual = np.empty(0), self.projected_height
        misfit = float(residual @ residual)
        for _ in range(_NEWTON_STEPS if len(modes) else 0):
            waves = self.waves(modes)
            columns = np.concatenate(self.projected(*waves), axis=1)
            amplitudes = _least_squares(columns, self.projected_height)
            residual = self.projected_height - columns @ amplitudes
            previous, misfit = misfit, float(residual @ residual)
            if abs(previous - misfit) < _CONVERGED:
                break
            derivatives = self.projected(*self.derivatives(*waves, amplitudes))
            jacobian = np.concatenate([columns, *derivatives], axis=1)
            step = _least_squares(jacobian, residual)[amplitudes.size :].reshape(2, -1).T
            longest_step = 1 / (3 * self.blocks.longer_side)
            modes = modes + step * np.minimum(1.0, longest_step / np.maximum(np.hypot(*step.T), _ROUNDING))[:, None]
        return _Fit(modes, amplitudes, residual, self._cost(modes, amplitudes, misfit))

    def _cost(self, modes: Floats, amplitudes: Floats, misfit: float) -> float:
        """Bayesian information criterion, up to a constant; infinite for waves out of range."""
        longer, wavenumber = self.blocks.longer_side, np.hypot(*modes.T)
        if (
            np.any(wavenumber > 1 / (SHORTEST_RELATIVE_WAVELENGTH * longer))
            or np.any(wavenumber < 1 / (_LONGEST * longer))
            or np.any(np.hypot(*amplitudes.reshape(2, -1)) > _HIGHEST * self.blocks.deviation)
        ):
            return math.inf
        count = self.projected_height.size
        cost = count * math.log(max(misfit, _ROUNDING) / count) + count - float(np.sum(np.log(self.root[:, 0] ** 2)))
        return cost + float(np.sum(np.log(self.blocks.weight))) + (self.form_terms + 4 * len(modes)) * math.log(count)

    def model(self, fit: _Fit) -> WavinessModel:
        """Waviness model of a fit, with form, section and response."""
        waves = self.waves(fit.modes)
        sum_of_waves = np.concatenate(waves, axis=1) @ fit.amplitudes
        linear = _least_squares(self.linear, self.root[:, 0] * self.blocks.mean_height - sum_of_waves)
        jacobian = np.concatenate([self.linear, *waves, *self.derivatives(*waves, fit.amplitudes)], axis=1)
        size = np.maximum(np.linalg.norm(jacobian, axis=0), np.finfo(float).tiny)
        inverse = np.linalg.pinv((jacobian / size).T @ (jacobian / size)) / np.outer(size, size)
        kept = np.concatenate([np.arange(self.form_terms), np.arange(linear.size, jacobian.shape[1])])
        response = inverse @ (self.root * jacobian).T
        cosine, sine = fit.amplitudes.reshape(2, -1)
        return WavinessModel(
            form=linear[: self.form_terms],
            half_side=self.blocks.longer_side / 2,
            modes=fit.modes,
            cosine=cosine,
            sine=sine,
            section=linear[self.form_terms :],
            response=response[kept],
            section_response=response[self.form_terms : linear.size],
            noise=(),
            cost=fit.cost,
            random=False,
        )


def _least_squares(design: Floats, z: Floats) -> Floats:
    """Least-squares coefficients by the normal equations with scaled columns, of least norm where they are singular."""
    size = np.linalg.norm(design, axis=0)
    size[size == 0] = 1.0
    scaled = design / size
    gram = scaled.T @ scaled
    return np.asarray(np.linalg.lstsq(gram, scaled.T @ z, rcond=_ROUNDING)[0] / size)


def _misfit_reduction(cosine: Floats, sine: Floats, residual: Floats) -> Floats:
    """Reduction of the residual sum of squares by each pair of cosine and sine."""
    cc, ss, cs = np.sum(cosine**2, axis=0), np.sum(sine**2, axis=0), np.sum(cosine * sine, axis=0)
    a, b = cosine.T @ residual, sine.T @ residual
    return np.asarray((ss * a**2 - 2 * cs * a * b + cc * b**2) / np.maximum(cc * ss - cs**2, _ROUNDING * cc * ss))


def _local_maxima(candidates: Floats, gain: Floats) -> Floats:
    """Modes whose reduction exceeds that of all neighbours, the largest first."""
    spacing = np.min(np.ptp(candidates, axis=0) / np.maximum([len(np.unique(k)) - 1 for k in candidates.T], 1))
    distance = np.hypot(*(candidates[:, None] - candidates[None, :]).T)
    opposite = np.hypot(*(candidates[:, None] + candidates[None, :]).T)
    near = np.minimum(distance, opposite) < 1.5 * spacing
    maxima = np.flatnonzero(gain >= np.max(np.where(near, gain[None, :], -np.inf), axis=1))
    return candidates[maxima[np.argsort(-gain[maxima])]]
