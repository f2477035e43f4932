"""Table of the observables of a structure, by name: frequencies, quality factors, settling times, amplitudes."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from sonolube.checks import Floats
from sonolube.errors import UnknownName
from sonolube.identification.small_vibration import SmallVibration, quality_factor_of, settling_time_of


@dataclass(frozen=True, kw_only=True, slots=True)
class Observable:
    """Observable quantity of a structure's small vibrations.

    Parameters
    ----------
    unit : str
        Its SI unit; empty for a pure number.
    meaning : str
        Its definition in a few words.
    requires : tuple of str
        Names of the `Conditions` it depends on.
    evaluate : callable
        Its values, shape (n,), from the `SmallVibration` of n structures.
    """

    unit: str
    meaning: str
    requires: tuple[str, ...] = ()
    evaluate: Callable[[SmallVibration], Floats]


_LOADED = ("normal_load", "decay_length")

OBSERVABLES: Mapping[str, Observable] = MappingProxyType(
    {
        "electrical_resonance": Observable(
            unit="Hz",
            meaning="Natural frequency, drive short-circuited, of the mode that draws the most current: peak of the"
            " conductance",
            evaluate=lambda vibration: vibration.resonance,
        ),
        "electrical_antiresonance": Observable(
            unit="Hz",
            meaning="Natural frequency of the same mode with the drive open: peak of the resistance",
            evaluate=lambda vibration: vibration.antiresonance,
        ),
        "effective_coupling_factor": Observable(
            unit="",
            meaning="Effective coupling factor of the same mode, k^2 = 1 - (resonance/antiresonance)^2",
            evaluate=lambda vibration: np.sqrt(1 - (vibration.resonance / vibration.antiresonance) ** 2),
        ),
        "resonance_quality_factor": Observable(
            unit="",
            meaning="Quality factor of the same mode, contact free",
            evaluate=lambda vibration: quality_factor_of(vibration.resonance_pole),
        ),
        "resonance_settling_time": Observable(
            unit="s",
            meaning="Time in which the transient of the same mode decays to 2 %, contact free",
            evaluate=lambda vibration: settling_time_of(vibration.resonance_pole),
        ),
        "amplitude_per_volt": Observable(
            unit="m/V",
            meaning="Amplitude of the contact per volt peak to peak at the drive frequency, contact free",
            requires=("frequency",),
            evaluate=lambda vibration: vibration.contact_amplitude(vibration.driven_motion) / 2,
        ),
        "resonance_amplitude_ratio": Observable(
            unit="",
            meaning="Amplitude of the contact at the drive frequency over that at the electrical resonance",
            requires=("frequency",),
            evaluate=lambda vibration: (
                vibration.contact_amplitude(vibration.driven_motion)
                / vibration.contact_amplitude(vibration.motion_per_volt(vibration.resonance))
            ),
        ),
        "dissipated_power": Observable(
            unit="W",
            meaning="Real electrical power at the drive voltage and frequency, contact free",
            requires=("frequency", "voltage_peak_to_peak"),
            evaluate=lambda vibration: _dissipated_power(vibration),
        ),
        "static_displacement_per_volt": Observable(
            unit="m/V",
            meaning="Displacement of the contact per volt of constant voltage, contact free",
            evaluate=lambda vibration: vibration.static_displacement_per_volt(),
        ),
        "residual_frequency": Observable(
            unit="Hz",
            meaning="Lowest frequency of free vibration on the loaded contact: that of the residual (beat) oscillation",
            requires=_LOADED,
            evaluate=lambda vibration: np.abs(vibration.residual_pole) / (2 * np.pi),
        ),
        "residual_settling_time": Observable(
            unit="s",
            meaning="Time in which the slowest transient on the loaded contact, but that of the driven mode, decays to"
            " 2 %",
            requires=_LOADED,
            evaluate=lambda vibration: vibration.residual_settling_time,
        ),
        "residual_fraction": Observable(
            unit="",
            meaning="Amplitude of the residual oscillation after the observation time, over the initial one",
            requires=(*_LOADED, "observation_time"),
            evaluate=lambda vibration: np.exp(
                vibration.residual_pole.real * vibration.conditions.value("observation_time")
            ),
        ),
    }
)
"""Observables of a structure by name."""

NUMBERED_OBSERVABLES: Mapping[str, Callable[[int], Observable]] = MappingProxyType(
    {
        "natural_frequency": lambda number: Observable(
            unit="Hz",
            meaning=f"Natural frequency {number}, contact free, drive short-circuited, rigid modes not counted",
            evaluate=lambda vibration: vibration.natural_frequency(number),
        ),
        "loaded_natural_frequency": lambda number: Observable(
            unit="Hz",
            meaning=f"Natural frequency {number} on the loaded contact, drive short-circuited, rigid modes not counted",
            requires=_LOADED,
            evaluate=lambda vibration: vibration.natural_frequency(number, loaded=True),
        ),
        "quality_factor": lambda number: Observable(
            unit="",
            meaning=f"Quality factor of natural frequency {number}, contact free",
            evaluate=lambda vibration: vibration.quality_factor(number),
        ),
    }
)
"""Observables of one mode, by the name that its number follows: "natural_frequency_2" is that of the second mode."""


def observable_named(name: str) -> Observable:
    """Observable of a name, of a mode where a number follows the name.

    Parameters
    ----------
    name : str
        A name of `OBSERVABLES`, or one of `NUMBERED_OBSERVABLES` with "_1", "_2" and so on after it.

    Returns
    -------
    Observable

    Raises
    ------
    UnknownName
        If it is none of them.
    """
    if name in OBSERVABLES:
        return OBSERVABLES[name]
    stem, _, number = name.rpartition("_")
    if stem in NUMBERED_OBSERVABLES and number.isascii() and number.isdigit() and len(number) < 4 and int(number) > 0:
        return NUMBERED_OBSERVABLES[stem](int(number))
    known = [*OBSERVABLES, *(f"{stem}_1" for stem in NUMBERED_OBSERVABLES)]
    raise UnknownName.among(known, kind="observable", name=name)


def _dissipated_power(vibration: SmallVibration) -> Floats:
    """Conductance times the square of the voltage amplitude over 2."""
    omega = 2 * np.pi * vibration.conditions.value("frequency")
    conductance = -omega * np.einsum("nk,nk->n", vibration.driven_motion, vibration.matrices.drive_vector).imag
    return np.asarray(conductance * vibration.conditions.value("voltage_peak_to_peak") ** 2 / 8)
