"""Charts of vibration: operating shape, modal assurance, amplitude over voltage."""

from collections.abc import Sequence

import numpy as np

from sonolube.charts import Axis, Band, Bars, Chart, Line, Panel, Points, Rule, one_panel
from sonolube.checks import Floats
from sonolube.measurement.vibration import AmplitudePerVolt, OperatingDeflectionShape
from sonolube.report.measured.sheet import captioned

_MAX_NUMBERED = 12  # points


@captioned("Operating shape", "Motion in phase with the whole, scaled to 1, and the phase of each point.")
def shape_figure(points: Sequence[str], operating: OperatingDeflectionShape) -> Chart:
    """Operating shape and phase, point by point."""
    place = np.arange(1.0, len(points) + 1)
    across = Axis("Point", ticks=tuple(place) if place.size <= _MAX_NUMBERED else ())
    phase = (np.degrees(operating.phase) + 90) % 360 - 90
    motion = (
        Line(x=place, y=operating.shape),
        Points(x=place, y=operating.shape, sources=tuple(points)),
        Rule(value=0.0, along="y", colour="0.5", dash=0),
    )
    panels = (
        Panel(x=across, y=Axis("Shape, greatest 1", lowest=-1.1, highest=1.1), parts=motion),
        Panel(
            x=across,
            y=Axis("Phase", "deg", lowest=-100.0, highest=280.0, ticks=(0, 180)),
            parts=(Points(x=place, y=phase, colour=1, marker=1, sources=tuple(points)),),
        ),
    )
    return Chart(panels=panels, size=(6.0, 3.8), heights=(2, 1), shares_x=True)


@captioned(
    "Modal assurance with computed modes",
    "Modal assurance criterion of the operating shape with each mode: 1 in proportion, 0 orthogonal.",
)
def assurance_figure(assurance_values: Floats) -> Chart:
    """Modal assurance criterion with each mode."""
    place = np.arange(1.0, assurance_values.size + 1)
    bars = Bars(places=place, lengths=assurance_values, along="y")
    return one_panel(
        Axis("Mode", ticks=tuple(place)), Axis("Modal assurance", lowest=0.0, highest=1.02), (bars,), size=(4.2, 2.8)
    )


@captioned("Amplitude over voltage", "Each recording, and the line through the origin with its 95 % interval.")
def proportion_figure(files: Sequence[str], volts: Floats, amplitudes: Floats, fit: AmplitudePerVolt) -> Chart:
    """Amplitude over voltage, a file each, with the line through the origin and its interval."""
    line = np.array([0.0, 1.05 * volts.max()])
    low, middle, high = (1e6 * slope * line for slope in (fit.lower, fit.amplitude_per_volt, fit.upper))
    parts = (
        Band(x=line, low=low, high=high, label="95 %", colour=5, opacity=0.5),
        Line(x=line, y=middle, label="in proportion", weight=0.85),
        Points(x=volts, y=1e6 * amplitudes, label="recordings", colour=1, marker=1, sources=tuple(files)),
    )
    return one_panel(
        Axis("Voltage, peak to peak", "V", lowest=0.0), Axis("Amplitude", "µm", lowest=0.0), parts, size=(4.4, 3.2)
    )
