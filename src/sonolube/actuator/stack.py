"""The piezoelectric stack: layers that act as one spring, whose rest length a voltage sets."""

import math
import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import (
    Complexes,
    Floats,
    require_finite,
    require_finite_complex,
    require_non_negative,
    require_positive,
    require_within,
)
from sonolube.errors import InconsistentCoupling, InvalidInput

COUPLING_TOLERANCE = 0.05


@dataclass(frozen=True, kw_only=True, slots=True)
class PiezoStack:
    """A stack of poled layers, short against the waves in it.

    With voltage V, elongation e, compressive force P on its ends and charge q,

        P = k_p (N d33 V - e) - c_p de/dt          q = C_S V + N d33 k_p e

    Parameters
    ----------
    free_capacitance : float
        Capacitance C_T with the ends free, well below resonance. [F]
    free_stroke_per_volt : float
        Elongation per volt with the ends free: layers times charge constant, N d33. [m/V]
    stack_stiffness : float
        Stiffness k_p between the ends, short-circuited. [N/m]
    stack_damping : float
        Damping c_p between the ends. [N s/m]
    stack_mass : float
        Effective mass m_0, counted with the body behind the stack. [kg]
    lowest_voltage : float or None
        Lowest voltage before the layers depole; None where it is not stated. [V]
    highest_voltage : float or None
        Highest voltage that the layers bear; None where it is not stated. [V]
    preload : float or None
        Compression at rest, which must outweigh any tension; None where it is not stated. [N]
    coupling_factor : float or None
        Coupling factor as stated, to be compared with the derived one; None where none is stated. []

    Raises
    ------
    InvalidInput
        If a capacitance, stroke or stiffness is not positive, a damping, mass or preload negative, a stated coupling
        factor outside 0 to 1, the limits in the wrong order, or the stack would give more energy than it is given:
        (N d33)^2 k_p must be less than C_T.

    Warns
    -----
    InconsistentCoupling
        If the stated coupling factor disagrees with the derived one by more than 5 %.

    References
    ----------
    .. [1] D 3.32, 3.33 and 3.42, taken from one layer to N. Table 3.5 lists stroke, stiffness, capacitance and a
       coupling factor of 0.431; the first three imply 0.65, or 0.54 if its capacitance is the clamped one.
    """

    free_capacitance: float
    free_stroke_per_volt: float
    stack_stiffness: float
    stack_damping: float
    stack_mass: float = 0.0
    lowest_voltage: float | None = None
    highest_voltage: float | None = None
    preload: float | None = None
    coupling_factor: float | None = None

    def __post_init__(self) -> None:
        require_positive(
            free_capacitance=self.free_capacitance,
            free_stroke_per_volt=self.free_stroke_per_volt,
            stack_stiffness=self.stack_stiffness,
        )
        require_non_negative(stack_damping=self.stack_damping, stack_mass=self.stack_mass)
        if self.preload is not None:
            require_non_negative(preload=self.preload)
        self._check_limits()
        self._check_coupling()

    def _check_limits(self) -> None:
        low, high = self.lowest_voltage, self.highest_voltage
        require_finite(lowest_voltage=low or 0.0, highest_voltage=high or 0.0)
        if low is not None and high is not None and low >= high:
            raise InvalidInput(f"lowest_voltage must lie below highest_voltage, {high!r} V, got {low!r} V")

    def _check_coupling(self) -> None:
        moved = self.charge_per_elongation * self.free_stroke_per_volt
        if moved >= self.free_capacitance:
            raise InvalidInput(
                f"free_capacitance must exceed free_stroke_per_volt^2 stack_stiffness, {moved:.4g} F,"
                f" got {self.free_capacitance!r} F: the coupling factor would exceed 1"
            )
        if self.coupling_factor is not None:
            require_within(0.0, 1.0, coupling_factor=self.coupling_factor)
            if caveat := _coupling_caveat(self):
                warnings.warn(caveat, InconsistentCoupling, stacklevel=4)

    @property
    def charge_per_elongation(self) -> float:
        """Charge per elongation at constant voltage, which is also blocked force per volt, N d33 k_p, in N/V."""
        return self.free_stroke_per_volt * self.stack_stiffness

    @property
    def derived_coupling_factor(self) -> float:
        """Coupling factor that stroke, stiffness and capacitance imply: k^2 = (N d33)^2 k_p/C_T."""
        return math.sqrt(self.charge_per_elongation * self.free_stroke_per_volt / self.free_capacitance)

    @property
    def clamped_capacitance(self) -> float:
        """Capacitance with the ends held, C_S = C_T (1 - k^2), in F."""
        return self.free_capacitance - self.charge_per_elongation * self.free_stroke_per_volt


