"""Mean friction ratio of a normally vibrated contact by stick-slip of its asperities."""

from dataclasses import dataclass
from functools import lru_cache
from math import exp, pi
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, Floats, Integers
from sonolube.execution.compilation import kernel
from sonolube.models.contact.contact_motion import ContactMotion, GapMotionBatch, gap_harmonics
from sonolube.models.contact.height_distribution import ExponentialHeights
from sonolube.models.contact.period_mean import richardson_period_mean
from sonolube.models.contact.rough import RoughContact, decay_length, separation
from sonolube.models.friction.models.asperity_stick_slip_batch import batched_stick_slip_ratio
from sonolube.models.friction.models.asperity_stick_slip_sine import EMPIRICAL_MEMORY_LENGTH
from sonolube.models.friction.models.model import FrictionModel, parameter
from sonolube.models.friction.models.planar_stick_slip import planar_stick_slip_ratio

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(64)
_EVEN, _EVEN_WEIGHTS = (1 + _NODES) / 2, _WEIGHTS / 2  # of a quadrature from 0 to 1
_GRADED = (1 - np.cos(pi * _EVEN)) / 2  # the same with nodes towards both ends
_GRADED_WEIGHTS = pi / 2 * np.sin(pi * _EVEN) * _EVEN_WEIGHTS
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
    sonolube.models.friction.models.bristle_with_holder.BristleWithHolder : One bristle, continuous through the period.
    sonolube.models.friction.models.kinematic.Kinematic : Direction of the relative velocity alone.

    References
    ----------
    .. [1] R. D. Mindlin, J. Appl. Mech. 16, 259 (1949), for the tangential stiffness of an asperity.
    """

    name: ClassVar[str] = "asperity_stick_slip"
    citation: ClassVar[str] = (
        "load-balanced exponential stick-slip; D_c = 1.5 um fitted to D Table 2.3 and sections 2.4 and 2.5"
    )

    directions: ClassVar[frozenset[str]] = frozenset({"normal", "along", "across"})

    memory_length: float = parameter(EMPIRICAL_MEMORY_LENGTH, positive=True)
    in_plane_fraction: float = parameter(0.0, lowest=0.0)
    in_plane_phase: float = parameter(0.0)

    def _ratios(self, contact: RoughContact, motion: ContactMotion, v_r: Floats, mu: ArrayLike | None) -> Floats:
        """Ratio at positive speeds, shape (n,)."""
        length = float(decay_length(contact, separation=separation(contact, normal_load=motion.normal_load)))

        def mean_over_limit(sampled: ContactMotion) -> Floats:
            gap, steps = _from_widest_gap(sampled)
            if sampled.along is None:
                delays = np.exp(-1j * self.in_plane_phase * np.arange(steps.size))
                slides = self.in_plane_fraction / self.memory_length * np.fft.irfft(steps * delays, gap.size)
            else:
                along = np.roll(sampled.along, -int(np.argmax(sampled.displacement)))
                slides = (np.roll(along, -1) - along) / self.memory_length
            steady = v_r / (self.memory_length * motion.frequency * gap.size)
            if sampled.across is not None:
                across = np.roll(sampled.across, -int(np.argmax(sampled.displacement))) / self.memory_length
                return planar_stick_slip_ratio(gap / length, np.cumsum(slides) - slides, across, steady)
            return _sampled_ratio(gap / length, slides, steady)

        is_normal = motion.along is None and motion.across is None and not self.in_plane_fraction
        if is_normal and motion.displacement.size <= _LONGEST_PERIOD:
            every = np.zeros(v_r.size, dtype=np.int64)
            closed = self.batched_ratio(
                contact, gap_harmonics(motion), sliding_speed=v_r, motion=every, friction_coefficient=np.nan
            )
            if np.isfinite(closed).all():
                return closed
        mean_force_ratio = float(np.mean(motion.normal_force)) / motion.normal_load
        return mean_force_ratio * richardson_period_mean(mean_over_limit, motion)

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
        """Friction ratios of many pairs of motion and speed at once; NaN where `ratio` must be used. []

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


@lru_cache(maxsize=64)
def _from_widest_gap(motion: ContactMotion) -> tuple[Floats, Complexes]:
    """Displacement from its widest on, and the harmonics of its steps; kept for fits."""
    gap = np.roll(motion.displacement, -int(np.argmax(motion.displacement)))
    harmonics = np.fft.rfft(gap)
    harmonics[0] = 0.0
    return gap, harmonics * (np.exp(2j * pi * np.arange(harmonics.size) / gap.size) - 1)


def _sampled_ratio(x: Floats, slides: Floats, steady: Floats) -> Floats:
    """Mean friction over the mean limit, for gaps, vibration slides and steady slides in decay lengths."""
    lowest, highest = float(x.min()), float(x.max())
    mean_limit = np.exp(lowest - x).mean()
    permanent = np.array([highest + 2 * (highest - lowest) + 2 * np.abs(slides).sum()])
    stroke = highest - lowest
    span = min(stroke, _NEGLIGIBLE)
    graded = span * _GRADED
    shares = span * _GRADED_WEIGHTS * np.exp(-graded)
    ratio = np.empty(steady.size)
    for i, slide in enumerate(steady.tolist()):
        # the force of elements in permanent contact is their height less a common envelope
        (force,), (least,) = _element_forces(x, slides, slide, permanent)
        start = max(highest, (permanent[0] - least) / 2)  # above it no element slips backwards
        total = exp(lowest - start) * (start - (permanent[0] - force) + 1)
        total += shares @ _element_forces(x, slides, slide, lowest + graded)[0]
        if start > highest:
            reach = min(start - highest, _NEGLIGIBLE)
            heights = stroke + reach * _EVEN
            forces = np.exp(-heights) * _element_forces(x, slides, slide, lowest + heights)[0]
            total += reach * (_EVEN_WEIGHTS @ forces)
        ratio[i] = total / mean_limit
    return ratio


def _element_forces(x: Floats, slides: Floats, steady: float, heights: Floats) -> Floats:
    """Of elements in contact below some gaps the mean force, and the least force less the gap, a row each."""
    forces = np.empty((2, heights.size))
    _write_element_forces(x, slides, steady, heights, np.empty((2, heights.size)), forces)
    return forces


@kernel(cache=True, error_model="numpy", no_cfunc_wrapper=True, _nrt=False)
def _write_element_forces(
    x: Floats, slides: Floats, steady: float, heights: Floats, work: Floats, forces: Floats
) -> None:
    """Write forces of elements, side by side, one in each SIMD lane, from the widest gap until the period repeats."""
    n, m = x.size, heights.size
    tau, before_period, total, least = work[0], work[1], forces[0], forces[1]
    for j in range(m):
        tau[j] = max(heights[j] - x[0], 0.0)
    for _ in range(100):
        for j in range(m):
            before_period[j] = tau[j]
            total[j], least[j] = 0.0, tau[j] - x[0]
        for k in range(n):
            before, after = x[k], x[k + 1 if k + 1 < n else 0]
            step = slides[k] + steady
            closing = step / (before - after) if before > after else 0.0
            for j in range(m):
                total[j] += tau[j]
                least[j] = min(least[j], tau[j] - before)
                limit = max(heights[j] - after, 0.0)
                slide = closing * limit if before > heights[j] else step  # in contact for part of the step
                tau[j] = min(max(tau[j] + slide, -limit), limit)
        changed = 0.0
        for j in range(m):
            changed = max(changed, abs(tau[j] - before_period[j]) / (1 + abs(before_period[j])))
        if changed <= 1e-12:
            break
    for j in range(m):
        total[j] /= n
