"""Mean friction ratio by the cube model of Dong (2015): over a full period, the separating half, and load-balanced."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats
from sonolube.models.contact.contact_motion import ContactMotion, load_balanced_motion, require_open_gap
from sonolube.models.contact.cube import cube_tangential_stiffness
from sonolube.models.contact.period_mean import richardson_period_mean
from sonolube.models.contact.rough import RoughContact, separation
from sonolube.models.contact.separating_half_period import sampled_separating_mean
from sonolube.models.friction.models.kinematic import kinematic_mean
from sonolube.models.friction.models.model import FrictionModel, MeanGap


class _CubeModel(FrictionModel):
    """Friction as stiffness of the cube times the deformation at rest: an elastic force, below the limit of slip."""

    __slots__ = ()

    range_note: ClassVar[str] = (
        "the stiffness of the cube times the deformation at rest exceeds mu F_N, at which the contact slips; lower the"
        " amplitude or the sliding speed, or use asperity_stick_slip"
    )

    def ratio_bounds(self, *, mean_force_ratio: Floats) -> tuple[Floats, Floats]:
        """Lowest and the highest friction ratio that the model can mean: 0 and 1, no more than mu F_N. []

        Parameters
        ----------
        mean_force_ratio : ndarray, any shape
            Without effect in this model, whose deformation is that under the load at rest.

        Returns
        -------
        tuple of ndarray, each of the shape of `mean_force_ratio`
        """
        return np.zeros_like(mean_force_ratio), np.ones_like(mean_force_ratio)


@final
@dataclass(frozen=True, kw_only=True, slots=True)
class Dong2015FullPeriod(_CubeModel):
    r"""Stiffness of the cube times the kinematic factor, averaged over the full period, as the dissertation prints it.

    Notes
    -----
    .. math:: \frac{F_1}{F_0} = \left\langle \frac{k_t(d + x)}{k_t(d)} \frac{v_r}{\sqrt{v_r^2 + v_1^2}} \right\rangle

    The tangential deformation is that at rest, and the component of friction along the sliding direction is averaged.
    The stiffness of the cube is proportional to the square of the area, so that vibration about the separation at rest
    increases friction. Where the mean exceeds 1 the elastic force exceeds mu F_N, at which the contact slips; such
    ratios are the formula's, and `model_friction` withholds them.

    See Also
    --------
    Dong2015HalfPeriod : The cube over the separating half period, by which the printed tables were computed.
    Dong2015LoadBalanced : The same mean about the gap that balances the load.

    References
    ----------
    .. [1] D 3.46 to 3.48, with the resultant where 3.46 prints v_1, which passes through zero twice a period.
    """

    name: ClassVar[str] = "dong_2015_full_period"
    citation: ClassVar[str] = "D 3.46 to 3.48, about the mean at rest as printed"
    mean_gap: ClassVar[MeanGap] = MeanGap.AT_REST

    def _ratios(self, contact: RoughContact, motion: ContactMotion, v_r: Floats, mu: ArrayLike | None) -> Floats:
        """Ratio at positive speeds, shape (n,)."""
        return _full_period(contact, motion, v_r)


@final
@dataclass(frozen=True, kw_only=True, slots=True)
class Dong2015HalfPeriod(_CubeModel):
    r"""Stiffness of the cube averaged over the half period in which the gap is wider than at rest.

    Notes
    -----
    .. math:: \frac{F_1}{F_0} = \frac{2}{T} \int_{x > 0} \frac{k_t(d + x)}{k_t(d)} \, dt

    In the other half of the period the surfaces are assumed to stick. Speed and frequency have no effect.
    `dong_2015_half_period_ratio` returns the same for a sine about the separation at rest.

    See Also
    --------
    Dong2015FullPeriod : The mean over the full period with the kinematic factor.

    References
    ----------
    .. [1] D 3.15 with u = 0.
    """

    name: ClassVar[str] = "dong_2015_half_period"
    citation: ClassVar[str] = "D 3.15 with u = 0"
    mean_gap: ClassVar[MeanGap] = MeanGap.AT_REST
    rate_dependent: ClassVar[bool] = False

    def _ratios(self, contact: RoughContact, motion: ContactMotion, v_r: Floats, mu: ArrayLike | None) -> Floats:
        """Ratio at positive speeds, shape (n,)."""
        k_ratio = _stiffness_ratio(contact, separation(contact, normal_load=motion.normal_load))

        def mean(sampled: ContactMotion) -> Floats:
            return sampled_separating_mean(k_ratio, displacement=sampled.displacement)

        return np.full(v_r.shape, richardson_period_mean(mean, motion))


@final
@dataclass(frozen=True, kw_only=True, slots=True)
class Dong2015LoadBalanced(_CubeModel):
    """Stiffness of the cube times the kinematic factor, about the mean gap at which the mean force equals the load.

    Notes
    -----
    The mean of `Dong2015FullPeriod` under `sonolube.models.contact.load_balanced_motion`; the mean of the motion itself
    has no effect. The mean stiffness of the cube, proportional to the square of the area, is still larger than at rest.

    See Also
    --------
    Dong2015FullPeriod : The same about the mean at rest.

    References
    ----------
    .. [1] D 3.46 to 3.48.
    """

    name: ClassVar[str] = "dong_2015_load_balanced"
    citation: ClassVar[str] = "D 3.46 to 3.48, about the mean gap that balances the load"
    needs_open_gap: ClassVar[bool] = False  # of the motion given; `ratio` refuses one that closes the balanced gap

    def _ratios(self, contact: RoughContact, motion: ContactMotion, v_r: Floats, mu: ArrayLike | None) -> Floats:
        """Ratio at positive speeds, shape (n,)."""
        return _full_period(contact, load_balanced_motion(contact, motion), v_r)


def _full_period(contact: RoughContact, motion: ContactMotion, v_r: Floats) -> Floats:
    """Mean of the stiffness ratio of the cube times the kinematic factor over the full period. []"""
    k_ratio = _stiffness_ratio(contact, require_open_gap(contact, motion))
    return kinematic_mean(k_ratio, motion, v_r)


def _stiffness_ratio(contact: RoughContact, d: Floats) -> Callable[[Floats], Floats]:
    """Tangential stiffness over that at a separation, as a function of the displacement from it."""
    at_rest = cube_tangential_stiffness(contact, separation=d)
    return lambda x: cube_tangential_stiffness(contact, separation=d + x) / at_rest
