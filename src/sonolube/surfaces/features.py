"""Hills of a height map, told from mere bumps by Wolf pruning."""

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Floats, require_within
from sonolube.errors import InvalidInput
from sonolube.surfaces.grid_kernel import count_sum_and_extremes
from sonolube.surfaces.height_map import HeightMap


@dataclass(frozen=True, kw_only=True, slots=True)
class FeatureParameters:
    """The significant hills of a surface.

    Parameters
    ----------
    peak_density : float
        Hills per area, Spd; not the summit density of a contact model. [1/m2]
    mean_peak_curvature : float
        Mean of both principal curvatures at their peaks, on average, Spc. [1/m]
    """

    peak_density: float
    mean_peak_curvature: float


def feature_parameters(surface: HeightMap, *, pruning: float = 0.05) -> FeatureParameters:
    """Return Spd and Spc.

    Parameters
    ----------
    surface : HeightMap
        Filtered as wanted. Hills do not reach across missing pixels.
    pruning : float
        Least height of a significant hill over its highest saddle, as a share of the total height, from 0 to 1.

    Returns
    -------
    FeatureParameters

    Raises
    ------
    InvalidInput
        If the map is flat, or no peak has four measured neighbours.

    Notes
    -----
    The map is segmented into hills (watersheds). Where a hill stands less than 5 % of Sz above the saddle to a higher
    one it is merged with that one, the lowest hill first. What is left are a few hills a wavelength of the waviness
    apart: Spd may be fifty times below the density of summits, which counts every pixel above its eight neighbours,
    and falls when a single scratch raises Sz. A contact model wants `summits`, never this.

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
    bend_x = (2 * z[row, column] - z[row, column - 1] - z[row, column + 1]) / surface.spacing_x**2
    bend_y = (2 * z[row, column] - z[row - 1, column] - z[row + 1, column]) / surface.spacing_y**2
    curvature = (bend_x + bend_y)[np.isfinite(bend_x + bend_y)] / 2
    if curvature.size == 0:
        raise InvalidInput(f"none of {peaks.size} peaks has four measured neighbours, so their curvature is unknown")
    return FeatureParameters(
        peak_density=peaks.size / (count * surface.spacing_x * surface.spacing_y),
        mean_peak_curvature=float(curvature.mean()),
    )


def _significant_peaks(height: Floats, falling: NDArray[np.int64], least: float) -> NDArray[np.int64]:
    """Return the flat places of peaks that stand at least `least` above the saddle to a higher peak.

    A hill that missing pixels keep from all higher ones is measured from its foot.
    """
    z = height.ravel()
    hill = np.full(z.size, -1, dtype=np.int32)
    foot = np.empty(z.size)
    lasting = np.zeros(z.size, dtype=np.bool_)
    _let_water_fall(height, falling, least, hill, foot, lasting)
    alone = np.flatnonzero(hill == np.arange(z.size))
    lasting[alone] = z[alone] - foot[alone] >= least
    return np.flatnonzero(lasting)


@numba.njit(cache=True, nogil=True, error_model="numpy")
def _let_water_fall(
    height: Floats,
    falling: NDArray[np.int64],
    least: float,
    hill: NDArray[np.int32],
    foot: Floats,
    lasting: NDArray[np.bool_],
) -> None:
    """Write for each pixel one of the same hill nearer to its peak, for each peak its foot, and which peaks last.

    The water falls from the highest pixel down. One that emerges alone is a peak; one that joins two hills is their
    saddle, and the lower of both peaks then lasts or is lost.
    """
    rows, columns = height.shape
    z = height.ravel()
    for order in range(falling.size):
        place = falling[order]
        row, column = place // columns, place % columns
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
                    lasting[lower] = z[lower] - z[place] >= least
                    hill[lower] = higher
                    peak = higher
        if peak < 0:
            peak = place
        hill[place] = peak
        foot[peak] = z[place]


@numba.njit(cache=True, error_model="numpy")
def _peak_of(hill: NDArray[np.int32], place: int) -> int:
    """Return the peak of a pixel's hill, and shorten the way there for later."""
    while hill[place] != place:
        hill[place] = hill[hill[place]]
        place = hill[place]
    return place
