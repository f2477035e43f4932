"""Small vibrations of many structures at once: modes, poles and driven motion, contact free or on a spring.

On its contact a structure is observed with a linear spring of stiffness normal load over decay length. For an
exponential contact law that is also the stiffness of the mean force against the mean displacement under vibration of
any amplitude, so that it holds for slow motions while the contact vibrates.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from sonolube.checks import Complexes, Floats, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.identification.structure_parametrisation import StructureMatrices

_GRAVITY = 9.80665  # m/s2
_SETTLED = 0.02  # amplitude over the initial one at which a transient counts as settled
_OSCILLATORY = 1e-9  # imaginary part of a pole over its modulus, below which it is rounding
_RIGID = 1e-12  # square of a natural frequency over the largest one, below which it is rounding
_FLOATING = 1e-9  # displacement of the contact in a rigid mode over its largest in any
_HIGHEST_QUALITY = 1e15  # beyond which damping is rounding
_TINY = float(np.finfo(float).tiny)

_Number = TypeVar("_Number", np.float64, np.complex128)


@dataclass(frozen=True, kw_only=True, slots=True)
class Conditions:
    """Conditions under which a structure was observed; None where an observable does not depend on them.

    Parameters
    ----------
    frequency : float or None
        Frequency of the drive voltage. [Hz]
    voltage_peak_to_peak : float or None
        Drive voltage, peak to peak. [V]
    normal_load : float or None
        Load on the contact. [N]
    decay_length : float or None
        Decay length of the contact force; the contact stiffness is load over decay length. [m]
    observation_time : float or None
        Time after the start of a transient. [s]
    added_mass : float
        Mass hung on the structure for this observation, whose weight adds to the load. [kg]
    added_to : str
        Name of the free parameter, a mass, to which it adds; empty without an added mass.

    Raises
    ------
    InvalidInput
        If a value is not positive, or an added mass has no parameter to add to.
    """

    frequency: float | None = None
    voltage_peak_to_peak: float | None = None
    normal_load: float | None = None
    decay_length: float | None = None
    observation_time: float | None = None
    added_mass: float = 0.0
    added_to: str = ""

    def __post_init__(self) -> None:
        for name in ("frequency", "voltage_peak_to_peak", "normal_load", "decay_length", "observation_time"):
            value = getattr(self, name)
            if value is not None:
                require_positive(**{name: value})
        require_non_negative(added_mass=self.added_mass)
        if self.added_mass and not self.added_to:
            raise InvalidInput("added_to must name the free parameter to which added_mass adds")

    def value(self, name: str) -> float:
        """Value of a condition that an observable requires; refused where it is missing."""
        value = getattr(self, name)
        if value is None:
            raise InvalidInput(f"{name} is missing among the conditions of the observation")
        return float(value)

    @property
    def contact_stiffness(self) -> float:
        """Stiffness of the contact under the load and the weight of the added mass, in N/m."""
        return (self.value("normal_load") + self.added_mass * _GRAVITY) / self.value("decay_length")


class SmallVibration:
    """Small vibrations of n structures under given conditions, each quantity computed when first used.

    Parameters
    ----------
    matrices : StructureMatrices
    conditions : Conditions
    """

    def __init__(self, matrices: StructureMatrices, conditions: Conditions) -> None:
        self.matrices = matrices
        self.conditions = conditions

    @cached_property
    def _mass_roots(self) -> Floats:
        """Inverse L^-1 of the Cholesky factor of the mass matrices, shape (n, k, k)."""
        return np.asarray(np.linalg.inv(np.linalg.cholesky(self.matrices.mass_matrix)), dtype=np.float64)

    @cached_property
    def _inverse_mass(self) -> Floats:
        """Inverse of the mass matrices, shape (n, k, k)."""
        return np.asarray(self._mass_roots.transpose(0, 2, 1) @ self._mass_roots)

    @cached_property
    def _eigenpairs(self) -> tuple[Floats, Floats]:
        """Squared angular frequencies, ascending, and eigenvectors, contact free, drive short-circuited."""
        squares, vectors = np.linalg.eigh(_standard_form(self._mass_roots, self.matrices.stiffness_matrix))
        return squares, vectors

    @cached_property
    def natural_frequencies(self) -> Floats:
        """Undamped natural frequencies, contact free, drive short-circuited, ascending, shape (n, k). [Hz]"""
        return _natural_frequencies(self._eigenpairs[0])

    def _frequencies_with(self, stiffness: Floats) -> Floats:
        """Undamped natural frequencies with other stiffness matrices, ascending, shape (n, k). [Hz]"""
        squares = np.asarray(np.linalg.eigvalsh(_standard_form(self._mass_roots, stiffness)), dtype=np.float64)
        return _natural_frequencies(squares)

    @cached_property
    def mode_shapes(self) -> Floats:
        """Mass-normalised shapes of the same modes in columns, shape (n, k, k)."""
        return np.asarray(self._mass_roots.transpose(0, 2, 1) @ self._eigenpairs[1])

    @cached_property
    def driven_mode(self) -> NDArray[np.intp]:
        """Index of the mode with the largest motional capacitance, shape (n,): that of the electrical resonance."""
        frequency = self.natural_frequencies
        participation = np.einsum("nk,nkm->nm", self.matrices.drive_vector, self.mode_shapes)
        root = np.divide(participation, frequency, out=np.zeros_like(frequency), where=frequency > 0)
        return np.asarray(np.abs(root).argmax(axis=1))  # of the motional capacitance, up to a factor

    @cached_property
    def resonance(self) -> Floats:
        """Frequency of the electrical resonance, shape (n,). [Hz]"""
        return _at(self.natural_frequencies, self.driven_mode)

    @cached_property
    def antiresonance(self) -> Floats:
        """Natural frequency of the driven mode with the drive open, shape (n,). [Hz]"""
        drive, capacitance = self.matrices.drive_vector, self.matrices.clamped_capacitance
        added = drive[:, :, np.newaxis] * drive[:, np.newaxis, :] / capacitance[:, np.newaxis, np.newaxis]
        stiffness = self.matrices.stiffness_matrix + added
        return _at(self._frequencies_with(stiffness), self.driven_mode)

    @cached_property
    def free_poles(self) -> Complexes:
        """Poles with the contact free, in 1/s, ascending in modulus, shape (n, 2k)."""
        return _poles(self._inverse_mass, self.matrices.damping_matrix, self.matrices.stiffness_matrix)

    @cached_property
    def resonance_pole(self) -> Complexes:
        """Pole of the driven mode with the contact free, shape (n,)."""
        return _nearest(self.free_poles, self.resonance)

    @cached_property
    def loaded_stiffness(self) -> Floats:
        """Stiffness matrices with the contact as a spring, shape (n, k, k)."""
        contact = self.matrices.contact_vector
        spring = self.conditions.contact_stiffness * (contact[:, :, np.newaxis] * contact[:, np.newaxis, :])
        return np.asarray(self.matrices.stiffness_matrix + spring)

    @cached_property
    def loaded_poles(self) -> Complexes:
        """Poles on the loaded contact, in 1/s, ascending in modulus, shape (n, 2k)."""
        return _poles(self._inverse_mass, self.matrices.damping_matrix, self.loaded_stiffness)

    @cached_property
    def residual_pole(self) -> Complexes:
        """Oscillatory pole of least modulus on the loaded contact, else the pole of least modulus, shape (n,)."""
        oscillatory = self.loaded_poles.imag > _OSCILLATORY * np.abs(self.loaded_poles)
        return _at(self.loaded_poles, oscillatory.argmax(axis=1))

    @cached_property
    def residual_settling_time(self) -> Floats:
        """Longest settling time on the loaded contact but for the pair of poles of the driven mode, shape (n,). [s]"""
        distance = np.abs(np.abs(self.loaded_poles) / (2 * np.pi) - self.resonance[:, np.newaxis])
        others = np.argsort(distance, axis=1, kind="stable")[:, 2:]
        return np.asarray(settling_time_of(np.take_along_axis(self.loaded_poles, others, axis=1)).max(axis=1))

    @cached_property
    def driven_motion(self) -> Complexes:
        """Complex amplitudes of the coordinates per volt at the drive frequency, contact free, shape (n, k)."""
        return self.motion_per_volt(np.asarray(self.conditions.value("frequency")))

    def motion_per_volt(self, frequency: Floats) -> Complexes:
        """Complex amplitudes of the coordinates per volt at a frequency in Hz, contact free, shape (n, k)."""
        omega = 2 * np.pi * np.reshape(frequency, (-1, 1, 1))
        m = self.matrices
        dynamic = m.stiffness_matrix + 1j * omega * m.damping_matrix - omega**2 * m.mass_matrix
        motion = np.linalg.solve(dynamic, m.drive_vector[..., np.newaxis])[..., 0]
        return np.asarray(motion, dtype=np.complex128)

    def contact_amplitude(self, motion: Complexes) -> Floats:
        """Amplitude of the contact's displacement in a motion of shape (n, k), shape (n,)."""
        return np.asarray(np.abs(np.einsum("nk,nk->n", motion, self.matrices.contact_vector)))

    def natural_frequency(self, number: int, *, loaded: bool = False) -> Floats:
        """Natural frequency of a mode counted from 1, rigid ones left out, shape (n,). [Hz]"""
        frequency = self.natural_frequencies
        if loaded:
            frequency = self._frequencies_with(self.loaded_stiffness)
        index = np.count_nonzero(frequency == 0, axis=1) + number - 1
        if index.max() >= frequency.shape[1]:
            raise InvalidInput(f"the structure has fewer than {number} vibration modes")
        return _at(frequency, index)

    def quality_factor(self, number: int) -> Floats:
        """Quality factor of a mode counted from 1, rigid ones left out, contact free, shape (n,)."""
        return quality_factor_of(_nearest(self.free_poles, self.natural_frequency(number)))

    def static_displacement_per_volt(self) -> Floats:
        """Displacement of the free contact per volt of constant voltage, shape (n,). [m/V]"""
        omega = 2 * np.pi * self.natural_frequencies
        contact = np.einsum("nk,nkm->nm", self.matrices.contact_vector, self.mode_shapes)
        drive = np.einsum("nk,nkm->nm", self.matrices.drive_vector, self.mode_shapes)
        rigid = omega == 0
        if np.any(np.abs(contact[rigid]) > _FLOATING * np.abs(contact).max()):
            raise InvalidInput("the structure floats with its contact free: no static displacement is defined")
        return np.asarray(np.divide(contact * drive, omega**2, out=np.zeros_like(omega), where=~rigid).sum(axis=1))


