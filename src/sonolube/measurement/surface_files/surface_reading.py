"""Content of a surface file as its reader returns it, before unit and spacing are completed."""

from dataclasses import dataclass
from datetime import datetime

from sonolube.checks import Floats


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SurfaceReading:
    """Heights, spacings and provenance as a surface file states them.

    Parameters
    ----------
    height : ndarray, shape (rows, columns)
        Height, NaN where it was not measured; in the length unit of the file where it does not state that unit. [m]
    format_name : str
        The file's format, such as "Wyko OPD".
    spacing_x, spacing_y : float or None
        Distance of neighbouring columns and rows, in the unit of the heights; None where the file states none. [m]
    states_unit : bool
        Whether the file states the unit of its lengths.
    metres_by_default : bool
        Whether lengths without a stated unit are metres where the user gives no unit.
    title, instrument : str
        As the file states them; empty where it does not.
    measured_at : datetime or None
        Time of the measurement, by the instrument's clock.
    """

    height: Floats
    format_name: str
    spacing_x: float | None = None
    spacing_y: float | None = None
    states_unit: bool = True
    metres_by_default: bool = False
    title: str = ""
    instrument: str = ""
    measured_at: datetime | None = None
