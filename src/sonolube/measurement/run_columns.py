"""Columns of a table of measured runs: names, usual units, meanings, and the words of help texts about them."""

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class RunColumn:
    """Column of a table of runs.

    Parameters
    ----------
    name : str
        Quantity of the vocabulary, or the name of a text.
    unit : str
        Unit as usually written in the heading; any unit of the same kind is read. Empty for pure numbers and texts.
    meaning : str
    needed : str
        When it is needed, and what stands for it otherwise.
    is_text : bool
        Whether the cells are free text.
    is_result : bool
        Whether it is measured, not set.
    also : tuple of str
        Other headings of a text; those of a quantity stand in the vocabulary.
    """

    name: str
    unit: str
    meaning: str
    needed: str
    is_text: bool = False
    is_result: bool = False
    also: tuple[str, ...] = ()

    @property
    def heading(self) -> str:
        """Name with the unit in brackets, as at the head of the column."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def _result(name: str, unit: str, meaning: str, needed: str) -> RunColumn:
    """Column of a quantity that is measured."""
    return RunColumn(name, unit, meaning, needed, is_result=True)


def _text(name: str, meaning: str, needed: str = "never", *, also: tuple[str, ...] = ()) -> RunColumn:
    """Column of free text."""
    return RunColumn(name, "", meaning, needed, is_text=True, also=also)


_setting: Final = RunColumn  # of a quantity that is set
_RIGS: Final = "where it is not the rig's, and without a rig file"
RUN_COLUMNS: Final = (
    _text(
        "run",
        "Name of the run",
        "where equal rows are runs of their own; without it they count as copies",
        also=("test", "test no", "run no", "no", "Versuch", "Versuch Nr", "Versuchsnummer", "Lauf", "Nr"),
    ),
    _text("block", "Runs made in one go: a day, a mounting, a pair of specimens", also=("day", "Tag")),
    _setting("vibration_amplitude", "um", "Amplitude of the vibration, zero to peak", _RIGS),
    _setting("voltage_peak_to_peak", "V", "Voltage of the drive, peak to peak", "instead of the amplitude, with a rig"),
    _setting("vibration_velocity", "m/s", "Peak velocity of the vibration", "instead of amplitude and frequency"),
    _setting("vibration_direction", "deg", "Angle between vibration and sliding", "for vibration in the contact plane"),
    _setting("frequency", "kHz", "Frequency of the vibration", _RIGS),
    _setting("sliding_speed", "mm/s", "Sliding speed", _RIGS),
    _setting("normal_load", "N", "Force pressing the bodies together", _RIGS),
    _setting("nominal_area", "mm2", "Nominal contact area", "for efficiency, where it is not the rig's"),
    _setting("nominal_pressure", "MPa", "Load over nominal area", "on maps over stress"),
    _setting("lowest_speed", "mm/s", "Lowest sliding speed", "in the literature, where a range is stated"),
    _result("friction_force", "N", "Friction with vibration", "with intrinsic_friction_force, or a ratio or reduction"),
    _result("intrinsic_friction_force", "N", "Friction without vibration", "with friction_force"),
    _result("friction_ratio", "", "Friction with vibration over that without", "where no forces are stated"),
    _result("friction_reduction", "%", "One minus the friction ratio", "where no forces are stated"),
    _result("friction_force_uncertainty", "N", "Standard uncertainty of friction_force", "without repeats"),
    _result("intrinsic_friction_force_uncertainty", "N", "That of intrinsic_friction_force", "without repeats"),
    _result("friction_reduction_uncertainty", "%", "That of reduction or ratio", "without repeats"),
    _result("wear_rate", "mm3/m", "Wear volume per sliding distance", "for wear, with intrinsic_wear_rate"),
    _result("intrinsic_wear_rate", "mm3/m", "The same without vibration", "for wear, with wear_rate"),
    _result("wear_rate_ratio", "", "Wear rate with vibration over that without", "for wear"),
    _result("wear_reduction", "%", "One minus the ratio of the wear rates", "for wear"),
    _result("actuator_power", "W", "Power drawn by the actuator", "for efficiency, and on maps over power"),
    _result("temperature", "degC", "Temperature of the specimen", "never"),
    _text("study", "Authors", "in the literature"),
    _text("direction", "longitudinal, transverse, in plane or perpendicular", "in the literature, where it is stated"),
    _text("source", "Document and table or page of the numbers", "in the literature", also=("Quelle",)),
    _text("note", "Anything else", also=("notes", "comment", "remark", "remarks", "Bemerkung", "Kommentar", "Notiz")),
)
"""Columns that a table of runs may have; further quantities of the vocabulary are read, and empty cells are allowed."""

TEXT_NAMES: Final = tuple(column.name for column in RUN_COLUMNS if column.is_text)
"""Names of the columns of free text, which are no quantities."""

_BY_NAME = {column.name: column for column in RUN_COLUMNS}
FRICTION_COLUMNS: Final = (
    f"{_BY_NAME['friction_reduction'].heading}, or friction_ratio, or {_BY_NAME['friction_force'].heading} and"
    f" {_BY_NAME['intrinsic_friction_force'].heading}"
)
"""Columns of which one set gives the friction of a run, in words."""


def heading(name: str) -> str:
    """Heading of a column of `RUN_COLUMNS`, its usual unit in brackets."""
    return _BY_NAME[name].heading


def runs_help(beginning: str) -> str:
    """Help text of an option that takes a table of runs: a beginning, then the columns."""
    settings = ", ".join(heading(name) for name in ("vibration_amplitude", "voltage_peak_to_peak", "sliding_speed"))
    return f"{beginning}: {FRICTION_COLUMNS}; {settings}, normal_load and others where they vary; cells may be empty."
