"""Pixels of a scan that stand out of their neighbours, as optical profilometers leave them at steep or dirty places."""

import numpy as np
from scipy.ndimage import median_filter

from sonolube.checks import Floats
from sonolube.models.surfaces.height_map import HeightMap

_OF_NEIGHBOURS = 20.0  # robust deviations of the differences to the median of the neighbours
_OF_HEIGHTS = 5.0  # robust deviations of the heights


def spike_heights(surface: HeightMap) -> Floats:
    """Height of each spike above the median of its neighbours, 0 elsewhere.

    Parameters
    ----------
    surface : HeightMap

    Returns
    -------
    ndarray, shape of `surface.height`
        In m. A pixel is a spike where it differs from the median of the three by three pixels around it by more than 20
        times the robust standard deviation of such differences, and 5 times that of all heights: steps, edges and
        grooves are none.

    Notes
    -----
    Robust standard deviations are 1.4826 times the median absolute deviation.
    """
    height = np.where(np.isfinite(surface.height), surface.height, np.nanmedian(surface.height))
    apart = height - median_filter(height, 3 if 1 not in height.shape else [min(3, size) for size in height.shape])
    limit = max(_OF_NEIGHBOURS * _robust_deviation(apart), _OF_HEIGHTS * _robust_deviation(height))
    return np.asarray(np.where(np.abs(apart) > limit, apart, 0.0) if limit > 0 else np.zeros_like(apart))


def _robust_deviation(values: Floats) -> float:
    """Standard deviation by the median absolute deviation."""
    return 1.4826 * float(np.median(np.abs(values - np.median(values))))
