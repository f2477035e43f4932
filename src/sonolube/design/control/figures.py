"""Figures of friction control: closed loop over time, feed-forward map with sensitivity, and stick-slip of a slider."""

from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from sonolube.design.control.control_design import ControlDesign
from sonolube.design.control.process import open_loop_response
from sonolube.design.control.stick_slip import StickSlipSuppression
from sonolube.figure import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def closed_loop_figure(study: ControlDesign) -> "Figure":
    """Friction force and drive voltage with its frequency, or commanded amplitude, of the closed loop over time.

    Parameters
    ----------
    study : ControlDesign

    Returns
    -------
    matplotlib.figure.Figure
        With the run at a fixed frequency beside, where the study has one.
    """
    from matplotlib.figure import Figure

    run, fixed, quantity = study.run, study.fixed_frequency_run, study.plant.quantity
    is_electrical = run.phase is not None
    figure = Figure(figsize=(5.6, 5.6 if is_electrical else 4.4))
    friction, drive, *lower = figure.subplots(
        3 if is_electrical else 2, 1, sharex=True, height_ratios=(2, 1, 1)[: 3 if is_electrical else 2]
    )
    ms = 1e3 * run.time
    if fixed is not None:
        friction.plot(ms, fixed.friction_force, color=COLOURS[1], linestyle="--", label="frequency fixed")
        drive.plot(ms, quantity.axis_scale * fixed.level, color=COLOURS[1], linestyle="--")
    friction.plot(ms, run.friction_force, color=COLOURS[0], label="friction" if fixed is None else "resonance tracked")
    friction.plot(ms, run.setpoint, color=COLOURS[6], linestyle=":", drawstyle="steps-post", label="target")
    friction.set(ylabel="Friction force [N]", ylim=(0, None))
    friction.legend(loc="best")
    drive.plot(ms, quantity.axis_scale * run.level, color=COLOURS[0])
    highest = quantity.axis_scale * study.level_maximum
    drive.axhline(highest, color="0.5", linestyle="-.", linewidth=1, label=f"{study.limit} limit")
    drive.set(ylabel=fill(quantity.axis_label, 14), ylim=(0, 1.12 * highest))
    drive.legend(loc="best")
    for frequency in lower:
        _draw_frequency(frequency, study)
    (lower or [drive])[-1].set(xlabel="Time [ms]", xlim=(0, float(ms[-1])))
    return figure


def _draw_frequency(frequency: "Axes", study: ControlDesign) -> None:
    """Draw drive and resonance frequency over time."""
    run = study.run
    ms = 1e3 * run.time
    frequency.plot(ms, 1e-3 * run.frequency, color=COLOURS[0], label="drive")
    frequency.plot(ms, 1e-3 * run.resonance_frequency, color=COLOURS[2], linestyle="--", label="resonance")
    frequency.set(ylabel="Frequency\n[kHz]")
    frequency.ticklabel_format(axis="y", useOffset=False)
    _require_span(frequency)
    frequency.legend(loc="best")


def control_design_figure(study: ControlDesign) -> "Figure":
    r"""Feed-forward map from voltage or amplitude to friction, and magnitude of the sensitivity over frequency.

    Parameters
    ----------
    study : ControlDesign

    Returns
    -------
    matplotlib.figure.Figure

    Notes
    -----
    The sensitivity of the loop of gain g about the process P and the controller C is

    .. math:: |S(f)| = \frac{1}{|1 + g\,P(f)\,C(f)|}
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 3.0))
    lookup, loop = figure.subplots(1, 2)
    plant, controller = study.plant, study.controller
    scale = plant.quantity.axis_scale
    lookup.plot(scale * plant.level, plant.friction_force, color=COLOURS[0], label="rig's model")
    table = controller.intrinsic_friction_force - np.array(controller.force_reduction)
    lookup.plot(scale * np.array(controller.level), table, color=COLOURS[1], linestyle="--", label="controller's table")
    level = np.interp(-study.friction_force, -plant.friction_force, plant.level)
    lookup.plot(scale * level, study.friction_force, "o", color=COLOURS[6], label="target")
    lookup.set(xlabel=plant.quantity.axis_label, ylabel="Friction force [N]", ylim=(0, None), xlim=(0, None))
    lookup.legend()
    nyquist = 0.5 / controller.process.sample_interval
    f = np.geomspace(1e-3 * nyquist, nyquist, 600)
    open_loop = study.plant_gain * open_loop_response(controller.process, controller.gains, frequency=f)
    loop.semilogx(f, 1 / np.abs(1 + open_loop))
    peak = study.margins.sensitivity_peak
    loop.axhline(peak, color="0.5", linestyle="-.", linewidth=1, label=f"maximum, {peak:.2f}")
    loop.axhline(1, color="0.5", linewidth=0.6)
    loop.set(xlabel="Frequency [Hz]", ylabel="Sensitivity, magnitude [–]", ylim=(0, 1.25 * max(peak, 1)))
    loop.legend(loc="lower right")
    return figure


def stick_slip_figure(suppression: StickSlipSuppression) -> "Figure":
    """Force in the holder of a dragged slider over time, without and with vibration.

    Parameters
    ----------
    suppression : StickSlipSuppression

    Returns
    -------
    matplotlib.figure.Figure
    """
    from matplotlib.figure import Figure

    still, vibrating = suppression.still, suppression.vibrating
    figure = Figure(figsize=(5.6, 2.8))
    axes = figure.subplots()
    axes.plot(1e3 * still.time, still.friction_force, color=COLOURS[1], linewidth=0.9, label="without vibration")
    label = f"with {suppression.quantity.text(suppression.level)}"
    axes.plot(1e3 * vibrating.time, vibrating.friction_force, color=COLOURS[0], linestyle="--", label=label)
    axes.set(xlabel="Time [ms]", ylabel="Force in the holder [N]", xlim=(0, 0.3e3 * float(still.time[-1])))
    top = float(still.friction_force.max())
    axes.set_ylim(top=1.35 * top)
    axes.legend(loc="upper center", ncols=2)
    return figure


def _require_span(axes: "Axes") -> None:
    """Widen the y axis to at least a thousandth of its values, so that rounding errors do not look like motion."""
    low, high = axes.get_ylim()
    middle, half = (low + high) / 2, (high - low) / 2
    half = max(half, 1e-3 * middle)
    axes.set_ylim(middle - half, middle + half)
