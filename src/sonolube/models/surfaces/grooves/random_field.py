"""Waviness model of a Gaussian random field, its spectrum estimated by empirical Bayes (evidence maximisation)."""

import math
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotri

from sonolube.checks import Floats
from sonolube.models.surfaces.grooves.blocks import HEIGHT_RESOLUTION, BlockAverages
from sonolube.models.surfaces.grooves.waviness_model import WavinessModel

_RINGS = 6  # of wavenumber, each with a spectral density of its own
_MAX_ITERATIONS = 40
_CONVERGED = 0.02  # change of the logarithm of a spectral density
_MIN_VARIANCE = 1e-10  # of a mode over that of the noise
_NEGLIGIBLE = 1e-6  # variance of a mode over that of the noise, below which it need not converge
_VAGUE = 100.0  # variance of the square terms of the form over that of the blocks: a curvature is not shrunk
_ROUNDING = 1e-12


def fit_random_field(blocks: BlockAverages) -> WavinessModel:
    """Waviness model as the posterior mean of a Gaussian random field, with spectrum and noise of greatest evidence.

    The spectral density is constant over rings of wavenumber and estimated with the noise by MacKay's fixed-point
    iteration of the evidence

    Source: D. J. C. MacKay, Neural Comput. 4, 415 (1992). doi:10.1162/neco.1992.4.3.415
    """
    modes = blocks.modes()
    count, free = len(modes), 3 + blocks.section.shape[1]
    form = blocks.form(6)
    design = np.concatenate([form[:, :3], blocks.section, form[:, 3:], *blocks.fourier_waves], axis=1)
    parts = [_Part.of(blocks, design, part) for part in blocks.parts]
    wavenumber = np.hypot(*modes.T)
    ring = np.minimum((wavenumber / wavenumber.max() * _RINGS).astype(np.intp), _RINGS - 1)
    rings = np.concatenate([np.full(3, _RINGS), ring, ring])  # the square terms of the form are free
    scale = blocks.deviation
    density = np.full(_RINGS + 1, scale**2 / count)
    density[_RINGS] = _VAGUE * scale**2
    noise = np.array([part.square / part.blocks for part in parts])  # worn blocks may vary more: unworn ones dominate
    noise[0] = scale**2 / 10
    bound = np.arange(free, design.shape[1])
    for _ in range(_MAX_ITERATIONS):
        prior, pairs = 1 / density[rings], list(zip(parts, noise, strict=True))
        precision = sum(part.gram / variance for part, variance in pairs)
        precision[np.diag_indices(free)] *= 1 + _ROUNDING
        precision[bound, bound] += prior
        covariance = _inverse(precision)
        mean = covariance @ sum(part.moment / variance for part, variance in pairs)
        used_noise, previous = noise, density
        freedom = np.bincount(rings, 1 - prior * np.diag(covariance)[free:], minlength=_RINGS)
        power = np.bincount(rings, mean[free:] ** 2, minlength=_RINGS)
        density = np.maximum(power / np.maximum(freedom, 1e-9), _MIN_VARIANCE * noise[0])
        density[_RINGS] = _VAGUE * scale**2
        effective = [float(np.sum(covariance * part.gram)) / variance for part, variance in pairs]
        noise = np.array([part.variance(mean, used, scale) for part, used in zip(parts, effective, strict=True)])
        if np.all(np.abs(np.log(density / previous))[previous > _NEGLIGIBLE * noise[0]] < _CONVERGED):
            break
    misfit = sum(part.residual_sum(mean) / variance for part, variance in zip(parts, used_noise, strict=True))
    cost = _log_noise(parts, used_noise) + misfit + float(mean[free:] ** 2 @ prior - np.sum(np.log(prior)))
    cost += float(np.linalg.slogdet(precision)[1] - np.linalg.slogdet(precision[:free, :free])[1])
    kept = np.concatenate([np.arange(3), bound])
    response = covariance @ (design * (blocks.weight / blocks.per_part(used_noise))[:, None]).T
    return WavinessModel(
        form=mean[kept[:6]],
        half_side=blocks.longer_side / 2,
        modes=modes,
        cosine=mean[-2 * count : -count],
        sine=mean[-count:],
        section=mean[3:free],
        response=response[kept],
        section_response=response[3:free],
        noise=tuple(noise.tolist()),
        cost=cost,
        random=True,
    )


class _Part(NamedTuple):
    """Normal equations of the unworn or the worn blocks for unit noise."""

    gram: Floats
    moment: Floats
    square: float
    blocks: int

    @classmethod
    def of(cls, blocks: BlockAverages, design: Floats, part: slice) -> "_Part":
        """Normal equations of a slice of the blocks."""
        weighted = blocks.weight[part, None] * design[part]
        z = blocks.mean_height[part]
        return cls(design[part].T @ weighted, weighted.T @ z, float(blocks.weight[part] @ z**2), z.size)

    def residual_sum(self, mean: Floats) -> float:
        """Weighted residual sum of squares for given coefficients."""
        return max(0.0, float(self.square - 2 * mean @ self.moment + mean @ self.gram @ mean))

    def variance(self, mean: Floats, used: float, scale: float) -> float:
        """Noise variance for given coefficients and effective number of parameters."""
        estimate = self.residual_sum(mean) / max(self.blocks - used, 1.0)
        return float(max(estimate, (_NEGLIGIBLE * scale) ** 2, HEIGHT_RESOLUTION**2))


def _inverse(precision: Floats) -> Floats:
    """Inverse of a symmetric matrix, by Cholesky's factor unless rounding has made it indefinite."""
    factor, indefinite = dpotrf(precision, lower=True)
    if indefinite:
        return np.asarray(np.linalg.inv(precision))
    lower, _ = dpotri(factor, lower=True)
    inverse = lower + lower.T  # the upper part of either factor is zero
    np.fill_diagonal(inverse, np.diag(lower))
    return np.asarray(inverse)


def _log_noise(parts: list[_Part], noise: Floats) -> float:
    """Sum of the logarithms of the noise variances over all blocks."""
    return float(sum(part.blocks * math.log(variance) for part, variance in zip(parts, noise, strict=True)))
