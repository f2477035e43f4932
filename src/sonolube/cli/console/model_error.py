"""Error of a rig's friction model, which no interval from the rig's inputs holds, as text and for JSON."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sonolube.friction import FrictionModel
    from sonolube.validation.model_error import ModelError

ERROR_LABEL = "left out"
"""Name of the row that states the error."""


def error_of(model: "FrictionModel") -> "ModelError | None":
    """Error of a friction model on published tests that it has not seen; None where none is known."""
    from sonolube.validation.model_error import unseen_error

    return unseen_error(model)


def error_text(error: "ModelError | None") -> str:
    """Error of the model in a sentence."""
    if error is None:
        return "the error of the model, which with these parameters is not known"
    return f"the error of the model: +-{error.rms:.2g} in the ratio on {error.tests} published tests, each unseen"


def error_object(error: "ModelError | None") -> dict[str, Any]:
    """Error of the model for JSON."""
    return {"model_error": None if error is None else {"rms": error.rms, "tests": error.tests}}
