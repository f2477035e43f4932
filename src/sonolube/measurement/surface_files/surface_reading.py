"""Content of a surface file as its reader returns it, before unit and spacing are completed."""

from dataclasses import dataclass
from datetime import datetime

from sonolube.checks import Floats

STATED_BY_FILE = "stated in the file"
FIXED_BY_FORMAT = "fixed by the format"
LIBRARY_DEFAULT = "SurfaceTopography's default for the format"
GIVEN_BY_USER = "given by the user"
ASSUMED_METRES = "assumed, as the file states none and none was given"


@dataclass(frozen=True, kw_only=True, slots=True, eq=False)
class SurfaceReading:
    """Heights, spacings and provenance as a surface file states them.

    Parameters
    ----------
    height : ndarray, shape (rows, columns)
        Height, NaN where it was not measured; in the length unit of the file where it does not state that unit. A
        profile is one row. [m]
    format_name : str
        The file's format, such as "Wyko OPD".
    spacing_x, spacing_y : float or None
        Distance of neighbouring columns and rows, in the unit of the heights; None where the file states none. [m]
    states_unit : bool
        Whether the unit of its lengths is known from the file or its format; heights and spacings are in metres then.
    metres_by_default : bool
        Whether lengths without a stated unit are metres where the user gives no unit.
    lateral_unit : str
        Unit in which the file's spacings are written; empty where it is not known from the file or its format.
    unit_origin : str
        How that unit is known: `STATED_BY_FILE`, `FIXED_BY_FORMAT` or `LIBRARY_DEFAULT`; empty where it is not.
    title, instrument : str
        As the file states them; empty where it does not.
    measured_at : datetime or None
        Time of the measurement, by the instrument's clock.
    notes : tuple of str
        What was done to the heights in reading, such as interpolation at even steps.
    """

    height: Floats
    format_name: str
    spacing_x: float | None = None
    spacing_y: float | None = None
    states_unit: bool = True
    metres_by_default: bool = False
    lateral_unit: str = ""
    unit_origin: str = ""
    title: str = ""
    instrument: str = ""
    measured_at: datetime | None = None
    notes: tuple[str, ...] = ()
