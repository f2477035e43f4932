"""Sheets of spectra with their charts: contact stiffness by the shift of a resonance, and fitted impedance."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from sonolube.charts import Axis, Chart, Line, Panel, Part, Points, Rule, one_panel
from sonolube.checks import Complexes, Floats
from sonolube.identification.circuit_fit import fit_circuit
from sonolube.identification.stack_fit import LOG_COMPLEX, fit_stack, hardly_determined, residual_for
from sonolube.measurement.contact_stiffness.analysis import MeasuredContactStiffness, measured_contact_stiffness
from sonolube.measurement.contact_stiffness.resonance_fit import ResonanceFit
from sonolube.measurement.contact_stiffness.resonance_spectrum import read_resonance_spectrum
from sonolube.measurement.contact_stiffness.stiffness_estimate import ContactStiffness, LogEstimate
from sonolube.measurement.impedance.spectrum import ImpedanceSpectrum, passive_spectrum, read_impedance
from sonolube.measurement.recorded_conditions import swept_impedance
from sonolube.measurement.statistics.log_parameter_fit import ConfidenceInterval
from sonolube.models.actuator import ButterworthVanDyke, PiezoStack, circuit_admittance
from sonolube.models.dynamics import Structure, electrical_admittance
from sonolube.report.measured import sheet
from sonolube.report.measured.sheet import captioned
from sonolube.text.units import format_si
from sonolube.vocabulary import quantities


@captioned("Resonance free and pressed", "Measured (points) and fitted (lines); the marks are the resonances compared.")
def resonances_figure(found: MeasuredContactStiffness) -> Chart:
    """Spectra free, pressed, free again and at large drive, with fits and the resonances that were compared."""
    fits = _named(found)
    highest = max(fit.spectrum.frequency[-1] for _, fit in fits)
    unit, scale = ("kHz", 1e-3) if highest > 1e4 else ("Hz", 1.0)
    parts: list[Part] = []
    for place, (name, fit) in enumerate(fits):
        f = scale * fit.spectrum.frequency
        parts += [
            Points(x=f, y=_level(fit, fit.spectrum.response), colour=place, is_faint=True),
            Line(x=f, y=_level(fit, fit.fitted), label=name, colour=place, dash=place, weight=0.85),
        ]
        compared = [one for one in fit.resonances if one in found.chosen]
        parts += [Rule(value=scale * one.frequency, colour=place, dash=place) for one in compared]
    kinds = ", ".join(sorted({fit.spectrum.quantity for _, fit in fits}))
    level = Axis(f"Response by {kinds} over its maximum", logarithmic=True)
    return one_panel(Axis("Frequency", unit), level, parts, size=(6.4, 3.8), legend="top", legend_columns=4)


def _named(found: MeasuredContactStiffness) -> list[tuple[str, ResonanceFit]]:
    """Fits by the name of their spectrum."""
    free = list(zip(("free", "free again"), found.free, strict=False))
    return [*free, ("pressed", found.pressed), *([] if found.large is None else [("large drive", found.large)])]


def _level(fit: ResonanceFit, values: Complexes) -> Floats:
    """Magnitude over the greatest one of the spectrum."""
    return np.asarray(np.abs(values) / np.max(np.abs(fit.spectrum.response)))


@dataclass(frozen=True, kw_only=True, slots=True)
class StiffnessSettings:
    """Rig, load and choice of the resonance of a measurement of contact stiffness.

    Parameters
    ----------
    normal_load : float
        Force pressing the bodies together. [N]
    structure : Structure or None
        Of the rig, its contact free.
    modal_mass : float or None
        Of the mode at the contact, instead of the structure. [kg]
    modal_mass_deviation : float
        Standard deviation of the logarithm of the modal mass.
    mode_near : float or None
        Frequency of the free resonance, in Hz; zero for a mode that floats.
    pressed_near : float or None
        Frequency of the pressed resonance, in Hz.
    vibration_amplitude : float or None
        At the contact in the spectrum at large drive, zero to peak. [m]
    log_amplitude_deviation : float
        Standard deviation of its logarithm.
    """

    normal_load: float
    structure: Structure | None = None
    modal_mass: float | None = None
    modal_mass_deviation: float = 0.1
    mode_near: float | None = None
    pressed_near: float | None = None
    vibration_amplitude: float | None = None
    log_amplitude_deviation: float = 0.05


def contact_stiffness_sheet(
    free: Path, pressed: Path, *, settings: StiffnessSettings, again: Path | None = None, large: Path | None = None
) -> tuple[sheet.Sheet, tuple[str, ...]]:
    """Stiffness of a contact by the shift of a resonance, from files of spectra.

    `rig_lines`: Lines of a rig file that state the stiffness by all that was measured; empty where it was not found.
    """
    spectra = [read_resonance_spectrum(path) for path in (free, *([] if again is None else [again]))]
    found = measured_contact_stiffness(
        spectra,
        read_resonance_spectrum(pressed),
        normal_load=settings.normal_load,
        structure=settings.structure,
        modal_mass=settings.modal_mass,
        modal_mass_deviation=settings.modal_mass_deviation,
        mode_near=settings.mode_near,
        pressed_near=settings.pressed_near,
        large=None if large is None else read_resonance_spectrum(large),
        vibration_amplitude=settings.vibration_amplitude,
        log_amplitude_deviation=settings.log_amplitude_deviation,
    )
    one = found.stiffness
    names = [("free", free), ("pressed", pressed), ("free again", again), ("large drive", large)]
    source = {name: path.name for name, path in names if path is not None}
    section = sheet.Sheet(
        values=_stiffness_values(one, settings),
        figures=(resonances_figure(found),),
        caveats=found.caveats,
        not_found=one.not_found,
    )
    best = one.best_stiffness
    lines = () if best is None else rig_lines(best)
    return sheet.joined([section], title=f"{pressed.name} against {free.name}", source=source), lines


def rig_lines(stiffness: LogEstimate) -> tuple[str, ...]:
    """Lines of a rig file that state a stiffness of the contact and its uncertainty; two tables of a line each."""
    return (
        "[contact]",
        f'normal_stiffness = "{stiffness.median:.4g} N/m"',
        "[uncertainty]",
        f'"contact.normal_stiffness" = "lognormal factor {float(np.exp(stiffness.log_deviation)):.3g}"',
    )


def _stiffness_values(one: ContactStiffness, settings: StiffnessSettings) -> tuple[sheet.Value, ...]:
    """Numbers of a measurement, those that matter most first."""
    contact = (
        ("normal_stiffness", "Normal stiffness of the contact (95 %)", "N/m"),
        ("decay_length", "Decay length of its force, load over stiffness (95 %)", "m"),
        ("decay_length_by_ratio", "Decay length by the ratio of shifts at large and small drive (95 %)", "m"),
        ("stiffness_ratio", "Stiffness at large over small drive", ""),
        ("decay_length_combined", "Decay length by both (95 %)", "m"),
    )
    known = [(name, label, found, unit) for name, label, unit in contact if (found := getattr(one, name)) is not None]
    frequencies = (
        ("free_frequency", "Resonance without contact", one.free_frequency, one.free_uncertainty or None),
        ("pressed_frequency", "Resonance under the load", one.pressed_frequency, one.pressed_uncertainty),
        ("frequency_shift", "Shift", one.frequency_shift, one.shift_uncertainty),
        *(() if one.drift is None else (("drift", "Drift between both free spectra", one.drift, None),)),
    )
    return (
        *(_estimate(*each) for each in known),
        *(sheet.Value(name, label, value, "Hz", uncertainty=error) for name, label, value, error in frequencies),
        sheet.quantity_value("normal_load", settings.normal_load),
    )


def _estimate(name: str, label: str, found: LogEstimate | float, unit: str) -> sheet.Value:
    """Estimate with its 95 % interval, or a plain number."""
    if isinstance(found, LogEstimate):
        return sheet.Value(name, label, found.median, unit, interval=found.interval)
    return sheet.Value(name, label, found, unit)


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
    parts : tuple of str or None
        Of `CIRCUIT_PARTS` that the circuit has; None takes those that the data demand.
    sweep : str or None
        Which of several sweeps of a file.
    stack : StackInStructure or None
        Whose parameters are sought; None fits a circuit.
    """

    branches: int | None = None
    residual: str = LOG_COMPLEX
    series_resistance: float = 0.0
    parts: tuple[str, ...] | None = None
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
        "columns": spectrum.columns,
        "points": f"{frequency.size}, {ends}",
        "residual": residual_for(spectrum, settings.residual),
        "sha256": spectrum.sha256,
    }
    section = replace(section, caveats=(*turned, *section.caveats, *spectrum.caveats))
    return sheet.joined([section], title=path.name, source=source)


