"""Protocol at another load and sliding speed."""

from sonolube.facts.protocol.record import Protocol
from sonolube.facts.protocol.steps import MotorSpeed, Prompt, Repeat, Step
from sonolube.text.units import format_si


def protocol_at(protocol: Protocol, *, normal_load: float, sliding_speed: float) -> Protocol:
    """Protocol whose test is at another load and speed, each where it has one.

    Parameters
    ----------
    protocol : Protocol
    normal_load : float
        [N]
    sliding_speed : float
        Of every step that turns the motor. [m/s]

    Returns
    -------
    Protocol
        Its title has load and speed behind a comma.
    """
    conditions = f"{format_si(normal_load, 'N')} and {format_si(sliding_speed, 'm/s')}"
    return protocol.model_copy(
        update={
            "title": f"{protocol.title.split(',')[0]}, {conditions}",
            "metadata": protocol.metadata.model_copy(update={"normal_load": normal_load}),
            "steps": tuple(_step_at(step, normal_load, sliding_speed) for step in protocol.steps),
        }
    )


def _step_at(step: Step, load: float, speed: float) -> Step:
    """Step at another load and speed."""
    match step:
        case Repeat():
            return step.model_copy(update={"steps": tuple(_step_at(each, load, speed) for each in step.steps)})
        case MotorSpeed() if step.sliding_speed or step.rotation_speed:
            return step.model_copy(update={"sliding_speed": speed, "rotation_speed": None})
        case Prompt() if step.normal_load is not None:
            text = f"Set a normal load of {format_si(load, 'N')}; bring the pin into contact."
            return step.model_copy(update={"normal_load": load, "text": text})
    return step
