"""What an amplifier must give an actuator: voltage, current, apparent power, slope."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from sonolube.actuator.drive_power import dissipated_power, peak_current, power_factor
from sonolube.checks import require_finite, require_finite_complex, require_positive

_POINTS_PER_WAVE = 32


@dataclass(frozen=True, kw_only=True, slots=True)
class AmplifierRequirements:
    """What an amplifier has to deliver.

    Parameters
    ----------
    voltage_maximum : float
        Highest voltage against ground, either way. [V]
    peak_current : float
        Highest current, either way. [A]
    rms_current : float
        Root mean square of the current. [A]
    apparent_power : float
        Effective voltage about its mean times effective current. [W]
    dissipated_power : float
        Mean power taken by the actuator and what it drives. [W]
    power_factor : float
        The one over the other. []
    slew_rate : float
        Fastest change of the voltage. [V/s]
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
    """Return what an amplifier has to deliver to drive an actuator with a periodic voltage.

    Parameters
    ----------
    admittance : array_like, shape (n,)
        Complex admittance at the harmonics 1 to n of the drive. [S]
    voltage_amplitude : array_like, shape (n,)
        Complex amplitude of those harmonics of the voltage, zero to peak. [V]
    frequency : float
        Frequency of the drive. [Hz]
    voltage_offset : float
        Mean of the drive. [V]

    Returns
    -------
    AmplifierRequirements

    Raises
    ------
    InvalidInput
        If a value is not finite, or the frequency not positive.
    """
    y = np.atleast_1d(require_finite_complex(admittance=admittance))
    volts = np.atleast_1d(require_finite_complex(voltage_amplitude=voltage_amplitude))
    f, offset = float(require_positive(frequency=frequency)), float(require_finite(voltage_offset=voltage_offset))
    orders = np.arange(1, volts.shape[-1] + 1)
    phase = np.linspace(0, 2 * np.pi, _POINTS_PER_WAVE * orders.size, endpoint=False)
    waves = np.exp(1j * np.multiply.outer(orders, phase))
    one = orders.size == 1
    swing = np.abs(volts) if one else np.abs((volts @ waves).real)
    lowest, highest = (-swing.max(), swing.max()) if one else ((volts @ waves).real.min(), (volts @ waves).real.max())
    rate = 2j * np.pi * f * orders * volts
    current = float(np.sqrt(0.5 * np.sum(np.abs(y * volts) ** 2)))
    return AmplifierRequirements(
        voltage_maximum=float(max(abs(offset + lowest), abs(offset + highest))),
        peak_current=float(peak_current(admittance=y, voltage_amplitude=volts)),
        rms_current=current,
        apparent_power=current * float(np.sqrt(0.5 * np.sum(np.abs(volts) ** 2))),
        dissipated_power=float(dissipated_power(admittance=y, voltage_amplitude=volts).sum()),
        power_factor=float(power_factor(admittance=y, voltage_amplitude=volts)),
        slew_rate=float(np.abs(rate).max() if one else np.abs((rate @ waves).real).max()),
    )
