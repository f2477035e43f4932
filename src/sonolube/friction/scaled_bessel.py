"""Modified Bessel function I_0, exponentially scaled."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.compilation import runs_plain

_LARGEST = 700.0  # beyond it exp overflows


def scaled_bessel_i0(argument: ArrayLike) -> Floats:
    """Return exp(-x) I_0(x), to 1e-13.

    Parameters
    ----------
    argument : array_like, any shape
        x, not negative.

    Returns
    -------
    ndarray, shape of `argument`
    """
    x = np.asarray(argument, dtype=np.float64)
    if runs_plain(x.size) and not np.any(x > _LARGEST):
        return np.asarray(np.exp(-x) * np.i0(x)).reshape(x.shape)
    from scipy.special import i0e

    return np.asarray(i0e(x))