def _circuit(spectrum: ImpedanceSpectrum, settings: ImpedanceSettings) -> sheet.Sheet:
    """Butterworth-Van Dyke circuit fitted to a spectrum."""
    fit = fit_circuit(
        spectrum,
        branches=settings.branches,
        residual=settings.residual,
        series_resistance=settings.series_resistance,
        parts=settings.parts,
    )
    captioned = sheet.captioned(
        "Impedance with the fitted circuit",
        f"Measured and fitted by the {fit.residual} residual, and the residual: relative in magnitude,"
        " radians in phase.",
    )
    figure = captioned(circuit_chart)(spectrum, fit.circuit)
    circles = (admittance_circle_figure(spectrum, fit.circuit),) if spectrum.has_phase else ()
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
    figure = captioned(stack_chart)(spectrum, initial.in_structure(fit.stack))
    loose = hardly_determined(fit.intervals)
    known = {name: getattr(fit.stack, name) for name in _OF_RIG if name not in loose}
    entries = sheet.rig_entries("stack", known)
    return sheet.Sheet(values=values, figures=(figure,), caveats=fit.caveats, rig_entries=entries)


_OF_RIG = ("free_capacitance", "free_stroke_per_volt", "stack_stiffness", "stack_damping")  # entries of a rig


_LABELS = {  # of quantities of circuits; of branches with the definition that holds beside other branches
    "series_inductance": "Lead inductance",
    "coupling_factor": "Coupling factor by C/(C0 + C)",
    "parallel_frequency": "Parallel resonance of the whole circuit",
    "effective_coupling_factor": "Effective coupling of the whole circuit",
}


def _values(intervals: Mapping[str, ConfidenceInterval]) -> tuple[sheet.Value, ...]:
    """Fitted parameters with their intervals."""
    return tuple(_value(name, interval) for name, interval in intervals.items())


def _value(name: str, interval: ConfidenceInterval) -> sheet.Value:
    """Fitted parameter with its interval, that of a branch named by its number."""
    ends = (interval.lower, interval.upper)
    if name in quantities():
        return sheet.quantity_value(name, interval.value, label=_LABELS.get(name, ""), interval=ends)
    base, _, branch = name.rpartition("_")
    word = quantities()[base]
    label = f"{_LABELS.get(base, word.meaning)}, branch {branch}"
    return sheet.Value(name, label, interval.value, word.unit, interval=ends)


def _rms(rms: float, residual: str) -> sheet.Value:
    """Root mean square of the residual of a fit."""
    return sheet.Value("residual_rms", f"Root mean square of the {residual} residual", rms, "")
