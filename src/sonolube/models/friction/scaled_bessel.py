"""Modified Bessel function I_0, exponentially scaled."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.execution.compilation import runs_plain

_LARGEST = 700.0  # beyond it exp overflows, and the asymptotic series holds to 1e-14
_SERIES = (3675 / 32768, 75 / 1024, 9 / 128, 1 / 8, 1.0)  # in 1/x, the highest power first
_FEW = 1000  # points for which numpy takes less than loading special functions


def scaled_bessel_i0(argument: ArrayLike) -> Floats:
    """exp(-x) I_0(x), to 1e-13."""
    x = np.asarray(argument, dtype=np.float64)
    if runs_plain(x.size, most=_FEW):
        below, above = np.minimum(x, _LARGEST), np.maximum(x, _LARGEST)
        series = np.polyval(_SERIES, 1 / above) / np.sqrt(2 * np.pi * above)
        return np.where(x > _LARGEST, series, (np.exp(-below) * np.i0(below)).reshape(x.shape))
    from scipy.special import i0e

    return np.asarray(i0e(x))
