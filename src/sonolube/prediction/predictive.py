"""Draws of the friction ratio of a rig from the posterior of the population, and after tests of its own."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.prediction.closures import Conditions, UncertainConditions
from sonolube.prediction.evidence import TestedRig
from sonolube.prediction.hierarchy import standard_normals
from sonolube.prediction.posterior import Posterior
from sonolube.prediction.rig_draws import RigDraws, rig_draws
from sonolube.prediction.run_check import RunCheck, checked_runs, student_weights

DRAWS: Final = 4000
"""Equally probable outcomes of a prediction, where no other number is asked for."""

_BEFORE: Final = 4096  # draws of the population, against which runs are checked
_ROUNDS: Final = 4  # of weighing runs that disagree with the others


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class RigPrediction:
    """Distribution of the friction ratio of one rig at any conditions.

    Parameters
    ----------
    draws : RigDraws
    check : RunCheck or None
        Own runs against the population and against each other; None without runs.
    count : int
        Equally probable outcomes.
    """

    draws: RigDraws
    check: RunCheck | None
    count: int

    def ratios(self, at: Conditions) -> Floats:
        """Friction ratios at conditions, equally probable.

        Shape (count, m). Not negative; one normal deviate of the discrepancy a draw, so that curves are smooth.
        """
        mean, deviation = self.draws.normals(at)
        rows = np.arange(self.count) % len(mean)
        fresh = standard_normals(self.count, columns=1, seed=5)
        shuffled = fresh[np.random.default_rng(6).permutation(self.count)]
        return np.maximum(mean[rows] + deviation[rows] * shuffled, 0.0)


def rig_prediction(
    posterior: Posterior, at: UncertainConditions, *, count: int, seed: int = 0, own: TestedRig | None = None
) -> RigPrediction:
    """Distribution of the friction ratio of a rig that is none of those learned from.

    Draws from the population are conditioned on the own tests; the discrepancy follows from its conditional
    distribution. Errors of four or more tests are Student's with 2 degrees of freedom, by weights of each test that
    follow from its deviation from the others (expectation maximisation).

    Source: K. L. Lange, R. J. A. Little and J. M. G. Taylor, J. Am. Stat. Assoc. 84, 881 (1989).
    """
    draws = rig_draws(posterior, at, count=count, seed=seed, own=own)
    if own is None:
        return RigPrediction(draws=draws, check=None, count=count)
    before = rig_draws(posterior, at, count=_BEFORE, seed=seed)
    for _ in range(_ROUNDS):
        weights = student_weights(before, draws, own)
        uncertainty = own.uncertainty / np.sqrt(weights)
        assert draws.own is not None
        if np.allclose(uncertainty, draws.own.uncertainty, rtol=0.1):
            break
        draws = rig_draws(posterior, at, count=count, seed=seed, own=replace(own, uncertainty=uncertainty))
    return RigPrediction(draws=draws, check=checked_runs(before, draws, own), count=count)


def ratio_draws(
    posterior: Posterior, at: UncertainConditions, *, count: int, seed: int = 0, own: TestedRig | None = None
) -> Floats:
    """Draws of the friction ratio of a rig at conditions, shape (count, m), as `rig_prediction` has them."""
    return rig_prediction(posterior, at, count=count, seed=seed, own=own).ratios(at.conditions)
