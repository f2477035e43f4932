"""Wear under vibration by pair of materials: published ratios, their population, and its predictions.

A pair of materials has the wear rate ratio exp(x) under the vibrations of the published wear tests; under any vibration

    ln ratio = w x,    w = u / (u + k (1 - u)),    u = (1 - R) / (1 - R_t) from 0 to 1,

with the friction ratio R there, by the mean of the friction model, and R_t the largest of those tests. Without an
effect on friction (R = 1) wear is that without vibration; from the smallest friction reduction of the tests on, w is
1: between reductions of 29 and 63 % on one pair the wear reduction stayed between 46 and 49 % (D Table 2.5). In
between nothing was measured. ln k is normal about 0, so that w is uncertain by a factor where it is small and known
at both ends. Its deviation is the difference between two views of that gap: wear that follows the friction, and wear
by the separating half period (D 3.28), which depends on the amplitude alone.
"""

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, require_non_negative, require_positive, require_within
from sonolube.errors import InvalidInput, UnknownName
from sonolube.facts.published import si_value

WEAR_HYPERPARAMETERS: Final = ("wear_rate_ratio", "pair_spread", "test_spread")
"""Their logarithms: mean M of ln ratio over pairs, its deviation T between pairs, and s between tests of a pair."""

WEAR_PRIOR: Final = ((np.log(0.7), np.log(0.5), np.log(0.1)), (0.7, 0.7, 0.7))
"""Means and standard deviations of the normal prior of these logarithms."""

_WEIGHT_SPREAD: Final = np.log(5.0)  # of ln k, by which two views of the gap between the tests and no vibration differ
_RIG_SPREAD: Final = 0.3  # of ln ratio between rigs of one pair, of which each published pair has one: an assumption
_NEAR: Final = 0.5  # difference of weights over which a departure of own tests holds
_DEPARTURE: Final = 2.0  # standard deviations beyond which own tests contradict the population


@dataclass(frozen=True, kw_only=True, slots=True)
class WearPair:
    """Wear with vibration over that without, of one pair of materials.

    Parameters
    ----------
    name : str
        Pin on disc.
    wear_rate_ratio : ndarray, shape (n,)
        Of each test. []
    uncertainty : float
        Standard uncertainty of its logarithm as printed.
    source : str
    sides : pair of tuple of str
        Materials or families of either side; any steel stands for any other.
    """

    name: str
    wear_rate_ratio: Floats
    uncertainty: float
    source: str
    sides: tuple[tuple[str, ...], tuple[str, ...]] = ((), ())


@cache
def published_wear() -> tuple[WearPair, ...]:
    """Pairs of materials worn with and without vibration, D sections 2.3 to 2.5.

    For both pairs with a titanium disc D states in words that wear was not reduced; that is a ratio of 1, uncertain.
    """
    text = files("sonolube.prediction").joinpath("published_wear.toml").read_text(encoding="utf-8")
    return tuple(
        WearPair(
            name=entry["name"],
            wear_rate_ratio=np.array([1 - si_value(fact) for fact in entry["wear_reductions"]] or [1.0]),
            uncertainty=entry["uncertainty"],
            source=entry["source"],
            sides=(tuple(entry["pin"]), tuple(entry["disc"])),
        )
        for entry in tomllib.loads(text)["pairs"]
    )


def published_pair(name: str) -> WearPair:
    """Published pair of materials of a name."""
    known = {pair.name: pair for pair in published_wear()}
    if name not in known:
        raise UnknownName.among(known, kind="published pair of materials", name=name)
    return known[name]


def vibration_weight(*, friction_ratio: ArrayLike, seed: int = 0) -> Floats:
    r"""Share of the effect of the published wear tests that a vibration has on wear, w. []

    `friction_ratio` has shape (draws, ...).

    0 for a ratio of 1 and more, 1 for 0.707 and less.

    .. math:: w = \frac{u}{u + k (1 - u)}, \qquad u = \frac{1 - R}{1 - R_t}, \qquad \ln k \sim N(0, \ln^2 5)

    with u limited to 0 to 1, and the smallest friction reduction of the published wear tests,
    :math:`1 - R_t = 0.293`.

    Source: D Table 2.5, at 87 mm/s.
    """
    ratio = require_non_negative(friction_ratio=friction_ratio)
    share = np.clip((1 - ratio) / si_value("table-2.5-friction_reduction-3"), 0.0, 1.0)
    draws = ratio.shape[:1]
    odds = np.exp(_WEIGHT_SPREAD * np.random.default_rng(seed + 2).standard_normal(draws))
    return np.asarray(share / (share + odds.reshape(draws + (1,) * (ratio.ndim - 1)) * (1 - share)))


