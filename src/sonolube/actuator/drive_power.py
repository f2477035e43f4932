"""Electrical power that a capacitive actuator draws from its amplifier."""

from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive


def driver_power(
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
