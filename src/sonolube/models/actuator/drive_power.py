"""Electrical power and current of a capacitive actuator: amplifier power, dissipation, power factor, peak current."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, Floats, require_finite_complex, require_non_negative, require_positive

_POINTS_PER_WAVE = 32  # peaks between points are missed by at most 1 - cos(pi/32), half a percent


def linear_amplifier_power(
    *, capacitance: ArrayLike, voltage_maximum: ArrayLike, voltage_peak_to_peak: ArrayLike, frequency: ArrayLike
) -> Floats:
    r"""Mean power that a linear amplifier draws from its supply to drive a capacitance. [W]

    Parameters
    ----------
    capacitance : array_like
        Capacitance of the actuator. [F]
    voltage_maximum : array_like
        Highest voltage of the drive, its offset included. [V]
    voltage_peak_to_peak : array_like
        Peak-to-peak voltage of the drive. [V]
    frequency : array_like
        Frequency of the drive. [Hz]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a capacitance or frequency is not positive, a voltage negative, or a value not finite.

    Notes
    -----
    .. math:: P_a = C\, U_{max}\, U_{pp}\, f \quad\text{(D 1.9)}

    The charge C U_pp is drawn f times a second from a supply at U_max and returned to ground. The actuator returns this
    reactive energy and the amplifier dissipates it; the actuator itself dissipates `dissipated_power`.

    References
    ----------
    .. [1] D 1.9.

    Examples
    --------
    >>> from sonolube.models.actuator import linear_amplifier_power
    >>> drive = {"voltage_maximum": 28.0, "voltage_peak_to_peak": 28.0, "frequency": 22e3}
    >>> round(float(linear_amplifier_power(capacitance=360e-9, **drive)), 2)
    6.21
    """
    C, f = require_positive(capacitance=capacitance), require_positive(frequency=frequency)  # noqa: N806
    U_max = require_non_negative(voltage_maximum=voltage_maximum)  # noqa: N806
    U_pp = require_non_negative(voltage_peak_to_peak=voltage_peak_to_peak)  # noqa: N806
    return C * U_max * U_pp * f  # D 1.9


def dissipated_power(*, admittance: ArrayLike, voltage_amplitude: ArrayLike) -> Floats:
    r"""Mean real power drawn by an actuator: dissipated in it or transmitted to what it drives. [W]

    Parameters
    ----------
    admittance : array_like
        Complex admittance at the frequency of the drive. [S]
    voltage_amplitude : array_like, broadcast against `admittance`
        Amplitude of the voltage, zero to peak. [V]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    Raises
    ------
    InvalidInput
        If a value is not finite.

    Notes
    -----
    .. math:: P = \tfrac12\, \mathrm{Re}(V I^*) = \tfrac12\, \mathrm{Re}\, Y\, |V|^2

    The powers of the harmonics of a periodic drive add.
    """
    y = require_finite_complex(admittance=admittance)
    volts = require_finite_complex(voltage_amplitude=voltage_amplitude)
    return np.asarray(0.5 * y.real * np.abs(volts) ** 2, dtype=np.float64)


def power_factor(*, admittance: ArrayLike, voltage_amplitude: ArrayLike) -> Floats:
    r"""Power factor: dissipated power over the product of root-mean-square voltage and current. []

    Parameters
    ----------
    admittance : array_like, shape (..., n)
        Complex admittance at each harmonic of the drive. [S]
    voltage_amplitude : array_like, shape (..., n)
        Amplitude of each harmonic of the voltage, zero to peak. [V]

    Returns
    -------
    ndarray, shape (...)
        Zero where no current flows.

    Raises
    ------
    InvalidInput
        If a value is not finite.

    Notes
    -----
    .. math::

        \lambda = \frac{\sum_n \mathrm{Re}\, Y_n |V_n|^2}{\sqrt{\sum_n |V_n|^2 \sum_n |Y_n V_n|^2}}

    Examples
    --------
    >>> from sonolube.models.actuator import power_factor
    >>> round(float(power_factor(admittance=[3e-3 + 4e-3j], voltage_amplitude=[14.0])), 3)  # cosine of the phase
    0.6
    """
    y = np.atleast_1d(require_finite_complex(admittance=admittance))
    volts = np.atleast_1d(require_finite_complex(voltage_amplitude=voltage_amplitude))
    power = dissipated_power(admittance=y, voltage_amplitude=volts).sum(axis=-1)
    squares = (np.abs(volts) ** 2).sum(axis=-1) * (np.abs(y * volts) ** 2).sum(axis=-1)
    apparent = 0.5 * np.sqrt(squares)
    return np.asarray(np.divide(power, apparent, out=np.zeros_like(apparent), where=apparent > 0))


def peak_current(*, admittance: ArrayLike, voltage_amplitude: ArrayLike) -> Floats:
    """Greatest magnitude of the current over a period of a periodic voltage. [A]

    Parameters
    ----------
    admittance : array_like, shape (..., n)
        Complex admittance at the harmonics 1 to n of the drive. [S]
    voltage_amplitude : array_like, shape (..., n)
        Complex amplitude of the harmonics 1 to n of the voltage, zero to peak. [V]

    Returns
    -------
    ndarray, shape (...)
        A lower bound within half a percent; exact for n = 1.

    Raises
    ------
    InvalidInput
        If a value is not finite.

    Notes
    -----
    For a square or sawtooth voltage on a capacitance it grows with the number of harmonics, and is limited in practice
    by the amplifier.

    Examples
    --------
    >>> from sonolube.models.actuator import peak_current
    >>> from sonolube.text.units import format_si
    >>> format_si(float(peak_current(admittance=[3e-3 + 4e-3j], voltage_amplitude=[14.0])), "A")
    '70 mA'
    """
    y = require_finite_complex(admittance=admittance)
    current = np.atleast_1d(y * require_finite_complex(voltage_amplitude=voltage_amplitude))
    lowest, highest = extremes_over_period(current)
    return np.maximum(-lowest, highest)


def extremes_over_period(harmonics: Complexes) -> tuple[Floats, Floats]:
    """Least and greatest value over a period from the amplitudes of the harmonics 1 to n, shape (..., n)."""
    order = np.arange(1, harmonics.shape[-1] + 1)
    if order.size == 1:
        amplitude = np.abs(harmonics[..., 0])
        return -amplitude, amplitude
    phase = np.linspace(0, 2 * np.pi, _POINTS_PER_WAVE * order.size, endpoint=False)
    history = (harmonics @ np.exp(1j * np.multiply.outer(order, phase))).real
    return np.asarray(history.min(axis=-1)), np.asarray(history.max(axis=-1))