def quality_factor_of(pole: Complexes) -> Floats:
    r"""Quality factor of a mode from its pole, :math:`|s|/(-2 \operatorname{Re} s)`."""
    modulus = np.abs(pole)
    return np.asarray(modulus / np.maximum(-2 * pole.real, modulus / _HIGHEST_QUALITY + _TINY))


def settling_time_of(pole: Complexes) -> Floats:
    r"""Time in which a transient decays to 2 %, :math:`\ln 50/(-\operatorname{Re} s)`. [s]"""
    return np.asarray(math.log(1 / _SETTLED) / np.maximum(-pole.real, _TINY))


def _natural_frequencies(squares: Floats) -> Floats:
    """Undamped natural frequencies in Hz from ascending squares of angular ones, zero for rigid modes, shape (n, k)."""
    rigid = squares <= _RIGID * squares[:, -1:]
    return np.asarray(np.sqrt(np.where(rigid, 0.0, squares)) / (2 * np.pi))


def _standard_form(mass_roots: Floats, stiffness: Floats) -> Floats:
    """Symmetric matrices L^-1 K L^-T, with the inverse of the Cholesky factors L of the mass."""
    return np.asarray(mass_roots @ stiffness @ mass_roots.transpose(0, 2, 1))


def _poles(inverse_mass: Floats, damping: Floats, stiffness: Floats) -> Complexes:
    """Poles of the free motion in 1/s, ascending in modulus, shape (n, 2k)."""
    k = inverse_mass.shape[-1]
    state = np.zeros((*inverse_mass.shape[:-2], 2 * k, 2 * k))
    state[..., :k, k:] = np.eye(k)
    state[..., k:, :k] = -inverse_mass @ stiffness
    state[..., k:, k:] = -inverse_mass @ damping
    poles = np.linalg.eigvals(state).astype(np.complex128)
    return np.asarray(np.take_along_axis(poles, np.argsort(np.abs(poles), axis=-1), axis=-1))


def _nearest(poles: Complexes, frequency: Floats) -> Complexes:
    """Pole whose modulus is nearest to a frequency in Hz, shape (n,)."""
    return _at(poles, np.abs(np.abs(poles) / (2 * np.pi) - frequency[:, np.newaxis]).argmin(axis=1))


def _at(values: NDArray[_Number], index: NDArray[np.intp]) -> NDArray[_Number]:
    """Element of an index in each row, shape (n,)."""
    return values[np.arange(len(values)), index]
