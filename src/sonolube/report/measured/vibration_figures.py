"""Figures of vibration: operating shape, modal assurance, amplitude over voltage."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Floats
from sonolube.figure import COLOURS, MARKERS, subplots
from sonolube.measurement.vibration import AmplitudePerVolt, OperatingDeflectionShape
from sonolube.report.measured.sheet import captioned

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@captioned("Operating shape", "Motion in phase with the whole, scaled to 1, and the phase of each point.")
def shape(points: Sequence[str], operating: OperatingDeflectionShape) -> "Figure":
    """Operating shape and phase, point by point."""
    figure, (top, bottom) = subplots(2, 1, figsize=(6.0, 3.8), sharex=True, height_ratios=(2, 1))
    place = np.arange(1, len(points) + 1)
    top.plot(place, operating.shape, marker=MARKERS[0])
    top.axhline(0, color="0.5", linewidth=0.6)
    bottom.plot(place, (np.degrees(operating.phase) + 90) % 360 - 90, MARKERS[1], color=COLOURS[1], linestyle="none")
    top.set(ylabel="shape, greatest 1", ylim=(-1.1, 1.1))
    bottom.set(xlabel="point", ylabel="phase (deg)", ylim=(-100, 280), yticks=[0, 180])
    if len(points) <= 12:
        bottom.set_xticks(place)
    return figure


@captioned(
    "Modal assurance with computed modes",
    "Modal assurance criterion of the operating shape with each mode: 1 in proportion, 0 orthogonal.",
)
def assurance(assurance_values: Floats) -> "Figure":
    """Modal assurance criterion with each mode."""
    figure, axes = subplots(figsize=(4.2, 2.8))
    place = np.arange(1, assurance_values.size + 1)
    axes.bar(place, assurance_values, width=0.6, color=COLOURS[0])
    axes.set(xlabel="mode", ylabel="modal assurance", ylim=(0, 1.02), xticks=place)
    return figure


@captioned("Amplitude over voltage", "Each recording, and the line through the origin with its 95 % interval.")
def proportion(volts: Floats, amplitudes: Floats, fit: AmplitudePerVolt) -> "Figure":
    """Amplitude over voltage with the line through the origin and its interval."""
    figure, axes = subplots(figsize=(4.4, 3.2))
    line = np.array([0.0, 1.05 * volts.max()])
    axes.fill_between(
        line, 1e6 * fit.lower * line, 1e6 * fit.upper * line, color=COLOURS[5], alpha=0.5, linewidth=0, label="95 %"
    )
    axes.plot(line, 1e6 * fit.amplitude_per_volt * line, color=COLOURS[0], linewidth=1.2, label="in proportion")
    axes.plot(volts, 1e6 * amplitudes, MARKERS[1], color=COLOURS[1], linestyle="none", label="recordings")
    axes.set(xlabel="voltage, peak to peak (V)", ylabel="amplitude (µm)", xlim=(0, None), ylim=(0, None))
    axes.legend()
    return figure
