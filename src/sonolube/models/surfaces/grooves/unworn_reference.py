"""Reference surface of a worn scan: form and waviness of the unworn pixels, extrapolated below the groove.

Waviness of many waves is a Gaussian random field, its spectrum estimated by empirical Bayes (evidence maximisation).
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotri

from sonolube.checks import Floats
from sonolube.models.surfaces.form_removal import fit_form
from sonolube.models.surfaces.grooves.blocks import (
    HEIGHT_RESOLUTION,
    BlockAverages,
    WavinessModel,
    block_averages,
    model_probabilities,
)
from sonolube.models.surfaces.grooves.plane_waves import PlaneWaveSearch
from sonolube.models.surfaces.grooves.track import GrooveTrack, centred_coordinates
from sonolube.models.surfaces.height_map import HeightMap, Mask

_RINGS = 6  # of wavenumber, each with a spectral density of its own
_MAX_ITERATIONS = 40
_CONVERGED = 0.02  # change of the logarithm of a spectral density
_MIN_VARIANCE = 1e-10  # of a mode over that of the noise
_NEGLIGIBLE_VARIANCE = 1e-6  # variance of a mode over that of the noise, below which it need not converge
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
    parts = [_Part(blocks, design, part) for part in blocks.parts]
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
        if np.all(np.abs(np.log(density / previous))[previous > _NEGLIGIBLE_VARIANCE * noise[0]] < _CONVERGED):
            break
    misfit = sum(part.residual_sum(mean) / variance for part, variance in zip(parts, used_noise, strict=True))
    noises = sum(part.blocks * math.log(variance) for part, variance in zip(parts, used_noise, strict=True))
    cost = float(noises) + misfit + float(mean[free:] ** 2 @ prior - np.sum(np.log(prior)))
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


class _Part:
    """Normal equations of the unworn or the worn blocks for unit noise."""

    def __init__(self, blocks: BlockAverages, design: Floats, part: slice) -> None:
        weighted = blocks.weight[part, None] * design[part]
        z = blocks.mean_height[part]
        self.gram, self.moment = design[part].T @ weighted, weighted.T @ z
        self.square, self.blocks = float(blocks.weight[part] @ z**2), z.size

    def residual_sum(self, mean: Floats) -> float:
        """Weighted residual sum of squares for given coefficients."""
        return max(0.0, float(self.square - 2 * mean @ self.moment + mean @ self.gram @ mean))

    def variance(self, mean: Floats, used: float, scale: float) -> float:
        """Noise variance for given coefficients and effective number of parameters."""
        estimate = self.residual_sum(mean) / max(self.blocks - used, 1.0)
        return float(max(estimate, (_NEGLIGIBLE_VARIANCE * scale) ** 2, HEIGHT_RESOLUTION**2))


def _inverse(precision: Floats) -> Floats:
    """Inverse of a symmetric matrix, by Cholesky's factor unless rounding has made it indefinite."""
    factor, indefinite = dpotrf(precision, lower=True)
    if indefinite:
        return np.asarray(np.linalg.inv(precision))
    lower, _ = dpotri(factor, lower=True)
    inverse = lower + lower.T  # the upper part of either factor is zero
    np.fill_diagonal(inverse, np.diag(lower))
    return np.asarray(inverse)


