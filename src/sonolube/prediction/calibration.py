"""Calibration: every published rig predicted without its own tests, beside simpler predictions of the same tests."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Final

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.stats import binomtest

from sonolube.checks import Floats
from sonolube.prediction.closures import CLOSURES, Closure
from sonolube.prediction.evidence import TestedRig, published_rigs
from sonolube.prediction.posterior import posteriors_without, published_log_likelihoods
from sonolube.prediction.predictive import ratio_draws
from sonolube.prediction.scores import (
    binomial_interval,
    central_interval,
    continuous_ranked_probability_score,
    interval_score,
)

_DRAWS: Final = 4000
_MEMORY_LENGTHS: Final = (1e-6, 2e-6)  # m, uniform: as examples/rigs/tribometer_uncertain.toml has it
_ROUGHNESS_SPREAD: Final = 0.1  # likewise
_STICK_SLIP: Final = CLOSURES[0]


@dataclass(frozen=True, kw_only=True, slots=True)
class UnseenPrediction:
    """Prediction of one test by the tests on other rigs.

    Parameters
    ----------
    rig : str
        Name of the rig.
    friction_ratio : float
        As measured. []
    uncertainty : float
        Standard uncertainty of that ratio.
    draws : ndarray, shape (draws,)
        Predicted measured ratio: with the uncertainty of the measurement.
    """

    rig: str
    friction_ratio: float
    uncertainty: float
    draws: Floats


@dataclass(frozen=True, kw_only=True, slots=True)
class Calibration:
    """Scores of one way to predict all tests unseen.

    Parameters
    ----------
    name : str
    predictions : tuple of UnseenPrediction
    """

    name: str
    predictions: tuple[UnseenPrediction, ...]

    def covered(self, probability: float) -> int:
        """Number of tests within the central interval of a probability."""
        return sum(
            bool(low <= one.friction_ratio <= high)
            for one in self.predictions
            for low, high in [central_interval(one.draws, probability)]
        )

    def coverage_interval(self, probability: float) -> tuple[float, float]:
        """95 % binomial interval of the coverage."""
        return binomial_interval(self.covered(probability), len(self.predictions))

    def p_value(self, probability: float) -> float:
        """Two-sided probability of such a coverage or a worse one, if the intervals are right."""
        return float(binomtest(self.covered(probability), len(self.predictions), probability).pvalue)

    @property
    def crps(self) -> float:
        """Mean continuous ranked probability score. []"""
        return float(
            np.mean([continuous_ranked_probability_score(one.draws, one.friction_ratio) for one in self.predictions])
        )

    @property
    def interval_score(self) -> float:
        """Mean interval score of the 80 % intervals. []"""
        return float(np.mean([interval_score(one.draws, one.friction_ratio) for one in self.predictions]))

    @property
    def median_width(self) -> float:
        """Median width of the 80 % intervals. []"""
        return float(np.median([np.subtract(*central_interval(one.draws, 0.8)[::-1]) for one in self.predictions]))


@cache
def calibrations() -> tuple[Calibration, ...]:
    """Calibration of this room's prediction, and of the simpler ones, on the published rigs.

    Returns
    -------
    tuple of Calibration
        The hierarchical model; the mean ratio of the other rigs with its
        scatter; one model fitted to the other rigs with its leave-one-rig-out residual; the uncertainty of the inputs
        alone.
    """
    rigs = published_rigs()
    rivals: Mapping[str, Callable[[Sequence[TestedRig], TestedRig, np.random.Generator], Floats]] = {
        "mean ratio with its scatter": _mean_ratio,
        "one model with its unseen residual": _single_model,
        "uncertainty of the inputs alone": _inputs_alone,
    }
    return (
        hierarchical_calibration("hierarchical model", CLOSURES),
        *(
            Calibration(name=name, predictions=tuple(p for rig in rigs for p in _unseen(rig, _by(rival, rigs, rig))))
            for name, rival in rivals.items()
        ),
    )


def hierarchical_calibration(name: str, closures: tuple[Closure, ...]) -> Calibration:
    """Every published rig left out in turn: hyperparameters and weights by the others alone.

    Parameters
    ----------
    name : str
    closures : tuple of Closure

    Returns
    -------
    Calibration
    """
    predictions: list[UnseenPrediction] = []
    for index, rig in enumerate(published_rigs()):
        posteriors = posteriors_without(published_log_likelihoods(), left_out=(index,), closures=closures)
        predictions += _unseen(rig, ratio_draws(posteriors, rig.at, count=_DRAWS).friction_ratio)
    return Calibration(name=name, predictions=tuple(predictions))


def _unseen(rig: TestedRig, ratios: Floats) -> list[UnseenPrediction]:
    """Predictions of the tests of a rig, with the uncertainty of each measurement."""
    noise = np.random.default_rng(4).standard_normal(ratios.shape) * rig.uncertainty
    return [
        UnseenPrediction(rig=rig.name, friction_ratio=float(y), uncertainty=float(u), draws=draws)
        for y, u, draws in zip(rig.friction_ratio, rig.uncertainty, (ratios + noise).T, strict=True)
    ]


def _by(
    rival: Callable[[Sequence[TestedRig], TestedRig, np.random.Generator], Floats],
    rigs: Sequence[TestedRig],
    rig: TestedRig,
) -> Floats:
    """Ratios of a rig by a simpler prediction from the others."""
    return rival([each for each in rigs if each is not rig], rig, np.random.default_rng(5))


def _mean_ratio(others: Sequence[TestedRig], rig: TestedRig, rng: np.random.Generator) -> Floats:
    """Normal distribution of the ratios of all other tests."""
    seen = np.concatenate([each.friction_ratio for each in others])
    return rng.normal(seen.mean(), seen.std(ddof=1), (_DRAWS, rig.friction_ratio.size))


def _single_model(others: Sequence[TestedRig], rig: TestedRig, rng: np.random.Generator) -> Floats:
    """Stick-slip with one memory length for all, normal with the rms of its leave-one-rig-out residuals."""
    residuals = [
        _stick_slip(each, _fitted([other for other in others if other is not each])) - each.friction_ratio
        for each in others
    ]
    deviation = float(np.sqrt(np.mean(np.concatenate(residuals) ** 2)))
    ratio = _stick_slip(rig, _fitted(others))
    return ratio + deviation * rng.standard_normal((_DRAWS, ratio.size))


def _inputs_alone(others: Sequence[TestedRig], rig: TestedRig, rng: np.random.Generator) -> Floats:
    """Stick-slip with the distributions of an uncertain rig file, as `sonolube uncertainty` propagates them."""
    factor = np.exp(_ROUGHNESS_SPREAD * rng.standard_normal((_DRAWS, 1)))
    memory_length = rng.uniform(*_MEMORY_LENGTHS, (_DRAWS, 1))
    return _STICK_SLIP.ratio(np.log(memory_length), rig.at.conditions.scaled(decay_length=factor))


def _fitted(rigs: Sequence[TestedRig]) -> float:
    """Logarithm of the memory length that fits tests on several rigs with the least squares."""

    def squares(log_length: float) -> float:
        return float(sum(np.sum((_stick_slip(rig, log_length) - rig.friction_ratio) ** 2) for rig in rigs))

    middle = float(np.log(_STICK_SLIP.median))
    return float(minimize_scalar(squares, bounds=(middle - 2, middle + 2), method="bounded").x)


def _stick_slip(rig: TestedRig, log_length: float) -> Floats:
    """Friction ratios of a rig by stick-slip with a memory length."""
    return _STICK_SLIP.ratio(log_length, rig.at.conditions)
