"""Error of a friction model on published tests that neither a fit nor its default has seen."""

from dataclasses import dataclass

from sonolube.friction import FrictionModel
from sonolube.validation.assessment import FITTED_SETS, cross_validation_errors
from sonolube.validation.friction_model_variants import FRICTION_MODEL_VARIANTS


@dataclass(frozen=True, kw_only=True, slots=True)
class ModelError:
    """Error of a friction model on unseen published tests.

    Parameters
    ----------
    rms : float
        Root mean square error of the friction ratio. []
    tests : int
        Number of tests within the range of the model.
    """

    rms: float
    tests: int


def unseen_error(model: FrictionModel) -> ModelError | None:
    """Return the error of a friction model on published tests that it has not seen, as `compare` has it.

    Parameters
    ----------
    model : FrictionModel

    Returns
    -------
    ModelError or None
        None for parameters other than the defaults, of which no error is known.
    """
    if model != type(model)():
        return None
    variants = {variant.name: variant for variant in FRICTION_MODEL_VARIANTS}
    errors = cross_validation_errors(variants[model.name.replace("_", "-")], FITTED_SETS)
    return ModelError(rms=errors.rms, tests=errors.count)
