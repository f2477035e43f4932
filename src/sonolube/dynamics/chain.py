"""Lumped chains: masses on one line, springs and dampers between them, a stack between two of them."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.actuator import PiezoStack
from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.dynamics.structure import Structure
from sonolube.errors import InvalidInput, UnknownName

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
    """Masses that move along the normal of the contact, and what joins them.

    Parameters
    ----------
    masses : mapping of str to float
        Mass of each body in kg, by name; its order is that of the coordinates.
    springs : tuple of Spring
    dampers : tuple of Damper
    stack : PiezoStack
        Its own mass goes with the body behind it.
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
    """Return the chain as a structure, whose coordinates are the heights of its masses.

    Parameters
    ----------
    chain : LumpedChain

    Returns
    -------
    Structure
        Coordinates in the order of `masses`, each positive away from the other surface.
    """
    names = list(chain.masses)
    stack, (near, behind) = chain.stack, chain.stack_between
    mass = np.diag([float(chain.masses[name]) for name in names])
    if behind != GROUND:
        mass[names.index(behind), names.index(behind)] += stack.stack_mass
    along = _difference(names, (near, behind))
    stiffness = stack.stack_stiffness * np.multiply.outer(along, along)
    damping = stack.stack_damping * np.multiply.outer(along, along)
    for spring in chain.springs:
        change = _difference(names, spring.between)
        stiffness += spring.spring_stiffness * np.multiply.outer(change, change)
    for damper in chain.dampers:
        change = _difference(names, damper.between)
        damping += damper.viscous_damping * np.multiply.outer(change, change)
    return Structure(
        mass_matrix=mass,
        damping_matrix=damping,
        stiffness_matrix=stiffness,
        drive_vector=stack.charge_per_elongation * along,
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
    """Return the three masses of the pin-on-disc tribometer: tip, reaction mass, loading arm.

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
        Damping c_2 beside it. [N s/m]
    tip_damping : float
        Damping c_1 between tip and disc. [N s/m]

    Returns
    -------
    LumpedChain
        Of masses "tip", "reaction" and "arm", that floats under its dead load.

    Raises
    ------
    InvalidInput
        If a mass or the arm's stiffness is not positive, or a damping negative.

    Notes
    -----
    All heights count away from the disc. D's matrices carry the stack's stiffness with a plus off the diagonal, since
    there x1 and x2 point in opposite directions, and F_N as if it drove the arm, of which it is the weight.

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
    """Return the structure that modes describe, such as those of finite elements.

    Parameters
    ----------
    frequencies : array_like, shape (n,)
        Natural frequency of each mode in Hz, the stack short-circuited; zero for rigid modes.
    damping_ratios : array_like, shape (n,) or ()
        Damping over critical damping of each mode.
    drive_participation : array_like, shape (n,)
        Modal force per volt, in N/V for shapes normalised to a modal mass of 1 kg.
    contact_participation : array_like, shape (n,)
        Displacement of the contact in each shape so normalised, positive away from the other body.
    clamped_capacitance : float
        Capacitance with all modes held; it has to include the static share of modes left out. [F]

    Returns
    -------
    Structure
        Coordinates are the modal ones.

    Raises
    ------
    InvalidInput
        If shapes disagree, a frequency or ratio is negative, or a value not finite.
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


def _difference(names: list[str], ends: tuple[str, str]) -> Floats:
    """Return how the distance from the first end to the second changes with each coordinate."""
    first, second = ends
    return np.array([float(name == second) - float(name == first) for name in names])


def _require_two_ends(kind: str, ends: tuple[str, str]) -> None:
    if len(ends) != 2 or ends[0] == ends[1]:
        raise InvalidInput(f"a {kind} needs two different ends, got {', '.join(map(repr, ends))}")
