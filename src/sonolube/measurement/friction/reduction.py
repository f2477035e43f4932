"""Friction reduction between two parts of a recording, with its uncertainty."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.facts.metrics import friction_reduction
from sonolube.measurement.statistics.autocorrelation import correlated_mean


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionReductionEstimate:
    """Friction reduction by vibration and the mean forces it follows from, each with its uncertainty.

    Parameters
    ----------
    friction_reduction : float
        Reduction relative to the intrinsic friction force. []
    friction_reduction_uncertainty : float
        Its standard uncertainty. []
    intrinsic_friction_force : float
        Mean without vibration. [N]
    intrinsic_friction_force_uncertainty : float
        Its standard error. [N]
    reduced_friction_force : float
        Mean with vibration. [N]
    reduced_friction_force_uncertainty : float
        Its standard error. [N]
    """

    friction_reduction: float
    friction_reduction_uncertainty: float
    intrinsic_friction_force: float
    intrinsic_friction_force_uncertainty: float
    reduced_friction_force: float
    reduced_friction_force_uncertainty: float


def estimate_friction_reduction(
    *, intrinsic_friction_force: ArrayLike, reduced_friction_force: ArrayLike
) -> FrictionReductionEstimate:
    r"""Friction reduction between two parts of a recording, with first-order uncertainty propagation.

    Parameters
    ----------
    intrinsic_friction_force : array_like, shape (samples,)
        Evenly spaced samples without vibration; NaN is left out. [N]
    reduced_friction_force : array_like, shape (samples,)
        Evenly spaced samples with vibration; NaN is left out. [N]

    Returns
    -------
    FrictionReductionEstimate

    Raises
    ------
    InvalidInput
        If a part holds fewer than two values, or the mean without vibration is not positive.

    See Also
    --------
    ratio_interval : Fieller's interval of the ratio of independent tests, without linearisation.

    Notes
    -----
    With the means :math:`F_0` and :math:`F_1` and their standard errors, which account for autocorrelation,

    .. math::

        P_f = 1 - \frac{F_1}{F_0} , \qquad
        u_P^2 = \left( \frac{u_1}{F_0} \right)^2 + \left( \frac{F_1 u_0}{F_0^2} \right)^2 .

    The linearisation holds while :math:`u_0/F_0` is below a tenth.

    References
    ----------
    .. [1] D 2.1.
    """
    off, on = correlated_mean(intrinsic_friction_force), correlated_mean(reduced_friction_force)
    reduction = friction_reduction(intrinsic_friction_force=off.mean, reduced_friction_force=on.mean)
    uncertainty = np.hypot(on.uncertainty / off.mean, on.mean * off.uncertainty / off.mean**2)
    return FrictionReductionEstimate(
        friction_reduction=float(reduction),
        friction_reduction_uncertainty=float(uncertainty),
        intrinsic_friction_force=off.mean,
        intrinsic_friction_force_uncertainty=off.uncertainty,
        reduced_friction_force=on.mean,
        reduced_friction_force_uncertainty=on.uncertainty,
    )
