"""Electrical drive of an actuator: voltage, frequency, waveform and ramp."""

from dataclasses import dataclass

from sonolube.checks import require_finite, require_non_negative, require_positive
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
