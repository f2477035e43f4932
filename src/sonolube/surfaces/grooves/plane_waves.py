"""Waviness below a groove as few plane waves, which pass it coherently."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sonolube.checks import Floats
from sonolube.surfaces.grooves.blocks import SHORTEST_RELATIVE_WAVELENGTH, BlockAverages
from sonolube.surfaces.grooves.waviness_model import WavinessModel

_MOST_WAVES = 4
_LONGEST = 3.0  # plane wave, over the longer side: longer ones are no waves to this field
_HIGHEST = 5.0  # amplitude of a plane wave over the spread of the unworn blocks: higher ones cancel each other
_NEWTON_ROUNDS = 15
_RESTED = 1e-4  # change of misfit, in variances of the noise
_FAINT = 1e-6  # noise over the spread of the unworn blocks: none
_EXACT = 1e-12
_UNLIKELY = 12.0  # cost above the least: a likelihood of 1/400
_DEVIATION_OVER_MEDIAN = 1.4826  # of Gaussian heights
_STARTS = 6  # hills of what a further wave would explain, from which it is refined


def fit_plane_waves(
    blocks: BlockAverages, *, noise: tuple[float, ...] | None = None, form_terms: int = 3
) -> tuple[list[WavinessModel], bool]:
    """Return sets of up to four plane waves of any direction and length, as many as the blocks bear out.

    Parameters
    ----------
    blocks : WornBlocks
    noise : tuple of float, optional
        Variance of unworn and of worn blocks, by which to weigh them, in m2; from neighbouring blocks where not given.
    form_terms : int
        3 for a plane below the waves, 6 for a form of second degree.

    Returns
    -------
    waves : list of Waves
        The likeliest set first, and others that are not much less likely.
    enough : bool
        Whether a further wave would explain nothing.
    """
    search = _Search.of(blocks, noise or _noise_of_neighbours(blocks), form_terms)
    candidates = blocks.modes()
    cosine, sine = search.seen(*search.waves(candidates))
    best = search.refined(np.empty((0, 2)))
    tried = [best]
    enough = False
    for _ in range(_MOST_WAVES + 1):
        gain = _explained(cosine, sine, best.rest) / float(np.mean(best.rest**2))
        enough = bool(gain.max() < 2 * math.log(best.rest.size))  # half of what a wave costs, for it may lie between
        if enough or len(best.modes) == _MOST_WAVES:
            break
        further = [search.refined(np.vstack([best.modes, hill])) for hill in _hills(candidates, gain)]
        tried += further
        likeliest = min(further, key=lambda fit: fit.cost)
        if likeliest.cost >= best.cost:
            break
        best = likeliest
    unlike = {round(fit.cost, 1): fit for fit in tried if fit.cost < best.cost + _UNLIKELY}
    return [search.as_waves(unlike[cost]) for cost in sorted(unlike)], enough


def _noise_of_neighbours(blocks: BlockAverages) -> tuple[float, ...]:
    """Return the variance of what does not go on from block to block, from third differences along the rows."""
    scale = (_DEVIATION_OVER_MEDIAN**2) / 20  # variance of the third difference of noise is 20 times its own
    differences = (np.diff(blocks.mean_height[part], 3) for part in blocks.parts)
    return tuple(
        max(scale * float(np.median(np.abs(part))) ** 2 if part.size else 0.0, (_FAINT * blocks.spread) ** 2)
        for part in differences
    )


class _Fit(NamedTuple):
    """Plane waves at the least misfit."""

    modes: Floats
    amplitudes: Floats  # cosines, sines
    rest: Floats
    cost: float


@dataclass(frozen=True, slots=True, eq=False)
class _Search:
    """The search for plane waves beside form and section, of which only what these cannot explain is seen."""

    blocks: BlockAverages
    form_terms: int
    root: Floats  # of the weights, (n, 1)
    flat: Floats  # form and section, weighted
    basis: Floats  # orthonormal, of the same space
    seen_height: Floats

    @classmethod
    def of(cls, blocks: BlockAverages, noise: tuple[float, ...], form_terms: int) -> "_Search":
        root = np.sqrt(blocks.weight / np.repeat(noise, [part.stop - part.start for part in blocks.parts]))[:, None]
        flat = root * np.concatenate([blocks.form(form_terms), blocks.section], axis=1)
        basis = np.linalg.qr(flat)[0]
        height = root[:, 0] * blocks.mean_height
        return cls(blocks, form_terms, root, flat, basis, height - basis @ (basis.T @ height))

    def waves(self, modes: Floats) -> tuple[Floats, Floats]:
        cosine, sine = self.blocks.waves(modes)
        return self.root * cosine, self.root * sine

    def seen(self, *columns: Floats) -> list[Floats]:
        return [column - self.basis @ (self.basis.T @ column) for column in columns]

    def slopes(self, cosine: Floats, sine: Floats, amplitudes: Floats) -> tuple[Floats, Floats]:
        """Return the change of the waves with their components along x and y, waves per metre."""
        c, s = amplitudes.reshape(2, -1)
        slope = 2 * math.pi * (s * cosine - c * sine)
        return self.blocks.x[:, None] * slope, self.blocks.y[:, None] * slope

    def refined(self, modes: Floats) -> _Fit:
        """Return the plane waves of least misfit near the given ones; of infinite cost where they run away."""
        amplitudes, rest, misfit = np.empty(0), self.seen_height, float(self.seen_height @ self.seen_height)
        for _ in range(_NEWTON_ROUNDS if len(modes) else 0):
            waves = self.waves(modes)
            seen = np.concatenate(self.seen(*waves), axis=1)
            amplitudes = _least_squares(seen, self.seen_height)
            rest = self.seen_height - seen @ amplitudes
            before, misfit = misfit, float(rest @ rest)
            if abs(before - misfit) < _RESTED:
                break
            slopes = self.seen(*self.slopes(*waves, amplitudes))
            shift = _least_squares(np.concatenate([seen, *slopes], axis=1), rest)[amplitudes.size :].reshape(2, -1).T
            furthest = 1 / (3 * self.blocks.longer_side)
            modes = modes + shift * np.minimum(1.0, furthest / np.maximum(np.hypot(*shift.T), _EXACT))[:, None]
        return _Fit(modes, amplitudes, rest, self._cost(modes, amplitudes, misfit))

    def _cost(self, modes: Floats, amplitudes: Floats, misfit: float) -> float:
        longer, wavenumber = self.blocks.longer_side, np.hypot(*modes.T)
        if (
            np.any(wavenumber > 1 / (SHORTEST_RELATIVE_WAVELENGTH * longer))
            or np.any(wavenumber < 1 / (_LONGEST * longer))
            or np.any(np.hypot(*amplitudes.reshape(2, -1)) > _HIGHEST * self.blocks.spread)
        ):
            return math.inf
        count = self.seen_height.size
        cost = count * math.log(max(misfit, _EXACT) / count) + count - float(np.sum(np.log(self.root[:, 0] ** 2)))
        return cost + float(np.sum(np.log(self.blocks.weight))) + (self.form_terms + 4 * len(modes)) * math.log(count)

    def as_waves(self, fit: _Fit) -> WavinessModel:
        waves = self.waves(fit.modes)
        sum_of_waves = np.concatenate(waves, axis=1) @ fit.amplitudes
        free = _least_squares(self.flat, self.root[:, 0] * self.blocks.mean_height - sum_of_waves)
        jacobian = np.concatenate([self.flat, *waves, *self.slopes(*waves, fit.amplitudes)], axis=1)
        size = np.maximum(np.linalg.norm(jacobian, axis=0), np.finfo(float).tiny)
        covariance = np.linalg.pinv((jacobian / size).T @ (jacobian / size)) / np.outer(size, size)
        covariance *= float(fit.rest @ fit.rest) / max(len(jacobian) - jacobian.shape[1], 1)
        kept = np.concatenate([np.arange(self.form_terms), np.arange(free.size, jacobian.shape[1])])
        cosine, sine = fit.amplitudes.reshape(2, -1)
        return WavinessModel(
            form=free[: self.form_terms],
            half_side=self.blocks.longer_side / 2,
            modes=fit.modes,
            cosine=cosine,
            sine=sine,
            section=free[self.form_terms :],
            covariance=covariance[np.ix_(kept, kept)],
            noise=(),
            cost=fit.cost,
            random=False,
        )


def _least_squares(design: Floats, z: Floats) -> Floats:
    size = np.linalg.norm(design, axis=0)
    size[size == 0] = 1.0
    scaled = design / size
    gram = scaled.T @ scaled
    return np.asarray(np.linalg.lstsq(gram, scaled.T @ z, rcond=_EXACT)[0] / size)


def _explained(cosine: Floats, sine: Floats, rest: Floats) -> Floats:
    """Return the squares that each pair of cosine and sine would take from what remains."""
    cc, ss, cs = np.sum(cosine**2, axis=0), np.sum(sine**2, axis=0), np.sum(cosine * sine, axis=0)
    a, b = cosine.T @ rest, sine.T @ rest
    return np.asarray((ss * a**2 - 2 * cs * a * b + cc * b**2) / np.maximum(cc * ss - cs**2, _EXACT * cc * ss))


def _hills(candidates: Floats, gain: Floats) -> Floats:
    """Return the modes that explain more than all their neighbours, the foremost of them."""
    spacing = np.min(
        np.ptp(candidates, axis=0) / np.maximum(np.array([len(np.unique(k)) - 1 for k in candidates.T]), 1)
    )
    distance = np.hypot(*(candidates[:, None] - candidates[None, :]).T)
    mirrored = np.hypot(*(candidates[:, None] + candidates[None, :]).T)
    near = np.minimum(distance, mirrored) < 1.5 * spacing
    summits = np.flatnonzero(gain >= np.max(np.where(near, gain[None, :], -np.inf), axis=1))
    return candidates[summits[np.argsort(-gain[summits])][:_STARTS]]