def free_stroke(stack: PiezoStack, *, stack_voltage: ArrayLike) -> Floats:
    """Return the static elongation with free ends. [m]

    Parameters
    ----------
    stack : PiezoStack
    stack_voltage : array_like, any shape
        Voltage on the stack. [V]

    Returns
    -------
    ndarray, shape of `stack_voltage`

    Raises
    ------
    InvalidInput
        If a voltage is not finite, or beyond the stack's limits.
    """
    return stack.free_stroke_per_volt * require_allowed_voltage(stack, stack_voltage=stack_voltage)


def blocked_force(stack: PiezoStack, *, stack_voltage: ArrayLike) -> Floats:
    """Return the compressive force on held ends. [N]

    Parameters
    ----------
    stack : PiezoStack
    stack_voltage : array_like, any shape
        Voltage on the stack. [V]

    Returns
    -------
    ndarray, shape of `stack_voltage`

    Raises
    ------
    InvalidInput
        If a voltage is not finite, or beyond the stack's limits.

    References
    ----------
    .. [1] D 3.42.
    """
    return stack.charge_per_elongation * require_allowed_voltage(stack, stack_voltage=stack_voltage)


def blocked_admittance(stack: PiezoStack, *, frequency: ArrayLike) -> Complexes:
    """Return current per voltage with held ends, complex. [S]

    Parameters
    ----------
    stack : PiezoStack
    frequency : array_like, any shape
        Frequency of the voltage. [Hz]

    Returns
    -------
    ndarray, shape of `frequency`

    Raises
    ------
    InvalidInput
        If a frequency is not positive.
    """
    return np.asarray(2j * np.pi * require_positive(frequency=frequency) * stack.clamped_capacitance)


def free_admittance(stack: PiezoStack, *, frequency: ArrayLike) -> Complexes:
    """Return current per voltage with ends that nothing holds or loads, complex. [S]

    Parameters
    ----------
    stack : PiezoStack
    frequency : array_like, any shape
        Frequency of the voltage. [Hz]

    Returns
    -------
    ndarray, shape of `frequency`

    Raises
    ------
    InvalidInput
        If a frequency is not positive.

    Notes
    -----
    The stack's own mass is left out: one end would carry all of it and the other none. For ends with masses put the
    stack into a chain and take the admittance of the structure.
    """
    s = 2j * np.pi * require_positive(frequency=frequency)
    motional = stack.charge_per_elongation**2 / (stack.stack_stiffness + s * stack.stack_damping)
    return np.asarray(s * (stack.clamped_capacitance + motional))


def stack_force(
    stack: PiezoStack, *, voltage_amplitude: ArrayLike, elongation: ArrayLike, frequency: ArrayLike
) -> Complexes:
    """Return the complex amplitude of the compressive force on the ends in steady sinusoidal motion. [N]

    Parameters
    ----------
    stack : PiezoStack
    voltage_amplitude : array_like
        Amplitude of the voltage about its mean, complex where its phase matters. [V]
    elongation : array_like, broadcast against `voltage_amplitude`
        Amplitude of the elongation about its mean, complex where its phase matters. [m]
    frequency : array_like, broadcast against `voltage_amplitude`
        Frequency of both. [Hz]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If an amplitude is not finite or a frequency not positive.
    """
    s = 2j * np.pi * require_positive(frequency=frequency)
    e = require_finite_complex(elongation=elongation)
    push = stack.charge_per_elongation * require_finite_complex(voltage_amplitude=voltage_amplitude)
    return np.asarray(push - (stack.stack_stiffness + s * stack.stack_damping) * e)


