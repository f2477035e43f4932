"""Predictive interval of the friction ratio of a rig alone, to stand beside what a friction model computes."""

from dataclasses import dataclass

from sonolube.errors import SonolubeError
from sonolube.prediction.applicability import applicability
from sonolube.prediction.inputs import rig_inputs
from sonolube.prediction.posterior import learned
from sonolube.prediction.predictive import DRAWS, ratio_draws
from sonolube.prediction.scores import central_interval
from sonolube.rig import ResolvedRig, Rig
from sonolube.rig.resolved_rig import resolved_rig


@dataclass(frozen=True, kw_only=True, slots=True)
class FrictionInterval:
    """Central 80 % interval of the friction ratio, with the error of the model, as `predict` gives it.

    Parameters
    ----------
    low, high : float or None
        Ends; None where there is no prediction.
    reason : str
        Why there is none.
    """

    low: float | None = None
    high: float | None = None
    reason: str = ""

    @property
    def text(self) -> str:
        """Interval in words, or why there is none."""
        if self.low is None or self.high is None:
            return f"not predicted: {self.reason}"
        return f"{self.low:.2g} to {self.high:.2g} (80 %, `sonolube predict`)"


def friction_interval(rig: Rig | ResolvedRig) -> FrictionInterval:
    """Interval of the friction ratio of a rig at its operating point, without own runs; equal to that of `predict`."""
    resolved = resolved_rig(rig)
    try:
        limits = applicability(resolved.rig)
        if limits.refusal:
            return FrictionInterval(reason=limits.refusal)
        if limits.any_ratio:
            return FrictionInterval(reason=limits.caveats[0])
        at = rig_inputs(resolved).at()
    except SonolubeError as refusal:
        return FrictionInterval(reason=str(refusal))
    low, high = central_interval(ratio_draws(learned().friction, at, count=DRAWS)[:, 0], 0.8)
    return FrictionInterval(low=float(low), high=float(high))
