"""Task `friction`: friction of a rig with and without vibration, by its own or another friction model."""

from typing import Annotated

from sonolube.models.friction import FRICTION_MODELS, FrictionModel
from sonolube.prediction.tested_amplitudes import large_amplitude_caveats
from sonolube.report.results.beyond_the_model import beyond_the_model
from sonolube.report.results.measured_on_rig import measured_on
from sonolube.rig import friction_point
from sonolube.rig.resolved_rig import resolved_rig
from sonolube.rig.simulation import friction_model_named
from sonolube.tasks.parameters import Interval, Parameter, RigFile, rig_of
from sonolube.tasks.predict.rig_record import RigRecord
from sonolube.tasks.task import task


def _described(model: type[FrictionModel]) -> str:
    """Name, parameters with their units, and source of a friction model."""
    parameters = ", ".join(f"{each.name} in {each.unit}" if each.unit else each.name for each in model.parameters())
    return f"{model.name} ({parameters or 'no parameters'}; {model.citation})"


_MODEL = Parameter(
    "Friction model instead of the rig's own (D is the dissertation):"
    f" {'; '.join(map(_described, FRICTION_MODELS.values()))}.",
    "NAME",
)


@task
def friction(rig: RigFile, *, model: Annotated[str | None, _MODEL] = None, interval: Interval = True) -> RigRecord:
    """Friction of the rig with and without vibration.

    Example: sonolube friction examples/rigs/collar.toml --set drive.voltage_peak_to_peak=14V

    Examples
    --------
    >>> import sonolube as sl
    >>> answer = sl.friction("examples/rigs/tribometer.toml")
    >>> round(float(answer["friction_ratio"]), 2)
    0.35
    >>> round(float(answer["friction_force"]), 2)  # in N
    0.36
    """
    known = rig_of(rig)
    resolved = resolved_rig(known)
    result = friction_point(resolved, model=model)
    by = known.friction_model if model is None else friction_model_named(known, model)
    beyond = beyond_the_model(resolved, by, interval=interval)
    return RigRecord(
        rig=known,
        result=result,
        measured=measured_on(known, vibration_amplitude=result.vibration_amplitude),
        leading=large_amplitude_caveats(resolved, vibration_amplitude=result.vibration_amplitude),
        rows=beyond.rows(),
        entries=beyond.object(),
    )
