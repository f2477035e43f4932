"""The bolt that keeps a stack in compression: what it stiffens, what it bears, how it tires."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from sonolube.actuator.stack import PiezoStack
from sonolube.checks import Floats, require_finite, require_non_negative, require_positive
from sonolube.errors import InvalidInput

_COARSE_PITCH = {2e-3: 0.4e-3, 2.5e-3: 0.45e-3, 3e-3: 0.5e-3, 4e-3: 0.7e-3, 5e-3: 0.8e-3, 6e-3: 1e-3, 8e-3: 1.25e-3}
_COARSE_PITCH |= {10e-3: 1.5e-3, 12e-3: 1.75e-3}  # ISO 261


@dataclass(frozen=True, kw_only=True, slots=True)
class PreloadBolt:
    """A metric bolt through or beside a stack, between the same two bodies.

    Parameters
    ----------
    thread_diameter : float
        Nominal diameter of the thread. [m]
    length : float
        Length that stretches, thread all along. [m]
    youngs_modulus : float
        Young's modulus. [Pa]
    yield_strength : float
        Proof strength Rp0.2. [Pa]
    preload : float
        Tension at rest, which is the compression of the stack. [N]
    bolts : int
        How many share the preload.

    Raises
    ------
    InvalidInput
        If a value is not positive, or the diameter none of M2 to M12.

    References
    ----------
    .. [1] ISO 261, coarse pitch; ISO 898-1, stress area.
    """

    thread_diameter: float
    length: float
    youngs_modulus: float
    yield_strength: float
    preload: float
    bolts: int = 1

    def __post_init__(self) -> None:
        require_positive(
            thread_diameter=self.thread_diameter,
            length=self.length,
            youngs_modulus=self.youngs_modulus,
            yield_strength=self.yield_strength,
            preload=self.preload,
            bolts=self.bolts,
        )
        if not any(math.isclose(self.thread_diameter, size) for size in _COARSE_PITCH):
            known = ", ".join(f"{1e3 * size:g}" for size in _COARSE_PITCH)
            raise InvalidInput(
                f"thread_diameter must be one of {known} mm, got {1e3 * self.thread_diameter:g} mm: other threads have"
                " no coarse pitch here"
            )

    @property
    def stress_area(self) -> float:
        """Stress area of all bolts together, pi/4 (d - 0.9382 P)^2 each, in m2."""
        pitch = next(p for size, p in _COARSE_PITCH.items() if math.isclose(size, self.thread_diameter))
        return self.bolts * math.pi / 4 * (self.thread_diameter - 0.9382 * pitch) ** 2  # ISO 898-1

    @property
    def stiffness(self) -> float:
        """Stiffness of all bolts together, in N/m."""
        return self.youngs_modulus * self.stress_area / self.length

    @property
    def endurance_limit(self) -> float:
        """Amplitude of the stress that a thread rolled before heat treatment bears for ever, in Pa.

        0.85 (150 mm/d + 45) MPa, for mean tensions between 0.2 and 0.8 of the proof load.
        """
        return 0.85e6 * (0.15 / self.thread_diameter + 45)  # VDI 2230-1, 5.5.3


def bolted_stack(stack: PiezoStack, bolt: PreloadBolt) -> PiezoStack:
    """Return the stack and its bolt as one stack between the bodies.

    Parameters
    ----------
    stack : PiezoStack
    bolt : PreloadBolt

    Returns
    -------
    PiezoStack
        Stiffer by the bolt, its stroke less in the same proportion; force per volt and clamped capacitance stay.

    Notes
    -----
    The bolt is a spring beside the stack: k = k_p + k_b, N d33 k = N d33 k_p. With the ends free the bolt holds the
    stack, so that the capacitance is the clamped one and (N d33 k_p)^2/k.
    """
    stiffness = stack.stack_stiffness + bolt.stiffness
    push = stack.charge_per_elongation
    return replace(
        stack,
        stack_stiffness=stiffness,
        free_stroke_per_volt=push / stiffness,
        free_capacitance=stack.clamped_capacitance + push**2 / stiffness,
        preload=bolt.preload,
        coupling_factor=None,
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class BoltStresses:
    """What a bolt bears, each array of the shape of the elongations.

    Parameters
    ----------
    bolt_stress_amplitude : ndarray
        Amplitude of the stress. [Pa]
    highest_bolt_stress : ndarray
        Highest stress. [Pa]
    fatigue_safety : ndarray
        Endurance limit over amplitude; infinite where nothing moves. []
    yield_safety : ndarray
        Proof strength over the highest stress. []
    """

    bolt_stress_amplitude: Floats
    highest_bolt_stress: Floats
    fatigue_safety: Floats
    yield_safety: Floats


def bolt_stresses(bolt: PreloadBolt, *, elongation_amplitude: ArrayLike, elongation: ArrayLike = 0.0) -> BoltStresses:
    """Return stresses and safeties of a bolt that a stack stretches.

    Parameters
    ----------
    bolt : PreloadBolt
    elongation_amplitude : array_like
        Half of the elongation from peak to peak. [m]
    elongation : array_like
        Mean elongation by the drive's offset. [m]

    Returns
    -------
    BoltStresses

    Raises
    ------
    InvalidInput
        If an amplitude is negative, or a value not finite.

    Notes
    -----
    VDI 2230 asks for 1.2 of the fatigue safety. Bending and torsion of tightening are left out.

    References
    ----------
    .. [1] VDI 2230, part 1 (2015), sections 5.5.2 and 5.5.3.
    """
    swing = require_non_negative(elongation_amplitude=elongation_amplitude)
    mean = require_finite(elongation=elongation)
    per_length = bolt.stiffness / bolt.stress_area
    amplitude = per_length * swing
    highest = bolt.preload / bolt.stress_area + per_length * mean + amplitude
    still = amplitude == 0
    return BoltStresses(
        bolt_stress_amplitude=amplitude,
        highest_bolt_stress=highest,
        fatigue_safety=np.where(still, np.inf, bolt.endurance_limit / np.where(still, 1.0, amplitude)),
        yield_safety=bolt.yield_strength / highest,
    )
