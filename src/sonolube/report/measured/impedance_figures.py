"""Charts of impedance spectra: fits and the admittance circle."""

import numpy as np

from sonolube.charts import Axis, Chart, Line, Panel, Part, Points, one_panel
from sonolube.checks import Complexes, Floats
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.models.actuator import ButterworthVanDyke, circuit_admittance
from sonolube.models.dynamics import Structure, electrical_admittance
from sonolube.report.measured.sheet import captioned


def circuit_chart(spectrum: ImpedanceSpectrum, fitted: ButterworthVanDyke) -> Chart:
    """Impedance measured and of a fitted circuit, above the residual."""
    return _fit(spectrum, circuit_admittance(fitted, frequency=spectrum.frequency))


def stack_chart(spectrum: ImpedanceSpectrum, fitted: Structure) -> Chart:
    """Impedance measured and of a fitted structure, above the residual."""
    return _fit(spectrum, electrical_admittance(fitted, frequency=spectrum.frequency))


@captioned("Admittance circle", "Susceptance over conductance; a mode draws a circle.")
def admittance_circle_figure(spectrum: ImpedanceSpectrum, fitted: ButterworthVanDyke) -> Chart:
    """Susceptance over conductance, measured and fitted."""
    fine = np.geomspace(spectrum.frequency[0], spectrum.frequency[-1], 4000)
    model = 1e3 * circuit_admittance(fitted, frequency=fine)
    measured = 1e3 * spectrum.admittance
    parts = (
        Points(x=measured.real, y=measured.imag, label="measured", colour="0.45", size=0.8),
        Line(x=model.real, y=model.imag, label="fitted", colour=1, weight=0.85),
    )
    return one_panel(
        Axis("Conductance", "mS"), Axis("Susceptance", "mS"), parts, has_equal_scales=True, size=(3.8, 3.6)
    )


def _fit(spectrum: ImpedanceSpectrum, model: Complexes) -> Chart:
    """Magnitude and phase of the impedance, measured and fitted, above the residual of the logarithm."""
    f = spectrum.frequency / 1e3
    left_over = np.log(model / spectrum.admittance)
    residual = [Line(x=f, y=left_over.real, label="magnitude", weight=0.7)]
    if spectrum.has_phase:
        residual.append(Line(x=f, y=left_over.imag, label="phase", colour=2, dash=1, weight=0.7))
    curves: list[tuple[Part, ...]] = []
    for values, fitted, is_measured in (
        (np.abs(spectrum.impedance), np.abs(1 / model), True),
        (_degrees(spectrum.impedance), _degrees(1 / model), spectrum.has_phase),
    ):
        measured = [Points(x=f, y=values, label="measured", colour="0.45", is_faint=True)] if is_measured else []
        curves.append((*measured, Line(x=f, y=fitted, label="fitted", colour=1, weight=0.85)))
    across = Axis("Frequency", "kHz")
    phase = Axis("Phase", "deg", lowest=-100.0, highest=100.0, ticks=(-90, 0, 90))
    panels = (
        Panel(x=across, y=Axis("Impedance", "ohm", logarithmic=True), parts=curves[0]),
        Panel(x=across, y=phase, parts=curves[1]),
        Panel(x=across, y=Axis("Residual"), parts=tuple(residual)),
    )
    return Chart(panels=panels, size=(6.4, 5.4), heights=(2, 1.5, 1), shares_x=True)


def _degrees(impedance: Complexes) -> Floats:
    """Phase in degrees."""
    return np.degrees(np.angle(impedance))
