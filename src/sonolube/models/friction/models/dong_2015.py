"""Friction ratio by the cube model of Dong (2015): over a full period, the separating half, and load-balanced.

For any motion of the gap, and under a sine about the separation at rest.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import OutsideRange, warn_of_range
from sonolube.models.contact.contact_motion import ContactMotion, load_balanced_motion, require_open_gap
from sonolube.models.contact.period_mean import (
    richardson_period_mean,
    sampled_separating_mean,
    separating_half_period_mean,
    separating_half_period_quadrature,
)
from sonolube.models.contact.rough import RoughContact, separation
from sonolube.models.contact.tangential_stiffness import cube_tangential_stiffness
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


def dong_2015_half_period_ratio(
    contact: RoughContact, *, normal_load: ArrayLike, vibration_amplitude: ArrayLike
) -> Floats:
    r"""Friction ratio under sinusoidal normal vibration by the cube over the separating half period. []

    Parameters
    ----------
    contact : RoughContact
    normal_load : array_like
        Force pressing the bodies together. [N]
    vibration_amplitude : array_like, broadcast against `normal_load`
        Amplitude of the vibration along the surface normal. [m]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        1 without vibration, less with it.

    Raises
    ------
    InvalidInput
        If a load is not positive, or an amplitude negative.
    OutsideRange
        If no separation in the range of the height distribution carries a load, or no asperity is in contact.

    Notes
    -----
    .. math::

        \frac{F_1}{F_0} = \frac1\pi \int_0^\pi \frac{k_t(d + a \sin\theta)}{k_t(d)}\, \mathrm{d}\theta \tag{D 3.15}

    The average of the tangential stiffness over the half period in which the displacement is positive, over that at
    rest; the tangential deformation is constant and cancels. In the other half period the surfaces are assumed to
    stick. Speed and frequency have no effect in this model, and the load little.

    See Also
    --------
    Dong2015HalfPeriod : The same for any motion of the gap.

    References
    ----------
    .. [1] D 3.15 with u = 0.
    """
    d = separation(contact, normal_load=normal_load)
    at_rest = cube_tangential_stiffness(contact, separation=d)
    if np.any(at_rest == 0.0):
        raise OutsideRange(f"normal_load of {np.min(normal_load):.3g} N is too small: no asperity is in contact")
    mean = separating_half_period_mean(
        lambda gap: cube_tangential_stiffness(contact, separation=gap),
        separation=d,
        vibration_amplitude=vibration_amplitude,
    )
    return mean / at_rest


def dong_2015_deformation_ratio(
    contact: RoughContact,
    *,
    normal_load: ArrayLike,
    normal_amplitude: ArrayLike,
    in_plane_amplitude: ArrayLike,
    deformation: ArrayLike,
    phase: ArrayLike = np.pi / 2,
) -> Floats:
    r"""Friction ratio by the cube with the in-plane motion added to the deformation, as D prints it. []

    Parameters
    ----------
    contact : RoughContact
    normal_load : array_like
        Force pressing the bodies together. [N]
    normal_amplitude : array_like
        Amplitude of the vibration along the surface normal. [m]
    in_plane_amplitude : array_like
        Amplitude of the vibration along the sliding direction. [m]
    deformation : array_like
        Tangential deformation of the contact in steady sliding, by D 3.11 the friction force over the stiffness. [m]
    phase : array_like
        Lag of the normal motion behind the in-plane one; pi/2 as D prints it. [rad]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a load or deformation is not positive, an amplitude negative, or a value not finite.
    OutsideRange
        If no separation in the range of the height distribution carries a load.

    Warns
    -----
    ModelRangeWarning
        If an in-plane amplitude exceeds the deformation, beyond which the contact slides.

    Notes
    -----
    .. math:: \frac{F_1}{F_0} = \frac2T \int_{T/2} \frac{k_t(d + v)}{k_t(d)}\, \frac{\delta + u}{\delta}\, \mathrm{d}t

    With the printed phase the contributions of the in-plane motion u in the two quarters of the half period cancel.
    In-plane vibration that enters the relative velocity has an effect: `dahl_under_vibration`.

    References
    ----------
    .. [1] D 3.12 and 3.15.
    """
    delta = require_positive(deformation=deformation)
    u_peak = require_non_negative(in_plane_amplitude=in_plane_amplitude)
    lag = require_finite(phase=phase)
    if np.any(u_peak > delta):
        warn_of_range(
            f"in_plane_amplitude of up to {np.max(u_peak):.3g} m is added to a deformation of {np.min(delta):.3g} m,"
            " beyond which the contact slides; use dahl_under_vibration"
        )
    d, v_peak = np.broadcast_arrays(
        require_positive(separation=separation(contact, normal_load=normal_load)),
        require_non_negative(normal_amplitude=normal_amplitude),
    )
    sines, weights = separating_half_period_quadrature()
    d, v_peak, strain = (array[..., np.newaxis] for array in (d, v_peak, u_peak * np.cos(lag) / delta))
    at_rest = cube_tangential_stiffness(contact, separation=d)
    k_ratio = cube_tangential_stiffness(contact, separation=d + v_peak * sines) / at_rest
    # of u/delta = (u_peak/delta) sin(theta + phase) the part with cos(theta) is odd about the peak and averages out
    return k_ratio * (1 + strain * sines) @ weights  # D 3.15
