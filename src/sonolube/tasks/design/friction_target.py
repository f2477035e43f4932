"""Target of a task that takes a coefficient of friction or a friction force."""

from sonolube.errors import InvalidInput
from sonolube.tasks.task import shown
from sonolube.units import to_si


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
