"""Closed-loop performance: rise time, settling time, overshoot and tracking error of a step, and energy of a run."""

from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats, require_non_negative, require_within
from sonolube.design.control.closed_loop_simulation import ClosedLoopRun
from sonolube.errors import InvalidInput
from sonolube.rig import Rig, level_settings
from sonolube.rig.driven_rig import DriveVoltage, require_drive

_FINAL_FRACTION = 5  # the tracking error is that of the last fifth


@dataclass(frozen=True, kw_only=True, slots=True)
class StepResponseMetrics:
    """Metrics of the response of the friction force to a step of its set-point.

    Parameters
    ----------
    rise_time : float or None
        Time from 10 to 90 % of the step; None where that is not reached. [s]
    settling_time : float or None
        Time from the step until the friction force stays within a band about the set-point; None where it does not. [s]
    overshoot : float
        Largest excess beyond the set-point over the step. []
    tracking_error : float
        Root-mean-square difference of friction force and set-point over the last fifth. [N]
    """

    rise_time: float | None
    settling_time: float | None
    overshoot: float
    tracking_error: float


@dataclass(frozen=True, kw_only=True, slots=True)
class ControlEnergy:
    """Energies of a closed-loop run.

    Parameters
    ----------
    amplifier_energy : float or None
        Energy supplied by a linear amplifier (D 1.9); None without a capacitance or a voltage. [J]
    electrical_energy : float or None
        Energy supplied to the motional branch; None of a commanded amplitude. [J]
    saved_work : float
        Reduction of the friction work at the rig's sliding speed, against friction without vibration. [J]
    """

    amplifier_energy: float | None
    electrical_energy: float | None
    saved_work: float


def step_response_metrics(run: ClosedLoopRun, *, start_time: float, band: float = 0.05) -> StepResponseMetrics:
    """Rise time, settling time, overshoot and tracking error of a step, up to the next step or the end.

    Parameters
    ----------
    run : ClosedLoopRun
    start_time : float
        Time of the step of the set-point. [s]
    band : float
        Half-width of the settling band, over the step.

    Returns
    -------
    StepResponseMetrics

    Raises
    ------
    InvalidInput
        If the set-point has no step at that time.

    See Also
    --------
    simulate_closed_loop, control_energy
    """
    half_width = float(require_within(0.0, 1.0, band=band))
    start = int(np.searchsorted(run.time, float(require_non_negative(start_time=start_time)) - 1e-12))
    if not 0 < start < run.time.size or run.setpoint[start] == run.setpoint[start - 1]:
        raise InvalidInput(f"start_time {start_time:g} s: the set-point has no step there; give the time of one")
    later_steps = np.flatnonzero(np.diff(run.setpoint[start:]))
    end = start + int(later_steps[0]) + 1 if later_steps.size else run.time.size
    step = run.setpoint[start] - run.setpoint[start - 1]
    time = run.time[start:end] - run.time[start]
    response = (run.friction_force[start:end] - run.setpoint[start - 1]) / step
    outside = np.flatnonzero(np.abs(response - 1) > half_width)
    settled = int(outside[-1]) + 1 if outside.size else 0
    error = run.friction_force[start:end] - run.setpoint[start:end]
    return StepResponseMetrics(
        rise_time=_time_between(time, response, 0.1, 0.9),
        settling_time=float(time[settled]) if settled < time.size else None,
        overshoot=max(float(response.max()) - 1, 0.0),
        tracking_error=float(np.sqrt(np.mean(error[-max(error.size // _FINAL_FRACTION, 1) :] ** 2))),
    )


def control_energy(rig: Rig, run: ClosedLoopRun) -> ControlEnergy:
    """Energy of amplifier and vibration, and reduction of the friction work, over a closed-loop run.

    Parameters
    ----------
    rig : Rig
        The offset of its voltage, where it has one, is scaled in its own ratio.
    run : ClosedLoopRun

    Returns
    -------
    ControlEnergy

    See Also
    --------
    step_response_metrics
    """
    interval = float(run.time[1] - run.time[0]) if run.time.size > 1 else 0.0
    amplifier_energy = None
    if rig.capacitance is not None and run.electrical_energy is not None:
        power = DriveVoltage(drive=require_drive(rig)).charging_power(
            capacitance=rig.capacitance, frequency=run.frequency, **level_settings(rig, run.level)
        )
        amplifier_energy = float(power.sum() * interval)
    reduction = rig.friction_coefficient * rig.normal_load - run.friction_force
    return ControlEnergy(
        amplifier_energy=amplifier_energy,
        electrical_energy=None if run.electrical_energy is None else float(run.electrical_energy[-1]),
        saved_work=float(reduction.sum() * interval * rig.sliding_speed),
    )


def _time_between(time: Floats, response: Floats, low: float, high: float) -> float | None:
    """Time between the first crossings of two levels; None where one is not reached."""
    if not (np.any(response >= low) and np.any(response >= high)):
        return None
    return float(_first_crossing(time, response, high) - _first_crossing(time, response, low))


def _first_crossing(time: Floats, response: Floats, level: float) -> float:
    """Time at which a response first reaches a level, by linear interpolation."""
    i = int(np.argmax(response >= level))
    if i == 0:
        return float(time[0])
    return float(np.interp(level, response[i - 1 : i + 1], time[i - 1 : i + 1]))
