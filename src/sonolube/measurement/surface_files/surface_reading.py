"""What a surface file says of itself, before anything is added to it."""

from dataclasses import dataclass
from datetime import datetime

from sonolube.checks import Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SurfaceReading:
    """The content of a surface file as its reader found it.

    Parameters
    ----------
    height : ndarray, shape (rows, columns)
        Height, NaN where it was not measured; in the file's own length where it does not say its unit. [m]
    format_name : str
        The file's format, such as "Wyko OPD".
    spacing_x, spacing_y : float or None
        Distance of neighbouring columns and rows, in the length of the heights; None where the file says none. [m]
    states_unit : bool
        Whether the file says in which unit its lengths are.
    title, instrument : str
        As the file gives them; empty where it does not.
    measured_at : datetime or None
        When it was measured, by the instrument's clock.
    """

    height: Floats
    format_name: str
    spacing_x: float | None = None
    spacing_y: float | None = None
    states_unit: bool = True
    title: str = ""
    instrument: str = ""
    measured_at: datetime | None = None
