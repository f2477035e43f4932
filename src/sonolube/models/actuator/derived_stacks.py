"""Equivalent stacks of a stack with a preload bolt or a lever, and of flextensional actuators by their data sheet."""

import math
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput
from sonolube.models.actuator.stack import PiezoStack

_COARSE_PITCH = {2e-3: 0.4e-3, 2.5e-3: 0.45e-3, 3e-3: 0.5e-3, 4e-3: 0.7e-3, 5e-3: 0.8e-3, 6e-3: 1e-3, 8e-3: 1.25e-3}
_COARSE_PITCH |= {10e-3: 1.5e-3, 12e-3: 1.75e-3}  # ISO 261, nominal diameter and pitch in m


@dataclass(frozen=True, kw_only=True, slots=True)
class PreloadBolt:
    """Metric bolt in parallel with a stack, between the same two bodies.

    Parameters
    ----------
    thread_diameter : float
        Nominal diameter of the thread. [m]
    length : float
        Stressed length, threaded throughout. [m]
    youngs_modulus : float
        Young's modulus. [Pa]
    yield_strength : float
        Proof strength Rp0.2. [Pa]
    preload : float
        Total tension at rest, equal to the compression of the stack. [N]
    bolts : int
        Number of bolts that share the preload.

    Raises
    ------
    InvalidInput
        If a value is not positive, or the diameter not that of a coarse thread from M2 to M12.

    References
    ----------
    .. [1] ISO 261, coarse pitch; ISO 898-1, tensile stress area.
    """

    thread_diameter: float
    length: float
    youngs_modulus: float
    yield_strength: float
    preload: float
    bolts: int = 1

    def __post_init__(self) -> None:
        require_positive(**asdict(self))
        if not any(math.isclose(self.thread_diameter, size) for size in _COARSE_PITCH):
            known = ", ".join(f"{1e3 * size:g}" for size in _COARSE_PITCH)
            raise InvalidInput(
                f"thread_diameter must be one of {known} mm, got {1e3 * self.thread_diameter:g} mm: the pitch of other"
                " threads is not tabulated"
            )

    @property
    def stress_area(self) -> float:
        r"""Tensile stress area of all bolts together, :math:`\frac{\pi}{4}(d - 0.9382\,P)^2` each, in m2."""
        pitch = next(p for size, p in _COARSE_PITCH.items() if math.isclose(size, self.thread_diameter))
        return self.bolts * math.pi / 4 * (self.thread_diameter - 0.9382 * pitch) ** 2  # ISO 898-1

    @property
    def stiffness(self) -> float:
        """Axial stiffness of all bolts together, E A/L, in N/m."""
        return self.youngs_modulus * self.stress_area / self.length

    @property
    def endurance_limit(self) -> float:
        """Endurance limit of the stress amplitude of a thread rolled before heat treatment, in Pa.

        0.85 (150 mm/d + 45) MPa, for mean tensions from 0.2 to 0.8 of the proof load (VDI 2230-1, 5.5.3).
        """
        return 0.85e6 * (0.15 / self.thread_diameter + 45)  # VDI 2230-1, 5.5.3


def tightening_preload(*, torque: ArrayLike, thread_diameter: ArrayLike, nut_factor: ArrayLike = 0.2) -> Floats:
    r"""Tension of a bolt by its tightening torque and nut factor. [N]

    Parameters
    ----------
    torque : array_like
        Tightening torque M. [N m]
    thread_diameter : array_like
        Nominal diameter of the thread, d. [m]
    nut_factor : array_like
        Nut factor K: 0.30 dry and bare, 0.20 as usual, 0.18 lubricated. []

    Returns
    -------
    ndarray

    Raises
    ------
    InvalidInput
        If a value is not positive, or the torque negative.

    Notes
    -----
    .. math:: F = \frac{M}{K d}

    Friction scatters, and the tension by about 30 % with it; the elongation of the bolt or the charge of the stack
    tells more.

    References
    ----------
    .. [1] J. E. Shigley, Mechanical Engineering Design, section 8-8, table 8-15.
    """
    lever = require_positive(nut_factor=nut_factor) * require_positive(thread_diameter=thread_diameter)
    return np.asarray(require_non_negative(torque=torque) / lever)


