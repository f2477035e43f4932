"""Equations of harmonic balance: receptances in pole-residue form; residual and derivatives of a single point.

All that a contact at one point and a drive at one port require of a linear structure are three frequency responses:
displacement per contact force, displacement per volt (equal to charge per force), and charge per volt. Each is a sum
over the uncoupled pairs of states of `FirstOrderModes`.

The residual in numpy has as unknowns the mean, real parts and imaginary parts of the contact's displacement harmonics.
The compiled kernel solves the same equations for batches; these serve continuation and sensitivities, which need
derivatives by parameters::

    R_0 = S_0 (mean - mean_0) - (mean force - F_N)
    R_k = X_k - c^T D(k omega)^-1 (b V_k + c Phi_k)
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.errors import InvalidInput
from sonolube.execution.compilation import kernel
from sonolube.models.dynamics.gap_laws.closed_form import GapLaw
from sonolube.models.dynamics.kernels.simd import INNER, LANES
from sonolube.models.dynamics.linear import first_order_modes, modes, static_contact
from sonolube.models.dynamics.structure import Structure

_NEGLIGIBLE = 1e-9  # participation of a mode in contact or drive, over the largest, that is rounding

CONTACT_PER_FORCE, CONTACT_PER_VOLT, CHARGE_PER_VOLT = range(3)
"""Rows of the numerators of `PoleResidueModel`; displacement per volt is also charge per contact force. []"""


class PoleResidueModel(NamedTuple):
    r"""Pairs of states of a structure that its contact or its drive excites or observes, m of them.

    Notes
    -----
    The pair s of states obeys :math:`\dot s = A s + b V + c\,(F_n - F_N)`. A receptance is

    .. math:: G(\omega) = \sum_j \frac{n_j + i\omega\, r_j}{\det A_j - \omega^2 - i\omega\,\mathrm{tr} A_j} .
    """

    state_matrix: Floats  # (m, 2, 2): A, in 1/s
    contact_input: Floats  # (m, 2): c
    displacement_output: Floats  # (m, 2): displacement of the contact per state
    velocity_output: Floats  # (m, 2): velocity of the contact per state
    determinant: Floats  # (m,) of A
    trace: Floats  # (m,) of A
    numerator_constant: Floats  # (3, m): n, rows CONTACT_PER_FORCE to CHARGE_PER_VOLT
    numerator_slope: Floats  # (3, m): r, likewise
    static_stiffness: float  # at the contact, in N/m; zero for a floating structure
    displacement_per_volt: float  # static, of the free contact, in m/V; zero for a floating structure
    clamped_capacitance: float  # in F

    def contact_poles(self) -> Floats:
        """Determinant, trace, numerator constant and slope of the contact receptance, shape (4, m)."""
        constant, slope = self.numerator_constant[CONTACT_PER_FORCE], self.numerator_slope[CONTACT_PER_FORCE]
        return np.array([self.determinant, self.trace, constant, slope])


@lru_cache(maxsize=16)
def pole_residue_model(structure: Structure) -> PoleResidueModel:
    """Receptances of a structure in pole-residue form."""
    natural = modes(structure)
    contact = np.abs(structure.contact_vector @ natural.shapes)
    drive = np.abs(structure.drive_vector @ natural.shapes)
    if not np.any(contact):
        raise InvalidInput("contact_vector must not be zero: the contact would never move")
    if np.any(drive[natural.rigid] > _NEGLIGIBLE * drive.max()):
        raise InvalidInput("drive_vector drives a rigid-body mode of the structure, which then has no steady state")
    pairs, static = first_order_modes(structure), static_contact(structure)
    displacement = np.einsum("j,jpa->pa", structure.contact_vector, pairs.to_displacement)
    charge = np.einsum("j,jpa->pa", structure.drive_vector, pairs.to_displacement)
    kept = _participates(pairs.contact_input) | _participates(pairs.drive_input)
    trace = np.trace(pairs.state_matrix, axis1=1, axis2=2)
    minus_adjugate = pairs.state_matrix - trace[:, np.newaxis, np.newaxis] * np.eye(2)
    ports = (  # output and input vectors, in the order of the rows
        (displacement, pairs.contact_input),
        (displacement, pairs.drive_input),
        (charge, pairs.drive_input),
    )
    return PoleResidueModel(
        state_matrix=np.ascontiguousarray(pairs.state_matrix[kept]),
        contact_input=np.ascontiguousarray(pairs.contact_input[kept]),
        displacement_output=np.ascontiguousarray(displacement[kept]),
        velocity_output=np.einsum("j,jpa->pa", structure.contact_vector, pairs.to_velocity)[kept],
        determinant=np.linalg.det(pairs.state_matrix)[kept],
        trace=trace[kept],
        numerator_constant=np.array(
            [np.einsum("pa,pab,pb->p", out, minus_adjugate, into)[kept] for out, into in ports]
        ),
        numerator_slope=np.array([np.einsum("pa,pa->p", out, into)[kept] for out, into in ports]),
        static_stiffness=static.static_stiffness,
        displacement_per_volt=static.displacement_per_volt or 0.0,
        clamped_capacitance=structure.clamped_capacitance,
    )


def _participates(inputs: Floats) -> np.ndarray:
    """Which pairs of states an input excites, beyond rounding."""
    size = np.abs(inputs).max(axis=1)
    return np.asarray(size > _NEGLIGIBLE * size.max(initial=0.0))


def receptance(model: PoleResidueModel, response: int, omega: Floats) -> Complexes:
    """Receptance at angular frequencies, by its pole-residue form; in m/N, m/V (which is C/N) or C/V."""
    real, imaginary = np.zeros((2, *omega.shape))
    square = np.square(omega)
    for constant, slope, determinant, trace in zip(
        model.numerator_constant[response], model.numerator_slope[response], model.determinant, model.trace, strict=True
    ):
        re, im, rise = determinant - square, -trace * omega, slope * omega
        inverse = 1 / (re * re + im * im)
        real += (constant * re + rise * im) * inverse
        imaginary += (rise * re - constant * im) * inverse
    return np.asarray(real + 1j * imaginary)


@kernel(**INNER)
def contact_receptances(poles: Floats, omega: Floats, order: float, receptances: Floats) -> None:
    """Write the contact receptance at a multiple of the angular frequency of each SIMD lane.

    `poles` has shape (4, m). `receptances` has shape (2, lanes).
    """
    for lane in range(LANES):
        receptances[0, lane], receptances[1, lane] = 0.0, 0.0
    for pair in range(poles.shape[1]):
        determinant, trace = poles[0, pair], poles[1, pair] * order
        constant, slope = poles[2, pair], poles[3, pair] * order
        for lane in range(LANES):
            re = determinant - order * omega[lane] * order * omega[lane]
            im = -trace * omega[lane]
            inverse = 1 / (re * re + im * im)
            rise = slope * omega[lane]
            receptances[0, lane] += (constant * re + rise * im) * inverse
            receptances[1, lane] += (rise * re - constant * im) * inverse


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
        return HarmonicBalanceResidual(self, unknowns, omega=omega, scale=scale)


class HarmonicBalanceResidual:
    """Residual of harmonic balance at one vector of unknowns, with its derivatives; samples span one period.

    Parameters
    ----------
    equations : HarmonicBalanceEquations
    unknowns : ndarray, shape (2H + 1,)
    omega : float
        Angular frequency of the drive, in rad/s.
    scale : float
        Factor on the harmonics of the drive.

    Attributes
    ----------
    displacement : ndarray, shape (samples,)
        Displacement of the contact. [m]
    velocity : ndarray, shape (samples,)
        Velocity of the contact, in m/s.
    force : ndarray, shape (samples,)
        Contact force, in N.
    stiffness, damping : ndarray, shape (samples,)
        Contact stiffness -dF/dx, in N/m, and damping -dF/dv, in N s/m.
    """

    def __init__(self, equations: HarmonicBalanceEquations, unknowns: Floats, *, omega: float, scale: float) -> None:
        self.equations, self.unknowns, self.omega, self.scale = equations, unknowns, omega, scale
        law, load, (mean, harmonics) = equations.gap_law, equations.normal_load, equations.unstack(unknowns)
        self.displacement: Floats = mean + (equations.basis @ harmonics).real
        self.velocity: Floats = (equations.basis @ (1j * omega * equations.multiples * harmonics)).real
        elastic = law.force(self.displacement, load)
        factor = np.maximum(1 - law.force_damping * self.velocity, 0.0)
        self.force = factor * elastic
        self.stiffness = factor * law.stiffness(self.displacement, load)
        self.damping = law.force_damping * elastic * (factor > 0)

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
