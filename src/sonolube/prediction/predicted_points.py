"""Predicted friction ratios and verdicts at many operating points of one rig, for studies, sweeps and maps."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.errors import SonolubeError
from sonolube.prediction.applicability import applicability, tested_ranges_text
from sonolube.prediction.chances import INTERVAL, ReductionChances, reduction_chances
from sonolube.prediction.evidence_posterior import EvidencePosterior
from sonolube.prediction.predictive import DRAWS
from sonolube.prediction.verdict import VERDICTS, Verdict, point_verdicts
from sonolube.rig import Rig
from sonolube.rig.datasets import PREDICTED_RATIO

if TYPE_CHECKING:
    import xarray as xr

MAX_PREDICTED: Final = 2000
"""Points of a result up to which each is predicted."""


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class PredictedRig:
    """Prediction of a rig for any of its operating points, where there is one.

    Parameters
    ----------
    rig : Rig
    chances : ReductionChances or None
        Distribution of its friction ratio; None where there is no prediction.
    reason : str
        Why there is none; empty where there is.
    """

    rig: Rig
    chances: ReductionChances | None
    reason: str = ""

    @property
    def runs(self) -> int:
        """Number of own runs that the prediction rests on."""
        return 0 if self.chances is None else self.chances.runs

    @property
    def named_columns(self) -> tuple[str, ...]:
        """Names of the columns of `columns`."""
        return ("verdict",) if self.chances is None else (*PREDICTED_RATIO, "verdict")

    def columns(
        self,
        *,
        vibration_amplitude: ArrayLike,
        frequency: ArrayLike | None = None,
        sliding_speed: ArrayLike | None = None,
        outside_model: ArrayLike = False,
    ) -> dict[str, NDArray[np.float64] | NDArray[np.int8]]:
        """Predicted friction ratios and verdicts at operating points.

        Parameters
        ----------
        vibration_amplitude : array_like
            Zero to peak; NaN for a point without a result. [m]
        frequency : array_like, shape of `vibration_amplitude`, optional
            That of the rig by default. [Hz]
        sliding_speed : array_like, shape of `vibration_amplitude`, optional
            That of the rig by default. [m/s]
        outside_model : array_like of bool, shape of `vibration_amplitude`
            Whether the point is outside the range of the friction model.

        Returns
        -------
        dict of str to ndarray
            By the names of `named_columns`: ends of the 80 % interval and median, and indices into `VERDICTS`.
        """
        verdict = self.verdicts(
            vibration_amplitude=vibration_amplitude,
            frequency=frequency,
            sliding_speed=sliding_speed,
            outside_model=outside_model,
        )
        if self.chances is None:
            return {"verdict": verdict}
        found = self.chances.quantiles(
            INTERVAL, vibration_amplitude=vibration_amplitude, frequency=frequency, sliding_speed=sliding_speed
        )
        return {**dict(zip(PREDICTED_RATIO, found, strict=True)), "verdict": verdict}

    def verdicts(
        self,
        *,
        vibration_amplitude: ArrayLike,
        frequency: ArrayLike | None = None,
        sliding_speed: ArrayLike | None = None,
        outside_model: ArrayLike = False,
    ) -> NDArray[np.int8]:
        """Verdicts at operating points, with the arguments of `columns`, as indices into `VERDICTS`."""
        own_frequency = None if self.rig.drive is None else self.rig.drive.frequency
        return point_verdicts(
            self.rig,
            vibration_amplitude=vibration_amplitude,
            frequency=own_frequency if frequency is None else frequency,
            sliding_speed=self.rig.sliding_speed if sliding_speed is None else sliding_speed,
            outside_model=outside_model,
            contradiction="" if self.chances is None else self.chances.contradiction,
        )

    def caveats(self, verdict: ArrayLike) -> tuple[str, ...]:
        """Sentences on points with these verdicts: own runs and evidence, a rig unlike the tests, their ranges."""
        found: list[str] = []
        if self.chances is not None:
            contradiction = self.chances.contradiction
            found = [*([contradiction] if contradiction else []), *self.chances.run_caveats, *self.chances.caveats]
        found += applicability(self.rig).caveats
        if np.any(np.asarray(verdict) == VERDICTS.index(Verdict.EXTRAPOLATED)):
            found.append(f"points beyond the published tests, {tested_ranges_text(self.rig)}, are extrapolated")
        return tuple(found)


def predicted_rig(
    rig: Rig, *, points: int, runs: "xr.Dataset | None" = None, evidence: EvidencePosterior | None = None
) -> PredictedRig:
    """Prediction of a rig for its operating points.

    Parameters
    ----------
    rig : Rig
    points : int
        How many there are; more than 2000 are not predicted, to bound the time.
    runs : xarray.Dataset, optional
        Own measured runs over `run`, as `predict` takes them.
    evidence : EvidencePosterior, optional
        Posterior by own published tests too, in place of the shipped one.

    Returns
    -------
    PredictedRig
        Without a prediction, and with the reason, where `predict` refuses the rig or knows of no interval.

    Raises
    ------
    InvalidInput
        If runs are given and the rig cannot be predicted, or the runs cannot be its own.
    """
    if points > MAX_PREDICTED and runs is None:
        reason = f"{points} points are more than the {MAX_PREDICTED} up to which each is predicted"
        return PredictedRig(rig=rig, chances=None, reason=reason)
    try:
        return PredictedRig(rig=rig, chances=reduction_chances(rig, runs=runs, evidence=evidence, draws=DRAWS))
    except SonolubeError as refusal:
        if runs is not None:
            raise
        return PredictedRig(rig=rig, chances=None, reason=str(refusal).removeprefix(f"{rig.title}: "))
