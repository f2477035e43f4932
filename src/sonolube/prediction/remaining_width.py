"""Expected width of a predictive interval after a further measurement: one run, the contact stiffness, an input."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.prediction.closures import Conditions
from sonolube.prediction.hierarchy import discrepancy_correlation
from sonolube.prediction.inputs import RigInputs
from sonolube.prediction.predictive import RigPrediction
from sonolube.prediction.scores import central_interval
from sonolube.prediction.stiffness_probes import Probe
from sonolube.text.units import format_si

KNOWN_WELL: Final = {"decay_length": 0.1, "vibration_amplitude": 0.02, "friction_coefficient": 0.03}
"""Standard deviation of the logarithm of each uncertain input after a careful measurement."""

_OUTCOMES: Final = 24  # of a measurement, over which the width is averaged
_PROBABILITIES: Final = (np.arange(_OUTCOMES) + 0.5) / _OUTCOMES
_RUN: Final = 0.05  # standard uncertainty of the ratio of one run
_FARTHER: Final = 2.0  # speed of the other point over that of the rig
_STIFFNESS: Final = (0.3, 0.1)  # standard deviations of the logarithm of a measured contact stiffness
_TAILS: Final = np.array([0.1, 0.9])  # probabilities of the ends of the interval
_NARROWEST: Final = 1e-6


@dataclass(frozen=True, kw_only=True, slots=True)
class Measure:
    """A measurement that would narrow a prediction.

    Parameters
    ----------
    label : str
        In words.
    share_left : float
        Expected width of the 80 % interval of the friction ratio after it, over the width now.
    """

    label: str
    share_left: float


def own_logarithms(found: RigPrediction, *, intrinsic: Floats, seed: int) -> dict[str, Floats]:
    """Draws of the uncertain inputs of a rig as logarithms by their names, row by row those of the friction ratio.

    Decay length and amplitude, as factors on their medians, are split from their ratio, on which friction depends.
    """
    draws = found.draws
    at, rows = draws.at, np.arange(found.count) % draws.rows.size
    if at.decay_length_spread is None:
        middle, scatter = draws.hyperparameters[rows, 1], np.exp(draws.hyperparameters[rows, 3])
    else:
        middle, scatter = np.zeros(found.count), np.full(found.count, at.decay_length_spread)
    both = np.hypot(scatter, at.amplitude_spread)
    deviate = draws.deviates[rows, 1]
    fresh = np.random.default_rng(seed + 7).standard_normal(found.count)
    amplitude = at.amplitude_spread / both * (-at.amplitude_spread * deviate + scatter * fresh)
    length = middle + both * deviate + amplitude
    return {"decay_length": length, "vibration_amplitude": amplitude, "friction_coefficient": np.log(intrinsic)}


class Target:
    """Draws of a predicted quantity, sorted once for all measurements that may narrow their 80 % interval.

    Parameters
    ----------
    draws : ndarray, shape (draws,)
    """

    def __init__(self, draws: Floats) -> None:
        self._order = np.argsort(draws)
        self._values = draws[self._order]
        low, high = central_interval(draws, 0.8)
        self._width = max(float(high - low), _NARROWEST)

    def share_left(self, *, observed: Floats, noise: float) -> float:
        """Expected width of the interval after a measurement over that now, at most 1.

        Draws are weighed by the normal density of each of 24 evenly probable outcomes of the measurement.
        """
        outcomes = np.quantile(observed + noise * _deviates(observed.size), _PROBABILITIES)
        deviations = outcomes[:, None] / noise - observed[self._order] / noise
        logs = np.multiply(deviations, -0.5 * deviations, out=deviations)
        logs -= logs.max(axis=1, keepdims=True)
        cumulative = np.cumsum(np.exp(logs, out=logs), axis=1, out=logs)
        ends = [each.searchsorted(each[-1] * _TAILS) for each in cumulative]
        low, high = self._values[np.minimum(ends, self._values.size - 1)].T
        return min(float(np.mean(high - low)) / self._width, 1.0)


@lru_cache(maxsize=4)
def _deviates(count: int) -> Floats:
    """Standard normal errors of a measurement, the same for all."""
    return np.random.default_rng(8).standard_normal(count)


def measures(
    found: RigPrediction, inputs: RigInputs, *, ratio: Floats, probes: Sequence[Probe], seed: int
) -> tuple[Measure, ...]:
    """Measurements that would narrow the prediction at the operating point: a run first, then the contact stiffness."""
    near, far = _two_points(found, inputs)
    narrowed = Target(near)
    made = [
        Measure(label="one run at this point", share_left=narrowed.share_left(observed=near, noise=_RUN)),
        Measure(
            label=f"one run at this point, for the ratio at {_FARTHER:g} times the speed",
            share_left=Target(far).share_left(observed=near, noise=_RUN),
        ),
    ]
    if not inputs.measured_length:
        length = own_logarithms(found, intrinsic=np.ones(found.count), seed=seed)["decay_length"]
        made += _stiffness_measures(ratio, length, probes)
    return tuple(made)


def _stiffness_measures(ratio: Floats, length: Floats, probes: Sequence[Probe]) -> list[Measure]:
    """Share of the width that a stiffness by each resonance would leave; two uncertainties where none shows it."""
    made, target = [], Target(ratio)
    for probe in probes:
        if not probe.resolvable.any():
            continue
        deviation = float(np.mean(probe.log_stiffness_deviation[probe.resolvable]))
        low, high = (format_si(float(each), "Hz", digits=3) for each in np.sort(probe.pressed_frequency)[[0, -1]])
        told = float(np.mean(probe.resolvable))  # share of contacts of which the shift tells
        left = told * target.share_left(observed=length, noise=deviation) + 1 - told
        label = f"contact stiffness by the {probe.name} ({low} to {high} when pressed)"
        made.append(Measure(label=label, share_left=left))
    if made:
        return made
    return [
        Measure(
            label=f"contact stiffness within {100 * noise:.0f} %",
            share_left=target.share_left(observed=length, noise=noise),
        )
        for noise in _STIFFNESS
    ]


def _two_points(found: RigPrediction, inputs: RigInputs) -> tuple[Floats, Floats]:
    """Draws of the ratio at the operating point and at a higher speed, the discrepancy correlated between both."""
    speeds = inputs.sliding_speed * np.array([1.0, _FARTHER])
    at: Conditions = inputs.at(sliding_speed=speeds).conditions
    mean, deviation = found.draws.normals(at)
    rows = np.arange(found.count) % len(mean)
    length = found.draws.hyperparameters[:, 5]
    correlation = discrepancy_correlation(at, at, log_length=length)[rows, 0, 1]
    first, other = np.random.default_rng(9).standard_normal((2, found.count))
    second = correlation * first + np.sqrt(1 - correlation**2) * other
    near = mean[rows, 0] + deviation[rows, 0] * first
    return np.maximum(near, 0.0), np.maximum(mean[rows, 1] + deviation[rows, 1] * second, 0.0)
