"""Mean friction ratio of a normally vibrated contact by stick-slip of its asperities."""

from dataclasses import dataclass
from math import cos, exp, pi, sin
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, Integers, require_positive
from sonolube.compilation import INNER, kernel
from sonolube.contact.gap_motion import (
    GapMotion,
    GapMotionBatch,
    delayed_oscillation,
    gap_harmonics,
    richardson_period_mean,
)
from sonolube.contact.height_distribution import ExponentialHeights
from sonolube.contact.rough import RoughContact, decay_length, separation
from sonolube.friction.models.asperity_stick_slip_batch import batched_stick_slip_ratio
from sonolube.friction.models.asperity_stick_slip_sine import EMPIRICAL_MEMORY_LENGTH
from sonolube.friction.models.model import FrictionModel, parameter

_HEIGHTS = np.polynomial.legendre.leggauss(64)
_LONGEST_PERIOD = 8192  # phases of a motion whose harmonics are worth a try
_NEGLIGIBLE = 40.0  # exponent beyond which the load of elements is negligible


@final
@dataclass(frozen=True, kw_only=True, slots=True)
class AsperityStickSlip(FrictionModel):
    r"""Stick-slip of independent asperities, whose tangential force restarts from zero at every contact.

    Parameters
    ----------
    memory_length : float
        Sliding distance D_c in which an asperity pressed by one decay length reaches its friction limit. The default
        is the fitted `EMPIRICAL_MEMORY_LENGTH`; without fit use `mindlin_memory_length`. [m]
    in_plane_fraction : float
        Amplitude along the sliding direction over that along the normal. []
    in_plane_phase : float
        Lag of the in-plane motion behind the normal one. [rad]

    Raises
    ------
    InvalidInput
        If the length is not positive, the fraction negative, or a value not finite.

    Notes
    -----
    The exponential contact law is a population of linear elements that come into contact at different gaps y. Each has
    a tangential spring, which sliding stretches, slips at its own limit, and is reset on separation. With the gap x(t)
    and the slide s(t), both in decay lengths l, the force of one element in units of its normal stiffness times l is

    .. math::

        \dot\tau = \frac{l}{D_c} \dot s \ \text{ while } |\tau| < y - x, \qquad |\tau| \le \max(y - x, 0),

    and the friction ratio is the mean over a period of all elements, weighted with the density exp(-y):

    .. math:: \frac{F_1}{F_0} = \frac{\int e^{-y} \langle\tau\rangle \, dy}{\langle e^{-x} \rangle}
              \frac{\langle F_n \rangle}{F_N}.

    The motion is used as given: about the separation at rest its mean normal force exceeds the load, and friction is
    higher accordingly. For other than exponential heights the ratio at the mean normal force is computed with the decay
    length at rest, and multiplied by the actual mean normal force over the load. `sine_stick_slip_ratio` is the same
    for a load-balanced sine in closed form.

    See Also
    --------
    sonolube.friction.models.bristle_with_holder.BristleWithHolder : One bristle, continuous through the period.
    sonolube.friction.models.kinematic.Kinematic : Direction of the relative velocity alone.

    References
    ----------
    .. [1] R. D. Mindlin, J. Appl. Mech. 16, 259 (1949), for the tangential stiffness of an asperity.
    """

    name: ClassVar[str] = "asperity_stick_slip"
    citation: ClassVar[str] = (
        "load-balanced exponential stick-slip; D_c = 1.5 um fitted to D Tables 2.3 and 4.2 and sections 2.4 and 2.5"
    )

    memory_length: float = parameter(EMPIRICAL_MEMORY_LENGTH, positive=True)
    in_plane_fraction: float = parameter(0.0, lowest=0.0)
    in_plane_phase: float = parameter(0.0)

    def ratio(
        self,
        contact: RoughContact,
        motion: GapMotion,
        *,
        sliding_speed: ArrayLike,
        friction_coefficient: ArrayLike | None = None,
    ) -> Floats:
        """Return mean friction under a motion of the gap over friction without vibration. []

        Parameters
        ----------
        contact : RoughContact
        motion : GapMotion
        sliding_speed : array_like, any shape
            Mean sliding speed. [m/s]
        friction_coefficient : float, optional
            Without effect in this model. []

        Returns
        -------
        ndarray, shape of `sliding_speed`

        Raises
        ------
        InvalidInput
            If a speed is not positive.
        """
        v_r = require_positive(sliding_speed=sliding_speed)
        length = float(decay_length(contact, separation=separation(contact, normal_load=motion.normal_load)))

        def mean_over_limit(sampled: GapMotion) -> Floats:
            widest_first = np.roll(sampled.displacement, -int(np.argmax(sampled.displacement)))
            in_plane = self.in_plane_fraction * delayed_oscillation(widest_first, phase=self.in_plane_phase)
            slides = length / self.memory_length * np.diff(in_plane, append=in_plane[:1])
            steady = length / self.memory_length * v_r.ravel() / (motion.frequency * widest_first.size)
            return _sampled_ratio(widest_first / length, slides / length, steady / length, *_HEIGHTS)

        if not self.in_plane_fraction and motion.displacement.size <= _LONGEST_PERIOD:
            every = np.zeros(v_r.size, dtype=np.int64)
            closed = self.batched_ratio(
                contact, gap_harmonics(motion), sliding_speed=v_r.ravel(), motion=every, friction_coefficient=np.nan
            )
            if np.isfinite(closed).all():
                return closed.reshape(v_r.shape)
        mean_force_ratio = float(np.mean(motion.normal_force)) / motion.normal_load
        return mean_force_ratio * richardson_period_mean(mean_over_limit, motion).reshape(v_r.shape)

    def batched_ratio(
        self,
        contact: RoughContact,
        motions: GapMotionBatch,
        *,
        sliding_speed: Floats,
        motion: Integers,
        friction_coefficient: float,
        tolerance: float = 1e-7,
    ) -> Floats:
        """Return the friction ratios of many pairs of motion and speed at once; NaN where `ratio` must be used. []

        Parameters
        ----------
        contact : RoughContact
        motions : GapMotionBatch
        sliding_speed : ndarray, shape (n,)
            Mean sliding speed of each point, positive. [m/s]
        motion : ndarray of int, shape (n,)
            Row of `motions` at each point.
        friction_coefficient : float, optional
            Without effect in this model. []
        tolerance : float
            Largest error by neglecting higher harmonics. []

        Returns
        -------
        ndarray, shape (n,)
            NaN without exponential heights or with in-plane motion, and where `batched_stick_slip_ratio` gives NaN.
        """
        if self.in_plane_fraction or not isinstance(contact.heights, ExponentialHeights):
            return np.full(sliding_speed.shape, np.nan)
        length, memory = decay_length(contact), self.memory_length
        return batched_stick_slip_ratio(
            motions,
            decay_length=length,
            sliding_speed=sliding_speed,
            motion=motion,
            memory_length=memory,
            tolerance=tolerance,
        )


