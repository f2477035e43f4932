"""Drive voltage of a rig: waveform, start-up ramp, harmonics, extremes, amplifier power and its balance."""

from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, Floats, require_non_negative
from sonolube.models.actuator.drive import Drive
from sonolube.models.actuator.drive_power import linear_amplifier_power
from sonolube.models.dynamics import WAVEFORMS, Sine, StartUpRamp, Waveform
from sonolube.models.dynamics.waveform import fourier_coefficients, sampled_waveform, waveform_extremes
from sonolube.rig.driven_rig import DrivenRig
from sonolube.rig.record import Rig
from sonolube.units import format_si

_VOLTAGE_HARMONICS = 64  # the 65th of a square wave moves the tip by less than 1e-5 of the first

NO_DISSIPATED_POWER = (
    "no dissipated power: the vibration is a sine of a stated amplitude, which no structure with losses gives; take the"
    " amplitude computed, from the tables stack and structure"
)
"""Reason for which a stated vibration has no dissipated power, and advice."""


def waveform_of(drive: Drive) -> Waveform:
    """Return the shape of the drive voltage.

    Raises
    ------
    InvalidInput
        If samples are fewer than two, all equal or not finite.
    """
    return WAVEFORMS[drive.waveform] if drive.waveform_samples is None else sampled_waveform(drive.waveform_samples)


def drive_and_load(rig: DrivenRig) -> dict[str, Any]:
    """Return the arguments, by name, with which a structure in contact is marched in time under a rig's drive and load.

    Parameters
    ----------
    rig : DrivenRig

    Returns
    -------
    dict

    Raises
    ------
    UnknownName
        If the shape of the start-up ramp is unknown.
    """
    drive = rig.drive
    return {
        "normal_load": rig.normal_load,
        "frequency": drive.frequency,
        "voltage_peak_to_peak": rig.voltage_peak_to_peak,
        "voltage_offset": drive.voltage_offset,
        "waveform": waveform_of(drive),
        "ramp": StartUpRamp(duration=drive.ramp_duration, shape=drive.ramp_shape),
    }


def voltage_harmonics(drive: Drive, *, voltage_peak_to_peak: ArrayLike | None = None) -> Complexes:
    """Return the harmonics of drives of one waveform, V = offset + Re sum V_k exp(2 pi i k f t), in V.

    Parameters
    ----------
    drive : Drive
    voltage_peak_to_peak : array_like, optional
        Peak-to-peak voltages instead of the drive's own. [V]

    Returns
    -------
    ndarray of complex, shape of `voltage_peak_to_peak` with the harmonics appended
    """
    waveform = waveform_of(drive)
    count = 1 if isinstance(waveform, Sine) else _VOLTAGE_HARMONICS
    return 2 * _swing(drive, voltage_peak_to_peak)[..., np.newaxis] * fourier_coefficients(waveform, count)[1:]


def voltage_range(
    drive: Drive, *, voltage_peak_to_peak: ArrayLike | None = None, voltage_offset: ArrayLike | None = None
) -> tuple[Floats, Floats]:
    """Return the lowest and the highest voltage of drives of one waveform, in V.

    Parameters
    ----------
    drive : Drive
    voltage_peak_to_peak : array_like, optional
        Peak-to-peak voltages instead of the drive's own. [V]
    voltage_offset : array_like, optional
        Mean voltages instead of the drive's own. [V]

    Returns
    -------
    pair of ndarray
    """
    offset = np.asarray(drive.voltage_offset if voltage_offset is None else voltage_offset, dtype=np.float64)
    swing, (lowest, highest) = _swing(drive, voltage_peak_to_peak), waveform_extremes(waveform_of(drive))
    return offset + swing * lowest, offset + swing * highest


def actuator_capacitance(rig: Rig) -> float | None:
    """Return the capacitance that an amplifier drives: that of the stack, else of the actuator. [F]"""
    return rig.capacitance if rig.stack is None else rig.stack.free_capacitance


def amplifier_power(
    drive: Drive,
    *,
    capacitance: float,
    voltage_peak_to_peak: ArrayLike | None = None,
    voltage_offset: ArrayLike | None = None,
    frequency: ArrayLike | None = None,
) -> Floats:
    """Return the power that a linear amplifier supplies, its rail at the drive's highest voltage. [W]

    Parameters
    ----------
    drive : Drive
    capacitance : float
        Capacitance of the actuator. [F]
    voltage_peak_to_peak : array_like, optional
        Peak-to-peak voltages instead of the drive's own. [V]
    voltage_offset : array_like, optional
        Mean voltages instead of the drive's own. [V]
    frequency : array_like, optional
        Frequencies instead of the drive's own. [Hz]

    Returns
    -------
    ndarray, shape of the broadcast arguments

    References
    ----------
    .. [1] D 1.9.
    """
    lowest, highest = voltage_range(drive, voltage_peak_to_peak=voltage_peak_to_peak, voltage_offset=voltage_offset)
    return linear_amplifier_power(
        capacitance=capacitance,
        voltage_maximum=np.maximum(np.abs(lowest), np.abs(highest)),
        voltage_peak_to_peak=_swing(drive, voltage_peak_to_peak),
        frequency=drive.frequency if frequency is None else frequency,
    )


def energy_balance(*, actuator_power: float | None, dissipated_power: float | None) -> str | None:
    """Return how the power of the amplifier and the dissipated power compare, and why, in one line.

    Parameters
    ----------
    actuator_power : float or None
        That a linear amplifier supplies, D 1.9; None or NaN where it is not known. [W]
    dissipated_power : float or None
        That the computed motion turns into heat; None or NaN where no structure gives it. [W]

    Returns
    -------
    str or None
        None where only the dissipated power is known.
    """
    if dissipated_power is None or not isfinite(dissipated_power):
        return NO_DISSIPATED_POWER
    if actuator_power is None or not isfinite(actuator_power):
        return None
    supplied, dissipated = actuator_power, dissipated_power
    capacitive, motional = format_si(supplied, "W"), format_si(dissipated, "W")
    which = (
        f"{capacitive} charges the actuator's capacitance alone, from the supply of a linear amplifier (D 1.9);"
        f" {motional} is what the computed motion turns into heat in stack, dampers and contact"
    )
    if dissipated <= supplied:
        return which
    return f"{which}: D 1.9 leaves the current of the motion out, so that the amplifier must supply the larger"


def _swing(drive: Drive, voltage_peak_to_peak: ArrayLike | None) -> Floats:
    return require_non_negative(
        voltage_peak_to_peak=drive.voltage_peak_to_peak or 0.0 if voltage_peak_to_peak is None else voltage_peak_to_peak
    )