_FORM_TERMS = 6  # a curvature that roughness hides is still there below the groove
_NEGLIGIBLE = 1e-3  # probability of a model
_HOPELESS = 60.0  # cost of the quickly found plane waves above that of the random field: a search is not worth it


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class UnwornReference:
    """Unworn reference surface: plane and mean of the waviness models, weighted by their evidence.

    Parameters
    ----------
    surface : HeightMap
        Heights of the reference everywhere in the field.
    models : list of WavinessModel
        Waviness models, the most probable first.
    blocks : BlockAverages
        Block averages of the scan to which the models were fitted.
    """

    surface: HeightMap
    models: list[WavinessModel]
    blocks: BlockAverages

    @property
    def waviness_height(self) -> float:
        """Standard deviation over the field of the waves of the most probable model. [m]"""
        x, y = centred_coordinates(self.surface)
        return float(np.std(self.models[0].heights(x, y) - self.models[0].form_alone(x, y)))

    def refined_track(self, track: GrooveTrack) -> GrooveTrack:
        """Track with direction and curvature corrected by the fit, so that one section fits along all of it."""
        section = self.models[0].section
        if not section.size:
            return track
        rotation, bending = (float(change) for change in section[-2:] / self.blocks.longer_side)
        curvature = track.track_curvature + bending / self.blocks.longer_side
        return replace(track, track_direction=track.track_direction + rotation, track_curvature=curvature)

    def groove_has_evidence(self) -> bool:
        """Whether a groove with a free section has greater evidence (BIC) than waviness alone."""
        wavy = _models(self.blocks.without_groove())[0]
        free_section = self.blocks.section.shape[1] * math.log(self.blocks.x.size)
        return bool(self.models[0].cost + free_section < wavy.cost)

    def pixel_weights(self, weights: Floats) -> Floats:
        """Derivatives of a weighted sum of the reference's heights with respect to the heights of the scan."""
        x, y = centred_coordinates(self.surface)
        probable = model_probabilities(self.models)
        of_blocks = sum(
            probability * (model.height_sum_gradient(x, y, weights) @ model.response)
            for probability, model in zip(probable, self.models, strict=True)
            if probability > _NEGLIGIBLE
        )
        return self.blocks.pixel_weights(np.asarray(of_blocks))

    def track_pixel_weights(self, lever: tuple[float, float]) -> Floats:
        """Derivatives of a distance from the track with respect to the heights of the scan."""
        response = self.models[0].section_response[-2:]
        longer = self.blocks.longer_side
        return self.blocks.pixel_weights(np.array([lever[0] / longer, lever[1] / longer**2]) @ response)

    def deviation_between_models(self, weights: Floats) -> float:
        """Standard deviation between the waviness models of a weighted sum of the reference's heights."""
        x, y = centred_coordinates(self.surface)
        probable = model_probabilities(self.models)
        total = np.array([model.height_sum(x, y, weights) for model in self.models])
        return math.sqrt(float(probable @ (total - probable @ total) ** 2))

    def random_part(self, surface: HeightMap) -> Floats:
        """Heights of a scan less what of the reference is not random: its form, and plane waves."""
        x, y = centred_coordinates(self.surface)
        model = self.models[0]
        waves = model.heights(x, y) - model.form_alone(x, y)
        return surface.height - self.surface.height + (waves if model.random else 0.0)


def unworn_reference(
    surface: HeightMap, *, track: GrooveTrack, worn_band: tuple[float, float], excluded: Mask | None = None
) -> UnwornReference:
    """Unworn reference surface of a scan with a groove, by Bayesian averaging of waviness models.

    Two kinds of waviness models are averaged with weights proportional to their evidence: up to four plane waves of any
    length above a sixth of the field, which extend coherently below the groove (`PlaneWaveSearch`), and a Gaussian
    random field (`fit_random_field`), whose part that the unworn pixels do not determine contributes to the
    uncertainty. Both are also fitted to the worn pixels: a groove of constant section hides only waves across it, so
    that variations along it are used, weighted by how constant the section is.

    Source: D. J. C. MacKay, Neural Comput. 4, 415 (1992). doi:10.1162/neco.1992.4.3.415
    """
    transverse, _ = track.curvilinear_coordinates(surface)
    unworn = (transverse <= worn_band[0]) | (transverse >= worn_band[1])
    plane = fit_form(surface, degree=1, reference=unworn if excluded is None else unworn & ~excluded).height
    flat = surface.with_height(surface.height - plane)
    blocks = block_averages(flat, track=track, worn_band=worn_band, excluded=excluded)
    models = _models(blocks)
    x, y = centred_coordinates(surface)
    waves = sum(weight * model.heights(x, y) for weight, model in zip(model_probabilities(models), models, strict=True))
    return UnwornReference(surface=surface.with_height(plane + waves), models=models, blocks=blocks)


def _models(blocks: BlockAverages) -> list[WavinessModel]:
    """Waviness models of the blocks, the most probable first; plane waves alone where they are sufficient."""
    search = PlaneWaveSearch(blocks, form_terms=_FORM_TERMS)
    if search.stepwise(starts=1).sufficient:
        waves = search.stepwise()
        if waves.sufficient:
            return search.models(waves)
    random = fit_random_field(blocks)
    found = [random]
    for terms in (3, 6):
        search = PlaneWaveSearch(blocks, noise=random.noise, form_terms=terms)
        if search.stepwise(starts=1).fits[0].cost < random.cost + _HOPELESS:
            found += search.models(search.stepwise())
    return sorted(found, key=lambda model: model.cost)
