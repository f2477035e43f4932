"""One law for all directions: asperities on exponential heights with a latent decay length and a latent slip length.

An asperity pressed by delta slips after mu C delta along the sliding (Mindlin). On exponential heights with the decay
length l the mean slip length is s = mu C l, which along the normal is the memory length of asperity stick-slip and
within the plane the slip length of springs on exponential heights. Of rig r, with phi in place of mu C,

    ln phi_r ~ N(mu, tau^2),    ln l_r ~ N(ln l_0 + kappa, tau_l^2),    s_r = phi_r l_r,

and the errors of amplitudes, discrepancy and errors of measurement are as in `sonolube.prediction.hierarchy`. The prior
of phi has the median 0.36 of metals within a factor of e, as that of the slip length that ships.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import log
from typing import Final

import numpy as np

from sonolube.checks import Floats
from sonolube.prediction.calibration import UnseenPrediction, unseen_predictions
from sonolube.prediction.evidence import CLOSURES, REFERENCE_DECAY_LENGTH, TestedRig, UncertainConditions
from sonolube.prediction.hierarchy import (
    HYPERPARAMETERS,
    OWN_DEVIATES,
    POPULATION_PRIOR,
    OwnParameters,
    Prior,
    log_discrepancy_scale,
    standard_normals,
)
from sonolube.prediction.posterior import Posterior, RigDraws
from sonolube.prediction.predictive import RigPrediction, ratio_draws
from sonolube.prediction.within_plane import MINDLIN_SLIP_LENGTH, SPRINGS, PlaneConditions

SLIP_RATIO: Final = MINDLIN_SLIP_LENGTH / REFERENCE_DECAY_LENGTH
"""Slip length over decay length, mu C, of metals. []"""

DRAWS: Final = 32768
"""Draws from the prior that are weighed."""

_STICK_SLIP: Final = CLOSURES[0]
_NODES: Final = 64  # of the integral over what one rig has of its own
_AT_ONCE: Final = 1024  # draws, to bound memory
_PREDICTED: Final = 4000  # outcomes of a prediction


@dataclass(frozen=True, kw_only=True, slots=True)
class JointLaw:
    """Variant of the law.

    Parameters
    ----------
    prior : Prior
        Of what is common to all rigs but phi.
    is_one_slip : bool
        Whether the memory length along the normal is the slip length; else it has the prior that ships, and the decay
        lengths learned along the normal alone tell of slip lengths.
    """

    prior: Prior = POPULATION_PRIOR
    is_one_slip: bool = True

    def draws(self, count: int = DRAWS) -> Floats:
        """Draws from the prior, shape (count, 7): hyperparameters with ln phi first, and the memory length."""
        means, deviations = self.prior.of(replace(_STICK_SLIP, median=SLIP_RATIO, spread=1.0))
        normals = standard_normals(count, columns=len(HYPERPARAMETERS) + 1, seed=2)
        memory = log(_STICK_SLIP.median) + _STICK_SLIP.spread * normals[:, 6]
        return np.column_stack([means + deviations * normals[:, :6], memory])

    def rig_draws(self, rows: Floats, deviates: Floats, rig: TestedRig, *, conditioned: bool) -> RigDraws:
        """Draws for a rig in its direction, one a row, conditioned on its tests or before them."""
        own = rig if conditioned else None
        places = np.arange(len(rows))
        if isinstance(rig.at.conditions, PlaneConditions):
            return RigDraws(Posterior(closure=SPRINGS, hyperparameters=plane_rows(rows)), rig.at, places, deviates, own)
        if not self.is_one_slip:
            along = rows[:, :6].copy()
            along[:, 0] = rows[:, 6]
            return RigDraws(Posterior(closure=_STICK_SLIP, hyperparameters=along), rig.at, places, deviates, own)
        posterior = Posterior(closure=_STICK_SLIP, hyperparameters=rows[:, :6])
        return _OneSlipDraws(posterior, rig.at, places, deviates, own)


def plane_rows(rows: Floats) -> Floats:
    """Hyperparameters of the slip length: of one rig ln s_r is normal about mu + kappa + ln l_0, shape (h, 6)."""
    found = rows[:, :6].copy()
    found[:, 0] = rows[:, 0] + rows[:, 1] + log(REFERENCE_DECAY_LENGTH)
    found[:, 2] = 0.5 * np.logaddexp(2 * rows[:, 2], 2 * rows[:, 3])
    return found


class SharedLength(OwnParameters):
    """Parameters of a rig along the normal whose memory length is its slip length phi l."""

    def __init__(self, hyperparameters: Floats, deviates: Floats, at: UncertainConditions) -> None:
        mu, kappa, tau, tau_l, sigma, _ = np.moveaxis(hyperparameters, -1, 0)
        scatter, error = np.exp(tau_l), at.amplitude_spread
        both = np.hypot(scatter, error)
        deviate = deviates[..., 1]
        self.log_factor = at.log_length_factor(length_factor=kappa, length_spread=tau_l, deviates=deviate)
        # ln l given the logarithm of l over the amplitude, of which the error of the amplitude is a part
        length = kappa + scatter**2 / both * deviate
        rest = np.hypot(np.exp(tau), scatter * error / both)
        self.log_parameter = np.asarray(mu + log(REFERENCE_DECAY_LENGTH) + length + rest * deviates[..., 0])
        self.log_discrepancy = np.asarray(sigma + log_discrepancy_scale(deviates[..., 2]))


@dataclass(frozen=True, slots=True, eq=False)
class _OneSlipDraws(RigDraws):
    """Draws of a rig along the normal whose memory length is its slip length."""

    @property
    def parameters(self) -> OwnParameters:
        """Parameters of each draw."""
        return SharedLength(self.hyperparameters, self.deviates, self.at)


@dataclass(frozen=True, kw_only=True, eq=False)
class JointPopulation:
    """Draws from the prior of a law with the likelihoods of rigs in all directions.

    Parameters
    ----------
    law : JointLaw
    rigs : tuple of TestedRig
    """

    law: JointLaw
    rigs: tuple[TestedRig, ...]

    @cached_property
    def draws(self) -> Floats:
        """Draws from the prior."""
        return self.law.draws()

    @cached_property
    def log_likelihoods(self) -> Floats:
        """Logarithm of the likelihood of each rig by each draw, shape (h, r)."""
        return np.column_stack([self._log_likelihood(rig) for rig in self.rigs])

    def _log_likelihood(self, rig: TestedRig) -> Floats:
        """Logarithm of the likelihood of a rig, over what it has of its own."""
        nodes = standard_normals(_NODES, columns=OWN_DEVIATES, seed=1)
        found = []
        for start in range(0, len(self.draws), _AT_ONCE):
            some = self.draws[start : start + _AT_ONCE]
            rows, deviates = np.repeat(some, _NODES, axis=0), np.tile(nodes, (len(some), 1))
            drawn = self.law.rig_draws(rows, deviates, rig, conditioned=True)
            found.append(np.logaddexp.reduce(drawn.log_density().reshape(-1, _NODES), axis=1) - np.log(_NODES))
        return np.concatenate(found)

    def log_weights(self, *, without: Sequence[int] = ()) -> Floats:
        """Logarithm of the weight of each draw by all rigs but some."""
        return np.asarray(np.delete(self.log_likelihoods, without, axis=1).sum(axis=1))

    def effective_draws(self) -> float:
        """Effective number of the draws by all rigs. []"""
        logs = self.log_weights()
        return float(np.exp(2 * np.logaddexp.reduce(logs) - np.logaddexp.reduce(2 * logs)))

    def unseen(self, place: int) -> list[UnseenPrediction]:
        """Predictions of the tests of a rig by those on all other rigs."""
        rig, logs = self.rigs[place], self.log_weights(without=(place,))
        shares = np.exp(logs - np.logaddexp.reduce(logs))
        rows = self.draws[np.random.default_rng(0).choice(len(shares), size=_PREDICTED, p=shares)]
        if isinstance(rig.at.conditions, PlaneConditions):
            posterior = Posterior(closure=SPRINGS, hyperparameters=plane_rows(rows))
            return unseen_predictions(rig, ratio_draws(posterior, rig.at, count=_PREDICTED))
        deviates = standard_normals(_PREDICTED, columns=OWN_DEVIATES, seed=3)
        drawn = self.law.rig_draws(rows, deviates, rig, conditioned=False)
        found = RigPrediction(draws=drawn, check=None, count=_PREDICTED)
        return unseen_predictions(rig, found.ratios(rig.at.conditions))
