"""Lumped-parameter and modal structures: chains of masses, springs, dampers and a stack; modes of finite elements."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput, UnknownName
from sonolube.models.actuator import PiezoStack
from sonolube.models.dynamics.structure import Structure

GROUND = "ground"


@dataclass(frozen=True, kw_only=True, slots=True)
class Spring:
    """A spring between two masses, or between a mass and the ground.

    Parameters
    ----------
    between : tuple of two str
        Names of the masses, or "ground".
    spring_stiffness : float
        Force per change of distance. [N/m]

    Raises
    ------
    InvalidInput
        If the stiffness is not positive, or both ends are the same.
    """

    between: tuple[str, str]
    spring_stiffness: float

    def __post_init__(self) -> None:
        require_positive(spring_stiffness=self.spring_stiffness)
        _require_two_ends("spring", self.between)


@dataclass(frozen=True, kw_only=True, slots=True)
class Damper:
    """A viscous damper between two masses, or between a mass and the ground.

    Parameters
    ----------
    between : tuple of two str
        Names of the masses, or "ground".
    viscous_damping : float
        Force per difference of velocity. [N s/m]

    Raises
    ------
    InvalidInput
        If the damping is negative, or both ends are the same.
    """

    between: tuple[str, str]
    viscous_damping: float

    def __post_init__(self) -> None:
        require_non_negative(viscous_damping=self.viscous_damping)
        _require_two_ends("damper", self.between)


@dataclass(frozen=True, kw_only=True, slots=True)
class LumpedChain:
    """Lumped-parameter model: masses that move along the contact normal, joined by springs, dampers and one stack.

    Parameters
    ----------
    masses : mapping of str to float
        Mass of each body in kg, by name; their order is that of the coordinates.
    springs : tuple of Spring
    dampers : tuple of Damper
    stack : PiezoStack
        Its own mass is added to the body behind it.
    stack_between : tuple of two str
        Body on the contact's side of the stack, and body behind it; either may be "ground".
    contact : str
        Body that touches the other surface.
    loaded : str or None
        Body that the weights of the dead load hang on, where that is known.

    Raises
    ------
    InvalidInput
        If a mass is not positive or named "ground", or both ends of the stack are the same.
    UnknownName
        If a spring, damper, stack or contact names no mass of the chain.
    """

    masses: Mapping[str, float]
    springs: tuple[Spring, ...]
    dampers: tuple[Damper, ...]
    stack: PiezoStack
    stack_between: tuple[str, str]
    contact: str
    loaded: str | None = None

    def __post_init__(self) -> None:
        if GROUND in self.masses:
            raise InvalidInput(f'"{GROUND}" has no mass: name the body otherwise')
        for name, mass in self.masses.items():
            require_positive(**{f"mass of {name}": mass})
        _require_two_ends("stack", self.stack_between)
        pairs = [self.stack_between, *(s.between for s in self.springs), *(d.between for d in self.dampers)]
        for name in (end for pair in pairs for end in pair):
            if name not in self.masses and name != GROUND:
                raise UnknownName.among([*self.masses, GROUND], kind="body", name=name)
        for body in (self.contact, self.loaded):
            if body is not None and body not in self.masses:
                raise UnknownName.among(self.masses, kind="body", name=body)


def chain_structure(chain: LumpedChain) -> Structure:
    r"""Structure of a lumped chain, whose coordinates are the heights of its masses.

    Parameters
    ----------
    chain : LumpedChain

    Returns
    -------
    Structure
        Coordinates in the order of `masses`, each positive away from the other surface.

    Notes
    -----
    A spring of stiffness k (a damper likewise) between coordinates i and j adds
    :math:`k\,(e_j - e_i)(e_j - e_i)^T` to the matrix; the stack adds its stiffness and damping in the same way and the
    drive vector :math:`b = N d_{33} k_p\,(e_j - e_i)`.

    References
    ----------
    .. [1] D 3.31, with all heights positive away from the disc.
    """
    names = list(chain.masses)
    stack, (near, behind) = chain.stack, chain.stack_between
    mass = np.diag([float(chain.masses[name]) for name in names])
    if behind != GROUND:
        mass[names.index(behind), names.index(behind)] += stack.stack_mass
    elongation = _elongation_vector(names, (near, behind))
    stiffness = stack.stack_stiffness * np.multiply.outer(elongation, elongation)
    damping = stack.stack_damping * np.multiply.outer(elongation, elongation)
    for spring in chain.springs:
        vector = _elongation_vector(names, spring.between)
        stiffness += spring.spring_stiffness * np.multiply.outer(vector, vector)
    for damper in chain.dampers:
        vector = _elongation_vector(names, damper.between)
        damping += damper.viscous_damping * np.multiply.outer(vector, vector)
    return Structure(
        mass_matrix=mass,
        damping_matrix=damping,
        stiffness_matrix=stiffness,
        drive_vector=stack.charge_per_elongation * elongation,
        contact_vector=np.array([float(name == chain.contact) for name in names]),
        clamped_capacitance=stack.clamped_capacitance,
        load_vector=None if chain.loaded is None else np.array([float(name == chain.loaded) for name in names]),
    )


def pin_on_disc_chain(
    stack: PiezoStack,
    *,
    tip_mass: float,
    reaction_mass: float,
    arm_mass: float,
    arm_stiffness: float,
    arm_damping: float,
    tip_damping: float = 0.0,
) -> LumpedChain:
    """Three-mass chain of the pin-on-disc tribometer: tip, reaction mass, loading arm.

    Parameters
    ----------
    stack : PiezoStack
        Between tip and reaction mass.
    tip_mass : float
        Mass m_1 of pin and holder. [kg]
    reaction_mass : float
        Mass m_2 behind the stack, without the stack's own m_0. [kg]
    arm_mass : float
        Effective mass m_3 of the arm with its weights. [kg]
    arm_stiffness : float
        Stiffness k_2 between reaction mass and arm. [N/m]
    arm_damping : float
        Damping c_2 parallel to that stiffness. [N s/m]
    tip_damping : float
        Damping c_1 between tip and disc. [N s/m]

    Returns
    -------
    LumpedChain
        Of masses "tip", "reaction" and "arm"; it floats: no spring connects it to the ground.

    Raises
    ------
    InvalidInput
        If a mass or the arm's stiffness is not positive, or a damping negative.

    Notes
    -----
    All heights are positive away from the disc. D's matrices have the stack's stiffness with a positive sign off the
    diagonal, since there x1 and x2 point in opposite directions, and treat F_N as a drive of the arm, whose weight it
    is.

    References
    ----------
    .. [1] D 3.31, figure 3.8.
    """
    masses = {"tip_mass": tip_mass, "reaction_mass": reaction_mass, "arm_mass": arm_mass}
    require_positive(**masses, arm_stiffness=arm_stiffness)
    require_non_negative(arm_damping=arm_damping, tip_damping=tip_damping)
    return LumpedChain(
        masses={name.removesuffix("_mass"): mass for name, mass in masses.items()},
        springs=(Spring(between=("reaction", "arm"), spring_stiffness=arm_stiffness),),
        dampers=(
            Damper(between=("reaction", "arm"), viscous_damping=arm_damping),
            Damper(between=("tip", GROUND), viscous_damping=tip_damping),
        ),
        stack=stack,
        stack_between=("tip", "reaction"),
        contact="tip",
        loaded="arm",
    )


def modal_structure(
    *,
    frequencies: ArrayLike,
    damping_ratios: ArrayLike,
    drive_participation: ArrayLike,
    contact_participation: ArrayLike,
    clamped_capacitance: float,
) -> Structure:
    """Structure in modal coordinates, from natural frequencies, damping ratios and participation factors.

    Parameters
    ----------
    frequencies : array_like, shape (n,)
        Natural frequency of each mode with the stack short-circuited, in Hz; zero for rigid-body modes.
    damping_ratios : array_like, shape (n,) or ()
        Damping over critical damping of each mode.
    drive_participation : array_like, shape (n,)
        Modal force per volt, in N/V for shapes normalised to a modal mass of 1 kg.
    contact_participation : array_like, shape (n,)
        Displacement of the contact in each mode shape of unit modal mass, positive away from the other body.
    clamped_capacitance : float
        Capacitance with all these modes clamped; it must include the static contribution of truncated modes. [F]

    Returns
    -------
    Structure
        In modal coordinates.

    Raises
    ------
    InvalidInput
        If shapes disagree, a frequency or ratio is negative, or a value not finite.

    Examples
    --------
    >>> from sonolube.models.dynamics import modal_structure, modes
    >>> mode = {"frequencies": [20e3], "damping_ratios": [0.01], "drive_participation": [10.0]}
    >>> transducer = modal_structure(**mode, contact_participation=[1.0], clamped_capacitance=4e-9)
    >>> modes(transducer).natural_frequency.round(3).tolist()
    [20000.0]
    """
    omega = 2 * np.pi * require_non_negative(frequencies=frequencies)
    if omega.ndim != 1:
        raise InvalidInput(f"frequencies must have one axis, got shape {omega.shape}")
    ratios = require_non_negative(damping_ratios=damping_ratios)
    if ratios.shape not in ((), omega.shape):
        raise InvalidInput(f"damping_ratios must have shape {omega.shape} or (), got {ratios.shape}")
    return Structure(
        mass_matrix=np.eye(omega.size),
        damping_matrix=np.diag(2 * ratios * omega),
        stiffness_matrix=np.diag(omega**2),
        drive_vector=require_finite(drive_participation=drive_participation),
        contact_vector=require_finite(contact_participation=contact_participation),
        clamped_capacitance=clamped_capacitance,
    )


def _elongation_vector(names: list[str], ends: tuple[str, str]) -> Floats:
    """Derivative of the distance from the first end to the second with respect to each coordinate."""
    first, second = ends
    return np.array([float(name == second) - float(name == first) for name in names])


def _require_two_ends(kind: str, ends: tuple[str, str]) -> None:
    """Refuse a spring, damper or stack whose two ends are the same."""
    if len(ends) != 2 or ends[0] == ends[1]:
        raise InvalidInput(f"a {kind} needs two different ends, got {', '.join(map(repr, ends))}")
