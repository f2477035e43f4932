"""What a pin-on-disc rig of given masses, springs and dampers would show its observers."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sonolube.actuator.stack import PiezoStack
from sonolube.checks import Complexes, Floats, require_non_negative, require_positive
from sonolube.dynamics.chain import chain_structure, pin_on_disc_chain
from sonolube.errors import InvalidInput
from sonolube.identification.fact import Observe

_GRAVITY = 9.80665  # m/s2
_SETTLED = 0.02  # share of a free vibration that is left once it counts as settled
_SWINGS = 1e-9  # imaginary share of a pole below which rounding made it
_TIP, _ARM = 0, -1  # places among the coordinates
_REFERENCE = {  # any rig will do to take the matrices apart
    "tip_mass": 1.0,
    "reaction_mass": 1.0,
    "arm_mass": 1.0,
    "arm_stiffness": 1e6,
    "arm_damping": 1e3,
    "tip_damping": 1e3,
}


@dataclass(frozen=True, kw_only=True, slots=True)
class PinOnDiscTest:
    """What is known of a pin-on-disc rig and of how it was driven and loaded.

    Parameters
    ----------
    stack : PiezoStack
        The actuator.
    frequency : float
        Drive frequency. [Hz]
    voltage_peak_to_peak : float
        Drive voltage at which the power is looked at. [V]
    normal_load : float
        Load under which the rig was observed. [N]
    decay_length : float
        Decay length of the contact force; the contact is as stiff as load over decay length. [m]
    settling_time : float
        Time after the start of the drive at which the remaining fluctuation is looked at. [s]
    added_mass : float
        Mass hung on the arm for a second observation of it, which adds its weight to the load. [kg]
    """

    stack: PiezoStack
    frequency: float
    voltage_peak_to_peak: float
    normal_load: float
    decay_length: float
    settling_time: float
    added_mass: float

    def __post_init__(self) -> None:
        require_positive(
            frequency=self.frequency,
            voltage_peak_to_peak=self.voltage_peak_to_peak,
            normal_load=self.normal_load,
            decay_length=self.decay_length,
            settling_time=self.settling_time,
        )
        require_non_negative(added_mass=self.added_mass)


@dataclass(frozen=True, kw_only=True, eq=False, slots=True)
class _Family:
    """All rigs of one stack, whose mass, damping and stiffness matrices are linear in the parameters."""

    drive: Floats
    reference: Floats  # the three matrices of one rig
    changes: Floats  # by which they grow as each parameter doubles


def observer(test: PinOnDiscTest) -> Observe:
    """Return what takes the parameters of rigs and tells what they would show in this test.

    Parameters
    ----------
    test : PinOnDiscTest

    Returns
    -------
    callable
        Takes a mapping of `tip_mass`, `reaction_mass`, `arm_mass`, `arm_stiffness`, `arm_damping` and `tip_damping`
        to an array of shape (n,) each, and returns one of arrays of that shape:

        With the contact free:

        - `electrical_resonance`: natural frequency of the stack between its masses, where current per voltage peaks
        - `resonance_quality`: quality factor of that vibration
        - `tip_settling`: time in which its transient falls to 2 %
        - `tip_amplitude_per_volt`: amplitude of the tip per volt peak to peak, at the drive frequency
        - `dissipated_power`: real power that the stack takes at the test's voltage
        - `resonance_share`: amplitude of the tip over what the same voltage gives at the resonance

        On the disc under load, the contact as small motions feel it:

        - `arm_frequency`: lowest frequency of a free vibration
        - `arm_settling`: time in which the slowest transient of all but the stack's falls to 2 %
        - `fluctuation_left`: share of the arm's transient left after the settling time
        - `heavier_arm_frequency`: lowest frequency under the added mass

        Of the parts themselves:

        - `mass_ratio`: reaction mass over tip mass
        - `arm_mass`: mass of the arm

    Raises
    ------
    InvalidInput
        By the callable, if a parameter is missing or not one of these.

    Notes
    -----
    For an exponential contact law the stiffness load over decay length is also that of the mean force for the mean
    displacement under vibration of any amplitude, so that it holds for the arm while the tip vibrates.
    """
    family = _family(test.stack)
    return lambda parameters: _observed(test, family, parameters)


def _observed(test: PinOnDiscTest, family: _Family, parameters: Mapping[str, Floats]) -> Mapping[str, Floats]:
    mass, damping, stiffness = _matrices(family, parameters)
    resonance = _highest_natural_frequency(mass, stiffness)
    driven, at_peak = (
        _motion_per_volt(mass, damping, stiffness, family.drive, frequency) for frequency in (test.frequency, resonance)
    )
    tip, tip_at_peak = np.abs(driven[:, _TIP]), np.abs(at_peak[:, _TIP])
    conductance = -2 * np.pi * test.frequency * (driven @ family.drive).imag
    heavier = mass.copy()
    heavier[:, _ARM, _ARM] += test.added_mass
    heavier_load = test.normal_load + test.added_mass * _GRAVITY
    free, loaded, heavier_loaded = _poles(
        np.stack([mass, mass, heavier]),
        damping,
        np.stack([_pressed(stiffness, load / test.decay_length) for load in (0.0, test.normal_load, heavier_load)]),
    )
    stack, arm, heavier_arm = free[:, -1], _lowest_vibration(loaded), _lowest_vibration(heavier_loaded)
    return {
        "electrical_resonance": resonance,
        "resonance_quality": np.abs(stack) / (-2 * stack.real),
        "tip_settling": _settling_time(stack),
        "tip_amplitude_per_volt": tip / 2,
        "dissipated_power": conductance * test.voltage_peak_to_peak**2 / 8,
        "resonance_share": tip / tip_at_peak,
        "arm_frequency": np.abs(arm) / (2 * np.pi),
        "arm_settling": _settling_time(loaded[:, :-2]).max(axis=1),
        "fluctuation_left": np.exp(arm.real * test.settling_time),
        "heavier_arm_frequency": np.abs(heavier_arm) / (2 * np.pi),
        "mass_ratio": parameters["reaction_mass"] / parameters["tip_mass"],
        "arm_mass": parameters["arm_mass"],
    }


def _family(stack: PiezoStack) -> _Family:
    def matrices(parameters: Mapping[str, float]) -> Floats:
        rig = chain_structure(pin_on_disc_chain(stack, **parameters))
        return np.stack([rig.mass_matrix, rig.damping_matrix, rig.stiffness_matrix])

    reference = matrices(_REFERENCE)
    return _Family(
        drive=chain_structure(pin_on_disc_chain(stack, **_REFERENCE)).drive_vector,
        reference=reference,
        changes=np.stack([matrices({**_REFERENCE, name: 2 * one}) - reference for name, one in _REFERENCE.items()]),
    )


def _matrices(family: _Family, parameters: Mapping[str, Floats]) -> Floats:
    if set(parameters) != set(_REFERENCE):
        raise InvalidInput(f"parameters must be {', '.join(_REFERENCE)}, got {', '.join(parameters)}")
    growth = np.stack([parameters[name] / one - 1 for name, one in _REFERENCE.items()])
    return np.asarray(family.reference[:, np.newaxis] + np.einsum("pn,pkij->knij", growth, family.changes))


def _pressed(stiffness: Floats, normal_stiffness: float) -> Floats:
    pressed = stiffness.copy()
    pressed[:, _TIP, _TIP] += normal_stiffness
    return pressed


def _highest_natural_frequency(mass: Floats, stiffness: Floats) -> Floats:
    scale = 1 / np.sqrt(np.diagonal(mass, axis1=1, axis2=2))
    scaled = stiffness * scale[:, :, np.newaxis] * scale[:, np.newaxis, :]
    return np.asarray(np.sqrt(np.linalg.eigvalsh(scaled)[:, -1]) / (2 * np.pi))


def _motion_per_volt(
    mass: Floats, damping: Floats, stiffness: Floats, drive: Floats, frequency: Floats | float
) -> Complexes:
    omega = 2 * np.pi * np.reshape(frequency, (-1, 1, 1))
    dynamic = stiffness + 1j * omega * damping - omega**2 * mass
    forces = np.broadcast_to(drive, mass.shape[:-1])[..., np.newaxis]
    return np.asarray(np.linalg.solve(dynamic, forces)[..., 0], dtype=np.complex128)


def _poles(mass: Floats, damping: Floats, stiffness: Floats) -> Complexes:
    """Return the complex rates of free motions, slowest first."""
    n = mass.shape[-1]
    inverse = np.linalg.inv(mass)
    state = np.zeros((*mass.shape[:-2], 2 * n, 2 * n))
    state[..., :n, n:] = np.eye(n)
    state[..., n:, :n] = -inverse @ stiffness
    state[..., n:, n:] = -inverse @ damping
    poles = np.linalg.eigvals(state).astype(np.complex128)
    return np.asarray(np.take_along_axis(poles, np.argsort(np.abs(poles), axis=-1), axis=-1))


def _lowest_vibration(poles: Complexes) -> Complexes:
    """Return the pole of the slowest motion that swings; where none swings, the slowest of all."""
    swings = poles.imag > _SWINGS * np.abs(poles)
    return np.asarray(poles[np.arange(len(poles)), swings.argmax(axis=1)])


def _settling_time(poles: Complexes) -> Floats:
    return np.asarray(math.log(1 / _SETTLED) / np.maximum(-poles.real, np.finfo(float).tiny))
