"""Amplifier limits of a sinusoidal drive: the largest peak-to-peak voltage within voltage, current and slew rate."""

from dataclasses import asdict, dataclass
from math import inf, pi

from sonolube.checks import require_positive


@dataclass(frozen=True, kw_only=True, slots=True)
class Amplifier:
    """Limits of an amplifier that drives a stack with a sine.

    Parameters
    ----------
    voltage_maximum : float
        Largest peak-to-peak voltage (swing). [V]
    current_maximum : float
        Largest absolute current; infinite for no limit. [A]
    slew_rate_maximum : float
        Slew rate; infinite for no limit. [V/s]

    Raises
    ------
    InvalidInput
        If a limit is not positive, or the voltage not finite.
    """

    voltage_maximum: float
    current_maximum: float = inf
    slew_rate_maximum: float = inf

    def __post_init__(self) -> None:
        limits = {name: limit for name, limit in asdict(self).items() if name == "voltage_maximum" or limit != inf}
        require_positive(**limits)


def swing_limit(amplifier: Amplifier, *, admittance: complex, frequency: float) -> float:
    r"""Largest peak-to-peak voltage of a sine within the limits of an amplifier. [V]

    Parameters
    ----------
    amplifier : Amplifier
    admittance : complex
        Admittance of the load. [S]
    frequency : float
        Frequency of the sine. [Hz]

    Returns
    -------
    float

    See Also
    --------
    active_limit

    Notes
    -----
    A sine of the peak-to-peak voltage :math:`U` has the current amplitude :math:`|Y| U/2` and the largest slope
    :math:`\pi f U`, so that

    .. math:: U \le \min\Bigl(U_{max},\ \frac{2 I_{max}}{|Y|},\ \frac{S_{max}}{\pi f}\Bigr)
    """
    require_positive(frequency=frequency)
    by_current = 2 * amplifier.current_maximum / abs(admittance) if admittance else inf
    return min(amplifier.voltage_maximum, by_current, amplifier.slew_rate_maximum / (pi * frequency))


def active_limit(amplifier: Amplifier, *, admittance: complex, frequency: float) -> str:
    """Name of the limit that determines `swing_limit`: "voltage", "current" or "slew rate".

    Parameters
    ----------
    amplifier : Amplifier
    admittance : complex
        Admittance of the load. [S]
    frequency : float
        Frequency of the sine. [Hz]

    Returns
    -------
    str

    See Also
    --------
    swing_limit
    """
    swing = swing_limit(amplifier, admittance=admittance, frequency=frequency)
    if swing == amplifier.voltage_maximum:
        return "voltage"
    return "slew rate" if swing == amplifier.slew_rate_maximum / (pi * frequency) else "current"
