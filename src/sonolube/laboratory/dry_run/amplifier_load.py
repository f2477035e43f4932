"""Load that a drive setting puts on an amplifier: current, slew rate, power and heat of a capacitive actuator."""

from dataclasses import dataclass

from sonolube.checks import require_positive
from sonolube.facts.protocol import SetPoint
from sonolube.laboratory.heating_assumptions import capacitive_load
from sonolube.models.actuator import linear_amplifier_power


@dataclass(frozen=True, kw_only=True, slots=True)
class DriveLoad:
    """Electrical load of a drive setting on an actuator taken as a capacitance.

    Parameters
    ----------
    peak_current : float
        Greatest magnitude of the current. [A]
    slew_rate : float
        Greatest rate of change of the voltage. [V/s]
    actuator_power : float
        Power a linear amplifier draws for it, D 1.9. [W]
    capacitive_power : float
        Root-mean-square alternating voltage times root-mean-square current, in W.
    """

    peak_current: float
    slew_rate: float
    actuator_power: float
    capacitive_power: float


OFF = DriveLoad(peak_current=0.0, slew_rate=0.0, actuator_power=0.0, capacitive_power=0.0)
"""Load of a drive that is off."""


def drive_load(point: SetPoint, *, capacitance: float) -> DriveLoad:
    r"""Load of a set point on the amplifier.

    Parameters
    ----------
    point : SetPoint
    capacitance : float
        Capacitance of the actuator. [F]

    Returns
    -------
    DriveLoad

    Raises
    ------
    InvalidInput
        If the capacitance is not positive.

    Notes
    -----
    A sine of the peak-to-peak voltage :math:`U` on the capacitance :math:`C` has the current amplitude and the steepest
    slope

    .. math:: \hat I = \pi f C U, \qquad \dot U_{max} = \pi f U

    Other waveforms are summed over 64 harmonics: the current of a square or sawtooth is limited by the amplifier alone,
    and that of a triangle comes out 18 % too high, by the overshoot of a truncated series.
    The current of the motion, largest at resonance, comes on top.
    """
    require_positive(capacitance=capacitance)
    if point.frequency is None or point.voltage_peak_to_peak == 0:
        return OFF
    need = capacitive_load(
        capacitance=capacitance,
        frequency=point.frequency,
        voltage_peak_to_peak=point.voltage_peak_to_peak,
        waveform=point.waveform,
    )
    power = linear_amplifier_power(
        capacitance=capacitance,
        voltage_maximum=point.voltage_maximum,
        voltage_peak_to_peak=point.voltage_peak_to_peak,
        frequency=point.frequency,
    )
    return DriveLoad(
        peak_current=need.peak_current,
        slew_rate=need.slew_rate,
        actuator_power=float(power),
        capacitive_power=need.apparent_power,
    )
