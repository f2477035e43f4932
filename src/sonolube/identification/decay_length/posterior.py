"""Posterior of the combinations of changes in a run: prior weights, evidence of each, and draws from all together."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np
from scipy.special import logsumexp

from sonolube.checks import Floats
from sonolube.identification.decay_length.conditions import SwitchConditions
from sonolube.identification.decay_length.evidence import Evidence, evidence
from sonolube.identification.decay_length.run_model import PARAMETERS, Changes, Channel, RunModel
from sonolube.identification.decay_length.switch_table import SwitchTable

HYPOTHESES: Final[Mapping[str, str]] = {
    "long_sliding": "long sliding: the decay length grows with the sliding distance",
    "zero_error": "zero error: the zero of the load cell is off",
    "detuning": "detuning: the amplitude at the contact falls during the run",
    "none": "none of them: decay length, zero and amplitude stay, the decay length belongs to the rig",
    "several": "several at once",
    "other": "something else: the friction ratio changes by itself",
}
"""Hypotheses about what sets the decay length by name, each in words."""

_SEVERAL: Final = 0.1  # prior probability of more than one change, shared by four combinations
_OTHER: Final = 0.05  # prior probability that the friction ratio changes by itself
_DRIFT: Final = PARAMETERS.index("drift")
_DISTANCES: Final = tuple(PARAMETERS.index(name) for name in ("growth_distance", "fall_distance", "drift_distance"))
_TURNED: Final = PARAMETERS.index("turned_share")
_STARTS: Final = ((0.0, 0.0), (-2.0, 0.0), (1.0, 1.0), (0.0, -1.0))  # deviates of the distances, and of that share
_COUNT: Final = 4000  # draws from all models together
_MATTERS: Final = 0.01  # posterior probability from which a model matters


@dataclass(frozen=True, slots=True)
class Combination:
    """Which quantities change in a run.

    Parameters
    ----------
    grows, falls, off : bool
        Whether the decay length grows, the amplitude falls, and the zero is off.
    drifts : bool
        Whether the friction ratio changes by itself.
    follows : bool
        Whether the amplitude at large drive falls with that of the vibration.
    """

    grows: bool
    falls: bool
    off: bool
    drifts: bool
    follows: bool

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the hypotheses whose changes it has."""
        flags = {"long_sliding": self.grows, "zero_error": self.off, "detuning": self.falls, "other": self.drifts}
        return tuple(name for name, flag in flags.items() if flag)

    @property
    def hypothesis(self) -> str:
        """Name of the hypothesis that it belongs to."""
        parts = self.parts
        return "none" if not parts else parts[0] if len(parts) == 1 else "several"

    @property
    def prior(self) -> float:
        """Prior probability."""
        alone = _OTHER if self.drifts else (1 - _SEVERAL - _OTHER) / 4
        own = _SEVERAL / 4 if len(self.parts) > 1 else alone
        return own / 2 if self.falls else own

    @property
    def changes(self) -> Changes:
        """Changes on which the readings beside the zero depend."""
        return Changes(self.grows, self.falls, self.drifts, self.follows)


COMBINATIONS: Final = (
    *(
        Combination(grows, falls, off, False, follows)
        for grows, falls, off, follows in product((False, True), repeat=4)
        if falls or follows
    ),
    Combination(False, False, False, True, True),
)
"""All combinations of changes; where the amplitude does not fall, that at large drive follows it by convention."""


class RunPosterior:
    """Evidence of every combination, with the posterior draws of their parameters.

    Parameters
    ----------
    table : SwitchTable
    conditions : SwitchConditions
    channels : tuple of Channel
    zero_log_ratio : float
        Logarithm of the evidence of a zero that is off over that of a good one.
    seed : int
        Of the random numbers.
    """

    def __init__(
        self,
        table: SwitchTable,
        conditions: SwitchConditions,
        *,
        channels: tuple[Channel, ...],
        zero_log_ratio: float,
        seed: int,
    ) -> None:
        self._seed = seed
        self.models: dict[Changes, tuple[RunModel, Evidence]] = {}
        for each in COMBINATIONS:
            if each.changes not in self.models:
                model = RunModel(table, conditions, each.changes, channels=channels)
                self.models[each.changes] = model, evidence(model.residuals, starts=_starts(), seed=seed)
        logs = np.array(
            [
                np.log(each.prior) + self._log_evidence(each) + (zero_log_ratio if each.off else 0.0)
                for each in COMBINATIONS
            ]
        )
        self.weights: Mapping[Combination, float] = dict(
            zip(COMBINATIONS, np.exp(logs - logsumexp(logs)).tolist(), strict=True)
        )

    def fit_of(self, combination: Combination) -> tuple[RunModel, Evidence]:
        """Model of a combination with its evidence."""
        return self.models[combination.changes]

    def _log_evidence(self, combination: Combination) -> float:
        """Logarithm of the evidence; a friction ratio that changes by itself has a moment prior."""
        found = self.fit_of(combination)[1]
        moment = float(found.weights @ found.draws[:, _DRIFT] ** 2) if combination.drifts else 1.0
        return found.log_evidence + float(np.log(moment))

    @property
    def probabilities(self) -> dict[str, float]:
        """Posterior probability of each hypothesis."""
        found = dict.fromkeys(HYPOTHESES, 0.0)
        for combination, weight in self.weights.items():
            found[combination.hypothesis] += weight
        return found

    def best(self, hypothesis: str) -> Combination:
        """Most probable combination of a hypothesis."""
        return max((each for each in COMBINATIONS if each.hypothesis == hypothesis), key=self.weights.__getitem__)

    @property
    def effective_draws(self) -> float:
        """Least number of effective draws of a model whose posterior probability is at least 0.01."""
        return min(self.fit_of(each)[1].effective_draws for each, weight in self.weights.items() if weight >= _MATTERS)

    def draws(self) -> tuple[Floats, Floats]:
        """Decay length and amplitude at each switch, shape (n, switches) each, drawn from all combinations."""
        rng = np.random.default_rng(self._seed)
        shares = dict.fromkeys(self.models, 0.0)
        for each, weight in self.weights.items():
            shares[each.changes] += weight
        lengths, amplitudes = [], []
        for changes, share in shares.items():
            model, found = self.models[changes]
            rows = rng.choice(len(found.weights), size=round(share * _COUNT), p=found.weights)
            length, amplitude = model.courses(found.draws[rows])
            lengths.append(length)
            amplitudes.append(amplitude)
        return np.concatenate(lengths), np.concatenate(amplitudes)


def _starts() -> Floats:
    """Deviates from which modes are sought, a row each."""
    starts = np.zeros((len(_STARTS), len(PARAMETERS)))
    for row, (distances, turned) in zip(starts, _STARTS, strict=True):
        row[list(_DISTANCES)], row[_TURNED] = distances, turned
    return starts
