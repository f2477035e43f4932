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
        figures=(figures.resonances(found),),
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
    values: list[sheet.Value] = []
    if one.normal_stiffness is not None and one.decay_length is not None:
        values += [
            _estimate("normal_stiffness", "Normal stiffness of the contact (95 %)", one.normal_stiffness, "N/m"),
            _estimate("decay_length", "Decay length of its force, load over stiffness (95 %)", one.decay_length, "m"),
        ]
    if one.decay_length_by_ratio is not None and one.stiffness_ratio is not None:
        label = "Decay length by the ratio of shifts at large and small drive (95 %)"
        values.append(_estimate("decay_length_by_ratio", label, one.decay_length_by_ratio, "m"))
    if one.stiffness_ratio is not None:
        values.append(sheet.Value("stiffness_ratio", "Stiffness at large over small drive", one.stiffness_ratio, ""))
    if one.decay_length_combined is not None:
        label = "Decay length by both (95 %)"
        values.append(_estimate("decay_length_combined", label, one.decay_length_combined, "m"))
    values += [
        sheet.Value(
            "free_frequency",
            "Resonance without contact",
            one.free_frequency,
            "Hz",
            uncertainty=one.free_uncertainty or None,
        ),
        sheet.Value(
            "pressed_frequency",
            "Resonance under the load",
            one.pressed_frequency,
            "Hz",
            uncertainty=one.pressed_uncertainty,
        ),
        sheet.Value("frequency_shift", "Shift", one.frequency_shift, "Hz", uncertainty=one.shift_uncertainty),
    ]
    if one.drift is not None:
        values.append(sheet.Value("drift", "Drift between both free spectra", one.drift, "Hz"))
    values.append(sheet.quantity_value("normal_load", settings.normal_load))
    return tuple(values)


def _estimate(name: str, label: str, estimate: LogEstimate, unit: str) -> sheet.Value:
    """Estimate with its 95 % interval."""
    return sheet.Value(name, label, estimate.median, unit, interval=estimate.interval)
