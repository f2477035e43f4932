"""Arguments of tasks that control friction: target, controller, and the resonance where the rig has no structure."""

from typing import Annotated

from sonolube.design import control as loops
from sonolube.errors import InvalidInput
from sonolube.rig import Rig
from sonolube.tasks.parameters import Number, Parameter, Quantity
from sonolube.tasks.task import in_si, shown
from sonolube.text.units import to_si

Delay = Annotated[Number, Quantity("Delay of the friction measurement.", "s")]
Rate = Annotated[Number, Quantity("Sampling rate of the controller.", "Hz")]
ClosedLoop = Annotated[Number | None, Quantity("Time constant of the closed loop; the delay by default.", "s")]
VoltageLimit = Annotated[Number | None, Quantity("Largest swing, peak to peak; the rig's own by default.", "V")]
Quality = Annotated[float, Parameter("Quality factor, where the rig has no structure.", lowest=0.6)]
Coupling = Annotated[float, Parameter("Effective coupling, where it has none.", lowest=0.001, highest=0.999)]


def sampling_and_duration(*, rate: Number, duration: Number) -> tuple[float, float]:
    """Sampling rate and duration of the running task in SI, both positive.

    Parameters
    ----------
    rate : float or str
        Of the controller, in Hz or with its unit.
    duration : float or str
        Of the run. [s]

    Returns
    -------
    tuple of two float
    """
    sampling, run_time = in_si("rate", rate), in_si("duration", duration)
    if sampling <= 0 or run_time <= 0:
        raise InvalidInput(f"{shown('rate')} {rate} and {shown('duration')} {duration} must be positive")
    return sampling, run_time


def assumed_resonance(rig: Rig, *, quality: float, coupling: float) -> tuple[loops.VibrationMode, dict[str, str]]:
    """Resonance at the frequency of the drive of a rig without a structure, with what is assumed of it.

    Parameters
    ----------
    rig : Rig
    quality, coupling : float
        Quality factor and effective coupling.

    Returns
    -------
    VibrationMode
    dict of str to str
    """
    text = f"at the drive's frequency, quality factor {quality:g}, coupling {coupling:g}; not measured"
    return loops.assumed_mode(rig, quality_factor=quality, coupling_factor=coupling), {"resonance": text}


def friction_force(name: str, target: str | float, *, normal_load: float) -> float:
    """Friction force of an argument that takes a coefficient or a force.

    Parameters
    ----------
    name : str
        Of the argument.
    target : str or float
        A coefficient such as 0.1, or a text such as "0.1" or "0.3N".
    normal_load : float
        Force pressing the bodies together. [N]

    Returns
    -------
    float
        In N.

    Raises
    ------
    InvalidInput
        If the text is neither a pure number nor a force, or not positive.
    """
    text = str(target)
    is_force = text.strip()[-1:].isalpha()
    value = to_si(text, unit="N" if is_force else "", name=shown(name)) * (1.0 if is_force else normal_load)
    if not value > 0:
        raise InvalidInput(f"{shown(name)} {text} must be positive, a coefficient such as 0.2 or a force such as 0.6N")
    return value
