"""Charts of force gauges: calibration loops and forces over time."""

from sonolube.charts import Axis, Band, Chart, Line, Panel, Points, Rule, envelope, one_panel
from sonolube.checks import Floats
from sonolube.measurement.gauge.calibration import ForceEstimate, PreisachCalibration, force_from_preisach
from sonolube.report.measured.sheet import captioned


@captioned("Force over displacement", "Measured loops and those of the Preisach model; below, the residual.")
def loops_figure(x: Floats, force: Floats, calibration: PreisachCalibration) -> Chart:
    """Force over displacement, measured and by the Preisach model, above the residual."""
    model = force_from_preisach(calibration, displacement=x).applied_force
    um, across = 1e6 * x, Axis("Displacement", "µm")
    curves = (
        Points(x=um, y=force, label="measured", colour="0.55", is_faint=True),
        Line(x=um, y=model, label="Preisach model", colour=1, weight=0.7),
    )
    residual = (Points(x=um, y=force - model, is_faint=True), Rule(value=0.0, along="y", colour="0.5", dash=0))
    panels = (
        Panel(x=across, y=Axis("Force", "N"), parts=curves),
        Panel(x=across, y=Axis("Residual", "N"), parts=residual),
    )
    return Chart(panels=panels, size=(5.0, 4.8), heights=(3, 1), shares_x=True)


@captioned("Force by the displacement", "With its standard uncertainty as a band.")
def force_figure(t: Floats, estimate: ForceEstimate) -> Chart:
    """Force over time with its standard uncertainty as a band."""
    f, u = estimate.applied_force, estimate.applied_force_uncertainty
    band = Band(x=t, low=f - u, high=f + u, label="standard uncertainty", colour=5, opacity=0.6)
    time, curve = envelope(t, f)
    parts = (band, Line(x=time, y=curve, weight=0.7))
    return one_panel(Axis("Time", "s"), Axis("Force", "N"), parts, size=(6.4, 3.0))
