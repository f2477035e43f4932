"""Equivalent stiffness of an exponential contact under large vibration, and the decay length from it."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive
from sonolube.errors import OutsideRange

_LARGEST = 1e6  # amplitude over decay length


def equivalent_stiffness_ratio(*, vibration_amplitude: ArrayLike, decay_length: ArrayLike) -> Floats:
    r"""Equivalent stiffness of a vibrating exponential contact over that at rest, by its describing function. []

    Parameters
    ----------
    vibration_amplitude : array_like, any shape
        Amplitude of the gap, zero to peak. [m]
    decay_length : array_like, broadcastable against `vibration_amplitude`
        Length over which the contact force falls by a factor of e. [m]

    Returns
    -------
    ndarray, broadcast shape

    Raises
    ------
    InvalidInput
        If an amplitude is negative or a decay length not positive.

    See Also
    --------
    decay_length_from_ratio : the inverse.

    Notes
    -----
    Under :math:`x = a\cos\theta` the mean gap rises so that the mean force stays the load,
    :math:`F = F_N e^{-\beta\cos\theta}/I_0(\beta)` with :math:`\beta = a/l`. The part of the force in phase with the
    motion is that of a spring of

    .. math:: \frac{k_{eq}}{k_n} = -\frac{1}{\pi a k_n}\oint F\cos\theta\,d\theta
              = \frac{2 I_1(\beta)}{\beta I_0(\beta)}, \qquad k_n = \frac{F_N}{l} ,

    which is :math:`1 - \beta^2/8` for small and :math:`2/\beta` for large amplitudes.

    Examples
    --------
    >>> from sonolube.measurement import equivalent_stiffness_ratio
    >>> ratio = equivalent_stiffness_ratio(vibration_amplitude=[0.2e-6, 2e-6], decay_length=2e-6)
    >>> ratio.round(3).tolist()  # 1 - beta^2/8, and 2 I1(1)/I0(1)
    [0.999, 0.893]
    """
    from scipy.special import i0e, i1e

    amplitude = require_non_negative(vibration_amplitude=vibration_amplitude)
    beta = amplitude / require_positive(decay_length=decay_length)
    safe = np.maximum(beta, 1e-8)
    return np.asarray(np.where(beta < 1e-8, 1.0, 2 * i1e(safe) / (safe * i0e(safe))))


def decay_length_from_ratio(stiffness_ratio: float, *, vibration_amplitude: float) -> float:
    """Decay length at which the equivalent stiffness under a vibration is a given fraction of that at rest. [m]

    Parameters
    ----------
    stiffness_ratio : float
        Equivalent stiffness at the large amplitude over that at a small one.
    vibration_amplitude : float
        Amplitude of the gap, zero to peak. [m]

    Returns
    -------
    float

    Raises
    ------
    OutsideRange
        If the ratio is not between 0 and 1: a contact whose force decays exponentially softens under vibration.

    Examples
    --------
    >>> from sonolube.measurement import decay_length_from_ratio, equivalent_stiffness_ratio
    >>> from sonolube.text.units import format_si
    >>> ratio = equivalent_stiffness_ratio(vibration_amplitude=2.5e-6, decay_length=2e-6)
    >>> format_si(decay_length_from_ratio(float(ratio), vibration_amplitude=2.5e-6), "m")
    '2 um'
    """
    from scipy.optimize import brentq

    amplitude = float(require_positive(vibration_amplitude=vibration_amplitude))
    if not 2 / _LARGEST < stiffness_ratio < 1 - 1e-9:
        raise OutsideRange(
            f"stiffness_ratio must lie between 0 and 1, got {stiffness_ratio:.4g}: vibration lowers the stiffness of a"
            " contact whose force decays exponentially; check which spectrum has the large drive"
        )

    def apart(log_beta: float) -> float:
        return (
            float(equivalent_stiffness_ratio(vibration_amplitude=np.exp(log_beta), decay_length=1.0)) - stiffness_ratio
        )

    return amplitude / float(np.exp(brentq(apart, np.log(1e-5), np.log(_LARGEST), xtol=1e-12)))


def log_ratio_slope(*, vibration_amplitude: float, decay_length: float) -> float:
    """Derivative of the logarithm of the equivalent stiffness ratio by that of amplitude over decay length. []

    Negative, from 0 for small to -1 for large amplitudes.
    """
    step = 1e-4
    ends = np.array([np.exp(step), np.exp(-step)]) * vibration_amplitude
    upper, lower = np.log(equivalent_stiffness_ratio(vibration_amplitude=ends, decay_length=decay_length))
    return float((upper - lower) / (2 * step))
