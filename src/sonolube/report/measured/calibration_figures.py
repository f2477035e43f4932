"""Figures of force gauges: calibration loops and forces over time."""

from typing import TYPE_CHECKING

from sonolube.checks import Floats
from sonolube.figure import COLOURS, subplots
from sonolube.measurement.gauge.calibration import ForceEstimate, PreisachCalibration, force_from_preisach
from sonolube.report.measured.sheet import captioned

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@captioned("Force over displacement", "Measured loops and those of the Preisach model; below, the residual.")
def loops(x: Floats, force: Floats, calibration: PreisachCalibration) -> "Figure":
    """Force over displacement, measured and by the Preisach model, above the residual."""
    figure, (top, bottom) = subplots(2, 1, figsize=(5.0, 4.8), sharex=True, height_ratios=(3, 1))
    model = force_from_preisach(calibration, displacement=x).applied_force
    um = 1e6 * x
    top.plot(um, force, ".", color="0.55", markersize=3, label="measured")
    top.plot(um, model, color=COLOURS[1], linewidth=1, label="Preisach model")
    bottom.plot(um, force - model, ".", color=COLOURS[0], markersize=2)
    bottom.axhline(0, color="0.5", linewidth=0.6)
    top.set(ylabel="force (N)")
    bottom.set(xlabel="displacement (µm)", ylabel="residual (N)")
    top.legend()
    return figure


@captioned("Force by the displacement", "With its standard uncertainty as a band.")
def force(t: Floats, estimate: ForceEstimate) -> "Figure":
    """Force over time with its standard uncertainty as a band."""
    figure, axes = subplots(figsize=(6.4, 3.0))
    f, u = estimate.applied_force, estimate.applied_force_uncertainty
    axes.fill_between(t, f - u, f + u, color=COLOURS[5], alpha=0.6, linewidth=0, label="standard uncertainty")
    axes.plot(t, f, color=COLOURS[0], linewidth=1)
    axes.set(xlabel="time (s)", ylabel="force (N)")
    axes.legend()
    return figure
