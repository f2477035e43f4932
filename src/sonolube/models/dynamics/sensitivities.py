"""Sensitivities of steady vibrations and their friction to every parameter, by the implicit function theorem."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, Floats, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.dynamics.friction_average.elliptic_quadrature import node_count_factor, quadrature_nodes
from sonolube.models.dynamics.gap_laws.closed_form import GapLaw
from sonolube.models.dynamics.harmonic_balance.equations import HarmonicBalanceEquations, HarmonicBalanceResidual
from sonolube.models.dynamics.linear import static_contact
from sonolube.models.dynamics.motions import Status, SteadyStates
from sonolube.models.dynamics.structure import Structure

_NEWTON_STEPS = 3  # that converge the solution to rounding before it is differentiated
_MIN_HARMONICS = 24


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StructureChange:
    """Derivative of a structure with respect to one parameter; what is not given does not depend on it.

    Parameters
    ----------
    mass_matrix, damping_matrix, stiffness_matrix : ndarray, shape (n, n), optional
        Derivatives of the matrices.
    drive_vector, contact_vector : ndarray, shape (n,), optional
        Derivatives of the vectors.
    """

    mass_matrix: Floats | None = None
    damping_matrix: Floats | None = None
    stiffness_matrix: Floats | None = None
    drive_vector: Floats | None = None
    contact_vector: Floats | None = None


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Sensitivities:
    """Derivatives of a batch of steady states with respect to each named parameter.

    Parameters
    ----------
    vibration_amplitude : mapping of str to ndarray, shape (...)
        Derivative of the amplitude, per unit of the parameter. [m]
    mean_displacement : mapping of str to ndarray, shape (...)
        Derivative of the mean displacement, per unit of the parameter. [m]
    kinematic : mapping of str to ndarray, shape (..., speeds)
        Derivative of `FrictionAverages.kinematic`, per unit of the parameter.
    """

    vibration_amplitude: dict[str, Floats]
    mean_displacement: dict[str, Floats]
    kinematic: dict[str, Floats]


def steady_state_sensitivities(
    states: SteadyStates,
    *,
    sliding_speed: ArrayLike = (),
    structure_changes: Mapping[str, StructureChange] | None = None,
) -> Sensitivities:
    r"""Sensitivities of amplitude, mean displacement and kinematic friction factor to every parameter.

    Parameters
    ----------
    states : SteadyStates
    sliding_speed : array_like, shape (speeds,)
        Sliding speeds of the friction factor. [m/s]
    structure_changes : mapping of str to StructureChange, optional
        Parameters of the structure, by names of the caller's choice.

    Returns
    -------
    Sensitivities
        With respect to "normal_load", "frequency", "voltage_scale" (a factor on the drive except its mean),
        "voltage_offset", the parameters of the gap law by their names, and those given.

    Raises
    ------
    InvalidInput
        If a state did not converge, a speed is not positive, or a name of `structure_changes` is taken.

    Notes
    -----
    One linear system per state serves all parameters p: the residual :math:`R(u, p) = 0` of harmonic balance gives

    .. math:: \frac{du}{dp} = -\left(\frac{\partial R}{\partial u}\right)^{-1} \frac{\partial R}{\partial p} .
    """
    if np.any(states.status == Status.NOT_CONVERGED):
        raise InvalidInput("states must have converged: a point without a vibration has no sensitivities")
    speeds = np.atleast_1d(require_positive(sliding_speed=sliding_speed)) if np.size(sliding_speed) else np.empty(0)
    changes = dict(structure_changes or {})
    shape = states.frequency.shape
    rows = [_one_state(states, index, speeds, changes) for index in np.ndindex(shape)]
    names = list(rows[0]) if rows else []

    def column(which: int, *inner: int) -> dict[str, Floats]:
        return {name: np.array([row[name][which] for row in rows], float).reshape((*shape, *inner)) for name in names}

    return Sensitivities(vibration_amplitude=column(0), mean_displacement=column(1), kinematic=column(2, speeds.size))


def _one_state(
    states: SteadyStates, index: tuple[int, ...], speeds: Floats, changes: dict[str, StructureChange]
) -> dict[str, tuple[float, float, Floats]]:
    """Derivatives of amplitude, mean displacement and friction factor of one state, by parameter."""
    balance = _converged_residual(states, index)
    own, structure = balance.equations, states.structure
    residuals = {
        "normal_load": own.stack(1.0, np.zeros(0, dtype=complex)),
        "frequency": 2 * np.pi * balance.by_omega,
        "voltage_scale": balance.by_scale,
        "voltage_offset": own.stack(
            -own.static_stiffness * (static_contact(structure).displacement_per_volt or 0.0), np.zeros(0, dtype=complex)
        ),
    }
    for name, change in _force_by_law(states.gap_law, balance).items():
        residuals[name] = residuals.get(name, 0.0) + balance.by_force(change)
    for name, structural in changes.items():
        if name in residuals:
            raise InvalidInput(f"structure_changes must not be named {name!r}, which is taken")
        residuals[name] = _residual_by_structure(structure, balance, structural)
    names = list(residuals)
    derivatives = -np.linalg.solve(balance.jacobian, np.array([residuals[name] for name in names]).T).T
    slowest = speeds.min(initial=np.inf) / (balance.omega * abs(states.harmonics[index][0]) + 1e-300)
    factor = int(node_count_factor(states.harmonics[index].reshape(1, -1))[0])
    nodes, weights = quadrature_nodes(states.extremum_phases[index], min(slowest, 1.0), factor)
    extrema = _extremum_phases(states, index)
    return {
        name: _outputs(balance, change, extrema, nodes, weights, speeds, 2 * np.pi if name == "frequency" else 0.0)
        for name, change in zip(names, derivatives, strict=True)
    }


def _converged_residual(states: SteadyStates, index: tuple[int, ...]) -> HarmonicBalanceResidual:
    """Equations of one state at a solution converged to rounding, with twice its harmonics."""
    orders = max(2 * int(states.harmonic_count[index]), _MIN_HARMONICS)
    equations = HarmonicBalanceEquations(
        structure=states.structure,
        gap_law=states.gap_law,
        normal_load=float(states.normal_load[index]),
        voltage_harmonics=states.voltage_harmonics[index],
        voltage_offset=float(states.voltage_offset[index]),
        orders=orders,
        samples=max(8 * orders, 256),
    )
    omega = 2 * np.pi * float(states.frequency[index])
    unknowns = equations.stack(float(states.mean_displacement[index]), states.harmonics[index])
    for _ in range(_NEWTON_STEPS):
        balance = equations.at(unknowns, omega=omega, scale=1.0)
        unknowns = unknowns - np.linalg.solve(balance.jacobian, balance.residual)
    return equations.at(unknowns, omega=omega, scale=1.0)


def _force_by_law(gap_law: GapLaw, balance: HarmonicBalanceResidual) -> dict[str, Floats]:
    """Derivatives of the contact force over the period by the load and each parameter of the law."""
    load, x = balance.equations.normal_load, balance.displacement
    factor = np.maximum(1 - gap_law.force_damping * balance.velocity, 0.0)
    by_damping = -gap_law.force(x, load) * balance.velocity * (factor > 0)
    elastic = gap_law.force_derivatives(x, load)
    return {"force_damping": by_damping} | {name: factor * change for name, change in elastic.items()}


def _residual_by_structure(structure: Structure, balance: HarmonicBalanceResidual, change: StructureChange) -> Floats:
    """Derivative of the residual by one parameter of the structure."""
    own, k = balance.equations, balance.equations.multiples[:, np.newaxis, np.newaxis] * balance.omega
    stiffness, damping, mass = (
        np.zeros_like(whole) if part is None else np.asarray(part, dtype=np.float64)
        for part, whole in (
            (change.stiffness_matrix, structure.stiffness_matrix),
            (change.damping_matrix, structure.damping_matrix),
            (change.mass_matrix, structure.mass_matrix),
        )
    )
    residual = balance.by_dynamic_stiffness(stiffness + 1j * k * damping - k**2 * mass)  # type: ignore[arg-type]
    harmonics = np.zeros(own.orders, dtype=np.complex128)
    if change.drive_vector is not None:
        harmonics -= (balance.per_force @ change.drive_vector) * own.voltage
    if change.contact_vector is not None:
        harmonics -= balance.coordinates @ change.contact_vector
        harmonics -= (balance.per_force @ change.contact_vector) * balance.force_harmonics
    residual = residual + own.stack(0.0, harmonics)
    if own.static_stiffness > 0:
        residual[0] += _static_residual_by_structure(structure, balance, change, stiffness)
    return residual


def _static_residual_by_structure(
    structure: Structure, balance: HarmonicBalanceResidual, change: StructureChange, stiffness: Floats
) -> float:
    """Derivative of the static equation's residual, S_0 (mean - static displacement) - (mean force - load).

    It is -S_0 times the derivative of the mean displacement under constant mean force and voltage.
    """
    own, mean = balance.equations, float(balance.unknowns[0])
    per_force = np.linalg.solve(structure.stiffness_matrix, structure.contact_vector)
    coordinates = per_force * own.static_stiffness * (mean - own.static_displacement) + np.linalg.solve(
        structure.stiffness_matrix, structure.drive_vector * own.voltage_offset
    )
    displacement = -float(per_force @ stiffness @ coordinates)
    if change.drive_vector is not None:
        displacement += float(per_force @ change.drive_vector) * own.voltage_offset
    if change.contact_vector is not None:
        displacement += float(change.contact_vector @ coordinates)
        by_vector = float(per_force @ change.contact_vector)
        displacement += by_vector * own.static_stiffness * (mean - own.static_displacement)
    return -own.static_stiffness * displacement


def _extremum_phases(states: SteadyStates, index: tuple[int, ...]) -> Floats:
    """Phases of the highest and the lowest displacement of one state, however many extrema it has."""
    if np.all(np.isfinite(states.extremum_phases[index])):
        return states.extremum_phases[index]  # type: ignore[no-any-return]
    harmonics, k = states.harmonics[index], np.arange(1, states.harmonics.shape[-1] + 1)
    phases = 2 * np.pi * np.arange(4096) / 4096
    x = (np.exp(1j * np.multiply.outer(phases, k)) @ harmonics).real
    found = np.array([phases[np.argmax(x)], phases[np.argmin(x)]])
    for _ in range(4):
        z = np.exp(1j * np.multiply.outer(found, k))
        found = found - (z @ (1j * k * harmonics)).real / (z @ (-(k**2) * harmonics)).real
    return found


def _outputs(
    balance: HarmonicBalanceResidual,
    derivative: Floats,
    extrema: Floats,
    nodes: Complexes,
    weights: Floats,
    speeds: Floats,
    omega_derivative: float,
) -> tuple[float, float, Floats]:
    r"""Derivatives of amplitude, mean displacement and friction factor from those of the unknowns.

    Notes
    -----
    .. math:: \frac{d}{dp} \frac{v_r}{\sqrt{v_r^2 + v^2}} = -\frac{v_r v}{(v_r^2 + v^2)^{3/2}}\,\frac{dv}{dp}
    """
    own = balance.equations
    _, harmonics = own.unstack(balance.unknowns)
    by_mean, by_harmonics = own.unstack(derivative)
    high, low = np.exp(1j * np.multiply.outer(extrema, own.multiples)) @ by_harmonics
    powers = nodes[:, np.newaxis] ** own.multiples
    velocity = (powers @ (1j * balance.omega * own.multiples * harmonics)).real
    change = balance.omega * by_harmonics + omega_derivative * harmonics
    velocity_change = (powers @ (1j * own.multiples * change)).real
    speed = speeds[:, np.newaxis]
    slope = -speed * velocity / (speed**2 + velocity**2) ** 1.5
    return 0.5 * float((high - low).real), by_mean, (slope * velocity_change) @ weights
