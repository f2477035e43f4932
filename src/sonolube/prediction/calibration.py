"""Calibration: every published rig predicted without its own tests, beside simpler predictions of the same tests."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.prediction.evidence import CLOSURES, TestedRig, published_rigs, rigs_by_records
from sonolube.prediction.hierarchy import Prior, central_interval, continuous_ranked_probability_score, interval_score
from sonolube.prediction.posterior import Population, Posterior, published_population
from sonolube.prediction.predictive import ratio_draws
from sonolube.prediction.within_plane import PlanePopulation, plane_population

BLIND: Final = "decay length unknown"
"""Name of the way that predicts: nothing enters that a user would not have before a test."""

MEAN_RATIO: Final = "mean ratio with its scatter"
"""Name of the simplest way: the ratios of all other tests."""

BY_RECORDS: Final = "decay length by records"
"""Name of the way with roughness as in the records, which no user has before a test."""

SAME_TRIBOMETER: Final = (("A", "C", "D", "E", "F"), ("B",), ("G",), ("H",), ("P",))
"""Sets by the rig that they were measured on."""

_RECORD_PRIOR: Final = Prior(length_factor=(1.0, 0.5), length_spread=(0.1, 1e-3))
_DRAWS: Final = 4000
_RESAMPLED: Final = 10_000  # sets, of the bootstrap
_MEMORY_LENGTHS: Final = (1e-6, 2e-6)  # m, uniform: as examples/rigs/tribometer_uncertain.toml has it
_ROUGHNESS_SPREAD: Final = 0.1  # likewise
_STICK_SLIP: Final = CLOSURES[0]
_Rival = Callable[[Sequence[TestedRig], TestedRig, np.random.Generator], Floats]


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

    def covered_by_rig(self, probability: float) -> dict[str, tuple[int, int]]:
        """Number of tests of each rig within the central interval of a probability, and of all its tests."""
        found = {}
        for name in dict.fromkeys(one.rig for one in self.predictions):
            own = Calibration(name=name, predictions=tuple(one for one in self.predictions if one.rig == name))
            found[name] = own.covered(probability), len(own.predictions)
        return found

    def rigs_covered(self, probability: float) -> int:
        """Number of rigs all of whose tests lie within."""
        return sum(inside == count for inside, count in self.covered_by_rig(probability).values())

    def of_rigs(self, some: Callable[[str], bool]) -> "Calibration":
        """Calibration of the tests of some rigs, by their names."""
        return replace(self, predictions=tuple(one for one in self.predictions if some(one.rig)))

    @property
    def scores(self) -> Floats:
        """Continuous ranked probability score of each test. []"""
        return np.array(
            [continuous_ranked_probability_score(one.draws, one.friction_ratio) for one in self.predictions]
        )

    @property
    def crps(self) -> float:
        """Mean continuous ranked probability score. []"""
        return float(np.mean(self.scores))

    @property
    def rigs(self) -> int:
        """Number of rigs whose tests were predicted."""
        return len({one.rig for one in self.predictions})

    @property
    def crps_by_rig(self) -> float:
        """Mean over rigs of the mean continuous ranked probability score of each. []"""
        names = np.array([one.rig for one in self.predictions])
        return float(np.mean([self.scores[names == name].mean() for name in np.unique(names)]))

    @property
    def interval_score(self) -> float:
        """Mean interval score of the 80 % intervals. []"""
        return float(np.mean([interval_score(one.draws, one.friction_ratio) for one in self.predictions]))

    @property
    def median_width(self) -> float:
        """Median width of the 80 % interval. []"""
        return float(np.median([np.subtract(*central_interval(one.draws, 0.8)[::-1]) for one in self.predictions]))

    def gain_over(self, rival: "Calibration") -> tuple[float, float, float]:
        """Fall of the mean CRPS against a rival, and its 95 % interval by bootstrap over sets.

        Parameters
        ----------
        rival : Calibration
            Of the same tests in the same order.

        Returns
        -------
        gain, low, high : float
            Positive where this way is better. []
        """
        falls = rival.scores - self.scores
        names = [one.rig for one in self.predictions]
        sets = sorted(set(names))
        sums = np.array([sum(fall for fall, name in zip(falls, names, strict=True) if name == each) for each in sets])
        counts = np.array([names.count(each) for each in sets])
        chosen = np.random.default_rng(0).integers(0, len(sets), (_RESAMPLED, len(sets)))
        low, high = np.quantile(sums[chosen].sum(axis=1) / counts[chosen].sum(axis=1), [0.025, 0.975])
        return float(falls.mean()), float(low), float(high)


@cache
def calibrations() -> tuple[Calibration, ...]:
    """Blind calibration of this room's prediction, of simpler ones, and of one by records, on the published rigs.

    Returns
    -------
    tuple of Calibration
        The prediction as a user gets it, `BLIND`; the mean ratio of the other rigs with its scatter; what follows rests
        on the roughness of the records: the same prediction, one model fitted to the other rigs with its
        leave-one-rig-out residual, and the uncertainty of the inputs alone.
    """
    records = rigs_by_records()
    rivals: Mapping[str, _Rival] = {
        "one model by records, its residual": _single_model,
        "uncertain inputs by records alone": _inputs_alone,
    }
    return (
        blind_calibration(),
        mean_ratio_calibration(),
        population_calibration(BY_RECORDS, Population.of(_STICK_SLIP, records, prior=_RECORD_PRIOR), records),
        *(_rival_calibration(name, rival, records) for name, rival in rivals.items()),
    )


@cache
def blind_calibration(groups: tuple[tuple[str, ...], ...] = ()) -> Calibration:
    """Calibration of the prediction with nothing that a user would not have before a test."""
    return population_calibration(BLIND, published_population(), published_rigs(), groups=groups)


def plane_calibration(population: PlanePopulation | None = None) -> Calibration:
    """Calibration within the plane of contact, by default of the shipped tests.

    Each rig by the others there and those along the normal.
    """
    known = population or plane_population()
    predictions = [
        one
        for place, rig in enumerate(known.rigs)
        for one in unseen_predictions(rig, ratio_draws(known.posterior(without=(place,)), rig.at, count=_DRAWS))
    ]
    return Calibration(name="within the plane", predictions=tuple(predictions))


def mean_ratio_calibration(
    groups: tuple[tuple[str, ...], ...] = (), *, rigs: Sequence[TestedRig] | None = None
) -> Calibration:
    """Calibration of the mean ratio of the other tests with its scatter, by default of the shipped tests.

    Groups are as in `blind_calibration`.
    """
    return _rival_calibration(MEAN_RATIO, _mean_ratio, published_rigs() if rigs is None else rigs, groups=groups)


def population_calibration(
    name: str, population: Population, rigs: Sequence[TestedRig], *, groups: tuple[tuple[str, ...], ...] = ()
) -> Calibration:
    """Every rig left out in turn, with what was learned from the others alone."""
    predictions: list[UnseenPrediction] = []
    for group in groups or tuple((rig.name,) for rig in rigs):
        places = tuple(place for place, rig in enumerate(rigs) if rig.name in group)
        posterior = population.posterior(without=places)
        for place in places:
            predictions += unseen_predictions(rigs[place], ratio_draws(posterior, rigs[place].at, count=_DRAWS))
    return _in_order(name, predictions, rigs)


def prediction_of_others(posterior: Posterior, rigs: Sequence[TestedRig], *, name: str = "") -> Calibration:
    """Calibration of rigs that a posterior was not learned from."""
    found = [one for rig in rigs for one in unseen_predictions(rig, ratio_draws(posterior, rig.at, count=_DRAWS))]
    return Calibration(name=name, predictions=tuple(found))


def _rival_calibration(
    name: str, rival: _Rival, rigs: Sequence[TestedRig], *, groups: tuple[tuple[str, ...], ...] = ()
) -> Calibration:
    """Calibration of a simpler way."""
    predictions: list[UnseenPrediction] = []
    for group in groups or tuple((rig.name,) for rig in rigs):
        others = [rig for rig in rigs if rig.name not in group]
        for rig in rigs:
            if rig.name in group:
                predictions += unseen_predictions(rig, rival(others, rig, np.random.default_rng(5)))
    return _in_order(name, predictions, rigs)


def _in_order(name: str, predictions: Sequence[UnseenPrediction], rigs: Sequence[TestedRig]) -> Calibration:
    """Calibration with its predictions in the order of the rigs."""
    places = {rig.name: place for place, rig in enumerate(rigs)}
    return Calibration(name=name, predictions=tuple(sorted(predictions, key=lambda one: places[one.rig])))


def unseen_predictions(rig: TestedRig, ratios: Floats) -> list[UnseenPrediction]:
    """Predictions of the tests of a rig by draws of their ratios, with the uncertainty of each measurement.

    `ratios` has shape (draws, n).
    """
    noise = np.random.default_rng(4).standard_normal(ratios.shape) * rig.uncertainty
    return [
        UnseenPrediction(rig=rig.name, friction_ratio=float(y), uncertainty=float(u), draws=draws)
        for y, u, draws in zip(rig.friction_ratio, rig.uncertainty, (ratios + noise).T, strict=True)
    ]


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

    from scipy.optimize import minimize_scalar

    middle = float(np.log(_STICK_SLIP.median))
    return float(minimize_scalar(squares, bounds=(middle - 2, middle + 2), method="bounded").x)


def _stick_slip(rig: TestedRig, log_length: float) -> Floats:
    """Friction ratios of a rig by stick-slip with a memory length."""
    return _STICK_SLIP.ratio(log_length, rig.at.conditions)
