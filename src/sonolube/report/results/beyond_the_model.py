"""Error of the friction model and predictive interval beside a computed friction ratio, as text and for JSON."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sonolube.models.friction import FrictionModel
    from sonolube.prediction.friction_interval import FrictionInterval
    from sonolube.rig import ResolvedRig, Rig
    from sonolube.validation.assessment import ErrorStatistics


@dataclass(frozen=True, kw_only=True, slots=True)
class BeyondTheModel:
    """Error of a rig's friction model, which no interval from the rig's inputs holds, and the interval that does.

    Parameters
    ----------
    error : ErrorStatistics or None
        On published tests, each unseen; None where it is not known.
    interval : FrictionInterval or None
        None where it is not asked for.
    """

    error: "ErrorStatistics | None"
    interval: "FrictionInterval | None"

    def rows(self) -> list[tuple[str, str]]:
        """Names and texts."""
        if self.interval is None:
            return [("left out", "the error of the model, which --interval states")]
        error = "the error of the model, which with these parameters is not known"
        if self.error is not None:
            error = (
                f"the error of the model: +-{self.error.rms:.2g} in the ratio on {self.error.count} published tests,"
                " each unseen"
            )
        return [("left out", error), ("predicted ratio", self.interval.text)]

    def object(self) -> dict[str, Any]:
        """Entries for JSON."""
        if self.interval is None:
            return {}
        ends = None if self.interval.low is None else [self.interval.low, self.interval.high]
        return {
            "model_error": None if self.error is None else {"rms": self.error.rms, "tests": self.error.count},
            "predicted_friction_ratio": {"interval_80": ends, "reason": self.interval.reason or None},
        }


def beyond_the_model(rig: "Rig | ResolvedRig", model: "FrictionModel", *, interval: bool) -> BeyondTheModel:
    """Model error and prediction interval that the friction ratio of a rig by a friction model leaves out."""
    if not interval:
        return BeyondTheModel(error=None, interval=None)
    from sonolube.prediction.friction_interval import friction_interval
    from sonolube.validation.assessment import unseen_error  # which fits, with scipy.optimize

    return BeyondTheModel(error=unseen_error(model), interval=friction_interval(rig))
