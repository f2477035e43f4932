"""Mean friction ratio of a normally vibrated contact by the direction of the relative velocity (kinematic model)."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.execution.compilation import kernel
from sonolube.models.contact.contact_motion import ContactMotion
from sonolube.models.contact.period_mean import richardson_period_mean
from sonolube.models.contact.rough import RoughContact
from sonolube.models.friction.models.model import FrictionModel, parameter

__all__ = ["Kinematic"]  # the period average serves the models of this room


@final
@dataclass(frozen=True, kw_only=True, slots=True)
class Kinematic(FrictionModel):
    r"""Constant friction along the resultant of sliding and vibration velocity.

    Parameters
    ----------
    amplitude_fraction : float
        Fraction of the vibration amplitude that enters; other values than 1 come from fits only. []

    Raises
    ------
    InvalidInput
        If the fraction is not positive.

    Notes
    -----
    .. math:: \frac{F_1}{F_0} = \left\langle \frac{v_r}{\sqrt{v_r^2 + v_1^2}} \right\rangle

    over a period, with the sliding speed v_r and the velocity v_1 along the normal. D 3.46 prints v_1, which passes
    through zero twice a period, below the fraction line; the resultant is meant.

    See Also
    --------
    sonolube.models.friction.models.dong_2015.Dong2015FullPeriod : The same, weighted with the stiffness of the cube.

    References
    ----------
    .. [1] D 3.46.
    """

    name: ClassVar[str] = "kinematic"
    citation: ClassVar[str] = "D 3.46, with the resultant velocity where v_1 is printed"

    needs_open_gap: ClassVar[bool] = False

    amplitude_fraction: float = parameter(1.0, positive=True)

    def _ratios(self, contact: RoughContact, motion: ContactMotion, v_r: Floats, mu: ArrayLike | None) -> Floats:
        """Ratio at positive speeds, shape (n,)."""
        return kinematic_mean(np.ones_like, motion, v_r, amplitude_fraction=self.amplitude_fraction)


def kinematic_mean(
    weight: Callable[[Floats], Floats], motion: ContactMotion, v_r: Floats, *, amplitude_fraction: float = 1.0
) -> Floats:
    r"""Period average of a weight times the kinematic factor at each speed, shape (n,). []

    .. math:: \langle w(x) \cos\theta \rangle, \qquad \cos\theta = \frac{v_r}{\sqrt{v_r^2 + v_1^2}}
    """

    def mean(sampled: ContactMotion) -> Floats:
        return _weighted_cosine(weight(sampled.displacement), amplitude_fraction * sampled.velocity, v_r)

    return richardson_period_mean(mean, motion)


@kernel(cache=True, no_cfunc_wrapper=True)
def _weighted_cosine(weights: Floats, velocity: Floats, speeds: Floats) -> Floats:
    """Mean of weight times v_r/sqrt(v_r^2 + v^2), both linear between samples, exactly for any v_r."""
    n = weights.size
    means = np.empty(speeds.size)
    for i in range(speeds.size):
        total = 0.0
        q = velocity[n - 1] / speeds[i]
        angle, length = np.arcsinh(q), np.sqrt(1 + q * q)
        for k in range(n):
            p, angle_before, length_before = q, angle, length
            q = velocity[k] / speeds[i]
            angle, length = np.arcsinh(q), np.sqrt(1 + q * q)
            w, rise, slope = weights[k - 1], weights[k] - weights[k - 1], q - p
            if abs(slope) > 1e-3:
                cosine = (angle - angle_before) / slope
                total += w * cosine + rise * ((length - length_before) / slope - p * cosine) / slope
            else:
                total += (w + rise / 2) / np.sqrt(1 + (p + q) ** 2 / 4)
        means[i] = total / n
    return means
