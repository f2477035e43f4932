"""Chances that a rig reaches a reduction of friction, by the distribution that `predict` has of its friction ratio."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from sonolube.checks import Floats, Integers
from sonolube.errors import InvalidInput
from sonolube.prediction.applicability import applicability
from sonolube.prediction.evidence import Conditions
from sonolube.prediction.evidence_posterior import EvidencePosterior, population_of
from sonolube.prediction.inputs import Input, OwnRuns, RigInputs, intrinsic_draws, own_runs, rig_inputs
from sonolube.prediction.predictive import RigPrediction, rig_prediction
from sonolube.prediction.rig_statement import contradiction_sentence, outlier_caveats
from sonolube.rig import Rig

if TYPE_CHECKING:
    import xarray as xr

_DRAWS: Final = 1000  # each of which has a distribution in closed form
INTERVAL: Final = (0.1, 0.5, 0.9)
"""Levels of the ends of the central 80 % interval, with the median between them."""

_NEAR_A_TENTH: Final = 0.015
_AT_ONCE: Final = 512  # conditions, to bound memory
_AMPLITUDES: Final = 257  # among which the least one is sought
_ROWS, _COLUMNS = 33, 17  # of a grid over amplitude and frequency or speed


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class ReductionChances:
    """Chances that friction on a rig falls by a share, and by how much it falls.

    Parameters
    ----------
    inputs : RigInputs
    prediction : RigPrediction
    own : OwnRuns or None
        Own runs that the prediction rests on.
    caveats : tuple of str
        Own published tests that it was learned from too.
    """

    inputs: RigInputs
    prediction: RigPrediction
    own: OwnRuns | None = None
    caveats: tuple[str, ...] = ()

    @property
    def runs(self) -> int:
        """Number of own runs that the prediction rests on."""
        return 0 if self.own is None else self.own.tested.friction_ratio.size

    @property
    def contradiction(self) -> str:
        """Sentence on own runs that contradict the prediction before them; empty where they do not."""
        return "" if self.own is None else contradiction_sentence(self.prediction.check, self.own)

    @property
    def run_caveats(self) -> tuple[str, ...]:
        """Sentences on own runs: what was taken from the rig, and which disagree with the others."""
        return () if self.own is None else (*outlier_caveats(self.prediction.check, self.own), *self.own.caveats)

    def of(
        self,
        friction_reduction: float,
        *,
        vibration_amplitude: ArrayLike,
        frequency: ArrayLike | None = None,
        sliding_speed: ArrayLike | None = None,
    ) -> Floats:
        """Probability that friction falls by a share and more.

        Parameters
        ----------
        friction_reduction : float
            Target, between 0 and 1. []
        vibration_amplitude : array_like
            Zero to peak; NaN gives NaN. [m]
        frequency, sliding_speed : array_like, broadcast against `vibration_amplitude`
            Those of the rig by default. [Hz], [m/s]

        Returns
        -------
        ndarray, shape of the broadcast arguments
            0 without vibration. []
        """
        settings = {"frequency": frequency, "sliding_speed": sliding_speed}
        moving, found = self._moving(vibration_amplitude, **settings)
        found[...] = np.where(np.isnan(found), np.nan, 0.0)
        for rows, conditions in moving:
            found.flat[rows] = self.prediction.chances(conditions, friction_ratio=1 - friction_reduction)
        return found

    def quantiles(
        self,
        levels: ArrayLike,
        *,
        vibration_amplitude: ArrayLike,
        frequency: ArrayLike | None = None,
        sliding_speed: ArrayLike | None = None,
    ) -> Floats:
        """Quantiles of the friction ratio at conditions.

        Parameters
        ----------
        levels : array_like, shape (k,)
            Between 0 and 1, such as 0.5 for the median.
        vibration_amplitude : array_like
            Zero to peak; NaN gives NaN. [m]
        frequency, sliding_speed : array_like, broadcast against `vibration_amplitude`
            Those of the rig by default. [Hz], [m/s]

        Returns
        -------
        ndarray, shape of `levels` and of the broadcast arguments
            1 without vibration. []
        """
        moving, still = self._moving(vibration_amplitude, frequency=frequency, sliding_speed=sliding_speed)
        shares = np.asarray(levels, dtype=np.float64)
        found = np.repeat(np.where(np.isnan(still), np.nan, 1.0).reshape(1, -1), shares.size, axis=0)
        for rows, conditions in moving:
            found[:, rows] = np.quantile(self.prediction.ratios(conditions), shares, axis=0)
        return found.reshape(*shares.shape, *still.shape)

    def draws(self, *, vibration_amplitude: ArrayLike) -> Floats:
        """Equally probable friction ratios along a curve of amplitudes.

        Parameters
        ----------
        vibration_amplitude : array_like, shape (m,)
            Zero to peak. [m]

        Returns
        -------
        ndarray, shape (draws, m)
            A rig a row, 1 without vibration. []
        """
        moving, still = self._moving(vibration_amplitude, frequency=None, sliding_speed=None)
        found = np.ones((self.prediction.count, still.size))
        for rows, conditions in moving:
            found[:, rows] = self.prediction.ratios(conditions)
        return found

    @property
    def friction(self) -> Input:
        """Coefficient of friction without vibration: by own runs where they have forces, else that of the rig."""
        return self.inputs.friction if self.own is None or self.own.friction is None else self.own.friction

    def intrinsic_coefficients(self) -> Floats:
        """Equally probable coefficients of friction without vibration."""
        return intrinsic_draws(self.friction, count=self.prediction.count)

    def _moving(
        self, vibration_amplitude: ArrayLike, *, frequency: ArrayLike | None, sliding_speed: ArrayLike | None
    ) -> tuple[list[tuple[Integers, Conditions]], Floats]:
        """Flat places of vibrating points with conditions, a bounded number at once; and a copy of all amplitudes."""
        f = self.inputs.frequency if frequency is None else frequency
        v = self.inputs.sliding_speed if sliding_speed is None else sliding_speed
        a, f, v = np.broadcast_arrays(*(np.asarray(each, dtype=np.float64) for each in (vibration_amplitude, f, v)))
        rows = np.flatnonzero(np.nan_to_num(a) > 0)
        parts = [part for part in np.array_split(rows, -(-rows.size // _AT_ONCE) or 1) if part.size]
        at = [
            self.inputs.at(vibration_amplitude=a.flat[part], frequency=f.flat[part], sliding_speed=v.flat[part])
            for part in parts
        ]
        return [(part, each.conditions) for part, each in zip(parts, at, strict=True)], a.copy()

    def over_grid(self, friction_reduction: float, vibration_amplitude: Floats, other: Floats, *, name: str) -> Floats:
        """Probabilities at very many points, between those of a grid over amplitude and frequency or sliding speed.

        Parameters
        ----------
        friction_reduction : float
            Target, between 0 and 1. []
        vibration_amplitude : ndarray
            Zero to peak; NaN gives NaN. [m]
        other : ndarray, shape of `vibration_amplitude`
            Frequencies or sliding speeds. [Hz] or [m/s]
        name : {"frequency", "sliding_speed"}

        Returns
        -------
        ndarray, shape of `vibration_amplitude`
            To 0.01. []
        """
        moving = np.isfinite(vibration_amplitude) & (vibration_amplitude > 0)
        found = np.where(np.isnan(vibration_amplitude), np.nan, 0.0)
        if not np.any(moving):
            return found
        logs, across = np.log(vibration_amplitude[moving]), np.log(other[moving])
        rows, columns = _nodes(logs, _ROWS), _nodes(across, _COLUMNS)
        table = self.of(friction_reduction, vibration_amplitude=np.exp(rows)[:, None], **{name: np.exp(columns)})
        values = np.stack([np.interp(logs, rows, column) for column in table.T])
        steps = np.interp(across, columns, np.arange(columns.size))
        below = np.minimum(steps.astype(int), max(columns.size - 2, 0))
        points = np.arange(logs.size)
        low, high = values[below, points], values[np.minimum(below + 1, columns.size - 1), points]
        found[moving] = low + (steps - below) * (high - low)
        return found

    def least_amplitude(
        self, friction_reduction: float, *, confidence: float, highest: float, frequency: float
    ) -> float | None:
        """Least amplitude, in m, up to a highest one, at which a reduction has a chance; None where none has."""
        amplitudes = highest * np.geomspace(1e-3, 1.0, _AMPLITUDES)
        chances = self.of(friction_reduction, vibration_amplitude=amplitudes, frequency=frequency)
        enough = np.flatnonzero(chances >= confidence)
        if not enough.size:
            return None
        first = int(enough[0])
        if first == 0:
            return float(amplitudes[0])
        share = (confidence - chances[first - 1]) / (chances[first] - chances[first - 1])
        return float(np.exp(np.interp(share, [0, 1], np.log(amplitudes[first - 1 : first + 1]))))

    def interval(
        self, *, vibration_amplitude: float, frequency: float | None = None, sliding_speed: float | None = None
    ) -> tuple[float, float, float]:
        """Ends of the 80 % interval of the friction ratio, and its median between them, by `RigPrediction.ratios`."""
        settings = {"frequency": frequency, "sliding_speed": sliding_speed}
        low, middle, high = self.quantiles(INTERVAL, vibration_amplitude=vibration_amplitude, **settings)
        return float(low), float(middle), float(high)


def reduction_chances(
    rig: Rig, *, runs: "xr.Dataset | None" = None, evidence: EvidencePosterior | None = None, draws: int = _DRAWS
) -> ReductionChances:
    """Chances that a rig reaches a reduction of friction.

    Parameters
    ----------
    rig : Rig
    runs : xarray.Dataset, optional
        Own measured runs over `run`, as `predict` takes them.
    evidence : EvidencePosterior, optional
        Posterior by own published tests too, in place of the shipped one.
    draws : int
        Equally probable outcomes.

    Returns
    -------
    ReductionChances

    Raises
    ------
    InvalidInput
        If `predict` refuses the rig or its runs, or knows of no interval, as of a lubricated contact.
    """
    limits = applicability(rig)
    if limits.refusal:
        raise InvalidInput(limits.refusal)
    if limits.any_ratio and runs is None:
        raise InvalidInput(f"{rig.title}: chances and intervals need a dry contact, or runs of your own")
    inputs = rig_inputs(rig, takes_plane=True)
    own = None if runs is None else own_runs(runs, inputs, title=rig.title)
    tested = None if own is None else own.tested
    found = rig_prediction(population_of(inputs.direction, evidence), inputs.at(), count=draws, own=tested)
    caveats = () if evidence is None else evidence.caveats(inputs.direction)
    return ReductionChances(inputs=inputs, prediction=found, own=own, caveats=caveats)


def _nodes(logs: Floats, count: int) -> Floats:
    """Even nodes between the ends of some logarithms; one where all are the same."""
    low, high = float(np.min(logs)), float(np.max(logs))
    return np.linspace(low, high, count) if high > low else np.array([low])


def odds_text(chance: float) -> str:
    """Chance in words: in tenths where it is near one, as "7 chances in 10", else in hundredths."""
    tenths = round(10 * chance)
    if abs(chance - tenths / 10) < _NEAR_A_TENTH and 0 < tenths < 10:
        return f"{tenths} {'chance' if tenths == 1 else 'chances'} in 10"
    hundredths = round(100 * chance)
    if hundredths == 0:
        return "less than 1 chance in 100"
    if hundredths == 100:
        return "more than 99 chances in 100"
    return f"{hundredths} {'chance' if hundredths == 1 else 'chances'} in 100"
