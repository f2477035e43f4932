"""Verdict on one operating point of a rig: in range, extrapolated, outside the model's range, or contradicted by runs.

One function judges a point for all commands, so that none gives a number without a word where another has none.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sonolube.errors import SonolubeError
from sonolube.models.friction.models.range_check import OUTSIDE_MODEL_RANGE
from sonolube.prediction.applicability import applicability, is_beyond_tests, tested_range_caveats, untested_conditions
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


NO_RESULT: Final = "no_result"
"""Name of the code of a point that has no friction to judge."""

VERDICTS: Final = (*map(str, Verdict), NO_RESULT)
"""Names of the codes of `point_verdicts`."""


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


def point_verdicts(
    rig: Rig,
    *,
    vibration_amplitude: ArrayLike,
    frequency: ArrayLike | None,
    sliding_speed: ArrayLike,
    outside_model: ArrayLike,
    contradiction: str = "",
) -> NDArray[np.int8]:
    """Verdicts on many operating points of a rig, each that of `point_verdict`.

    Parameters
    ----------
    rig : Rig
    vibration_amplitude : array_like
        Zero to peak; NaN for a point without a result. [m]
    frequency : array_like or None
        Broadcast against `vibration_amplitude`; None where the rig has none. [Hz]
    sliding_speed : array_like
        Broadcast against `vibration_amplitude`. [m/s]
    outside_model : array_like of bool, broadcast against `vibration_amplitude`
        Whether the point is outside the range of the friction model.
    contradiction : str
        How own runs contradict the prediction before them; empty where they do not.

    Returns
    -------
    ndarray of int, shape of the broadcast arguments
        Indices into `VERDICTS`.
    """
    beyond = is_beyond_tests(
        rig, vibration_amplitude=vibration_amplitude, frequency=frequency, sliding_speed=sliding_speed
    )
    amplitude, outside = np.asarray(vibration_amplitude, dtype=np.float64), np.asarray(outside_model, dtype=np.bool_)
    code = VERDICTS.index
    found = np.where(beyond & (amplitude != 0), code(Verdict.EXTRAPOLATED), code(Verdict.IN_RANGE))
    found = np.where(outside, code(Verdict.OUTSIDE_MODEL_RANGE), found)
    if contradiction:
        found = np.full(found.shape, code(Verdict.CONTRADICTED))
    return np.where(np.isnan(amplitude), code(NO_RESULT), found).astype(np.int8)


def verdicts_text(codes: ArrayLike) -> str:
    """Number of points of each verdict in words; empty where no point has a result."""
    counts = verdict_counts(codes)
    counts.pop(NO_RESULT, None)
    total = sum(counts.values())
    parts = [f"{count} {_WORDS[Verdict(name)]}" for name, count in counts.items()]
    if len(parts) == 1:
        return f"all {total} points with a result are {_WORDS[Verdict(next(iter(counts)))]}"
    return f"of {total} points with a result: {', '.join(parts)}" if parts else ""


def verdict_counts(codes: ArrayLike) -> dict[str, int]:
    """Number of points of each verdict that occurs, by its name."""
    counts = np.bincount(np.ravel(codes), minlength=len(VERDICTS)).tolist()
    return {name: count for name, count in zip(VERDICTS, counts, strict=True) if count}


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
