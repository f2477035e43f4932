"""How a steady vibration and its friction change with every parameter, by the implicit function theorem."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, Floats, require_positive
from sonolube.dynamics.friction_average.elliptic_quadrature import fineness_of, phases_of
from sonolube.dynamics.gap_law import ExponentialGap, GapLaw, HertzGap, LinearGap, TabulatedGap
from sonolube.dynamics.harmonic_balance.residual import Balance, PointEquations
from sonolube.dynamics.linear import static_contact
from sonolube.dynamics.steady_state import Status, SteadyStates
from sonolube.dynamics.structure import Structure
from sonolube.errors import InvalidInput

_POLISH = 3  # Newton steps that make the solution exact to rounding before it is differentiated
_LEAST = 24  # harmonics


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StructureChange:
    """Derivative of a structure by one parameter; what is not given does not depend on it.

    Parameters
    ----------
    mass_matrix, damping_matrix, stiffness_matrix : ndarray, shape (n, n), optional
    drive_vector, contact_vector : ndarray, shape (n,), optional
    """

    mass_matrix: Floats | None = None
    damping_matrix: Floats | None = None
    stiffness_matrix: Floats | None = None
    drive_vector: Floats | None = None
    contact_vector: Floats | None = None


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class Gradients:
    """Derivatives by each named parameter.

    Parameters
    ----------
    vibration_amplitude : mapping of str to ndarray, shape (...)
        Derivative of the amplitude, per unit of the parameter. [m]
    mean_displacement : mapping of str to ndarray, shape (...)
        Derivative of the mean displacement, per unit of the parameter. [m]
    kinematic : mapping of str to ndarray, shape (..., speeds)
        Derivative of `SlidingMeans.kinematic`, per unit of the parameter.
    """

    vibration_amplitude: dict[str, Floats]
    mean_displacement: dict[str, Floats]
    kinematic: dict[str, Floats]


def gradients(
    states: SteadyStates,
    *,
    sliding_speed: ArrayLike = (),
    structure_changes: Mapping[str, StructureChange] | None = None,
) -> Gradients:
    """Return the derivatives of amplitude, mean displacement and kinematic friction factor by every parameter.

    Parameters
    ----------
    states : SteadyStates
    sliding_speed : array_like, shape (speeds,)
        Sliding speeds of the friction factor. [m/s]
    structure_changes : mapping of str to StructureChange, optional
        Parameters of the structure, by names of the caller's choice.

    Returns
    -------
    Gradients
        By "normal_load", "frequency", "voltage_scale" (a factor on the whole drive but its mean), "voltage_offset", the
        gap law's own parameters under their names, and those given.

    Raises
    ------
    InvalidInput
        If a state did not converge, a speed is not positive, or a name is taken twice.

    Notes
    -----
    One linear system a state serves all parameters: the residual R(u, p) = 0 gives du/dp = -(dR/du)^-1 dR/dp.
    """
    if np.any(states.status == Status.NOT_CONVERGED):
        raise InvalidInput("states must have converged: a point without a vibration has no gradients")
    speeds = (
        np.empty(0) if np.size(sliding_speed) == 0 else np.atleast_1d(require_positive(sliding_speed=sliding_speed))
    )
    changes = dict(structure_changes or {})
    shape = states.frequency.shape
    rows = [_one_state(states, index, speeds, changes) for index in np.ndindex(shape)]
    names = list(rows[0]) if rows else []

    def column(which: int, *inner: int) -> dict[str, Floats]:
        return {
            name: np.array([row[name][which] for row in rows], dtype=np.float64).reshape((*shape, *inner))
            for name in names
        }

    return Gradients(vibration_amplitude=column(0), mean_displacement=column(1), kinematic=column(2, speeds.size))


def _one_state(
    states: SteadyStates, index: tuple[int, ...], speeds: Floats, changes: dict[str, StructureChange]
) -> dict[str, tuple[float, float, Floats]]:
    balance = _polished(states, index)
    own, structure = balance.equations, states.structure
    residuals = {
        "normal_load": own.stack(1.0, np.zeros(0, dtype=complex)),
        "frequency": 2 * np.pi * balance.by_omega,
        "voltage_scale": balance.by_scale,
        "voltage_offset": own.stack(
            -own.static_stiffness * (static_contact(structure).displacement_per_volt or 0.0), np.zeros(0, dtype=complex)
        ),
    }
    for name, change in _by_law(states.gap_law, balance).items():
        residuals[name] = residuals.get(name, 0.0) + balance.by_force(change)
    for name, structural in changes.items():
        if name in residuals:
            raise InvalidInput(f"structure_changes must not be named {name!r}, which is taken")
        residuals[name] = _by_structure(structure, balance, structural)
    names = list(residuals)
    moved = -np.linalg.solve(balance.jacobian, np.array([residuals[name] for name in names]).T).T
    slowest = speeds.min(initial=np.inf) / (balance.omega * abs(states.harmonics[index][0]) + 1e-300)
    fineness = int(fineness_of(states.harmonics[index].reshape(1, -1))[0])
    z, weights = phases_of(states.turns[index], min(slowest, 1.0), fineness)
    extremes = _extreme_phases(states, index)
    return {
        name: _outputs(balance, change, extremes, z, weights, speeds, 2 * np.pi if name == "frequency" else 0.0)
        for name, change in zip(names, moved, strict=True)
    }


def _polished(states: SteadyStates, index: tuple[int, ...]) -> Balance:
    orders = max(2 * int(states.harmonic_count[index]), _LEAST)
    equations = PointEquations(
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
    for _ in range(_POLISH):
        balance = equations.at(unknowns, omega=omega, scale=1.0)
        unknowns = unknowns - np.linalg.solve(balance.jacobian, balance.residual)
    return equations.at(unknowns, omega=omega, scale=1.0)


def _by_law(gap_law: GapLaw, balance: Balance) -> dict[str, Floats]:
    """Return the derivative of the force over the period by the load and by each parameter of the law."""
    load, x = balance.equations.normal_load, balance.displacement
    share = np.maximum(1 - gap_law.force_damping * balance.velocity, 0.0)
    elastic = gap_law.force(x, load)
    found = {"force_damping": -elastic * balance.velocity * (share > 0)}
    if isinstance(gap_law, ExponentialGap):
        length = gap_law.decay_length
        return found | {"normal_load": share * elastic / load, "decay_length": share * elastic * x / length**2}
    if isinstance(gap_law, HertzGap):
        coefficient = gap_law.coefficient
        rest = (load / coefficient) ** (2 / 3)
        approach = np.maximum(rest - x, 0.0)
        stiffness = 1.5 * coefficient * np.sqrt(approach)
        by_coefficient = share * (approach**1.5 - stiffness * 2 / 3 * rest / coefficient)
        return found | {
            "normal_load": share * stiffness * 2 / 3 * rest / load,
            "tip_radius": by_coefficient * 0.5 * coefficient / gap_law.tip_radius,
            "effective_modulus": by_coefficient * coefficient / gap_law.effective_modulus,
        }
    if isinstance(gap_law, TabulatedGap):
        at_rest = gap_law.stiffness(np.zeros(()), load)
        return found | {"normal_load": share * gap_law.stiffness(x, load) / at_rest}
    assert isinstance(gap_law, LinearGap)
    return found | {"normal_load": share * (elastic > 0), "normal_stiffness": -share * x * (elastic > 0)}


def _by_structure(structure: Structure, balance: Balance, change: StructureChange) -> Floats:
    """Return the derivative of the residual by one parameter of the structure."""
    own, k = balance.equations, balance.equations.multiples[:, np.newaxis, np.newaxis] * balance.omega
    stiffness, damping, mass = (
        np.zeros_like(whole) if part is None else np.asarray(part, dtype=np.float64)
        for part, whole in (
            (change.stiffness_matrix, structure.stiffness_matrix),
            (change.damping_matrix, structure.damping_matrix),
            (change.mass_matrix, structure.mass_matrix),
        )
    )
    residual = balance.by_stiffness(stiffness + 1j * k * damping - k**2 * mass)  # type: ignore[arg-type]
    harmonics = np.zeros(own.orders, dtype=np.complex128)
    if change.drive_vector is not None:
        harmonics -= (balance.to_force @ change.drive_vector) * own.voltage
    if change.contact_vector is not None:
        harmonics -= balance.coordinates @ change.contact_vector
        harmonics -= (balance.to_force @ change.contact_vector) * balance.force_harmonics
    residual = residual + own.stack(0.0, harmonics)
    if own.static_stiffness > 0:
        residual[0] += _by_static_structure(structure, balance, change, stiffness)
    return residual


def _by_static_structure(structure: Structure, balance: Balance, change: StructureChange, stiffness: Floats) -> float:
    """Return the derivative of the static equation, S_0 (mean - free mean) = mean force - load."""
    own, mean = balance.equations, float(balance.unknowns[0])
    per_force = np.linalg.solve(structure.stiffness_matrix, structure.contact_vector)
    rest = per_force * own.static_stiffness * (mean - own.static_displacement) + np.linalg.solve(
        structure.stiffness_matrix, structure.drive_vector * own.voltage_offset
    )
    moved = -float(per_force @ stiffness @ rest)
    if change.drive_vector is not None:
        moved += float(per_force @ change.drive_vector) * own.voltage_offset
    if change.contact_vector is not None:
        moved += float(change.contact_vector @ rest)
        moved += float(per_force @ change.contact_vector) * own.static_stiffness * (mean - own.static_displacement)
    return -own.static_stiffness * moved


def _extreme_phases(states: SteadyStates, index: tuple[int, ...]) -> Floats:
    """Return the phases of the highest and the lowest displacement."""
    if np.all(np.isfinite(states.turns[index])):
        return states.turns[index]  # type: ignore[no-any-return]
    harmonics, k = states.harmonics[index], np.arange(1, states.harmonics.shape[-1] + 1)
    phases = 2 * np.pi * np.arange(4096) / 4096
    x = (np.exp(1j * np.multiply.outer(phases, k)) @ harmonics).real
    found = np.array([phases[np.argmax(x)], phases[np.argmin(x)]])
    for _ in range(4):
        z = np.exp(1j * np.multiply.outer(found, k))
        found = found - (z @ (1j * k * harmonics)).real / (z @ (-(k**2) * harmonics)).real
    return found


def _outputs(
    balance: Balance,
    moved: Floats,
    extremes: Floats,
    z: Complexes,
    weights: Floats,
    speeds: Floats,
    omega_moved: float,
) -> tuple[float, float, Floats]:
    """Return the derivatives of amplitude, mean and friction factor from that of the unknowns."""
    own = balance.equations
    _, harmonics = own.unstack(balance.unknowns)
    mean_moved, harmonics_moved = own.unstack(moved)
    high, low = np.exp(1j * np.multiply.outer(extremes, own.multiples)) @ harmonics_moved
    powers = z[:, np.newaxis] ** own.multiples
    velocity = (powers @ (1j * balance.omega * own.multiples * harmonics)).real
    change = balance.omega * harmonics_moved + omega_moved * harmonics
    velocity_moved = (powers @ (1j * own.multiples * change)).real
    speed = speeds[:, np.newaxis]
    slope = -speed * velocity / (speed**2 + velocity**2) ** 1.5
    return 0.5 * float((high - low).real), mean_moved, (slope * velocity_moved) @ weights
