"""Flextensional actuators by their data sheet, and stacks behind an ideal displacement amplifier."""

import math
from dataclasses import asdict, dataclass, replace

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput
from sonolube.models.actuator.stack import PiezoStack


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
