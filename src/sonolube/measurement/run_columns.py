"""Columns of a table of measured runs: names, usual units, meanings, and the words of help texts about them.

The list is `run_columns.toml` beside this module.
"""

import tomllib
from dataclasses import dataclass
from importlib.resources import files
from math import nan, pi
from typing import Final


@dataclass(frozen=True, kw_only=True, slots=True)
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
    unit: str = ""
    meaning: str
    needed: str
    is_text: bool = False
    is_result: bool = False
    also: tuple[str, ...] = ()

    @property
    def heading(self) -> str:
        """Name with the unit in brackets, as at the head of the column."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


SOURCE: Final = "source"
"""Column of the document or file that a run is from."""

SWITCH: Final = "used"
"""Column that leaves a run out of predictions and fits without removing it."""

SWITCHED_OFF: Final = ("no", "nein", "off", "false", "0")
"""Cells of it, in small letters, that leave a run out; any other, and none, uses it."""

DIRECTION_COLUMN: Final = "vibration_direction"
"""Column whose cells are angles or words."""

DIRECTION_WORDS: Final = {
    **{"along": 0.0, "longitudinal": 0.0, "across": pi / 2, "transverse": pi / 2},
    **{"normal": nan, "perpendicular": nan, "torsional": nan},
}
"""Words for a direction of vibration with the angle to the sliding that stands for each, in rad; NaN for none."""

_TABLE: Final = files("sonolube.measurement").joinpath("run_columns.toml").read_text(encoding="utf-8")
RUN_COLUMNS: Final = tuple(
    RunColumn(name=name, **entry | {"also": tuple(entry.get("also", ()))})
    for name, entry in tomllib.loads(_TABLE).items()
)
"""Columns that a table of runs may have; further quantities of the vocabulary are read, and empty cells are allowed."""

TEXT_NAMES: Final = tuple(column.name for column in RUN_COLUMNS if column.is_text)
"""Names of the columns of free text, which are no quantities."""

_BY_NAME = {column.name: column for column in RUN_COLUMNS}
FRICTION_COLUMNS: Final = (
    f"{_BY_NAME['friction_reduction'].heading}, or friction_ratio, or {_BY_NAME['friction_force'].heading} and"
    f" {_BY_NAME['intrinsic_friction_force'].heading}, or friction_coefficient and intrinsic_friction_coefficient"
)
"""Columns of which one set gives the friction of a run, in words."""


def heading(name: str) -> str:
    """Heading of a column of `RUN_COLUMNS`, its usual unit in brackets."""
    return _BY_NAME[name].heading


def runs_help(beginning: str) -> str:
    """Help text of an option that takes a table of runs: a beginning, then the columns."""
    settings = ", ".join(heading(name) for name in ("vibration_amplitude", "voltage_peak_to_peak", "sliding_speed"))
    return f"{beginning}: {FRICTION_COLUMNS}; {settings}, normal_load and others where they vary; cells may be empty."
