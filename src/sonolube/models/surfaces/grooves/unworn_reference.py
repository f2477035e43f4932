"""Reference surface of a worn scan: form and waviness of the unworn pixels, extrapolated below the groove."""

import math
from dataclasses import dataclass, replace

import numpy as np

from sonolube.checks import Floats
from sonolube.models.surfaces.form_removal import fit_form
from sonolube.models.surfaces.grooves.blocks import BlockAverages, block_averages
from sonolube.models.surfaces.grooves.plane_coordinates import centred_coordinates
from sonolube.models.surfaces.grooves.plane_waves import PlaneWaveSearch
from sonolube.models.surfaces.grooves.random_field import fit_random_field
from sonolube.models.surfaces.grooves.track import GrooveTrack
from sonolube.models.surfaces.grooves.waviness_model import WavinessModel, model_probabilities
from sonolube.models.surfaces.height_map import HeightMap, Mask

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
