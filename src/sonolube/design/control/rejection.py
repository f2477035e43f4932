"""Response of a friction control loop to a step of the real friction: run, largest deviation, recovery, and figure."""

from dataclasses import dataclass, replace

import numpy as np

from sonolube.charts import Axis, Chart, Line, Panel, Rule
from sonolube.checks import require_within
from sonolube.design.control.closed_loop_simulation import (
    ClosedLoopRun,
    Disturbance,
    FrictionLoop,
    simulate_closed_loop,
)
from sonolube.design.control.control_design import ControlDesign
from sonolube.errors import InvalidInput

_START = 0.5  # of the run, by which friction has reached the target
_BAND = 0.05  # of the step, within which friction counts as back at the target
_SHOWN = (-10.0, 60.0)  # effective dead times about the step, drawn


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class DisturbanceRejection:
    """Closed loop at its target under a step of the real friction.

    Parameters
    ----------
    run : ClosedLoopRun
    friction_step : float
        Relative change of the real friction. []
    start_time : float
        Time of the step. [s]
    peak_deviation : float
        Largest distance of the friction force from the target after the step. [N]
    recovery_time : float or None
        Time from the step until friction stays within 5 % of the step about the target; None where it does not. [s]
    """

    run: ClosedLoopRun
    friction_step: float
    start_time: float
    peak_deviation: float
    recovery_time: float | None


def disturbance_rejection(
    loop: FrictionLoop, *, friction_force: float, friction_step: float, duration: float, friction_factor: float = 1.0
) -> DisturbanceRejection:
    """Response of a loop at its target to a step of the real friction, without noise and warming.

    Parameters
    ----------
    loop : FrictionLoop
    friction_force : float
        Target. [N]
    friction_step : float
        Relative change of the real friction. []
    duration : float
        Simulated time, of which the second half follows the step. [s]
    friction_factor : float
        Real friction over that of the model before the step. []

    Returns
    -------
    DisturbanceRejection

    Raises
    ------
    InvalidInput
        If the step is zero, or not between -90 and 900 %.

    See Also
    --------
    design_control, step_response_metrics
    """
    if not float(require_within(-0.9, 9.0, friction_step=friction_step)):
        raise InvalidInput("friction_step must not be zero")
    interval = loop.controller.process.sample_interval
    samples = round(duration / interval)
    start = round(_START * samples)
    run = simulate_closed_loop(
        loop,
        setpoint=np.full(samples, friction_force),
        disturbance=Disturbance(
            friction_factor=friction_factor, later_factor=1 + friction_step, start_time=(start - 0.5) * interval
        ),
    )
    deviation = np.abs(run.friction_force[start:] - friction_force)
    outside = np.flatnonzero(deviation > _BAND * abs(friction_step) * friction_force)
    back = int(outside[-1]) + 1 if outside.size else 0
    return DisturbanceRejection(
        run=run,
        friction_step=friction_step,
        start_time=start * interval,
        peak_deviation=float(deviation.max()),
        recovery_time=back * interval if back < deviation.size else None,
    )


def rejection_chart(study: ControlDesign, rejection: DisturbanceRejection) -> Chart:
    """Friction force and drive voltage, or commanded amplitude, over the time from the step of the real friction."""
    run, quantity = rejection.run, study.plant.quantity
    ms = 1e3 * (run.time - rejection.start_time)
    first, last = (1e3 * each * study.controller.process.effective_dead_time for each in _SHOWN)
    shown = (ms >= first) & (ms <= last)
    time = Axis("Time from the step", "ms", lowest=max(first, ms[0]), highest=min(last, ms[-1]))
    target = np.full(int(shown.sum()), study.friction_force)
    friction = (
        Line(x=ms[shown], y=run.friction_force[shown], label="friction"),
        Line(x=ms[shown], y=target, label="target", colour=6, dash=3),
    )
    highest = quantity.axis_scale * study.level_maximum
    drive = (
        Line(x=ms[shown], y=quantity.axis_scale * run.level[shown]),
        Rule(value=highest, along="y", label=f"{study.limit} limit", colour="0.5", dash=2),
    )
    return Chart(
        panels=(
            Panel(x=time, y=Axis("Friction force", "N"), parts=friction),
            Panel(x=time, y=replace(quantity.axis, lowest=0.0, highest=1.12 * highest), parts=drive),
        ),
        size=(5.6, 3.6),
        heights=(1.6, 1.0),
        shares_x=True,
    )
