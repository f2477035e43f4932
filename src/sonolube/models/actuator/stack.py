"""Quasi-static model of a piezoelectric stack: constitutive law, force, and limits of its drive."""

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

_COUPLING_TOLERANCE = 0.05  # relative difference between the stated and the derived coupling factor that is accepted


@dataclass(frozen=True, kw_only=True, slots=True)
class PiezoStack:
    r"""Multilayer piezoelectric stack, short compared with the wavelength.

    Parameters
    ----------
    free_capacitance : float
        Capacitance C_T with the ends free, well below resonance. [F]
    free_stroke_per_volt : float
        Elongation per volt with the ends free: number of layers times charge constant, N d33. [m/V]
    stack_stiffness : float
        Short-circuit stiffness k_p between the ends. [N/m]
    stack_damping : float
        Damping c_p between the ends. [N s/m]
    stack_mass : float
        Effective mass m_0, attributed to the body at the back of the stack. [kg]
    lowest_voltage : float or None
        Lowest admissible voltage, below which the layers depole; None where not stated. [V]
    highest_voltage : float or None
        Highest admissible voltage; None where not stated. [V]
    preload : float or None
        Compression at rest, which must exceed any dynamic tension; None where not stated. [N]
    coupling_factor : float or None
        Stated coupling factor, to be compared with the derived one; None where not stated. []

    Raises
    ------
    InvalidInput
        If a capacitance, stroke or stiffness is not positive, a damping, mass or preload negative, a stated coupling
        factor outside 0 to 1, the voltage limits in the wrong order, or the derived coupling factor not below one:
        (N d33)^2 k_p must be less than C_T.

    Warns
    -----
    InconsistentCoupling
        If the stated coupling factor differs from the derived one by more than 5 %.

    Notes
    -----
    With the voltage V, elongation e, compressive force P on the ends and charge q

    .. math:: P = k_p (N d_{33} V - e) - c_p \dot e, \qquad q = C_S V + N d_{33} k_p e

    and the coupling factor and clamped capacitance

    .. math:: k^2 = \frac{(N d_{33})^2 k_p}{C_T}, \qquad C_S = C_T (1 - k^2)

    References
    ----------
    .. [1] D 3.32, 3.33 and 3.42, generalised from one layer to N. D Table 3.5 lists stroke, stiffness, capacitance and
       a coupling factor of 0.431; the first three imply 0.65, or 0.54 if its capacitance is the clamped one.
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
        require_voltage_limits(self.lowest_voltage, self.highest_voltage)
        self._check_coupling()

    def _check_coupling(self) -> None:
        """Refuse a derived coupling factor above one, and warn of a stated one that differs."""
        motional = self.charge_per_elongation * self.free_stroke_per_volt
        if motional >= self.free_capacitance:
            raise InvalidInput(
                f"free_capacitance must exceed free_stroke_per_volt^2 stack_stiffness, {motional:.4g} F,"
                f" got {self.free_capacitance!r} F: the coupling factor would exceed 1"
            )
        if self.coupling_factor is not None:
            require_within(0.0, 1.0, coupling_factor=self.coupling_factor)
            if caveat := _coupling_caveat(self):
                warnings.warn(caveat, InconsistentCoupling, stacklevel=4)

    @property
    def charge_per_elongation(self) -> float:
        """Charge per elongation at constant voltage, equal to blocked force per volt: N d33 k_p, in N/V."""
        return self.free_stroke_per_volt * self.stack_stiffness

    @property
    def derived_coupling_factor(self) -> float:
        """Coupling factor derived from stroke, stiffness and capacitance: k^2 = (N d33)^2 k_p/C_T."""
        return math.sqrt(self.charge_per_elongation * self.free_stroke_per_volt / self.free_capacitance)

    @property
    def clamped_capacitance(self) -> float:
        """Capacitance with the ends blocked, C_S = C_T (1 - k^2), in F."""
        return self.free_capacitance - self.charge_per_elongation * self.free_stroke_per_volt


def require_voltage_limits(low: float | None, high: float | None) -> None:
    """Refuse limits of a voltage in the wrong order."""
    require_finite(lowest_voltage=low or 0.0, highest_voltage=high or 0.0)
    if low is not None and high is not None and low >= high:
        raise InvalidInput(f"lowest_voltage must lie below highest_voltage, {high!r} V, got {low!r} V")


def stack_force(
    stack: PiezoStack, *, voltage_amplitude: ArrayLike, elongation: ArrayLike, frequency: ArrayLike
) -> Complexes:
    r"""Complex amplitude of the compressive force on the ends of a stack in harmonic motion. [N]

    Parameters
    ----------
    stack : PiezoStack
    voltage_amplitude : array_like
        Amplitude of the voltage about its mean, complex where its phase matters. [V]
    elongation : array_like, broadcast against `voltage_amplitude`
        Amplitude of the elongation about its mean, complex where its phase matters. [m]
    frequency : array_like, broadcast against `voltage_amplitude`
        Frequency of the motion. [Hz]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If an amplitude is not finite or a frequency not positive.

    Notes
    -----
    .. math:: P = N d_{33} k_p V - (k_p + i\omega c_p)\, e
    """
    s = 2j * np.pi * require_positive(frequency=frequency)
    e = require_finite_complex(elongation=elongation)
    blocked = stack.charge_per_elongation * require_finite_complex(voltage_amplitude=voltage_amplitude)
    return np.asarray(blocked - (stack.stack_stiffness + s * stack.stack_damping) * e)


def require_allowed_voltage(stack: PiezoStack, *, stack_voltage: ArrayLike) -> Floats:
    """Voltages as an array, refused where they are beyond the limits of the stack. [V]

    Parameters
    ----------
    stack : PiezoStack
    stack_voltage : array_like, any shape
        Voltages of the drive. [V]

    Returns
    -------
    ndarray, shape of `stack_voltage`

    Raises
    ------
    InvalidInput
        If a voltage is not finite, or beyond the limits of the stack.
    """
    volts = require_finite(stack_voltage=stack_voltage)
    lowest, highest = float(np.min(volts, initial=np.inf)), float(np.max(volts, initial=-np.inf))
    if stack.lowest_voltage is not None and lowest < stack.lowest_voltage:
        raise InvalidInput(
            f"the drive goes down to {lowest:g} V; the lowest admissible voltage is {stack.lowest_voltage:g} V"
        )
    if stack.highest_voltage is not None and highest > stack.highest_voltage:
        raise InvalidInput(
            f"the drive goes up to {highest:g} V; the highest admissible voltage is {stack.highest_voltage:g} V"
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
    """Caveats of a drive: tension beyond the preload and an inconsistent coupling factor, one line each with advice.

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
        Empty where there is none.

    Raises
    ------
    InvalidInput
        If a voltage is beyond the limits of the stack, a peak-to-peak voltage negative, a frequency not positive, or a
        value not finite.

    Notes
    -----
    The mean compression is taken as the preload, as in a structure whose ends follow the offset of the voltage freely.
    """
    offset = require_finite(voltage_offset=voltage_offset)
    amplitude = require_non_negative(voltage_peak_to_peak=voltage_peak_to_peak) / 2
    for volts in (offset - amplitude, offset + amplitude):
        require_allowed_voltage(stack, stack_voltage=volts)
    force = stack_force(stack, voltage_amplitude=amplitude, elongation=elongation, frequency=frequency)
    caveats = (_tension_caveat(stack, float(np.max(np.abs(force), initial=0.0))), _coupling_caveat(stack))
    return tuple(caveat for caveat in caveats if caveat)


def _tension_caveat(stack: PiezoStack, tension: float) -> str:
    """Caveat of a dynamic tension beyond the preload; empty where there is none."""
    if tension <= (stack.preload or 0.0):
        return ""
    if stack.preload is None:
        return f"the vibration causes a tension in the stack of up to {tension:.0f} N and no preload is stated"
    return (
        f"tension in the stack: the vibration causes a tension of up to {tension:.0f} N on a preload of"
        f" {stack.preload:.0f} N; ceramics crack in tension: preload more or drive less"
    )


def _coupling_caveat(stack: PiezoStack) -> str:
    """Caveat of a stated coupling factor that differs from the derived one; empty where they agree."""
    stated, derived = stack.coupling_factor, stack.derived_coupling_factor
    if stated is None or abs(stated - derived) <= _COUPLING_TOLERANCE * derived:
        return ""
    return (
        f"coupling_factor is stated as {stated:g}, but stroke, stiffness and capacitance imply {derived:.3g},"
        " which is used; is the capacitance the free one?"
    )
