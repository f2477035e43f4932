"""Sheet of a contact's stiffness by the shift of a resonance, and the lines of the rig file that state it."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sonolube.measurement.contact_stiffness.analysis import measured_contact_stiffness
from sonolube.measurement.contact_stiffness.resonance_spectrum import read_resonance_spectrum
from sonolube.measurement.contact_stiffness.stiffness_estimate import ContactStiffness, LogEstimate
from sonolube.models.dynamics import Structure
from sonolube.report.measured import contact_stiffness_figures as figures, sheet


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
        values=_values(one, settings),
        figures=(figures.resonances_figure(found),),
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


def _values(one: ContactStiffness, settings: StiffnessSettings) -> tuple[sheet.Value, ...]:
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
