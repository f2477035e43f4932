"""The equations of harmonic balance of one point, with all their derivatives, in plain array language.

Unknowns are stacked as mean, real parts and imaginary parts of the contact's harmonics. The compiled kernel solves the
same equations for many points at once; these serve where derivatives are wanted, along curves and by parameters.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.dynamics.gap_law import GapLaw
from sonolube.dynamics.linear import static_contact
from sonolube.dynamics.structure import Structure


@dataclass(frozen=True, kw_only=True)
class PointEquations:
    """One structure, contact and drive.

    Parameters
    ----------
    structure : Structure
    gap_law : GapLaw
    normal_load : float
        Dead load F_N. [N]
    voltage_harmonics : ndarray of complex, shape (K,)
        Harmonics of the drive, in V, before scaling.
    voltage_offset : float
        Mean of the drive. [V]
    orders : int
        Harmonics H of the contact.
    samples : int
        Instants at which its force is taken.
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
        """Static stiffness at the contact, zero where the structure floats, in N/m."""
        return static_contact(self.structure).static_stiffness

    @cached_property
    def static_displacement(self) -> float:
        """Mean displacement of the contact without contact force, in m."""
        return (static_contact(self.structure).displacement_per_volt or 0.0) * self.voltage_offset

    @cached_property
    def multiples(self) -> Floats:
        """Orders of the harmonics."""
        return np.arange(1.0, self.orders + 1)

    @cached_property
    def turning(self) -> Complexes:
        """The exponentials exp(i k theta), one instant a row."""
        return np.exp(2j * np.pi * np.multiply.outer(np.arange(self.samples) / self.samples, self.multiples))

    @cached_property
    def voltage(self) -> Complexes:
        """Harmonics of the drive, padded with zeros."""
        padded = np.zeros(self.orders, dtype=np.complex128)
        padded[: self.voltage_harmonics.size] = self.voltage_harmonics
        return padded

    def stack(self, mean: float, harmonics: Complexes) -> Floats:
        """Return the vector of unknowns."""
        own = np.zeros(self.orders, dtype=np.complex128)
        own[: harmonics.size] = harmonics[: self.orders]
        return np.concatenate([[mean], own.real, own.imag])

    def unstack(self, unknowns: Floats) -> tuple[float, Complexes]:
        """Return mean and harmonics."""
        return float(unknowns[0]), unknowns[1 : self.orders + 1] + 1j * unknowns[self.orders + 1 :]

    def at(self, unknowns: Floats, *, omega: float, scale: float) -> "Balance":
        """Return the equations at a guess.

        Parameters
        ----------
        unknowns : ndarray, shape (2H + 1,)
        omega : float
            Angular frequency of the drive, in rad/s.
        scale : float
            Factor on the harmonics of the drive.

        Returns
        -------
        Balance
        """
        mean, harmonics = self.unstack(unknowns)
        x = mean + (self.turning @ harmonics).real
        v = (self.turning @ (1j * omega * self.multiples * harmonics)).real
        elastic = self.gap_law.force(x, self.normal_load)
        lag = self.gap_law.force_damping
        share = np.maximum(1 - lag * v, 0.0)
        return Balance(
            equations=self,
            omega=omega,
            scale=scale,
            unknowns=unknowns,
            displacement=x,
            velocity=v,
            force=share * elastic,
            stiffness=share * self.gap_law.stiffness(x, self.normal_load),
            damping=lag * elastic * (share > 0),
        )


