"""Command `friction`: friction of a rig with and without vibration, by its own or another friction model."""

from typing import Annotated

import typer

from sonolube.cli.console.answer import deliver
from sonolube.cli.console.beyond_the_model import Interval, beyond_the_model
from sonolube.cli.console.options import Amplitude, Changes, Json, Load, RigPath, loaded_rig
from sonolube.cli.predict.measured import measured_on
from sonolube.cli.predict.rig_record import RigRecord
from sonolube.compilation import few_points
from sonolube.models.friction import FRICTION_MODELS, FrictionModel
from sonolube.prediction.tested_amplitudes import large_amplitude_caveats
from sonolube.rig import friction_point
from sonolube.rig.simulation import friction_model_named


def _described(model: type[FrictionModel]) -> str:
    """Name, parameters with their units, and source of a friction model."""
    parameters = ", ".join(f"{each.name} in {each.unit}" if each.unit else each.name for each in model.parameters())
    return f"{model.name} ({parameters or 'no parameters'}; {model.citation})"


_MODEL_HELP = f"Friction model instead of the rig's own: {'; '.join(map(_described, FRICTION_MODELS.values()))}."


@few_points()
def friction(
    rig: RigPath,
    load: Load = None,
    model: Annotated[str | None, typer.Option(metavar="NAME", help=_MODEL_HELP)] = None,
    amplitude: Amplitude = None,
    changes: Changes = None,
    interval: Interval = True,
    json: Json = False,
) -> None:
    """Friction of the rig with and without vibration.

    Example: sonolube friction examples/rigs/collar.toml --set drive.voltage_peak_to_peak=14V
    """
    known = loaded_rig(rig, load=load, changes=changes, amplitude=amplitude)
    result = friction_point(known, model=model)
    measured = measured_on(known, vibration_amplitude=result.vibration_amplitude)
    by = known.friction_model if model is None else friction_model_named(known, model)
    beyond = beyond_the_model(known, by, interval=interval)
    answer = RigRecord(
        rig=known,
        result=result,
        measured=measured,
        leading=large_amplitude_caveats(known, vibration_amplitude=result.vibration_amplitude),
        rows=beyond.rows(),
        entries=beyond.object(),
    )
    deliver(answer, as_json=json)
