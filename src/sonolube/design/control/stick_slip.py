"""Stick-slip of a rig's slider on an elastic holder and its suppression, and figures of friction control."""

from dataclasses import dataclass, replace

import numpy as np

from sonolube.charts import Axis, Chart, Line, Panel, Part, Points, Rule, one_panel
from sonolube.checks import Floats
from sonolube.design.control.control_design import ControlDesign
from sonolube.design.control.friction_characteristic import level_for_friction
from sonolube.design.control.process import open_loop_response
from sonolube.design.control.stick_slip_oscillator import (
    StickSlipMotion,
    mass_on_belt,
    steady_sliding_damping,
    stick_slip_motion,
)
from sonolube.rig import CommandedQuantity, Rig

HOLDER_MASS = 0.05
"""Assumed mass that moves with the slider. [kg]"""

HOLDER_STIFFNESS = 2e4
"""Assumed stiffness of the holder. [N/m]"""

HOLDER_DAMPING_RATIO = 0.01
"""Assumed damping ratio of the holder. []"""

STATIC_FRICTION_FACTOR = 1.3
"""Assumed friction at rest over friction of sliding, both without vibration. []"""

_PERIODS = 80  # free periods of the holder that are integrated


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class StickSlipSuppression:
    """Motion of a slider on an elastic holder without and with vibration.

    Parameters
    ----------
    still, vibrating : StickSlipMotion
        Without and with vibration.
    level : float
        Drive voltage or amplitude of `vibrating`, in V or m.
    quantity : CommandedQuantity
        Voltage or amplitude.
    damping : tuple of two float
        Damping of small motions about steady sliding, without and with vibration, in N s/m.
    """

    still: StickSlipMotion
    vibrating: StickSlipMotion
    level: float
    quantity: CommandedQuantity
    damping: tuple[float, float]


def stick_slip_suppression(rig: Rig, study: ControlDesign) -> StickSlipSuppression:
    r"""Stick-slip of a rig's slider without vibration and at the voltage or amplitude of the commanded friction.

    The holder has the mass, stiffness, damping ratio and static friction of the constants of this module, with

    .. math:: c = 2 \zeta \sqrt{m k}

    and friction that falls from its static value over the rig's sliding speed.

    See Also
    --------
    dragged_mass, dragged_motion, steady_sliding_damping
    """
    level = float(level_for_friction(study.plant, friction_force=study.friction_force))
    without, within = (
        mass_on_belt(
            rig,
            holder_mass=HOLDER_MASS,
            holder_stiffness=HOLDER_STIFFNESS,
            holder_damping=2 * HOLDER_DAMPING_RATIO * float(np.sqrt(HOLDER_MASS * HOLDER_STIFFNESS)),
            static_friction_force=STATIC_FRICTION_FACTOR * study.plant.highest_force,
            stribeck_velocity=rig.sliding_speed,
            level=each,
        )
        for each in (0.0, level)
    )
    return StickSlipSuppression(
        still=stick_slip_motion(without, duration=_PERIODS * without.period),
        vibrating=stick_slip_motion(within, duration=_PERIODS * within.period),
        level=level,
        quantity=study.plant.quantity,
        damping=(steady_sliding_damping(without), steady_sliding_damping(within)),
    )


_SHOWN = 0.3  # of the motion of a slider
_MAX_DRAWN = 3000  # points of it
_MIN_SPAN = 2e-3  # of an axis relative to its middle, below which rounding errors would look like motion


def closed_loop_chart(study: ControlDesign) -> Chart:
    """Friction force and drive voltage with its frequency, or commanded amplitude, of the closed loop over time.

    With the run at a fixed frequency beside, where the study has one.
    """
    run, fixed, quantity = study.run, study.fixed_frequency_run, study.plant.quantity
    ms, scale = 1e3 * run.time, quantity.axis_scale
    highest = scale * study.level_maximum
    friction: list[Part] = []
    drive: list[Part] = []
    if fixed is not None:
        friction.append(Line(x=ms, y=fixed.friction_force, label="frequency fixed", colour=1, dash=1))
        drive.append(Line(x=ms, y=scale * fixed.level, colour=1, dash=1))
    friction += [
        Line(x=ms, y=run.friction_force, label="friction" if fixed is None else "resonance tracked"),
        Line(x=ms, y=run.setpoint, label="target", colour=6, dash=3, is_stepped=True),
    ]
    drive += [
        Line(x=ms, y=scale * run.level),
        Rule(value=highest, along="y", label=f"{study.limit} limit", colour="0.5", dash=2),
    ]
    time = Axis("Time", "ms", lowest=0.0, highest=float(ms[-1]))
    panels = [
        Panel(x=time, y=Axis("Friction force", "N", lowest=0.0), parts=tuple(friction)),
        Panel(x=time, y=replace(quantity.axis, lowest=0.0, highest=1.12 * highest), parts=tuple(drive)),
    ]
    if run.phase is not None:
        panels.append(_frequencies(time, ms, 1e-3 * run.frequency, 1e-3 * run.resonance_frequency))
    heights = (2.0, 1.0, 1.0)[: len(panels)]
    return Chart(panels=tuple(panels), size=(5.6, 2.0 + 1.2 * len(panels)), heights=heights, shares_x=True)


