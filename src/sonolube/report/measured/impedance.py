"""Sheets of impedance spectra: fitted equivalent circuit, or the fitted stack of a structure."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from sonolube.identification.circuit_fit import fit_circuit
from sonolube.identification.spectral_residual import LOG_COMPLEX, residual_for
from sonolube.identification.stack_fit import fit_stack
from sonolube.measurement.impedance.passivity import passive_spectrum
from sonolube.measurement.impedance.reader import read_impedance
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum
from sonolube.measurement.statistics.log_parameter_fit import ConfidenceInterval
from sonolube.measurement.swept_impedance import swept_impedance
from sonolube.models.actuator import PiezoStack
from sonolube.models.dynamics import Structure
from sonolube.report.measured import impedance_figures as figures, sheet
from sonolube.text.units import format_si
from sonolube.vocabulary import quantities


@dataclass(frozen=True, slots=True)
class StackInStructure:
    """Stack by its data sheet, and the structure as a function of the stack."""

    stack: PiezoStack
    in_structure: Callable[[PiezoStack], Structure]


@dataclass(frozen=True, kw_only=True, slots=True)
class ImpedanceSettings:
    """Settings of the fit to an impedance spectrum.

    Parameters
    ----------
    branches : int or None
        How many modes; None takes as many as a criterion bears out.
    residual : str
        "log-complex", "log-magnitude" or "linear-magnitude".
    series_resistance : float
        Of the leads, as known. [ohm]
    sweep : str or None
        Which of several sweeps of a file.
    stack : StackInStructure or None
        Whose parameters are sought; None fits a circuit.
    """

    branches: int | None = None
    residual: str = LOG_COMPLEX
    series_resistance: float = 0.0
    sweep: str | None = None
    stack: StackInStructure | None = None


def impedance_sheet(path: Path, *, settings: ImpedanceSettings) -> sheet.Sheet:
    """Equivalent circuit fitted to a measured impedance spectrum, or the stack of a structure."""
    spectrum, turned = passive_spectrum(swept_impedance(path) or read_impedance(path, sweep=settings.sweep))
    section = _circuit(spectrum, settings) if settings.stack is None else _stack(spectrum, settings, settings.stack)
    frequency = spectrum.frequency
    ends = " to ".join(format_si(float(end), "Hz", digits=6) for end in (frequency[0], frequency[-1]))
    source = {
        "format": spectrum.file_format,
        "sweep": spectrum.sweep,
        "points": f"{frequency.size}, {ends}",
        "residual": residual_for(spectrum, settings.residual),
        "sha256": spectrum.sha256,
    }
    section = replace(section, caveats=(*turned, *section.caveats, *spectrum.caveats))
    return sheet.joined([section], title=path.name, source=source)


def _circuit(spectrum: ImpedanceSpectrum, settings: ImpedanceSettings) -> sheet.Sheet:
    """Butterworth-Van Dyke circuit fitted to a spectrum."""
    fit = fit_circuit(
        spectrum, branches=settings.branches, residual=settings.residual, series_resistance=settings.series_resistance
    )
    captioned = sheet.captioned(
        "Impedance with the fitted circuit",
        f"Measured and fitted by the {fit.residual} residual, and the residual: relative in magnitude,"
        " radians in phase.",
    )
    figure = captioned(figures.circuit_chart)(spectrum, fit.circuit)
    circles = (figures.admittance_circle_figure(spectrum, fit.circuit),) if spectrum.has_phase else ()
    values = (*_values(fit.intervals), _rms(fit.residual_rms, fit.residual))
    return sheet.Sheet(values=values, figures=(figure, *circles), caveats=fit.caveats)


def _stack(spectrum: ImpedanceSpectrum, settings: ImpedanceSettings, initial: StackInStructure) -> sheet.Sheet:
    """Parameters of a stack fitted to the spectrum of its structure."""
    fit = fit_stack(spectrum, initial.stack, in_structure=initial.in_structure, residual=settings.residual)
    charge = fit.charge_per_elongation
    ends = (charge.lower, charge.upper)
    force = sheet.Value("force_per_volt", "Blocked force per volt", charge.value, "N/V", interval=ends)
    values = (*_values(fit.intervals), force, _rms(fit.residual_rms, fit.residual))
    captioned = sheet.captioned(
        "Impedance with the fitted stack",
        f"Measured, and that of the structure with the stack found by the {fit.residual} residual.",
    )
    figure = captioned(figures.stack_chart)(spectrum, initial.in_structure(fit.stack))
    return sheet.Sheet(values=values, figures=(figure,), caveats=fit.caveats)


def _values(intervals: Mapping[str, ConfidenceInterval]) -> tuple[sheet.Value, ...]:
    """Fitted parameters with their intervals."""
    return tuple(_value(name, interval) for name, interval in intervals.items())


def _value(name: str, interval: ConfidenceInterval) -> sheet.Value:
    """Fitted parameter with its interval, that of a branch named by its number."""
    ends = (interval.lower, interval.upper)
    if name in quantities():
        return sheet.quantity_value(name, interval.value, interval=ends)
    base, _, branch = name.rpartition("_")
    word = quantities()[base]
    label = f"{word.meaning}, branch {branch}"
    return sheet.Value(name, label, interval.value, word.unit, interval=ends)


def _rms(rms: float, residual: str) -> sheet.Value:
    """Root mean square of the residual of a fit."""
    return sheet.Value("residual_rms", f"Root mean square of the {residual} residual", rms, "")
