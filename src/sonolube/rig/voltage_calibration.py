"""Calibration of a drive by one measurement: a voltage, peak to peak, and the vibration amplitude that it gives."""

import re
from dataclasses import dataclass
from typing import Final

from sonolube.checks import require_positive
from sonolube.errors import InvalidInput
from sonolube.text.units import format_si, to_si

_PEAK_TO_PEAK: Final = re.compile(r"(?<=[Vm\s])\s*(?:pp|p-p|ss)\s*\Z", re.IGNORECASE)
_EXAMPLE: Final = "'25 V = 2 um', a voltage peak to peak and the amplitude zero to peak"


@dataclass(frozen=True, kw_only=True, slots=True)
class VoltageCalibration:
    """One measured pair of voltage and amplitude, between which and zero the drive is taken as linear.

    Parameters
    ----------
    voltage_peak_to_peak : float
        [V]
    vibration_amplitude : float
        Zero to peak. [m]
    """

    voltage_peak_to_peak: float
    vibration_amplitude: float

    def __post_init__(self) -> None:
        require_positive(voltage_peak_to_peak=self.voltage_peak_to_peak, vibration_amplitude=self.vibration_amplitude)

    @property
    def amplitude_per_volt(self) -> float:
        """Amplitude over voltage. [m/V]"""
        return self.vibration_amplitude / self.voltage_peak_to_peak

    @property
    def text(self) -> str:
        """As `voltage_calibration` reads it."""
        volts, amplitude = format_si(self.voltage_peak_to_peak, "V"), format_si(self.vibration_amplitude, "m")
        return f"{volts} = {amplitude}"


def voltage_calibration(text: str, *, name: str = "calibration") -> VoltageCalibration:
    """Calibration of a text such as "25 V = 2 um"; "pp" behind the amplitude halves it.

    Raises
    ------
    InvalidInput
        If the text is no pair of a voltage and a length, or one of them is not positive.

    Examples
    --------
    >>> from sonolube.rig.voltage_calibration import voltage_calibration
    >>> f"{voltage_calibration('25 V = 2 um').amplitude_per_volt:.3g}"
    '8e-08'
    """
    left, equals, right = text.partition("=")
    if not equals:
        raise InvalidInput(f"{name} {text[:60]!r} must be such as {_EXAMPLE}")
    volts = to_si(_PEAK_TO_PEAK.sub("", left).strip(), unit="V", name=name)
    amplitude = to_si(_PEAK_TO_PEAK.sub("", right).strip(), unit="m", name=name)
    halved = 0.5 if _PEAK_TO_PEAK.search(right.rstrip()) else 1.0
    return VoltageCalibration(voltage_peak_to_peak=volts, vibration_amplitude=halved * amplitude)