def log_wear_posterior(hyperparameters: Floats, pairs: tuple[WearPair, ...]) -> Floats:
    r"""Logarithm of the posterior density, but for a constant, of rows of `WEAR_HYPERPARAMETERS`.

    `hyperparameters` has shape (h, 3). Shape (h,).

    The logarithms of the n ratios of a pair are normal about the mean of the pair with the variance s^2 + u^2, and the
    means of pairs about M with T^2, so that those of one pair have the covariance :math:`T^2 + (s^2+u^2)\,\delta_{ij}`.
    """
    mean, between, within = hyperparameters.T
    centres, deviations = np.array(WEAR_PRIOR)
    total = -0.5 * np.sum(((hyperparameters - centres) / deviations) ** 2, axis=1)
    for pair in pairs:
        residual = np.log(pair.wear_rate_ratio) - mean[:, None]
        own, shared, n = np.exp(2 * within) + pair.uncertainty**2, np.exp(2 * between), pair.wear_rate_ratio.size
        alone = np.sum(residual**2, axis=1) / own
        together = shared * np.sum(residual, axis=1) ** 2 / (own * (own + n * shared))
        total += -0.5 * (alone - together + (n - 1) * np.log(own) + np.log(own + n * shared))
    return np.asarray(total)


@dataclass(frozen=True, kw_only=True, slots=True)
class WearPosterior:
    """Draws of the hyperparameters of wear.

    Parameters
    ----------
    hyperparameters : ndarray, shape (h, 3)
        Equally probable: logarithms, in the order of `WEAR_HYPERPARAMETERS`.
    """

    hyperparameters: Floats

    def wear_rate_ratios(
        self,
        count: int,
        *,
        measured: Floats | None = None,
        weight: ArrayLike = 1.0,
        measured_weight: ArrayLike = 1.0,
        pair: str | None = None,
        seed: int = 0,
    ) -> Floats:
        r"""Draws of the mean wear rate ratio of a rig that is none of the published.

        Shape (count,).

        ln ratio is w x, and x normal about M with T^2; after the n tests of a published pair, of mean y and with
        own variance s^2 + u^2, about :math:`M + b (y - M)` with :math:`T^2 (1 - b) + 0.3^2`, where
        :math:`b = n T^2 / (n T^2 + s^2 + u^2)` and 0.3 is the deviation between rigs of one pair. Own tests condition
        it likewise. Where their mean is more than two standard deviations off, the rig is taken to depart from the
        population near its tests, by a normal deviation as large as that asks for.
        """
        weights = _per_draw(count, weight=weight)
        tested_weights = _per_draw(count, measured_weight=measured_weight)
        rng = np.random.default_rng(seed)
        mean, between, within = self.hyperparameters[rng.integers(0, len(self.hyperparameters), count)].T
        shared, own = np.exp(2 * between), np.exp(2 * within)
        if pair is not None:
            mean, shared = _of_pair(published_pair(pair), mean, shared, own)
        centre, variance = weights * mean, weights**2 * shared
        if measured is not None and measured.size:
            logs = np.log(require_positive(wear_rate_ratio=measured))
            off = logs.mean() - tested_weights * mean
            spread = tested_weights**2 * shared + own / logs.size
            departure = np.maximum((off / _DEPARTURE) ** 2 - spread, 0.0)
            near = np.exp(-0.5 * ((weights - tested_weights) / _NEAR) ** 2)
            covariance = weights * tested_weights * shared + departure * near
            gain = covariance / (spread + departure)
            centre = centre + gain * off
            variance = np.maximum(variance + departure - gain * covariance, 0.0)
        return np.asarray(np.exp(centre + np.sqrt(variance) * rng.standard_normal(count)))


def _per_draw(count: int, **weight: ArrayLike) -> Floats:
    """Weights of all draws, from one or from one for each."""
    values = require_within(0.0, 1.0, **weight)
    if values.shape not in ((), (1,), (count,)):
        name = next(iter(weight))
        raise InvalidInput(f"{name} must be one number or one for each of {count} draws, got {values.shape}")
    return np.broadcast_to(values, (count,))


def _of_pair(pair: WearPair, mean: Floats, shared: Floats, own: Floats) -> tuple[Floats, Floats]:
    """Mean and variance of ln ratio of another rig of a published pair, after the tests of that pair."""
    tests = pair.wear_rate_ratio.size
    share = tests * shared / (tests * shared + own + pair.uncertainty**2)
    centre = mean + share * (np.log(pair.wear_rate_ratio).mean() - mean)
    return centre, shared * (1 - share) + _RIG_SPREAD**2
