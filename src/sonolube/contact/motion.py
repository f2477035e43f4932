"""How the gap of a contact moves over one period of vibration."""

from collections.abc import Callable
from dataclasses import dataclass

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
from sonolube.contact.rough import RoughContact, normal_force, normal_stiffness, separation
from sonolube.errors import InvalidInput, OutsideRange

_COARSEST, _FINEST = 256, 65536  # samples a period between which a mean is refined


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class GapMotion:
    """One period of a steady motion along the surface normal.

    Parameters
    ----------
    displacement : ndarray, shape (n,)
        Displacement from rest under the load, positive for wider gaps, at n uniform phases from 0. [m]
    normal_force : ndarray, shape (n,)
        Normal contact force at these phases. [N]
    frequency : float
        Frequency of the vibration. [Hz]
    normal_load : float
        Dead load, the normal force at rest. [N]

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

    @property
    def velocity(self) -> Floats:
        """Velocity along the surface normal, positive for opening gaps. [m/s]"""
        n = self.displacement.size
        harmonics = np.fft.rfft(self.displacement) * (2j * np.pi * self.frequency) * np.arange(n // 2 + 1)
        if n % 2 == 0:
            harmonics[-1] = 0.0  # the highest harmonic of an even count has no derivative at the samples
        return np.fft.irfft(harmonics, n)

    def resampled(self, samples: int) -> "GapMotion":
        """Return the same motion at another number of phases, its harmonics kept."""
        return GapMotion(
            displacement=_resampled(self.displacement, samples),
            normal_force=np.maximum(_resampled(self.normal_force, samples), 0.0),
            frequency=self.frequency,
            normal_load=self.normal_load,
        )


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class HarmonicMotions:
    r"""Steady motions of the gap by their harmonics, one row to a motion.

    Parameters
    ----------
    mean_displacement : ndarray, shape (m,)
        Mean displacement from rest under the load. [m]
    harmonics : ndarray of complex, shape (m, K)
        Complex amplitudes X_k of the displacement, in m.
    frequency : ndarray, shape (m,)
        Fundamental frequency. [Hz]

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

    def __post_init__(self) -> None:
        mean = np.atleast_1d(require_finite(mean_displacement=self.mean_displacement))
        swing = np.atleast_2d(require_finite_complex(harmonics=self.harmonics))
        f = np.atleast_1d(require_positive(frequency=self.frequency))
        if not mean.size == f.size == swing.shape[0] or mean.ndim != 1 or swing.ndim != 2:
            raise InvalidInput(
                "mean_displacement, frequency and harmonics must have one row to a motion, got shapes"
                f" {mean.shape}, {f.shape} and {swing.shape}"
            )
        for name, value in (("mean_displacement", mean), ("harmonics", swing), ("frequency", f)):
            object.__setattr__(self, name, value)


def harmonic_motion(
    contact: RoughContact,
    *,
    normal_load: ArrayLike,
    vibration_amplitude: ArrayLike,
    frequency: ArrayLike,
    samples: int = _COARSEST,
) -> GapMotion:
    """Return a prescribed sine about rest, its mean not moved by the vibration.

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
        Phases at which the motion is kept, widest gap first.

    Returns
    -------
    GapMotion

    Raises
    ------
    InvalidInput
        If the load or frequency is not positive, or the amplitude negative.
    OutsideRange
        If no separation carries the load, or the amplitude leaves the height law's range.

    Notes
    -----
    Only a stiff mount holds the mean: the mean normal force then exceeds the load. Under a dead load the mean rises,
    `load_balanced_motion`.
    """
    load, a = require_positive(normal_load=normal_load), require_non_negative(vibration_amplitude=vibration_amplitude)
    x = a * np.cos(2 * np.pi * np.arange(samples) / samples)
    return GapMotion(
        displacement=x,
        normal_force=normal_force(contact, separation=separation(contact, normal_load=load) + x),
        frequency=float(require_positive(frequency=frequency)),
        normal_load=float(load),
    )


