"""Friction to be held by a controller that was designed for a rig, with its limits."""

from math import ceil

from sonolube.design.control import ControlDesign, ControlSettings
from sonolube.facts.protocol import Limits, exact_text
from sonolube.laboratory.closed_loop.record import FrictionHold, SpeedStep
from sonolube.models.actuator.drive import Drive

_SAMPLE_RATE = 2000.0  # Hz, at least
_HEADROOM = 1.1  # of the limit of the measured voltage, for noise, over the voltage that may be commanded


def planned_hold(
    drive: Drive,
    design: ControlDesign,
    *,
    speeds: tuple[SpeedStep, ...],
    settings: ControlSettings,
    run_in: float,
    temperature: float | None,
    force: float | None,
) -> FrictionHold:
    """Friction to be held by a controller, with the limits that end the test.

    Parameters
    ----------
    drive : Drive
    design : ControlDesign
    speeds : tuple of SpeedStep
    settings : ControlSettings
        Of the design.
    run_in : float
        Time of sliding before the controller takes over, in s.
    temperature : float or None
        Limit of the temperature. [K]
    force : float or None
        Limit of the friction force, in N.

    Returns
    -------
    FrictionHold
    """
    swing = drive.voltage_peak_to_peak or 0.0
    ratio = drive.voltage_offset / swing if swing else 0.0
    highest = _HEADROOM * (abs(ratio) + 0.5) * design.controller.level_maximum
    rate = 1 / settings.sample_interval
    return FrictionHold(
        controller=design.controller,
        friction_force=design.friction_force,
        frequency=drive.frequency,
        speeds=speeds,
        duration=settings.duration,
        limits=_limits(highest, lasts=run_in + settings.duration, temperature=temperature, force=force),
        run_in=run_in,
        offset_ratio=ratio,
        sample_rate=rate * ceil(_SAMPLE_RATE / rate),
    )


def _limits(voltage: float, *, lasts: float, temperature: float | None, force: float | None) -> Limits:
    """Limits that end the test."""
    content = {"voltage_maximum": exact_text(voltage, unit="V"), "duration_maximum": exact_text(lasts, unit="s")}
    if temperature is not None:
        content["temperature_maximum"] = exact_text(temperature, unit="K")
    if force is not None:
        content["friction_force_maximum"] = exact_text(force, unit="N")
    return Limits.model_validate(content)