def _sampled_ratio(x: Floats, slides: Floats, steady: Floats, nodes: Floats, weights: Floats) -> Floats:
    """Return the mean friction over the mean limit, for gaps, vibration slides and steady slides in decay lengths."""
    ratio = np.empty(steady.size)
    _sum_elements(x, slides, steady, float(x.min()), float(x.max()), nodes, weights, np.empty(x.size), ratio)
    return ratio


@kernel(cache=True, no_cfunc_wrapper=True, _nrt=False)
def _sum_elements(
    x: Floats,
    slides: Floats,
    steady: Floats,
    lowest: float,
    highest: float,
    nodes: Floats,
    weights: Floats,
    force: Floats,
    ratio: Floats,
) -> None:
    """Write the mean friction of all elements over their mean limit, from the least and the greatest gap."""
    mean_limit = distance = 0.0
    for k in range(x.size):
        mean_limit += exp(lowest - x[k])
        distance += abs(slides[k])
    mean_limit /= x.size
    above, span = highest + 2 * (highest - lowest) + 2 * distance, min(highest - lowest, _NEGLIGIBLE)
    for i in range(steady.size):
        start = total = share = 0.0
        for turn in range(-1, 2 * nodes.size):  # one call of _element_force, which is long to compile
            j, in_contact = turn // 2, turn % 2 == 1  # throughout the period, or for a part of it
            y = above
            if turn >= 0 and not in_contact:
                angle = pi * (1 + nodes[j]) / 2
                y = lowest + span * (1 - cos(angle)) / 2  # graded towards both ends
                share = weights[j] * pi * span * sin(angle) / 4
            elif turn >= 0:
                if not start > highest:
                    continue
                y = highest + (start - highest) * (1 + nodes[j]) / 2
                share = weights[j] * (start - highest) / 2
            mean = _element_force(x, slides, steady[i], y, force)
            if turn >= 0:
                total += share * (exp(lowest - y) * mean) if in_contact else share * exp(lowest - y) * mean
                continue
            # the force of elements in permanent contact is their height less a common envelope
            start = highest
            for k in range(x.size):
                start = max(start, (above - force[k] + x[k]) / 2)  # above it no element slips backwards
            total = exp(lowest - start) * (start - (above - mean) + 1)
        ratio[i] = total / mean_limit


@kernel(**INNER, _nrt=False)
def _element_force(x: Floats, slides: Floats, steady: float, y: float, force: Floats) -> float:
    """Return the mean force of the element in contact below gap y, and write it at every phase, widest gap first."""
    n = x.size
    tau = max(y - x[0], 0.0)
    for _ in range(100):
        start = tau
        total = 0.0
        for k in range(n):
            force[k] = tau
            total += tau
            before, after = x[k], x[k + 1 if k + 1 < n else 0]
            limit = y - after
            if limit <= 0:
                tau = 0.0
                continue
            step = slides[k] + steady
            if before > y:
                step *= limit / (before - after)  # came into contact within this step
            tau = min(max(tau + step, -limit), limit)
        if abs(tau - start) <= 1e-12 * (1 + abs(start)):
            break
    return total / n
