"""What an amplifier can give: the largest swing within its voltage, current and slew rate."""

from dataclasses import dataclass
from math import inf, pi

from sonolube.checks import require_positive


@dataclass(frozen=True, kw_only=True, slots=True)
class Amplifier:
    """Limits of an amplifier that drives a stack with a sine.

    Parameters
    ----------
    voltage_maximum : float
        Largest swing, peak to peak. [V]
    current_maximum : float
        Largest current, either way; no limit where it is infinite. [A]
    slew_rate_maximum : float
        Greatest rate of change of the voltage; no limit where it is infinite. [V/s]

    Raises
    ------
    InvalidInput
        If a limit is not positive, or the voltage not finite.
    """

    voltage_maximum: float
    current_maximum: float = inf
    slew_rate_maximum: float = inf

    def __post_init__(self) -> None:
        require_positive(voltage_maximum=self.voltage_maximum)
        if self.current_maximum != inf:
            require_positive(current_maximum=self.current_maximum)
        if self.slew_rate_maximum != inf:
            require_positive(slew_rate_maximum=self.slew_rate_maximum)


def largest_swing(amplifier: Amplifier, *, admittance: complex, frequency: float) -> float:
    """Return the largest sine, peak to peak, that an amplifier keeps up. [V]

    Parameters
    ----------
    amplifier : Amplifier
    admittance : complex
        Of what it drives. [S]
    frequency : float
        Frequency of the sine. [Hz]

    Notes
    -----
    A sine of swing U draws up to abs(Y) U/2 and changes by up to pi f U per time.
    """
    require_positive(frequency=frequency)
    by_current = 2 * amplifier.current_maximum / abs(admittance) if admittance else inf
    return min(amplifier.voltage_maximum, by_current, amplifier.slew_rate_maximum / (pi * frequency))


def limiting(amplifier: Amplifier, *, admittance: complex, frequency: float) -> str:
    """Return which limit decides: "voltage", "current" or "slew rate".

    Parameters
    ----------
    amplifier : Amplifier
    admittance : complex
        Of what it drives. [S]
    frequency : float
        Frequency of the sine. [Hz]
    """
    swing = largest_swing(amplifier, admittance=admittance, frequency=frequency)
    if swing == amplifier.voltage_maximum:
        return "voltage"
    return "slew rate" if swing == amplifier.slew_rate_maximum / (pi * frequency) else "current"
