"""Figures of impedance spectra: fits and the admittance circle."""

from typing import TYPE_CHECKING

import numpy as np

from sonolube.checks import Complexes, Floats
from sonolube.figure import COLOURS, subplots
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.models.actuator import ButterworthVanDyke, circuit_admittance
from sonolube.models.dynamics.structure import Structure, electrical_admittance
from sonolube.report.measured.sheet import captioned

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def circuit(spectrum: ImpedanceSpectrum, fitted: ButterworthVanDyke) -> "Figure":
    """Impedance measured and of a fitted circuit, above the residual."""
    return _fit(spectrum, circuit_admittance(fitted, frequency=spectrum.frequency))


def stack(spectrum: ImpedanceSpectrum, fitted: Structure) -> "Figure":
    """Impedance measured and of a fitted structure, above the residual."""
    return _fit(spectrum, electrical_admittance(fitted, frequency=spectrum.frequency))


@captioned("Admittance circle", "Susceptance over conductance; a mode draws a circle.")
def admittance_circle(spectrum: ImpedanceSpectrum, fitted: ButterworthVanDyke) -> "Figure":
    """Susceptance over conductance, measured and fitted."""
    figure, axes = subplots(figsize=(3.8, 3.6))
    fine = np.geomspace(spectrum.frequency[0], spectrum.frequency[-1], 4000)
    model = 1e3 * circuit_admittance(fitted, frequency=fine)
    measured = 1e3 * spectrum.admittance
    axes.plot(measured.real, measured.imag, ".", color="0.45", markersize=4, label="measured")
    axes.plot(model.real, model.imag, color=COLOURS[1], linewidth=1.2, label="fitted")
    axes.set(xlabel="conductance (mS)", ylabel="susceptance (mS)", aspect="equal")
    axes.legend()
    return figure


def _fit(spectrum: ImpedanceSpectrum, model: Complexes) -> "Figure":
    """Magnitude and phase of the impedance, measured and fitted, above the residual of the logarithm."""
    f = spectrum.frequency / 1e3
    figure, (top, middle, bottom) = subplots(3, 1, figsize=(6.4, 5.4), sharex=True, height_ratios=(2, 1.5, 1))
    for axes, of, is_measured in ((top, np.abs, True), (middle, _degrees, spectrum.has_phase)):
        if is_measured:
            axes.plot(f, of(spectrum.impedance), ".", color="0.45", markersize=3, label="measured")
        axes.plot(f, of(1 / model), color=COLOURS[1], linewidth=1.2, label="fitted")
    left_over = np.log(model / spectrum.admittance)
    bottom.plot(f, left_over.real, color=COLOURS[0], linewidth=1, label="magnitude")
    if spectrum.has_phase:
        bottom.plot(f, left_over.imag, "--", color=COLOURS[2], linewidth=1, label="phase")
    top.set(yscale="log", ylabel="impedance (ohm)")
    middle.set(ylabel="phase (deg)", ylim=(-100, 100), yticks=[-90, 0, 90])
    bottom.set(xlabel="frequency (kHz)", ylabel="residual")
    top.legend()
    bottom.legend(ncols=2)
    return figure


def _degrees(impedance: Complexes) -> Floats:
    """Phase in degrees."""
    return np.degrees(np.angle(impedance))