def require_allowed_voltage(stack: PiezoStack, *, stack_voltage: ArrayLike) -> Floats:
    """Return voltages as an array; refuse any that the stack does not bear. [V]

    Parameters
    ----------
    stack : PiezoStack
    stack_voltage : array_like, any shape
        Voltages that the drive reaches. [V]

    Returns
    -------
    ndarray, shape of `stack_voltage`

    Raises
    ------
    InvalidInput
        If a voltage is not finite, or beyond the stack's limits.
    """
    volts = require_finite(stack_voltage=stack_voltage)
    lowest, highest = float(np.min(volts, initial=np.inf)), float(np.max(volts, initial=-np.inf))
    if stack.lowest_voltage is not None and lowest < stack.lowest_voltage:
        raise InvalidInput(
            f"the drive goes down to {lowest:g} V; the stack bears no less than {stack.lowest_voltage:g} V"
        )
    if stack.highest_voltage is not None and highest > stack.highest_voltage:
        raise InvalidInput(
            f"the drive goes up to {highest:g} V; the stack bears no more than {stack.highest_voltage:g} V"
        )
    return volts


def stack_caveats(
    stack: PiezoStack,
    *,
    voltage_offset: ArrayLike,
    voltage_peak_to_peak: ArrayLike,
    elongation: ArrayLike,
    frequency: ArrayLike,
) -> tuple[str, ...]:
    """Return what speaks against driving the stack so, one line each, with advice.

    Parameters
    ----------
    stack : PiezoStack
    voltage_offset : array_like
        Mean of the highest and the lowest voltage. [V]
    voltage_peak_to_peak : array_like, broadcast against `voltage_offset`
        Difference of the highest and the lowest voltage. [V]
    elongation : array_like, broadcast against `voltage_offset`
        Amplitude of the elongation, complex where its phase against the voltage matters. [m]
    frequency : array_like, broadcast against `voltage_offset`
        Frequency of the drive. [Hz]

    Returns
    -------
    tuple of str
        Empty where nothing is known to speak against it.

    Raises
    ------
    InvalidInput
        If a voltage goes beyond the stack's limits, a peak-to-peak voltage is negative, a frequency not positive, or a
        value not finite.

    Notes
    -----
    Takes the mean compression to be the preload, as it is where the structure floats: there the ends yield to the
    offset.
    """
    centre = require_finite(voltage_offset=voltage_offset)
    swing = require_non_negative(voltage_peak_to_peak=voltage_peak_to_peak) / 2
    for volts in (centre - swing, centre + swing):
        require_allowed_voltage(stack, stack_voltage=volts)
    force = stack_force(stack, voltage_amplitude=swing, elongation=elongation, frequency=frequency)
    caveats = (_tension_caveat(stack, float(np.max(np.abs(force), initial=0.0))), _coupling_caveat(stack))
    return tuple(caveat for caveat in caveats if caveat)


def _tension_caveat(stack: PiezoStack, pull: float) -> str:
    if stack.preload is None:
        return f"the vibration pulls on the stack with up to {pull:.3g} N and no preload is stated" if pull > 0 else ""
    if pull <= stack.preload:
        return ""
    return (
        f"tension in the stack: the vibration pulls with up to {pull:.3g} N on a preload of {stack.preload:g} N;"
        " ceramics crack in tension: preload more or drive less"
    )


def _coupling_caveat(stack: PiezoStack) -> str:
    stated, derived = stack.coupling_factor, stack.derived_coupling_factor
    if stated is None or abs(stated - derived) <= COUPLING_TOLERANCE * derived:
        return ""
    return (
        f"coupling_factor is stated as {stated:g}, but stroke, stiffness and capacitance imply {derived:.3g},"
        " which is taken; is the capacitance the free one?"
    )