def bolted_stack(stack: PiezoStack, bolt: PreloadBolt) -> PiezoStack:
    r"""Equivalent stack of a stack with its preload bolt in parallel.

    Parameters
    ----------
    stack : PiezoStack
    bolt : PreloadBolt

    Returns
    -------
    PiezoStack
        Stiffness is increased by the bolt and stroke reduced in proportion; blocked force per volt and clamped
        capacitance are unchanged.

    Notes
    -----
    With the stiffness :math:`k_p`, free stroke per volt :math:`N d_{33}` and clamped capacitance :math:`C_S` of the
    stack and the stiffness :math:`k_b` of the bolt

    .. math::

        k = k_p + k_b, \qquad (N d_{33})' = \frac{N d_{33} k_p}{k}, \qquad
        C_T' = C_S + \frac{(N d_{33} k_p)^2}{k}
    """
    stiffness = stack.stack_stiffness + bolt.stiffness
    force_per_volt = stack.charge_per_elongation
    return replace(
        stack,
        stack_stiffness=stiffness,
        free_stroke_per_volt=force_per_volt / stiffness,
        free_capacitance=stack.clamped_capacitance + force_per_volt**2 / stiffness,
        preload=bolt.preload,
        coupling_factor=None,
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class BoltStresses:
    """Stresses and safety factors of a bolt, each of the shape of the elongations.

    Parameters
    ----------
    bolt_stress_amplitude : ndarray
        Stress amplitude. [Pa]
    highest_bolt_stress : ndarray
        Highest stress. [Pa]
    fatigue_safety : ndarray
        Endurance limit over stress amplitude; infinite at zero amplitude. []
    yield_safety : ndarray
        Proof strength over the highest stress. []
    """

    bolt_stress_amplitude: Floats
    highest_bolt_stress: Floats
    fatigue_safety: Floats
    yield_safety: Floats


def bolt_stresses(bolt: PreloadBolt, *, elongation_amplitude: ArrayLike, elongation: ArrayLike = 0.0) -> BoltStresses:
    r"""Stresses and safety factors of a preload bolt under the elongation of its stack.

    Parameters
    ----------
    bolt : PreloadBolt
    elongation_amplitude : array_like
        Half of the peak-to-peak elongation. [m]
    elongation : array_like
        Mean elongation, from the offset of the drive. [m]

    Returns
    -------
    BoltStresses

    Raises
    ------
    InvalidInput
        If an amplitude is negative, or a value not finite.

    Notes
    -----
    With the preload F, stress area A, length L and modulus E of the bolt, the mean elongation e and its amplitude a

    .. math::

        \sigma_a = \frac{E a}{L}, \qquad \sigma_{max} = \frac{F}{A} + \frac{E (e + a)}{L}, \qquad
        S_D = \frac{\sigma_A}{\sigma_a}, \qquad S_F = \frac{R_{p0.2}}{\sigma_{max}}

    VDI 2230 recommends a fatigue safety of 1.2. Bending, and torsion from tightening, are neglected.

    References
    ----------
    .. [1] VDI 2230, part 1 (2015), sections 5.5.2 and 5.5.3.
    """
    alternating = require_non_negative(elongation_amplitude=elongation_amplitude)
    mean = require_finite(elongation=elongation)
    stress_per_elongation = bolt.stiffness / bolt.stress_area
    amplitude = stress_per_elongation * alternating
    highest = bolt.preload / bolt.stress_area + stress_per_elongation * mean + amplitude
    is_static = amplitude == 0
    return BoltStresses(
        bolt_stress_amplitude=amplitude,
        highest_bolt_stress=highest,
        fatigue_safety=np.where(is_static, np.inf, bolt.endurance_limit / np.where(is_static, 1.0, amplitude)),
        yield_safety=bolt.yield_strength / highest,
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class FlextensionalActuator:
    r"""Flextensional (amplified) actuator by its data sheet.

    Parameters
    ----------
    stroke : float
        Stroke with both ends free, well below resonance. [m]
    stroke_voltage : float
        Change of voltage for that stroke. [V]
    blocked_force : float
        Force on blocked ends for the same change of voltage: stroke times stiffness. [N]
    resonance_frequency : float
        Lowest resonance in the mounting of interest: one end fixed, or both free. [Hz]
    free_capacitance : float
        Capacitance with both ends free. [F]
    actuator_mass : float
        Total mass. [kg]
    mechanical_quality_factor : float
        Quality factor of that resonance. []

    Raises
    ------
    InvalidInput
        If a value is not positive, or the effective mass would exceed the total mass.

    Notes
    -----
    Valid up to the first resonance, the only one in a data sheet. With blocked force F, stroke d and resonance f

    .. math:: k = \frac{F}{d}, \qquad m_\mathrm{eff} = \frac{k}{(2\pi f)^2}
    """

    stroke: float
    stroke_voltage: float
    blocked_force: float
    resonance_frequency: float
    free_capacitance: float
    actuator_mass: float
    mechanical_quality_factor: float

    def __post_init__(self) -> None:
        require_positive(**asdict(self))
        if self.effective_mass > self.actuator_mass:
            raise InvalidInput(
                f"resonance_frequency of {self.resonance_frequency:g} Hz with a stiffness of {self.stiffness:.3g} N/m"
                f" moves {self.effective_mass:.3g} kg, more than actuator_mass, {self.actuator_mass:g} kg;"
                " was it measured with a load?"
            )

    @property
    def stiffness(self) -> float:
        """Stiffness between the ends, short-circuited, in N/m."""
        return self.blocked_force / self.stroke

    @property
    def effective_mass(self) -> float:
        """Effective mass of the resonance at that stiffness, in kg.

        With one end fixed it is the mass at the other end; with both free it is the reduced mass of the two, so that
        each of two equal ends has twice as much.
        """
        return self.stiffness / (2 * math.pi * self.resonance_frequency) ** 2


def equivalent_stack(actuator: FlextensionalActuator) -> PiezoStack:
    r"""Massless stack with the stroke, stiffness, damping and capacitance of a flextensional actuator.

    Parameters
    ----------
    actuator : FlextensionalActuator

    Returns
    -------
    PiezoStack
        To be used with the effective mass at the ends.

    Raises
    ------
    InvalidInput
        If stroke, force and capacitance imply a coupling factor above one.

    Notes
    -----
    The damping is that of the quality factor Q, :math:`c = \sqrt{k\, m_\mathrm{eff}}/Q`.
    """
    impedance = math.sqrt(actuator.stiffness * actuator.effective_mass)
    return PiezoStack(
        free_capacitance=actuator.free_capacitance,
        free_stroke_per_volt=actuator.stroke / actuator.stroke_voltage,
        stack_stiffness=actuator.stiffness,
        stack_damping=impedance / actuator.mechanical_quality_factor,
    )


def lever_amplified_stack(stack: PiezoStack, *, amplification_ratio: float) -> PiezoStack:
    """Equivalent stack at the output of an ideal displacement amplifier (lever).

    Parameters
    ----------
    stack : PiezoStack
    amplification_ratio : float
        Output stroke over that of the stack, n. []

    Returns
    -------
    PiezoStack
        Stroke multiplied by n, forces divided by n, stiffness, damping and mass by n squared; capacitance and voltages
        are unchanged.

    Raises
    ------
    InvalidInput
        If the ratio is not positive.

    Notes
    -----
    An ideal lever neither stores nor dissipates energy, so that the coupling factor is unchanged. The compliance of
    real frames lowers it.
    """
    n = float(require_positive(amplification_ratio=amplification_ratio))
    return replace(
        stack,
        free_stroke_per_volt=stack.free_stroke_per_volt * n,
        stack_stiffness=stack.stack_stiffness / n**2,
        stack_damping=stack.stack_damping / n**2,
        stack_mass=stack.stack_mass / n**2,
        preload=None if stack.preload is None else stack.preload / n,
    )
