"""Means over the half of a vibration's period in which the surfaces stand wider apart than at rest."""

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive

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


def separating_mean(value: Callable[[Floats], Floats], *, displacement: ArrayLike) -> Floats:
    """Return the mean of a quantity over the part of a sampled period in which the displacement is positive.

    Parameters
    ----------
    value : callable
        Gives the quantity, elementwise, for an array of displacements.
    displacement : array_like, shape (n,)
        Displacement from rest at uniform phases of one period. [m]

    Returns
    -------
    ndarray, shape ()
        In the unit of the quantity; its value at rest if the displacement is never positive.

    Raises
    ------
    InvalidInput
        If a displacement is not finite.

    Notes
    -----
    Displacement and quantity are taken as linear between samples, so that the error falls with the square of their
    distance.
    """
    x = require_finite(displacement=displacement)
    before, values = np.roll(x, 1), value(np.maximum(x, 0.0))  # the rest of the period does not count
    values_before = np.roll(values, 1)
    rise = np.maximum(x, before) - np.minimum(x, before)
    share = np.clip(np.maximum(x, before) / np.where(rise > 0, rise, 1.0), 0.0, 1.0)  # of the step spent above rest
    share = np.where(rise > 0, share, np.where(x > 0, 1.0, 0.0))
    above, below = np.where(x > before, values, values_before), np.where(x > before, values_before, values)
    means = above + (below - above) * share / 2
    time = np.sum(share)
    return np.asarray(np.sum(share * means) / time if time > 0 else value(np.zeros(1))[0])


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
