"""Powers of a rig beside each other: what the amplifier supplies, and what the motion turns into heat."""

from math import isfinite

from sonolube.units import format_si


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
        None where one of them is not known.
    """
    known = [power for power in (actuator_power, dissipated_power) if power is not None and isfinite(power)]
    if len(known) < 2:
        return None
    supplied, dissipated = known
    capacitive, motional = format_si(supplied, "W"), format_si(dissipated, "W")
    which = (
        f"{capacitive} charges the actuator's capacitance alone, from the supply of a linear amplifier (D 1.9);"
        f" {motional} is what the computed motion turns into heat in stack, dampers and contact"
    )
    if dissipated <= supplied:
        return which
    return f"{which}: D 1.9 leaves the current of the motion out, so that the amplifier must supply the larger"
