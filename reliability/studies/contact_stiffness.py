"""Stiffness of a contact by the shift of a resonance, measured blind on virtual rigs with noise and drift."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from reliability import virtual_contact as virtual
from reliability.study import Measure, Record, Study
from sonolube.measurement.contact_stiffness.analysis import measured_contact_stiffness
from sonolube.measurement.contact_stiffness.resonance_spectrum import vibration_spectrum
from sonolube.models.dynamics import Structure

_MASS_DEVIATION = 0.1  # of the logarithm of what the analysis is told over the truth
_AMPLITUDE_DEVIATION = 0.05
_DRIFT = 3e-4  # standard deviation of the relative change of stiffness between both free spectra


def _trial(seed: int) -> Record:
    rng = np.random.default_rng([27, seed])
    is_slow = seed % 2 == 0
    chain = virtual.TRIBOMETER if is_slow else virtual.SONOTRODE
    length = float(np.exp(rng.normal(np.log(1.5e-6), 0.6)))
    k = virtual.LOAD / length
    f = np.linspace(70, 450, 381) if is_slow else np.linspace(21.5e3, 22.9e3, 701)
    noise = float(10 ** rng.uniform(-3.3, -2.0))
    drift, share = float(rng.normal(0, _DRIFT)), float(rng.random())
    amplitude = float(rng.uniform(1.0, 4.0)) * length
    softer = virtual.equivalent_spring(k, amplitude=amplitude, decay_length=length)
    runs = [(0.0, 0.0), (k, share * drift), (0.0, drift), (softer, share * drift)]
    spectra = [
        vibration_spectrum(
            frequency=f,
            response=virtual.noisy(rng, virtual.velocity(chain, f, spring=spring, softening=soft), noise),
            quantity="velocity",
        )
        for spring, soft in runs
    ]
    mass_error = float(np.exp(rng.normal(0, _MASS_DEVIATION)))
    stated = amplitude * float(np.exp(rng.normal(0, _AMPLITUDE_DEVIATION)))
    found = measured_contact_stiffness(
        [spectra[0], spectra[2]],
        spectra[1],
        normal_load=virtual.LOAD,
        structure=_told(chain, mass_error),
        modal_mass_deviation=_MASS_DEVIATION,
        mode_near=153.0 if is_slow else 22.0e3,
        large=spectra[3],
        vibration_amplitude=stated,
        log_amplitude_deviation=_AMPLITUDE_DEVIATION,
    ).stiffness
    estimates = {
        "stiffness": found.normal_stiffness and (found.normal_stiffness, k),
        "ratio": found.decay_length_by_ratio and (found.decay_length_by_ratio, length),
        "both": found.decay_length_combined and (found.decay_length_combined, length),
    }
    scores = {
        name: round(float(np.log(pair[0].median / pair[1]) / pair[0].log_deviation), 3)
        for name, pair in estimates.items()
        if pair
    }
    spreads = {f"{name}_deviation": round(pair[0].log_deviation, 4) for name, pair in estimates.items() if pair}
    return {"slow": is_slow, **scores, **spreads, "finite": _is_finite(found.frequency_shift)}


def _told(chain: virtual.Chain, mass_error: float) -> Structure:
    """Structure as the analysis is told: all masses, dampers and springs off by one factor, so the frequencies hold."""
    mass, damping, stiffness = (mass_error * matrix for matrix in chain.matrices())
    contact = np.zeros(len(mass))
    contact[0] = 1
    return Structure(
        mass_matrix=mass,
        damping_matrix=damping,
        stiffness_matrix=stiffness,
        drive_vector=np.zeros(len(mass)),
        contact_vector=contact,
        clamped_capacitance=1e-9,
    )


def _is_finite(value: float) -> bool:
    return bool(np.isfinite(value))


def _measures(records: Sequence[Record], *, bars: tuple[float, float] = (0.8, 1.2)) -> list[Measure]:
    labels = {
        "stiffness": "standard deviation of error over stated uncertainty, logarithm of the stiffness",
        "ratio": "the same of the decay length by the ratio of shifts",
        "both": "the same of the decay length by both",
    }
    lower, upper = bars
    found = []
    for name, label in labels.items():
        z = np.array([float(str(record[name])) for record in records if name in record])
        value = float(np.std(z, ddof=1))
        held = lower <= value <= upper
        found.append(Measure(label=label, value=f"{value:.3f}", bar=f"{lower:g} to {upper:g}", holds=bool(held)))
        if name == "stiffness":
            mean = float(np.mean(z))
            found.append(
                Measure(label="mean of the first", value=f"{mean:+.3f}", bar="-0.3 to 0.3", holds=abs(mean) < 0.3)
            )
            covered = float(np.mean(np.abs(z) < 1.96))
            bar = "0.9 to 1"
            found.append(
                Measure(label="of its 95 % intervals cover", value=f"{covered:.2f}", bar=bar, holds=covered >= 0.9)
            )
        found.append(Measure(label=f"found of {len(records)}", value=str(z.size)))
        spread = np.median([float(str(record[f"{name}_deviation"])) for record in records if name in record])
        found.append(Measure(label="median stated uncertainty of the logarithm", value=f"{spread:.3f}"))
    return found


def _sample_measures(records: Sequence[Record]) -> list[Measure]:
    return [
        replace(each, holds=True) if each.label.startswith("mean") else each
        for each in _measures(records, bars=(0.3, 2.0))
    ]


STUDY = Study(
    title="Contact stiffness by the shift of a resonance",
    question="Stiffness and decay length err by as much as their uncertainties state, on a slow resonance of quality"
    " factor 4 and on one of 22 kHz of quality factor 360, with noise, drift between both free spectra, a modal mass"
    " known within 10 % and an amplitude known within 5 %.",
    sources=(
        "measurement/contact_stiffness/*.py",
        "models/dynamics/contact_spring.py",
        "measurement/statistics/autocorrelation.py",
    ),
    trials=100,
    sample=8,
    trial=_trial,
    measures=_measures,
    sample_measures=_sample_measures,
)
