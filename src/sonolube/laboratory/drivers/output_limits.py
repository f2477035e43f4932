"""Limits of drive sources and motors, to which a setting is held before anything is sent."""

from dataclasses import dataclass
from typing import Final

from sonolube.laboratory.devices import WAVEFORMS, DeviceError, DriveSetting
from sonolube.text.units import format_si

_ROUNDING: Final = 1 + 1e-9


@dataclass(frozen=True, kw_only=True, slots=True)
class DriveLimits:
    """Amplifier behind an output, and what output and actuator stand.

    Parameters
    ----------
    amplifier_gain : float
        Voltage at the actuator per voltage of the output. []
    actuator_voltage : float
        Greatest magnitude at the actuator, offset included; in V.
    output_voltage : float
        Greatest magnitude that the output gives and the amplifier takes, in V.
    frequency_maximum : float
        In Hz.
    """

    amplifier_gain: float
    actuator_voltage: float
    output_voltage: float
    frequency_maximum: float

    @property
    def voltage_maximum(self) -> float:
        """Magnitude of the voltage at the actuator that can be given. [V]"""
        return min(self.actuator_voltage, self.amplifier_gain * self.output_voltage)

    def output_of(self, setting: DriveSetting, *, device: str) -> tuple[float, float]:
        """Amplitude peak to peak and offset of the output for a setting at the actuator. [V]

        Parameters
        ----------
        setting : DriveSetting
        device : str
            Name in errors.

        Returns
        -------
        tuple of float

        Raises
        ------
        DeviceError
            If the setting lies beyond a limit or its waveform is unknown.
        """
        if setting.waveform not in WAVEFORMS:
            raise DeviceError(f"{device}: no waveform {setting.waveform!r}; it gives {', '.join(WAVEFORMS)}")
        reached = setting.voltage_maximum
        if not 0 <= setting.voltage_peak_to_peak <= 2 * reached <= 2 * self.voltage_maximum * _ROUNDING:
            wanted, most = format_si(reached, "V"), format_si(self.voltage_maximum, "V")
            raise DeviceError(f"{device}: {wanted} at the actuator refused; it gives at most {most}")
        if not 0 < setting.frequency <= self.frequency_maximum * _ROUNDING:
            wanted, most = format_si(setting.frequency, "Hz"), format_si(self.frequency_maximum, "Hz")
            raise DeviceError(f"{device}: {wanted} refused; it gives frequencies up to {most}")
        return setting.voltage_peak_to_peak / self.amplifier_gain, setting.voltage_offset / self.amplifier_gain


def require_speed(*, rotation_speed: float, highest: float, device: str) -> None:
    """Raise where a motor cannot turn at a speed."""
    if not 0 <= rotation_speed <= highest * _ROUNDING:
        wanted, most = format_si(rotation_speed, "1/s"), format_si(highest, "1/s")
        raise DeviceError(f"{device}: {wanted} refused; it turns at 0 to {most}")