def load_balanced_motion(contact: RoughContact, motion: GapMotion) -> GapMotion:
    """Return the same vibration about the mean gap at which the mean contact force is the load.

    Parameters
    ----------
    contact : RoughContact
    motion : GapMotion

    Returns
    -------
    GapMotion
        Its normal force is that of the contact at the new gaps.

    Raises
    ------
    OutsideRange
        If the balance lies outside the height law's range.

    Notes
    -----
    A sine of amplitude a in a contact of decay length l rises by l ln I0(a/l).
    """
    d, x = separation(contact, normal_load=motion.normal_load), motion.displacement
    x = x + max(0.0, -float(np.min(x)))  # to start where every gap carries something sensible
    for _ in range(50):
        forces, slopes = normal_force(contact, separation=d + x), normal_stiffness(contact, separation=d + x)
        # Newton on the logarithm of the mean force, exact in one step for exponential heights
        excess = np.log(np.mean(forces) / motion.normal_load)
        x = x + excess * np.mean(forces) / np.mean(slopes)
        if abs(excess) < 1e-13:
            break
    else:
        raise OutsideRange(f"normal_load of {motion.normal_load:.3g} N is not balanced at any gap of this motion")
    return GapMotion(
        displacement=x,
        normal_force=normal_force(contact, separation=d + x),
        frequency=motion.frequency,
        normal_load=motion.normal_load,
    )


def open_separation(contact: RoughContact, motion: GapMotion) -> Floats:
    """Return the separation at rest about which a motion takes place, if it never closes the gap. [m]

    Parameters
    ----------
    contact : RoughContact
    motion : GapMotion

    Returns
    -------
    ndarray, shape ()

    Raises
    ------
    OutsideRange
        If the mean planes meet at some phase, or no separation carries the load.
    """
    d = separation(contact, normal_load=motion.normal_load)
    nearest = float(d + np.min(motion.displacement))
    if nearest <= 0:
        raise OutsideRange(
            f"the motion closes the gap: from a separation of {float(d):.3g} m at rest it comes to {nearest:.3g} m."
            " A smaller amplitude, or a mean gap that balances the load, keeps it open"
        )
    return d


def converged_mean(mean: Callable[[GapMotion], Floats], motion: GapMotion, *, tolerance: float = 1e-5) -> Floats:
    """Return a mean over the period, taken at ever more phases until it stands.

    Parameters
    ----------
    mean : callable
        Gives the mean, or several, for a motion; its error must fall with the square of the phases' distance.
    motion : GapMotion
    tolerance : float
        Largest error left, relative to the larger of the mean and one.

    Returns
    -------
    ndarray, shape of what `mean` returns

    Raises
    ------
    OutsideRange
        If 65536 phases do not suffice.
    """
    samples = max(_COARSEST, motion.displacement.size)
    coarse = mean(motion.resampled(samples))
    while samples < _FINEST:
        samples *= 2
        fine = mean(motion.resampled(samples))
        change = fine - coarse
        # a third of the change is the error that Richardson's extrapolation then removes to the next order
        if np.all(np.abs(change) / 3 < tolerance * np.maximum(np.abs(fine), 1.0)):
            return fine + change / 3
        coarse = fine
    raise OutsideRange(f"the mean over a period does not settle with {samples} samples of this motion")


def shifted(values: Floats, *, phase: float) -> Floats:
    """Return the varying part of a sampled period, later by a phase.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Samples at uniform phases.
    phase : float
        How much later. [rad]

    Returns
    -------
    ndarray, shape (n,)
    """
    harmonics = np.fft.rfft(values) * np.exp(-1j * phase * np.arange(values.size // 2 + 1))
    harmonics[0] = 0.0
    return np.fft.irfft(harmonics, values.size)


def _resampled(values: Floats, samples: int) -> Floats:
    n = values.size
    if samples == n:
        return values
    harmonics = np.fft.rfft(values)
    if n % 2 == 0 and samples > n:
        harmonics[-1] /= 2  # shared between both signs of the highest frequency, which now stand apart
    return np.fft.irfft(harmonics, samples) * (samples / n)
