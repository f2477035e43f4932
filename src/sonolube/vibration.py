"""Means over the half of a vibration's period in which the surfaces stand wider apart than at rest."""

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive

_NODES = 40  # 1e-12 for exponentials over up to a hundred decay lengths, and any amplitude below the separation
_BLOCK = 4096  # points whose samples together still fit a processor's cache


def separating_half_period_mean(
    value: Callable[[Floats], Floats], *, separation: ArrayLike, vibration_amplitude: ArrayLike
) -> Floats:
    """Return the mean of a quantity of the gap over the half period in which the displacement is positive.

    Parameters
    ----------
    value : callable
        Gives the quantity, elementwise, for an array of separations.
    separation : array_like
        Separation about which the surfaces vibrate. [m]
    vibration_amplitude : array_like, broadcast against `separation`
        Amplitude of the normal vibration. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        In the unit of the quantity.

    Raises
    ------
    InvalidInput
        If a separation is not positive, or an amplitude negative.

    Notes
    -----
    The separating half never closes the gap, whatever the amplitude; the other half does where the amplitude reaches
    the separation, unless the mean separation rises under vibration. The mean is taken about the separation given.
    """
    d, a = np.broadcast_arrays(
        require_positive(separation=separation), require_non_negative(vibration_amplitude=vibration_amplitude)
    )
    sines, weights = separating_half_period_rule()
    gaps, amplitudes, means = d.ravel(), a.ravel(), np.empty(d.size)
    for start in range(0, d.size, _BLOCK):
        block = slice(start, start + _BLOCK)
        means[block] = weights @ value(gaps[block] + np.multiply.outer(sines, amplitudes[block]))
    return means.reshape(d.shape)


@cache
def separating_half_period_rule() -> tuple[Floats, Floats]:
    """Return displacements over amplitude, and the weights with which to average over the separating half period.

    Returns
    -------
    sines, weights : ndarray
        Gauss-Legendre in the phase from rest to the peak, which the way back mirrors; the weights sum to 1.
    """
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    sines, weights = np.sin((nodes + 1) * np.pi / 4), weights / 2
    sines.flags.writeable = weights.flags.writeable = False  # shared by all callers
    return sines, weights
