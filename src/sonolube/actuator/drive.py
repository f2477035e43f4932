"""The electrical drive of an actuator."""

from dataclasses import dataclass

from sonolube.checks import require_finite, require_non_negative, require_positive


@dataclass(frozen=True, kw_only=True, slots=True)
class Drive:
    """A periodic drive voltage.

    Parameters
    ----------
    voltage_peak_to_peak : float or None
        Difference of the highest and the lowest voltage; None where the supply does not tell. [V]
    voltage_offset : float
        Mean of the highest and the lowest voltage. [V]
    frequency : float
        Repetition frequency. [Hz]
    waveform : str
        Shape of one period, such as "sine".
    """

    frequency: float
    voltage_peak_to_peak: float | None = None
    voltage_offset: float = 0.0
    waveform: str = "sine"

    def __post_init__(self) -> None:
        if self.voltage_peak_to_peak is not None:
            require_non_negative(voltage_peak_to_peak=self.voltage_peak_to_peak)
        require_finite(voltage_offset=self.voltage_offset)
        require_positive(frequency=self.frequency)
