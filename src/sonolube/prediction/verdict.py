"""Verdict on one operating point of a rig: in range, extrapolated, outside the model's range, or contradicted by runs.

One function judges a point for all commands, so that none gives a number without a word where another has none.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from sonolube.errors import SonolubeError
from sonolube.models.friction.models.range_check import OUTSIDE_MODEL_RANGE
from sonolube.prediction.applicability import applicability, tested_range_caveats, untested_conditions
from sonolube.rig import FrictionPoint, ResolvedRig, Rig, friction_point
from sonolube.rig.resolved_rig import resolved_rig


class Verdict(StrEnum):
    """Standing of an operating point between models and tests."""

    IN_RANGE = "in_range"
    EXTRAPOLATED = "extrapolated"
    OUTSIDE_MODEL_RANGE = OUTSIDE_MODEL_RANGE
    CONTRADICTED = "contradicted_by_runs"


_WORDS = {
    Verdict.IN_RANGE: "within the range of the friction model and of the published tests",
    Verdict.EXTRAPOLATED: "extrapolated beyond the published tests",
    Verdict.OUTSIDE_MODEL_RANGE: "outside the range of the friction model",
    Verdict.CONTRADICTED: "contradicted by own runs",
}


@dataclass(frozen=True, kw_only=True, slots=True)
class PointVerdict:
    """Verdict on an operating point with its reasons.

    Parameters
    ----------
    verdict : Verdict
    reasons : tuple of str
        One line each; empty in range.
    """

    verdict: Verdict
    reasons: tuple[str, ...] = ()

    @property
    def words(self) -> str:
        """Verdict in words, without the reasons."""
        return _WORDS[self.verdict]

    @property
    def text(self) -> str:
        """Verdict in words with its reasons."""
        return f"{self.words}: {'; '.join(self.reasons)}" if self.reasons else self.words

    def object(self) -> dict[str, object]:
        """Verdict and reasons for JSON."""
        return {"verdict": str(self.verdict), "verdict_reasons": list(self.reasons)}


def point_verdict(
    rig: Rig | ResolvedRig, *, friction: FrictionPoint | None = None, lubricant: bool = False, contradiction: str = ""
) -> PointVerdict:
    """Verdict on the operating point of a rig.

    Parameters
    ----------
    rig : Rig or ResolvedRig
    friction : FrictionPoint, optional
        Friction by the model that the verdict is on; the rig's own where absent.
    lubricant : bool
        Whether the contact is stated to be lubricated.
    contradiction : str
        How own runs contradict the prediction before them; empty where they do not.

    Returns
    -------
    PointVerdict
        Of own runs before the model, of the model before the tests.

    Raises
    ------
    InvalidInput, OutsideRange
        As `friction_point`, where no friction is given.
    """
    resolved = resolved_rig(rig)
    point = friction_point(resolved) if friction is None else friction
    if contradiction:
        return PointVerdict(verdict=Verdict.CONTRADICTED, reasons=(contradiction,))
    if point.reason:
        return PointVerdict(
            verdict=Verdict.OUTSIDE_MODEL_RANGE, reasons=(point.reason.removeprefix(f"{OUTSIDE_MODEL_RANGE}: "),)
        )
    reasons = _beyond_tests(resolved.rig, point, lubricant=lubricant)
    return PointVerdict(verdict=Verdict.EXTRAPOLATED if reasons else Verdict.IN_RANGE, reasons=reasons)


def verdict_of_rig(rig: Rig | ResolvedRig) -> PointVerdict | None:
    """Verdict on the operating point of a rig; None where it has no friction to judge."""
    try:
        return point_verdict(rig)
    except SonolubeError:
        return None


def _beyond_tests(rig: Rig, point: FrictionPoint, *, lubricant: bool) -> tuple[str, ...]:
    """What lies beyond the published tests, a line each."""
    if not np.any(point.vibration_amplitude):
        return ()
    limits = applicability(rig, lubricant=lubricant)
    if limits.refusal:
        return (f"compared with no published test, as {limits.refusal.removeprefix(f'{rig.title}: ')}",)
    amplitude = point.vibration_amplitude
    outside = untested_conditions if rig.direction.is_normal else tested_range_caveats
    return (*limits.beyond_tests, *outside(rig, vibration_amplitude=amplitude))
