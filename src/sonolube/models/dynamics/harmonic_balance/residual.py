r"""Residual and derivatives of the equations of harmonic balance of a single point, in numpy.

The unknowns are stacked as mean, real parts and imaginary parts of the contact's displacement harmonics. The compiled
kernel solves the same equations for batches; these serve continuation and sensitivities, which need derivatives by
parameters.

.. math::
    R_0 = S_0\,(\bar x - \bar x_0) - (\bar F_n - F_N), \qquad
    R_k = X_k - c^T D(k\omega)^{-1}\,(b\,V_k + c\,\Phi_k)
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.models.dynamics.gap_laws.protocol import GapLaw
from sonolube.models.dynamics.linear import static_contact
from sonolube.models.dynamics.structure import Structure


@dataclass(frozen=True, kw_only=True)
class HarmonicBalanceEquations:
    """Equations of harmonic balance of one structure, contact and drive.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : float
        Dead load F_N. [N]
    voltage_harmonics : ndarray of complex, shape (K,)
        Harmonics of the drive before scaling, in V.
    voltage_offset : float
        Mean of the drive. [V]
    orders : int
        Number of harmonics H of the contact.
    samples : int
        Number of samples of the contact force per period.
    """

    structure: Structure
    gap_law: GapLaw
    normal_load: float
    voltage_harmonics: Complexes
    voltage_offset: float
    orders: int
    samples: int

    @cached_property
    def static_stiffness(self) -> float:
        """Static stiffness S_0 at the contact, zero for a floating structure, in N/m."""
        return static_contact(self.structure).static_stiffness

    @cached_property
    def static_displacement(self) -> float:
        """Mean displacement of the contact without contact force, in m."""
        return (static_contact(self.structure).displacement_per_volt or 0.0) * self.voltage_offset

    @cached_property
    def multiples(self) -> Floats:
        """Orders k of the harmonics."""
        return np.arange(1.0, self.orders + 1)

    @cached_property
    def basis(self) -> Complexes:
        """Basis functions exp(i k theta), one row per sample."""
        return np.exp(2j * np.pi * np.multiply.outer(np.arange(self.samples) / self.samples, self.multiples))

    @cached_property
    def voltage(self) -> Complexes:
        """Harmonics of the drive, padded with zeros to H."""
        padded = np.zeros(self.orders, dtype=np.complex128)
        padded[: self.voltage_harmonics.size] = self.voltage_harmonics
        return padded

    def stack(self, mean: float, harmonics: Complexes) -> Floats:
        """Vector of unknowns from mean and harmonics."""
        own = np.zeros(self.orders, dtype=np.complex128)
        own[: harmonics.size] = harmonics[: self.orders]
        return np.concatenate([[mean], own.real, own.imag])

    def unstack(self, unknowns: Floats) -> tuple[float, Complexes]:
        """Mean and harmonics from the vector of unknowns."""
        return float(unknowns[0]), unknowns[1 : self.orders + 1] + 1j * unknowns[self.orders + 1 :]

    def at(self, unknowns: Floats, *, omega: float, scale: float) -> "HarmonicBalanceResidual":
        """Residual and derivatives at a vector of unknowns; `unknowns` has shape (2H + 1,)."""
        mean, harmonics = self.unstack(unknowns)
        x = mean + (self.basis @ harmonics).real
        v = (self.basis @ (1j * omega * self.multiples * harmonics)).real
        elastic = self.gap_law.force(x, self.normal_load)
        tau = self.gap_law.force_damping
        factor = np.maximum(1 - tau * v, 0.0)
        return HarmonicBalanceResidual(
            equations=self,
            omega=omega,
            scale=scale,
            unknowns=unknowns,
            displacement=x,
            velocity=v,
            force=factor * elastic,
            stiffness=factor * self.gap_law.stiffness(x, self.normal_load),
            damping=tau * elastic * (factor > 0),
        )


@dataclass(frozen=True, kw_only=True)
class HarmonicBalanceResidual:
    """Residual of harmonic balance at one vector of unknowns, with its derivatives; samples span one period.

    Parameters
    ----------
    equations : HarmonicBalanceEquations
    omega : float
        Angular frequency of the drive, in rad/s.
    scale : float
        Factor on the harmonics of the drive.
    unknowns : ndarray, shape (2H + 1,)
    displacement : ndarray, shape (samples,)
        Displacement of the contact. [m]
    velocity : ndarray, shape (samples,)
        Velocity of the contact, in m/s.
    force : ndarray, shape (samples,)
        Contact force, in N.
    stiffness, damping : ndarray, shape (samples,)
        Contact stiffness -dF/dx, in N/m, and damping -dF/dv, in N s/m.
    """

    equations: HarmonicBalanceEquations
    omega: float
    scale: float
    unknowns: Floats
    displacement: Floats
    velocity: Floats
    force: Floats
    stiffness: Floats
    damping: Floats

    @cached_property
    def per_force(self) -> Complexes:
        """Coordinates per contact force at each harmonic, D^-1 c, shape (H, n)."""
        return self._response(self.equations.structure.contact_vector)

    @cached_property
    def per_volt(self) -> Complexes:
        """Coordinates per volt at each harmonic, D^-1 b, shape (H, n)."""
        return self._response(self.equations.structure.drive_vector)

    @cached_property
    def force_harmonics(self) -> Complexes:
        """Harmonics Phi_k of the contact force, in N."""
        return 2 * _fourier_coefficients(self.force)[1 : self.equations.orders + 1]

    @cached_property
    def coordinates(self) -> Complexes:
        """Harmonics of all coordinates under drive and contact force, shape (H, n)."""
        driven = self.per_volt * (self.scale * self.equations.voltage)[:, np.newaxis]
        return driven + self.per_force * self.force_harmonics[:, np.newaxis]

    @cached_property
    def residual(self) -> Floats:
        """Residual of each equation, shape (2H + 1,)."""
        own, (mean, harmonics) = self.equations, self.equations.unstack(self.unknowns)
        static = own.static_stiffness * (mean - own.static_displacement) - (float(self.force.mean()) - own.normal_load)
        return own.stack(static, harmonics - self.coordinates @ own.structure.contact_vector)

    @cached_property
    def jacobian(self) -> Floats:
        r"""Derivatives of the residual by the unknowns, shape (2H + 1, 2H + 1).

        With the Fourier coefficients :math:`\hat s_m` of the stiffness and :math:`\hat d_m` of the damping,

        .. math::
            -\Delta\Phi_k = 2\hat s_k\,\Delta\bar x
            + \sum_j \left(\hat s_{k-j} + ij\omega\,\hat d_{k-j}\right) \Delta X_j
            + \left(\hat s_{k+j} - ij\omega\,\hat d_{k+j}\right) \Delta X_j^* .
        """
        own = self.equations
        k = own.multiples.astype(np.int64)
        stiffness = _fourier_coefficients(self.stiffness)
        damping = 1j * self.omega * k * _fourier_coefficients(self.damping)[:, np.newaxis]
        minus, plus, column = np.subtract.outer(k, k), np.add.outer(k, k), np.arange(own.orders)
        direct = stiffness[minus] + damping[minus, column]
        conjugate = stiffness[plus] - damping[plus, column]
        on_mean = stiffness[-k] + damping[-k, column]
        receptance = (self.per_force @ own.structure.contact_vector)[:, np.newaxis]
        by_mean, by_real, by_imaginary = (
            receptance * derivative
            for derivative in (2 * stiffness[k][:, np.newaxis], direct + conjugate, 1j * (direct - conjugate))
        )
        unit, mean = np.eye(own.orders), np.array([[own.static_stiffness + stiffness[0].real]])
        return np.block(
            [
                [mean, on_mean.real[np.newaxis], -on_mean.imag[np.newaxis]],
                [by_mean.real, unit + by_real.real, by_imaginary.real],
                [by_mean.imag, by_real.imag, unit + by_imaginary.imag],
            ]
        )

    @cached_property
    def by_scale(self) -> Floats:
        """Derivative of the residual by the factor on the drive."""
        own = self.equations
        return own.stack(0.0, -(self.per_volt @ own.structure.contact_vector) * own.voltage)

    @cached_property
    def by_omega(self) -> Floats:
        """Derivative of the residual by the angular frequency at constant unknowns."""
        structure, k = self.equations.structure, self.equations.multiples[:, np.newaxis, np.newaxis]
        change = 1j * k * structure.damping_matrix - 2 * k**2 * self.omega * structure.mass_matrix
        return self.by_dynamic_stiffness(change) + self.by_force(-self.damping * self.velocity / self.omega)  # type: ignore[arg-type]

    def by_dynamic_stiffness(self, change: Complexes) -> Floats:
        """Derivative of the residual by a change of the dynamic stiffness, shape (H, n, n)."""
        return self.equations.stack(0.0, np.einsum("ki,kij,kj->k", self.per_force, change, self.coordinates))

    def by_force(self, change: Floats) -> Floats:
        """Derivative of the residual by a change of the contact force over the period, shape (samples,)."""
        coefficients = _fourier_coefficients(change)
        receptance = self.per_force @ self.equations.structure.contact_vector
        harmonics = -receptance * 2 * coefficients[1 : self.equations.orders + 1]
        return self.equations.stack(-float(coefficients[0].real), harmonics)

    def _response(self, force: Floats) -> Complexes:
        """Coordinates under a unit generalised force at each harmonic, shape (H, n)."""
        own, omega = self.equations.structure, self.omega * self.equations.multiples[:, np.newaxis, np.newaxis]
        stiffness = own.stiffness_matrix + 1j * omega * own.damping_matrix - omega**2 * own.mass_matrix
        forces = np.broadcast_to(force + 0j, stiffness.shape[:-1])[..., np.newaxis]
        return np.asarray(np.linalg.solve(stiffness, forces))[..., 0]


def _fourier_coefficients(samples: Floats) -> Complexes:
    """Complex Fourier coefficients of one period of samples."""
    return np.asarray(np.fft.fft(samples) / samples.size, dtype=np.complex128)