def _frequencies(time: Axis, ms: Floats, drive: Floats, resonance: Floats) -> Panel:
    """Frequency of drive and resonance in kHz over time, on an axis that makes no motion of rounding errors."""
    low, high = float(min(drive.min(), resonance.min())), float(max(drive.max(), resonance.max()))
    middle = (low + high) / 2
    half = max(0.55 * (high - low), _MIN_SPAN / 2 * middle)
    lines = (Line(x=ms, y=drive, label="drive"), Line(x=ms, y=resonance, label="resonance", colour=2, dash=1))
    y = Axis("Frequency", "kHz", lowest=middle - half, highest=middle + half)
    return Panel(x=time, y=y, parts=lines)


def control_design_chart(study: ControlDesign) -> Chart:
    r"""Feed-forward map from voltage or amplitude to friction, and magnitude of the sensitivity over frequency.

    The sensitivity of the loop of gain g about the process P and the controller C is

    .. math:: |S(f)| = \frac{1}{|1 + g\,P(f)\,C(f)|}
    """
    plant, controller = study.plant, study.controller
    table = controller.intrinsic_friction_force - np.array(controller.force_reduction)
    scale = plant.quantity.axis_scale
    level = np.interp(-study.friction_force, -plant.friction_force, plant.level)
    lookup = (
        Line(x=scale * plant.level, y=plant.friction_force, label="rig's model"),
        Line(x=scale * np.array(controller.level), y=table, label="controller's table", colour=1, dash=1),
        Points(x=np.array([scale * level]), y=np.array([study.friction_force]), label="target", colour=6),
    )
    nyquist = 0.5 / controller.process.sample_interval
    f = np.geomspace(1e-3 * nyquist, nyquist, 600)
    open_loop = study.plant_gain * open_loop_response(controller.process, controller.gains, frequency=f)
    peak = study.margins.sensitivity_peak
    loop = (
        Line(x=f, y=1 / np.abs(1 + open_loop)),
        Rule(value=peak, along="y", label=f"maximum, {peak:.2f}", colour="0.5", dash=2),
        Rule(value=1.0, along="y", colour="0.5", dash=0),
    )
    magnitude = Axis("Sensitivity, magnitude", lowest=0.0, highest=1.25 * max(peak, 1))
    return Chart(
        panels=(
            Panel(x=replace(plant.quantity.axis, lowest=0.0), y=Axis("Friction force", "N", lowest=0.0), parts=lookup),
            Panel(x=Axis("Frequency", "Hz", logarithmic=True), y=magnitude, parts=loop),
        ),
        size=(6.4, 3.0),
        columns=2,
    )


def stick_slip_chart(suppression: StickSlipSuppression) -> Chart:
    """Force in the holder of a dragged slider over time, without and with vibration."""
    label = f"with {suppression.quantity.text(suppression.level)}"
    still, vibrating = suppression.still, suppression.vibrating
    count = max(2, int(_SHOWN * still.time.size))
    shown = slice(0, count, -(-count // _MAX_DRAWN))
    ms = 1e3 * still.time[shown]
    lines = (
        Line(x=ms, y=still.friction_force[shown], label="without vibration", colour=1, weight=0.7),
        Line(x=ms, y=vibrating.friction_force[shown], label=label, dash=1),
    )
    return one_panel(
        Axis("Time", "ms", lowest=0.0, highest=float(ms[-1])),
        Axis("Force in the holder", "N"),
        lines,
        size=(5.6, 2.8),
        legend="top",
    )
