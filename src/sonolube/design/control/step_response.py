"""What a closed loop achieved: how fast and true it follows a step, and what energy that took."""

from dataclasses import dataclass

import numpy as np

from sonolube.checks import Floats, require_non_negative, require_within
from sonolube.design.control.closed_loop import ControlRun
from sonolube.errors import InvalidInput
from sonolube.rig import Rig
from sonolube.rig.driven_rig import require_drive
from sonolube.rig.excitation import amplifier_power


@dataclass(frozen=True, kw_only=True, slots=True)
class StepResponse:
    """How friction follows a step of its reference.

    Parameters
    ----------
    rise_time : float or None
        From a tenth to nine tenths of the step; None where it does not get there. [s]
    settling_time : float or None
        From the step until friction stays within a band about the new reference; None where it does not. [s]
    overshoot : float
        Farthest beyond the new reference, over the step. []
    tracking_error : float
        Root mean square of friction less reference over the last fifth. [N]
    """

    rise_time: float | None
    settling_time: float | None
    overshoot: float
    tracking_error: float


@dataclass(frozen=True, kw_only=True, slots=True)
class ControlEnergy:
    """Energy of a run.

    Parameters
    ----------
    amplifier_energy : float or None
        Supplied by a linear amplifier, D 1.9; None where the capacitance is not known. [J]
    electrical_energy : float
        Taken by the motion from the drive. [J]
    saved_work : float
        Work of friction saved at the rig's sliding speed, against none of the vibration. [J]
    """

    amplifier_energy: float | None
    electrical_energy: float
    saved_work: float


def step_response(run: ControlRun, *, start_time: float, band: float = 0.05) -> StepResponse:
    """Return how friction follows the step of the reference at a time, to the next step or the end.

    Parameters
    ----------
    run : ControlRun
    start_time : float
        When the reference steps. [s]
    band : float
        Half width of the band of settling, over the step.

    Returns
    -------
    StepResponse

    Raises
    ------
    InvalidInput
        If the reference does not step there.
    """
    half_width = float(require_within(0.0, 1.0, band=band))
    start = int(np.searchsorted(run.time, float(require_non_negative(start_time=start_time)) - 1e-12))
    if not 0 < start < run.time.size or run.reference[start] == run.reference[start - 1]:
        raise InvalidInput(f"start_time {start_time:g} s: the reference does not step there")
    later = np.flatnonzero(np.diff(run.reference[start:]))
    end = start + int(later[0]) + 1 if later.size else run.time.size
    step = run.reference[start] - run.reference[start - 1]
    time = run.time[start:end] - run.time[start]
    done = (run.friction_force[start:end] - run.reference[start - 1]) / step
    outside = np.flatnonzero(np.abs(done - 1) > half_width)
    settled = int(outside[-1]) + 1 if outside.size else 0
    deviation = run.friction_force[start:end] - run.reference[start:end]
    return StepResponse(
        rise_time=_time_between(time, done, 0.1, 0.9),
        settling_time=float(time[settled]) if settled < time.size else None,
        overshoot=max(float(done.max()) - 1, 0.0),
        tracking_error=float(np.sqrt(np.mean(deviation[-max(deviation.size // 5, 1) :] ** 2))),
    )


def control_energy(rig: Rig, run: ControlRun) -> ControlEnergy:
    """Return the energies of a run.

    Parameters
    ----------
    rig : Rig
        With a drive voltage, whose offset goes with the swing in its own proportion.
    run : ControlRun

    Returns
    -------
    ControlEnergy
    """
    drive = require_drive(rig)
    interval = float(run.time[1] - run.time[0]) if run.time.size > 1 else 0.0
    supplied = None
    if rig.capacitance is not None:
        power = amplifier_power(
            drive,
            capacitance=rig.capacitance,
            voltage_peak_to_peak=run.voltage_peak_to_peak,
            voltage_offset=drive.offset_ratio * run.voltage_peak_to_peak,
            frequency=run.frequency,
        )
        supplied = float(power.sum() * interval)
    saved = rig.friction_coefficient * rig.normal_load - run.friction_force
    return ControlEnergy(
        amplifier_energy=supplied,
        electrical_energy=float(run.electrical_energy[-1]),
        saved_work=float(saved.sum() * interval * rig.sliding_speed),
    )


def _time_between(time: Floats, done: Floats, low: float, high: float) -> float | None:
    if not (np.any(done >= low) and np.any(done >= high)):
        return None
    return float(_first_crossing(time, done, high) - _first_crossing(time, done, low))


def _first_crossing(time: Floats, done: Floats, level: float) -> float:
    i = int(np.argmax(done >= level))
    if i == 0:
        return float(time[0])
    return float(np.interp(level, done[i - 1 : i + 1], time[i - 1 : i + 1]))
