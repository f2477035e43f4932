"""Feature parameters of a height map after ISO 25178-2: hills by watershed segmentation with Wolf pruning."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats, require_within
from sonolube.errors import InvalidInput
from sonolube.execution.compilation import kernel
from sonolube.models.surfaces.grid_kernel import count_sum_and_extremes
from sonolube.models.surfaces.height_map import HeightMap


@dataclass(frozen=True, kw_only=True, slots=True)
class FeatureParameters:
    """Density and curvature of the significant peaks of a surface.

    Parameters
    ----------
    peak_density : float
        Density of peaks Spd: significant hills per area; not the summit density of a contact model. [1/m2]
    mean_peak_curvature : float
        Arithmetic mean peak curvature Spc: mean of both principal curvatures, averaged over the peaks. [1/m]
    """

    peak_density: float
    mean_peak_curvature: float


def feature_parameters(surface: HeightMap, *, pruning: float = 0.05) -> FeatureParameters:
    """Density of peaks Spd and arithmetic mean peak curvature Spc of ISO 25178-2, with Wolf pruning.

    Parameters
    ----------
    surface : HeightMap
        Scale-limited surface. Hills do not extend across missing pixels.
    pruning : float
        Wolf pruning threshold: least height of a significant hill above its highest saddle over the total height Sz,
        from 0 to 1.

    Returns
    -------
    FeatureParameters

    Raises
    ------
    InvalidInput
        If the map is flat, or no peak has four measured neighbours.

    Notes
    -----
    The map is segmented into hills by the watershed of the inverted surface. A hill whose peak is less than 5 % of Sz
    above the saddle to a higher hill is merged with it, the lowest first. The remaining hills are about a wavelength of
    the waviness apart: Spd can be fifty times below the density of summits, which counts every pixel above its eight
    neighbours, and it decreases when a single scratch raises Sz. A contact model requires
    `sonolube.models.surfaces.asperities.summit_statistics`, not Spd.

    References
    ----------
    .. [1] ISO 25178-2:2021, Geometrical product specifications, surface texture: areal, part 2.
    .. [2] G. W. Wolf, in: Advances in Geographic Information Systems (1991); P. J. Scott, Int. J. Mach. Tools Manuf.
       38, 559 (1998).
    """
    require_within(0.0, 1.0, pruning=pruning)
    z = np.ascontiguousarray(surface.height)
    count, _, lowest, highest = count_sum_and_extremes(z)
    if lowest == highest:
        raise InvalidInput(f"height must vary, got {lowest!r} m in every measured pixel: a flat map has no hills")
    peaks = _significant_peaks(z, np.argsort(-z, axis=None)[:count], pruning * (highest - lowest))
    row, column = np.divmod(peaks, z.shape[1])
    inside = (row > 0) & (row < z.shape[0] - 1) & (column > 0) & (column < z.shape[1] - 1)
    row, column = row[inside], column[inside]
    curvature_x = (2 * z[row, column] - z[row, column - 1] - z[row, column + 1]) / surface.spacing_x**2
    curvature_y = (2 * z[row, column] - z[row - 1, column] - z[row + 1, column]) / surface.spacing_y**2
    curvature = (curvature_x + curvature_y)[np.isfinite(curvature_x + curvature_y)] / 2
    if curvature.size == 0:
        raise InvalidInput(f"none of the {peaks.size} peaks has four measured neighbours, as their curvature requires")
    return FeatureParameters(
        peak_density=peaks.size / (count * surface.spacing_x * surface.spacing_y),
        mean_peak_curvature=float(curvature.mean()),
    )


def _significant_peaks(height: Floats, descending: NDArray[np.int64], least: float) -> NDArray[np.int64]:
    """Flat indices of the peaks at least `least` above the saddle to a higher peak.

    A hill that missing pixels separate from all higher ones is measured from its lowest pixel.
    """
    z = height.ravel()
    hill = np.full(z.size, -1, dtype=np.int32)
    foot = np.empty(z.size)
    significant = np.zeros(z.size, dtype=np.bool_)
    _watershed(height, descending, least, hill, foot, significant)
    unmerged = np.flatnonzero(hill == np.arange(z.size))
    significant[unmerged] = z[unmerged] - foot[unmerged] >= least
    return np.flatnonzero(significant)


@kernel(cache=True, nogil=True, error_model="numpy")
def _watershed(
    height: Floats,
    descending: NDArray[np.int64],
    least: float,
    hill: NDArray[np.int32],
    foot: Floats,
    significant: NDArray[np.bool_],
) -> None:
    """Segment the map into hills by union-find over the pixels in descending order of height.

    Writes the parent of each pixel in the tree of its hill, the lowest pixel of each peak's hill, and which peaks are
    significant. A pixel without a higher neighbour is a peak; one that joins two hills is their saddle, where the lower
    hill is merged into the higher one.
    """
    rows, columns = height.shape
    z = height.ravel()
    for order in range(descending.size):
        pixel = descending[order]
        row, column = pixel // columns, pixel % columns
        peak: int = -1
        for r in range(max(row - 1, 0), min(row + 2, rows)):
            for c in range(max(column - 1, 0), min(column + 2, columns)):
                if hill[r * columns + c] < 0:
                    continue
                other = _peak_of(hill, r * columns + c)
                if peak < 0:
                    peak = other
                elif other != peak:
                    higher, lower = (peak, other) if z[peak] >= z[other] else (other, peak)
                    significant[lower] = z[lower] - z[pixel] >= least
                    hill[lower] = higher
                    peak = higher
        if peak < 0:
            peak = pixel
        hill[pixel] = peak
        foot[peak] = z[pixel]


@kernel(cache=True, error_model="numpy")
def _peak_of(hill: NDArray[np.int32], pixel: int) -> int:
    """Peak of a pixel's hill: the root of its tree, with path halving."""
    while hill[pixel] != pixel:
        hill[pixel] = hill[hill[pixel]]
        pixel = hill[pixel]
    return pixel
