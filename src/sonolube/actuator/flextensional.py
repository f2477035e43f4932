"""Amplified actuators: a stack in a frame that trades force for stroke, as its data sheet describes it."""

import math
from dataclasses import dataclass

from sonolube.actuator.stack import PiezoStack
from sonolube.checks import require_positive
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True)
class FlextensionalActuator:
    """A flextensional actuator by its data sheet.

    Parameters
    ----------
    stroke : float
        Stroke with both ends free, well below resonance. [m]
    stroke_voltage : float
        Change of voltage that gives it. [V]
    blocked_force : float
        Force on held ends for the same change of voltage: stroke times stiffness. [N]
    resonance_frequency : float
        Lowest resonance, mounted as the effective mass is wanted: with one end held, or with both free. [Hz]
    free_capacitance : float
        Capacitance with both ends free. [F]
    actuator_mass : float
        Mass of the whole. [kg]
    mechanical_quality_factor : float
        Quality factor of that resonance. []

    Raises
    ------
    InvalidInput
        If a value is not positive, or the resonance so low that more than the whole mass would have to move.

    Notes
    -----
    For frequencies up to the first resonance, which alone the data sheet describes.
    """

    stroke: float
    stroke_voltage: float
    blocked_force: float
    resonance_frequency: float
    free_capacitance: float
    actuator_mass: float
    mechanical_quality_factor: float

    def __post_init__(self) -> None:
        require_positive(
            stroke=self.stroke,
            stroke_voltage=self.stroke_voltage,
            blocked_force=self.blocked_force,
            resonance_frequency=self.resonance_frequency,
            free_capacitance=self.free_capacitance,
            actuator_mass=self.actuator_mass,
            mechanical_quality_factor=self.mechanical_quality_factor,
        )
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
        """Mass which that stiffness carries at the resonance, in kg.

        For a resonance with one end held, the mass at the other; for one with both ends free their reduced mass, so
        that each of two equal ends has twice as much.
        """
        return self.stiffness / (2 * math.pi * self.resonance_frequency) ** 2


def equivalent_stack(actuator: FlextensionalActuator) -> PiezoStack:
    """Return the stack without mass that acts as the actuator does between its ends.

    Parameters
    ----------
    actuator : FlextensionalActuator

    Returns
    -------
    PiezoStack
        Goes with `effective_mass`, which the chain has to carry at the ends.

    Raises
    ------
    InvalidInput
        If stroke, force and capacitance would give more energy than the drive puts in.
    """
    impedance = math.sqrt(actuator.stiffness * actuator.effective_mass)
    return PiezoStack(
        free_capacitance=actuator.free_capacitance,
        free_stroke_per_volt=actuator.stroke / actuator.stroke_voltage,
        stack_stiffness=actuator.stiffness,
        stack_damping=impedance / actuator.mechanical_quality_factor,
    )


def lever_amplified_stack(stack: PiezoStack, *, amplification_ratio: float) -> PiezoStack:
    """Return the stack as it acts through an ideal lever.

    Parameters
    ----------
    stack : PiezoStack
    amplification_ratio : float
        Stroke at the lever's end over that of the stack, n. []

    Returns
    -------
    PiezoStack
        Stroke times n, forces over n; stiffness, damping and mass over n squared; capacitance and voltages as they
        are.

    Raises
    ------
    InvalidInput
        If the ratio is not positive.

    Notes
    -----
    A lever neither stores nor loses energy, so the coupling factor stays. Real frames bend: their own stiffness lowers
    the coupling factor, and data sheets tell by how much.
    """
    n = float(require_positive(amplification_ratio=amplification_ratio))
    return PiezoStack(
        free_capacitance=stack.free_capacitance,
        free_stroke_per_volt=stack.free_stroke_per_volt * n,
        stack_stiffness=stack.stack_stiffness / n**2,
        stack_damping=stack.stack_damping / n**2,
        stack_mass=stack.stack_mass / n**2,
        lowest_voltage=stack.lowest_voltage,
        highest_voltage=stack.highest_voltage,
        preload=None if stack.preload is None else stack.preload / n,
        coupling_factor=stack.coupling_factor,
    )
