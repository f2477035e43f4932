"""Error of a rig's friction model, which no interval from the rig's inputs holds, as text and for JSON."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sonolube.validation.assessment import ErrorStatistics

ERROR_LABEL = "left out"
"""Name of the row that states the error."""


def error_text(error: "ErrorStatistics | None") -> str:
    """Error of the model in a sentence."""
    if error is None:
        return "the error of the model, which with these parameters is not known"
    return f"the error of the model: +-{error.rms:.2g} in the ratio on {error.count} published tests, each unseen"


def error_object(error: "ErrorStatistics | None") -> dict[str, Any]:
    """Error of the model for JSON."""
    return {"model_error": None if error is None else {"rms": error.rms, "tests": error.count}}
