"""Mean friction ratio of a normally vibrated contact by stick-slip of its asperities."""

from dataclasses import dataclass
from math import cos, exp, pi, sin
from typing import ClassVar, final

import numba
import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, Integers, require_positive
from sonolube.contact.height_distribution import ExponentialHeights
from sonolube.contact.motion import GapMotion, HarmonicMotions, converged_mean, shifted
from sonolube.contact.rough import RoughContact, decay_length, separation
from sonolube.friction.models.asperity_stick_slip_batch import batched_stick_slip_ratio
from sonolube.friction.models.asperity_stick_slip_sine import EMPIRICAL_MEMORY_LENGTH
from sonolube.friction.models.model import FrictionModel, parameter

_HEIGHTS = np.polynomial.legendre.leggauss(64)
_NEGLIGIBLE = 40.0  # exponents beyond which elements carry nothing


@final
@dataclass(frozen=True, kw_only=True, slots=True)
class AsperityStickSlip(FrictionModel):
    r"""Stick-slip of independent asperities, each of which sticks anew at every touch.

    Parameters
    ----------
    memory_length : float
        Sliding distance D_c in which an asperity pressed by one decay length reaches its friction limit; of the
        default, which is empirical, see `EMPIRICAL_MEMORY_LENGTH`, and with nothing fitted `mindlin_memory_length`. [m]
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
    The exponential contact law is a population of linear elements that touch at different gaps y. Each carries a
    tangential spring that the sliding stretches, slips at its own limit, and is reset on separation. With the gap x(t)
    and the stretch s(t), both in decay lengths l, the force of one element in units of its normal stiffness times l is

    .. math::

        \dot\tau = \frac{l}{D_c} \dot s \ \text{ while } |\tau| < y - x, \qquad |\tau| \le \max(y - x, 0),

    and the friction ratio the mean over a period of all elements, weighted with the density exp(-y):

    .. math:: \frac{F_1}{F_0} = \frac{\int e^{-y} \langle\tau\rangle \, dy}{\langle e^{-x} \rangle}
              \frac{\langle F_n \rangle}{F_N}.

    The motion is taken as it is: one about an unmoved mean presses harder than the load, and so rubs harder. For other
    than exponential heights the decay length at rest is taken for the friction ratio at the mean normal force, and the
    actual mean normal force for the rest. `sine_stick_slip_ratio` is the same for a sine of balanced load in closed
    form.

    See Also
    --------
    sonolube.friction.models.bristle_with_holder.BristleWithHolder : One bristle that keeps its force through a period.
    sonolube.friction.models.kinematic.Kinematic : Direction of the relative velocity alone.

    References
    ----------
    .. [1] R. D. Mindlin, J. Appl. Mech. 16, 259 (1949), for the tangential stiffness of an asperity.
    """

    name: ClassVar[str] = "asperity_stick_slip"
    citation: ClassVar[str] = (
        "load-balanced exponential stick-slip; D_c = 1.5 um fitted to D Table 2.3 and sections 2.4 and 2.5"
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
            in_plane = self.in_plane_fraction * shifted(widest_first, phase=self.in_plane_phase)
            stretch = length / self.memory_length * (np.roll(in_plane, -1) - in_plane)
            steady = length / self.memory_length * v_r.ravel() / (motion.frequency * widest_first.size)
            return _sampled_ratio(widest_first / length, stretch / length, steady / length, *_HEIGHTS)

        mean_force_ratio = float(np.mean(motion.normal_force)) / motion.normal_load
        return mean_force_ratio * converged_mean(mean_over_limit, motion).reshape(v_r.shape)

    def batched_ratio(
        self,
        contact: RoughContact,
        motions: HarmonicMotions,
        *,
        sliding_speed: Floats,
        motion: Integers,
        friction_coefficient: float,
    ) -> Floats:
        """Return the friction ratio of many pairs of motion and speed at once; NaN where `ratio` must be used. []

        Parameters
        ----------
        contact : RoughContact
        motions : HarmonicMotions
        sliding_speed : ndarray, shape (n,)
            Mean sliding speed of each point, positive. [m/s]
        motion : ndarray of int, shape (n,)
            Row of `motions` at each point.
        friction_coefficient : float, optional
            Without effect in this model. []

        Returns
        -------
        ndarray, shape (n,)
            NaN without exponential heights or with in-plane motion, and where `batched_stick_slip_ratio` gives NaN.
        """
        if self.in_plane_fraction or not isinstance(contact.heights, ExponentialHeights):
            return np.full(sliding_speed.shape, np.nan)
        return batched_stick_slip_ratio(
            motions,
            decay_length=decay_length(contact),
            sliding_speed=sliding_speed,
            motion=motion,
            memory_length=self.memory_length,
        )


@numba.njit(cache=True)
def _sampled_ratio(x: Floats, stretch: Floats, steady: Floats, nodes: Floats, weights: Floats) -> Floats:
    """Return the mean friction over the mean limit, for gaps, in-plane stretch and its steady part in decay lengths."""
    lowest, highest = x.min(), x.max()
    mean_limit = np.mean(np.exp(lowest - x))
    ratio = np.empty(steady.size)
    force = np.empty(x.size)
    for i in range(steady.size):
        # elements that never part all follow one course: their force is their height less a common envelope
        above = highest + 2 * (highest - lowest) + 2 * np.sum(np.abs(stretch))
        envelope = above - _follow(x, stretch, steady[i], above, force)
        start = highest
        for k in range(x.size):
            start = max(start, (above - force[k] + x[k]) / 2)  # above it none slides backwards
        total = exp(lowest - start) * (start - envelope + 1)
        span = min(highest - lowest, _NEGLIGIBLE)
        for j in range(nodes.size):
            node, weight = nodes[j], weights[j]
            angle = pi * (1 + node) / 2
            y = lowest + span * (1 - cos(angle)) / 2  # crowding at both ends, where elements touch briefly or part so
            total += weight * pi * span * sin(angle) / 4 * exp(lowest - y) * _follow(x, stretch, steady[i], y, force)
            if start > highest:
                y = highest + (start - highest) * (1 + node) / 2
                share = exp(lowest - y) * _follow(x, stretch, steady[i], y, force)
                total += weight * (start - highest) / 2 * share
        ratio[i] = total / mean_limit
    return ratio


@numba.njit(cache=True)
def _follow(x: Floats, stretch: Floats, steady: float, y: float, force: Floats) -> float:
    """Return the mean force of the element that touches at gap y, and its force at every phase; widest gap first."""
    n = x.size
    tau = max(y - x[0], 0.0)
    for _ in range(100):
        begun = tau
        total = 0.0
        for k in range(n):
            force[k] = tau
            total += tau
            before, after = x[k], x[k + 1 if k + 1 < n else 0]
            limit = y - after
            if limit <= 0:
                tau = 0.0
                continue
            step = stretch[k] + steady
            if before > y:
                step *= limit / (before - after)  # touched within this step
            tau = min(max(tau + step, -limit), limit)
        if abs(tau - begun) <= 1e-12 * (1 + abs(begun)):
            break
    return total / n
