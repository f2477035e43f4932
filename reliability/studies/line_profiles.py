"""Random line profiles, whose parameters are computed a second time and known in closed form."""

import math
from collections.abc import Sequence

import numpy as np

from reliability.study import Measure, Record, Study
from sonolube.checks import Floats
from sonolube.models.surfaces import evaluate_profile

_ALPHA = math.sqrt(math.log(2) / math.pi)


def _trial(seed: int) -> Record:
    rng = np.random.default_rng(seed)
    cutoff = float(rng.choice([0.08e-3, 0.25e-3, 0.8e-3]))
    spacing = cutoff / rng.uniform(400, 1600)
    amplitude = 10 ** rng.uniform(-8, -5)
    wavelength = cutoff / rng.uniform(6, 16)
    x = spacing * np.arange(math.ceil(rng.uniform(6.2, 9) * cutoff / spacing))
    sine = amplitude * np.sin(2 * math.pi * x / wavelength + rng.uniform(0, 6.3))
    tilt = rng.uniform(-0.02, 0.02) * x + rng.uniform(-1e-3, 1e-3)
    pure = evaluate_profile(height=sine + tilt, spacing=spacing, long_cutoff_length=cutoff)
    passed = amplitude * (1 - math.exp(-math.pi * (_ALPHA * cutoff / wavelength) ** 2))
    sine_error = max(
        abs(pure.parameters.arithmetic_mean_height / (2 * passed / math.pi) - 1),
        abs(pure.parameters.rms_height / (passed / math.sqrt(2)) - 1),
        abs((pure.parameters.mean_profile_element_spacing or 0.0) / wavelength - 1),
    )
    noisy = sine + tilt + rng.uniform(0.01, 0.5) * amplitude * rng.standard_normal(x.size)
    found = evaluate_profile(height=noisy, spacing=spacing, long_cutoff_length=cutoff)
    again = _second(noisy, spacing, cutoff)
    names = ("arithmetic_mean_height", "rms_height", "mean_section_height", "total_height", "kurtosis")
    second_error = max(abs(getattr(found.parameters, name) / again[name] - 1) for name in names)
    return {"sine": float(sine_error), "second": float(second_error)}


def _second(height: Floats, spacing: float, cutoff: float) -> dict[str, float]:
    """Parameters by plain sums: least-squares line, Gaussian mean line point by point, five sections in the middle."""
    at = np.arange(height.size)
    z = height - np.polyval(np.polyfit(at, height, 1), at)
    reach = math.ceil(1.6 * cutoff / spacing)
    weight = np.exp(-math.pi * (np.arange(-reach, reach + 1) * spacing / (_ALPHA * cutoff)) ** 2)
    mean_line = np.convolve(z, weight, "same") / np.convolve(np.ones(z.size), weight, "same")
    points = round(5 * cutoff / spacing)
    start = (z.size - points) // 2
    points -= points % 5
    rough = (z - mean_line)[start : start + points]
    rough = rough - rough.mean()
    return {
        "arithmetic_mean_height": float(np.abs(rough).mean()),
        "rms_height": float(rough.std()),
        "mean_section_height": float(np.ptp(rough.reshape(5, -1), axis=1).mean()),
        "total_height": float(np.ptp(rough)),
        "kurtosis": float((rough**4).mean() / rough.var() ** 2),
    }


def _measures(records: Sequence[Record]) -> list[Measure]:
    return [
        _worst(records, "sine", "greatest deviation of Ra, Rq and Rsm of a tilted sine from its closed form", 0.01),
        _worst(
            records, "second", "greatest deviation of Ra, Rq, Rz, Rt and Rku of sine and noise from plain sums", 1e-9
        ),
    ]


def _worst(records: Sequence[Record], key: str, label: str, bar: float) -> Measure:
    worst = max(float(str(record[key])) for record in records)
    return Measure(label=label, value=f"{worst:.2g}", bar=f"{bar:g} at most", holds=worst <= bar)


STUDY = Study(
    title="Parameters of line profiles",
    question="Sines of random height, length, tilt and noise have the parameters of their closed form after the filter"
    " of ISO 16610-21, and those of a second computation by plain sums.",
    sources=(
        "models/surfaces/profile_evaluation.py",
        "models/surfaces/roughness_profile.py",
        "models/surfaces/gaussian_filter.py",
    ),
    trials=1000,
    sample=15,
    trial=_trial,
    measures=_measures,
)