@dataclass(frozen=True, kw_only=True)
class Balance:
    """The equations at one guess; arrays over one period.

    Parameters
    ----------
    equations : PointEquations
    omega : float
        Angular frequency of the drive, in rad/s.
    scale : float
        Factor on the drive.
    unknowns : ndarray, shape (2H + 1,)
    displacement : ndarray, shape (samples,)
        Displacement of the contact. [m]
    velocity : ndarray, shape (samples,)
        Its velocity, in m/s.
    force : ndarray, shape (samples,)
        Contact force, in N.
    stiffness, damping : ndarray, shape (samples,)
        Fall of the force per displacement and per velocity, in N/m and N s/m.
    """

    equations: PointEquations
    omega: float
    scale: float
    unknowns: Floats
    displacement: Floats
    velocity: Floats
    force: Floats
    stiffness: Floats
    damping: Floats

    @cached_property
    def to_force(self) -> Complexes:
        """Coordinates per unit force on the contact at each harmonic, shape (H, n)."""
        return self._response(self.equations.structure.contact_vector)

    @cached_property
    def to_volt(self) -> Complexes:
        """Coordinates per volt at each harmonic, shape (H, n)."""
        return self._response(self.equations.structure.drive_vector)

    @cached_property
    def force_harmonics(self) -> Complexes:
        """Harmonics of the contact force, in N."""
        return 2 * _spectrum(self.force)[1 : self.equations.orders + 1]

    @cached_property
    def coordinates(self) -> Complexes:
        """Harmonics of all coordinates under drive and contact force, shape (H, n)."""
        driven = self.to_volt * (self.scale * self.equations.voltage)[:, np.newaxis]
        return driven + self.to_force * self.force_harmonics[:, np.newaxis]

    @cached_property
    def residual(self) -> Floats:
        """What is left of each equation."""
        own, (mean, harmonics) = self.equations, self.equations.unstack(self.unknowns)
        static = own.static_stiffness * (mean - own.static_displacement) - (float(self.force.mean()) - own.normal_load)
        return own.stack(static, harmonics - self.coordinates @ own.structure.contact_vector)

    @cached_property
    def jacobian(self) -> Floats:
        """Derivatives of the residual by the unknowns, shape (2H + 1, 2H + 1)."""
        own = self.equations
        k = own.multiples.astype(np.int64)
        stiffness, damping = _spectrum(self.stiffness), 1j * self.omega * k * _spectrum(self.damping)[:, np.newaxis]
        apart, summed, column = np.subtract.outer(k, k), np.add.outer(k, k), np.arange(own.orders)
        direct = stiffness[apart] + damping[apart, column]
        mirrored = stiffness[summed] - damping[summed, column]
        on_mean = stiffness[-k] + damping[-k, column]
        receptance = (self.to_force @ own.structure.contact_vector)[:, np.newaxis]
        by_mean, by_real, by_imaginary = (
            receptance * falls
            for falls in (2 * stiffness[k][:, np.newaxis], direct + mirrored, 1j * (direct - mirrored))
        )
        unit = np.eye(own.orders)
        return np.block(
            [
                [
                    np.array([[own.static_stiffness + stiffness[0].real]]),
                    on_mean.real[np.newaxis],
                    -on_mean.imag[np.newaxis],
                ],
                [by_mean.real, unit + by_real.real, by_imaginary.real],
                [by_mean.imag, by_real.imag, unit + by_imaginary.imag],
            ]
        )

    @cached_property
    def by_scale(self) -> Floats:
        """Derivative of the residual by the factor on the drive."""
        own = self.equations
        return own.stack(0.0, -(self.to_volt @ own.structure.contact_vector) * own.voltage)

    @cached_property
    def by_omega(self) -> Floats:
        """Derivative of the residual by the angular frequency, the unknowns held."""
        structure, k = self.equations.structure, self.equations.multiples[:, np.newaxis, np.newaxis]
        change = 1j * k * structure.damping_matrix - 2 * k**2 * self.omega * structure.mass_matrix
        return self.by_stiffness(change) + self.by_force(-self.damping * self.velocity / self.omega)  # type: ignore[arg-type]

    def by_stiffness(self, change: Complexes) -> Floats:
        """Return the derivative of the residual by a change of the dynamic stiffness, shape (H, n, n)."""
        return self.equations.stack(0.0, np.einsum("ki,kij,kj->k", self.to_force, change, self.coordinates))

    def by_force(self, change: Floats) -> Floats:
        """Return the derivative of the residual by a change of the force over the period."""
        spectrum = _spectrum(change)
        receptance = self.to_force @ self.equations.structure.contact_vector
        harmonics = -receptance * 2 * spectrum[1 : self.equations.orders + 1]
        return self.equations.stack(-float(spectrum[0].real), harmonics)

    def _response(self, force: Floats) -> Complexes:
        structure, k = self.equations.structure, self.equations.multiples[:, np.newaxis, np.newaxis]
        stiffness = (
            structure.stiffness_matrix
            + 1j * k * self.omega * structure.damping_matrix
            - (k * self.omega) ** 2 * structure.mass_matrix
        )
        return np.asarray(
            np.linalg.solve(stiffness, np.broadcast_to(force + 0j, stiffness.shape[:-1])[..., np.newaxis])
        )[..., 0]


def _spectrum(samples: Floats) -> Complexes:
    return np.asarray(np.fft.fft(samples) / samples.size, dtype=np.complex128)
