"""The surface as it was before it wore, carried on from where it is unworn to where it is not."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.surfaces.form_removal import fit_form
from sonolube.surfaces.grooves.blocks import BlockAverages, block_averages
from sonolube.surfaces.grooves.plane_coordinates import centred_coordinates
from sonolube.surfaces.grooves.plane_waves import fit_plane_waves
from sonolube.surfaces.grooves.random_field import fit_random_field
from sonolube.surfaces.grooves.track import GrooveTrack
from sonolube.surfaces.grooves.waviness_model import WavinessModel, model_probabilities
from sonolube.surfaces.height_map import HeightMap

Mask = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class UnwornReference:
    """A plane and waves through the unworn pixels, carried on below the worn ones.

    Parameters
    ----------
    surface : HeightMap
        Their heights, everywhere in the field.
    models : list of Waves
        What they may be made of beside a plane, the likeliest first: the surface is the mean of them.
    blocks : WornBlocks
        The scan in blocks, to which they were fitted.
    """

    surface: HeightMap
    models: list[WavinessModel]
    blocks: BlockAverages

    @property
    def waviness_height(self) -> float:
        """Standard deviation of the likeliest waves over the field. [m]"""
        x, y = centred_coordinates(self.surface)
        return float(np.std(self.models[0].heights(x, y) - self.models[0].form_alone(x, y)))

    def better_track(self, track: GrooveTrack) -> GrooveTrack:
        """Return the track turned and bent so that one section fits all along it.

        Parameters
        ----------
        track : GrooveTrack
            The one to which the reference was fitted.

        Returns
        -------
        GrooveTrack
        """
        section = self.models[0].section
        if not section.size:
            return track
        turn, bend = (float(change) for change in section[-2:] / self.blocks.longer_side)
        return GrooveTrack(
            track_direction=track.track_direction + turn,
            track_curvature=track.track_curvature + bend / self.blocks.longer_side,
            track_offset=track.track_offset,
        )

    def groove_is_borne_out(self) -> bool:
        """Return whether heights are likelier with a groove of free section than as waves alone."""
        wavy = _models(self.blocks.without_groove())[0]
        free_section = self.blocks.section.shape[1] * math.log(self.blocks.x.size)
        return bool(self.models[0].cost + free_section < wavy.cost)

    def volume_uncertainty(self, region: Mask) -> float:
        """Return the standard uncertainty of the volume between reference and surface over some pixels.

        Parameters
        ----------
        region : bool array, shape of the heights

        Returns
        -------
        float
            In m3: what each model leaves open, and how far the models differ.
        """
        x, y = centred_coordinates(self.surface)
        weight = model_probabilities(self.models)
        volume = np.array([float(model.heights(x, y)[region].sum()) for model in self.models])
        sums = [model.sums(x, y, region) for model in self.models]
        own = np.array([float(s @ model.covariance @ s) for s, model in zip(sums, self.models, strict=True)])
        variance = float(weight @ (np.maximum(own, 0.0) + (volume - weight @ volume) ** 2))
        return math.sqrt(variance) * self.surface.spacing_x * self.surface.spacing_y


def unworn_reference(
    surface: HeightMap, *, track: GrooveTrack, worn_band: tuple[float, float], left_out: Mask | None = None
) -> UnwornReference:
    """Fit a plane and waves to what a groove has left of a surface.

    Parameters
    ----------
    surface : HeightMap
    track : GrooveTrack
        Of the groove.
    worn_band : tuple of float
        Between which distances from it the surface is worn or piled up, in m.
    left_out : bool array, shape of the heights, optional
        Pixels that count for neither, such as debris.

    Returns
    -------
    UnwornReference

    Raises
    ------
    InvalidInput
        If too little of the unworn surface is left to decide a plane.

    Notes
    -----
    Two kinds of model compete, and the mean of them is taken, weighed by evidence: up to four plane waves of any
    length above a sixth of the field, which reach coherently below the groove; or a random field, its spectrum
    constant over rings of wavenumber and told from the data, of which the part that the unworn pixels do not decide
    goes into the uncertainty. Both also see the worn pixels: a groove of even section hides waves across it only, so
    what varies along it counts, weighed by how even it is.

    References
    ----------
    .. [1] D. J. C. MacKay, Neural Comput. 4, 415 (1992). doi:10.1162/neco.1992.4.3.415
    """
    across, _ = track.curvilinear_coordinates(surface)
    unworn = (across <= worn_band[0]) | (across >= worn_band[1])
    plane = fit_form(surface, degree=1, reference=unworn if left_out is None else unworn & ~left_out).height
    blocks = block_averages(
        surface.with_height(surface.height - plane), track=track, worn_band=worn_band, left_out=left_out
    )
    models = _models(blocks)
    x, y = centred_coordinates(surface)
    waves = sum(weight * model.heights(x, y) for weight, model in zip(model_probabilities(models), models, strict=True))
    return UnwornReference(surface=surface.with_height(plane + waves), models=models, blocks=blocks)


def _models(blocks: BlockAverages) -> list[WavinessModel]:
    few, enough = fit_plane_waves(blocks)
    if enough:
        return few
    random = fit_random_field(blocks)
    found = [random]
    for terms in (3, 6):
        found += fit_plane_waves(blocks, noise=random.noise, form_terms=terms)[0]
    return sorted(found, key=lambda model: model.cost)
