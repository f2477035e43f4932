"""Electrical power and current that a capacitive actuator draws from its amplifier."""

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_finite_complex, require_non_negative, require_positive

_POINTS_PER_WAVE = 32  # peaks between points are missed by at most 1 - cos(pi/32), half a percent


def linear_amplifier_power(
    *, capacitance: ArrayLike, voltage_maximum: ArrayLike, voltage_peak_to_peak: ArrayLike, frequency: ArrayLike
) -> Floats:
    """Return the mean power a linear amplifier takes from its supply to drive a capacitance. [W]

    Parameters
    ----------
    capacitance : array_like
        Capacitance of the actuator. [F]
    voltage_maximum : array_like
        Highest voltage that the drive reaches, the offset included. [V]
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
    The charge C U_pp, drawn f times a second from a supply at U_max and returned to ground. The actuator gives this
    reactive power back and the amplifier turns it to heat; what the actuator itself dissipates is half the real part of
    voltage times conjugate current.

    References
    ----------
    .. [1] D 1.9.
    """
    C, f = require_positive(capacitance=capacitance), require_positive(frequency=frequency)  # noqa: N806
    U_max = require_non_negative(voltage_maximum=voltage_maximum)  # noqa: N806
    U_pp = require_non_negative(voltage_peak_to_peak=voltage_peak_to_peak)  # noqa: N806
    return C * U_max * U_pp * f  # D 1.9


def dissipated_power(*, admittance: ArrayLike, voltage_amplitude: ArrayLike) -> Floats:
    """Return the mean power that the actuator and what it drives turn to heat or pass on. [W]

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
    Re(V I*)/2. The powers of the harmonics of a periodic drive add.
    """
    y = require_finite_complex(admittance=admittance)
    volts = require_finite_complex(voltage_amplitude=voltage_amplitude)
    return np.asarray(0.5 * y.real * np.abs(volts) ** 2, dtype=np.float64)


def power_factor(*, admittance: ArrayLike, voltage_amplitude: ArrayLike) -> Floats:
    """Return dissipated power over the product of effective voltage and current. []

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
    """
    y = np.atleast_1d(require_finite_complex(admittance=admittance))
    volts = np.atleast_1d(require_finite_complex(voltage_amplitude=voltage_amplitude))
    power = dissipated_power(admittance=y, voltage_amplitude=volts).sum(axis=-1)
    squares = (np.abs(volts) ** 2).sum(axis=-1) * (np.abs(y * volts) ** 2).sum(axis=-1)
    apparent = 0.5 * np.sqrt(squares)
    return np.asarray(np.divide(power, apparent, out=np.zeros_like(apparent), where=apparent > 0))


def peak_current(*, admittance: ArrayLike, voltage_amplitude: ArrayLike) -> Floats:
    """Return the highest current that the amplifier has to deliver, either way. [A]

    Parameters
    ----------
    admittance : array_like, shape (..., n)
        Complex admittance at the harmonics 1 to n of the drive. [S]
    voltage_amplitude : array_like, shape (..., n)
        Complex amplitude of the harmonics 1 to n of the voltage, zero to peak. [V]

    Returns
    -------
    ndarray, shape (...)
        From below within half a percent; exact for n = 1.

    Raises
    ------
    InvalidInput
        If a value is not finite.

    Notes
    -----
    A square or sawtooth voltage asks a capacitance for a current that grows with every harmonic counted: there the
    amplifier's own limits decide.
    """
    y = require_finite_complex(admittance=admittance)
    current = np.atleast_1d(y * require_finite_complex(voltage_amplitude=voltage_amplitude))
    harmonics = np.arange(1, current.shape[-1] + 1)
    if harmonics.size == 1:
        return np.asarray(np.abs(current[..., 0]))
    phase = np.linspace(0, 2 * np.pi, _POINTS_PER_WAVE * harmonics.size, endpoint=False)
    history = (current @ np.exp(1j * np.multiply.outer(harmonics, phase))).real
    return np.asarray(np.abs(history).max(axis=-1))
