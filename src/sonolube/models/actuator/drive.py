"""Electrical drive of an actuator: its voltage, the power and current that it takes, and the amplifier it needs."""

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
)
from sonolube.errors import InvalidInput


@dataclass(frozen=True, kw_only=True, slots=True)
class Drive:
    """Periodic drive voltage and its ramp at switch-on.

    Parameters
    ----------
    voltage_peak_to_peak : float or None
        Difference of the highest and the lowest voltage; None where it is unknown. [V]
    voltage_offset : float
        Mean voltage. [V]
    frequency : float
        Repetition frequency. [Hz]
    waveform : str
        Shape of one period, such as "sine"; "sampled" for that of `waveform_samples`.
    waveform_samples : sequence of float or None
        Equally spaced samples of one period in any unit; offset and scale are irrelevant.
    ramp_duration : float
        Time over which voltage and offset rise from zero; zero for a step. [s]
    ramp_shape : str
        Shape of the rise, such as "linear".

    Raises
    ------
    InvalidInput
        If a value is not finite, a peak-to-peak voltage or duration negative, the frequency not positive, or samples
        are given for a waveform other than "sampled", or missing for that one.
    """

    frequency: float
    voltage_peak_to_peak: float | None = None
    voltage_offset: float = 0.0
    waveform: str = "sine"
    waveform_samples: tuple[float, ...] | None = None
    ramp_duration: float = 0.0
    ramp_shape: str = "linear"

    def __post_init__(self) -> None:
        if self.voltage_peak_to_peak is not None:
            require_non_negative(voltage_peak_to_peak=self.voltage_peak_to_peak)
        require_finite(voltage_offset=self.voltage_offset)
        require_positive(frequency=self.frequency)
        require_non_negative(ramp_duration=self.ramp_duration)
        if (self.waveform == "sampled") != (self.waveform_samples is not None):
            raise InvalidInput('waveform "sampled" and waveform_samples belong together: give both or neither')
        if self.waveform_samples is not None:
            object.__setattr__(self, "waveform_samples", tuple(self.waveform_samples))

    @property
    def offset_ratio(self) -> float:
        """Mean voltage over peak-to-peak voltage, which stays when the voltage is varied; 0 without a voltage. []"""
        return self.voltage_offset / self.voltage_peak_to_peak if self.voltage_peak_to_peak else 0.0


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
    return harmonic_peak(np.atleast_1d(y * require_finite_complex(voltage_amplitude=voltage_amplitude)))


def harmonic_peak(harmonics: Complexes) -> Floats:
    """Greatest magnitude over a period from the amplitudes of the harmonics 1 to n, shape (..., n)."""
    lowest, highest = _extremes_over_period(harmonics)
    return np.maximum(-lowest, highest)


def _extremes_over_period(harmonics: Complexes) -> tuple[Floats, Floats]:
    """Least and greatest value over a period from the amplitudes of the harmonics 1 to n, shape (..., n)."""
    order = np.arange(1, harmonics.shape[-1] + 1)
    if order.size == 1:
        amplitude = np.abs(harmonics[..., 0])
        return -amplitude, amplitude
    phase = np.linspace(0, 2 * np.pi, _POINTS_PER_WAVE * order.size, endpoint=False)
    history = (harmonics @ np.exp(1j * np.multiply.outer(order, phase))).real
    return np.asarray(history.min(axis=-1)), np.asarray(history.max(axis=-1))


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
    lowest, highest = _extremes_over_period(volts)
    falling, rising = _extremes_over_period(2j * np.pi * f * np.arange(1, volts.size + 1) * volts)
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
