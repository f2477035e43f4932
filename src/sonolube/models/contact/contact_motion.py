"""Periodic motions of a contact: one sampled period by direction, and batches of Fourier coefficients of the gap.

The record in which `sonolube.models.dynamics` hands over a vibration and which the models of friction and wear take.
"""

from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import (
    Complexes,
    Floats,
    require_finite,
    require_finite_complex,
    require_non_negative,
    require_positive,
)
from sonolube.errors import InvalidInput, OutsideRange
from sonolube.models.contact.rough import RoughContact, normal_force, normal_stiffness, separation

_MAX_KEPT = 2048  # samples of motions that are kept at another number of phases
_SAMPLES = 256  # per period


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ContactMotion:
    """One period of a steady-state motion of a contact along its normal and within its plane, at uniform phases.

    Parameters
    ----------
    displacement : ndarray, shape (n,)
        Displacement from the position at rest under the load, positive for wider gaps, at n uniform phases from 0. [m]
    normal_force : ndarray, shape (n,)
        Normal contact force at these phases. [N]
    frequency : float
        Frequency of the vibration. [Hz]
    normal_load : float
        Dead load, which is the normal force at rest. [N]
    along, across : ndarray, shape (n,), optional
        Displacement within the plane at these phases, along the mean sliding and across it, in m; None for none.

    Raises
    ------
    InvalidInput
        If the shapes differ, there are fewer than eight samples, a force is negative, the frequency or load not
        positive, or a value not finite.
    """

    displacement: Floats
    normal_force: Floats
    frequency: float
    normal_load: float
    along: Floats | None = None
    across: Floats | None = None

    def __post_init__(self) -> None:
        x = require_finite(displacement=self.displacement)
        F_n = require_non_negative(normal_force=self.normal_force)
        require_positive(frequency=self.frequency)
        require_positive(normal_load=self.normal_load)
        if x.ndim != 1 or x.size < 8 or x.shape != F_n.shape:
            raise InvalidInput(
                "displacement and normal_force must be rows of the same eight or more phases,"
                f" got shapes {x.shape} and {F_n.shape}"
            )
        object.__setattr__(self, "displacement", x)
        object.__setattr__(self, "normal_force", F_n)
        for name in ("along", "across"):
            if getattr(self, name) is None:
                continue
            within = require_finite(**{name: getattr(self, name)})
            if within.shape != x.shape:
                raise InvalidInput(
                    f"{name} must have the phases of displacement, got shapes {within.shape} and {x.shape}"
                )
            object.__setattr__(self, name, within)

    @property
    def velocity(self) -> Floats:
        """Velocity along the surface normal by spectral differentiation, positive for opening gaps. [m/s]"""
        n = self.displacement.size
        harmonics = np.fft.rfft(self.displacement) * (2j * np.pi * self.frequency) * np.arange(n // 2 + 1)
        if n % 2 == 0:
            harmonics[-1] = 0.0  # the highest harmonic of an even count has no derivative at the samples
        return np.fft.irfft(harmonics, n)

    def resampled(self, samples: int) -> "ContactMotion":
        """Same motion at another number of phases, by its harmonics.

        Parameters
        ----------
        samples : int
            Number of uniform phases.

        Returns
        -------
        ContactMotion
        """
        return (_resampled_motion if samples <= _MAX_KEPT else _resampled_motion.__wrapped__)(self, samples)


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class GapMotionBatch:
    r"""Fourier coefficients of many steady-state motions of the gap, one row per motion.

    Parameters
    ----------
    mean_displacement : ndarray, shape (m,)
        Mean displacement from the position at rest under the load. [m]
    harmonics : ndarray of complex, shape (m, K)
        Complex amplitudes X_k of the displacement, in m.
    frequency : ndarray, shape (m,)
        Fundamental frequency. [Hz]
    mean_force_ratio : ndarray, shape (m,), optional
        Mean normal force over the load; 1 by default, as under a dead load. Springs to the ground carry a part.

    Raises
    ------
    InvalidInput
        If the shapes do not match, a frequency is not positive or a value not finite.

    Notes
    -----
    .. math:: x(t) = \bar x + \mathrm{Re} \sum_{k=1}^{K} X_k e^{2 \pi i k f t}
    """

    mean_displacement: Floats
    harmonics: Complexes
    frequency: Floats
    mean_force_ratio: Floats = field(default_factory=lambda: np.ones(1))

    def __post_init__(self) -> None:
        mean = np.atleast_1d(require_finite(mean_displacement=self.mean_displacement))
        coefficients = np.atleast_2d(require_finite_complex(harmonics=self.harmonics))
        f = np.atleast_1d(require_positive(frequency=self.frequency))
        if not mean.size == f.size == coefficients.shape[0] or mean.ndim != 1 or coefficients.ndim != 2:
            raise InvalidInput(
                "mean_displacement, frequency and harmonics must have one row per motion, got shapes"
                f" {mean.shape}, {f.shape} and {coefficients.shape}"
            )
        ratio = np.atleast_1d(require_non_negative(mean_force_ratio=self.mean_force_ratio))
        if ratio.shape not in {(1,), mean.shape}:
            raise InvalidInput(f"mean_force_ratio must have one value or one per motion, got shape {ratio.shape}")
        ratio = np.broadcast_to(ratio, mean.shape)
        columns = (("mean_displacement", mean), ("harmonics", coefficients), ("frequency", f))
        for name, value in (*columns, ("mean_force_ratio", ratio)):
            object.__setattr__(self, name, value)


def gap_harmonics(motion: ContactMotion) -> GapMotionBatch:
    """Fourier coefficients of one motion, as a batch of one.

    Parameters
    ----------
    motion : ContactMotion

    Returns
    -------
    GapMotionBatch
        Of every harmonic below half the number of phases.
    """
    n = motion.displacement.size
    coefficients = np.fft.rfft(motion.displacement) / n
    return GapMotionBatch(
        mean_displacement=np.array([coefficients[0].real]),
        harmonics=2 * coefficients[np.newaxis, 1 : (n + 1) // 2],
        frequency=np.array([motion.frequency]),
        mean_force_ratio=np.array([np.mean(motion.normal_force) / motion.normal_load]),
    )


def sinusoidal_motion(
    contact: RoughContact,
    *,
    normal_load: ArrayLike,
    vibration_amplitude: ArrayLike,
    frequency: ArrayLike,
    samples: int = _SAMPLES,
) -> ContactMotion:
    r"""Sinusoidal motion of prescribed amplitude about the separation at rest.

    Parameters
    ----------
    contact : RoughContact
    normal_load : float
        Force pressing the bodies together at rest. [N]
    vibration_amplitude : float
        Amplitude of the vibration along the surface normal. [m]
    frequency : float
        Frequency of the vibration. [Hz]
    samples : int
        Number of phases, the widest gap first.

    Returns
    -------
    ContactMotion

    Raises
    ------
    InvalidInput
        If the load or frequency is not positive, or the amplitude negative.
    OutsideRange
        If no separation carries the load, or the motion leaves the range of the height distribution.

    Notes
    -----
    .. math:: x(t) = a \cos 2 \pi f t, \qquad F_n(t) = F_n(d + x)

    The mean gap stays that at rest, so that the mean normal force exceeds the load: only a stiff mount holds the gap in
    this way. Under a dead load the mean gap rises, see `load_balanced_motion`.

    See Also
    --------
    load_balanced_motion : The same vibration with a mean normal force equal to the load.
    """
    load, a = require_positive(normal_load=normal_load), require_non_negative(vibration_amplitude=vibration_amplitude)
    x = a * np.cos(2 * np.pi * np.arange(samples) / samples)
    return ContactMotion(
        displacement=x,
        normal_force=normal_force(contact, separation=separation(contact, normal_load=load) + x),
        frequency=float(require_positive(frequency=frequency)),
        normal_load=float(load),
    )


def load_balanced_motion(contact: RoughContact, motion: ContactMotion) -> ContactMotion:
    r"""Same vibration about the mean gap at which the mean normal force equals the load.

    Parameters
    ----------
    contact : RoughContact
    motion : ContactMotion

    Returns
    -------
    ContactMotion
        Its normal force is that of the contact at the new gaps.

    Raises
    ------
    OutsideRange
        If the balanced gap lies outside the range of the height distribution.

    Notes
    -----
    .. math:: \frac1T \int_0^T F_n(d + \bar x + \tilde x(t))\, \mathrm{d}t = F_N

    is solved for the mean displacement by Newton's method. With exponential heights a sine of amplitude a rises by
    :math:`\bar x = l \ln I_0(a/l)`, l being the decay length of the contact force.

    See Also
    --------
    sinusoidal_motion : A sine about the separation at rest.
    """
    d, x = separation(contact, normal_load=motion.normal_load), motion.displacement
    x = x + max(0.0, -float(np.min(x)))  # start with no gap narrower than at rest, within range of the forces
    for _ in range(50):
        forces, slopes = normal_force(contact, separation=d + x), normal_stiffness(contact, separation=d + x)
        # Newton on the logarithm of the mean force, exact in one step for exponential heights
        excess = np.log(np.mean(forces) / motion.normal_load)
        x = x + excess * np.mean(forces) / np.mean(slopes)
        if abs(excess) < 1e-13:
            break
    else:
        load = f"normal_load of {motion.normal_load:.3g} N"
        raise OutsideRange(f"{load} is balanced by no mean gap of this motion; reduce the amplitude")
    return replace(motion, displacement=x, normal_force=normal_force(contact, separation=d + x))


def require_open_gap(contact: RoughContact, motion: ContactMotion) -> Floats:
    """Separation at rest of a motion; refuses a motion that closes the gap. [m]"""
    d = separation(contact, normal_load=motion.normal_load)
    smallest = float(d + np.min(motion.displacement))
    if smallest <= 0:
        raise OutsideRange(
            f"the motion closes the gap: its smallest separation is {smallest:.3g} m, from {float(d):.3g} m at rest."
            " Reduce the amplitude, or use the load-balanced mean gap"
        )
    return d


def delayed_oscillation(values: Floats, *, phase: float) -> Floats:
    """Oscillating part of a sampled period, delayed by a phase; `values` has shape (..., n)."""
    samples = values.shape[-1]
    harmonics = np.fft.rfft(values) * np.exp(-1j * phase * np.arange(samples // 2 + 1))
    harmonics[..., 0] = 0.0
    return np.fft.irfft(harmonics, samples)


@lru_cache(maxsize=256)
def _resampled_motion(motion: ContactMotion, samples: int) -> ContactMotion:
    """Motion at another number of uniform phases; kept for models that are fitted to it."""
    return replace(
        motion,
        displacement=_resampled(motion.displacement, samples),
        normal_force=np.maximum(_resampled(motion.normal_force, samples), 0.0),
        along=None if motion.along is None else _resampled(motion.along, samples),
        across=None if motion.across is None else _resampled(motion.across, samples),
    )


def _resampled(values: Floats, samples: int) -> Floats:
    """Sampled period at another number of uniform phases, by its harmonics."""
    n = values.size
    if samples == n:
        return values
    harmonics = np.fft.rfft(values)
    if n % 2 == 0 and samples > n:
        harmonics[-1] /= 2  # one of the two signs of the highest frequency, which are now separate
    return np.fft.irfft(harmonics, samples) * (samples / n)
