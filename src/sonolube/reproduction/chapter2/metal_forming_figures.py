"""Section 2.4.1, metal forming: figure of the mechanisms of the literature, as far as they have models."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from sonolube.facts.published import si_value
from sonolube.figure import COLOURS, LINES, MARKERS, ReportFigure
from sonolube.models.friction import (
    acoustic_softening_ratio,
    parallel_vibration_ratio,
    reference_intensity_from_test,
    superposed_mean_stress,
    transverse_vibration_ratio,
)
from sonolube.reproduction.plots import axes_row, line_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def metal_forming_figures() -> Iterator[ReportFigure]:
    """Figure of section 2.4.1."""
    yield ReportFigure(
        name="figures-2-28-2-29-metal-forming",
        title="Mechanisms of ultrasonic metal forming, by models",
        caption="D figures 2.28 and 2.29 are diagrams of the literature; here, its mechanisms as far as they have "
        "models. Left: superposition of steady and oscillating stress; the tool parts from the work beyond half the "
        "yield strength (dotted). Middle: acoustic softening. The intensity of the 40 % on zinc is not printed: its "
        "point lies where the curve has that ratio. Right: the vector of friction turned by vibration along and across "
        "the sliding. Lines: coefficients that simulations of extrusion assumed, over the 0.1 without vibration (D "
        "2.4.1). Swaging, solid-like films and metallurgical changes have no model here.",
        draw=_mechanisms,
    )


def zinc_intensity() -> float:
    """Intensity over that of flow without load at which acoustic softening has the 40 % on zinc. []"""
    ratio = 1 - si_value("2.4.1-blaha-force-reduction")
    return 1 / float(reference_intensity_from_test(stress_ratio=ratio, acoustic_intensity=1.0))


def _mechanisms() -> "Figure":
    """Draw mean stress over stress amplitude, flow stress over intensity, and friction over speed."""
    figure, (stress, softening, friction) = axes_row(3, (7.8, 3.3), sharey=True)
    amplitude = np.linspace(0.0, 1.5, 151)
    mean = superposed_mean_stress(yield_strength=1.0, youngs_modulus=1.0, strain_amplitude=amplitude)
    stress.plot(amplitude, mean, **line_style(0), label="superposition")
    stress.plot([0.5, 0.5], [0, 1.1], ":", color="0.4", linewidth=1)
    stress.set(xlabel="Stress amplitude\nover yield strength [1]", ylabel="Over the value without vibration [1]")
    intensity = np.linspace(0.0, 1.2, 241)
    ratio = acoustic_softening_ratio(acoustic_intensity=intensity, reference_intensity=1.0)
    softening.plot(intensity, ratio, **line_style(0), label="acoustic softening")
    zinc = zinc_intensity(), 1 - si_value("2.4.1-blaha-force-reduction")
    softening.plot(*zinc, MARKERS[3], color="black", ms=7, label="zinc crystal, D 2.4.1")
    softening.set(xlabel="Intensity over that of\nflow without load [1]")
    speed = np.linspace(1e-3, 1.5, 151)
    for index, (name, model) in enumerate(
        (("along", parallel_vibration_ratio), ("across", transverse_vibration_ratio))
    ):
        friction.plot(speed, model(sliding_speed=speed, vibration_velocity=1.0), **line_style(index), label=name)
    without = si_value("2.4.1-lucas-coefficient-static")
    for index, name in enumerate(("vibrated", "none"), start=2):
        coefficient = si_value(f"2.4.1-lucas-coefficient-{name}")
        style: dict[str, Any] = {"color": COLOURS[index], "linestyle": LINES[index], "clip_on": False, "zorder": 3}
        friction.axhline(coefficient / without, **style, label=f"extrusion, {coefficient:g}")
    friction.set(xlabel="Sliding speed over peak\nvibration velocity [1]")
    for axes in (stress, softening, friction):
        axes.set(ylim=(0, 1.5), yticks=(0, 0.5, 1))
        axes.set_xlim(left=0)
        axes.legend(loc="upper left")
    return figure
