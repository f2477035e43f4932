"""Outliers of single pixels, by comparison with the median of their neighbours."""

import numpy as np
from scipy.ndimage import median_filter, uniform_filter

from sonolube.models.surfaces.form_removal import robust_deviation
from sonolube.models.surfaces.height_map import HeightMap

_DEVIATIONS = 8.0  # over the standard deviation of heights about the median of their neighbours
_COMMON = 4.0  # over the deviation that 2 % of the pixels exceed
_LEAST = 0.05  # of the range of heights: the kink of an edge is less


def without_outliers(surface: HeightMap) -> HeightMap:
    """Scan with outliers of one or two pixels as missing ones."""
    measured = surface.measured
    share = uniform_filter(measured.astype(np.float64), 5)
    mean = uniform_filter(np.where(measured, surface.height, 0.0), 5) / np.maximum(share, 0.01)
    filled = np.where(measured, surface.height, mean)
    deviation = np.abs(filled - median_filter(filled, 3))
    of_measured = deviation[measured]
    low, high = np.quantile(filled[measured], [0.005, 0.995])
    limit = max(
        _DEVIATIONS * robust_deviation(of_measured),
        _COMMON * float(np.quantile(of_measured, 0.98)),
        _LEAST * float(high - low),
    )
    outlying = measured & (deviation > limit)
    if not outlying.any() or outlying.sum() == measured.sum():
        return surface
    return surface.with_height(np.where(outlying, np.nan, surface.height))
