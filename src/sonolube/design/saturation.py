"""Saturation power: amplifier power beyond which more of it reduces friction little."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative

SATURATION_GAIN = 0.05
"""Additional friction reduction per doubling of the power below which the reduction counts as saturated. []"""


def saturation_power(*, friction_reduction: ArrayLike, actuator_power: ArrayLike) -> Floats:
    r"""Power beyond which doubling it reduces friction by no more than another 0.05. [W]

    Parameters
    ----------
    friction_reduction : array_like, shape (..., n)
        Friction reduction at each power, NaN where it is unknown. []
    actuator_power : array_like, shape (n,)
        Amplifier powers, increasing. [W]

    Returns
    -------
    ndarray, shape (...)
        NaN where doubling gains more up to the last power, or gains less everywhere.

    Raises
    ------
    InvalidInput
        If a power is negative or not finite.

    Notes
    -----
    The largest root :math:`P` of

    .. math:: \mu_r(2P) - \mu_r(P) = 0.05

    with the friction reduction :math:`\mu_r` interpolated linearly over the power.

    Examples
    --------
    >>> import numpy as np
    >>> from sonolube.design import saturation_power
    >>> power = np.linspace(0, 10, 1001)
    >>> round(float(saturation_power(friction_reduction=1 - np.exp(-power), actuator_power=power)), 2)
    2.94
    """
    power = require_non_negative(actuator_power=actuator_power)
    rows = np.asarray(friction_reduction, dtype=np.float64)
    lower = np.unique(np.concatenate([power, power / 2]))
    lower = lower[(lower >= power[0]) & (2 * lower <= power[-1])]
    saturation = np.full(rows.shape[:-1], np.nan)
    for index in np.ndindex(saturation.shape):
        excess = np.interp(2 * lower, power, rows[index]) - np.interp(lower, power, rows[index]) - SATURATION_GAIN
        above = np.flatnonzero(excess > 0)
        if above.size and above[-1] + 1 < lower.size and np.isfinite(excess).all():
            last = int(above[-1])
            fraction = excess[last] / (excess[last] - excess[last + 1])
            saturation[index] = lower[last] + fraction * (lower[last + 1] - lower[last])
    return saturation
