"""Power that an amplifier has to supply to a rig: the charge of the actuator's capacitance, or the heat of the motion.

A linear amplifier charges the capacitance C from its supply, P_c = C U_max U_pp f (D 1.9), and that formula leaves the
current of the motion out; the motion turns P = Re(V I*)/2 into heat. The power to supply is the larger of the two.
Where no structure with losses gives the heat, it is P_c at least.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Final, Literal, final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Complexes, Floats
from sonolube.models.actuator.drive import harmonic_peak
from sonolube.models.dynamics import SteadyStates
from sonolube.rig.driven_rig import NO_DISSIPATED_POWER
from sonolube.text.units import format_si

POWERS: Final = ("power_to_supply", "charging_power", "dissipated_power", "apparent_power", "peak_current")
"""Power to supply, both of its parts, and the apparent power and the current beside it."""

FiguredPower = Literal["power_to_supply", "charging_power"]
"""Power of a map or a figure: to be supplied, or that of D 1.9, as the dissertation draws it."""


@final
@dataclass(frozen=True, kw_only=True, slots=True)
class PowerToSupply:
    """Power that an amplifier has to supply at an operating point, with its parts.

    Parameters
    ----------
    power_to_supply : float
        Larger of the two parts that are known. [W]
    charging_power : float or None
        Charge of the capacitance from the supply of a linear amplifier, D 1.9. [W]
    dissipated_power : float or None
        What the computed motion turns into heat in stack, dampers and contact; None where no structure gives it. [W]
    apparent_power : float or None
        Root-mean-square voltage times root-mean-square current; None where no computed motion gives the current. [W]
    peak_current : float or None
        Greatest magnitude of that current. [A]
    energy_balance : str
        How the two parts compare, and why.
    """

    power_to_supply: float
    charging_power: float | None
    dissipated_power: float | None
    apparent_power: float | None
    peak_current: float | None
    energy_balance: str

    @property
    def is_at_least(self) -> bool:
        """Whether a part is not known, so that the power to supply may be larger."""
        return self.charging_power is None or self.dissipated_power is None

    @property
    def text(self) -> str:
        """Power to supply with its unit, "at least" before it where a part is not known."""
        return power_text(self.power_to_supply, is_at_least=self.is_at_least)


def power_text(power: float, *, is_at_least: bool) -> str:
    """Power with its unit, "at least" before it where it is a lower bound."""
    text = format_si(power, "W")
    return f"at least {text}" if is_at_least else text


def larger_power(*, charging_power: ArrayLike, dissipated_power: ArrayLike) -> Floats:
    """Power to supply: the larger of its two parts, the other one where one is NaN. [W]

    Parameters
    ----------
    charging_power : array_like
        Charge of the capacitance, D 1.9; NaN where it is not known. [W]
    dissipated_power : array_like, broadcast against `charging_power`
        Heat of the motion; NaN where it is not known. [W]

    Returns
    -------
    ndarray, shape of the broadcast arguments
        NaN where neither is known.

    Examples
    --------
    >>> from math import nan
    >>> from sonolube.rig.power import larger_power
    >>> larger_power(charging_power=[6.21, 6.21, nan], dissipated_power=[43.9, nan, nan]).tolist()
    [43.9, 6.21, nan]
    """
    return np.asarray(np.fmax(charging_power, dissipated_power), dtype=np.float64)


def apparent_power(*, voltage_harmonics: Complexes, current_harmonics: Complexes) -> Floats:
    """Root-mean-square alternating voltage times root-mean-square current of harmonics, shape (..., n). [W]"""
    squares = [np.sum(np.abs(harmonics) ** 2, axis=-1) for harmonics in (voltage_harmonics, current_harmonics)]
    return np.asarray(0.5 * np.sqrt(squares[0] * squares[1]))


def electrical_load(states: SteadyStates) -> dict[str, Floats]:
    """Apparent power and peak current of steady vibrations, by name, in W and A."""
    volts, current = states.voltage_harmonics, states.current_harmonics
    return {
        "apparent_power": apparent_power(voltage_harmonics=volts, current_harmonics=current),
        "peak_current": harmonic_peak(current),
    }


def power_to_supply(
    *,
    charging_power: float | None,
    dissipated_power: float | None,
    apparent_power: float | None = None,
    peak_current: float | None = None,
) -> PowerToSupply | None:
    """Power that an amplifier has to supply, from its two parts; None where neither is known.

    Parameters
    ----------
    charging_power : float or None
        Charge of the capacitance, D 1.9; None or NaN where it is not known. [W]
    dissipated_power : float or None
        Heat of the motion; None or NaN where it is not known. [W]
    apparent_power : float or None
        None or NaN where the current is not known. [W]
    peak_current : float or None
        None or NaN where it is not known. [A]

    Returns
    -------
    PowerToSupply or None

    Examples
    --------
    >>> from sonolube.rig import power_to_supply
    >>> power_to_supply(charging_power=6.21, dissipated_power=43.9).text
    '43.9 W'
    >>> power_to_supply(charging_power=6.21, dissipated_power=None).text
    'at least 6.21 W'
    """
    charge, heat, apparent, peak = map(_known, (charging_power, dissipated_power, apparent_power, peak_current))
    known = [part for part in (charge, heat) if part is not None]
    if not known:
        return None
    return PowerToSupply(
        power_to_supply=max(known),
        charging_power=charge,
        dissipated_power=heat,
        apparent_power=apparent,
        peak_current=peak,
        energy_balance=_balance(charge, heat),
    )


def with_former_key(quantities: Mapping[str, float | None]) -> dict[str, float | None]:
    """Quantities for JSON, with the charging power also under `actuator_power`, its key before it had its own name."""
    beside = {"actuator_power": quantities["charging_power"]} if "charging_power" in quantities else {}
    return {**quantities, **beside}


def _known(value: float | None) -> float | None:
    """Value, or None where it is NaN."""
    return value if value is not None and isfinite(value) else None


def _balance(charge: float | None, heat: float | None) -> str:
    """Comparison of the two parts, and why the larger counts."""
    of_charge = (
        None
        if charge is None
        else (
            f"{format_si(charge, 'W')} charges the actuator's capacitance alone, from the supply of a linear amplifier"
            " (D 1.9)"
        )
    )
    of_heat = (
        None
        if heat is None
        else (f"{format_si(heat, 'W')} is what the computed motion turns into heat in stack, dampers and contact")
    )
    if charge is None or of_charge is None:
        return f"{of_heat}; the charge of the capacitance is not known: give actuator.capacitance"
    if heat is None or of_heat is None:
        return f"{of_charge}; {NO_DISSIPATED_POWER}"
    if heat <= charge:
        return f"{of_charge}; {of_heat}"
    why = "D 1.9 leaves the current of the motion out, so that the amplifier must supply the larger"
    return f"{of_charge}; {of_heat}: {why}"
