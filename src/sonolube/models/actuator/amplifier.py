"""Requirements on the amplifier of an actuator: voltage, current, power and slew rate."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import require_finite, require_finite_complex, require_positive
from sonolube.models.actuator.drive_power import dissipated_power, extremes_over_period, peak_current, power_factor


@dataclass(frozen=True, kw_only=True, slots=True)
class AmplifierRequirements:
    """Requirements on an amplifier under a periodic voltage.

    Parameters
    ----------
    voltage_maximum : float
        Greatest magnitude of the voltage to ground, its offset included. [V]
    peak_current : float
        Greatest magnitude of the current. [A]
    rms_current : float
        Root-mean-square current. [A]
    apparent_power : float
        Root-mean-square alternating voltage times root-mean-square current. [W]
    dissipated_power : float
        Mean real power drawn by the actuator and what it drives. [W]
    power_factor : float
        Dissipated over apparent power. []
    slew_rate : float
        Greatest rate of change of the voltage. [V/s]
    """

    voltage_maximum: float
    peak_current: float
    rms_current: float
    apparent_power: float
    dissipated_power: float
    power_factor: float
    slew_rate: float


def amplifier_requirements(
    *, admittance: ArrayLike, voltage_amplitude: ArrayLike, frequency: float, voltage_offset: float = 0.0
) -> AmplifierRequirements:
    r"""Voltage, current, power and slew rate that an amplifier has to supply for a periodic drive of an actuator.

    Parameters
    ----------
    admittance : array_like, shape (n,)
        Complex admittance at the harmonics 1 to n of the drive. [S]
    voltage_amplitude : array_like, shape (n,)
        Complex amplitude of these harmonics of the voltage, zero to peak. [V]
    frequency : float
        Frequency of the drive. [Hz]
    voltage_offset : float
        Mean voltage. [V]

    Returns
    -------
    AmplifierRequirements

    Raises
    ------
    InvalidInput
        If a value is not finite, or the frequency not positive.

    Notes
    -----
    With the admittance :math:`Y_n` and the voltage amplitude :math:`U_n` of the harmonics

    .. math::

        I_\mathrm{rms}^2 = \tfrac12 \sum_n |Y_n U_n|^2, \qquad
        S = I_\mathrm{rms} \sqrt{\tfrac12 \sum_n |U_n|^2}, \qquad
        P = \tfrac12 \sum_n \mathrm{Re}\, Y_n\, |U_n|^2

    Extrema over the period are those at 32 points per period of the highest harmonic; of a sine they are exact.

    See Also
    --------
    sonolube.models.actuator.matching : Networks that reduce the current.
    """
    y = np.atleast_1d(require_finite_complex(admittance=admittance))
    volts = np.atleast_1d(require_finite_complex(voltage_amplitude=voltage_amplitude))
    f, offset = float(require_positive(frequency=frequency)), float(require_finite(voltage_offset=voltage_offset))
    lowest, highest = extremes_over_period(volts)
    falling, rising = extremes_over_period(2j * np.pi * f * np.arange(1, volts.size + 1) * volts)
    rms_current = float(np.sqrt(0.5 * np.sum(np.abs(y * volts) ** 2)))
    return AmplifierRequirements(
        voltage_maximum=float(max(abs(offset + lowest), abs(offset + highest))),
        peak_current=float(peak_current(admittance=y, voltage_amplitude=volts)),
        rms_current=rms_current,
        apparent_power=rms_current * float(np.sqrt(0.5 * np.sum(np.abs(volts) ** 2))),
        dissipated_power=float(dissipated_power(admittance=y, voltage_amplitude=volts).sum()),
        power_factor=float(power_factor(admittance=y, voltage_amplitude=volts)),
        slew_rate=float(max(-falling, rising)),
    )
